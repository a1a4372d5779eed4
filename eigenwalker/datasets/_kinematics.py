"""From joint angles to a body whose stance foot stays on the ground."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.datasets._anatomy import JOINTS, MARKER_JOINTS
from eigenwalker.datasets._gait_curves import AXIAL_CURVES, LIMB_CURVES
from eigenwalker.datasets._quaternions import about, conjugate, product, rotvec
from eigenwalker.motion import Skeleton, forward_kinematics

__all__ = ["Posture", "posture", "stance_height", "stance_velocity", "support"]

_LOADING = 0.13  # strides over which the body's weight goes from one foot to the other
_EARLY = 0.03  # strides before its phase zero at which a foot, already near the ground, begins to carry
_SINK = 0.01  # metres by which the other foot may be below the floor before it lifts the body
_SOFTNESS = 0.004  # metres by which heel or ball must be lower to be the one on the ground


class Posture(NamedTuple):
    """Where a body is that is held at the center of its pelvis.

    Parameters
    ----------
    markers : ndarray of shape (n_frames, 15, 3)
        The virtual markers, in metres from the pelvis.
    soles : ndarray of shape (n_frames, 2, 2, 3)
        Left and right foot, heel and ball.
    """

    markers: NDArray[np.float64]
    soles: NDArray[np.float64]


def posture(
    skeleton: Skeleton, axial: NDArray[np.float64], left: NDArray[np.float64], right: NDArray[np.float64]
) -> Posture:
    """Return the body for joint angles in radians.

    Parameters
    ----------
    skeleton : Skeleton
        From `body_skeleton`.
    axial : ndarray of shape (n_frames, n_axial_curves)
        Angles of pelvis, trunk and neck, in the order of `AXIAL_CURVES`.
    left, right : ndarray of shape (n_frames, n_limb_curves)
        Angles of the limbs, in the order of `LIMB_CURVES`.

    Returns
    -------
    Posture
    """
    rotations = np.zeros((len(axial), len(JOINTS), 3))
    angles = dict(zip(AXIAL_CURVES, axial.T, strict=True))
    pelvis, trunk = (_turned(angles, part) for part in ("pelvis", "trunk"))
    upright = conjugate(pelvis)
    rotations[:, JOINTS.index("pelvis")] = rotvec(pelvis)
    rotations[:, JOINTS.index("thorax")] = rotvec(product(upright, trunk))
    nod = product(about("x", angles["neck_obliquity"]), about("y", angles["neck_flexion"]))
    rotations[:, JOINTS.index("clavicle")] = rotvec(nod)
    for side, sign, limb in (("left", 1.0, left), ("right", -1.0, right)):
        flexion = dict(zip(LIMB_CURVES, limb.T, strict=True))
        hip, shoulder = (_swung(flexion, joint, sign) for joint in ("hip", "shoulder"))
        # Thigh and foot have their angles in the room, so what is above them is taken out.
        bend = flexion["hip_flexion"] - flexion["knee_flexion"] - flexion["foot_pitch"]
        rotations[:, JOINTS.index(f"{side}_hip")] = rotvec(product(upright, hip))
        rotations[:, JOINTS.index(f"{side}_shoulder")] = rotvec(shoulder)
        rotations[:, JOINTS.index(f"{side}_knee"), 1] = flexion["knee_flexion"]
        rotations[:, JOINTS.index(f"{side}_ankle"), 1] = bend
        rotations[:, JOINTS.index(f"{side}_elbow"), 1] = -flexion["elbow_flexion"]
    offsets = np.broadcast_to(skeleton.offsets, rotations.shape)
    joints, frames = forward_kinematics(rotations, offsets, skeleton.parents)
    feet = skeleton.end_parents
    soles = joints[:, feet] + np.einsum("teij,ej->tei", frames[:, feet], skeleton.end_offsets)
    return Posture(joints[:, MARKER_JOINTS], soles.reshape(len(axial), 2, 2, 3))  # 4 tips -> 2 feet, heel and ball


def _turned(angles: dict[str, NDArray[np.float64]], part: str) -> NDArray[np.float64]:
    """Rotation, then obliquity, then tilt, each about the axis that the one before has left."""
    level = product(about("z", angles[f"{part}_rotation"]), about("x", angles[f"{part}_obliquity"]))
    return product(level, about("y", angles[f"{part}_tilt"]))


def _swung(angles: dict[str, NDArray[np.float64]], joint: str, sign: float) -> NDArray[np.float64]:
    """Turn a hanging limb inward about its axis, lift it forward, and then the plane it moves in outward."""
    flexed = product(about("x", sign * angles[f"{joint}_abduction"]), about("y", -angles[f"{joint}_flexion"]))
    return product(flexed, about("z", -sign * angles[f"{joint}_rotation"]))


def support(phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the share of the body's weight on each foot, shape (n_phases, 2), left first.

    Parameters
    ----------
    phase : ndarray of shape (n_phases,)
        In strides from the heel strike of the left foot. The right one follows half a stride later.
    """
    carried = (phase + _EARLY) % 1.0
    onto_left = np.clip(carried / _LOADING, 0.0, 1.0)
    onto_right = np.clip((carried - 0.5) / _LOADING, 0.0, 1.0)
    left = _smooth(onto_left) - _smooth(onto_right)
    return np.column_stack((left, 1.0 - left))


def _smooth(share: NDArray[np.float64]) -> NDArray[np.float64]:
    return share**3 * (10.0 + share * (6.0 * share - 15.0))


def _ground_shares(soles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share of heel and ball in the contact of each foot, shape (n_frames, 2, 2)."""
    ball = 1.0 / (1.0 + np.exp(np.clip((soles[:, :, 1, 2] - soles[:, :, 0, 2]) / _SOFTNESS, -50.0, 50.0)))
    return np.stack((1.0 - ball, ball), axis=2)


def stance_height(soles: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how high the pelvis is when the standing foot touches the floor, shape (n_frames,), in metres.

    Heel and ball are joined by a soft minimum, the two feet by their share of the weight, so that the hand-over from
    one to the other is smooth. The other foot counts only where it would sink into the floor.

    Parameters
    ----------
    soles : ndarray of shape (n_frames, 2, 2, 3)
        From `posture`.
    weight : ndarray of shape (n_frames, 2)
        From `support`.
    """
    lowest = -_soft_maximum(-soles[..., 2])  # of each foot, (n_frames, 2)
    standing = -(weight * lowest).sum(axis=1)
    return _soft_maximum(np.column_stack((standing, -lowest - _SINK)))


def _soft_maximum(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the maximum along the last axis, rounded off where two values are about equal."""
    top = values.max(axis=-1)
    return top + _SOFTNESS * np.log(np.exp((values - top[..., np.newaxis]) / _SOFTNESS).sum(axis=-1))


def stance_velocity(soles: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how the pelvis moves over the floor in a closed stride, shape (n_phases, 2), in metres per stride.

    The point of the sole that touches the ground stays where it is, so the pelvis moves against it.

    Parameters
    ----------
    soles : ndarray of shape (n_phases, 2, 2, 3)
        From `posture`, at evenly spaced phases of one stride.
    weight : ndarray of shape (n_phases, 2)
        From `support`.
    """
    floor = soles[..., :2]
    velocity = (np.roll(floor, -1, axis=0) - np.roll(floor, 1, axis=0)) * (len(soles) / 2)
    shares = weight[:, :, np.newaxis] * _ground_shares(soles)
    return -np.einsum("tfc,tfci->ti", shares, velocity)
