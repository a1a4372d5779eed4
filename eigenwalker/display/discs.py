"""Discs drawn into pictures, with smooth edges."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

__all__ = ["cover_pixels", "draw_discs"]

_AT_ONCE = 8  # frames whose discs are computed together: their arrays stay in the cache


def cover_pixels(columns: NDArray[np.floating], rows: NDArray[np.floating], radius: float) -> NDArray[np.float64]:
    r"""Return which part of each pixel is covered by a disc around zero, exactly.

    The part of the disc left of x and above y has the area

    .. math:: A(x, y) = H(x) + \operatorname{sgn}(y) \left[ \min(H(x), H(-c)) + \max(H(x), H(c)) - H(c) \right]
              + y \left[ \min(\max(x, -c), c) + c \right]

    with x and y cut to the radius r, the half chord c = sqrt(r^2 - y^2) at height y, and half of the area left of x,
    H(x) = (x sqrt(r^2 - x^2) + r^2 asin(x / r)) / 2 + pi r^2 / 4. It is the integral over columns of the length of
    chord that lies above y. Differences of A between the corners of a pixel are its share. The shares of all pixels
    add up to the area of the disc wherever it lies between them, so that a moving dot does not flicker.

    Parameters
    ----------
    columns : ndarray of shape (n_discs, n_columns + 1)
        Left edges of pixels, and the right edge of the last one, from the center of the disc.
    rows : ndarray of shape (n_discs, n_rows + 1)
        Upper edges of pixels, and the lower edge of the last one.
    radius : float
        In pixels.

    Returns
    -------
    ndarray of shape (n_discs, n_rows, n_columns)
        From 0 for none to 1 for all.
    """
    x = np.clip(columns, -radius, radius)[:, np.newaxis]  # (n_discs, 1, n_columns + 1)
    y = np.clip(rows, -radius, radius)[..., np.newaxis]  # (n_discs, n_rows + 1, 1)
    chord = np.sqrt(radius**2 - y**2)
    left, chord_left = _half_area(x, radius), _half_area(chord, radius)
    whole = math.pi * radius**2 / 2
    beyond = np.minimum(left, whole - chord_left) + np.maximum(left, chord_left) - chord_left
    areas = left + np.sign(y) * beyond + y * (np.minimum(np.maximum(x, -chord), chord) + chord)
    return np.diff(np.diff(areas, axis=1), axis=2)


def _half_area(x: NDArray[np.floating], radius: float) -> NDArray[np.float64]:
    """Return the area of half a disc, above its middle, left of x."""
    return (x * np.sqrt(radius**2 - x**2) + radius**2 * np.arcsin(x / radius)) / 2 + math.pi * radius**2 / 4


def draw_discs(
    centers: NDArray[np.floating], diameter: float, size: tuple[int, int], *, ground: int = 0, disc: int = 255
) -> Iterator[NDArray[np.uint8]]:
    """Yield pictures of discs.

    A pixel has the value ground + share (disc - ground), rounded, with the share of it that is covered, see
    `cover_pixels`; where discs overlap, that of the one that covers most of it.

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
    width, height = size
    levels = np.rint(np.linspace(ground, disc, 256)).astype(np.uint8)
    shares = np.zeros(height * width + 1, dtype=np.uint8)  # the last one takes what falls outside
    pixels = np.full(height * width + 1, ground, dtype=np.uint8)
    for first in range(0, len(centers), _AT_ONCE):
        several = np.nan_to_num(centers[first : first + _AT_ONCE], nan=-np.inf)
        for places, values in zip(*_disc_pixels(several, diameter, size), strict=True):
            np.maximum.at(shares, places, values)
            pixels[places] = levels[shares[places]]
            yield pixels[:-1].reshape(height, width)
            shares[places], pixels[places] = 0, ground


def _disc_pixels(
    centers: NDArray[np.floating], diameter: float, size: tuple[int, int]
) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
    """Return the pixels that discs may touch, row by row through the picture, and what of them is covered.

    Parameters
    ----------
    centers : ndarray of shape (n_frames, n_discs, 2)
        Column and row in pixels, infinite for a disc that is not there.
    diameter, size : float, and (int, int)
        In pixels.

    Returns
    -------
    places, values : ndarray of shape (n_frames, n_discs n_steps n_steps)
        Places outside the picture are one behind its last. Values are from 0 for nothing of a pixel to 255 for all.
    """
    width, height = size
    steps = np.arange(math.ceil(diameter) + 2)
    bounded = np.clip(centers.reshape(-1, 2), -len(steps), np.array(size) + len(steps))  # (n_frames n_discs, 2)
    grid = np.rint(bounded - (len(steps) - 1) / 2).astype(np.intp)[..., np.newaxis] + steps  # (..., 2, n_steps)
    edges = np.concatenate((grid - 0.5, grid[..., -1:] + 0.5), axis=2) - bounded[..., np.newaxis]
    shares = cover_pixels(edges[:, 0], edges[:, 1], diameter / 2)  # (n_frames n_discs, n_steps, n_steps)
    columns, rows = grid[:, 0, np.newaxis], grid[:, 1, :, np.newaxis]
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    places = np.where(inside, width * rows + columns, width * height)
    shape = len(centers), -1  # (n_frames n_discs, n_steps, n_steps) -> (n_frames, n_discs n_steps n_steps)
    return places.reshape(shape), np.rint(255 * shares).astype(np.uint8).reshape(shape)
