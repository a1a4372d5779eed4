"""From a recording to a walk in the treadmill frame."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import check_choice, check_finite, check_walks
from eigenwalker.motion.body import check_leg_length, stature
from eigenwalker.motion.cadence import steady_cadence
from eigenwalker.motion.clip import cut, guess_frequency, steady_frames, whole_frames, without_leaps
from eigenwalker.motion.filtering import low_pass, resample
from eigenwalker.motion.fourier import FREQUENCY_RANGE
from eigenwalker.motion.gaps import fill_gaps
from eigenwalker.motion.heading import (
    facing,
    first_direction,
    floor_points,
    one_stride,
    swing,
    travels,
    turn,
)
from eigenwalker.motion.joint_preparation import joints_of_all, prepare_joints
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.rig import Place, Rig
from eigenwalker.motion.strides import cut_to_strides
from eigenwalker.motion.symmetry import symmetrize_walk
from eigenwalker.motion.treadmill import belt_speed, refine_frequency, smooth_path, straighten, without_path
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["prepare", "prepare_walks"]

_NEEDED = ("pelvis", "left_hip", "right_hip", "left_ankle", "right_ankle")


def prepare(
    walk: Walk | JointWalk,
    *,
    representation: str = "markers",
    rig: Rig | Mapping[str, Place] | None = None,
    reference: str | ArrayLike | None = None,
    joints: Sequence[str] | None = None,
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
) -> Any:
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
    representation : {"markers", "joints"}, default "markers"
        "joints" keeps a joint walk one of joint rotations (Tilmanne & Dutoit 2012): limbs keep their length, and the
        size of the body is no part of the style. See `prepare_joints`; gaps, a moving camera, ``heading="curve"`` and
        `symmetrize` are for markers only.
    rig : Rig or dict, default None
        Which joints or markers make each of the 15; see `Walk.to_markers`. None recognises them by their names.
    reference : "zero" or array-like of shape (n_joints, 3), default None
        For joints: the posture from which rotations are counted, see `reference_frames`. None is the rig's.
    joints : sequence of str, default None
        For joints: whose rotations become channels. None is those that turn in this walk.
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
    Walk or JointWalk
        A JointWalk for "joints", else a Walk.

    Raises
    ------
    TypeError
        If "joints" is asked for and the walk has markers.
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
    check_choice(representation, ("markers", "joints"), name="representation")
    if representation == "joints":
        return prepare_joints(
            _check_for_joints(walk, max_gap=max_gap, camera=camera, heading=heading, symmetrize=symmetrize),
            rig=rig,
            reference=reference,
            joints=joints,
            cutoff=cutoff,
            frame_rate=frame_rate,
            clip=clip,
            frequency=frequency,
            heading=heading,
            treadmill=treadmill,
            normalize_size=normalize_size,
            cadence=cadence,
            frequency_range=frequency_range,
        )
    _check_for_markers(reference=reference, joints=joints)
    check_choice(camera, ("still", "moving"), name="camera")
    check_choice(clip, ("steady", "whole"), name="clip")
    check_choice(frequency, ("search", "events"), name="frequency")
    check_choice(heading, ("path", "curve", "body", None), name="heading")
    check_choice(cadence, ("recorded", "steady"), name="cadence")
    limits = FREQUENCY_RANGE if frequency_range is None else frequency_range
    walk = _as_markers(walk, rig, max_gap)
    walk = cut(walk, whole_frames(walk))
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    walk = cut(walk, without_leaps(walk)) if camera == "still" else _around_pelvis(walk)
    walk = walk if cutoff is None else low_pass(walk, cutoff=cutoff)
    walk = walk if frame_rate is None else resample(walk, frame_rate=frame_rate)
    direction = first_direction(walk)
    if clip == "steady" and travels(walk):
        walk = cut(walk, steady_frames(walk, direction, limits))
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


def _check_for_joints(
    walk: Walk | JointWalk, *, max_gap: float | None, camera: str, heading: str | None, symmetrize: bool
) -> JointWalk:
    """Return a joint walk, or raise if it cannot be prepared in the way that is asked for."""
    if not isinstance(walk, JointWalk):
        raise TypeError(
            f"representation='joints' needs a JointWalk, as BVH and AMC files hold, got {type(walk).__name__}; markers "
            "do not say how joints turn"
        )
    asked = {
        "max_gap": max_gap is not None,
        "camera='moving'": camera != "still",
        "heading='curve'": heading == "curve",
        "symmetrize=True": symmetrize,
    }
    wrong = [name for name, given in asked.items() if given]
    if wrong:
        raise ValueError(f"{', '.join(wrong)} can be asked for with representation='markers' only")
    return walk


def _check_for_markers(**options: object) -> None:
    wrong = [name for name, value in options.items() if value is not None]
    if wrong:
        raise ValueError(f"{' and '.join(wrong)} can be given with representation='joints' only")


def _as_markers(walk: Walk | JointWalk, rig: Rig | Mapping[str, Place] | None, max_gap: float | None) -> Walk:
    """Return a walk of markers that has those needed; gaps are filled while all recorded markers are there to help."""
    if isinstance(walk, JointWalk):
        markers = walk.to_markers(rig)
    elif isinstance(walk, Walk):
        filled = walk if max_gap is None else fill_gaps(walk, max_gap=max_gap)
        known = rig is None and set(_NEEDED) <= set(walk.marker_set.names)
        markers = filled if known else filled.to_markers(rig)
    else:
        raise TypeError(f"expected a Walk or a JointWalk, got {type(walk).__name__}")
    check_leg_length(markers)
    return markers


def _around_pelvis(walk: Walk) -> Walk:
    """Count x and y from the pelvis, frame by frame."""
    origin = np.column_stack((floor_points(walk, "pelvis"), np.zeros(walk.n_frames)))
    return replace(walk, positions=walk.positions - origin[:, np.newaxis])


def _above_ankles(walk: Walk, frequency: float) -> Walk:
    """Count z from the mean height of the ankles over a stride."""
    heights = np.column_stack([walk.marker(f"{side}_ankle")[:, 2] for side in ("left", "right")])
    mean = one_stride(heights, walk.frame_rate, frequency).mean()
    return replace(walk, positions=walk.positions - np.array([0.0, 0.0, mean]))


def _frequency_in_place(walk: Walk, direction: NDArray[np.float64], frequency_range: tuple[float, float]) -> float:
    """Return the stride frequency of a walk that stays in place, whichever way it leads."""
    return refine_frequency(walk, guess_frequency(walk, direction, frequency_range))


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
        walk = replace(walk, speed=belt_speed(walk, direction))
    elif heading == "curve":
        return straighten(walk, guess_frequency(walk, direction, frequency_range), treadmill=treadmill)
    else:
        path, stride = smooth_path(walk, guess_frequency(walk, direction, frequency_range))
        direction = path.velocity
        walk = without_path(walk, path.points) if treadmill else walk
    if heading is None:
        return walk
    return turn(walk, facing(walk, stride) if heading == "body" else direction)


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
) -> list[Any]:
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
        Arguments of `prepare`. With ``representation="joints"`` all walks get the channels of the joints that turn in
        any of them, unless `joints` says which.

    Returns
    -------
    list of Walk or JointWalk

    Raises
    ------
    WalkError
        If walks are refused and `on_error` is "raise"; names each with its reason.
    """
    check_choice(on_error, ("raise", "skip"), name="on_error")
    walks = check_walks(walks, kind=(Walk, JointWalk))
    names = [walk.name or f"walk {position}" for position, walk in enumerate(walks)]
    if options.get("representation") == "joints" and options.get("joints") is None:
        options["joints"] = joints_of_all(walks)
    results, refusals = collect(
        lambda walk: prepare(walk, **options), walks, names, n_jobs=n_jobs, progress=progress, description="prepare"
    )
    report_refusals(refusals, len(walks), on_error=on_error, what="walks")
    return [walk for walk in results if walk is not None]
