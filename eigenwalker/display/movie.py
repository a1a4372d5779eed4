"""Point-light displays as movies: MP4 through ffmpeg, GIF through Pillow."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import check_choice
from eigenwalker._whole_files import whole_file
from eigenwalker.display._ffmpeg import LUMA, encode_mp4, find_ffmpeg
from eigenwalker.display._numbers import check_number
from eigenwalker.display.discs import draw_discs
from eigenwalker.display.point_lights import frame_times
from eigenwalker.display.screen import Screen
from eigenwalker.display.stimuli import PointLightDisplay

__all__ = ["Movie", "draw_frames", "plan_movie", "write_movie"]

_RATES = {".mp4": 60.0, ".gif": 50.0}  # frames per second, unless given
_HUNDREDTHS = 100  # of a second, in which the delays of GIF are counted
_FASTEST_GIF = 50.0
_SMALLEST_DOT = 1.0  # pixels; the center of mass of smaller ones is more than a tenth of a pixel off


class Movie(NamedTuple):
    """A movie file, or one to be.

    Parameters
    ----------
    path : Path
        Where it is.
    times : ndarray of shape (n_frames,)
        What its frames show, in seconds of the display.
    delays : ndarray of shape (n_frames,)
        How long each of them is shown, in seconds.
    """

    path: Path
    times: NDArray[np.float64]
    delays: NDArray[np.float64]

    @property
    def duration(self) -> float:
        """In seconds."""
        return math.fsum(self.delays)

    @property
    def rate(self) -> float:
        """Frames per second, the mean of a GIF's."""
        return len(self.delays) / self.duration


def write_movie(
    display: PointLightDisplay,
    path: str | os.PathLike[str],
    *,
    duration: float | None = None,
    rate: float | None = None,
    screen: Screen | None = None,
) -> Movie:
    """Write a display as a movie, as a whole or not at all.

    Each frame shows the display at the very time at which it appears. The dots are smooth at their edges, white on
    black or black on white, in the values of pixels: what luminance a screen gives them is the screen's. The file's
    pixels are the screen's; show it in its own size.

    Parameters
    ----------
    display : PointLightDisplay
        What to show.
    path : str or path
        Where to; ``.mp4`` (H.264, which browsers play, compressed with next to no loss) or ``.gif`` (no loss).
    duration : float, default None
        In seconds. None is exactly one stride, which loops without a seam; the display must repeat itself.
    rate : float, default None
        Frames per second. None is 60, for a GIF 50, the most there is. One stride rarely has a whole number of frames.
        An MP4 then has the nearest whole number, evenly spaced, and is played a little faster or slower, so that the
        stride lasts as long as it does. A GIF counts time in hundredths of a second: its stride lasts the nearest
        number of them (0.5 % off at worst), and where frames do not divide it, some stay for a hundredth longer.
    screen : Screen, default None
        Distance, pixels and size of the picture. None is `Screen()`.

    Returns
    -------
    Movie
        What was written: `path`, `times` of the frames and `delays`, `duration` and `rate`.

    Raises
    ------
    ImportError
        If ffmpeg, or Pillow for a GIF, is not installed.
    OSError
        If the file cannot be written.
    ValueError
        If the display does not repeat itself and no duration is given; if the suffix is another one; if an MP4's sides
        are not even; if a GIF has more than 50 frames per second; if dots are smaller than a pixel.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import PointLightDisplay, write_movie
    >>> walker = PointLightDisplay.from_walk(make_walkers(1, random_state=0).data[0])
    >>> with TemporaryDirectory() as folder:
    ...     movie = write_movie(walker.scramble_phase(random_state=0), Path(folder, "scrambled.gif"))
    >>> len(movie.times), movie.duration
    (49, 0.98)
    """
    screen = Screen() if screen is None else screen
    movie = plan_movie(display, path, duration=duration, rate=rate, screen=screen)
    with whole_file(movie.path) as part:
        if movie.path.suffix.lower() == ".gif":
            _encode_gif(_pictures(display, movie.times, screen), part, movie.delays)
        else:
            pictures = _pictures(display, movie.times, screen, grays=LUMA)
            encode_mp4(pictures, part, rate=Fraction(movie.rate).limit_denominator(1001), size=screen.size)
    return movie


def draw_frames(display: PointLightDisplay, times: ArrayLike, screen: Screen | None = None) -> NDArray[np.uint8]:
    """Return the pictures of a movie as an array, for other software to show.

    Parameters
    ----------
    display : PointLightDisplay
        What to show.
    times : array-like of shape (n_frames,)
        In seconds.
    screen : Screen, default None
        Distance, pixels and size of the picture. None is `Screen()`.

    Returns
    -------
    ndarray of shape (n_frames, height, width)
        Gray values from 0 for black to 255 for white, the topmost row first.
    """
    screen = Screen() if screen is None else screen
    moments = np.atleast_1d(np.asarray(times, dtype=np.float64))
    pictures = np.empty((len(moments), *screen.size[::-1]), dtype=np.uint8)
    for picture, drawn in zip(pictures, _pictures(display, moments, screen), strict=True):
        picture[:] = drawn
    return pictures


def _pictures(
    display: PointLightDisplay, times: NDArray[np.float64], screen: Screen, *, grays: tuple[int, int] = (0, 255)
) -> Iterator[NDArray[np.uint8]]:
    """Return an iterator over pictures (height, width), black and white as in `grays`, each gone with the next."""
    places = display.evaluate(times, unit="px", screen=screen)
    width, height = screen.size
    # From the middle of the picture, upwards, to the middle of the pixel at the top left, downwards.
    centers = np.array([0.5, -0.5]) * (width - 1, height - 1) * (1, -1) + places * (1, -1)
    ground, disc = grays if display.polarity == "light" else grays[::-1]
    return draw_discs(centers, _dot_pixels(display, screen), screen.size, ground=ground, disc=disc)


def _dot_pixels(display: PointLightDisplay, screen: Screen) -> float:
    pixels = screen.pixels_across(display.dot_diameter)
    if pixels < _SMALLEST_DOT:
        raise ValueError(
            f"dots must be at least {_SMALLEST_DOT:g} pixel wide, to be where they should be, got {pixels:.2g} from a "
            f"diameter of {display.dot_diameter:g} degrees; use larger dots, display.with_dots(diameter), or a Screen "
            "with finer pixels or farther away"
        )
    return pixels


def plan_movie(
    display: PointLightDisplay,
    path: str | os.PathLike[str],
    *,
    duration: float | None,
    rate: float | None,
    screen: Screen,
) -> Movie:
    """Return the movie that `write_movie` would write, or raise its errors, without writing it."""
    target = Path(path)
    suffix = target.suffix.lower()
    check_choice(suffix, _RATES, name="the suffix of path")
    if not target.parent.is_dir():
        raise FileNotFoundError(f"no folder {target.parent} for the movie {target.name}; make it first")
    _dot_pixels(display, screen)
    if duration is None and math.isinf(display.period):
        raise ValueError(
            f"display {display.name!r} does not repeat itself after a stride, because its dots travel, differ in their "
            "periods or have a limited lifetime; give a duration in seconds"
        )
    rate = _RATES[suffix] if rate is None else check_number(rate, "rate", above=0, unit="frames per second")
    span = display.period if duration is None else check_number(duration, "duration", above=0, unit="seconds")
    if suffix == ".gif":
        _import_pillow()
        return Movie(target, *_gif_times(span, rate, cycle=duration is None))
    find_ffmpeg()
    width, height = screen.size
    if width % 2 or height % 2:
        raise ValueError(
            f"an MP4's width and height must be even, got {width} x {height}; use "
            f"Screen(size=({width + width % 2}, {height + height % 2}))"
        )
    return Movie(target, *_mp4_times(span, rate, cycle=duration is None))


def _mp4_times(span: float, rate: float, *, cycle: bool) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times and delays, shape (n_frames,), of a cycle in evenly spaced frames, or of a duration."""
    played = max(1, round(span * rate)) / span if cycle else rate
    times = frame_times(span, played)
    return times, np.full(len(times), 1 / played)


def _gif_times(span: float, rate: float, *, cycle: bool) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times and delays, shape (n_frames,), with delays in whole hundredths of a second."""
    if rate > _FASTEST_GIF:
        raise ValueError(
            f"a GIF has at most {_FASTEST_GIF:g} frames per second, because it counts in hundredths of a second and "
            f"browsers show one of them as ten, got rate={rate:g}; use rate={_FASTEST_GIF:g}, or an MP4"
        )
    total = round(_HUNDREDTHS * span)
    n_frames = int(total * rate / _HUNDREDTHS + 1e-9)
    if n_frames == 0:
        raise ValueError(f"duration must hold at least one frame, got {span:g} s at {rate:g} frames per second")
    ends = np.rint(np.arange(n_frames + 1) * total / n_frames)
    shown = span / total if cycle else 1 / _HUNDREDTHS  # seconds of the display in a hundredth of the movie
    return ends[:-1] * shown, np.diff(ends) / _HUNDREDTHS


def _encode_gif(pictures: Iterable[NDArray[np.uint8]], path: Path, delays: NDArray[np.float64]) -> None:
    """Write gray pictures as a GIF that repeats for ever."""
    image_module = _import_pillow()
    grays = bytes(level for level in range(256) for _ in "rgb")

    def as_images() -> Iterator[Any]:
        for picture in pictures:
            image = image_module.frombytes("P", picture.shape[::-1], picture.tobytes())
            image.putpalette(grays)
            yield image

    images = as_images()
    milliseconds = [round(1000 * delay) for delay in delays]
    with path.open("wb") as file:
        next(images).save(
            file, format="GIF", save_all=True, append_images=images, duration=milliseconds, loop=0, optimize=False
        )


def _import_pillow() -> Any:
    try:
        from PIL import Image
    except ImportError:
        raise ImportError("GIF movies need Pillow: pip install 'eigenwalker[movie]'") from None
    return Image
