"""Feet that do not twist on the floor while they stand."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

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
    yaw = np.unwrap(np.arctan2(pose.feet[:, :, 1, 0], pose.feet[:, :, 0, 0]), axis=0)
    return np.column_stack([hold.amount * (yaw[hold.middle, foot] - yaw[:, foot]) for foot, hold in enumerate(holds)])


def turn_feet(pose: LegPose, angles: NDArray[np.float64]) -> LegPose:
    """Return where legs are when their feet are turned to the left at the ankles, by angles (n_frames, 2)."""
    ankles = pose.ankles[:, :, np.newaxis]  # beside the points of the sole
    return pose._replace(
        feet=turn_left(pose.feet, angles, axis=-2),
        toes=turn_left(pose.toes, angles, axis=-2),  # they go along
        soles=ankles + turn_left(pose.soles - ankles, angles),
    )


def turn_left(values: NDArray[np.float64], angles: NDArray[np.float64], *, axis: int = -1) -> NDArray[np.float64]:
    """Return vectors turned to the left about the vertical.

    Parameters
    ----------
    values : ndarray of shape (n_frames, ..., 3)
        Points, or matrices (n_frames, ..., 3, 3), one an angle, whose columns are turned.
    angles : ndarray of shape (n_frames,) or (n_frames, 2)
        In radians; one a frame, or one for each leg.
    axis : int, default -1
        The axis of x, y and z; -2 for matrices.
    """
    if not angles.any():
        return values
    legs = angles.size // len(angles)
    whole = np.ascontiguousarray(values, dtype=np.float64).reshape(len(angles) * legs, -1, 3)  # rows of three numbers
    return _turn_left(whole, np.ascontiguousarray(angles, dtype=np.float64).ravel(), axis == -2).reshape(values.shape)


@njit(cache=True, nogil=True)
def _turn_left(values, angles, columns):
    """Turn rows of three numbers, or the columns of three rows, by an angle for each group of rows."""
    out = np.empty(values.shape)
    n_rows = values.shape[1]
    for i in range(len(values)):
        cosine, sine = np.cos(angles[i]), np.sin(angles[i])
        if columns:
            for j in range(3):
                out[i, 0, j] = cosine * values[i, 0, j] - sine * values[i, 1, j]
                out[i, 1, j] = sine * values[i, 0, j] + cosine * values[i, 1, j]
                out[i, 2, j] = values[i, 2, j]
        else:
            for row in range(n_rows):
                out[i, row, 0] = cosine * values[i, row, 0] - sine * values[i, row, 1]
                out[i, row, 1] = sine * values[i, row, 0] + cosine * values[i, row, 1]
                out[i, row, 2] = values[i, row, 2]
    return out
