"""Markers on the skin of bodies whose joint centres are known."""

from dataclasses import replace
from functools import cache

import numpy as np

from eigenwalker import make_walkers
from eigenwalker.motion import MarkerSet, Walk

__all__ = ["horst_markers", "known_body", "mirrored", "moved", "plug_in_gait_markers"]

UP = np.array([0.0, 0.0, 1.0])
SIDES = {"left": "L", "right": "R"}
_BONES = (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"))


@cache
def known_body(seed=0, n_frames=120):
    """Return a synthetic walk of the 15 markers, along x."""
    walk = make_walkers(1, random_state=seed).data[0]
    return replace(walk, positions=walk.positions[:n_frames], name="anna", speed=float("nan"))


def _unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _pelvis_axes(body):
    """Return forward, left and up of the pelvis, each of shape (n_frames, 3)."""
    left = _unit(body.marker("left_hip") - body.marker("right_hip"))
    forward = _unit(np.cross(left, UP))
    return forward, left, np.cross(forward, left)


def _bone_axes(body, side, top, bottom):
    """Return forward and outward, at right angles to a bone and turning with it, each of shape (n_frames, 3)."""
    along = _unit(body.marker(f"{side}_{bottom}") - body.marker(f"{side}_{top}"))
    left = _pelvis_axes(body)[1]
    left = _unit(left - np.sum(left * along, axis=1, keepdims=True) * along)
    return np.cross(along, left), left if side == "left" else -left


def _walk(body, markers):
    positions = np.stack(list(markers.values()), axis=1)
    return Walk(positions, body.frame_rate, MarkerSet(tuple(markers)), body.name)


def plug_in_gait_markers(body, *, medial=("KNM", "MED"), sacrum=False):
    """Return the markers of Plug-in Gait on a body.

    The pelvis is as wide as the regression of Harrington et al. 2007 has it for the distance between the hips, and
    lies where that regression finds these hips.
    """
    forward, left, up = _pelvis_axes(body)
    middle = (body.marker("left_hip") + body.marker("right_hip")) / 2
    apart = np.linalg.norm(body.marker("left_hip") - body.marker("right_hip"), axis=1, keepdims=True)
    width, depth = (apart / 2 - 0.0073) / 0.33, 0.15
    front = middle + (0.24 * depth + 0.0099) * forward + (0.30 * width + 0.0109) * up
    back = front - depth * forward
    markers = {"LASI": front + width / 2 * left, "RASI": front - width / 2 * left}
    markers |= {"SACR": back} if sacrum else {"LPSI": back + 0.04 * left, "RPSI": back - 0.04 * left}
    head, neck = body.marker("head"), body.marker("clavicle")
    for name, ahead, aside in (("LFHD", 1, 1), ("RFHD", 1, -1), ("LBHD", -1, 1), ("RBHD", -1, -1)):
        markers[name] = head + 0.09 * ahead * forward + 0.07 * aside * left
    markers |= {"C7": neck - 0.06 * forward, "CLAV": neck + 0.06 * forward, "T10": neck - 0.2 * up}
    apart = np.linalg.norm(body.marker("left_shoulder") - body.marker("right_shoulder"), axis=1, keepdims=True)
    for side, letter in SIDES.items():
        (_, thigh), (_, shank), (_, arm) = (_bone_axes(body, side, *ends) for ends in _BONES)
        hip, knee, ankle = (body.marker(f"{side}_{joint}") for joint in ("hip", "knee", "ankle"))
        markers[f"{letter}SHO"] = body.marker(f"{side}_shoulder") + 0.17 * apart * up
        markers[f"{letter}ELB"] = body.marker(f"{side}_elbow") + 0.04 * arm
        wrist = body.marker(f"{side}_wrist")
        markers |= {f"{letter}WRA": wrist + 0.03 * forward, f"{letter}WRB": wrist - 0.03 * forward}
        markers |= {f"{letter}KNE": knee + 0.05 * thigh, f"{letter}ANK": ankle + 0.043 * shank}
        markers |= {f"{letter}THI": (hip + knee) / 2 + 0.09 * thigh, f"{letter}TIB": (knee + ankle) / 2 + 0.07 * shank}
        if medial is not None:
            markers |= {f"{letter}{medial[0]}": knee - 0.05 * thigh, f"{letter}{medial[1]}": ankle - 0.043 * shank}
        markers |= {f"{letter}HEE": ankle - 0.05 * forward - 0.05 * UP, f"{letter}TOE": ankle + 0.14 * forward}
    return _walk(body, markers)


def horst_markers(body, *, knees=True):
    """Return the markers of Horst et al. 2019 that make the 15 markers, with those on knees and ankles or without."""
    forward, left, up = _pelvis_axes(body)
    middle = (body.marker("left_hip") + body.marker("right_hip")) / 2
    head, neck = body.marker("head"), body.marker("clavicle")
    markers = {"L HEAD": head + 0.07 * left, "R HEAD": head - 0.07 * left}
    markers |= {"C7": neck + 0.08 * up - 0.05 * forward, "STERNUM": neck - 0.08 * up + 0.05 * forward}
    apart = np.linalg.norm(body.marker("left_shoulder") - body.marker("right_shoulder"), axis=1, keepdims=True)
    wrists = {"L": ("L WRIST LAT", "L WIRST MED"), "R": ("R WIRST LAT", "R WRITS MED")}
    for side, letter in SIDES.items():
        axes = [_bone_axes(body, side, *ends) for ends in _BONES]
        (_, thigh), (_, shank), (_, arm) = axes
        hip, knee, ankle = (body.marker(f"{side}_{joint}") for joint in ("hip", "knee", "ankle"))
        elbow, wrist = body.marker(f"{side}_elbow"), body.marker(f"{side}_wrist")
        markers[f"{letter} ACROMION"] = body.marker(f"{side}_shoulder") + 0.17 * apart * up
        markers |= {f"{letter} ELBOW LAT": elbow + 0.04 * arm, f"{letter} ELBOW MED": elbow - 0.04 * arm}
        markers |= {wrists[letter][0]: wrist + 0.03 * forward, wrists[letter][1]: wrist - 0.03 * forward}
        markers[f"{letter} GTROCH"] = middle + 2 * (hip - middle)
        for segment, top, bottom, (ahead, out) in (("THIGH", hip, knee, axes[0]), ("SHANK", knee, ankle, axes[1])):
            for number, (share, way) in enumerate(((0.6, 0.04), (0.6, -0.03), (0.8, 0.03), (0.85, -0.04)), 1):
                blanks = "  " if (letter, segment, number) == ("R", "THIGH", 1) else " "
                markers[f"{letter} {segment}{blanks}{number}"] = top + share * (bottom - top) + 0.06 * out + way * ahead
        if knees:
            markers |= {f"{letter} KNEE LAT": knee + 0.05 * thigh, f"{letter} KNEE MED": knee - 0.05 * thigh}
            markers |= {f"{letter} ANKLE LAT": ankle + 0.04 * shank, f"{letter} ANKLE MED": ankle - 0.04 * shank}
        toe = ankle + 0.14 * forward - 0.05 * UP
        markers[f"{letter} HEEL"] = ankle - 0.05 * forward - 0.04 * UP
        markers |= {f"{letter} FOOT LAT": toe + 0.04 * shank, f"{letter} FOOT MED": toe - 0.04 * shank}
    return _walk(body, markers)


def moved(walk, rotation, shift):
    """Return a walk after a rigid motion, `rotation` a matrix."""
    return replace(walk, positions=walk.positions @ np.asarray(rotation).T + shift)


def mirrored(walk):
    """Return a walk seen in a mirror, with the names of the markers of the other side."""
    odd = {"L WIRST MED": "R WRITS MED", "L WRIST LAT": "R WIRST LAT", "L THIGH 1": "R THIGH  1"}
    swap = odd | {right: left for left, right in odd.items()}
    letters = {"L": "R", "R": "L"}
    sides = ("L ", "R ", *(f"{letter}{part}" for letter in "LR" for part in ("F", "B", "A", "P", "S", "E", "W")))
    sides += tuple(f"{letter}{part}" for letter in "LR" for part in ("K", "T", "H", "M"))
    names = [
        swap.get(name, letters[name[0]] + name[1:] if name.startswith(sides) else name)
        for name in walk.marker_set.names
    ]
    return replace(walk, positions=walk.positions * [1.0, -1.0, 1.0], marker_set=MarkerSet(tuple(names)))
