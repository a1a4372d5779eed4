"""Which foot stands, when the weight goes over to the other one, and where the body goes while a foot stands."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.signal import find_peaks

__all__ = ["Stance", "Support", "find_stances", "find_support", "smooth_step", "sole_shares"]

_PROMINENCE = 0.25  # of the range of left minus right ankle, by which a step stands out from noise
_STILL = 0.05  # metres of that range below which nobody walks
_SHARP = 0.00002  # metres of height over which the floor passes from one point of the sole to another
_SOFT = 0.006  # the same for the height of the body, which would jerk at once


class Stance(NamedTuple):
    """A foot on the floor, from one hand-over of the weight to the next.

    Parameters
    ----------
    foot : int
        0 is left, 1 is right.
    start, end : float
        In frames; -inf and inf where the walk begins or ends in it.
    """

    foot: int
    start: float
    end: float


class Support(NamedTuple):
    """What a standing foot does to the root; see `find_support`.

    Parameters
    ----------
    advance : ndarray of shape (n_frames - 1, 2, 2)
        How far the root must go from each frame to the next so that the sole of the left, or right, foot does not
        move over the floor: x and y, in metres.
    height : ndarray of shape (n_frames, 2)
        How high the root must be so that the sole of that foot touches the floor, in metres.
    """

    advance: NDArray[np.float64]
    height: NDArray[np.float64]


def find_support(soles: NDArray[np.float64]) -> Support:
    r"""Return where each foot would carry the root if it stood.

    In a standing foot the sole rolls from heel to toes. With the heights z of its points, p, each of them holds the
    share :math:`w_p \propto e^{-z_p / s}` of the floor. The root goes by minus their mean movement, s = 0.02 mm, and
    is as high as minus their mean height, s = 6 mm: a flat foot lies on the floor, and of one that is nearly flat the
    lowest point is up to 3 mm below it.

    Parameters
    ----------
    soles : ndarray of shape (n_frames, 2, 3, 3)
        Heel, ball and tip of both feet against the root, in metres, along the room.
    """
    return Support(*_support(np.ascontiguousarray(soles, dtype=np.float64), _SHARP, _SOFT))


@njit(cache=True, nogil=True)
def _support(soles, sharp, soft):
    n_frames, n_feet, n_points, _ = soles.shape
    advance, height = np.zeros((max(n_frames - 1, 0), n_feet, 2)), np.empty((n_frames, n_feet))
    heights, shares = np.empty(n_points), np.empty(n_points)
    for t in range(n_frames):
        for foot in range(n_feet):
            for point in range(n_points):
                heights[point] = soles[t, foot, point, 2]
            _share_out(heights, soft, shares)
            height[t, foot] = 0.0
            for point in range(n_points):  # of points about as low, their mean
                height[t, foot] -= shares[point] * heights[point]
            if t == n_frames - 1:
                continue
            for point in range(n_points):
                heights[point] = 0.5 * (heights[point] + soles[t + 1, foot, point, 2])
            _share_out(heights, sharp, shares)
            for point in range(n_points):
                for axis in range(2):
                    step = soles[t + 1, foot, point, axis] - soles[t, foot, point, axis]
                    advance[t, foot, axis] -= shares[point] * step
    return advance, height


@njit(cache=True, nogil=True)
def _share_out(heights, scale, shares):
    """Write shares, counted from the lowest point, so that no exponential overflows."""
    lowest, total = heights[0], 0.0
    for height in heights:
        lowest = min(lowest, height)
    for point in range(len(heights)):
        shares[point] = np.exp((lowest - heights[point]) / scale)
        total += shares[point]
    for point in range(len(heights)):
        shares[point] /= total


def sole_shares(heights: NDArray[np.float64], scale: float = _SHARP) -> NDArray[np.float64]:
    """Return how much of the floor each point of a sole holds, from their heights, shape (..., n_points)."""
    flat = np.ascontiguousarray(heights, dtype=np.float64).reshape(-1, heights.shape[-1])
    return _all_shares(flat, scale).reshape(heights.shape)


@njit(cache=True, nogil=True)
def _all_shares(heights, scale):
    out = np.empty(heights.shape)
    for row in range(len(heights)):
        _share_out(heights[row], scale, out[row])
    return out


def find_stances(difference: NDArray[np.float64]) -> tuple[list[Stance], float]:
    """Return the stances of a walk, and the frames of a stride.

    Against the body the standing foot goes back while the other one swings: the weight is handed over where the
    distance between the ankles, ahead, is largest. The lowest point of both feet would not do, because a swinging toe
    passes the floor nearly as low.

    Parameters
    ----------
    difference : ndarray of shape (n_frames,)
        Left minus right ankle, ahead, in metres.
    """
    reach = np.ptp(difference)
    if reach < _STILL:
        return [Stance(0, -np.inf, np.inf)], float(len(difference))
    over: list[tuple[float, int]] = []
    for foot, sign in ((0, 1.0), (1, -1.0)):  # the foot ahead takes over
        ahead = np.pad(sign * difference, 1, constant_values=-np.inf)  # at its ends, one side is enough to stand out
        peaks = find_peaks(ahead, prominence=_PROMINENCE * reach)[0] - 1
        peaks = peaks[(peaks > 0) & (peaks < len(difference) - 1)]
        before, top, after = difference[peaks - 1], difference[peaks], difference[peaks + 1]
        bend = before - 2 * top + after
        shift = np.where(bend == 0, 0.0, 0.5 * (before - after) / np.where(bend == 0, 1.0, bend))
        over += [(float(time), foot) for time in peaks + shift]
    over.sort()
    taken = [entry for place, entry in enumerate(over) if place == 0 or entry[1] != over[place - 1][1]]
    if not taken:
        return [Stance(int(difference[-1] > difference[0]), -np.inf, np.inf)], float(len(difference))
    first = Stance(1 - taken[0][1], -np.inf, taken[0][0])
    ends = [time for time, _ in taken[1:]] + [np.inf]
    stances = [first, *(Stance(foot, start, end) for (start, foot), end in zip(taken, ends, strict=True))]
    steps = np.diff([time for time, _ in taken])
    return stances, 2 * float(np.median(steps)) if len(steps) else float(len(difference))


def smooth_step(values: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return a rise from 0, at and below 0, to 1, at and above 1, with two smooth derivatives."""
    flat = np.ascontiguousarray(values, dtype=np.float64)
    return _smooth_step(flat.ravel()).reshape(flat.shape)


@njit(cache=True, nogil=True)
def _smooth_step(values):
    out = np.empty(len(values))
    for place in range(len(values)):
        x = min(1.0, max(0.0, values[place]))
        out[place] = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
    return out
