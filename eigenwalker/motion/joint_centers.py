"""Where joint centres lie under markers on the skin: published rules, frame by frame.

All take paths of shape (n_frames, 3), in metres, and return one. They turn and move with the body, they know no
left and right but what they are told, and a frame's result depends on that frame only.
"""

import numpy as np
from numpy.typing import NDArray

__all__ = ["hip_center", "inward_center", "midpoint", "shoulder_center"]

Path = NDArray[np.float64]

_SHOULDER_DROP = 0.17  # of the distance between the acromia


def midpoint(first: Path, second: Path) -> Path:
    """Return the middle between two places."""
    return (first + second) / 2


def hip_center(left_asis: Path, right_asis: Path, back: Path, *, side: str) -> Path:
    """Return a hip joint centre from the pelvis, by the regression of Harrington et al.

    In the axes of the pelvis, from the middle between the anterior superior iliac spines, in millimetres:
    0.24 PD + 9.9 backward, 0.30 PW + 10.9 down and 0.33 PW + 7.3 to the side, with the pelvic width PW between the
    two anterior spines and the pelvic depth PD from their middle to the middle of the posterior spines (Harrington,
    Zavatsky, Lawson, Yuan & Theologis 2007, J. Biomech. 40, 595-602, the equations without leg length).

    Parameters
    ----------
    left_asis, right_asis : ndarray of shape (n_frames, 3)
        Anterior superior iliac spines. The skin over the spines is taken for the spines.
    back : ndarray of shape (n_frames, 3)
        Middle of the posterior superior iliac spines, or a marker on the sacrum between them.
    side : {"left", "right"}
        The hip.
    """
    front, across = midpoint(left_asis, right_asis), left_asis - right_asis
    width = _length(across)
    depth = _length(front - back)
    leftward = across / width
    forward = _unit(_square_to(front - back, leftward))
    up = np.cross(forward, leftward)
    outward = leftward if side == "left" else -leftward
    return front - (0.24 * depth + 0.0099) * forward - (0.30 * width + 0.0109) * up + (0.33 * width + 0.0073) * outward


def shoulder_center(acromion: Path, other_acromion: Path, pelvis: Path) -> Path:
    """Return a shoulder joint centre: below the acromion by 17 % of the distance between the acromia.

    The constant offset of Rab, Petuskey & Bagley 2002 (Gait Posture 15, 113-119). Down is from the middle of the
    shoulders to the pelvis, at right angles to the line between the acromia.
    """
    across = other_acromion - acromion
    down = _unit(_square_to(pelvis - midpoint(acromion, other_acromion), _unit(across)))
    return acromion + _SHOULDER_DROP * _length(across) * down


def inward_center(lateral: Path, proximal: Path, side: Path, other_side: Path, *, share: float) -> Path:
    """Return an estimate of a knee, ankle or elbow centre where only the lateral marker is there.

    The marker is moved towards the other side of the body, at right angles to the line that leads to it from the
    joint above, by a share of that line's length. This is an assumption and no measurement: the axis of the joint
    is taken for parallel to the line between the hips (or shoulders), and the breadth of the joint for that of an
    average adult. A joint broader by 2 cm has its centre 1 cm further in. In the static trial of Horst et al. 2019 the
    estimates lie up to 7 mm (knee) and 18 mm (ankle, elbow) from the middle between both markers. Record a medial
    marker, at least in a static trial, to do better.

    Parameters
    ----------
    lateral, proximal : ndarray of shape (n_frames, 3)
        The marker, and the centre of the joint above.
    side, other_side : ndarray of shape (n_frames, 3)
        The hip or shoulder of this side and the one of the other side.
    share : float
        How far the centre is from the marker, over the distance from the joint above to the marker.
    """
    limb = lateral - proximal
    inward = _unit(_square_to(other_side - side, _unit(limb)))
    return lateral + share * _length(limb) * inward


def _length(vectors: Path) -> Path:
    return np.linalg.norm(vectors, axis=-1, keepdims=True)


def _unit(vectors: Path) -> Path:
    return vectors / _length(vectors)


def _square_to(vectors: Path, axis: Path) -> Path:
    """Return the part of some vectors at right angles to a unit vector."""
    return vectors - np.sum(vectors * axis, axis=-1, keepdims=True) * axis
