"""Rigs of marker sets: which recorded markers make the 15 markers, and how."""

from functools import partial

from eigenwalker.motion.joint_centers import hip_center, inward_center, midpoint, shoulder_center
from eigenwalker.motion.rig import Estimate, Place, Rig, Segment
from eigenwalker.motion.skeleton import FEET, TROJE15

__all__ = ["MARKER_RIGS"]

_TROJE15 = Rig("troje15", {marker: marker for marker in (*TROJE15.names, *FEET)})

# The pelvis is the middle between the hips, as in the other rigs; the Kinect's hip_center lies some 5 cm above it.
_KINECT = Rig(
    "kinect",
    {marker: marker for marker in TROJE15.names}
    | {"clavicle": "shoulder_center", "pelvis": {"left_hip": 0.5, "right_hip": 0.5}},
)


def _between(first: str, second: str) -> dict[str, float]:
    return {first: 0.5, second: 0.5}


# From the lateral marker to the centre: half the breadth across the epicondyles or malleoli of an average adult and the
# radius of a marker, over the length of the thigh, shank or upper arm.
_KNEE_SHARE, _ANKLE_SHARE, _ELBOW_SHARE = 0.12, 0.10, 0.13
_MEDIAL = (("KNM", "MED"), ("MKNE", "MANK"), ("KNEM", "ANKM"))  # medial knee and ankle, as laboratories call them


def _plug_in_gait(back: Place, medial: tuple[str, str] | None) -> Rig:
    """Return the rig of Vicon's full-body Plug-in Gait, with medial markers of a name or without any."""
    markers: dict[str, Place] = {
        "head": {"LFHD": 0.25, "RFHD": 0.25, "LBHD": 0.25, "RBHD": 0.25},
        "clavicle": _between("CLAV", "C7"),
    }
    hips = {side: Estimate(partial(hip_center, side=side), ("LASI", "RASI", back)) for side in ("left", "right")}
    markers["pelvis"] = Estimate(midpoint, (hips["left"], hips["right"]))
    trunk = Estimate(midpoint, (_between("LASI", "RASI"), back))
    shoulders = {
        "left": Estimate(shoulder_center, ("LSHO", "RSHO", trunk)),
        "right": Estimate(shoulder_center, ("RSHO", "LSHO", trunk)),
    }
    segments: list[Segment] = []
    for side, other, letter in (("left", "right", "L"), ("right", "left", "R")):
        leg = _plug_in_gait_leg(letter, hips[side], hips[other], medial)
        arm = _plug_in_gait_arm(letter, shoulders[side], shoulders[other])
        markers |= {f"{side}_{joint}": place for joint, place in (leg | arm).items()}
        if medial is not None:
            knee, ankle = (f"{letter}{name}" for name in medial)
            segments.append(Segment((hips[side], f"{letter}THI", f"{letter}KNE"), (knee,)))
            segments.append(Segment((_between(f"{letter}KNE", knee), f"{letter}TIB", f"{letter}ANK"), (ankle,)))
    return Rig("plug-in gait", markers, segments=tuple(segments))


def _plug_in_gait_leg(letter: str, hip: Place, other_hip: Place, medial: tuple[str, str] | None) -> dict[str, Place]:
    lateral_knee, lateral_ankle = f"{letter}KNE", f"{letter}ANK"
    if medial is not None:
        knee: Place = _between(lateral_knee, f"{letter}{medial[0]}")
        ankle: Place = _between(lateral_ankle, f"{letter}{medial[1]}")
    else:
        knee = Estimate(partial(inward_center, share=_KNEE_SHARE), (lateral_knee, hip, hip, other_hip))
        ankle = Estimate(partial(inward_center, share=_ANKLE_SHARE), (lateral_ankle, knee, hip, other_hip))
    return {"hip": hip, "knee": knee, "ankle": ankle, "heel": f"{letter}HEE", "toe": f"{letter}TOE"}


def _plug_in_gait_arm(letter: str, shoulder: Place, other_shoulder: Place) -> dict[str, Place]:
    lateral = f"{letter}ELB"
    elbow = Estimate(partial(inward_center, share=_ELBOW_SHARE), (lateral, shoulder, shoulder, other_shoulder))
    return {"shoulder": shoulder, "elbow": elbow, "wrist": _between(f"{letter}WRA", f"{letter}WRB")}


_BACKS: tuple[Place, ...] = (_between("LPSI", "RPSI"), "SACR")
_PLUG_IN_GAIT = tuple(_plug_in_gait(back, medial) for medial in (*_MEDIAL, None) for back in _BACKS)

# Names as they are misspelt in the files.
_HORST_WRISTS = {"L": ("L WRIST LAT", "L WIRST MED"), "R": ("R WIRST LAT", "R WRITS MED")}
_HORST_THIGHS = {
    "L": ("L THIGH 1", "L THIGH 2", "L THIGH 3", "L THIGH 4"),
    "R": ("R THIGH  1", "R THIGH 2", "R THIGH 3", "R THIGH 4"),
}


def _horst_limbs(letter: str, other: str) -> dict[str, Place]:
    """Return the places of one side's limbs.

    A hip lies a quarter of the way from the greater trochanter of its side to the other one (Weinhandl & O'Connor
    2010, J. Biomech. 43, 2633-2636).
    """
    pelvis = _between("L GTROCH", "R GTROCH")
    return {
        "shoulder": Estimate(shoulder_center, (f"{letter} ACROMION", f"{other} ACROMION", pelvis)),
        "elbow": _between(f"{letter} ELBOW LAT", f"{letter} ELBOW MED"),
        "wrist": _between(*_HORST_WRISTS[letter]),
        "hip": {f"{letter} GTROCH": 0.75, f"{other} GTROCH": 0.25},
        "knee": _between(f"{letter} KNEE LAT", f"{letter} KNEE MED"),
        "ankle": _between(f"{letter} ANKLE LAT", f"{letter} ANKLE MED"),
        "heel": f"{letter} HEEL",
        "toe": _between(f"{letter} FOOT LAT", f"{letter} FOOT MED"),
    }


def _horst_segments(letter: str) -> tuple[Segment, Segment]:
    """Return thigh and shank, which carry the knee and ankle markers of the static trial."""
    knee = (f"{letter} KNEE LAT", f"{letter} KNEE MED")
    ankle = (f"{letter} ANKLE LAT", f"{letter} ANKLE MED")
    shank = tuple(f"{letter} SHANK {number}" for number in range(1, 5))
    return Segment(_HORST_THIGHS[letter], knee), Segment(shank, knee + ankle)


# Markers of Horst, Lapuschkin, Samek, Mueller & Schoellhorn 2019, a public dataset of overground walking.
_HORST = Rig(
    "horst",
    {
        "head": _between("L HEAD", "R HEAD"),
        "clavicle": _between("C7", "STERNUM"),
        "pelvis": _between("L GTROCH", "R GTROCH"),
    }
    | {f"left_{joint}": place for joint, place in _horst_limbs("L", "R").items()}
    | {f"right_{joint}": place for joint, place in _horst_limbs("R", "L").items()},
    segments=_horst_segments("L") + _horst_segments("R"),
)

MARKER_RIGS: tuple[Rig, ...] = (_TROJE15, _KINECT, *_PLUG_IN_GAIT, _HORST)
"""Rigs of marker sets; the first one that fits is taken, so that those with medial markers come first."""
