"""From a recording to a walk in the treadmill frame."""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import WalkError, check_choice, check_finite, check_walks
from eigenwalker.motion.body import check_leg_length, stature
from eigenwalker.motion.fourier import FREQUENCY_RANGE, coarse_frequency, estimate_frequency
from eigenwalker.motion.path import Path, fit_path, longest_run, stance_speed, steady_stretch, swing_direction
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["mirror_walk", "prepare", "prepare_walks"]

_NEEDED = ("pelvis", "left_hip", "right_hip", "left_ankle", "right_ankle")
_TRAVEL_SPEED = 0.15  # m/s over the whole clip; slower is swaying on a treadmill, not going anywhere
_JUMP_SPEED = 15.0  # m/s of the pelvis between two frames; no body moves like that
_MAX_ROUNDS = 20
_ENOUGH_STRIDES = 2.0  # a steady part with fewer is widened


def prepare(
    walk: Walk | JointWalk,
    *,
    clip: str = "steady",
    heading: str = "path",
    treadmill: bool = True,
    normalize_size: bool = False,
    frequency_range: tuple[float, float] = FREQUENCY_RANGE,
) -> Walk:
    """Return a walk as it would look on a treadmill, ready for the Fourier model.

    Joint walks become walks of the 15 markers. Frames before or after a leap of the whole body (frames of zeros at
    the start of a file) are left out with a warning. Then, for a walk that travels: the steady part is cut out; the
    walk is turned so that it leads along x; and the path of the pelvis, a polynomial in time of x and y, fitted
    together with 4 harmonics of the stride, is taken out of all markers. Its mean velocity becomes `speed`.
    Height over the floor, z, stays as recorded.

    A walk that stays in place keeps its frames and its place. Its `speed` is what the walk says, else estimated
    from the stance feet.

    Parameters
    ----------
    walk : Walk or JointWalk
        One recording, with the markers pelvis, left and right hip and ankle.
    clip : {"steady", "whole"}, default "steady"
        The longest stretch in which the pelvis's speed over a stride stays within 20 % of its median, or all. If
        the steady stretch has fewer than two strides the limit is widened in steps of 10 %, up to the whole clip.
    heading : {"path", "body", None}, default "path"
        What is turned to x: the direction of the path, or the mean direction the pelvis faces. None leaves the walk
        as it is. In place there is no path; there "path" is the direction in which the legs swing.
    treadmill : bool, default True
        Whether the path is taken out.
    normalize_size : bool, default False
        Whether positions are divided by the body's stature, which is then kept in `size`, so that walks of large and
        small people differ in proportions and motion only.
    frequency_range : tuple of float, default (0.3, 2.5)
        Where the stride frequency is looked for, in hertz.

    Returns
    -------
    Walk

    Raises
    ------
    WalkError
        If a marker is missing, a value is not finite, legs are shorter than 0.3 m or longer than 1.3 m, the walk has
        no period, or has less than one stride.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import prepare
    >>> walk = make_walkers(1, treadmill=False, random_state=0).data[0]
    >>> prepared = prepare(walk)
    >>> bool(abs(prepared.marker("pelvis")[:, :2].mean()) < 0.01), bool(prepared.speed > 0.5)
    (True, True)
    """
    check_choice(clip, ("steady", "whole"), name="clip")
    check_choice(heading, ("path", "body", None), name="heading")
    walk = _without_leaps(_as_markers(walk))
    direction = _first_direction(walk)
    if _travels(walk):
        if clip == "steady":
            walk = _steady_part(walk, direction, frequency_range)
        path = _smooth_path(walk, direction, frequency_range)
        direction = path.velocity
        if treadmill:
            walk = _without_path(walk, path)
    else:
        _guess_frequency(walk, direction, frequency_range)  # refuses a walk without a period
        if np.isnan(walk.speed):
            left, right = (_floor(walk, f"{side}_ankle") @ direction for side in ("left", "right"))
            walk = replace(walk, speed=stance_speed(left, right, walk.frame_rate))
    if heading is not None:
        walk = _turn(walk, _facing(walk) if heading == "body" else direction)
    return _to_unit_stature(walk) if normalize_size else walk


def _as_markers(walk: Walk | JointWalk) -> Walk:
    if not isinstance(walk, (Walk, JointWalk)):
        raise TypeError(f"expected a Walk or a JointWalk, got {type(walk).__name__}")
    markers = walk.to_markers() if isinstance(walk, JointWalk) else walk
    missing = [name for name in _NEEDED if name not in markers.marker_set.names]
    if missing:
        raise WalkError(
            f"walk {walk.name!r}: expected the markers {', '.join(_NEEDED)}, but {', '.join(missing)} are missing; "
            f"it has {', '.join(markers.marker_set.names)}"
        )
    check_finite(markers.channels, markers.channel_names, walk=walk.name)
    check_leg_length(markers)
    return markers


def _without_leaps(walk: Walk) -> Walk:
    """Keep the longest run of frames without a leap of the pelvis, and say which frames are left out."""
    steps = np.linalg.norm(np.diff(walk.marker("pelvis"), axis=0), axis=1) * walk.frame_rate
    if not (steps > _JUMP_SPEED).any():
        return walk
    first, last = longest_run(steps <= _JUMP_SPEED)
    warnings.warn(
        f"walk {walk.name!r}: the pelvis leaps at {steps.max():.0f} m/s; kept frames {first} to {last} of "
        f"{walk.n_frames} and left the other {walk.n_frames - 1 - last + first} out",
        stacklevel=3,
    )
    return _cut(walk, slice(first, last + 1))


def _cut(walk: Walk, frames: slice) -> Walk:
    """Keep a stretch of frames, and the events in it."""
    start, end = frames.start / walk.frame_rate, frames.stop / walk.frame_rate
    events = tuple(event._replace(time=event.time - start) for event in walk.events if start <= event.time < end)
    return replace(walk, positions=walk.positions[frames], events=events)


def _floor(walk: Walk, marker: str) -> NDArray[np.floating]:
    return walk.marker(marker)[:, :2]


def _travels(walk: Walk) -> bool:
    pelvis = _floor(walk, "pelvis")
    times = (np.arange(len(pelvis)) - (len(pelvis) - 1) / 2) / walk.frame_rate
    velocity = times @ pelvis / max(times @ times, 1e-12)  # slope of the straight line through the path
    return bool(np.hypot(*velocity) > _TRAVEL_SPEED)


def _leftward(walk: Walk) -> NDArray[np.float64]:
    return (_floor(walk, "left_hip") - _floor(walk, "right_hip")).mean(axis=0)


def _facing(walk: Walk) -> NDArray[np.float64]:
    leftward = _leftward(walk)
    return np.array([leftward[1], -leftward[0]])


def _first_direction(walk: Walk) -> NDArray[np.float64]:
    """Return the unit vector over the floor from start to end, or along which the legs swing in place."""
    if not _travels(walk):
        return swing_direction(_floor(walk, "left_ankle") - _floor(walk, "right_ankle"), _leftward(walk))
    pelvis = _floor(walk, "pelvis")
    return (pelvis[-1] - pelvis[0]) / np.hypot(*(pelvis[-1] - pelvis[0]))


def _turn(walk: Walk, direction: NDArray[np.float64]) -> Walk:
    """Turn a walk about the vertical so that `direction` becomes x."""
    cosine, sine = direction / np.hypot(*direction)
    rotation = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return replace(walk, positions=walk.positions @ rotation.T)


def _guess_frequency(walk: Walk, direction: NDArray[np.float64], frequency_range: tuple[float, float]) -> float:
    difference = (_floor(walk, "left_ankle") - _floor(walk, "right_ankle")) @ direction
    return coarse_frequency(difference, walk.frame_rate, frequency_range=frequency_range, name=walk.name)


def _steady_part(walk: Walk, direction: NDArray[np.float64], frequency_range: tuple[float, float]) -> Walk:
    frequency = _guess_frequency(walk, direction, frequency_range)
    pelvis = _floor(walk, "pelvis")
    for tolerance in np.arange(0.2, 1.0, 0.1):
        frames = steady_stretch(pelvis, walk.frame_rate, frequency, tolerance=tolerance)
        if (frames.stop - frames.start) * frequency / walk.frame_rate >= _ENOUGH_STRIDES:
            return _cut(walk, frames)
    return walk


def _smooth_path(walk: Walk, direction: NDArray[np.float64], frequency_range: tuple[float, float]) -> Path:
    """Return the path of the pelvis.

    It is fitted together with harmonics of a frequency that is found in the walk without its path; the two are
    repeated until they agree.
    """
    frequency, before = _guess_frequency(walk, direction, frequency_range), 0.0
    path = fit_path(_floor(walk, "pelvis"), walk.frame_rate, frequency)
    for _ in range(_MAX_ROUNDS):
        if abs(frequency - before) <= 1e-9 * frequency:
            break
        channels = _without_path(walk, path).channels
        frequency, before = estimate_frequency(channels, walk.frame_rate, start=frequency, precision=1e-6), frequency
        path = fit_path(_floor(walk, "pelvis"), walk.frame_rate, frequency)
    return path


def _without_path(walk: Walk, path: Path) -> Walk:
    """Take the path out of all markers; its mean velocity is the speed of the belt."""
    positions = walk.positions - np.pad(path.points, ((0, 0), (0, 1)))[:, np.newaxis]
    return replace(walk, positions=positions, speed=float(np.hypot(*path.velocity)))


def _to_unit_stature(walk: Walk) -> Walk:
    size = stature(walk)
    return replace(walk, positions=walk.positions / size, size=walk.size * size)


def mirror_walk(walk: Walk) -> Walk:
    """Return the walk seen in a mirror: y changes sign, and left and right markers change places.

    Parameters
    ----------
    walk : Walk
        With markers whose names start with left_ and right_ in pairs.

    Returns
    -------
    Walk
    """
    return replace(walk, positions=walk.positions[:, walk.marker_set.mirror] * np.array([1.0, -1.0, 1.0]))


def prepare_walks(
    walks: Sequence[Walk | JointWalk],
    *,
    n_jobs: int | None = None,
    progress: bool = False,
    on_error: str = "raise",
    **options: Any,
) -> list[Walk]:
    """Return the prepared walks of a list, in its order.

    Parameters
    ----------
    walks : list of Walk or JointWalk
        Recordings.
    n_jobs : int, default None
        Number of parallel jobs; None is one.
    progress : bool, default False
        Whether a progress bar appears when it takes longer than two seconds.
    on_error : {"raise", "skip"}, default "raise"
        Whether refused walks raise one error that lists them all, or are left out with one warning that lists them.
    **options
        Arguments of `prepare`.

    Returns
    -------
    list of Walk

    Raises
    ------
    WalkError
        If walks are refused and `on_error` is "raise"; names each with its reason.
    """
    check_choice(on_error, ("raise", "skip"), name="on_error")
    walks = check_walks(walks, kind=(Walk, JointWalk))
    names = [walk.name or f"walk {position}" for position, walk in enumerate(walks)]
    results, refusals = collect(
        lambda walk: prepare(walk, **options), walks, names, n_jobs=n_jobs, progress=progress, description="prepare"
    )
    report_refusals(refusals, len(walks), on_error=on_error, what="walks")
    return [walk for walk in results if walk is not None]
