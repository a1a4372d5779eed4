"""Legs that reach for given places: inverse kinematics of hip, knee and ankle."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from eigenwalker.motion._quaternions import (
    about,
    added,
    cross,
    dot,
    from_rotvec,
    length,
    product,
    product_of_inverse,
    shortest_turn,
    subtracted,
    to_rotvec,
    turned,
)

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
    foot : ndarray of shape (n_frames, 4)
        Axes of the foot in the room, as quaternions.
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
    pelvis : ndarray of shape (n_frames, 4)
        Axes of the joint that the hip hangs from, in the room: quaternions, w first.
    hip : ndarray of shape (n_frames, 3)
        Where the hip is.
    thigh, shank : ndarray of shape (3,)
        From hip to knee and from knee to ankle, along their own axes, in metres.
    ankle : ndarray of shape (n_frames, 3)
        Where the ankle should be.
    foot : ndarray of shape (n_frames, 4)
        Axes that the foot should have, in the room: quaternions.
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
    out, feet = np.empty((n_frames, 3, 3)), np.empty((n_frames, 4))
    bent, missed = np.empty(n_frames), np.empty(n_frames)
    upper, lower = (thigh[0], thigh[1], thigh[2]), (shank[0], shank[1], shank[2])
    for t in range(n_frames):
        above = (pelvis[t, 0], pelvis[t, 1], pelvis[t, 2], pelvis[t, 3])
        lying = (foot[t, 0], foot[t, 1], foot[t, 2], foot[t, 3])
        start, target = (hip[t, 0], hip[t, 1], hip[t, 2]), (ankle[t, 0], ankle[t, 1], ankle[t, 2])
        knee = from_rotvec((rotations[t, 1, 0], rotations[t, 1, 1], rotations[t, 1, 2]))
        end = turned(knee, lower)  # from knee to ankle, along the axes of the thigh
        flexion = _angle(upper, end)
        shortest, longest = _limits(length(upper), length(lower), flexion, max_knee)
        away = subtracted(target, start)
        distance = length(away)
        wanted = min(max(distance, shortest), longest)
        if wanted != distance and held[t] > 0.0:
            point = (pivot[t, 0], pivot[t, 1], pivot[t, 2])
            target, lying = _roll(target, lying, start, point, wanted, held[t])
            away = subtracted(target, start)
            distance = length(away)
            wanted = min(max(distance, shortest), longest)
        missed[t] = abs(distance - wanted)
        bent[t] = _flexion(length(upper), length(lower), wanted) - flexion
        bowed = product(_bend(upper, end, wanted), knee)
        leg = product(above, from_rotvec((rotations[t, 0, 0], rotations[t, 0, 1], rotations[t, 0, 2])))
        leg = product(shortest_turn(turned(leg, added(upper, turned(bowed, lower))), away), leg)
        if swivel[t] != 0.0:
            leg = product(about(away, -swivel[t]), leg)  # to the left about the line from the ankle up to the hip
        out[t, 0, 0], out[t, 0, 1], out[t, 0, 2] = to_rotvec(product_of_inverse(above, leg))
        out[t, 1, 0], out[t, 1, 1], out[t, 1, 2] = to_rotvec(bowed)
        out[t, 2, 0], out[t, 2, 1], out[t, 2, 2] = to_rotvec(product_of_inverse(product(leg, bowed), lying))
        feet[t, 0], feet[t, 1], feet[t, 2], feet[t, 3] = lying
    return out, feet, bent, missed


@njit(cache=True, nogil=True, error_model="numpy")
def _limits(upper, lower, flexion, max_knee):
    """Return how near to the hip and how far from it the ankle may be."""
    nearest = _far(upper, lower, flexion + max_knee)
    stretched = max(_NEARLY_STRAIGHT * (upper + lower), _far(upper, lower, flexion))
    return nearest, min(_far(upper, lower, flexion - max_knee), stretched)


@njit(cache=True, nogil=True, error_model="numpy")
def _bend(thigh, shank, wanted):
    """Return the turn of the knee, about its own axis, after which hip and ankle are so far apart.

    For a unit axis a the product thigh . shank becomes A cos(turn) + B sin(turn) + C.
    """
    if abs(length(added(thigh, shank)) - wanted) < _ROUNDING:
        return 1.0, 0.0, 0.0, 0.0
    x, y, z = cross(thigh, shank)
    y += 1e-3 * length(thigh) * length(shank)  # flexion is about y, to the left; it counts where the leg is straight
    axis = (x, y, z)
    along = dot(thigh, axis) * dot(shank, axis) / dot(axis, axis)
    cosine, sine = dot(thigh, shank) - along, dot(thigh, cross(axis, shank)) / length(axis)
    goal = 0.5 * (wanted * wanted - dot(thigh, thigh) - dot(shank, shank)) - along
    share = min(1.0, max(-1.0, goal / np.sqrt(cosine * cosine + sine * sine)))
    return about(axis, np.arctan2(sine, cosine) + np.arccos(share))


@njit(cache=True, nogil=True, error_model="numpy")
def _roll(ankle, foot, hip, pivot, wanted, held):
    """Return ankle and foot rolled about a pivot and the foot's y axis, by 20 degrees at most, to come near enough."""
    axis = turned(foot, (0.0, 1.0, 0.0))
    lever, way = subtracted(ankle, pivot), subtracted(hip, pivot)
    flat, gap = _across(lever, axis), dot(lever, axis) - dot(way, axis)
    across = _across(way, axis)
    near, far = length(flat), length(across)
    if near < 1e-6 or far < 1e-6:
        return ankle, foot
    cosine = (near * near + far * far + gap * gap - wanted * wanted) / (2.0 * near * far)
    goal = np.arccos(min(1.0, max(-1.0, cosine)))
    now = _angle(flat, across)  # a turn by this about the axis, or against it, would point the lever at the hip
    if dot(cross(flat, across), axis) < 0.0:
        now, goal = -now, -goal
    turn = about(axis, held * min(_MAX_ROLL, max(-_MAX_ROLL, now - goal)))
    return added(pivot, turned(turn, lever)), product(turn, foot)


@njit(cache=True, nogil=True, error_model="numpy")
def _across(vector, axis):
    """Return the part of a vector that is perpendicular to a unit axis."""
    along = dot(vector, axis)
    return vector[0] - along * axis[0], vector[1] - along * axis[1], vector[2] - along * axis[2]


@njit(cache=True, nogil=True, error_model="numpy")
def _far(upper, lower, flexion):
    """Return the distance from hip to ankle with a knee that is bent so much, in radians."""
    cosine = np.cos(min(np.pi, max(0.0, flexion)))
    return np.sqrt(max(0.0, upper * upper + lower * lower + 2.0 * upper * lower * cosine))


@njit(cache=True, nogil=True, error_model="numpy")
def _flexion(upper, lower, distance):
    """Return the angle of a knee, zero where it is straight, from the distance between hip and ankle."""
    cosine = (distance * distance - upper * upper - lower * lower) / (2.0 * upper * lower)
    return np.arccos(min(1.0, max(-1.0, cosine)))


@njit(cache=True, nogil=True, error_model="numpy")
def _angle(a, b):
    """Return the angle between two vectors."""
    return np.arctan2(length(cross(a, b)), dot(a, b))
