"""The reference posture of a skeleton, standing at ease, and walks whose joints are counted from it.

Exponential maps are not linear: means and harmonics of them depend on the posture that is zero. Files choose it by
what suits a program, so that the hips of one rig pass half a turn. Counted from one posture, along the axes of the
room, the same motion has nearly the same numbers in every skeleton.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import WalkError, check_array, check_finite
from eigenwalker.motion.rig import STANDING, Place, Rig, as_rig
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.rotations import forward_kinematics, turn_frames, unroll_rotvec
from eigenwalker.motion.skeleton import Skeleton
from eigenwalker.motion.walk import JointWalk

__all__ = ["lean_back", "reference_frames", "stand_upright"]

SIDES = ("left", "right")
_DOWN = np.array([0.0, 0.0, -1.0])
_HANGING = (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist"))
_STEEP = 0.7  # the cosine against the vertical of what points down
_STILL = 1e-6  # radians by which a joint above the root may turn


def reference_frames(
    skeleton: Skeleton,
    *,
    rig: Rig | Mapping[str, Place] | None = None,
    reference: str | ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Return how the joints' own axes lie in the room while the body stands in its reference posture.

    Each joint's axes are those that the rig's `Posture` names, else those of the skeleton where all rotations are
    zero. Then thighs, shanks, upper arms and forearms are turned down, the shortest way, and carry hands and feet with
    them; feet and toes are pitched where the rig says so.

    Parameters
    ----------
    skeleton : Skeleton
        Any one.
    rig : Rig or dict, default None
        Which joints are hips, knees ...; None recognises the rigs in `RIGS` by their joint names.
    reference : "zero" or array-like of shape (n_joints, 3), default None
        Another posture: "zero" is the one where all rotations of the skeleton are zero; an array has exponential maps
        against the parent, in radians. None is the rig's.

    Returns
    -------
    ndarray of shape (n_joints, 3, 3)
        Rotation matrices; their columns are the joints' axes.

    Raises
    ------
    ValueError
        If no rig is recognised, `reference` has another shape, or another word.
    """
    n_joints = len(skeleton.joint_names)
    if reference is None:
        return _standing(skeleton, find_rig(skeleton.joint_names) if rig is None else as_rig(rig, skeleton.joint_names))
    if isinstance(reference, str):
        if reference != "zero":
            raise ValueError(f"reference must be 'zero', an array or None, got {reference!r}")
        return np.tile(np.eye(3), (n_joints, 1, 1))
    posture = check_array(reference, shape=(n_joints, 3), name="reference")
    check_finite(posture, [f"reference {axis}" for axis in "xyz"], walk="reference")
    return forward_kinematics(posture[np.newaxis], np.zeros((1, n_joints, 3)), skeleton.parents)[1][0]


def _standing(skeleton: Skeleton, rig: Rig) -> NDArray[np.float64]:
    """Return the joints' axes, shape (n_joints, 3, 3), in the reference posture of a rig."""
    ends = {rig.joint(f"{side}_{one}"): rig.joint(f"{side}_{other}") for side in SIDES for one, other in _HANGING}
    feet = {rig.joint(f"{side}_ankle"): toe_joint(skeleton, rig, side) for side in SIDES}
    posture = STANDING if _stands_already(skeleton, rig, ends) else rig.posture
    frames, carried = np.empty((len(skeleton.parents), 3, 3)), np.empty((len(skeleton.parents), 3, 3))
    for place, (name, parent) in enumerate(zip(skeleton.joint_names, skeleton.parents, strict=True)):
        own = _axes_of(posture.axes.get(name, "xyz"))
        carried[place] = carried[parent] if parent >= 0 else np.eye(3)
        if name in ends:
            carried[place] = _shortest_turn(own @ _bone(skeleton, name, ends[name]), _DOWN)
        elif name in feet and posture.foot_pitch is not None and (toe := feet[name]) is not None:
            down = np.deg2rad(posture.foot_pitch)
            ahead = np.array([np.cos(down), 0.0, -np.sin(down)])
            carried[place] = _shortest_turn(own @ _bone(skeleton, name, toe), ahead)
        elif name in feet.values():
            carried[place] = _upward(posture.toe_lift) @ carried[parent]
        frames[place] = carried[place] @ own
    return frames


def _stands_already(skeleton: Skeleton, rig: Rig, ends: Mapping[str, str]) -> bool:
    """Return whether a file holds bones along the axes of the room, as those of an upright walk are written.

    Then thighs and shanks point down as they are, and not where the rig says.
    """
    if not rig.posture.axes:
        return False
    legs = [rig.joint(f"{side}_{joint}") for side in SIDES for joint in ("hip", "knee")]
    bones = {name: _bone(skeleton, name, ends[name]) for name in legs}
    own = [_axes_of(rig.posture.axes.get(name, "xyz")) @ bone for name, bone in bones.items()]
    return all(_points_down(bone) for bone in bones.values()) and not any(_points_down(bone) for bone in own)


def _points_down(bone: NDArray[np.float64]) -> bool:
    return bool(-bone[2] > _STEEP * np.linalg.norm(bone))


def _upward(degrees: float) -> NDArray[np.float64]:
    """Return the rotation matrix that pitches what points ahead up."""
    cosine, sine = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])


def toe_joint(skeleton: Skeleton, rig: Rig, side: str) -> str | None:
    """Return the joint that hangs from the ankle of a side, None where there is none."""
    ankle = skeleton.index(rig.joint(f"{side}_ankle"))
    hanging = np.flatnonzero(skeleton.parents == ankle)
    return skeleton.joint_names[hanging[0]] if hanging.size else None


def _axes_of(code: str) -> NDArray[np.float64]:
    """Return the rotation matrix whose columns point where the letters say, "x-zy" for ahead, down and left."""
    columns, sign = [], 1.0
    for letter in code:
        if letter == "-":
            sign = -1.0
            continue
        columns.append(sign * np.eye(3)["xyz".index(letter)])
        sign = 1.0
    return np.stack(columns, axis=1)


def _bone(skeleton: Skeleton, joint: str, end: str) -> NDArray[np.float64]:
    """Return the way from a joint to one below it, along the chain between them while all its rotations are zero."""
    start, place = skeleton.index(joint), skeleton.index(end)
    chain = [*skeleton.above(place), place]
    if start not in chain:
        raise ValueError(f"joint {end!r} must hang from {joint!r} in the skeleton, but does not")
    bone = np.asarray(skeleton.offsets[chain[chain.index(start) + 1 :]].sum(axis=0), dtype=np.float64)
    if not np.linalg.norm(bone) > 0:
        raise ValueError(f"the bone from {joint!r} to {end!r} must have a length, to be turned down, but has none")
    return bone


def _shortest_turn(start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation matrix that turns one direction into another about an axis across both."""
    start, end = start / np.linalg.norm(start), end / np.linalg.norm(end)
    across, cosine = np.cross(start, end), float(start @ end)
    if cosine < -1 + 1e-12:  # any axis across will do
        aside = np.eye(3)[np.argmin(np.abs(start))]
        axis = np.cross(start, aside) / np.linalg.norm(np.cross(start, aside))
        return 2 * np.outer(axis, axis) - np.eye(3)
    cross = np.array([[0, -across[2], across[1]], [across[2], 0, -across[0]], [-across[1], across[0], 0]])
    return np.eye(3) + cross + cross @ cross / (1 + cosine)


def stand_upright(
    walk: JointWalk,
    *,
    rig: Rig | Mapping[str, Place] | None = None,
    reference: str | ArrayLike | None = None,
) -> JointWalk:
    """Return the same walk with rotations counted from the reference posture, along the axes of the room.

    Nothing moves otherwise: with the axes G of a joint in the reference posture, the rotation R of a file becomes
    G_parent R G', and the offset o of the joint G_parent o.

    Parameters
    ----------
    walk : JointWalk
        As a file has it.
    rig : Rig or dict, default None
        Which joints are hips, knees ...; None recognises the rigs in `RIGS` by their joint names.
    reference : "zero" or array-like of shape (n_joints, 3), default None
        See `reference_frames`.

    Returns
    -------
    JointWalk
        Its skeleton is `upright`. Rotations run without jumps; in the first frame their angles are at most pi. Joints
        above the root, which only say where the file's axes lie, stand still with zero rotations. A walk that is
        upright already is returned as it is, unless a `reference` is given.

    Raises
    ------
    WalkError
        If joints above the root turn.
    ValueError
        If no rig is recognised.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import JointWalk, Skeleton, stand_upright
    >>> arm = Skeleton(("shoulder", "elbow"), [-1, 0], [[0, 0, 1.4], [0, 0.3, 0]])
    >>> hanging = np.array([[[-np.pi / 2, 0, 0], [0, 0, 0]]])
    >>> walk = JointWalk(hanging, [[0, 0, 1.4]], arm, frame_rate=30)
    >>> upright = stand_upright(walk, reference=walk.rotations[0])
    >>> upright.rotations[0].round(6) + 0.0, upright.skeleton.offsets[1].round(6) + 0.0
    (array([[0., 0., 0.],
           [0., 0., 0.]]), array([ 0. ,  0. , -0.3]))
    """
    skeleton = walk.skeleton
    if skeleton.upright and reference is None:
        return walk
    frames = _with_top(walk, reference_frames(skeleton, rig=rig, reference=reference))
    parents = _parent_frames(skeleton, frames)
    ends = frames[skeleton.end_parents]
    standing = replace(
        skeleton,
        offsets=np.einsum("jik,jk->ji", parents, skeleton.offsets),
        end_offsets=np.einsum("eik,ek->ei", ends, skeleton.end_offsets),
        rotation_orders=None,
        upright=True,
    )
    return replace(
        walk,
        skeleton=standing,
        rotations=turn_frames(walk.rotations, parents, frames.transpose(0, 2, 1)),
        root=walk.root @ parents[skeleton.root].T,
        translations={joint: path @ parents[skeleton.index(joint)].T for joint, path in walk.translations.items()},
    )


def lean_back(
    walk: JointWalk,
    original: JointWalk,
    *,
    rig: Rig | Mapping[str, Place] | None = None,
    reference: str | ArrayLike | None = None,
) -> JointWalk:
    """Return an upright walk in the skeleton of the walk that `stand_upright` made one of that skeleton from.

    Parameters
    ----------
    walk : JointWalk
        Upright, of any number of frames.
    original : JointWalk
        With the skeleton of a file.
    rig, reference
        Those that were given to `stand_upright`.

    Returns
    -------
    JointWalk
        `stand_upright` of it is `walk` again, to rounding.

    Raises
    ------
    ValueError
        If the joints differ.
    """
    skeleton = original.skeleton
    if walk.skeleton.joint_names != skeleton.joint_names or (walk.skeleton.parents != skeleton.parents).any():
        raise ValueError(
            f"walk {walk.name!r} must have the joints of {original.name!r}, {', '.join(skeleton.joint_names)}; got "
            f"{', '.join(walk.skeleton.joint_names)}"
        )
    if skeleton.upright and reference is None:
        return replace(walk, skeleton=skeleton)
    frames = _with_top(original, reference_frames(skeleton, rig=rig, reference=reference))
    parents = _parent_frames(skeleton, frames)
    return replace(
        walk,
        skeleton=skeleton,
        rotations=turn_frames(walk.rotations, parents.transpose(0, 2, 1), frames),
        root=walk.root @ parents[skeleton.root],
        translations={joint: path @ parents[skeleton.index(joint)] for joint, path in walk.translations.items()},
    )


def _with_top(walk: JointWalk, frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return frames in which the joints above the root have the axes that they have in the walk."""
    above = walk.skeleton.above(walk.skeleton.root)
    if not above:
        return frames
    turning = np.ptp(unroll_rotvec(walk.rotations[:, above]), axis=0).max(axis=1) > _STILL
    if turning.any():
        names = walk.skeleton.joint_names
        turned = ", ".join(names[joint] for joint in np.array(above)[turning])
        raise WalkError(
            f"walk {walk.name!r}: expected joints above the root {names[walk.skeleton.root]!r} to stand still, but "
            f"{turned} turn; bake their rotations into the root where the file was made"
        )
    frames = frames.copy()
    still = forward_kinematics(walk.rotations[:1], np.zeros((1, len(frames), 3)), walk.skeleton.parents)[1][0]
    frames[above] = still[above]
    return frames


def _parent_frames(skeleton: Skeleton, frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the axes of each joint's parent, those of the room for the first, shape (n_joints, 3, 3)."""
    return np.concatenate((np.eye(3)[np.newaxis], frames[skeleton.parents[1:]]))
