"""Which way a walker goes and faces, and turning walks to the x axis."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.path import swing_direction
from eigenwalker.motion.walk import Walk

__all__ = ["facing", "first_direction", "floor_points", "leftward", "leg_difference", "travels", "turn"]

_TRAVEL_SPEED = 0.15  # m/s over the whole clip; slower is swaying on a treadmill, not going anywhere
_PAIRS = ("hip", "shoulder")


def floor_points(walk: Walk, marker: str) -> NDArray[np.floating]:
    """Return x and y of a marker, shape (n_frames, 2)."""
    return walk.marker(marker)[:, :2]


def travels(walk: Walk) -> bool:
    """Return whether the pelvis goes somewhere: a straight line through its path rises by more than 0.15 m/s."""
    pelvis = floor_points(walk, "pelvis")
    times = (np.arange(len(pelvis)) - (len(pelvis) - 1) / 2) / walk.frame_rate
    velocity = times @ pelvis / max(times @ times, 1e-12)  # slope of the straight line through the path
    return bool(np.hypot(*velocity) > _TRAVEL_SPEED)


def leg_difference(walk: Walk) -> NDArray[np.floating]:
    """Return left minus right ankle over the floor, shape (n_frames, 2)."""
    return floor_points(walk, "left_ankle") - floor_points(walk, "right_ankle")


def leftward(walk: Walk) -> NDArray[np.float64]:
    """Return the vector over the floor from the right side of the body to the left, shape (n_frames, 2).

    Hips and, where there are any, shoulders are added up, so that their turning against each other cancels.
    """
    pairs = [pair for pair in _PAIRS if f"left_{pair}" in walk.marker_set.names]
    return np.sum([floor_points(walk, f"left_{pair}") - floor_points(walk, f"right_{pair}") for pair in pairs], axis=0)


def facing(walk: Walk) -> NDArray[np.float64]:
    """Return the mean direction over the floor that the pelvis faces, shape (2,), not of unit length."""
    across = (floor_points(walk, "left_hip") - floor_points(walk, "right_hip")).mean(axis=0)
    return np.array([across[1], -across[0]])


def first_direction(walk: Walk) -> NDArray[np.float64]:
    """Return the unit vector over the floor from start to end, or along which the legs swing in place."""
    if not travels(walk):
        across = (floor_points(walk, "left_hip") - floor_points(walk, "right_hip")).mean(axis=0)
        return swing_direction(leg_difference(walk), across)
    pelvis = floor_points(walk, "pelvis")
    return (pelvis[-1] - pelvis[0]) / np.hypot(*(pelvis[-1] - pelvis[0]))


def turn(walk: Walk, direction: NDArray[np.float64]) -> Walk:
    """Turn a walk about the vertical so that `direction` becomes x.

    Parameters
    ----------
    walk : Walk
        What to turn.
    direction : ndarray of shape (2,) or (n_frames, 2)
        Over the floor, of any length; one for all frames or one a frame.
    """
    cosine, sine = (np.atleast_2d(direction) / np.linalg.norm(direction, axis=-1, keepdims=True)).T  # each (1 or T,)
    zero, one = np.zeros_like(cosine), np.ones_like(cosine)
    rotation = np.array([[cosine, sine, zero], [-sine, cosine, zero], [zero, zero, one]])  # (3, 3, 1 or T)
    return replace(walk, positions=walk.positions @ rotation.transpose(2, 1, 0))
