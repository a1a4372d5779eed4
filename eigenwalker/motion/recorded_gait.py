"""The gait of a whole recording, starts, stops and leaps included: what of it walks, and where in its stride it is."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from eigenwalker.motion.clip import cut, steady_frames, without_leaps
from eigenwalker.motion.fourier import FREQUENCY_RANGE
from eigenwalker.motion.gait_tracking import GaitTrack, track_gait
from eigenwalker.motion.heading import first_direction, travels
from eigenwalker.motion.joint_preparation import prepare_joints
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.rig import Place, Rig
from eigenwalker.motion.walk import JointWalk

__all__ = ["RecordedGait", "find_gait"]


class RecordedGait(NamedTuple):
    """What `find_gait` returns.

    Parameters
    ----------
    whole : JointWalk
        The recording, upright.
    frames : slice
        Its longest run without a leap, such as from a T-pose into the motion.
    prepared : JointWalk
        The steady stretch of these, as `prepare` leaves it.
    track : GaitTrack
        Of these frames.
    goes : bool
        Whether the walk goes over the floor; else it stays in place.
    """

    whole: JointWalk
    frames: slice
    prepared: JointWalk
    track: GaitTrack
    goes: bool


def find_gait(
    walk: JointWalk,
    joints: Sequence[str],
    *,
    phase_reference: str | Mapping[str, float] = "auto",
    rig: Rig | Mapping[str, Place] | None = None,
    heading: str | None = "path",
    frequency_range: tuple[float, float] | None = None,
) -> RecordedGait:
    """Return the gait of a recording.

    Parameters
    ----------
    walk : JointWalk
        Upright, the whole recording.
    joints : sequence of str
        Whose rotations are channels.
    phase_reference : "auto" or mapping of str to float, default "auto"
        See `phase_weights`.
    rig, heading, frequency_range
        See `prepare`.

    Raises
    ------
    WalkError
        As `prepare`.
    """
    walk = replace(walk, channel_joints=tuple(joints))
    frames = _without_leaps(walk, rig)
    core = cut(walk, frames)
    markers = core.to_markers(rig)
    goes, limits = travels(markers), frequency_range or FREQUENCY_RANGE
    steady = steady_frames(markers, first_direction(markers), limits) if goes else slice(0, core.n_frames)
    prepared = prepare_joints(
        cut(core, steady), rig=rig, joints=joints, clip="whole", heading=heading, frequency_range=frequency_range
    )
    step = 2 * np.pi / core.frame_rate * stride_frequency(prepared, phase_reference=phase_reference)
    place = walk.skeleton.root
    pelvis = Rotation.from_rotvec(np.array(core.rotations[:, place]))
    # What `prepare` has taken out is a turn about the vertical.
    turned = pelvis[steady.start] * Rotation.from_rotvec(np.array(prepared.rotations[0, place])).inv()
    faces = pelvis.apply([1.0, 0.0, 0.0])
    track = track_gait(
        core.channels @ phase_weights(core, phase_reference),
        np.unwrap(np.arctan2(faces[:, 1], faces[:, 0])),
        step,
        steady=steady,
        heading=float(turned.as_rotvec()[2]),
    )
    return RecordedGait(walk, frames, prepared, track, goes)


def _without_leaps(walk: JointWalk, rig: Rig | Mapping[str, Place] | None) -> slice:
    """Return the longest run of frames in which nothing leaps; that the others are left out is not said: they stay."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return without_leaps(walk.to_markers(rig))
