"""From a recording to a walk in the treadmill frame."""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import check_choice, check_finite, check_walks
from eigenwalker.motion.body import check_leg_length, stature
from eigenwalker.motion.cadence import steady_cadence
from eigenwalker.motion.filtering import low_pass, resample
from eigenwalker.motion.fourier import FREQUENCY_RANGE, coarse_frequency
from eigenwalker.motion.gaps import fill_gaps
from eigenwalker.motion.heading import (
    facing,
    first_direction,
    floor_points,
    leg_difference,
    one_stride,
    swing,
    travels,
    turn,
)
from eigenwalker.motion.passes import cut
from eigenwalker.motion.path import stance_speed, steady_stretch
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.runs import longest_run
from eigenwalker.motion.strides import cut_to_strides
from eigenwalker.motion.symmetry import symmetrize_walk
from eigenwalker.motion.treadmill import refine_frequency, smooth_path, straighten, without_path
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["prepare", "prepare_walks"]

_NEEDED = ("pelvis", "left_hip", "right_hip", "left_ankle", "right_ankle")
_JUMP_SPEED = 15.0  # m/s of the pelvis between two frames; no body moves like that
_ENOUGH_STRIDES = 2.0  # a steady part with fewer is widened


def prepare(
    walk: Walk | JointWalk,
    *,
    max_gap: float | None = None,
    cutoff: float | None = None,
    frame_rate: float | None = None,
    camera: str = "still",
    clip: str = "steady",
    frequency: str = "search",
    heading: str | None = "path",
    treadmill: bool = True,
    normalize_size: bool = False,
    cadence: str = "recorded",
    symmetrize: bool = False,
    frequency_range: tuple[float, float] | None = None,
) -> Walk:
    """Return a walk as it would look on a treadmill, ready for the Fourier model.

    Joint walks and known sets of markers become walks of the 15 markers. Frames at both ends in which a marker is
    missing, and frames before or after a leap of the whole body (frames of zeros at the start of a file), are left out
    with a warning. Then, for a walk that travels: the
    steady part is cut out; the walk is turned so that it leads along x; and the path of the pelvis, a polynomial in
    time of x and y, fitted together with 4 harmonics of the stride, is taken out of all markers. Its mean velocity
    becomes `speed`. Height over the floor, z, stays as recorded.

    A walk that stays in place keeps its frames and its place. Its `speed` is what the walk says, else estimated
    from the stance feet.

    Steps that are off unless asked for are functions of their own, too: `fill_gaps`, `low_pass`, `resample`,
    `cut_to_strides`, `steady_cadence`, `symmetrize_walk`. The last two erase what a clinician looks for. Recordings
    with turns go through `split_passes` first.

    Parameters
    ----------
    walk : Walk or JointWalk
        One recording in one direction, with the markers pelvis, left and right hip and ankle.
    max_gap : float, default None
        Longest gap that is filled, in seconds; see `fill_gaps`. None fills none, and a walk with gaps is refused.
    cutoff : float, default None
        Of the low-pass, in hertz; see `low_pass`. None is no low-pass.
    frame_rate : float, default None
        Frames per second of the result; see `resample`. None keeps that of the walk.
    camera : {"still", "moving"}, default "still"
        Whether positions count from a fixed place. With a camera that follows the walker nothing is known about the
        path and the floor: the pelvis's x and y are taken out frame by frame, z counts from the mean height of the
        ankles, `speed` is estimated from the stance feet, and "path" is the direction in which the legs swing.
    clip : {"steady", "whole"}, default "steady"
        The longest stretch in which the pelvis's speed over a stride stays within 20 % of its median, or all. If
        the steady stretch has fewer than two strides the limit is widened in steps of 10 %, up to the whole clip.
    frequency : {"search", "events"}, default "search"
        "events" cuts the walk to the strides between events of one foot and counts them, see `cut_to_strides`; one
        stride is enough then. "search" leaves the frequency to be found in the motion.
    heading : {"path", "curve", "body", None}, default "path"
        What is turned to x: the direction of the path; its direction at each moment, which straightens a gentle curve
        (within a millimeter for one radian on eight strides; fewer strides give the path fewer bends); or the mean
        direction the pelvis faces. None leaves the walk as it is. In place there is no path; there "path" and "curve"
        are the direction in which the legs swing.
    treadmill : bool, default True
        Whether the path is taken out.
    normalize_size : bool, default False
        Whether positions are divided by the body's stature, which is then kept in `size`, so that walks of large and
        small people differ in proportions and motion only.
    cadence : {"recorded", "steady"}, default "recorded"
        "steady" takes drift of the cadence out, see `steady_cadence`.
    symmetrize : bool, default False
        Whether the walk becomes the mean of itself and its mirror image; see `symmetrize_walk`.
    frequency_range : tuple of float, default None
        Where the stride frequency is looked for, in hertz. None is 0.3 to 2.5. A range that is given is for walks of
        which more is known: the frequency found in it then stays with the walk, so that nothing later finds another.

    Returns
    -------
    Walk

    Raises
    ------
    WalkError
        If a marker is missing, a value is not finite, legs are shorter than 0.3 m or longer than 1.3 m, the walk has
        no period, or has less than one stride. With "events" also if no foot strikes or leaves the floor twice, with
        "curve" if the path nearly stops, and if "steady" or `symmetrize` is asked for while the walk still travels.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import prepare
    >>> walk = make_walkers(1, treadmill=False, random_state=0).data[0]
    >>> prepared = prepare(walk)
    >>> bool(abs(prepared.marker("pelvis")[:, :2].mean()) < 0.01), bool(prepared.speed > 0.5)
    (True, True)
    """
    check_choice(camera, ("still", "moving"), name="camera")
    check_choice(clip, ("steady", "whole"), name="clip")
    check_choice(frequency, ("search", "events"), name="frequency")
    check_choice(heading, ("path", "curve", "body", None), name="heading")
    check_choice(cadence, ("recorded", "steady"), name="cadence")
    limits = FREQUENCY_RANGE if frequency_range is None else frequency_range
    walk = _without_empty_ends(_as_markers(walk, max_gap))
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    walk = _without_leaps(walk) if camera == "still" else _around_pelvis(walk)
    walk = walk if cutoff is None else low_pass(walk, cutoff=cutoff)
    walk = walk if frame_rate is None else resample(walk, frame_rate=frame_rate)
    direction = first_direction(walk)
    if clip == "steady" and travels(walk):
        walk = _steady_part(walk, direction, limits)
    if frequency == "events":
        walk = _whole_strides(walk, direction)
    if camera == "moving":
        walk = _above_ankles(walk, _frequency_in_place(walk, direction, limits))
    walk = _to_heading(walk, heading, direction, treadmill, limits)
    walk = _to_unit_stature(walk) if normalize_size else walk
    if frequency_range is None and cadence == "recorded" and not symmetrize:
        return walk
    known = replace(walk, frequency=stride_frequency(walk, frequency_range=limits))
    varied = _without_variation(known, steady=cadence == "steady", symmetrize=symmetrize)
    return replace(varied, frequency=np.nan) if frequency_range is None and np.isnan(walk.frequency) else varied


def _as_markers(walk: Walk | JointWalk, max_gap: float | None) -> Walk:
    """Return a walk of markers that has those needed; gaps are filled while all recorded markers are there to help."""
    if isinstance(walk, JointWalk):
        markers = walk.to_markers()
    elif isinstance(walk, Walk):
        filled = walk if max_gap is None else fill_gaps(walk, max_gap=max_gap)
        markers = filled if set(_NEEDED) <= set(walk.marker_set.names) else filled.to_markers()
    else:
        raise TypeError(f"expected a Walk or a JointWalk, got {type(walk).__name__}")
    check_leg_length(markers)
    return markers


def _without_empty_ends(walk: Walk) -> Walk:
    """Keep the frames from the first to the last one that has all markers, and say how many are left out."""
    whole = np.flatnonzero(np.isfinite(walk.channels).all(axis=1))
    if not whole.size or whole[-1] - whole[0] + 1 == walk.n_frames:
        return walk
    warnings.warn(
        f"walk {walk.name!r}: not all markers were seen yet, or any more; kept frames {whole[0]} to {whole[-1]} of "
        f"{walk.n_frames} and left the other {walk.n_frames - 1 - whole[-1] + whole[0]} out",
        stacklevel=3,
    )
    return cut(walk, slice(whole[0], whole[-1] + 1))


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
    return cut(walk, slice(first, last + 1))


def _around_pelvis(walk: Walk) -> Walk:
    """Count x and y from the pelvis, frame by frame."""
    origin = np.column_stack((floor_points(walk, "pelvis"), np.zeros(walk.n_frames)))
    return replace(walk, positions=walk.positions - origin[:, np.newaxis])


def _above_ankles(walk: Walk, frequency: float) -> Walk:
    """Count z from the mean height of the ankles over a stride."""
    heights = np.column_stack([walk.marker(f"{side}_ankle")[:, 2] for side in ("left", "right")])
    mean = one_stride(heights, walk.frame_rate, frequency).mean()
    return replace(walk, positions=walk.positions - np.array([0.0, 0.0, mean]))


def _guess_frequency(walk: Walk, direction: NDArray[np.float64], frequency_range: tuple[float, float]) -> float:
    if not np.isnan(walk.frequency):
        return walk.frequency
    difference = leg_difference(walk) @ direction
    return coarse_frequency(difference, walk.frame_rate, frequency_range=frequency_range, name=walk.name)


def _frequency_in_place(walk: Walk, direction: NDArray[np.float64], frequency_range: tuple[float, float]) -> float:
    """Return the stride frequency of a walk that stays in place, whichever way it leads."""
    return refine_frequency(walk, _guess_frequency(walk, direction, frequency_range))


def _steady_part(walk: Walk, direction: NDArray[np.float64], frequency_range: tuple[float, float]) -> Walk:
    frequency = _guess_frequency(walk, direction, frequency_range)
    pelvis = floor_points(walk, "pelvis")
    for tolerance in np.arange(0.2, 1.0, 0.1):
        frames = steady_stretch(pelvis, walk.frame_rate, frequency, tolerance=tolerance)
        if (frames.stop - frames.start) * frequency / walk.frame_rate >= _ENOUGH_STRIDES:
            return cut(walk, frames)
    return walk


def _whole_strides(walk: Walk, direction: NDArray[np.float64]) -> Walk:
    """Cut a walk that leads along `direction` from strike to strike, and leave its axes as they are."""
    return turn(cut_to_strides(turn(walk, direction)), direction * [1.0, -1.0])


def _to_heading(
    walk: Walk,
    heading: str | None,
    direction: NDArray[np.float64],
    treadmill: bool,
    frequency_range: tuple[float, float],
) -> Walk:
    """Take the path of a walk that travels out, and turn what is ahead to x."""
    if not travels(walk):
        stride = _frequency_in_place(walk, direction, frequency_range)
        direction = swing(walk, stride)
        walk = _with_belt(walk, direction)
    elif heading == "curve":
        return straighten(walk, _guess_frequency(walk, direction, frequency_range), treadmill=treadmill)
    else:
        path, stride = smooth_path(walk, _guess_frequency(walk, direction, frequency_range))
        direction = path.velocity
        walk = without_path(walk, path.points) if treadmill else walk
    if heading is None:
        return walk
    return turn(walk, facing(walk, stride) if heading == "body" else direction)


def _with_belt(walk: Walk, direction: NDArray[np.float64]) -> Walk:
    """Estimate the speed of the belt where it is unknown."""
    if not np.isnan(walk.speed):
        return walk
    left, right = (floor_points(walk, f"{side}_ankle") @ direction for side in ("left", "right"))
    return replace(walk, speed=walk.size * stance_speed(left, right, walk.frame_rate))


def _to_unit_stature(walk: Walk) -> Walk:
    size = stature(walk)
    return replace(walk, positions=walk.positions / size, size=walk.size * size)


def _without_variation(walk: Walk, *, steady: bool, symmetrize: bool) -> Walk:
    """Take drift of the cadence and differences between left and right out of a walk of known frequency."""
    walk = steady_cadence(walk) if steady else walk
    return symmetrize_walk(walk) if symmetrize else walk


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
