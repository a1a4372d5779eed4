"""From body proportions to a skeleton.

Segment lengths are fractions of stature after Drillis & Contini (1966), as printed in Winter (2009), Biomechanics and
Motor Control of Human Movement, Fig. 4.1. Breadths are those of joint centers, which lie inside the breadths of the
body: about 0.21 of stature between the shoulders (biacromial breadth, Gordon et al. 2014, less the way to the center)
and 0.105 between the hips (Seidel et al. 1995, J. Biomech. 28, 995-998).
"""

from collections.abc import Mapping

import numpy as np

from eigenwalker.motion import TROJE15, Skeleton

__all__ = ["BODY_PARAMETERS", "JOINTS", "LIMB_JOINTS", "MARKER_JOINTS", "body_skeleton"]

_THIGH, _SHANK, _ANKLE_HEIGHT = 0.245, 0.246, 0.039
_UPPER_ARM, _FOREARM = 0.186, 0.146
_SHOULDER_HALF, _HIP_HALF = 0.105, 0.0525
_HIP_DEPTH = 0.022  # of the hip centers below the center of the pelvis
_LUMBAR = 0.05  # the joint of the trunk above the center of the pelvis
_THORAX = 0.218  # from there to the shoulders, which are at 0.818 of stature
_NECK = 0.112  # from the clavicle to the center of the head
_HEEL, _BALL = 0.036, 0.075  # behind and before the ankle; the foot is 0.152 of stature long

LIMB_JOINTS = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
BODY_PARAMETERS = (
    "stature",
    "leg_length",
    "shank_share",
    "arm_length",
    "forearm_share",
    "neck_length",
    "shoulder_breadth",
    "hip_breadth",
    "pelvis_depth",
    "shoulder_lift",
    "shoulder_forward",
    "clavicle_forward",
    "head_forward",
    *(f"{side}_{joint}_shift_{axis}" for side in ("left", "right") for joint in LIMB_JOINTS for axis in "xyz"),
)
"""Stature in metres; lengths and breadths as relative deviations from the average proportion; shares as the part of
the limb by which its lower segment is longer and its upper one shorter; the rest are offsets in metres, the shifts
those of a joint against its place in a straight and symmetric body, in the frame of the bone above it."""

_SIDES = (("left", 1.0), ("right", -1.0))
_PARENTS = {"pelvis": "", "thorax": "pelvis", "clavicle": "thorax", "head": "clavicle"}
for _side, _ in _SIDES:
    _PARENTS |= {f"{_side}_shoulder": "thorax", f"{_side}_elbow": f"{_side}_shoulder"}
    _PARENTS |= {f"{_side}_wrist": f"{_side}_elbow", f"{_side}_hip": "pelvis"}
    _PARENTS |= {f"{_side}_knee": f"{_side}_hip", f"{_side}_ankle": f"{_side}_knee"}
JOINTS = tuple(_PARENTS)
_PARENT_INDEX = np.array([JOINTS.index(parent) if parent else -1 for parent in _PARENTS.values()])
MARKER_JOINTS = np.array([JOINTS.index(name) for name in TROJE15.names])
"""Position of each of the 15 markers among the joints of `body_skeleton`."""


def body_skeleton(parameters: Mapping[str, float]) -> Skeleton:
    """Return the skeleton of one walker, standing upright with hanging arms.

    Parameters
    ----------
    parameters : mapping of str to float
        `BODY_PARAMETERS`.

    Returns
    -------
    Skeleton
        The 15 markers and the joint of the trunk, with heel and ball of the left and the right foot as tips.
    """
    offsets = _trunk(parameters)
    for side, sign in _SIDES:
        offsets |= _limbs(parameters, side, sign)
    sole = parameters["stature"] * np.array([[-_HEEL, 0.0, -_ANKLE_HEIGHT], [_BALL, 0.0, -_ANKLE_HEIGHT]])
    feet = [JOINTS.index("left_ankle")] * 2 + [JOINTS.index("right_ankle")] * 2
    return Skeleton(
        joint_names=JOINTS,
        parents=_PARENT_INDEX,
        offsets=np.array([offsets[name] for name in JOINTS]),
        end_parents=np.array(feet),
        end_offsets=np.vstack((sole, sole)),
    )


def _trunk(parameters: Mapping[str, float]) -> dict[str, tuple[float, ...]]:
    stature = parameters["stature"]
    # Long legs are at the cost of the trunk: the parts always add up to the stature.
    thorax = stature * (_THORAX - (_THIGH + _SHANK) * parameters["leg_length"] - _NECK * parameters["neck_length"])
    neck = stature * _NECK * (1 + parameters["neck_length"])
    return {
        "pelvis": (0.0, 0.0, 0.0),
        "thorax": (0.0, 0.0, stature * _LUMBAR),
        "clavicle": (parameters["clavicle_forward"], 0.0, thorax),
        "head": (parameters["head_forward"] - parameters["clavicle_forward"], 0.0, neck),
    }


def _limbs(parameters: Mapping[str, float], side: str, sign: float) -> dict[str, tuple[float, ...]]:
    stature = parameters["stature"]
    leg, arm = stature * (1 + parameters["leg_length"]), stature * (1 + parameters["arm_length"])
    shank, forearm = parameters["shank_share"], parameters["forearm_share"]
    shoulder = sign * stature * _SHOULDER_HALF * (1 + parameters["shoulder_breadth"])
    hip = sign * stature * _HIP_HALF * (1 + parameters["hip_breadth"])
    height = _trunk(parameters)["clavicle"][2] + parameters["shoulder_lift"]
    straight = {
        "shoulder": (parameters["shoulder_forward"], shoulder, height),
        "elbow": (0.0, 0.0, -arm * (_UPPER_ARM - (_UPPER_ARM + _FOREARM) * forearm)),
        "wrist": (0.0, 0.0, -arm * (_FOREARM + (_UPPER_ARM + _FOREARM) * forearm)),
        "hip": (0.0, hip, -stature * _HIP_DEPTH - parameters["pelvis_depth"]),
        "knee": (0.0, 0.0, -leg * (_THIGH - (_THIGH + _SHANK) * shank)),
        "ankle": (0.0, 0.0, -leg * (_SHANK + (_THIGH + _SHANK) * shank)),
    }
    return {
        f"{side}_{joint}": tuple(
            place + parameters[f"{side}_{joint}_shift_{axis}"]
            for axis, place in zip("xyz", straight[joint], strict=True)
        )
        for joint in LIMB_JOINTS
    }
