"""Made-up walks of joints whose feet are known to stand, to slide, to float or to sink."""

from dataclasses import replace

import numpy as np

from eigenwalker.motion import JointWalk, Skeleton

__all__ = ["ANKLE", "LEG", "planted_walk", "skeleton_with_feet", "standing_walk"]

LEG, THIGH = 0.8, 0.4
TOE = (0.12, 0.0, -0.05)  # from ankle to toe joint
ANKLE = 0.05 + 0.05 * LEG  # height of the ankle over the sole
FRAME_RATE, PERIOD, STANCE, SPEED = 120.0, 1.0, 0.6, 1.2

_TRUNK = (
    ("Hips", None, (0.0, 0.0, 0.0)),
    ("Spine", "Hips", (0.0, 0.0, 0.5)),
    ("Neck", "Spine", (0.0, 0.0, 0.1)),
    ("Head", "Neck", (0.0, 0.0, 0.1)),
)
_LIMBS = (
    ("Shoulder", "Spine", (0.0, 0.05, 0.0)),
    ("Arm", "Shoulder", (0.0, 0.12, 0.0)),
    ("ForeArm", "Arm", (0.0, 0.0, -0.3)),
    ("Hand", "ForeArm", (0.0, 0.0, -0.25)),
    ("UpLeg", "Hips", (0.0, 0.1, 0.0)),
    ("Leg", "UpLeg", (0.0, 0.0, -THIGH)),
    ("Foot", "Leg", (0.0, 0.0, THIGH - LEG)),
    ("ToeBase", "Foot", TOE),
)


def skeleton_with_feet(*, toes=True, **fields):
    """Return an upright skeleton with the joint names of Mixamo's, with legs of 0.8 m."""
    bones = list(_TRUNK)
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        for name, parent, (x, y, z) in _LIMBS:
            above = parent if parent in {"Spine", "Hips"} else side + parent
            bones.append((side + name, above, (x, sign * y, z)))
    bones = [bone for bone in bones if toes or "Toe" not in bone[0]]
    names = tuple(name for name, *_ in bones)
    parents = [-1 if parent is None else names.index(parent) for _, parent, _ in bones]
    return Skeleton(names, parents, [offset for *_, offset in bones], **({"upright": True} | fields))


def standing_walk(n_frames=5, *, skeleton=None, **fields):
    """Return a walk of somebody who stands still, the soles on the floor."""
    skeleton = skeleton or skeleton_with_feet()
    rotations = np.zeros((n_frames, len(skeleton.joint_names), 3))
    return JointWalk(rotations, np.tile([0.0, 0.0, LEG + ANKLE], (n_frames, 1)), skeleton, FRAME_RATE, **fields)


def planted_walk(*, n_strides=5, slide=0.0, height=0.0, in_place=False, **fields):
    """Return a walk along x at 1.2 m/s, two strides of 1 s shifted by half a one, each foot down for 0.6 s.

    Feet are flat. While it stands a foot slides ahead at `slide` m/s, `height` metres over the floor; then it swings
    evenly, and rises. The ankles follow by stretching the shank, so that nothing else has to fit.
    """
    times = np.arange(round(n_strides * PERIOD * FRAME_RATE)) / FRAME_RATE
    still = standing_walk(len(times), **fields)
    ahead = SPEED * times[:, np.newaxis] * [1.0, 0.0, 0.0]
    paths = {}
    for foot, side in enumerate(("Left", "Right")):
        cycle = times / PERIOD + 0.25 + 0.5 * foot
        phase, number = cycle % 1.0, np.floor(cycle)
        swung = np.clip((phase - STANCE) / (1 - STANCE), 0.0, 1.0)
        slid = slide * PERIOD * (np.minimum(phase, STANCE) - swung * STANCE)
        place = SPEED * PERIOD * (number + swung - 0.25 - 0.5 * foot + 0.5 * STANCE) + slid
        rise = np.where(swung > 0, 0.08 * np.sin(np.pi * swung), 0.0)
        paths[f"{side}Foot"] = np.column_stack((place - ahead[:, 0], np.zeros_like(place), rise + height + THIGH - LEG))
    walk = replace(still, root=still.root + ahead, translations=paths)
    return replace(walk, root=still.root, speed=SPEED) if in_place else walk
