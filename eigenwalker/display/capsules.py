r"""Sticks with round ends drawn into pictures, with smooth edges; a disc is a stick without length.

A pixel whose middle is at the distance d from the line between the ends of a stick of radius r is covered by

.. math:: \min(\max(r - d + \tfrac{1}{2}, 0), 1)

of it: exact for an edge along the pixels, within 0.08 for any other edge that is straight over a pixel. Where sticks
overlap the one counts that covers most, so that they look like one piece.
"""

import math
from collections.abc import Iterator

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["draw_capsules"]


def draw_capsules(
    ends: NDArray[np.floating],
    radii: NDArray[np.floating],
    size: tuple[int, int],
    *,
    ground: int = 0,
    ink: int = 255,
) -> Iterator[NDArray[np.uint8]]:
    """Yield pictures of sticks with round ends.

    Parameters
    ----------
    ends : ndarray of shape (n_frames, n_sticks, 2, 2)
        Both ends of each, column and row in pixels, from the middle of the pixel at the top left. What is outside the
        picture is not drawn.
    radii : ndarray of shape (n_sticks,)
        Half their widths, in pixels.
    size : (int, int)
        Width and height of the pictures in pixels.
    ground, ink : int, default 0 and 255
        Values of pixels without and within a stick.

    Yields
    ------
    ndarray of shape (height, width)
        The same array each time, drawn anew: copy it to keep it.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.display.capsules import draw_capsules
    >>> level = np.array([[[[1.0, 1.0], [9.0, 1.0]]]])  # from the second column on, beyond the picture
    >>> next(draw_capsules(level, np.array([0.75]), (4, 3)))
    array([[  0,  64,  64,  64],
           [ 64, 255, 255, 255],
           [  0,  64,  64,  64]], dtype=uint8)
    """
    levels = np.rint(np.linspace(ground, ink, 256)).astype(np.uint8)
    shares = np.zeros(size[::-1], dtype=np.uint8)
    picture = np.empty(size[::-1], dtype=np.uint8)
    widths = np.ascontiguousarray(radii, dtype=np.float64)
    for frame in np.ascontiguousarray(ends, dtype=np.float64):
        shares[:] = 0
        _draw(frame, widths, shares)
        np.take(levels, shares, out=picture)
        yield picture


@njit(cache=True, nogil=True)
def _draw(ends, radii, shares):
    """Draw sticks (n_sticks, 2, 2) into what is covered of each pixel, 0 to 255."""
    for stick in range(len(ends)):
        radius = radii[stick]
        x, y = ends[stick, 0, 0], ends[stick, 0, 1]
        right, down = ends[stick, 1, 0] - x, ends[stick, 1, 1] - y
        squared = right * right + down * down
        first, stop = _span(x, right, radius, shares.shape[1])
        top, bottom = _span(y, down, radius, shares.shape[0])
        for row in range(top, bottom):
            for column in range(first, stop):
                along = (column - x) * right + (row - y) * down
                part = min(max(along / squared, 0.0), 1.0) if squared > 0 else 0.0
                far = math.hypot(column - x - part * right, row - y - part * down)
                share = int(255 * min(max(radius - far + 0.5, 0.0), 1.0) + 0.5)
                if share > shares[row, column]:
                    shares[row, column] = share


@njit(cache=True, nogil=True)
def _span(start, length, radius, n_pixels):
    """Return the first pixel along a side that a stick may touch, and the one behind the last."""
    reach = radius + 1
    low, high = min(start, start + length) - reach, max(start, start + length) + reach
    if not (low < n_pixels and high > 0):  # NaN is nowhere
        return 0, 0
    return max(math.floor(low), 0), min(math.ceil(high) + 1, n_pixels)
