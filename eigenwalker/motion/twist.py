"""Feet that do not twist on the floor while they stand."""

import numpy as np
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
    values : ndarray of shape (n_frames, ...)
        Points, or matrices whose columns are turned.
    angles : ndarray of shape (n_frames,) or (n_frames, 2)
        In radians; one a frame, or one for each leg.
    axis : int, default -1
        The axis of x, y and z; -2 for matrices.
    """
    if not angles.any():
        return values
    parts = np.moveaxis(values, axis, 0)
    shape = (*angles.shape, *[1] * (parts.ndim - 1 - angles.ndim))
    cosine, sine = np.cos(angles).reshape(shape), np.sin(angles).reshape(shape)
    turned = np.empty(values.shape)
    x, y, z = np.moveaxis(turned, axis, 0)
    x[...], y[...], z[...] = cosine * parts[0] - sine * parts[1], sine * parts[0] + cosine * parts[1], parts[2]
    return turned
