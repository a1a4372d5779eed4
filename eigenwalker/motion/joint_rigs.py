"""Rigs of skeletons: which joints of a family of files make the 15 markers."""

from eigenwalker.motion.rig import STANDING, Place, Posture, Rig

__all__ = ["JOINT_RIGS"]


def _rig(name: str, *, trunk: dict[str, dict[str, float]], limbs: dict[str, str], posture: Posture = STANDING) -> Rig:
    """Build a rig from its trunk and the pair of joints, "left|right", under each marker of the limbs."""
    markers: dict[str, Place] = dict(trunk)
    for marker, pair in limbs.items():
        markers[f"left_{marker}"], markers[f"right_{marker}"] = pair.split("|")
    return Rig(name, markers, posture)


def _bandai_limbs(side: str) -> tuple[str, ...]:
    joints = ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes")
    return tuple(f"{joint}_{side}" for joint in joints)


# The centre of the head lies above the joint between neck and skull. Where the file has no tip
# of the head, it is reached by carrying on along the neck.
_BANDAI = _rig(
    "bandai",
    trunk={
        "head": {"Head": 2.0, "Neck": -1.0},
        "clavicle": {"Shoulder_L": 0.5, "Shoulder_R": 0.5},
        "pelvis": {"UpperLeg_L": 0.5, "UpperLeg_R": 0.5},
    },
    limbs={
        "shoulder": "UpperArm_L|UpperArm_R",
        "elbow": "LowerArm_L|LowerArm_R",
        "wrist": "Hand_L|Hand_R",
        "hip": "UpperLeg_L|UpperLeg_R",
        "knee": "LowerLeg_L|LowerLeg_R",
        "ankle": "Foot_L|Foot_R",
    },
    posture=Posture(
        axes={
            "Hips": "xz-y",
            **dict.fromkeys(("Spine", "Chest", "Neck", "Head"), "yzx"),
            "Shoulder_L": "xyz",
            "Shoulder_R": "-xy-z",
            **dict.fromkeys(_bandai_limbs("L"), "x-zy"),
            **dict.fromkeys(_bandai_limbs("R"), "-xzy"),
        },
        foot_pitch=40.0,  # standing, ankles are 118 to 120 mm above the floor, the toe joints 42 to 44 mm
        toe_lift=17.0,
        toe_height=0.053,
    ),
)
_LIMB_JOINTS = {
    "shoulder": "LeftArm|RightArm",
    "elbow": "LeftForeArm|RightForeArm",
    "wrist": "LeftHand|RightHand",
    "hip": "LeftUpLeg|RightUpLeg",
    "knee": "LeftLeg|RightLeg",
    "ankle": "LeftFoot|RightFoot",
}
_ACCLAIM = Posture(toe_height=0.03)  # the toe joints of the CMU database lie 20 to 25 mm above the floor
_CMU = _rig(
    "cmu",
    trunk={
        "head": {"Head": 1.5, "Neck1": -0.5},
        "clavicle": {"Neck": 1.0},
        "pelvis": {"LeftUpLeg": 0.5, "RightUpLeg": 0.5},
    },
    limbs=_LIMB_JOINTS,
    posture=_ACCLAIM,
)
# A joint of ASF is the start of its bone. lwrist is the lower third of the forearm; the wrist is where lhand starts.
_ASF = _rig(
    "asf",
    trunk={
        "head": {"head": 1.5, "upperneck": -0.5},
        "clavicle": {"lowerneck": 1.0},
        "pelvis": {"lfemur": 0.5, "rfemur": 0.5},
    },
    limbs={
        "shoulder": "lhumerus|rhumerus",
        "elbow": "lradius|rradius",
        "wrist": "lhand|rhand",
        "hip": "lfemur|rfemur",
        "knee": "ltibia|rtibia",
        "ankle": "lfoot|rfoot",
    },
    posture=_ACCLAIM,
)


def _mixamo(name: str, prefix: str) -> Rig:
    """Return the rig of Mixamo's skeletons, whose joints some programs write with a prefix."""
    return _rig(
        name,
        trunk={
            "head": {f"{prefix}Head": 2.0, f"{prefix}Neck": -1.0},
            "clavicle": {f"{prefix}LeftShoulder": 0.5, f"{prefix}RightShoulder": 0.5},
            "pelvis": {f"{prefix}LeftUpLeg": 0.5, f"{prefix}RightUpLeg": 0.5},
        },
        limbs={marker: "|".join(prefix + joint for joint in pair.split("|")) for marker, pair in _LIMB_JOINTS.items()},
    )


JOINT_RIGS: tuple[Rig, ...] = (_BANDAI, _CMU, _ASF, _mixamo("mixamorig", "mixamorig:"), _mixamo("mixamo", ""))
"""Rigs of skeletons; the joints of one may be among those of another, and the first one that fits is taken."""
