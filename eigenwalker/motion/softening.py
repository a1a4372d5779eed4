"""A body that is not thrown about: paths of the root whose speed changes no faster than legs let it."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from eigenwalker.motion.support import rise

__all__ = ["soften_path"]

_LIMIT = 23.0  # m/s^2: a change of 0.38 m/s between frames at 60 Hz, about the most of planted recordings
_WIDTHS = (0.01, 0.015, 0.02, 0.03, 0.04)  # strides: of the Gaussian, the narrowest that is wide enough
_AROUND = 3.0  # widths to either side of a jolt over which the smooth path is taken, and as many again to fade


def soften_path(path: NDArray[np.float64], frame_rate: float, stride: float) -> NDArray[np.float64]:
    """Return a path without jolts; where it has none it stays as it is to the last bit.

    Around each change of velocity of more than 23 m/s^2 the path is smoothed in time by a Gaussian, of 1 % of a stride
    or the narrowest up to 4 % that is wide enough.

    Parameters
    ----------
    path : ndarray of shape (n_frames, 3)
        Of the root, in metres.
    frame_rate : float
        Frames per second.
    stride : float
        In frames.

    Returns
    -------
    ndarray of shape (n_frames, 3)

    Examples
    --------
    >>> import numpy as np
    >>> kinked = np.maximum(0, np.arange(-10, 11) / 60.0)[:, np.newaxis] * [1.0, 0.0, 0.0]  # from 0 to 1 m/s at once
    >>> changes = np.abs(np.diff(soften_path(kinked, 60.0, 60.0), 2, axis=0)).max() * 60
    >>> bool(changes < 0.4)
    True
    """
    if len(path) < 3:
        return path
    straight = path[0] + np.linspace(0.0, 1.0, len(path))[:, np.newaxis] * (path[-1] - path[0])
    # About the straight line, which no smoothing at the ends may bend.
    soft, found = path, np.zeros(len(path), dtype=np.bool_)
    for width in _WIDTHS:
        if not _find_jolts(soft, _LIMIT / frame_rate**2, found):
            return soft
        soft = path + _shift(path - straight, found, width * stride)
    return soft


@njit(cache=True, nogil=True)
def _find_jolts(path, limit, found):
    """Mark the frames in which a path, (n_frames, 3), changes its step by more than `limit`; say whether any does."""
    any_left = False
    for t in range(1, len(path) - 1):
        total = 0.0
        for axis in range(3):
            total += (path[t + 1, axis] - 2.0 * path[t, axis] + path[t - 1, axis]) ** 2
        if total > limit**2:
            found[t] = any_left = True
    return any_left


@njit(cache=True, nogil=True)
def _shift(path, found, sigma):
    """Return what leads from a path, (n_frames, 3), to the smooth one, in shares that fade away from jolts."""
    n_frames, reach = len(path), int(4.0 * sigma + 0.5)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    weights /= weights.sum()
    shift = np.zeros_like(path)
    for t in range(n_frames):
        share = rise(2.0 - _away(found, t, 2.0 * _AROUND * sigma) / (_AROUND * sigma))
        if share == 0.0:
            continue
        for axis in range(3):
            mean = 0.0
            for lag in range(2 * reach + 1):
                mean += weights[lag] * path[min(max(t + lag - reach, 0), n_frames - 1), axis]
            shift[t, axis] = share * (mean - path[t, axis])
    return shift


@njit(cache=True, nogil=True)
def _away(found, frame, most):
    """Return how many frames lie between a frame and the nearest jolt, or `most` if that is nearer."""
    distance = 0
    while distance < most:
        before, after = frame - distance, frame + distance
        if (before >= 0 and found[before]) or (after < len(found) and found[after]):
            return float(distance)
        distance += 1
    return most
