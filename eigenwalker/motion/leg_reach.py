"""Legs that reach for given places: inverse kinematics of hip, knee and ankle."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from eigenwalker.motion.rotations import rotation_matrix, rotvec_of_matrix

__all__ = ["Reach", "reach"]

_NEARLY_STRAIGHT = 0.9999  # of the length of a stretched leg; at all of it a knee would lock and jump
_MAX_ROLL = np.deg2rad(20.0)
_ROUNDING = 1e-14  # metres; the knee of a straight leg would turn by the root of it


class Reach(NamedTuple):
    """What `reach` returns.

    Parameters
    ----------
    rotations : ndarray of shape (n_frames, 3, 3)
        New exponential maps of hip, knee and ankle, in radians.
    foot : ndarray of shape (n_frames, 3, 3)
        Axes of the foot in the room.
    knee : ndarray of shape (n_frames,)
        By how much the knee bends more than before, in radians.
    missed : ndarray of shape (n_frames,)
        How far the ankle stays from where it should be, in metres.
    """

    rotations: NDArray[np.float64]
    foot: NDArray[np.float64]
    knee: NDArray[np.float64]
    missed: NDArray[np.float64]


def reach(
    rotations: NDArray[np.float64],
    pelvis: NDArray[np.float64],
    hip: NDArray[np.float64],
    thigh: NDArray[np.float64],
    shank: NDArray[np.float64],
    ankle: NDArray[np.float64],
    foot: NDArray[np.float64],
    pivot: NDArray[np.float64],
    held: NDArray[np.float64],
    swivel: NDArray[np.float64],
    *,
    max_knee: float,
) -> Reach:
    """Return how hip, knee and ankle of one leg turn so that the foot is where it should be.

    The knee bends about its own axis until the ankle is as far from the hip as it should be; the hip turns the leg the
    shortest way; the ankle keeps the foot as it should lie. Where the knee would have to bend or stretch by more than
    `max_knee`, or the leg is too short, a foot that is held rolls about the point that it stands on, up or down, and
    one that is not stays behind.

    Parameters
    ----------
    rotations : ndarray of shape (n_frames, 3, 3)
        Exponential maps of hip, knee and ankle before, in radians.
    pelvis : ndarray of shape (n_frames, 3, 3)
        Axes of the joint that the hip hangs from, in the room.
    hip : ndarray of shape (n_frames, 3)
        Where the hip is.
    thigh, shank : ndarray of shape (3,)
        From hip to knee and from knee to ankle, along their own axes, in metres.
    ankle : ndarray of shape (n_frames, 3)
        Where the ankle should be.
    foot : ndarray of shape (n_frames, 3, 3)
        Axes that the foot should have, in the room.
    pivot : ndarray of shape (n_frames, 3)
        The point of the sole that stands on the floor.
    held : ndarray of shape (n_frames,)
        From 0 to 1: how much it stands there.
    swivel : ndarray of shape (n_frames,)
        By how much the leg is turned about the line from hip to ankle, in radians.
    max_knee : float
        In radians.
    """
    arrays = [rotations, pelvis, hip, thigh, shank, ankle, foot, pivot, held, swivel]
    compiled: Callable[..., tuple] = _reach
    return Reach(*compiled(*(np.ascontiguousarray(array, dtype=np.float64) for array in arrays), max_knee))


@njit(cache=True, nogil=True, error_model="numpy")
def _reach(rotations, pelvis, hip, thigh, shank, ankle, foot, pivot, held, swivel, max_knee):
    n_frames = len(rotations)
    out, feet, bent, missed = np.empty((n_frames, 3, 3)), foot.copy(), np.empty(n_frames), np.empty(n_frames)
    upper, lower = _length(thigh), _length(shank)
    longest = _NEARLY_STRAIGHT * (upper + lower)
    knee, bowed, frame = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    turn, spare = np.empty((3, 3)), np.empty((3, 3))
    axis, end, away, target, whole = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for t in range(n_frames):
        rotation_matrix(rotations[t, 1], knee)
        _move(knee, shank, end)  # from knee to ankle, along the axes of the thigh
        flexion = _angle(thigh, end, axis)
        straight = min(_far(upper, lower, flexion - max_knee), max(longest, _far(upper, lower, flexion)))
        shortest = _far(upper, lower, flexion + max_knee)
        for i in range(3):
            target[i] = ankle[t, i]
            away[i] = target[i] - hip[t, i]
        distance = _length(away)
        wanted = min(max(distance, shortest), straight)
        if wanted != distance and held[t] > 0.0:
            _roll(target, feet[t], hip[t], pivot[t], wanted, held[t], turn, spare)
            for i in range(3):
                away[i] = target[i] - hip[t, i]
            distance = _length(away)
            wanted = min(max(distance, shortest), straight)
        missed[t] = abs(distance - wanted)
        bent[t] = _flexion(upper, lower, wanted) - flexion
        axis[1] += 1e-3 * upper * lower  # flexion is about y, to the left; it counts where the leg is straight
        bend = _bend(thigh, end, axis, wanted)
        length = _length(axis)
        for i in range(3):
            axis[i] *= bend / length
        rotation_matrix(axis, turn)
        _multiply(turn, knee, bowed)
        _move(bowed, shank, end)
        for i in range(3):
            end[i] += thigh[i]
        rotation_matrix(rotations[t, 0], turn)
        _multiply(pelvis[t], turn, spare)
        _move(spare, end, whole)
        _shortest_turn(whole, away, axis, turn)
        _multiply(turn, spare, frame)
        if swivel[t] != 0.0:
            for i in range(3):  # about the line from the ankle up to the hip
                axis[i] = -swivel[t] * away[i] / distance
            rotation_matrix(axis, turn)
            _multiply(turn, frame, spare)
            _copy(spare, frame)
        _multiply_back(pelvis[t], frame, spare)
        rotvec_of_matrix(spare, out[t, 0])
        rotvec_of_matrix(bowed, out[t, 1])
        _multiply(frame, bowed, spare)
        _multiply_back(spare, feet[t], turn)
        rotvec_of_matrix(turn, out[t, 2])
    return out, feet, bent, missed


@njit(cache=True, nogil=True, error_model="numpy")
def _bend(thigh, shank, axis, wanted):
    """Return the turn of the shank about an axis after which hip and ankle are so far apart.

    For a unit axis a the product thigh . shank becomes A cos(turn) + B sin(turn) + C.
    """
    whole, cross = np.empty(3), np.empty(3)
    for i in range(3):
        whole[i] = thigh[i] + shank[i]
    if abs(_length(whole) - wanted) < _ROUNDING:
        return 0.0
    _cross(axis, shank, cross)
    square, length = _dot(axis, axis), _length(axis)
    along = _dot(thigh, axis) * _dot(shank, axis) / square
    cosine, sine = _dot(thigh, shank) - along, _dot(thigh, cross) / length
    goal = 0.5 * (wanted * wanted - _dot(thigh, thigh) - _dot(shank, shank)) - along
    share = min(1.0, max(-1.0, goal / np.hypot(cosine, sine)))
    return np.arctan2(sine, cosine) + np.arccos(share)


@njit(cache=True, nogil=True, error_model="numpy")
def _roll(ankle, foot, hip, pivot, wanted, held, matrix, spare):
    """Roll a foot about its pivot and its own y axis, by 20 degrees at most, so that the ankle comes near enough."""
    axis, flat, across, cross = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    along_lever, along_way = 0.0, 0.0
    for i in range(3):
        axis[i] = foot[i, 1]
        along_lever += (ankle[i] - pivot[i]) * axis[i]
        along_way += (hip[i] - pivot[i]) * axis[i]
    for i in range(3):
        flat[i] = ankle[i] - pivot[i] - along_lever * axis[i]
        across[i] = hip[i] - pivot[i] - along_way * axis[i]
    near, far = _length(flat), _length(across)
    if near < 1e-6 or far < 1e-6:
        return
    gap = (along_lever - along_way) ** 2
    cosine = (near * near + far * far + gap - wanted * wanted) / (2.0 * near * far)
    goal = np.arccos(min(1.0, max(-1.0, cosine)))
    now = _angle(flat, across, cross)  # a turn by this about the axis, or against it, would point the lever at the hip
    if _dot(cross, axis) < 0.0:
        now, goal = -now, -goal
    turn = held * min(_MAX_ROLL, max(-_MAX_ROLL, now - goal))
    for i in range(3):
        cross[i] = turn * axis[i]
        flat[i] = ankle[i] - pivot[i]
    rotation_matrix(cross, matrix)
    _move(matrix, flat, across)
    _multiply(matrix, foot, spare)
    for i in range(3):
        ankle[i] = pivot[i] + across[i]
        for j in range(3):
            foot[i, j] = spare[i, j]


@njit(cache=True, nogil=True, inline="always")
def _move(matrix, vector, out):
    for i in range(3):
        out[i] = matrix[i, 0] * vector[0] + matrix[i, 1] * vector[1] + matrix[i, 2] * vector[2]


@njit(cache=True, nogil=True, inline="always")
def _multiply(a, b, out):
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@njit(cache=True, nogil=True, inline="always")
def _multiply_back(a, b, out):
    """Write the product of the transpose of one matrix and another."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[0, i] * b[0, j] + a[1, i] * b[1, j] + a[2, i] * b[2, j]


@njit(cache=True, nogil=True, inline="always")
def _copy(matrix, out):
    for i in range(3):
        for j in range(3):
            out[i, j] = matrix[i, j]


@njit(cache=True, nogil=True, inline="always")
def _far(upper, lower, flexion):
    """Return the distance from hip to ankle with a knee that is bent so much, in radians."""
    cosine = np.cos(min(np.pi, max(0.0, flexion)))
    return np.sqrt(max(0.0, upper * upper + lower * lower + 2.0 * upper * lower * cosine))


@njit(cache=True, nogil=True, inline="always")
def _flexion(upper, lower, distance):
    """Return the angle of a knee, zero where it is straight, from the distance between hip and ankle."""
    cosine = (distance * distance - upper * upper - lower * lower) / (2.0 * upper * lower)
    return np.arccos(min(1.0, max(-1.0, cosine)))


@njit(cache=True, nogil=True, inline="always")
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, nogil=True, inline="always")
def _length(vector):
    return np.sqrt(_dot(vector, vector))


@njit(cache=True, nogil=True, inline="always")
def _cross(a, b, out):
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@njit(cache=True, nogil=True, inline="always")
def _angle(a, b, cross):
    """Return the angle between two vectors, and write their cross product."""
    _cross(a, b, cross)
    return np.arctan2(_length(cross), _dot(a, b))


@njit(cache=True, nogil=True, error_model="numpy")
def _shortest_turn(start, end, axis, out):
    """Write the rotation matrix that turns one direction into another, which is not its opposite, into `out`."""
    angle = _angle(start, end, axis)
    sine = _length(axis)
    scale = angle / sine if sine > 1e-300 else 0.0
    for i in range(3):
        axis[i] *= scale
    rotation_matrix(axis, out)
