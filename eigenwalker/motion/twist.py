"""Feet that do not twist on the floor while they stand."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from eigenwalker.motion._quaternions import product
from eigenwalker.motion.legs import LegPose
from eigenwalker.motion.planting import Hold

__all__ = ["lost_yaw", "turn_feet", "turn_left", "untwist_feet"]


def untwist_feet(pose: LegPose, holds: list[Hold]) -> LegPose:
    """Return where legs are when each foot that stands keeps its direction, turned about the vertical at its ankle.

    A harmonic series turns a standing foot by a few degrees, so that heel and toes could not stand still both.

    Parameters
    ----------
    pose : LegPose
        With the root at the origin.
    holds : list of Hold
        Of the left and the right foot.
    """
    return turn_feet(pose, lost_yaw(pose, holds))


def lost_yaw(pose: LegPose, holds: list[Hold]) -> NDArray[np.float64]:
    """Return by how much each foot is to be turned to the left so that it keeps its direction while it stands.

    Parameters
    ----------
    pose : LegPose
        Where the legs are.
    holds : list of Hold
        Of the left and the right foot.

    Returns
    -------
    ndarray of shape (n_frames, 2)
        In radians.
    """
    yaw = _yaw(pose.feet)
    return np.column_stack([hold.amount * (yaw[hold.middle, foot] - yaw[:, foot]) for foot, hold in enumerate(holds)])


def turn_feet(pose: LegPose, angles: NDArray[np.float64]) -> LegPose:
    """Return where legs are when their feet are turned to the left at the ankles, by angles (n_frames, 2)."""
    return pose._replace(
        feet=turn_left(pose.feet, angles),
        toes=turn_left(pose.toes, angles),  # they go along
        soles=_turn_about(pose.soles, pose.ankles, angles),
    )


@njit(cache=True, nogil=True)
def _yaw(feet):
    """Return where the x axes of quaternions (n_frames, 2, 4) point, in radians to the left, without jumps."""
    yaw, turn = np.empty(feet.shape[:2]), 2.0 * np.pi
    for t in range(len(feet)):
        for foot in range(feet.shape[1]):
            w, x, y, z = feet[t, foot, 0], feet[t, foot, 1], feet[t, foot, 2], feet[t, foot, 3]
            yaw[t, foot] = np.arctan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z))
            if t > 0:
                yaw[t, foot] += turn * np.round((yaw[t - 1, foot] - yaw[t, foot]) / turn)
    return yaw


@njit(cache=True, nogil=True)
def _turn_about(soles, ankles, angles):
    """Return points (n_frames, 2, n_points, 3) turned to the left about others (n_frames, 2, 3)."""
    out = np.empty(soles.shape)
    for t in range(len(soles)):
        for foot in range(soles.shape[1]):
            cosine, sine = np.cos(angles[t, foot]), np.sin(angles[t, foot])
            for point in range(soles.shape[2]):
                x, y = soles[t, foot, point, 0] - ankles[t, foot, 0], soles[t, foot, point, 1] - ankles[t, foot, 1]
                out[t, foot, point, 0] = ankles[t, foot, 0] + cosine * x - sine * y
                out[t, foot, point, 1] = ankles[t, foot, 1] + sine * x + cosine * y
                out[t, foot, point, 2] = soles[t, foot, point, 2]
    return out


def turn_left(values: NDArray[np.float64], angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points or quaternions turned to the left about the vertical.

    Parameters
    ----------
    values : ndarray of shape (n_frames, 3), (n_frames, 4) or (n_frames, 2, 4)
        Points, or quaternions with w first.
    angles : ndarray of shape (n_frames,) or (n_frames, 2)
        In radians; one a frame, or one for each leg.
    """
    if not angles.any():
        return values
    rows = np.ascontiguousarray(values, dtype=np.float64).reshape(angles.size, -1)  # one an angle
    turn = _turn_points if rows.shape[1] == 3 else _turn_quaternions
    return turn(rows, np.ascontiguousarray(angles, dtype=np.float64).ravel()).reshape(values.shape)


@njit(cache=True, nogil=True)
def _turn_points(points, angles):
    out = np.empty(points.shape)
    for i in range(len(points)):
        cosine, sine = np.cos(angles[i]), np.sin(angles[i])
        out[i, 0] = cosine * points[i, 0] - sine * points[i, 1]
        out[i, 1] = sine * points[i, 0] + cosine * points[i, 1]
        out[i, 2] = points[i, 2]
    return out


@njit(cache=True, nogil=True)
def _turn_quaternions(turns, angles):
    out = np.empty(turns.shape)
    for i in range(len(turns)):
        half = 0.5 * angles[i]
        before = (turns[i, 0], turns[i, 1], turns[i, 2], turns[i, 3])
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = product((np.cos(half), 0.0, 0.0, np.sin(half)), before)
    return out
