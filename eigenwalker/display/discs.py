r"""Discs drawn into pictures, with smooth edges: each pixel by the very part of it that a disc covers.

The part of a disc around zero that lies left of x and above y has the area

.. math:: A(x, y) = H(x) + \operatorname{sgn}(y) \left[ \min(H(x), H(-c)) + \max(H(x), H(c)) - H(c) \right]
          + y \left[ \min(\max(x, -c), c) + c \right]

with x and y cut to the radius r, the half chord c = sqrt(r^2 - y^2) at height y, and half of the area left of x,
H(x) = (x sqrt(r^2 - x^2) + r^2 asin(x / r)) / 2 + pi r^2 / 4: the integral over columns of the length of chord above y.
Differences of A between the corners of a pixel are what is covered of it. So the pixels of a disc add up to its area
wherever it lies between them, and a moving dot does not flicker.
"""

import math
from collections.abc import Iterator

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["draw_discs"]


def draw_discs(
    centers: NDArray[np.floating], diameter: float, size: tuple[int, int], *, ground: int = 0, disc: int = 255
) -> Iterator[NDArray[np.uint8]]:
    """Yield pictures of discs.

    A pixel has the value ground + share (disc - ground), rounded, with the share of it that is covered; where discs
    overlap, by the one that covers most of it.

    Parameters
    ----------
    centers : ndarray of shape (n_frames, n_discs, 2)
        Column and row in pixels, from the middle of the pixel at the top left; NaN for a disc that is not there. Discs
        outside the picture are not drawn, those across its edge in part.
    diameter : float
        In pixels.
    size : (int, int)
        Width and height of the pictures in pixels.
    ground, disc : int, default 0 and 255
        Values of pixels without and within a disc.

    Yields
    ------
    ndarray of shape (height, width)
        The same array each time, drawn anew: copy it to keep it.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.display.discs import draw_discs
    >>> next(draw_discs(np.array([[[1.0, 1.0]]]), 2.0, (3, 3)))
    array([[ 20, 116,  20],
           [116, 255, 116],
           [ 20, 116,  20]], dtype=uint8)
    """
    shape = size[1], size[0]
    levels = np.rint(np.linspace(ground, disc, 256)).astype(np.uint8)
    shares, picture = np.zeros(shape, dtype=np.uint8), np.full(shape, ground, dtype=np.uint8)
    for frame in np.ascontiguousarray(centers, dtype=np.float64):
        _draw(frame, diameter / 2, shares, picture, levels)
        yield picture
        _wipe(frame, diameter / 2, shares, picture, levels)


@njit(cache=True, nogil=True)
def _draw(centers, radius, shares, picture, levels):
    """Draw discs (n_discs, 2): `shares` keeps what is covered of each pixel, 0 to 255, `picture` its level."""
    n_steps = math.ceil(2 * radius) + 2
    x, halves = np.zeros(n_steps), np.zeros(n_steps)
    above, below = np.zeros(n_steps), np.zeros(n_steps)
    for disc in range(len(centers)):
        first, stop = _span(centers[disc, 0], radius, picture.shape[1])
        top, bottom = _span(centers[disc, 1], radius, picture.shape[0])
        for step in range(stop - first + 1):
            x[step] = min(max(first + step - 0.5 - centers[disc, 0], -radius), radius)
            halves[step] = _half_area(x[step], radius)
        _areas(top - 0.5 - centers[disc, 1], radius, x, halves, above)
        for row in range(top, bottom):
            _areas(row + 0.5 - centers[disc, 1], radius, x, halves, below)
            for step in range(stop - first):
                covered = below[step + 1] - below[step] - above[step + 1] + above[step]
                share = int(255 * covered + 0.5)
                if share > shares[row, first + step]:
                    shares[row, first + step] = share
                    picture[row, first + step] = levels[share]
            above, below = below, above


@njit(cache=True, nogil=True)
def _wipe(centers, radius, shares, picture, levels):
    """Undo `_draw`."""
    for disc in range(len(centers)):
        first, stop = _span(centers[disc, 0], radius, picture.shape[1])
        top, bottom = _span(centers[disc, 1], radius, picture.shape[0])
        shares[top:bottom, first:stop] = 0
        picture[top:bottom, first:stop] = levels[0]


@njit(cache=True, nogil=True)
def _span(center, radius, n_pixels):
    """Return the first pixel along a side that a disc may touch, and the one behind the last: none for NaN."""
    if not -radius - 1 < center < n_pixels + radius:
        return 0, 0
    return max(math.floor(center - radius + 0.5), 0), min(math.floor(center + radius + 0.5) + 1, n_pixels)


@njit(cache=True, nogil=True)
def _areas(y, radius, x, halves, areas):
    """Fill in A(x, y) at some x, with their H(x) in `halves`."""
    y = min(max(y, -radius), radius)
    chord = math.sqrt(radius**2 - y**2)
    right = _half_area(chord, radius)
    left = math.pi * radius**2 / 2 - right
    sign = 1.0 if y > 0 else -1.0
    for step in range(len(x)):
        beyond = min(halves[step], left) + max(halves[step], right) - right
        areas[step] = halves[step] + sign * beyond + y * (min(max(x[step], -chord), chord) + chord)


@njit(cache=True, nogil=True)
def _half_area(x, radius):
    """Return the area of half a disc left of x."""
    return (x * math.sqrt(radius**2 - x**2) + radius**2 * math.asin(x / radius)) / 2 + math.pi * radius**2 / 4
