"""Bodies shown frame by frame, as they were recorded or generated: stick figures, or dots, in place or on their way."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import check_array, check_choice, check_finite, check_frame_rate, restore_read_only
from eigenwalker.display._numbers import check_number
from eigenwalker.display.body import find_azimuth
from eigenwalker.display.point_lights import view_axes
from eigenwalker.display.screen import Screen
from eigenwalker.motion.skeleton import MarkerSet
from eigenwalker.motion.walk import Walk, check_marker_walk

__all__ = ["FIGURES", "FigureDisplay"]

FIGURES = ("sticks", "dots")
"""What a body can be shown as."""

_FILLED = 0.9  # part of the picture that is filled where no size is given
_STICK, _HEAD, _DOT = 0.024, 0.125, 0.025  # of the body's height: widths of sticks, head, and dots without a size


@dataclass(frozen=True, eq=False, repr=False)
class FigureDisplay:
    """A body that moves as it did frame by frame, to be shown as a stick figure or as dots.

    Where a `PointLightDisplay` repeats the harmonics of a stride, this shows a walk as it is, with its steps that
    differ, its turns and its way over the floor: walks of 3 to 17 seconds in the studies of Tilmanne, Moinet & Dutoit
    2012 (6.1), with and without displacement. The camera holds still, in orthographic projection. Make one with
    `FigureDisplay.from_walk`; each method returns a new one.

    Parameters
    ----------
    positions : ndarray of shape (n_frames, n_markers, 3)
        In metres; x forward, y left, z up.
    frame_rate : float
        Frames per second.
    marker_set : MarkerSet
        Names and sticks; a marker "head" is drawn as a disc.
    figure : {"sticks", "dots"}, default "sticks"
        What is drawn.
    azimuth : float, default 90.0
        Where the observer stands, in degrees: 0 in front, 90 at the walker's right side.
    height : float, default None
        Degrees of visual angle that the body spans. None is as large as the picture allows.
    dot_diameter : float, default None
        In degrees of visual angle. None is a fortieth of the body's height.
    body_height : float, default NaN
        In metres. NaN is from the lowest place of any marker to the highest.
    middle : array-like of shape (3,), default None
        What is in the middle of the picture, in metres. None is the middle of all that is seen in the course of time.
    name : str, default ""
        What it is called in errors.

    See Also
    --------
    write_figure_movie, draw_figures : Movies and pictures of it.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display.figures import FigureDisplay
    >>> walker = FigureDisplay.from_walk(make_walkers(1, random_state=0).data[0])
    >>> walker.seen_from("half-profile").evaluate([0.0, 0.5]).shape
    (2, 15, 2)
    """

    positions: NDArray[np.floating]
    frame_rate: float
    marker_set: MarkerSet
    figure: str = "sticks"
    azimuth: float = 90.0
    height: float | None = None
    dot_diameter: float | None = None
    body_height: float = math.nan
    middle: ArrayLike | None = None
    name: str = ""

    def __post_init__(self) -> None:
        shape = ("n_frames", len(self.marker_set.names), 3)
        object.__setattr__(self, "positions", check_array(self.positions, shape=shape, name="positions"))
        object.__setattr__(self, "frame_rate", check_frame_rate(self.frame_rate))
        if not (self.positions.size and np.isfinite(self.positions).all()):
            raise ValueError(f"positions must be finite, of one frame or more, got shape {self.positions.shape}")
        check_choice(self.figure, FIGURES, name="figure")
        object.__setattr__(self, "azimuth", check_number(self.azimuth, "azimuth", unit="degrees"))
        for name in ("height", "dot_diameter"):
            if getattr(self, name) is not None:
                value = check_number(getattr(self, name), name, above=0, at_most=90, unit="degrees of visual angle")
                object.__setattr__(self, name, value)
        object.__setattr__(self, "body_height", self._check_height())
        if not len(self.parts):
            raise ValueError(
                f"display {self.name!r}: expected a head or sticks to draw, got neither; use figure='dots'"
            )
        if self.middle is not None:
            object.__setattr__(self, "middle", check_array(self.middle, shape=(3,), name="middle"))

    def _check_height(self) -> float:
        if not math.isnan(self.body_height):
            return check_number(self.body_height, "body_height", above=0, unit="metres")
        height = float(np.ptp(self.positions[..., 2]))
        if height <= 0:
            raise ValueError(f"display {self.name!r}: expected a body of some height, got all markers on one level")
        return height

    def __setstate__(self, state: dict[str, object]) -> None:
        restore_read_only(self, state)

    @classmethod
    def from_walk(cls, walk: Walk) -> Self:
        """Return the stick figure of a walk, from the side.

        Parameters
        ----------
        walk : Walk
            Where it goes over the floor it does so in the picture: `prepare` it to show it in place.

        Raises
        ------
        TypeError
            If it is a JointWalk; `to_markers` makes a Walk of it.
        WalkError
            If markers are missing in some frames.
        """
        walk = check_marker_walk(walk)
        check_finite(walk.channels, walk.channel_names, walk=walk.name)
        return cls(walk.size * walk.positions, walk.frame_rate, walk.marker_set, name=walk.name)

    @property
    def duration(self) -> float:
        """Number of frames over frame rate, in seconds."""
        return len(self.positions) / self.frame_rate

    def seen_from(self, view: str | float) -> Self:
        """Return the display from another viewpoint.

        Parameters
        ----------
        view : {"frontal", "half-profile", "side"} or float
            Azimuth in degrees: 0 walks towards the observer, 90 to the right, -90 to the left, 180 away.
        """
        azimuth = find_azimuth(view) if isinstance(view, str) else view
        return replace(self, azimuth=check_number(azimuth, "view", unit="degrees"))

    def sized(self, height: float | None) -> Self:
        """Return the display in another size: degrees of visual angle that the body spans, None as large as fits."""
        return replace(self, height=height)

    def drawn_as(self, figure: str, *, dot_diameter: float | None = None) -> Self:
        """Return the display of "sticks" or "dots", these maybe of a diameter in degrees of visual angle."""
        return replace(self, figure=figure, dot_diameter=dot_diameter)

    def evaluate(self, times: ArrayLike) -> NDArray[np.float64]:
        """Return where the markers are seen at any times.

        Between two frames they go straight; before the first one and after the last one they stand still.

        Parameters
        ----------
        times : array-like of shape (n_times,)
            In seconds.

        Returns
        -------
        ndarray of shape (n_times, n_markers, 2)
            To the right and up from the middle of the picture, in metres.
        """
        moments = np.asarray(times, dtype=np.float64)
        if moments.ndim != 1 or not np.isfinite(moments).all():
            raise ValueError(f"times must be finite and have shape (n_times,), got shape {moments.shape}")
        last = len(self.positions) - 1
        frames = np.clip(moments * self.frame_rate, 0, last)
        before = np.floor(frames).astype(np.intp)
        share = (frames - before)[:, np.newaxis, np.newaxis]
        seen = self._seen()
        return (1 - share) * seen[before] + share * seen[np.minimum(before + 1, last)]

    @property
    def extent(self) -> NDArray[np.float64]:
        """Metres across and up of the least picture that all of the figure is in all the time, shape (2,)."""
        drawn = np.abs(self._seen()[:, self.parts])  # (n_frames, n_parts, 2 ends, 2)
        return 2 * (drawn + self._shares()[:, np.newaxis, np.newaxis] * self.body_height / 2).max(axis=(0, 1, 2))

    def pixels_per_meter(self, screen: Screen) -> float:
        """Return the scale on a screen: that of the height in degrees, or that at which nine tenths are filled."""
        if self.height is not None:
            return screen.pixels_across(self.height) / self.body_height
        return float((_FILLED * np.asarray(screen.size) / self.extent).min())

    @property
    def parts(self) -> NDArray[np.intp]:
        """What is drawn: sticks by the markers at their ends, then discs, which end where they begin, (n_parts, 2)."""
        names, sticks = self.marker_set.names, self.marker_set.sticks
        if self.figure == "dots":
            sticks = tuple((name, name) for name in names)
        elif "head" in names:
            sticks = (*sticks, ("head", "head"))
        return np.array([[names.index(end) for end in ends] for ends in sticks], dtype=np.intp).reshape(-1, 2)

    def widths(self, screen: Screen, scale: float) -> NDArray[np.float64]:
        """Return how wide the parts are on a screen, in pixels, at a scale in pixels a metre, shape (n_parts,)."""
        if self.figure == "dots" and self.dot_diameter is not None:
            return np.full(len(self.parts), screen.pixels_across(self.dot_diameter))
        return scale * self.body_height * self._shares()

    def _shares(self) -> NDArray[np.float64]:
        """Return how wide the parts are, in heights of the body."""
        if self.figure == "dots":
            return np.full(len(self.parts), _DOT)
        return np.array([_HEAD if start == end else _STICK for start, end in self.parts])

    def _seen(self) -> NDArray[np.float64]:
        """Return the places of all frames, shape (n_frames, n_markers, 2), from the middle of the picture."""
        axes = view_axes(self.azimuth, 0.0)[:2]
        seen = np.asarray(self.positions, dtype=np.float64) @ axes.T  # (n_frames, n_markers, 2)
        if self.middle is not None:
            return seen - axes @ np.asarray(self.middle, dtype=np.float64)
        low, high = seen.min(axis=(0, 1)), seen.max(axis=(0, 1))
        return seen - 0.5 * (low + high)

    def __repr__(self) -> str:
        """Say what there is, without the numbers."""
        return f"<FigureDisplay {self.name!r}: {self.figure}, {self.duration:.3g} s>"
