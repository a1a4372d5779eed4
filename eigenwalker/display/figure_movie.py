"""Movies and pictures of bodies that move frame by frame."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import check_choice
from eigenwalker._whole_files import whole_file
from eigenwalker.display._ffmpeg import LUMA, encode_mp4, find_ffmpeg
from eigenwalker.display._numbers import check_number
from eigenwalker.display.capsules import draw_capsules
from eigenwalker.display.figures import FigureDisplay
from eigenwalker.display.movie import Movie
from eigenwalker.display.point_lights import frame_times
from eigenwalker.display.screen import Screen

__all__ = ["draw_figures", "write_figure_movie"]

_RATE = 60.0  # frames per second
_INK = {"sticks": 0.8, "dots": 1.0}  # from black to white: sticks are light gray
_THINNEST = 1.0  # pixels; what is thinner would be dark


def write_figure_movie(
    display: FigureDisplay,
    path: str | os.PathLike[str],
    *,
    duration: float | None = None,
    rate: float | None = None,
    screen: Screen | None = None,
    scale: float | None = None,
) -> Movie:
    """Write a body that moves frame by frame as an MP4, as a whole or not at all.

    Sticks are light gray on black and dots white, all of them a pixel wide at least; each frame shows the very time at
    which it appears.

    Parameters
    ----------
    display : FigureDisplay
        What to show.
    path : str or path
        Where to; ``.mp4`` (H.264, which browsers play, compressed with next to no loss).
    duration : float, default None
        In seconds; beyond its end a walk stands still. None is as long as the walk is.
    rate : float, default None
        Frames per second. None is 60.
    screen : Screen, default None
        Distance, pixels and size of the picture. None is `Screen()`.
    scale : float, default None
        Pixels a metre, so that several movies have the same one. None is that of the display.

    Returns
    -------
    Movie
        What was written: `path`, `times` of the frames and `delays`, `duration` and `rate`.

    Raises
    ------
    ImportError
        If ffmpeg is not installed.
    OSError
        If the file cannot be written.
    ValueError
        If the suffix is another one, sides are not even, or the body is larger than the picture.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display.figure_movie import write_figure_movie
    >>> from eigenwalker.display.figures import FigureDisplay
    >>> walker = FigureDisplay.from_walk(make_walkers(1, random_state=0).data[0])
    >>> with TemporaryDirectory() as folder:
    ...     write_figure_movie(walker.seen_from(30), Path(folder, "walker.mp4"), duration=0.5).times.shape
    (30,)
    """
    screen = Screen() if screen is None else screen
    target = Path(path)
    check_choice(target.suffix.lower(), (".mp4",), name="the suffix of path")
    if not target.parent.is_dir():
        raise FileNotFoundError(f"no folder {target.parent} for the movie {target.name}; make it first")
    width, height = screen.size
    if width % 2 or height % 2:
        raise ValueError(
            f"an MP4's width and height must be even, got {width} x {height}; use "
            f"Screen(size=({width + width % 2}, {height + height % 2}))"
        )
    find_ffmpeg()
    rate = _RATE if rate is None else check_number(rate, "rate", above=0, unit="frames per second")
    times = frame_times(display.duration if duration is None else duration, rate)
    pictures = _pictures(display, times, screen, scale, grays=LUMA)
    with whole_file(target) as part:
        encode_mp4(pictures, part, rate=Fraction(rate).limit_denominator(1001), size=screen.size)
    return Movie(target, times, np.full(len(times), 1 / rate))


def draw_figures(
    display: FigureDisplay, times: ArrayLike, screen: Screen | None = None, *, scale: float | None = None
) -> NDArray[np.uint8]:
    """Return the pictures of a movie as an array, for other software to show.

    Parameters
    ----------
    display : FigureDisplay
        What to show.
    times : array-like of shape (n_frames,)
        In seconds.
    screen : Screen, default None
        Distance, pixels and size of the picture. None is `Screen()`.
    scale : float, default None
        Pixels a metre. None is that of the display.

    Returns
    -------
    ndarray of shape (n_frames, height, width)
        Gray values from 0 for black to 255 for white, the topmost row first.
    """
    screen = Screen() if screen is None else screen
    moments = np.atleast_1d(np.asarray(times, dtype=np.float64))
    pictures = np.empty((len(moments), *screen.size[::-1]), dtype=np.uint8)
    for picture, drawn in zip(pictures, _pictures(display, moments, screen, scale), strict=True):
        picture[:] = drawn
    return pictures


def _pictures(
    display: FigureDisplay,
    times: NDArray[np.float64],
    screen: Screen,
    scale: float | None,
    *,
    grays: tuple[int, int] = (0, 255),
) -> Iterator[NDArray[np.uint8]]:
    """Return an iterator over pictures (height, width), black and white as in `grays`, each gone with the next."""
    size = np.asarray(screen.size)
    scale = display.pixels_per_meter(screen) if scale is None else check_number(scale, "scale", above=0)
    widths = np.maximum(display.widths(screen, scale), _THINNEST)
    wanted = scale * display.extent
    if (wanted > size + 1).any():
        raise ValueError(
            f"display {display.name!r}: expected a picture of {math.ceil(wanted[0])} x {math.ceil(wanted[1])} pixels "
            f"or more, got {size[0]} x {size[1]}; use Screen(size=...), or a smaller height"
        )
    places = scale * display.evaluate(times)
    # From the middle of the picture, upwards, to the middle of the pixel at the top left, downwards.
    centers = 0.5 * (size - 1) + places * (1, -1)
    low, high = grays
    ink = low + round(_INK[display.figure] * (high - low))
    return draw_capsules(centers[:, display.parts], widths / 2, screen.size, ground=low, ink=ink)
