"""From recorded joint rotations to a walk in joint angles on a treadmill (Tilmanne & Dutoit 2012, section 2.2)."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import WalkError, check_choice, check_finite, check_names
from eigenwalker.motion.body import check_leg_length, stature
from eigenwalker.motion.cadence import steady_cadence
from eigenwalker.motion.clip import cut, guess_frequency, steady_frames, without_leaps
from eigenwalker.motion.filtering import low_pass, resample
from eigenwalker.motion.fourier import FREQUENCY_RANGE
from eigenwalker.motion.gait import detect_events
from eigenwalker.motion.heading import check_in_place, facing, first_direction, swing, travels, turn, turn_points
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.posture import stand_upright
from eigenwalker.motion.rig import Place, Rig, as_rig
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.rotations import turn_frames
from eigenwalker.motion.strides import stride_frames
from eigenwalker.motion.treadmill import belt_speed, refine_frequency, smooth_path
from eigenwalker.motion.walk import JointWalk, Walk, hip_flexion

__all__ = ["joints_of_all", "moving_joints", "prepare_joints", "scale_body", "turn_walk", "with_rigid_bones"]

_RIGID = 0.02  # metres over which a bone's end may wander and still be taken for a bone
_STILL = 1e-6  # radians over which a joint must turn to have channels


def prepare_joints(
    walk: JointWalk,
    *,
    rig: Rig | Mapping[str, Place] | None = None,
    reference: str | ArrayLike | None = None,
    joints: Sequence[str] | None = None,
    cutoff: float | None = None,
    frame_rate: float | None = None,
    clip: str = "steady",
    frequency: str = "search",
    heading: str | None = "path",
    treadmill: bool = True,
    normalize_size: bool = False,
    cadence: str = "recorded",
    frequency_range: tuple[float, float] | None = None,
) -> JointWalk:
    """Return a walk in joint angles as it would look on a treadmill: ``prepare(walk, representation="joints")``.

    Rotations are counted from the rig's reference posture along the axes of the room, see `stand_upright`; where the
    walk leads is decided from the 15 markers that its skeleton carries, as `prepare` does it. The path and the heading
    are taken out of the root; its sway, and its height over the floor, stay.

    Parameters
    ----------
    walk : JointWalk
        One recording in one direction.
    rig : Rig or dict, default None
        Which joints make each of the 15 markers; None recognises the rigs in `RIGS` by their joint names.
    reference : "zero" or array-like of shape (n_joints, 3), default None
        Another reference posture, see `reference_frames`.
    joints : sequence of str, default None
        Whose rotations become channels. None is those that turn in this walk. It changes nothing else.
    cutoff, frame_rate, clip, frequency, treadmill, normalize_size, cadence, frequency_range
        See `prepare`.
    heading : {"path", "body", None}, default "path"
        See `prepare`.

    Returns
    -------
    JointWalk
        Its skeleton is `upright`, and its bones are rigid.

    Raises
    ------
    WalkError
        As `prepare`; and if joints other than the root wander by more than 2 cm against their parent.

    Warns
    -----
    UserWarning
        If such joints wander by less: their mean is taken.
    """
    check_choice(clip, ("steady", "whole"), name="clip")
    check_choice(frequency, ("search", "events"), name="frequency")
    check_choice(heading, ("path", "body", None), name="heading")
    check_choice(cadence, ("recorded", "steady"), name="cadence")
    limits = FREQUENCY_RANGE if frequency_range is None else frequency_range
    walk = replace(walk, channel_joints=None)
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    check_finite(walk.root, [f"root {axis}" for axis in "xyz"], walk=walk.name)
    walk = with_rigid_bones(stand_upright(walk, rig=rig, reference=reference))
    chosen = moving_joints([walk]) if joints is None else walk.skeleton.in_order(check_names(joints, name="joints"))
    check_leg_length(walk.to_markers(rig))
    walk = cut(walk, without_leaps(walk.to_markers(rig)))
    walk = walk if cutoff is None else low_pass(walk, cutoff=cutoff)
    walk = walk if frame_rate is None else resample(walk, frame_rate=frame_rate)
    markers = walk.to_markers(rig)
    direction = first_direction(markers)
    if clip == "steady" and travels(markers):
        walk, markers = _cut_both(walk, markers, steady_frames(markers, direction, limits))
    if frequency == "events":
        ahead = turn(markers, direction)
        frames, counted = stride_frames(ahead)
        walk = replace(walk, frequency=counted, events=detect_events(ahead).events)
        walk, markers = _cut_both(walk, replace(markers, frequency=counted), frames)
    walk = _to_heading(walk, markers, heading, direction, treadmill, limits)
    walk = _to_unit_stature(walk, rig) if normalize_size else walk
    if frequency_range is None and cadence == "recorded":
        return replace(walk, channel_joints=chosen)
    flexion = hip_flexion(find_rig(walk.skeleton.joint_names) if rig is None else as_rig(rig))
    known = replace(walk, frequency=stride_frequency(walk, phase_reference=flexion, frequency_range=limits))
    if cadence == "steady":
        check_in_place(walk.to_markers(rig))
        known = steady_cadence(known, phase_reference=flexion)
    found = np.nan if frequency_range is None and np.isnan(walk.frequency) else known.frequency
    return replace(known, frequency=found, channel_joints=chosen)


def moving_joints(walks: Sequence[JointWalk]) -> tuple[str, ...]:
    """Return the joints that turn by more than 1e-6 radians in at least one of some walks, in the first one's order."""
    turning: set[str] = set()
    for walk in walks:
        ranges = np.ptp(walk.rotations, axis=0).max(axis=1)
        turning |= {name for name, reach in zip(walk.skeleton.joint_names, ranges, strict=True) if reach > _STILL}
    return tuple(name for name in walks[0].skeleton.joint_names if name in turning)


def joints_of_all(walks: Sequence[object]) -> tuple[str, ...] | None:
    """Return the joints that turn in any of some walks, None where their skeletons have different joints."""
    turned = [walk for walk in walks if isinstance(walk, JointWalk)]
    same = len(turned) == len(walks) and len({walk.skeleton.joint_names for walk in turned}) == 1
    return moving_joints(turned) if same else None


def with_rigid_bones(walk: JointWalk) -> JointWalk:
    """Return a walk in which only the root moves against its parent, or raise where bones change by centimetres."""
    if not walk.translations:
        return walk
    reach = {joint: float(np.ptp(path, axis=0).max()) for joint, path in walk.translations.items()}
    loose = {joint: length for joint, length in reach.items() if not length <= _RIGID}
    if loose:
        listed = ", ".join(f"{joint} {length:.2g} m" for joint, length in loose.items())
        raise WalkError(
            f"walk {walk.name!r}: expected bones of constant length, but joints wander against their parents by "
            f"{listed}, more than {_RIGID} m; take positions of markers, representation='markers', or export the file "
            "without position channels on these joints"
        )
    warnings.warn(
        f"walk {walk.name!r}: {', '.join(reach)} move by up to {max(reach.values()):.2g} m against their parents; "
        "their mean offsets are taken",
        stacklevel=3,
    )
    offsets = np.array(walk.skeleton.offsets)
    for joint, path in walk.translations.items():
        offsets[walk.skeleton.index(joint)] = path.mean(axis=0)
    return replace(walk, skeleton=replace(walk.skeleton, offsets=offsets), translations={})


def _cut_both(walk: JointWalk, markers: Walk, frames: slice) -> tuple[JointWalk, Walk]:
    return cut(walk, frames), cut(markers, frames)


def _to_heading(
    walk: JointWalk,
    markers: Walk,
    heading: str | None,
    direction: NDArray[np.float64],
    treadmill: bool,
    frequency_range: tuple[float, float],
) -> JointWalk:
    """Take the path of a walk that travels out of its root, and turn what is ahead to x."""
    guess = guess_frequency(markers, direction, frequency_range)
    if travels(markers):
        path, stride = smooth_path(markers, guess)
        direction = path.velocity
        if treadmill:
            speed = walk.size * float(np.hypot(*path.velocity))
            walk = replace(walk, root=walk.root - np.pad(path.points, ((0, 0), (0, 1))), speed=speed)
    else:
        stride = refine_frequency(markers, guess)
        direction = swing(markers, stride)
        walk = replace(walk, speed=belt_speed(markers, direction))
    if heading is None:
        return walk
    return turn_walk(walk, facing(markers, stride) if heading == "body" else direction)


def turn_walk(walk: JointWalk, direction: NDArray[np.float64]) -> JointWalk:
    """Turn an upright walk about the vertical so that a direction over the floor, shape (2,), becomes x."""
    cosine, sine = direction / np.hypot(*direction)
    ahead = np.array([[[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]]])
    place = walk.skeleton.root
    rotations = np.array(walk.rotations)
    rotations[:, [place]] = turn_frames(rotations[:, [place]], ahead, np.eye(3)[np.newaxis])
    above = walk.skeleton.offsets[walk.skeleton.above(place), :2].sum(axis=0)  # upright: no turn lies between
    floor = turn_points(walk.root[:, :2] + above, direction[np.newaxis]) - above
    root = np.column_stack((floor, walk.root[:, 2]))
    return replace(walk, rotations=rotations, root=root)


def _to_unit_stature(walk: JointWalk, rig: Rig | Mapping[str, Place] | None) -> JointWalk:
    size = stature(walk.to_markers(rig))
    return replace(scale_body(walk, 1 / size), size=walk.size * size)


def scale_body(walk: JointWalk, factor: float) -> JointWalk:
    """Return a walk in which the bones and the path of the root are longer by a factor."""
    skeleton = walk.skeleton
    body = replace(skeleton, offsets=skeleton.offsets * factor, end_offsets=skeleton.end_offsets * factor)
    return replace(walk, skeleton=body, root=walk.root * factor)
