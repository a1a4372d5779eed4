"""Walks of several people on one body, so that they differ in how joints turn and in nothing else."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_walks
from eigenwalker.motion.body import leg_length
from eigenwalker.motion.clip import cut
from eigenwalker.motion.rig import Place, Rig
from eigenwalker.motion.skeleton import Skeleton
from eigenwalker.motion.walk import JointWalk

__all__ = ["share_skeleton"]


def share_skeleton(
    walks: Sequence[JointWalk], skeleton: Skeleton | None = None, *, rig: Rig | Mapping[str, Place] | None = None
) -> list[JointWalk]:
    """Return walks with their rotations on one body.

    The height of the root over the floor is multiplied by the ratio of leg lengths, hip to knee to ankle, so that feet
    stay near the floor. Everything else stays: rotations, sway, speed and size. Feet that do not quite stand after that
    are for `plant_feet`.

    Parameters
    ----------
    walks : list of JointWalk
        Upright, with bones of constant length: from ``prepare(walk, representation="joints")``. All have the same
        joints in the same order.
    skeleton : Skeleton, default None
        The body, upright. None is the mean of those of the walks, walk by walk: a person with more walks counts more.

    rig : Rig or dict, default None
        Which joints are hips, knees and ankles; None recognises the rigs in `RIGS` by their joint names.

    Returns
    -------
    list of JointWalk
        All with the same `skeleton`.

    Raises
    ------
    WalkError
        If walks are not upright, have bones that change, or have other joints than the skeleton, else than the first
        walk; lists all of them.
    ValueError
        If `skeleton` is not upright, or no rig is recognised.

    Examples
    --------
    >>> from eigenwalker import read_walks
    >>> from eigenwalker.motion import prepare_walks, share_skeleton
    >>> walks = read_walks(["05_01.bvh", "08_01.bvh"], unit=0.0564)  # doctest: +SKIP
    >>> walks = share_skeleton(prepare_walks(walks, representation="joints"))  # doctest: +SKIP
    >>> walks[0].skeleton is walks[1].skeleton  # doctest: +SKIP
    True
    """
    walks = check_walks(walks, kind=JointWalk)
    if skeleton is not None and not isinstance(skeleton, Skeleton):
        raise TypeError(f"skeleton must be a Skeleton, got {type(skeleton).__name__}")
    if skeleton is not None and not skeleton.upright:
        raise ValueError(
            "skeleton must be upright, such as stand_upright(walk).skeleton, got one in the axes of a file"
        )
    _check_bodies(walks, walks[0].skeleton if skeleton is None else skeleton)
    body = _mean_skeleton([walk.skeleton for walk in walks]) if skeleton is None else skeleton
    return [_on_body(walk, body, rig) for walk in walks]


def _check_bodies(walks: Sequence[JointWalk], expected: Skeleton) -> None:
    """Raise one error with all that keeps walks from having one skeleton."""
    names = [walk.name or f"walk {position}" for position, walk in enumerate(walks)]
    found = {name: _faults(walk, expected) for name, walk in zip(names, walks, strict=True)}
    refused = [f"\n  {name}: {'; '.join(faults)}" for name, faults in found.items() if faults]
    if refused:
        raise WalkError(
            f"{len(refused)} of {len(walks)} walks cannot be put on one skeleton; prepare all of them with "
            "representation='joints', and bring their files to one tree of joints, or leave them out:"
            f"{''.join(refused)}"
        )


def _faults(walk: JointWalk, expected: Skeleton) -> list[str]:
    """Say all that keeps a walk from having a skeleton."""
    skeleton = walk.skeleton
    if not skeleton.upright:
        return ["is in the axes of a file; use prepare(walk, representation='joints') or stand_upright(walk)"]
    above, wanted = _parent_names(skeleton), _parent_names(expected)
    moved = [joint for joint, parent in wanted.items() if above.get(joint, parent) != parent]
    told = {
        "lacks": [joint for joint in wanted if joint not in above],
        "has unknown joints": [joint for joint in above if joint not in wanted],
        "hangs elsewhere:": [f"{joint} from {above[joint]} instead of {wanted[joint]}" for joint in moved],
        "has bones that change in length:": list(walk.translations),
    }
    faults = [f"{fault} {', '.join(joints)}" for fault, joints in told.items() if joints]
    return faults or _other_layout(skeleton, expected)


def _other_layout(skeleton: Skeleton, expected: Skeleton) -> list[str]:
    """Say what else differs in skeletons of the same joints and bones."""
    layouts = {
        "another order of joints": (skeleton.joint_names, expected.joint_names),
        "another root": tuple((one.joint_names[one.root],) for one in (skeleton, expected)),
        "other tips": tuple(tuple(one.joint_names[joint] for joint in one.end_parents) for one in (skeleton, expected)),
    }
    return [
        f"has {what}: {', '.join(got) or 'none'} instead of {', '.join(wanted) or 'none'}"
        for what, (got, wanted) in layouts.items()
        if got != wanted
    ]


def _parent_names(skeleton: Skeleton) -> dict[str, str]:
    """Return what each joint hangs from."""
    names = skeleton.joint_names
    return {
        name: names[parent] if parent >= 0 else "nothing" for name, parent in zip(names, skeleton.parents, strict=True)
    }


def _mean_skeleton(skeletons: Sequence[Skeleton]) -> Skeleton:
    """Return a skeleton whose bones, in the reference posture, are the means of those of others."""
    offsets = np.mean([skeleton.offsets for skeleton in skeletons], axis=0)
    ends = np.mean([skeleton.end_offsets for skeleton in skeletons], axis=0)
    return replace(skeletons[0], offsets=offsets, end_offsets=ends)


def _on_body(walk: JointWalk, body: Skeleton, rig: Rig | Mapping[str, Place] | None) -> JointWalk:
    """Return a walk on another body, its root as much higher over the floor as the legs are longer."""
    moved = replace(walk, skeleton=body)
    ratio = _leg_length(moved, rig) / _leg_length(walk, rig)
    root: NDArray[np.float64] = np.array(walk.root, dtype=np.float64)
    root[:, 2] = ratio * (root[:, 2] + _top_height(walk.skeleton)) - _top_height(body)
    return replace(moved, root=root)


def _leg_length(walk: JointWalk, rig: Rig | Mapping[str, Place] | None) -> float:
    """Return hip to knee plus knee to ankle, in metres."""
    return leg_length(cut(walk, slice(0, 1)).to_markers(rig))  # of rigid bones: each frame has the same


def _top_height(skeleton: Skeleton) -> float:
    """Return how high the joints above the root, which do not turn, put the place that its path counts from."""
    return float(skeleton.offsets[skeleton.above(skeleton.root), 2].sum())
