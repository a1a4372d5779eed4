"""Walks of any length and frame rate, over the floor, from the harmonics of a walk in joint angles."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray
from sklearn.utils import check_random_state

from eigenwalker._validation import check_finite, check_frame_rate, check_walks
from eigenwalker.motion.fourier import check_sampling, evaluate_harmonics, fit_harmonics, reference_phase, shift_phase
from eigenwalker.motion.ground import MAX_KNEE, plant_on_way
from eigenwalker.motion.legs import find_legs
from eigenwalker.motion.phase import find_stride, phase_weights
from eigenwalker.motion.rig import Place, Rig
from eigenwalker.motion.variation import StrideVariation
from eigenwalker.motion.walk import JointWalk
from eigenwalker.motion.way import Way, find_way

__all__ = ["synthesize"]

_DURATION = 10.0  # seconds


def synthesize(
    walks: JointWalk | Sequence[JointWalk],
    *,
    duration: float | None = None,
    frame_rate: float = 60.0,
    n_harmonics: int = 3,
    loop: bool = False,
    travel: bool = True,
    heading: float = 0.0,
    curvature: float = 0.0,
    path: ArrayLike | None = None,
    variation: StrideVariation | None = None,
    random_state: int | np.random.RandomState | None = None,
    speed: float | None = None,
    hold: bool = True,
    max_knee: float = MAX_KNEE,
    phase_reference: str | Mapping[str, float] = "auto",
    rig: Rig | Mapping[str, Place] | None = None,
    n_jobs: int | None = None,
) -> Any:
    """Return walks of any length that their harmonics make, with feet that stand (Tilmanne & Dutoit 2012, section 2.2).

    Each walk becomes its mean posture and `n_harmonics` harmonics of each channel (Eq. 1), which are evaluated at any
    time; `plant_feet` puts the result on the floor. The paper's walks have no path of the root; its displacement is
    this package's.

    Parameters
    ----------
    walks : JointWalk or list of JointWalk
        Upright and in place: from `prepare` with ``representation="joints"``, or made by a model of such walks.
    duration : float, default None
        In seconds. None is 10, and one stride with `loop`.
    frame_rate : float, default 60.0
        Frames per second.
    n_harmonics : int, default 3
        The fundamental included. The paper has 2; feet that swing, and with them speed, need a third.
    loop : bool, default False
        Whether the walk can be played over and over: a stride has a whole number of frames, which changes the
        frequency by half a frame a stride at most; there are as many whole strides as come nearest to `duration`; and
        the last frame has the pose of the first.
    travel, heading, curvature, path, speed, hold, max_knee, rig
        See `plant_feet`. With `path` or `curvature` there is no `loop`.
    variation : StrideVariation, default None
        How strides differ from each other. None makes all of them the same, as in the paper, which names that as its
        weakness. A loop has none.
    random_state : int, RandomState instance or None, default None
        Of the variation. Each walk has its own numbers.
    phase_reference : "auto" or mapping of str to float, default "auto"
        See `phase_weights`.
    n_jobs : int, default None
        Number of processes; None is one. The result does not depend on it.

    Returns
    -------
    JointWalk or list of JointWalk
        As was given, with the names of the walks. The first frame has the phase of the first frame given, and its
        root is over the origin.

    Raises
    ------
    WalkError
        If a walk has no period, or less than one stride.
    ValueError
        If a number is out of range, a skeleton is not upright, or options contradict each other.

    Examples
    --------
    >>> from eigenwalker import prepare, read_walk, write_walk
    >>> from eigenwalker.motion import synthesize
    >>> walk = prepare(read_walk("dataset-2_walk_elderly_001.bvh"), representation="joints")  # doctest: +SKIP
    >>> write_walk(synthesize(walk, duration=30, frame_rate=120), "elderly.bvh")  # doctest: +SKIP
    """
    several = not isinstance(walks, JointWalk)
    listed = check_walks(walks if several else [walks], kind=JointWalk)
    check_frame_rate(frame_rate)
    if duration is not None and not 0 < duration < np.inf:
        raise ValueError(f"duration must be positive and finite, in seconds, got {duration!r}")
    if loop and (curvature or path is not None or variation is not None):
        raise ValueError("a loop must be straight and its strides the same: leave curvature, path and variation out")
    if not travel and (curvature or path is not None):
        raise ValueError("travel=False keeps the walk in place: it has no curvature and no path")
    order = _Order(
        duration=duration,
        frame_rate=frame_rate,
        n_harmonics=n_harmonics,
        loop=loop,
        travel=travel,
        way=find_way(heading=heading, curvature=curvature, path=path),
        variation=variation,
        speed=speed,
        hold=hold,
        max_knee=max_knee,
        phase_reference=phase_reference,
        rig=rig,
    )
    seeds = check_random_state(random_state).randint(2**31 - 1, size=len(listed))
    jobs = (delayed(_make)(walk, order, int(seed)) for walk, seed in zip(listed, seeds, strict=True))
    made = list(Parallel(n_jobs=n_jobs)(jobs))
    return made if several else made[0]


class _Order(NamedTuple):
    """What `synthesize` was asked for."""

    duration: float | None
    frame_rate: float
    n_harmonics: int
    loop: bool
    travel: bool
    way: Way
    variation: StrideVariation | None
    speed: float | None
    hold: bool
    max_knee: float
    phase_reference: str | Mapping[str, float]
    rig: Rig | Mapping[str, Place] | None


def _make(walk: JointWalk, order: _Order, seed: int) -> JointWalk:
    """Return one walk. A stride more at both ends says where the feet come from and go to, and is cut off again."""
    legs = find_legs(walk.skeleton, order.rig)
    weights = phase_weights(walk, order.phase_reference)
    channels = np.asarray(walk.channels, dtype=np.float64)
    check_finite(channels, walk.channel_names, walk=walk.name)
    frequency = find_stride(channels, walk.frame_rate, weights, known=walk.frequency, name=walk.name)
    coefficients = fit_harmonics(channels, walk.frame_rate, frequency, order.n_harmonics)
    check_sampling(walk.n_frames, order.frame_rate, frequency, order.n_harmonics)
    stride = order.frame_rate / frequency
    n_frames = _count_frames(order, frequency)
    if order.loop:
        stride = max(2 * order.n_harmonics + 1, round(stride))
    margin = int(np.ceil(stride))
    times = np.arange(-margin, n_frames + margin) / order.frame_rate
    start = reference_phase(coefficients, weights)
    series = _series(coefficients, start, order.frame_rate / stride, times, order.variation, seed)
    series.flags.writeable = False  # else the walk keeps a copy
    still = np.zeros((len(times), 3))
    plain: dict[str, Any] = {"root": still, "translations": {}, "events": ()}
    long = walk.with_channels(series, frame_rate=order.frame_rate, frequency=order.frame_rate / stride, **plain)
    keep = slice(margin, margin + n_frames)
    options: dict[str, Any] = {"speed": order.speed, "hold": order.hold, "max_knee": order.max_knee}
    planted, advance = plant_on_way(long, order.way, legs, keep=keep, **options)
    planted = _closed(planted) if order.loop else planted
    return planted if order.travel else _on_treadmill(planted, advance, order)


def _count_frames(order: _Order, frequency: float) -> int:
    """Return the number of frames; a loop ends with the first one again."""
    if not order.loop:
        return max(1, round((_DURATION if order.duration is None else order.duration) * order.frame_rate))
    n_strides = 1 if order.duration is None else max(1, round(order.duration * frequency))
    return n_strides * max(2 * order.n_harmonics + 1, round(order.frame_rate / frequency)) + 1


def _series(
    coefficients: NDArray[np.float64],
    start: float,
    frequency: float,
    times: NDArray[np.float64],
    variation: StrideVariation | None,
    seed: int,
) -> NDArray[np.float64]:
    """Return channels at times, from coefficients whose phase zero lies `start` radians after time zero."""
    if variation is None:
        return evaluate_harmonics(coefficients, frequency, times)
    counted = times - start / (2 * np.pi * frequency)  # from phase zero on, where one stride passes into the next
    counted += np.ceil(max(0.0, -counted[0]) * frequency) / frequency
    return variation.series(shift_phase(coefficients, start), frequency, counted, random_state=seed)


def _closed(walk: JointWalk) -> JointWalk:
    """Make the last pose that of the first frame to the last bit, and the height of the root too."""
    rotations, root = np.array(walk.rotations), np.array(walk.root)
    rotations[-1], root[-1, 2] = rotations[0], root[0, 2]
    return replace(walk, rotations=rotations, root=root)


def _on_treadmill(walk: JointWalk, advance: float, order: _Order) -> JointWalk:
    """Take the steady advance out of a walk; of a loop all of it, so that its root closes as well."""
    share = np.arange(walk.n_frames)[:, np.newaxis]
    if order.loop:
        step = (walk.root[-1] - walk.root[0]) / (walk.n_frames - 1)
    else:
        angle = float(order.way.direction(np.zeros(1))[0])
        step = advance * np.array([np.cos(angle), np.sin(angle), 0.0])
    return replace(walk, root=walk.root - share * step, speed=walk.size * float(np.hypot(*step[:2])) * walk.frame_rate)
