"""Where the soles of the feet are in a walk of joints: heels, balls and tips of the toes."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.posture import stand_upright, toe_joint
from eigenwalker.motion.rig import Place, Rig, as_rig
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.rotations import forward_kinematics
from eigenwalker.motion.skeleton import Skeleton
from eigenwalker.motion.walk import JointWalk

__all__ = ["Sole", "sole_offsets", "sole_points"]

SIDES = ("left", "right")
_FOOT_WITHOUT_TOES = np.array([0.12, 0.0, -0.05])  # from ankle to toe joint, in lengths of the leg


class Sole(NamedTuple):
    """What `sole_offsets` returns: which joints carry the points of the soles, and where.

    Parameters
    ----------
    joints : ndarray of shape (2, 3)
        Position in the skeleton of the joint that carries each point: left foot, right foot; heel, ball, tip.
    offsets : ndarray of shape (2, 3, 3)
        From that joint to the point, along the joint's own axes, in metres.
    """

    joints: NDArray[np.intp]
    offsets: NDArray[np.float64]


def sole_offsets(skeleton: Skeleton, rig: Rig | Mapping[str, Place] | None = None) -> Sole:
    """Return which joints carry the points of the soles, and where on them the points are.

    Skeletons end at the toe joints or above; the sole is put below them as the rig's `Posture` says. While the body
    stands, all of it lies on one plane, `toe_height` below the toe joint: the heel `heel_back` behind the ankle, which
    carries it; the ball straight below the toe joint, and the tip of the toes `toe_ahead` before that, both carried by
    the toe joint. These are shares of the leg, thigh and shank, the mean of both sides.

    Parameters
    ----------
    skeleton : Skeleton
        Upright, see `stand_upright`.
    rig : Rig or dict, default None
        Which joints are hips, knees and ankles; None recognises the rigs in `RIGS` by their joint names.

    Returns
    -------
    Sole
        Where no joint hangs from an ankle, the ankle carries all three points; the tip of the skeleton on it, if there
        is one, is taken for the toe joint, else a place 0.12 legs ahead of the ankle and 0.05 below.

    Raises
    ------
    ValueError
        If the skeleton is not upright, or no rig is recognised.
    """
    if not skeleton.upright:
        raise ValueError("skeleton must be upright, its joints' axes along those of the room: use stand_upright(walk)")
    rig = find_rig(skeleton.joint_names) if rig is None else as_rig(rig, skeleton.joint_names)
    shape, leg = rig.posture, _leg_length(skeleton, rig)
    down, ahead = np.array([0.0, 0.0, -shape.toe_height * leg]), np.array([shape.toe_ahead * leg, 0.0, 0.0])
    joints, offsets = np.empty((2, 3), dtype=np.intp), np.empty((2, 3, 3))
    for foot, side in enumerate(SIDES):
        ankle, name = skeleton.index(rig.joint(f"{side}_ankle")), toe_joint(skeleton, rig, side)
        toe = _toe_place(skeleton, ankle, leg) if name is None else skeleton.offsets[skeleton.index(name)]
        carried = toe if name is None else np.zeros(3)  # from the joint that carries ball and tip
        joints[foot] = [ankle, *[ankle if name is None else skeleton.index(name)] * 2]
        heel = np.array([-shape.heel_back * leg, 0.0, toe[2] + down[2]])
        offsets[foot] = heel, carried + down, carried + down + ahead
    return Sole(joints, offsets)


def _leg_length(skeleton: Skeleton, rig: Rig) -> float:
    """Return the length of thigh and shank, the mean of both sides, in metres."""
    lengths = []
    for side in SIDES:
        hip, knee, ankle = (skeleton.index(rig.joint(f"{side}_{joint}")) for joint in ("hip", "knee", "ankle"))
        for above, joint in ((hip, knee), (knee, ankle)):
            chain = [*skeleton.above(joint), joint]
            bone = skeleton.offsets[chain[chain.index(above) + 1 :]].sum(axis=0)  # past joints between the two
            lengths.append(float(np.linalg.norm(bone)))
    return sum(lengths) / 2


def _toe_place(skeleton: Skeleton, ankle: int, leg: float) -> NDArray[np.floating]:
    """Return where the toe joint would be, from the ankle, where the skeleton has none."""
    tips = skeleton.end_offsets[skeleton.end_parents == ankle]
    found = tips[np.linalg.norm(tips, axis=1) > 0]
    return found[0] if len(found) else leg * _FOOT_WITHOUT_TOES


def sole_points(walk: JointWalk, rig: Rig | Mapping[str, Place] | None = None) -> NDArray[np.float64]:
    """Return where heels, balls and tips of both feet are in the room, by forward kinematics.

    Parameters
    ----------
    walk : JointWalk
        One that is not upright yet is brought there by `stand_upright`, which moves nothing.
    rig : Rig or dict, default None
        Which joints are hips, knees and ankles; None recognises the rigs in `RIGS` by their joint names.

    Returns
    -------
    ndarray of shape (n_frames, 2, 3, 3)
        In metres: frames; left foot, right foot; heel, ball, tip of the toes (see `sole_offsets`); x, y, z.

    Raises
    ------
    ValueError
        If no rig is recognised.

    Examples
    --------
    >>> from eigenwalker import read_walk
    >>> from eigenwalker.motion import sole_points
    >>> walk = read_walk("dataset-2_walk_normal_001.bvh", unit="cm")  # doctest: +SKIP
    >>> lowest = sole_points(walk)[..., 2].min(axis=(1, 2))  # height over the floor, frame by frame  # doctest: +SKIP
    """
    walk = stand_upright(walk, rig=rig)
    joints, offsets = sole_offsets(walk.skeleton, rig)
    positions, frames = forward_kinematics(walk.rotations, walk._local_positions(), walk.skeleton.parents)
    # (n_frames, 2, 3, 3, 3) @ (2, 3, 3, 1) -> (n_frames, 2, 3, 3)
    return positions[:, joints] + (frames[:, joints] @ offsets[..., np.newaxis])[..., 0]
