"""What a trait axis or an Eigenwalker moves, drawn on the body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sklearn.pipeline import Pipeline

from eigenwalker._validation import check_choice
from eigenwalker.display._canvas import figure_of, take_axes, to_png, write_number
from eigenwalker.display.body import check_drawable, check_views, draw_bodies, name_view, project
from eigenwalker.model.eigenwalkers import axis_features, eigenwalker_features, shares_of, split_model, trait_axes
from eigenwalker.motion.fourier import evaluate_harmonics
from eigenwalker.motion.skeleton import MarkerSet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["AxisDisplay"]

_N_POINTS = 101  # of a path over one stride
_HEIGHT = 6.0  # inches, of the body
_MARGIN = 0.06  # meters, around it
_BODY = 0.75  # gray of the average walker
_SIDE = 0.02  # meters from the middle of the body, from where on a marker is of one side
_LOW: dict[str, Any] = {"color": "0.3", "lw": 0.8, "ls": (0, (4, 2))}
_HIGH: dict[str, Any] = {"color": "0", "lw": 1.2, "ls": "-"}
_ARROW: dict[str, Any] = {"color": "black", "marker": r"$\longrightarrow$", "ms": 18, "mew": 0.4, "ls": ""}
_TO_SCALE: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1, "units": "inches", "width": 0.022}


class AxisDisplay:
    """What an axis moves: the body of the average walker, and how it changes from -alpha to +alpha.

    Arrows lead from the mean posture at -alpha to that at +alpha: the structure. Around their two ends run the paths of
    the markers over one stride, dashed at -alpha and solid at +alpha: the dynamics. All is in meters, nothing is
    exaggerated. Markers on the far side of the body are paler.

    Parameters
    ----------
    coefficients : ndarray of shape (3, 2 n_harmonics + 1, n_markers, 3)
        Fourier coefficients at -alpha, 0 and +alpha, with the rows mean, sin1, cos1, ..., in metres.
    frequencies : ndarray of shape (3,)
        Strides per second there.
    marker_set : MarkerSet
        Names of the markers, and sticks.
    title : str
        What the axis is.
    ends : (str, str)
        Words for its negative and its positive end.
    shares : (float, float)
        Shares of structure and dynamics in the axis, see `axis_shares`.
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
    >>> from eigenwalker.display import AxisDisplay
    >>> from eigenwalker.model import make_eigenwalkers
    >>> walkers = make_walkers(24, random_state=0)
    >>> model = make_eigenwalkers(n_components=5).fit(walkers.data, walkers.target["gender"])
    >>> display = AxisDisplay.from_estimator(model, "gender")
    >>> [ax.get_xlabel() for ax in display.axes_]
    ['frontal view (m)', 'side view (m)']
    """

    def __init__(
        self,
        coefficients: NDArray[np.float64],
        frequencies: NDArray[np.float64],
        *,
        marker_set: MarkerSet,
        title: str,
        ends: tuple[str, str],
        shares: tuple[float, float],
        views: Sequence[str | float],
    ) -> None:
        self.coefficients = coefficients
        self.frequencies = frequencies
        self.marker_set = marker_set
        self.title = title
        self.ends = ends
        self.shares = shares
        self.views = views

    @classmethod
    def from_estimator(
        cls,
        model: Pipeline,
        trait: str,
        *,
        alpha: float = 2.0,
        views: Sequence[str | float] = ("frontal", "side"),
        ax: Axes | Sequence[Axes] | None = None,
    ) -> Self:
        """Draw a trait axis of a model.

        Parameters
        ----------
        model : Pipeline
            Fitted on walks of markers, from `make_eigenwalkers` or with the same kinds of steps.
        trait : str
            Name of the trait.
        alpha : float, default 2.0
            How far from the average walker, to both sides, in the trait step's `alpha_unit`.
        views : sequence of {"frontal", "half-profile", "side"} or float, default ("frontal", "side")
            Where the observer stands, one panel a view; a number is an azimuth in degrees.
        ax : matplotlib Axes or sequence of Axes, default None
            Where to draw, one a view. None makes a new figure.

        Returns
        -------
        AxisDisplay

        Raises
        ------
        TypeError
            If the model is one of joint walks.
        ValueError
            If the trait or a view is unknown, `alpha` is not positive, or there are not as many axes as views.
        """
        check_drawable(split_model(model)[1].template_)
        axes = trait_axes(model)
        check_choice(trait, axes.trait_names_, name="trait")
        _check_range(alpha, views)
        negative, positive = (
            f"{pole} (alpha = {write_number(sign * alpha, '+g')})"
            for pole, sign in zip(axes.poles_[trait], (-1, 1), strict=True)
        )
        title = f"{trait}: from {negative} to {positive}"
        display = cls._from_change(model, alpha * axis_features(model).loc[[trait]], title, (negative, positive), views)
        return display.plot(ax=ax)

    @classmethod
    def from_eigenwalker(
        cls,
        model: Pipeline,
        number: int = 1,
        *,
        n_sd: float = 2.0,
        views: Sequence[str | float] = ("frontal", "side"),
        ax: Axes | Sequence[Axes] | None = None,
    ) -> Self:
        """Draw an Eigenwalker of a model.

        Parameters
        ----------
        model : Pipeline
            Fitted on walks of markers, from `make_eigenwalkers` or with the same kinds of steps.
        number : int, default 1
            Which, from 1 on; the sign of an Eigenwalker has no meaning.
        n_sd : float, default 2.0
            How far from the average walker, to both sides, in SD over the training walkers.
        views, ax
            See `from_estimator`, as for errors.

        Returns
        -------
        AxisDisplay
        """
        check_drawable(split_model(model)[1].template_)
        changes = eigenwalker_features(model)
        check_choice(number, changes.index.tolist(), name="number")
        _check_range(n_sd, views)
        share = split_model(model)[2][-1].explained_variance_ratio_[number - 1]
        low, high = (f"{write_number(sign * n_sd, '+g')} SD" for sign in (-1, 1))
        title = f"Eigenwalker {number}, {share:.0%} of the variance: from {low} to {high}"
        return cls._from_change(model, n_sd * changes.loc[[number]], title, (low, high), views).plot(ax=ax)

    @classmethod
    def _from_change(
        cls, model: Pipeline, change: pd.DataFrame, title: str, ends: tuple[str, str], views: Sequence[str | float]
    ) -> Self:
        """Return the display of a change of features, one row, before it is drawn."""
        shares = shares_of(model, change).iloc[0]
        return cls(
            *_stations(model, change),
            marker_set=check_drawable(split_model(model)[1].template_),
            title=title,
            ends=ends,
            shares=(float(shares["structure"]), float(shares["dynamics"])),
            views=views,
        )

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
        azimuths = check_views(self.views)
        paths = np.stack([_paths(coefficients) for coefficients in self.coefficients[[0, 2]]])
        seen = [project(paths, azimuth)[..., :2] for azimuth in azimuths]
        limits = [_limits(picture[..., 0]) for picture in seen]
        height = _limits(paths[..., 2])
        widths = [np.ptp(limit) / np.ptp(height) for limit in limits]
        self.axes_ = take_axes(ax, (_HEIGHT * sum(widths) + 0.8 * len(widths) + 2.3, _HEIGHT + 0.9), widths)
        self.figure_ = figure_of(self.axes_[0])
        for panel, view, azimuth, picture, limit in zip(self.axes_, self.views, azimuths, seen, limits, strict=True):
            self._draw_view(panel, azimuth, picture)
            panel.set(xlim=limit, ylim=height, aspect="equal")
            panel.set_xlabel(name_view(view))
        self.axes_[0].set_ylabel("height (m)")
        self.axes_[0].set_title(self._title(), loc="left", fontsize="medium")
        self._add_legend(self.axes_[-1])
        return self

    def _draw_view(self, ax: Axes, azimuth: float, paths: NDArray[np.float64]) -> None:
        """Draw one panel; `paths` are those at -alpha and +alpha as seen, shape (2, n_points, n_markers, 2)."""
        low, average, high = project(self.coefficients[:, 0], azimuth)  # (n_markers, 3) each
        draw_bodies(ax, self.marker_set, average[np.newaxis], gray=_BODY, contrast=0.1)
        is_far = _is_far(self.coefficients[1, 0], azimuth)
        # (2, n_points, n_markers, 2) -> two times (n_markers, n_points, 2)
        for path_low, path_high, far in zip(*np.swapaxes(paths, 1, 2), is_far, strict=True):
            ax.plot(*path_low.T, **_style(_LOW, far))
            ax.plot(*path_high.T, **_style(_HIGH, far))
        grays = [str(0.5 * far) for far in is_far]
        ax.quiver(*low[:, :2].T, *(high - low)[:, :2].T, color=grays, zorder=6, **_TO_SCALE)
        ax.spines[["top", "right"]].set_visible(False)

    def _title(self) -> str:
        before, _, after = self.frequencies
        structure, dynamics = self.shares
        return (
            f"{self.title}\n"
            f"structure {structure:.0%}, dynamics {dynamics:.0%} of the axis\n"
            f"stride frequency {before:.2f} to {after:.2f} Hz ({write_number(after - before, '+.2f')} Hz)"
        )

    def _add_legend(self, ax: Axes) -> None:
        from matplotlib.lines import Line2D

        handles = [
            Line2D([], [], label=f"path of a marker,\n{self.ends[0]}", **_LOW),
            Line2D([], [], label=f"path of a marker,\n{self.ends[1]}", **_HIGH),
            Line2D([], [], label="change of mean posture", **_ARROW),
            Line2D([], [], color=str(_BODY), lw=1.6, label="average walker"),
        ]
        ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize="small")

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _check_range(alpha: float, views: Sequence[str | float]) -> None:
    if not 0 < alpha < np.inf:
        raise ValueError(f"alpha must be positive, as both ends of the axis are drawn, got {alpha}")
    check_views(views)


def _stations(model: Pipeline, change: pd.DataFrame) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the average walker and those to both sides of it.

    Returns
    -------
    coefficients : ndarray of shape (3, 2 n_harmonics + 1, n_markers, 3)
    frequencies : ndarray of shape (3,)
    """
    _, linearizer, reduction = split_model(model)
    average = reduction.inverse_transform(trait_axes(model).mean_[np.newaxis])
    vectors = average + np.outer([-1.0, 0.0, 1.0], change.to_numpy()[0])
    n_rows, n_channels = 2 * linearizer.n_harmonics + 1, len(linearizer.template_.channel_names)
    # (3, n_features) -> (3, 2 n_harmonics + 1, n_markers, 3)
    coefficients = vectors[:, : n_rows * n_channels].reshape(3, n_rows, -1, 3)
    return coefficients, vectors[:, change.columns.get_loc("frequency")]


def _limits(values: NDArray[np.float64]) -> tuple[float, float]:
    return float(values.min()) - _MARGIN, float(values.max()) + _MARGIN


def _is_far(posture: NDArray[np.float64], azimuth: float) -> NDArray[np.bool_]:
    """Return which markers are on the far side of the body; none where it is seen from in front or behind."""
    away = np.sin(np.deg2rad(azimuth))  # 1 where the left side is the far one, -1 where the right side is
    return posture[:, 1] * np.sign(away) > (_SIDE if abs(away) > 0.1 else np.inf)


def _style(style: dict[str, Any], far: bool) -> dict[str, Any]:
    """Return how a path is drawn, paler on the far side of the body."""
    return style | {"color": str(float(style["color"]) + 0.4), "zorder": 4} if far else style | {"zorder": 5}


def _paths(coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the markers over one stride, shape (n_points, n_markers, 3)."""
    n_rows, n_markers = coefficients.shape[:2]
    channels = evaluate_harmonics(coefficients.reshape(n_rows, -1), 1.0, np.linspace(0, 1, _N_POINTS))
    return channels.reshape(_N_POINTS, n_markers, 3)  # (n_points, 3 n_markers) -> (n_points, n_markers, 3)
