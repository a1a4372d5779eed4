"""Rotations and vectors inside of compiled loops: quaternions (w, x, y, z) and vectors (x, y, z) as tuples of floats.

Tuples stay in registers, while small arrays are looked up, counted and freed.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = [
    "about",
    "added",
    "cross",
    "dot",
    "from_rotvec",
    "length",
    "product",
    "product_of_inverse",
    "rotvecs_between",
    "shortest_turn",
    "subtracted",
    "to_rotvec",
    "turned",
]


@njit(cache=True, nogil=True, error_model="numpy")
def from_rotvec(rotvec):
    """Return the quaternion of an exponential map."""
    x, y, z = rotvec
    angle = np.sqrt(x * x + y * y + z * z)
    scale = 0.5 if angle < 1e-12 else np.sin(0.5 * angle) / angle
    return np.cos(0.5 * angle), scale * x, scale * y, scale * z


@njit(cache=True, nogil=True, error_model="numpy")
def to_rotvec(turn):
    """Return the exponential map, of at most half a turn, of a quaternion."""
    w, x, y, z = turn
    sine = np.sqrt(x * x + y * y + z * z)
    sign = -1.0 if w < 0 else 1.0
    scale = sign * (2.0 if sine < 1e-12 else 2.0 * np.arctan2(sine, sign * w) / sine)
    return scale * x, scale * y, scale * z


@njit(cache=True, nogil=True, error_model="numpy")
def about(axis, angle):
    """Return the quaternion of a turn about an axis of any length."""
    scale = np.sin(0.5 * angle) / length(axis)
    return np.cos(0.5 * angle), scale * axis[0], scale * axis[1], scale * axis[2]


@njit(cache=True, nogil=True, error_model="numpy")
def shortest_turn(start, end):
    """Return the quaternion that turns one direction into another, which is not its opposite."""
    x, y, z = cross(start, end)
    w = length(start) * length(end) + dot(start, end)
    scale = 1.0 / np.sqrt(w * w + x * x + y * y + z * z)
    return scale * w, scale * x, scale * y, scale * z


@njit(cache=True, nogil=True, error_model="numpy")
def product(a, b):
    """Return the quaternion of a turn b that is followed by a turn a."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


@njit(cache=True, nogil=True, error_model="numpy")
def product_of_inverse(a, b):
    """Return the quaternion that leads from a to b, in the axes of a."""
    return product((a[0], -a[1], -a[2], -a[3]), b)


@njit(cache=True, nogil=True, error_model="numpy")
def turned(turn, vector):
    """Return a vector turned by a quaternion: v + 2 w (u x v) + 2 u x (u x v), u its vector part."""
    u = (turn[1], turn[2], turn[3])
    x, y, z = cross(u, vector)
    once = (2.0 * x, 2.0 * y, 2.0 * z)
    x, y, z = cross(u, once)
    return vector[0] + turn[0] * once[0] + x, vector[1] + turn[0] * once[1] + y, vector[2] + turn[0] * once[2] + z


@njit(cache=True, nogil=True, error_model="numpy")
def added(a, b):
    """Return the sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit(cache=True, nogil=True, error_model="numpy")
def subtracted(a, b):
    """Return a vector less another one."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(cache=True, nogil=True, error_model="numpy")
def dot(a, b):
    """Return the scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, nogil=True, error_model="numpy")
def cross(a, b):
    """Return the vector product of two vectors."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True, nogil=True, error_model="numpy")
def length(vector):
    """Return the length of a vector."""
    return np.sqrt(dot(vector, vector))


def rotvecs_between(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the exponential maps that lead from some quaternions to others, both (n_frames, 4), in their own axes."""
    return _rotvecs_between(*(np.ascontiguousarray(part, dtype=np.float64) for part in (first, second)))


@njit(cache=True, nogil=True)
def _rotvecs_between(first, second):
    out = np.empty((len(first), 3))
    for t in range(len(first)):
        one = (first[t, 0], first[t, 1], first[t, 2], first[t, 3])
        other = (second[t, 0], second[t, 1], second[t, 2], second[t, 3])
        out[t, 0], out[t, 1], out[t, 2] = to_rotvec(product_of_inverse(one, other))
    return out
