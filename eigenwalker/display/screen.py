r"""Degrees of visual angle, metres and pixels on a flat screen.

A point at distance r from the middle of a screen is seen at the angle a from it, with

.. math:: r = D \tan a

where D is the distance from the eye to the middle of the screen: no small-angle rule. A line of length l in the middle
of the screen spans 2 atan(l / 2 D).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.display._numbers import check_count, check_number

__all__ = ["Screen"]


@dataclass(frozen=True)
class Screen:
    """What a display is shown on: how far away, how large a pixel, how many of them.

    Parameters
    ----------
    distance : float, default 0.57
        From the observer's eye to the middle of the screen, in metres. At 0.57 m one centimetre is one degree, nearly.
    pixel_pitch : float, default 0.00027
        From one pixel to the next, in metres: the width of the screen over its number of pixels. Pixels are square.
    size : (int, int), default (640, 480)
        Width and height of the picture, in pixels. Its middle is the zero of all places on the screen.

    Examples
    --------
    A screen 53 cm wide with 1920 pixels, 80 cm away:

    >>> from eigenwalker.display import Screen
    >>> screen = Screen(distance=0.8, pixel_pitch=0.53 / 1920, size=(800, 600))
    >>> round(screen.pixels_across(5.0), 2)
    253.07
    >>> [round(angle, 2) for angle in screen.extent]
    [15.72, 11.82]
    """

    distance: float = 0.57
    pixel_pitch: float = 0.00027
    size: tuple[int, int] = (640, 480)

    def __post_init__(self) -> None:
        for name in ("distance", "pixel_pitch"):
            value = check_number(getattr(self, name), name, above=0, unit="metres")
            object.__setattr__(self, name, value)
        if self.pixel_pitch > 0.01:
            raise ValueError(f"pixel_pitch must be in metres, 0.00027 for instance, got {self.pixel_pitch:g}")
        if not isinstance(self.size, (tuple, list, np.ndarray)) or len(self.size) != 2:
            raise ValueError(f"size must be (width, height) in pixels, got {self.size!r}")
        width, height = (check_count(pixels, "size", at_least=1) for pixels in self.size)
        object.__setattr__(self, "size", (width, height))

    @property
    def extent(self) -> tuple[float, float]:
        """Degrees of visual angle that the picture spans, across and up."""
        across, up = (2 * math.degrees(math.atan(0.5 * n * self.pixel_pitch / self.distance)) for n in self.size)
        return across, up

    def to_pixels(self, degrees: ArrayLike) -> NDArray[np.float64]:
        """Return places in pixels from the middle of the screen, from places in degrees, one angle an axis."""
        angles = np.deg2rad(np.asarray(degrees, dtype=np.float64))
        return self.distance / self.pixel_pitch * np.tan(angles)

    def to_degrees(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Return places in degrees, one angle an axis, from places in pixels from the middle of the screen."""
        meters = self.pixel_pitch * np.asarray(pixels, dtype=np.float64)
        return np.rad2deg(np.arctan(meters / self.distance))

    def pixels_across(self, degrees: float) -> float:
        """Return how many pixels a line in the middle of the screen is long that spans an angle."""
        return 2 * float(self.to_pixels(degrees / 2))
