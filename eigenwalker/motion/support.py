"""Which foot stands, when the weight goes over to the other one, and where the body goes while a foot stands."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["Stance", "Support", "find_stances", "find_support", "rise", "smooth_step", "standing_points"]

_PROMINENCE = 0.25  # of the range of left minus right ankle, by which a step stands out from noise
_STILL = 0.05  # metres of that range below which nobody walks
_SHARP = 0.00002  # metres of height over which the floor passes from one point of the sole to another
_SOFT = 0.006  # the same for the height of the body, which would jerk at once
_NONE = 40.0  # of those heights over the lowest point, where a share is lost in rounding


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
    lowest : ndarray of shape (n_frames, 2)
        Height of the lowest point of each sole against the root.
    """

    advance: NDArray[np.float64]
    height: NDArray[np.float64]
    lowest: NDArray[np.float64]


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


@njit(cache=True, nogil=True, error_model="numpy")
def _support(soles, sharp, soft):
    n_frames, n_feet, n_points, _ = soles.shape
    advance, height = np.zeros((max(n_frames - 1, 0), n_feet, 2)), np.zeros((n_frames, n_feet))
    lowest, heights, shares = np.empty((n_frames, n_feet)), np.empty(n_points), np.empty(n_points)
    for t in range(n_frames):
        for foot in range(n_feet):
            for point in range(n_points):
                heights[point] = soles[t, foot, point, 2]
            lowest[t, foot] = _share_out(heights, soft, shares)
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
    return advance, height, lowest


@njit(cache=True, nogil=True, error_model="numpy")
def _share_out(heights, scale, shares):
    """Write shares, counted from the lowest point, so that no exponential overflows, and return its height."""
    lowest, total = heights[0], 0.0
    for height in heights:
        lowest = min(lowest, height)
    for point in range(len(heights)):
        over = (heights[point] - lowest) / scale
        shares[point] = np.exp(-over) if over < _NONE else 0.0
        total += shares[point]
    for point in range(len(heights)):
        shares[point] /= total
    return lowest


def standing_points(soles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points on which feet stand, shape (n_frames, 2, 3), or would stand: the mean of those as low.

    Parameters
    ----------
    soles : ndarray of shape (n_frames, 2, n_points, 3)
        In metres.
    """
    return _standing_points(np.ascontiguousarray(soles, dtype=np.float64), _SHARP)


@njit(cache=True, nogil=True, error_model="numpy")
def _standing_points(soles, sharp):
    n_frames, n_feet, n_points, _ = soles.shape
    out, heights, shares = np.zeros((n_frames, n_feet, 3)), np.empty(n_points), np.empty(n_points)
    for t in range(n_frames):
        for foot in range(n_feet):
            for point in range(n_points):
                heights[point] = soles[t, foot, point, 2]
            _share_out(heights, sharp, shares)
            for point in range(n_points):
                for axis in range(3):
                    out[t, foot, axis] += shares[point] * soles[t, foot, point, axis]
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
        peaks = _prominent_peaks(sign * difference, _PROMINENCE * reach)
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


@njit(cache=True, nogil=True)
def _prominent_peaks(values, prominence):
    """Return the frames, but for the first and last one, of peaks that stand out so far on each side of them.

    A side is what lies between a peak and a higher value; one that goes on to the end of the walk always does.
    """
    peaks = [0 for _ in range(0)]
    first, n_frames = 0, len(values)
    while first < n_frames:
        last, top = first, values[first]
        while last + 1 < n_frames and values[last + 1] == top:
            last += 1
        peak = (first + last) // 2
        rises = first == 0 or values[first - 1] < top
        falls = last == n_frames - 1 or values[last + 1] < top
        if rises and falls and 0 < peak < n_frames - 1 and _stands_out(values, peak, prominence):
            peaks.append(peak)
        first = last + 1
    return np.array(peaks, dtype=np.int64)


@njit(cache=True, nogil=True)
def _stands_out(values, peak, prominence):
    top = values[peak]
    for step in (-1, 1):
        lowest, frame = top, peak
        while 0 <= frame < len(values) and values[frame] <= top:
            lowest = min(lowest, values[frame])
            frame += step
        if 0 <= frame < len(values) and top - lowest < prominence:
            return False
    return True


def smooth_step(values: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return a rise from 0, at and below 0, to 1, at and above 1, with two smooth derivatives."""
    flat = np.ascontiguousarray(values, dtype=np.float64)
    return _smooth_step(flat.ravel()).reshape(flat.shape)


@njit(cache=True, nogil=True)
def _smooth_step(values):
    out = np.empty(len(values))
    for place in range(len(values)):
        out[place] = rise(values[place])
    return out


@njit(cache=True, nogil=True)
def rise(value):
    """Return `smooth_step` of one number (compiled)."""
    x = min(1.0, max(0.0, value))
    return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
