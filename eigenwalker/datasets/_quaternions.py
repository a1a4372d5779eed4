"""Products of rotations about coordinate axes, as quaternions (w, x, y, z) with time first.

A product of two acts like that of matrices: the right one first.
"""

import numpy as np
from numpy.typing import NDArray

__all__ = ["about", "conjugate", "product", "rotvec"]


def about(axis: str, angle: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Return the rotation by `angle` radians about the axis "x", "y" or "z", shape (n_frames, 4)."""
    half = np.atleast_1d(angle) / 2
    turn = np.zeros((len(half), 4))
    turn[:, 0], turn[:, 1 + "xyz".index(axis)] = np.cos(half), np.sin(half)
    return turn


def conjugate(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the inverse rotation."""
    return rotation * np.array([1.0, -1.0, -1.0, -1.0])


def product(left: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation that turns by `right`, then by `left`."""
    a, b, c, d = left.T
    w, x, y, z = right.T
    return np.column_stack((
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ))  # fmt: skip


def rotvec(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return exponential maps, shape (n_frames, 3), of rotations by less than half a turn."""
    sine = np.linalg.norm(rotation[:, 1:], axis=1)
    angle = 2 * np.arctan2(sine, rotation[:, 0])
    small = sine < 1e-12
    scale = np.where(small, 2.0, angle / np.where(small, 1.0, sine))
    return rotation[:, 1:] * scale[:, np.newaxis]
