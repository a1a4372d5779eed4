"""Figures of walks with matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import check_walks
from eigenwalker.motion.fourier import evaluate_harmonics, fit_harmonics, reference_phase, shift_phase
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.skeleton import MarkerSet
from eigenwalker.motion.walk import JointWalk, Walk

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["StickFigureDisplay", "project"]

VIEWS = {"frontal": 0.0, "half-profile": 30.0, "side": 90.0}
"""Azimuth of the named views, in degrees (Troje 2002, section 4)."""


def project(positions: NDArray[np.floating], azimuth: float) -> NDArray[np.float64]:
    """Return what an observer sees of markers, by orthographic projection.

    Parameters
    ----------
    positions : ndarray of shape (..., 3)
        In metres; x forward, y left, z up.
    azimuth : float
        Where the observer stands, in degrees: 0 in front of the walker, 90 at its right side, so that it walks to
        the right of the picture.

    Returns
    -------
    ndarray of shape (..., 3)
        To the right in the picture, up, and towards the observer, in metres.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.display import project
    >>> project(np.array([1.0, 0.0, 1.7]), 90).round(6) + 0
    array([1. , 1.7, 0. ])
    """
    angle = np.deg2rad(azimuth)
    x, y, z = np.moveaxis(np.asarray(positions, dtype=np.float64), -1, 0)
    right = x * np.sin(angle) + y * np.cos(angle)
    near = x * np.cos(angle) - y * np.sin(angle)
    return np.stack((right, z, near), axis=-1)


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
        walks : list of Walk
            Walks in place, with the same markers; their names are written beside the rows.
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
        walks = check_walks(walks, kind=Walk)
        if isinstance(view, str) and view not in VIEWS:
            raise ValueError(f"view must be one of {', '.join(VIEWS)} or an azimuth in degrees, got {view!r}")
        azimuth = VIEWS[view] if isinstance(view, str) else float(view)
        return cls(walks, azimuth=azimuth, n_phases=n_phases).plot(ax=ax)

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
        from matplotlib.figure import Figure

        if ax is None:
            figure = Figure(figsize=(1.1 * self.n_phases + 1.2, 2.2 * len(self.walks) + 0.2), layout="constrained")
            ax = figure.add_subplot()
        self.ax_ = ax
        figure_of_ax = ax.get_figure(root=True)
        assert figure_of_ax is not None  # axes live on a figure
        self.figure_ = figure_of_ax
        postures = [_postures(walk, self.n_phases) for walk in self.walks]
        seen = [project(posture, self.azimuth) for posture in postures]
        width = 1.15 * max(np.ptp(picture[..., 0]) for picture in seen)
        height = 1.1 * max(picture[..., 1].max() for picture in seen)
        for row, (walk, picture) in enumerate(zip(self.walks, seen, strict=True)):
            floor = -row * height
            offsets = np.column_stack(
                (np.arange(self.n_phases) * width - picture[..., 0].mean(), np.full(self.n_phases, floor))
            )
            _draw_figures(ax, walk.marker_set, picture, offsets)
            ax.plot([-0.5 * width, (self.n_phases - 0.5) * width], [floor, floor], color="0.8", lw=0.8, zorder=0)
            ax.text(-0.48 * width, floor - 0.02 * height, walk.name, ha="left", va="top")
        ax.set_aspect("equal", anchor="N")
        ax.set_axis_off()
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        picture = BytesIO()
        self.figure_.savefig(picture, format="png", dpi=90)
        return picture.getvalue()


def _postures(walk: Walk, n_phases: int) -> NDArray[np.float64]:
    """Markers at evenly spaced phases of the mean stride, shape (n_phases, n_markers, 3)."""
    frequency = stride_frequency(walk)
    n_harmonics = max(1, min(4, int(0.45 * walk.frame_rate / frequency)))
    coefficients = fit_harmonics(walk.channels, walk.frame_rate, frequency, n_harmonics)
    coefficients = shift_phase(coefficients, reference_phase(coefficients, phase_weights(walk)))
    channels = evaluate_harmonics(coefficients, frequency, np.arange(n_phases) / (n_phases * frequency))
    return channels.reshape(n_phases, -1, 3)  # (n_phases, 3 n_markers) -> (n_phases, n_markers, 3)


def _draw_figures(ax: Axes, markers: MarkerSet, picture: NDArray[np.float64], offsets: NDArray[np.float64]) -> None:
    """Draw all postures of a walk: sticks that are nearer to the observer darker and on top, dots for the markers."""
    from matplotlib.collections import LineCollection

    points = picture[..., :2] + offsets[:, np.newaxis]  # (n_phases, n_markers, 2)
    ends = np.array([[markers.index(first), markers.index(second)] for first, second in markers.sticks], dtype=int)
    if len(ends):
        depth = picture[..., 2] - picture[..., 2].mean(axis=1, keepdims=True)
        near = (depth[:, ends].mean(axis=2) / max(float(np.abs(depth).max()), 1e-9)).ravel()  # (n_phases n_sticks,)
        order = np.argsort(near, kind="stable")
        segments = points[:, ends].reshape(-1, 2, 2)[order]  # (n_phases, n_sticks, 2, 2) -> (n_phases n_sticks, 2, 2)
        grays = [str(round(gray, 3)) for gray in 0.4 - 0.35 * near[order]]
        ax.add_collection(LineCollection(list(segments), colors=grays, linewidths=1.6, capstyle="round", zorder=2))
    ax.scatter(points[..., 0].ravel(), points[..., 1].ravel(), s=7, color="black", zorder=4, linewidths=0)
    if "head" in markers.names:
        head = points[:, markers.index("head")]
        ax.scatter(head[:, 0], head[:, 1], s=60, color="black", zorder=4, linewidths=0)
