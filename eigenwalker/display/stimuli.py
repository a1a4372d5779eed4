"""Point-light displays for experiments: a walker of dots, whole, inverted, scrambled, masked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.utils import check_random_state

from eigenwalker._validation import check_choice, check_names
from eigenwalker.display._numbers import check_count, check_number
from eigenwalker.display.body import find_azimuth
from eigenwalker.display.dots import Dots, walker_dots
from eigenwalker.display.lifetime import Lifetime, lit_dots
from eigenwalker.display.point_lights import frame_times, view_axes
from eigenwalker.display.scrambling import (
    choose_clones,
    rectangle,
    scatter_periods,
    scatter_phases,
    scrambling_directions,
)
from eigenwalker.display.screen import Screen
from eigenwalker.motion.walk import Walk

__all__ = ["PointLightDisplay"]

_UNITS = ("m", "deg", "px")
_POLARITIES = ("light", "dark")
_HEIGHT = 10.0  # degrees of visual angle
_Seed = int | np.random.RandomState | None


@dataclass(frozen=True, eq=False, repr=False)
class PointLightDisplay:
    """Dots that move like the joints of a walker, evaluated from their Fourier coefficients at any time.

    Make one with `PointLightDisplay.from_walk`. Each method returns a new display and changes **all dots that there
    are at that moment**, so the order of the calls is part of the stimulus: the mask of
    ``walker.inverted().add_mask(60)`` is made of the inverted walker's dots, and ``walker.add_mask(60).inverted()``
    inverts both. Inversion and the scrambling of an "area" happen in the plane of the current view: turn that first.

    Places depend on time alone, see the module `point_lights`, so that every frame rate is exact. Random numbers come
    from `numpy.random.RandomState`, whose stream is fixed: one seed gives the same frames on every machine, but for
    the rounding of its sines, 1e-12 m.

    Parameters
    ----------
    dots : Dots
        The walker's, and behind them those of its masks. Zero is the middle of the walker.
    height : float
        What the walker's markers cover from bottom to top in the course of a stride, in metres.
    scale : float
        Tangent of the visual angle that a metre spans: 1 / (metres from which a walker of life size is seen).
    speed : float, default NaN
        At which the walker would walk over the floor, in m/s; NaN where it is unknown.
    azimuth, elevation : float, default 90.0 and 0.0
        Where the observer stands, in degrees, see `seen_from`.
    dot_diameter : float, default 0.25
        In degrees of visual angle.
    polarity : {"light", "dark"}, default "light"
        Light dots on dark, or dark dots on light.
    start : float, default 0.0
        Phase of the walker at time zero, in strides, see `starting_at`.
    lifetimes : tuple of Lifetime, default ()
        Runs of dots of which only some are lit at a time.
    name : str, default ""
        What the display is called in errors.

    See Also
    --------
    make_display : The same from one flat set of parameters, such as a row of a table of conditions.
    eigenwalker.model.hybrid_walk : Structure of one walker, dynamics of another, to make a display of.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import PointLightDisplay, Screen
    >>> walker = PointLightDisplay.from_walk(make_walkers(1, random_state=0).data[0])
    >>> walker.frames(duration=2.0, rate=60).shape
    (120, 15, 2)
    >>> masked = walker.sized(height=6).scramble_position(random_state=1).add_mask(45, random_state=2)
    >>> masked.frames(2.0, 144, unit="px", screen=Screen(distance=0.8)).shape
    (288, 60, 2)
    """

    dots: Dots
    height: float
    scale: float
    speed: float = math.nan
    azimuth: float = 90.0
    elevation: float = 0.0
    dot_diameter: float = 0.25
    polarity: str = "light"
    start: float = 0.0
    lifetimes: tuple[Lifetime, ...] = ()
    name: str = ""

    @classmethod
    def from_walk(cls, walk: Walk, *, n_harmonics: int = 4, markers: Sequence[str] | None = None) -> Self:
        """Return the display of a walk, see `walker_dots`: one dot a marker, from the side, 10 degrees high.

        Parameters
        ----------
        walk : Walk
            In place, from `prepare` or from a model.
        n_harmonics : int, default 4
            Number of harmonics that are kept. With at least as many as a model has, its walks are exact.
        markers : sequence of str, default None
            Those that become dots. None takes all. Middle and height are those of all in any case, so that parts of
            a walker stay where they are in the whole.
        """
        dots, height = walker_dots(walk, n_harmonics)
        scale = 2 * math.tan(math.radians(_HEIGHT) / 2) / height
        whole = cls(dots, height, scale, speed=walk.speed, name=walk.name)
        return whole if markers is None else whole.only(markers)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the dots: those of markers, and ``mask1_left_ankle`` and so on."""
        return self.dots.names

    @property
    def is_mask(self) -> NDArray[np.bool_]:
        """Which dots `add_mask` made, shape (n_dots,)."""
        return np.array([name.startswith("mask") for name in self.names])

    @property
    def period(self) -> float:
        """Seconds after which the picture repeats itself, those of a stride; infinite where it never does."""
        dots = self.dots
        repeats = not (np.ptp(dots.frequencies) or dots.velocities.any() or self.lifetimes)
        return 1 / float(dots.frequencies[0]) if repeats else math.inf

    @property
    def axes(self) -> NDArray[np.float64]:
        """To the right of the picture, up, and towards the observer: unit vectors, one a row, shape (3, 3)."""
        return view_axes(self.azimuth, self.elevation)

    def frames(
        self, duration: float, rate: float, *, unit: str = "m", screen: Screen | None = None
    ) -> NDArray[np.float64]:
        """Return the places of the dots in evenly spaced frames, shape (n_frames, n_dots, 2).

        Parameters
        ----------
        duration : float
            In seconds; there are duration times rate frames, rounded.
        rate : float
            Frames per second: frame i is that of time i / rate.
        unit, screen : str, default "m", and Screen, default None
            See `evaluate`, as for what is returned.
        """
        return self.evaluate(frame_times(duration, rate), unit=unit, screen=screen)

    def evaluate(self, times: ArrayLike, *, unit: str = "m", screen: Screen | None = None) -> NDArray[np.float64]:
        """Return the places of the dots at any times, such as those at which a screen really flipped.

        Parameters
        ----------
        times : array-like of shape (n_times,)
            In seconds, in any order; not negative for dots of limited lifetime.
        unit : {"m", "deg", "px"}, default "m"
            Metres at the walker, in life size; degrees of visual angle, one an axis, by the exact tangent; pixels.
        screen : Screen, default None
            Needed for pixels only: places in degrees are the same on every screen.

        Returns
        -------
        ndarray of shape (n_times, n_dots, 2)
            To the right and up, from the middle of the picture; NaN where a dot is not lit.
        """
        check_choice(unit, _UNITS, name="unit")
        moments = np.asarray(times, dtype=np.float64)
        if moments.ndim != 1 or not np.isfinite(moments).all():
            raise ValueError(f"times must be finite and have shape (n_times,), got shape {moments.shape}")
        places = self.dots.evaluate(moments, self.axes[:2], self.start)
        for lifetime in self.lifetimes:
            places[:, lifetime.first : lifetime.stop][~lit_dots(moments, lifetime)] = np.nan
        if unit == "m":
            return places
        degrees = np.rad2deg(np.arctan(self.scale * places))
        if unit == "deg":
            return degrees
        if not isinstance(screen, Screen):
            raise TypeError(f"unit='px' needs screen=Screen(distance, pixel_pitch, size), got {screen!r}")
        return screen.to_pixels(degrees)

    def seen_from(self, view: str | float, elevation: float = 0.0) -> Self:
        """Return the display from another viewpoint, in orthographic projection.

        Parameters
        ----------
        view : {"frontal", "half-profile", "side"} or float
            Azimuth in degrees: 0 walks towards the observer, 90 to the right, -90 to the left, 180 away.
        elevation : float, default 0.0
            How far above the walker's horizon the observer is, in degrees, -90 to 90.
        """
        azimuth = check_number(find_azimuth(view) if isinstance(view, str) else view, "view", unit="degrees")
        elevation = check_number(elevation, "elevation", at_least=-90, at_most=90, unit="degrees")
        return replace(self, azimuth=azimuth, elevation=elevation)

    def sized(self, *, height: float | None = None, distance: float | None = None) -> Self:
        """Return the display in another size.

        Parameters
        ----------
        height : float, default None
            Degrees of visual angle that the whole walker spans, upright in the middle of the screen.
        distance : float, default None
            Metres from which a walker of life size is seen, so that tall walkers stay taller than small ones. One of
            the two must be given.
        """
        if (height is None) == (distance is None):
            raise ValueError(f"give either height or distance, got height={height!r} and distance={distance!r}")
        if distance is not None:
            return replace(self, scale=1 / check_number(distance, "distance", above=0, unit="metres"))
        angle = check_number(height, "height", above=0, at_most=170, unit="degrees of visual angle")
        return replace(self, scale=2 * math.tan(math.radians(angle) / 2) / self.height)

    def with_dots(self, diameter: float, polarity: str = "light") -> Self:
        """Return the display with dots of another diameter, in degrees of visual angle, "light" or "dark"."""
        check_choice(polarity, _POLARITIES, name="polarity")
        diameter = check_number(diameter, "diameter", above=0, at_most=90, unit="degrees of visual angle")
        return replace(self, dot_diameter=diameter, polarity=polarity)

    def starting_at(self, phase: float | None, *, random_state: _Seed = None) -> Self:
        """Return the display with another phase at time zero.

        Parameters
        ----------
        phase : float or None
            In strides: at 0 the left ankle is furthest in front of the right one, at 0.5 behind it. None draws one.
        random_state : int, RandomState or None, default None
            What it is drawn with.
        """
        drawn = check_random_state(random_state).random_sample() if phase is None else phase
        return replace(self, start=check_number(drawn, "phase", unit="strides"))

    def only(self, names: Sequence[str]) -> Self:
        """Return the display with some of its dots, by their names, in the order given."""
        wanted = check_names(names, name="names")
        unknown = [name for name in wanted if name not in self.names]
        if unknown or not wanted:
            raise ValueError(f"names must be out of {', '.join(self.names)}, got {', '.join(unknown) or 'none'}")
        if self.lifetimes:
            raise ValueError("choose the dots first, and limit their lifetime afterwards")
        return replace(self, dots=self.dots.pick([self.names.index(name) for name in wanted], wanted))

    def inverted(self, *, local: bool = False) -> Self:
        """Return the display upside down.

        Parameters
        ----------
        local : bool, default False
            False mirrors the picture about the horizontal line through its middle: the walker stands on its head and
            faces the same way. True mirrors each dot's own motion about the horizontal line through its mean: the
            means stay where they are.
        """
        return replace(self, dots=self.dots.reflected(self.axes[1], local=local))

    def scramble_position(self, amount: float = 1.0, *, how: str = "area", random_state: _Seed = None) -> Self:
        """Return the display with the dots' means scrambled; each dot's own motion stays exactly as it is.

        Each mean moves the part `amount` of the way to a place drawn evenly from those from which the dot's whole path
        stays inside the box that the display's dots cover now, see `scatter_means`.

        Parameters
        ----------
        amount : float, default 1.0
            From 0, none, to 1, anywhere.
        how : {"area", "horizontal", "vertical", "volume", "x", "y", "z"}, default "area"
            Directions in which they move: in the plane of the picture, along one of its axes, in space, or along one
            of the walker's axes.
        random_state : int, RandomState or None, default None
            Asked for one number for each dot and direction, dots first.
        """
        amount = check_number(amount, "amount", at_least=0, at_most=1)
        directions = scrambling_directions(how, self.axes)
        scattered = self.dots.scattered(directions, check_random_state(random_state), amount=amount)
        return replace(self, dots=scattered)

    def scramble_phase(self, amount: float = 1.0, *, random_state: _Seed = None) -> Self:
        """Return the display with the dots' phases scrambled, see `scatter_phases`; paths stay exactly as they are.

        Parameters
        ----------
        amount : float, default 1.0
            From 0, none, to 1, any phase: phases move evenly by up to half of this, in strides, either way.
        random_state : int, RandomState or None, default None
            Asked for one number for each dot.
        """
        amount = check_number(amount, "amount", at_least=0, at_most=1)
        uniform = check_random_state(random_state).random_sample(len(self.names))
        return replace(self, dots=replace(self.dots, phases=scatter_phases(self.dots.phases, uniform, amount=amount)))

    def scramble_period(self, amount: float = 1.0, *, random_state: _Seed = None) -> Self:
        """Return the display with the dots' periods scrambled, see `scatter_periods`; paths stay exactly as they are.

        Parameters
        ----------
        amount : float, default 1.0
            Periods are multiplied by 1 / (1 + amount) to 1 + amount, the logarithm of it drawn evenly.
        random_state : int, RandomState or None, default None
            Asked for one number for each dot.
        """
        amount = check_number(amount, "amount", at_least=0)
        uniform = check_random_state(random_state).random_sample(len(self.names))
        frequencies = scatter_periods(self.dots.frequencies, uniform, amount=amount)
        return replace(self, dots=replace(self.dots, frequencies=frequencies))

    def translating(self, speed: float | None = None, *, start: float = 0.0) -> Self:
        """Return the display of dots that move forward instead of staying in place.

        Parameters
        ----------
        speed : float, default None
            In m/s. None takes the walker's own, at which its feet do not slide.
        start : float, default 0.0
            How far ahead the dots are at time zero, in metres; -speed * duration / 2 is in the middle half way.
        """
        if speed is None and math.isnan(self.speed):
            raise ValueError(
                f"display {self.name!r}: the walk's own speed is unknown; give translating(speed=...) in m/s, or set "
                "it on the walk, dataclasses.replace(walk, speed=1.3)"
            )
        pace = check_number(self.speed if speed is None else speed, "speed", unit="m/s")
        forward, ahead = np.array([1.0, 0.0, 0.0]), check_number(start, "start", unit="metres")
        return replace(self, dots=self.dots.moving(pace * forward, ahead * forward))

    def add_mask(
        self,
        n_dots: int,
        *,
        source: PointLightDisplay | None = None,
        area: tuple[float, float] | None = None,
        phase: float = 1.0,
        random_state: _Seed = None,
    ) -> Self:
        """Return the display with mask dots, clones of its dots that are scrambled (Cutting, Moore & Morrison 1988).

        All dots are cloned equally often, those of an incomplete round drawn at random, so that the mask has the
        motion of what it masks. Positions of clones are scrambled wholly, phases by `phase`.

        Parameters
        ----------
        n_dots : int
            Number of mask dots.
        source : PointLightDisplay, default None
            Whose dots are cloned, masks left aside. None takes this display.
        area : (float, float), default None
            Width and height in metres, around the middle of the picture, of the area in which their paths stay. None
            takes the rectangle that the source's dots cover.
        phase : float, default 1.0
            Amount of `scramble_phase`; clones with 0 move in step with the walker.
        random_state : int, RandomState or None, default None
            Asked for one number for each dot of the source, two for each clone's place, one for each clone's phase.
        """
        n_dots = check_count(n_dots, "n_dots", at_least=1)
        phase = check_number(phase, "phase", at_least=0, at_most=1)
        random, whole = check_random_state(random_state), self if source is None else source
        walker = np.flatnonzero(~whole.is_mask)
        clones = walker[choose_clones(n_dots, random.random_sample(len(walker)))]
        first = np.count_nonzero(self.is_mask) + 1
        mask = whole.dots.pick(clones, [f"mask{first + k}_{whole.names[dot]}" for k, dot in enumerate(clones)])
        mask = mask.scattered(self.axes[:2], random, box=None if area is None else rectangle(area))
        phases = mask.phases + whole.start - self.start  # the source's start, not this display's
        phases = scatter_phases(phases, random.random_sample(n_dots), amount=phase)
        return replace(self, dots=self.dots.join(replace(mask, phases=phases)))

    def limit_lifetime(self, n_visible: int, lifetime: float, *, random_state: _Seed = None) -> Self:
        """Return the display with only some dots lit at a time, each for a limited time, see `lit_dots`.

        Dots that are limited already stay as they are, so that a walker and its mask can be limited apart:
        ``walker.limit_lifetime(5, 0.2).add_mask(60).limit_lifetime(20, 0.2)``.

        Parameters
        ----------
        n_visible : int
            How many dots are lit at any time, at least one and fewer than there are.
        lifetime : float
            How long each stays lit, in seconds.
        random_state : int, RandomState or None, default None
            What their order is drawn with.
        """
        first, stop = self.lifetimes[-1].stop if self.lifetimes else 0, len(self.names)
        if stop - first < 2:
            raise ValueError(f"a limited lifetime needs at least two dots that have none yet, got {stop - first}")
        n_visible = check_count(n_visible, "n_visible", at_least=1, at_most=stop - first - 1)
        lifetime = check_number(lifetime, "lifetime", above=0, unit="seconds")
        seed = int(check_random_state(random_state).random_sample() * 2**32)
        return replace(self, lifetimes=(*self.lifetimes, Lifetime(first, stop, n_visible, lifetime, seed)))

    def __repr__(self) -> str:
        """Say what there is, without the numbers."""
        return f"<PointLightDisplay {self.name!r}: {len(self.names)} dots, {self.is_mask.sum()} of them mask>"
