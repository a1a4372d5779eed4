"""The legs of a skeleton apart from the rest of it: pelvis, hips, knees, ankles, soles."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from eigenwalker.motion._quaternions import added, from_rotvec, product, turned
from eigenwalker.motion.posture import SIDES
from eigenwalker.motion.rig import Place, Rig, as_rig
from eigenwalker.motion.rigs import find_rig
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
    pelvis : ndarray of shape (n_frames, 2, 4)
        Axes of the joints that the hips hang from, as quaternions, w first.
    feet, toes : ndarray of shape (n_frames, 2, 4)
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
    return _known_legs(skeleton) if rig is None else _legs(skeleton, as_rig(rig, skeleton.joint_names))


@lru_cache(maxsize=16)
def _known_legs(skeleton: Skeleton) -> Legs:
    """Return the legs of a skeleton, which many walks share, in a rig that is recognized."""
    return _legs(skeleton, find_rig(skeleton.joint_names))


def _legs(skeleton: Skeleton, rig: Rig) -> Legs:
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
    hip, _, ankle = legs.chain.T
    toes = legs.sole_joints[:, 2]
    arrays = [rotations, root, legs.offsets, legs.sole_offsets]
    places = [legs.joints, legs.parents, hip, ankle, legs.parents[hip], toes, legs.sole_joints]
    compiled: Callable[..., tuple] = _pose
    return LegPose(
        *compiled(
            *(np.ascontiguousarray(array, dtype=np.float64) for array in arrays),
            legs.root,
            *(np.ascontiguousarray(place) for place in places),
        )
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _pose(rotations, root, offsets, sole_offsets, top, joints, parents, hip, ankle, pelvis, toes, sole_joints):
    """Return the parts of a `LegPose`: forward kinematics of the joints of the legs alone."""
    n_frames, (n_feet, n_points) = len(rotations), sole_joints.shape
    hips, ankles = np.empty((n_frames, n_feet, 3)), np.empty((n_frames, n_feet, 3))
    axes, soles = np.empty((3, n_frames, n_feet, 4)), np.empty((n_frames, n_feet, n_points, 3))
    places, turns = np.empty((len(joints), 3)), np.empty((len(joints), 4))
    for t in range(n_frames):
        for j in range(len(joints)):
            turn = from_rotvec((rotations[t, joints[j], 0], rotations[t, joints[j], 1], rotations[t, joints[j], 2]))
            place = (offsets[j, 0], offsets[j, 1], offsets[j, 2])
            if j == top:
                place = (root[t, 0], root[t, 1], root[t, 2])
            if parents[j] >= 0:
                place = _carried(places, turns, parents[j], place)
                turn = product(_quaternion(turns, parents[j]), turn)
            places[j, 0], places[j, 1], places[j, 2] = place
            turns[j, 0], turns[j, 1], turns[j, 2], turns[j, 3] = turn
        for foot in range(n_feet):
            for i in range(3):
                hips[t, foot, i], ankles[t, foot, i] = places[hip[foot], i], places[ankle[foot], i]
            for i in range(4):
                axes[0, t, foot, i] = turns[pelvis[foot], i]
                axes[1, t, foot, i] = turns[ankle[foot], i]
                axes[2, t, foot, i] = turns[toes[foot], i]
            for point in range(n_points):
                offset = (sole_offsets[foot, point, 0], sole_offsets[foot, point, 1], sole_offsets[foot, point, 2])
                place = _carried(places, turns, sole_joints[foot, point], offset)
                soles[t, foot, point, 0], soles[t, foot, point, 1], soles[t, foot, point, 2] = place
    return hips, ankles, axes[0], axes[1], axes[2], soles


@njit(cache=True, nogil=True)
def _quaternion(turns, joint):
    return turns[joint, 0], turns[joint, 1], turns[joint, 2], turns[joint, 3]


@njit(cache=True, nogil=True)
def _carried(places, turns, joint, offset):
    """Return where a point is that a joint carries at an offset."""
    return added((places[joint, 0], places[joint, 1], places[joint, 2]), turned(_quaternion(turns, joint), offset))
