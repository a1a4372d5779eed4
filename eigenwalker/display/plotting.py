"""Figures of walks with matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import check_walks
from eigenwalker.display._canvas import figure_of, take_axes, to_png
from eigenwalker.display.body import draw_bodies, find_azimuth, project
from eigenwalker.motion.fourier import evaluate_harmonics, fit_harmonics, reference_phase, shift_phase
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.walk import JointWalk, Walk

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["StickFigureDisplay"]


class StickFigureDisplay:
    """Stick figures of walks: one row a walk, one column a phase of the stride.

    Parameters
    ----------
    walks : list of Walk
        Walks in place, with the same markers.
    azimuth : float
        Where the observer stands, in degrees.
    n_phases : int
        Number of phases in a stride, evenly spaced; the first has the left foot furthest in front.

    Attributes
    ----------
    ax_ : matplotlib Axes
        What was drawn on.
    figure_ : matplotlib Figure
        The figure it belongs to.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import StickFigureDisplay
    >>> display = StickFigureDisplay.from_walks(make_walkers(2, random_state=0).data)
    >>> display.ax_.get_aspect()
    1.0
    """

    def __init__(self, walks: list[Walk], *, azimuth: float, n_phases: int) -> None:
        self.walks = walks
        self.azimuth = azimuth
        self.n_phases = n_phases

    @classmethod
    def from_walks(
        cls,
        walks: Sequence[Walk | JointWalk],
        *,
        view: str | float = "half-profile",
        n_phases: int = 6,
        ax: Axes | None = None,
    ) -> Self:
        """Draw walks.

        Parameters
        ----------
        walks : list of Walk or JointWalk
            Walks in place; their names are written below the rows. Of joints the 15 markers are drawn, `to_markers`.
        view : {"frontal", "half-profile", "side"} or float, default "half-profile"
            Where the observer stands; a number is an azimuth in degrees.
        n_phases : int, default 6
            Number of phases in a stride.
        ax : matplotlib Axes, default None
            Where to draw. None makes a new figure.

        Returns
        -------
        StickFigureDisplay
        """
        walks = check_walks(walks, kind=(Walk, JointWalk))
        bodies = [walk.to_markers() if isinstance(walk, JointWalk) else walk for walk in walks]
        return cls(bodies, azimuth=find_azimuth(view), n_phases=n_phases).plot(ax=ax)

    def plot(self, ax: Axes | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : matplotlib Axes, default None
            Where to draw.

        Returns
        -------
        self
        """
        (ax,) = take_axes(ax, (1.1 * self.n_phases + 1.2, 2.2 * len(self.walks) + 0.2))
        self.ax_, self.figure_ = ax, figure_of(ax)
        postures = [_postures(walk, self.n_phases) for walk in self.walks]
        seen = [project(posture, self.azimuth) for posture in postures]
        width = 1.15 * max(np.ptp(picture[..., 0]) for picture in seen)
        height = 1.2 * max(picture[..., 1].max() for picture in seen)
        for row, (walk, picture) in enumerate(zip(self.walks, seen, strict=True)):
            floor = -row * height
            offsets = np.column_stack(
                (np.arange(self.n_phases) * width - picture[..., 0].mean(), np.full(self.n_phases, floor))
            )
            picture[..., :2] += offsets[:, np.newaxis]
            draw_bodies(ax, walk.marker_set, picture)
            ax.plot([-0.5 * width, (self.n_phases - 0.5) * width], [floor, floor], color="0.8", lw=0.8, zorder=0)
            ax.text(-0.48 * width, floor - 0.02 * height, walk.name, ha="left", va="top")
        ax.set_aspect("equal", anchor="N")
        ax.set_axis_off()
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _postures(walk: Walk, n_phases: int) -> NDArray[np.float64]:
    """Markers at evenly spaced phases of the mean stride, shape (n_phases, n_markers, 3)."""
    frequency = stride_frequency(walk)
    n_harmonics = max(1, min(4, int(0.45 * walk.frame_rate / frequency)))
    coefficients = fit_harmonics(walk.channels, walk.frame_rate, frequency, n_harmonics)
    coefficients = shift_phase(coefficients, reference_phase(coefficients, phase_weights(walk)))
    channels = evaluate_harmonics(coefficients, frequency, np.arange(n_phases) / (n_phases * frequency))
    return channels.reshape(n_phases, -1, 3)  # (n_phases, 3 n_markers) -> (n_phases, n_markers, 3)
