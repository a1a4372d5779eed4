"""The paths of a walk's markers, as recorded and as the harmonic series has them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from eigenwalker.display._canvas import figure_of, take_axes, to_png
from eigenwalker.display.body import check_drawable, check_views, draw_bodies, name_view, project
from eigenwalker.motion.fourier import evaluate_harmonics, fit_harmonics
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.walk import Walk

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["TrajectoryDisplay"]

_N_POINTS = 101  # of a path over one stride
_HEIGHT = 5.5  # inches


class TrajectoryDisplay:
    """Paths of the markers around the mean posture: what was recorded in gray, the harmonic series in black.

    Parameters
    ----------
    walk : Walk
        In place.
    n_harmonics : int
        Of the series.
    views : sequence of str or float
        Where the observer stands, one panel a view.

    Attributes
    ----------
    axes_ : list of matplotlib Axes
        What was drawn on, one a view.
    figure_ : matplotlib Figure
        The figure they belong to.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import TrajectoryDisplay
    >>> display = TrajectoryDisplay.from_walk(make_walkers(1, random_state=0).data[0])
    >>> [ax.get_xlabel() for ax in display.axes_]
    ['frontal view (m)', 'side view (m)']
    """

    def __init__(self, walk: Walk, *, n_harmonics: int, views: Sequence[str | float]) -> None:
        self.walk = walk
        self.n_harmonics = n_harmonics
        self.views = views

    @classmethod
    def from_walk(
        cls,
        walk: Walk,
        *,
        n_harmonics: int = 2,
        views: Sequence[str | float] = ("frontal", "side"),
        ax: Axes | Sequence[Axes] | None = None,
    ) -> Self:
        """Draw the paths of a walk.

        Parameters
        ----------
        walk : Walk
            Prepared, in place.
        n_harmonics : int, default 2
            Of the series that is drawn over what was recorded.
        views : sequence of {"frontal", "half-profile", "side"} or float, default ("frontal", "side")
            Where the observer stands, one panel a view; a number is an azimuth in degrees.
        ax : matplotlib Axes or sequence of Axes, default None
            Where to draw, one a view. None makes a new figure.

        Returns
        -------
        TrajectoryDisplay

        Raises
        ------
        TypeError
            If it is a joint walk.
        WalkError
            If the walk has gaps, no period or less than one stride.
        """
        check_drawable(walk)
        check_views(views)
        return cls(walk, n_harmonics=n_harmonics, views=views).plot(ax=ax)

    def plot(self, ax: Axes | Sequence[Axes] | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : matplotlib Axes or sequence of Axes, default None
            Where to draw, one a view.

        Returns
        -------
        self
        """
        mean, series = _fit(self.walk, self.n_harmonics)
        width = _HEIGHT * 0.7
        self.axes_ = take_axes(ax, (width * len(self.views) + 0.4, _HEIGHT + 0.6), [1.0] * len(self.views))
        self.figure_ = figure_of(self.axes_[0])
        for panel, view, azimuth in zip(self.axes_, self.views, check_views(self.views), strict=True):
            draw_bodies(panel, self.walk.marker_set, project(mean, azimuth)[np.newaxis], gray=0.8, contrast=0.1)
            # (n_frames, n_markers, 2) -> (2, n_frames, n_markers): one line a marker
            recorded = np.moveaxis(project(self.walk.positions, azimuth)[..., :2], -1, 0)
            fitted = np.moveaxis(project(series, azimuth)[..., :2], -1, 0)
            first, *_ = panel.plot(*recorded, color="0.62", lw=0.5, zorder=4)
            first.set_label("recorded")
            first, *_ = panel.plot(*fitted, color="black", lw=1.1, zorder=5)
            first.set_label(f"{self.n_harmonics} harmonics")
            panel.set(aspect="equal", xlabel=name_view(view))
            panel.spines[["top", "right"]].set_visible(False)
        self.axes_[0].set_ylabel("height (m)")
        self.axes_[0].set_title(self.walk.name, loc="left", fontsize="medium")
        self.axes_[-1].legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1.0, 1.0))
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _fit(walk: Walk, n_harmonics: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean posture, shape (n_markers, 3), and one stride of the series, (n_points, n_markers, 3)."""
    frequency = stride_frequency(walk)
    coefficients = fit_harmonics(walk.channels, walk.frame_rate, frequency, n_harmonics)
    channels = evaluate_harmonics(coefficients, frequency, np.linspace(0, 1 / frequency, _N_POINTS))
    return coefficients[0].reshape(-1, 3), channels.reshape(
        _N_POINTS, -1, 3
    )  # (..., 3 n_markers) -> (..., n_markers, 3)
