"""A body that is not thrown about: paths of the root whose speed changes no faster than legs let it."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from eigenwalker.motion.support import smooth_step

__all__ = ["soften_path"]

_LIMIT = 23.0  # m/s^2: a change of 0.38 m/s between frames at 60 Hz, about the most of planted recordings
_WIDTHS = (
    0.01,
    0.015,
    0.02,
    0.03,
    0.04,
)  # strides, of the Gaussian that is taken first, and then if that is too narrow
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
    soft, found = path, np.zeros(max(len(path) - 2, 0), dtype=bool)
    for width in _WIDTHS:
        left = np.linalg.norm(np.diff(soft, 2, axis=0), axis=1) * frame_rate**2 > _LIMIT
        if not left.any():
            return soft
        found |= left
        jolts = np.flatnonzero(found) + 1
        sigma = width * stride
        away = np.abs(np.arange(len(path))[:, np.newaxis] - jolts).min(axis=1)  # frames from the nearest jolt
        share = smooth_step(2.0 - away / (_AROUND * sigma))
        straight = _line(path)
        smooth = straight + gaussian_filter1d(path - straight, sigma, axis=0, mode="nearest")
        soft = path + share[:, np.newaxis] * (smooth - path)
    return soft


def _line(path: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the straight line from the first to the last frame, which no smoothing at the ends may bend."""
    return path[0] + np.linspace(0.0, 1.0, len(path))[:, np.newaxis] * (path[-1] - path[0])
