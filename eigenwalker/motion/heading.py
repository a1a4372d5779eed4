"""Which way a walker goes and faces, and turning walks to the x axis."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.motion.fourier import SEARCH_HARMONICS, evaluate_harmonics, fit_harmonics
from eigenwalker.motion.path import swing_direction
from eigenwalker.motion.walk import Walk

__all__ = [
    "across_pairs",
    "check_in_place",
    "facing",
    "first_direction",
    "floor_points",
    "floor_velocity",
    "leftward",
    "leg_difference",
    "one_stride",
    "swing",
    "travels",
    "turn",
    "turn_points",
]

_TRAVEL_SPEED = 0.15  # m/s over the whole clip; slower is swaying on a treadmill, not going anywhere
_PAIRS = ("hip", "shoulder")
_SAMPLES = 64  # of one stride: far more than its harmonics need


def floor_points(walk: Walk, marker: str) -> NDArray[np.floating]:
    """Return x and y of a marker, shape (n_frames, 2)."""
    return walk.marker(marker)[:, :2]


def floor_velocity(walk: Walk) -> NDArray[np.float64]:
    """Return the velocity of the pelvis over the floor, shape (2,), in m/s: the slope of a straight line through it."""
    pelvis = floor_points(walk, "pelvis")
    times = (np.arange(len(pelvis)) - (len(pelvis) - 1) / 2) / walk.frame_rate
    return walk.size * (times @ pelvis) / max(float(times @ times), 1e-12)


def travels(walk: Walk) -> bool:
    """Return whether the pelvis goes somewhere, at more than 0.15 m/s."""
    return bool(np.hypot(*floor_velocity(walk)) > _TRAVEL_SPEED)


def leg_difference(walk: Walk) -> NDArray[np.floating]:
    """Return left minus right ankle over the floor, shape (n_frames, 2)."""
    return floor_points(walk, "left_ankle") - floor_points(walk, "right_ankle")


def check_in_place(walk: Walk) -> None:
    """Raise unless a walk stays in place, as one from `prepare` does."""
    if travels(walk):
        raise WalkError(
            f"walk {walk.name!r}: expected a walk in place, got one that travels at "
            f"{np.hypot(*floor_velocity(walk)):.2g} m/s; prepare it with treadmill=True first"
        )


def across_pairs(walk: Walk) -> list[tuple[str, str]]:
    """Return the pairs of markers, left and right, that tell which way a body faces: the hips, and shoulders if any."""
    pairs = [(f"left_{joint}", f"right_{joint}") for joint in _PAIRS]
    return [pair for pair in pairs if set(pair) <= set(walk.marker_set.names)]


def leftward(walk: Walk) -> NDArray[np.float64]:
    """Return the vector over the floor from the right side of the body to the left, shape (n_frames, 2).

    Hips and, where there are any, shoulders are added up, so that their turning against each other cancels.
    """
    return np.sum([floor_points(walk, left) - floor_points(walk, right) for left, right in across_pairs(walk)], axis=0)


def one_stride(paths: NDArray[np.floating], frame_rate: float, frequency: float) -> NDArray[np.float64]:
    """Return one stride of paths (n_frames, n_paths), its harmonics without noise and drift, shape (64, n_paths).

    Means over a whole stride do not depend on where in a stride the recording starts and ends; means over frames do.
    """
    n_harmonics = max(1, min(SEARCH_HARMONICS, int(0.45 * frame_rate / frequency), (len(paths) - 2) // 3))
    coefficients = fit_harmonics(paths, frame_rate, frequency, n_harmonics)
    return evaluate_harmonics(coefficients, frequency, np.arange(_SAMPLES) / (_SAMPLES * frequency))


def facing(walk: Walk, frequency: float) -> NDArray[np.float64]:
    """Return the mean direction over the floor that the pelvis faces, shape (2,), not of unit length."""
    across = _across_hips(walk)
    left = one_stride(across, walk.frame_rate, frequency).mean(axis=0)
    if np.hypot(*left) <= 1e-9 * max(np.abs(across).max(), 1.0):
        raise WalkError(
            f"walk {walk.name!r}: left and right hip are in one place, so it faces nowhere; use a heading "
            "other than 'body'"
        )
    return np.array([left[1], -left[0]])


def swing(walk: Walk, frequency: float) -> NDArray[np.float64]:
    """Return the unit vector over the floor along which the legs swing, for walks that stay in place, shape (2,)."""
    paths = np.hstack((leg_difference(walk), _across_hips(walk)))  # (n_frames, 4)
    stride = one_stride(paths, walk.frame_rate, frequency)
    return swing_direction(stride[:, :2], stride[:, 2:].mean(axis=0))


def _across_hips(walk: Walk) -> NDArray[np.floating]:
    return floor_points(walk, "left_hip") - floor_points(walk, "right_hip")


def first_direction(walk: Walk) -> NDArray[np.float64]:
    """Return the unit vector over the floor in which a walk leads, or along which the legs swing in place.

    A first guess, before the stride is known.
    """
    if not travels(walk):
        return swing_direction(leg_difference(walk), _across_hips(walk).mean(axis=0))
    velocity = floor_velocity(walk)
    return velocity / np.hypot(*velocity)


def turn(walk: Walk, direction: NDArray[np.float64]) -> Walk:
    """Turn a walk about the vertical so that `direction` becomes x.

    Parameters
    ----------
    walk : Walk
        What to turn.
    direction : ndarray of shape (2,) or (n_frames, 2)
        Over the floor, of any length; one for all frames or one a frame.
    """
    turned = turn_points(walk.positions[..., :2], np.expand_dims(direction, -2))
    return replace(walk, positions=np.concatenate((turned, walk.positions[..., 2:]), axis=-1))


def turn_points(points: NDArray[np.floating], direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points over the floor, shape (..., 2), turned so that `direction`, of the same shape or one, becomes x."""
    cosine, sine = np.moveaxis(direction / np.linalg.norm(direction, axis=-1, keepdims=True), -1, 0)
    x, y = points[..., 0], points[..., 1]
    return np.stack((cosine * x + sine * y, cosine * y - sine * x), axis=-1)
