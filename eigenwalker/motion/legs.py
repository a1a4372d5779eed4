"""The legs of a skeleton apart from the rest of it: pelvis, hips, knees, ankles, soles."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from eigenwalker.motion.posture import SIDES
from eigenwalker.motion.rig import Place, Rig, as_rig
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.rotations import forward_kinematics
from eigenwalker.motion.skeleton import Skeleton
from eigenwalker.motion.sole import sole_offsets

__all__ = ["LegPose", "Legs", "find_legs", "pose_legs"]


class Legs(NamedTuple):
    """Where in a skeleton the legs are.

    Parameters
    ----------
    joints : ndarray of shape (n_joints,)
        Positions in the skeleton of all joints from its top to the toes.
    parents : ndarray of shape (n_joints,)
        Their parents, as positions among themselves.
    offsets : ndarray of shape (n_joints, 3)
        From the parents, in metres.
    root : int
        The joint that carries the body, as a position among them.
    chain : ndarray of shape (2, 3)
        Hip, knee and ankle of the left and of the right leg, as positions among them.
    sole_joints : ndarray of shape (2, 3)
        Which of them carry heel, ball and tip.
    sole_offsets : ndarray of shape (2, 3, 3)
        Where these points are on them, in metres.
    """

    joints: NDArray[np.intp]
    parents: NDArray[np.intp]
    offsets: NDArray[np.float64]
    root: int
    chain: NDArray[np.intp]
    sole_joints: NDArray[np.intp]
    sole_offsets: NDArray[np.float64]


class LegPose(NamedTuple):
    """Where the legs are in the room, frame by frame; the second axis is left and right.

    Parameters
    ----------
    hips, ankles : ndarray of shape (n_frames, 2, 3)
        In metres.
    pelvis : ndarray of shape (n_frames, 2, 3, 3)
        Axes of the joints that the hips hang from, as columns of rotation matrices.
    feet, toes : ndarray of shape (n_frames, 2, 3, 3)
        Axes of the ankles, and of the joints that carry the toes.
    soles : ndarray of shape (n_frames, 2, 3, 3)
        Heel, ball and tip of the foot, in metres.
    """

    hips: NDArray[np.float64]
    ankles: NDArray[np.float64]
    pelvis: NDArray[np.float64]
    feet: NDArray[np.float64]
    toes: NDArray[np.float64]
    soles: NDArray[np.float64]


def find_legs(skeleton: Skeleton, rig: Rig | Mapping[str, Place] | None = None) -> Legs:
    """Return where the legs of an upright skeleton are.

    Parameters
    ----------
    skeleton : Skeleton
        Upright, see `stand_upright`.
    rig : Rig or dict, default None
        Which joints are hips, knees and ankles; None recognises the rigs in `RIGS` by their joint names.

    Raises
    ------
    ValueError
        If the skeleton is not upright, no rig is recognised, or knee and ankle do not hang from the joint above.
    """
    rig = find_rig(skeleton.joint_names) if rig is None else as_rig(rig, skeleton.joint_names)
    sole = sole_offsets(skeleton, rig)
    names = [[rig.joint(f"{side}_{joint}") for joint in ("hip", "knee", "ankle")] for side in SIDES]
    chain = np.array([[skeleton.index(name) for name in leg] for leg in names])
    for leg in chain:
        if (skeleton.parents[leg[1:]] != leg[:-1]).any():
            hip, knee, ankle = (skeleton.joint_names[joint] for joint in leg)
            raise ValueError(f"{knee} must hang from {hip} and {ankle} from {knee}, without a joint between them")
    ends = [*chain.ravel(), *sole.joints.ravel(), skeleton.root]
    joints = np.array(sorted({joint for end in ends for joint in (*skeleton.above(int(end)), int(end))}))
    place = np.full(len(skeleton.parents) + 1, -1)  # the last one is the parent of the top, -1
    place[joints] = np.arange(len(joints))
    return Legs(
        joints,
        place[skeleton.parents[joints]],
        np.asarray(skeleton.offsets[joints], dtype=np.float64),
        int(place[skeleton.root]),
        place[chain],
        place[sole.joints],
        sole.offsets,
    )


def pose_legs(rotations: NDArray[np.floating], root: NDArray[np.floating], legs: Legs) -> LegPose:
    """Return where the legs are.

    Parameters
    ----------
    rotations : ndarray of shape (n_frames, n_joints, 3)
        Of all joints of the skeleton, in radians.
    root : ndarray of shape (n_frames, 3)
        Path of the root, in metres.
    legs : Legs
        Of the skeleton.
    """
    local = np.tile(legs.offsets, (len(rotations), 1, 1))
    local[:, legs.root] = root
    positions, frames = forward_kinematics(rotations[:, legs.joints], local, legs.parents)
    hip, _, ankle = legs.chain.T
    toes = legs.sole_joints[:, 2]
    places = (hip, ankle, legs.parents[hip], toes, legs.sole_joints, legs.sole_offsets)
    compiled: Callable[..., tuple] = _pick
    return LegPose(*compiled(positions, frames, *(np.ascontiguousarray(part) for part in places)))


@njit(cache=True, nogil=True)
def _pick(positions, frames, hip, ankle, pelvis, toes, sole_joints, sole_offsets):
    """Return the parts of a `LegPose` from positions and frames of all joints of the legs."""
    n_frames = len(positions)
    n_feet, n_points = sole_joints.shape
    hips, ankles = np.empty((n_frames, n_feet, 3)), np.empty((n_frames, n_feet, 3))
    axes = np.empty((3, n_frames, n_feet, 3, 3))
    soles = np.empty((n_frames, n_feet, n_points, 3))
    for t in range(n_frames):
        for foot in range(n_feet):
            for i in range(3):
                hips[t, foot, i] = positions[t, hip[foot], i]
                ankles[t, foot, i] = positions[t, ankle[foot], i]
                for j in range(3):
                    axes[0, t, foot, i, j] = frames[t, pelvis[foot], i, j]
                    axes[1, t, foot, i, j] = frames[t, ankle[foot], i, j]
                    axes[2, t, foot, i, j] = frames[t, toes[foot], i, j]
                for point in range(n_points):
                    joint = sole_joints[foot, point]
                    place = positions[t, joint, i]
                    for j in range(3):
                        place += frames[t, joint, i, j] * sole_offsets[foot, point, j]
                    soles[t, foot, point, i] = place
    return hips, ankles, axes[0], axes[1], axes[2], soles
