"""Feet that stand as they stood before a walk was changed: planting as the difference of two walks."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion._quaternions import rotvecs_between
from eigenwalker.motion.gait_tracking import GaitTrack
from eigenwalker.motion.leg_reach import reach
from eigenwalker.motion.legs import LegPose, Legs, pose_legs
from eigenwalker.motion.planting import Hold, Plan, hold_feet, plan_feet
from eigenwalker.motion.rotations import unroll_rotvec
from eigenwalker.motion.support import find_stances, find_support, smooth_step, standing_points
from eigenwalker.motion.twist import lost_yaw, turn_feet

__all__ = ["plant_as_before"]

_WALKS = 0.5  # share of a walk's swing from which on a stride is added at an end

Array = NDArray[np.float64]


class _Steps(NamedTuple):
    """Where legs are against the root, when their feet are held, what they twist meanwhile, and their plan."""

    pose: LegPose
    holds: list[Hold]
    twist: Array
    plan: Plan


def plant_as_before(
    rotations: NDArray[np.floating],
    before: NDArray[np.floating],
    legs: Legs,
    track: GaitTrack,
    *,
    max_knee: float,
) -> tuple[Array, Array]:
    """Return rotations of a changed walk whose feet stand as they did before, and how its root moves differently.

    Both walks are planted by their feet, see `plan_feet`: where that puts the root of one and of the other differs by
    what the change asks of the root; what the feet of one lack to stand still, and not those of the other, the legs
    reach for. So feet slide, twist and sink as far as they did, and without a change nothing moves at all.

    Parameters
    ----------
    rotations, before : ndarray of shape (n_frames, n_joints, 3)
        Of the changed walk and of the one that it was, upright, in radians.
    legs : Legs
        Of the skeleton.
    track : GaitTrack
        Of the walk: where it leads, and how long a stride is.
    max_knee : float
        See `reach`, in radians.

    Returns
    -------
    rotations : ndarray of shape (n_frames, n_joints, 3)
        Legs apart as given; legs, too, in frames in which nothing is lacking.
    root : ndarray of shape (n_frames, 3)
        To be added to the path of the root, in metres; over the floor it starts with zero.
    """
    stride = min(len(rotations) - 1, round(2 * np.pi / float(np.median(np.diff(track.phase)))))
    walks = tuple(track.share[[0, -1]] > _WALKS)
    found, before, heading = (_with_strides(path, stride, walks) for path in (rotations, before, track.heading))
    frames = slice(stride, stride + len(rotations))
    ahead = np.column_stack((np.cos(heading), np.sin(heading)))
    old, new = (_find_steps(turns, legs, ahead) for turns in (before, found))
    shifts, angles = new.plan.shifts - old.plan.shifts, new.twist - old.twist
    pose = turn_feet(new.pose, angles)
    for foot, hold in enumerate(new.holds):
        lacks = (shifts[:, foot] != 0).any(axis=1) | (angles[:, foot] != 0)
        if lacks.any():
            _reach(found, pose, shifts[:, foot], hold.amount, foot, legs, lacks, max_knee)
    root = (new.plan.root - old.plan.root)[frames]
    return found[frames], root - root[0] * [1.0, 1.0, 0.0]


def _with_strides(path: NDArray[np.floating], stride: int, walks: tuple[bool, ...]) -> Array:
    """Return a path (n_frames, ...) with a stride before the first and one after the last frame.

    A walk that is cut off in the midst of a step says neither where that foot comes down nor where it came from: the
    stride next to that end does, shifted to where the walk ends. A walk that stands there goes on standing.

    Parameters
    ----------
    path : ndarray of shape (n_frames, ...)
        More frames than a stride.
    stride : int
        In frames.
    walks : tuple of bool
        Whether it walks at its start, and at its end.
    """
    path = np.asarray(path, dtype=np.float64)
    first, last = (np.repeat(path[[end]], stride, axis=0) for end in (0, -1))
    near = smooth_step(2 * np.arange(stride) / stride - 1).reshape(-1, *[1] * (path.ndim - 1))
    if walks[0]:
        first = path[:stride] + near * (path[0] - path[stride])
    if walks[1]:
        last = path[-stride:] + near[::-1] * (path[-1] - path[-1 - stride])
    return np.concatenate((first, path, last))


def _find_steps(rotations: NDArray[np.floating], legs: Legs, ahead: Array) -> _Steps:
    """Return how a walk steps that leads in a direction, shape (n_frames, 2)."""
    pose = pose_legs(rotations, np.zeros((len(rotations), 3)), legs)
    difference = ((pose.ankles[:, 0, :2] - pose.ankles[:, 1, :2]) * ahead).sum(axis=1)
    stances, stride = find_stances(difference)
    holds = hold_feet(stances, stride, len(rotations))
    twist = lost_yaw(pose, holds)
    plan = plan_feet(stances, stride, holds, find_support(turn_feet(pose, twist).soles))
    return _Steps(pose, holds, twist, plan)


def _reach(
    rotations: Array,
    pose: LegPose,
    shift: Array,
    amount: Array,
    foot: int,
    legs: Legs,
    lacks: NDArray[np.bool_],
    max_knee: float,
) -> None:
    """Let one leg reach for where its foot is shifted to, in the frames in which it lacks that; in place."""
    _, knee, ankle = legs.chain[foot]
    joints = legs.joints[legs.chain[foot]]
    found = reach(
        rotations[:, joints],
        pose.pelvis[:, foot],
        pose.hips[:, foot],
        legs.offsets[knee],
        legs.offsets[ankle],
        pose.ankles[:, foot] + shift,
        pose.feet[:, foot],
        standing_points(pose.soles)[:, foot] + shift,
        amount,
        np.zeros(len(rotations)),
        max_knee=max_knee,
    )
    changed = {int(joint): found.rotations[:, place] for place, joint in enumerate(joints)}
    toes = legs.sole_joints[foot, 2]
    if toes != ankle:  # they stay as they lie when the foot rolls over them
        changed[int(legs.joints[toes])] = rotvecs_between(found.foot, pose.toes[:, foot])
    for joint, turning in changed.items():
        rotations[:, joint] = unroll_rotvec(np.where(lacks[:, np.newaxis], turning, rotations[:, joint]))
