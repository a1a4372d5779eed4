"""Feet on the floor: root motion from the standing foot, and legs that reach for where the feet stand."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from eigenwalker._validation import WalkError, check_finite
from eigenwalker.motion._quaternions import rotvecs_between
from eigenwalker.motion.leg_reach import reach
from eigenwalker.motion.legs import LegPose, Legs, find_legs, pose_legs
from eigenwalker.motion.planting import Plan, hold_feet, plan_feet
from eigenwalker.motion.rig import Place, Rig
from eigenwalker.motion.rotations import unroll_rotvec
from eigenwalker.motion.support import find_stances, find_support, standing_points
from eigenwalker.motion.twist import turn_left, untwist_feet
from eigenwalker.motion.walk import JointWalk
from eigenwalker.motion.way import Way, find_way

__all__ = ["MAX_KNEE", "plant_feet", "plant_on_way"]

MAX_KNEE = 15.0  # degrees


def plant_feet(
    walk: JointWalk,
    *,
    travel: bool = True,
    heading: float = 0.0,
    curvature: float = 0.0,
    path: ArrayLike | None = None,
    speed: float | None = None,
    hold: bool = True,
    max_knee: float = MAX_KNEE,
    rig: Rig | Mapping[str, Place] | None = None,
) -> JointWalk:
    """Return a walk that goes over the floor as its legs say, with feet that do not slide.

    Which foot stands is found from the gait: the one that goes back against the body (`find_support`). The root is
    moved so that the sole of that foot, which rolls from heel to toes, stays where it is; around a hand-over of the
    weight it follows both feet in turn, so that nothing jumps. Both feet are then held through double support: hip,
    knee and ankle of each leg reach for where the foot stands (`reach`). What the walk itself says of the path of its
    root is not used.

    Parameters
    ----------
    walk : JointWalk
        Upright and leading along x: from `prepare` with ``representation="joints"``, or made by a model of such walks.
    travel : bool, default True
        Whether the walk goes over the floor. Else it stays in place on a treadmill whose `speed` is known.
    heading : float, default 0.0
        In which direction it leads at first, in radians to the left of x.
    curvature : float, default 0.0
        Of its path, in 1/m; positive turns to the left. A circle of 4 m in radius has 0.25.
    path : array-like of shape (n_points, 2), default None
        Points over the floor, in metres, that the path leads through smoothly, and on straight beyond the last one;
        in place of `heading` and `curvature`.
    speed : float, default None
        How fast it goes, in m/s. None is the `speed` of the walk, which `prepare` finds in a recording; NaN is unknown,
        then it goes as its legs say. Legs reach for up to 3 % more or less than they say: a walk that would have to
        change more goes as near to its speed as that. Without `hold` it always goes as its legs say.
    hold : bool, default True
        Whether legs reach. Else only the root is moved: rotations stay what they are, and the feet slide a few
        centimetres while they hand over.
    max_knee : float, default 15.0
        By how many degrees a knee may bend or stretch for it. A foot that stands rolls up or down for what is left,
        by 20 degrees at most.
    rig : Rig or dict, default None
        Which joints are hips, knees and ankles; None recognises the rigs in `RIGS` by their joint names.

    Returns
    -------
    JointWalk
        The floor is z = 0. Its `speed` is that of the belt for a walk in place, else NaN.

    Raises
    ------
    WalkError
        If there are fewer than three frames, or values that are not finite.
    ValueError
        If the skeleton is not upright, no rig is recognised, or a path is given together with heading or curvature,
        or has fewer than two different points.

    Examples
    --------
    >>> from eigenwalker import prepare, read_walk
    >>> from eigenwalker.motion import plant_feet
    >>> walk = read_walk("dataset-2_walk_normal_001.bvh")  # doctest: +SKIP
    >>> treadmill = prepare(walk, representation="joints")  # doctest: +SKIP
    >>> round_a_circle = plant_feet(treadmill, curvature=0.25)  # doctest: +SKIP
    """
    if not isinstance(walk, JointWalk):
        raise TypeError(f"expected a JointWalk, whose feet have soles, got {type(walk).__name__}")
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    if not travel and (curvature or path is not None):
        raise ValueError("travel=False keeps the walk in place: it has no curvature and no path")
    way = find_way(heading=heading, curvature=curvature, path=path)
    legs = find_legs(walk.skeleton, rig)
    planted, advance = plant_on_way(walk, way, legs, speed=speed, hold=hold, max_knee=max_knee)
    return planted if travel else _in_place(planted, advance, heading)


def plant_on_way(
    walk: JointWalk,
    way: Way,
    legs: Legs,
    *,
    keep: slice | None = None,
    speed: float | None = None,
    hold: bool = True,
    max_knee: float = MAX_KNEE,
) -> tuple[JointWalk, float]:
    """Return some frames of a walk planted on a way, and its mean advance in metres a frame; see `plant_feet`.

    Parameters
    ----------
    walk : JointWalk
        Upright.
    way : Way
        It starts in the first frame that is kept.
    legs : Legs
        Of the skeleton.
    keep : slice, default None
        Those before and after say where the feet come from and go to. None keeps all.
    speed, hold, max_knee
        See `plant_feet`.
    """
    if walk.n_frames < 3:
        raise WalkError(f"walk {walk.name!r}: expected at least 3 frames, got {walk.n_frames}")
    if not np.isfinite(max_knee) or max_knee < 0:
        raise ValueError(f"max_knee must be finite and not negative, in degrees, got {max_knee!r}")
    if speed is not None and (speed <= 0 or np.isinf(speed)):
        raise ValueError(f"speed must be positive and finite, in m/s, or NaN where it is unknown, got {speed!r}")
    top = np.asarray(walk.skeleton.offsets[walk.skeleton.above(walk.skeleton.root)], dtype=np.float64).sum(axis=0)
    pose = pose_legs(walk.rotations, np.tile(-top, (walk.n_frames, 1)), legs)  # with the root at the origin
    stances, stride = find_stances(pose.ankles[:, 0, 0] - pose.ankles[:, 1, 0])
    holds = hold_feet(stances, stride, walk.n_frames) if hold else []
    pose = untwist_feet(pose, holds) if hold else pose
    wanted = (walk.speed if speed is None else speed) / (walk.size * walk.frame_rate)
    plan = plan_feet(stances, stride, holds, find_support(pose.soles), frame_rate=walk.frame_rate, speed=wanted)
    frames = slice(0, walk.n_frames) if keep is None else keep
    start = plan.root[frames.start] * [1.0, 1.0, 0.0]
    plan = plan._replace(
        root=plan.root[frames] - start, shifts=plan.shifts[frames], anchors=plan.anchors[frames] - start[0]
    )
    rotations = np.array(walk.rotations[frames], dtype=np.float64)
    pose = LegPose(*(part[frames] for part in pose))
    root = _place(rotations, pose, plan, way, legs, [hold.amount[frames] for hold in holds], np.deg2rad(max_knee))
    rotations.flags.writeable = False  # else the walk keeps a copy
    new: dict[str, Any] = {"rotations": rotations, "root": root - top, "translations": {}, "events": ()}
    return replace(walk, **new, speed=float("nan")), plan.speed


class _Goal(NamedTuple):
    """Where one leg should go; arguments of `reach`, and the axes of the toes."""

    ankle: NDArray[np.float64]
    foot: NDArray[np.float64]
    toes: NDArray[np.float64]
    pivot: NDArray[np.float64]
    swivel: NDArray[np.float64]


def _place(
    rotations: NDArray[np.float64],
    pose: LegPose,
    plan: Plan,
    way: Way,
    legs: Legs,
    amounts: list[NDArray[np.float64]],
    max_knee: float,
) -> NDArray[np.float64]:
    """Turn rotations along their way, and let the legs reach as far as their feet are held, in place; return the root.

    Rotations, shape (n_frames, n_joints, 3), are those of all joints.
    """
    root, angles = way.bend(plan.root, plan.root[:, 0])
    if angles.any():
        place = legs.joints[legs.root]
        turned = Rotation.from_rotvec(np.outer(angles, [0.0, 0.0, 1.0])) * Rotation.from_rotvec(rotations[:, place])
        rotations[:, place] = unroll_rotvec(turned.as_rotvec())
    goals = _goals(pose, plan, way, angles) if amounts else ()
    for foot, (amount, goal) in enumerate(zip(amounts, goals, strict=True)):
        _, knee, ankle = legs.chain[foot]
        joints = legs.joints[legs.chain[foot]]
        found = reach(
            rotations.take(joints, axis=1),
            turn_left(pose.pelvis[:, foot], angles),
            turn_left(pose.hips[:, foot], angles) + root,
            legs.offsets[knee],
            legs.offsets[ankle],
            goal.ankle,
            goal.foot,
            goal.pivot,
            amount,
            goal.swivel,
            max_knee=max_knee,
        )
        for joint, turning in zip(joints, found.rotations.swapaxes(0, 1), strict=True):
            rotations[:, joint] = turning
        toes = legs.sole_joints[foot, 2]
        if toes != ankle:  # they stay as they lie when the foot rolls over them
            rotations[:, legs.joints[toes]] = rotvecs_between(found.foot, goal.toes)
    return root


def _goals(pose: LegPose, plan: Plan, way: Way, angles: NDArray[np.float64]) -> list[_Goal]:
    """Return where the feet should be on the way: they turn with the path while they swing, not while they stand."""
    points, goals = standing_points(pose.soles), []
    for foot in (0, 1):
        shift = plan.root + plan.shifts[:, foot]
        ankle, turning = way.bend(pose.ankles[:, foot] + shift, plan.anchors[:, foot])
        pivot, _ = way.bend(points[:, foot] + shift, plan.anchors[:, foot])
        feet, toes = (turn_left(part[:, foot], turning) for part in (pose.feet, pose.toes))
        goals.append(_Goal(ankle, feet, toes, pivot, turning - angles))
    return goals


def _in_place(walk: JointWalk, advance: float, heading: float) -> JointWalk:
    """Take the steady advance, in metres a frame, out of a planted walk."""
    way = np.outer(np.arange(walk.n_frames) * advance, [np.cos(heading), np.sin(heading), 0.0])
    return replace(walk, root=walk.root - way, speed=walk.size * advance * walk.frame_rate)
