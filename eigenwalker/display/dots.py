"""Dots that each run along a path of their own, and the dots of a walker."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import check_array, check_finite, check_names, restore_read_only
from eigenwalker.display._numbers import check_count
from eigenwalker.display.point_lights import evaluate_dots, path_reach, reflect
from eigenwalker.display.scrambling import scatter_means
from eigenwalker.motion.fourier import fit_harmonics, reference_phase, shift_phase
from eigenwalker.motion.heading import check_in_place
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.walk import Walk, check_marker_walk

__all__ = ["Dots", "walker_dots"]


@dataclass(frozen=True, eq=False)
class Dots:
    """Where dots are at any time; the formula is that of the module `point_lights`.

    Parameters
    ----------
    coefficients : ndarray of shape (2 n_harmonics + 1, n_dots, 3)
        Rows mean, sin1, cos1, ..., in metres; x forward, y left, z up.
    frequencies : ndarray of shape (n_dots,)
        Strides per second.
    phases : ndarray of shape (n_dots,)
        At time zero, in strides.
    velocities : ndarray of shape (n_dots, 3)
        In m/s; zero for dots that stay in place.
    names : tuple of str
        One name a dot.
    """

    coefficients: NDArray[np.floating]
    frequencies: NDArray[np.floating]
    phases: NDArray[np.floating]
    velocities: NDArray[np.floating]
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        names = check_names(self.names, name="names")
        object.__setattr__(self, "names", names)
        n_dots = len(names)
        shapes: dict[str, tuple[int | str, ...]] = {
            "coefficients": ("2 n_harmonics + 1", n_dots, 3),
            "frequencies": (n_dots,),
            "phases": (n_dots,),
            "velocities": (n_dots, 3),
        }
        for name, shape in shapes.items():
            array = check_array(getattr(self, name), shape=shape, name=name)
            if not np.isfinite(array).all():
                raise ValueError(f"{name} must be finite, got {np.count_nonzero(~np.isfinite(array))} NaN or infinite")
            object.__setattr__(self, name, array)
        if n_dots == 0 or len(self.coefficients) % 2 == 0:
            raise ValueError(
                "coefficients must have an odd number of rows and at least one dot, got "
                f"{len(self.coefficients)} rows and {n_dots} dots"
            )
        if (self.frequencies <= 0).any():
            raise ValueError(f"frequencies must be positive, in hertz, got {self.frequencies.min():g}")

    def __setstate__(self, state: dict[str, object]) -> None:
        restore_read_only(self, state)

    def evaluate(self, times: NDArray[np.floating], axes: NDArray[np.floating], start: float) -> NDArray[np.float64]:
        """Return the places of the dots along some axes.

        Parameters
        ----------
        times : ndarray of shape (n_times,)
            In seconds.
        axes : ndarray of shape (n_axes, 3)
            Unit vectors.
        start : float
            Added to all phases, in strides.

        Returns
        -------
        ndarray of shape (n_times, n_dots, n_axes)
            In metres.
        """
        places = evaluate_dots(self.coefficients @ axes.T, self.frequencies, self.phases + start, times)
        return places + np.multiply.outer(times, self.velocities @ axes.T)

    def pick(self, dots: ArrayLike, names: Sequence[str]) -> Self:
        """Return some of the dots, by their positions, each as often as it is named, under other names."""
        picked = np.asarray(dots, dtype=np.intp)
        return replace(
            self,
            coefficients=self.coefficients[:, picked],
            frequencies=self.frequencies[picked],
            phases=self.phases[picked],
            velocities=self.velocities[picked],
            names=tuple(names),
        )

    def join(self, other: Dots) -> Self:
        """Return these dots and others behind them; a harmonic that only some have is zero in the rest."""
        n_rows = max(len(self.coefficients), len(other.coefficients))
        padded = [
            np.pad(dots.coefficients, ((0, n_rows - len(dots.coefficients)), (0, 0), (0, 0))) for dots in (self, other)
        ]
        joined: dict[str, Any] = {
            name: np.concatenate((getattr(self, name), getattr(other, name)))
            for name in ("frequencies", "phases", "velocities")
        }
        return replace(self, coefficients=np.concatenate(padded, axis=1), names=(*self.names, *other.names), **joined)

    def reflected(self, normal: NDArray[np.floating], *, local: bool) -> Self:
        """Return the dots mirrored in the plane through zero with a unit normal, or each in that through its mean."""
        coefficients, first = np.array(self.coefficients), 1 if local else 0
        coefficients[first:] = reflect(coefficients[first:], normal)
        return replace(
            self, coefficients=coefficients, velocities=self.velocities if local else reflect(self.velocities, normal)
        )

    def moving(self, velocity: NDArray[np.floating], start: NDArray[np.floating]) -> Self:
        """Return the dots shifted by `start` in metres, and with a velocity in m/s added, both of shape (3,)."""
        coefficients = np.array(self.coefficients)
        coefficients[0] += start
        return replace(self, coefficients=coefficients, velocities=self.velocities + velocity)

    def scattered(
        self,
        directions: NDArray[np.floating],
        random: np.random.RandomState,
        *,
        amount: float = 1.0,
        box: NDArray[np.floating] | None = None,
    ) -> Self:
        """Return the dots with their means scattered in a box, see `scatter_means`.

        Parameters
        ----------
        directions : ndarray of shape (n_directions, 3)
            Unit vectors at right angles to each other; along others nothing changes.
        random : RandomState
            Asked for one number for each dot and direction, dots first.
        amount : float, default 1.0
            From 0 to 1.
        box : ndarray of shape (2, n_directions), default None
            Lowest and highest corner, in metres. None is the box that the dots cover in the course of a stride.
        """
        along = self.coefficients @ directions.T  # (2 K + 1, n_dots, n_directions)
        reach, uniform = path_reach(along), random.random_sample(along.shape[1:])
        moved = scatter_means(along[0], reach, reach.box if box is None else box, uniform, amount=amount)
        coefficients = np.array(self.coefficients)
        coefficients[0] += (moved - along[0]) @ directions
        return replace(self, coefficients=coefficients)


def walker_dots(walk: Walk, n_harmonics: int) -> tuple[Dots, float]:
    """Return the dots of a walk, one a marker, and the height of the walker.

    Harmonics are fitted (Troje 2002, Eq. 1) and shifted to the common phase: at phase zero the left ankle is furthest
    in front of the right one. A size that was taken out of the walk is put back. Zero is the middle of the box that
    the markers cover in the course of a stride.

    Parameters
    ----------
    walk : Walk
        In place.
    n_harmonics : int
        Number of harmonics.

    Returns
    -------
    dots, height : Dots and float
        The height is that of the box, in metres.

    Raises
    ------
    TypeError
        If `walk` holds joint rotations.
    WalkError
        If the walk travels, has gaps, less than one stride or no period.
    """
    walk = check_marker_walk(walk)
    n_harmonics = check_count(n_harmonics, "n_harmonics", at_least=1)
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    check_in_place(walk)
    frequency = stride_frequency(walk)
    flat = fit_harmonics(walk.channels, walk.frame_rate, frequency, n_harmonics)
    flat = walk.size * shift_phase(flat, reference_phase(flat, phase_weights(walk)))
    coefficients = flat.reshape(len(flat), -1, 3)  # (2 K + 1, 3 n_markers) -> (2 K + 1, n_markers, 3)
    box = path_reach(coefficients).box
    coefficients[0] -= box.mean(axis=0)
    n_dots = coefficients.shape[1]
    dots = Dots(
        coefficients, np.full(n_dots, frequency), np.zeros(n_dots), np.zeros((n_dots, 3)), walk.marker_set.names
    )
    return dots, float(box[1, 2] - box[0, 2])
