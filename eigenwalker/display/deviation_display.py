"""How one walker deviates from a group."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker.display._canvas import figure_of, take_axes, to_png, write_number
from eigenwalker.display.body import check_drawable, draw_bodies, draw_sticks, find_azimuth, project
from eigenwalker.model.walker_score import WalkerScore
from eigenwalker.motion.skeleton import MarkerSet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["DeviationDisplay"]

_BLACK = 4.0  # |z| from which on cells and markers are black
_LARGE = 2.0  # |z| from which on numbers are bold
_GROUP = 0.75  # gray of the average walker
_SHADES: dict[str, Any] = {"cmap": "Greys", "vmin": 0.0, "vmax": _BLACK}


class DeviationDisplay:
    """How one walker deviates from a group, in standard deviations of the group.

    To the left the mean posture of the walker, and behind it, in gray, that of the group. A marker is larger and darker
    the further its mean position deviates: the largest z, without its sign, of three coordinates. To the right, for
    each marker, the root mean square of z over these coordinates, "structure", and over the coefficients of each
    harmonic. A z of 4 and more is black; without any z a cell is empty and a marker white.

    Parameters
    ----------
    features : DataFrame
        Index: names of features as `FourierLinearizer` has them. Columns: value, that of the walker; mean, that of the
        group; and z, NaN where a feature has none.
    marker_set : MarkerSet
        Names of the markers, and sticks.
    name : str
        The walker.
    view : str or float
        Where the observer stands.

    Attributes
    ----------
    axes_ : list of matplotlib Axes
        What was drawn on: bodies, table.
    figure_ : matplotlib Figure
        The figure they belong to.

    Examples
    --------
    >>> import numpy as np
    >>> import pandas as pd
    >>> from eigenwalker.display import DeviationDisplay
    >>> from eigenwalker.motion import MarkerSet
    >>> names = ["mean_head_x", "mean_head_y", "mean_head_z", "sin1_head_x", "cos1_head_x", "frequency"]
    >>> features = pd.DataFrame({"value": 1.0, "mean": 0.9, "z": [3.0, 0.0, np.nan, 1.0, 1.0, -0.5]}, index=names)
    >>> DeviationDisplay(features, marker_set=MarkerSet(("head",)), name="anna", view="side").table().round(2)
          structure  harmonic 1
    head       2.12         1.0
    """

    def __init__(self, features: pd.DataFrame, *, marker_set: MarkerSet, name: str, view: str | float) -> None:
        self.features = features
        self.marker_set = marker_set
        self.name = name
        self.view = view

    @classmethod
    def from_score(
        cls, score: WalkerScore, *, view: str | float = "half-profile", ax: Axes | Sequence[Axes] | None = None
    ) -> Self:
        """Draw the score of a walker.

        Parameters
        ----------
        score : WalkerScore
            From `score_walker`, of a walk of markers.
        view : {"frontal", "half-profile", "side"} or float, default "half-profile"
            Where the observer stands; a number is an azimuth in degrees.
        ax : sequence of two matplotlib Axes, default None
            Where to draw bodies and table. None makes a new figure.

        Returns
        -------
        DeviationDisplay

        Raises
        ------
        TypeError
            If the walks are joint walks.
        """
        marker_set = check_drawable(score.average)
        return cls(score.features, marker_set=marker_set, name=score.name or "walk", view=view).plot(ax=ax)

    def table(self) -> pd.DataFrame:
        """Return the root mean square of z of each marker, over its mean posture and over each of its harmonics.

        Returns
        -------
        DataFrame
            One row a marker; the columns structure, harmonic 1, harmonic 2, ... NaN where no feature has a z.
        """
        places = self._places()
        squares = (places["z"] ** 2).groupby([places["marker"], places["block"]], sort=False).mean().unstack()
        blocks = list(dict.fromkeys(places["block"]))
        table = np.sqrt(squares).reindex(index=list(self.marker_set.names), columns=blocks)
        return table.rename_axis(index=None, columns=None)

    def _places(self) -> pd.DataFrame:
        """Return the features that a marker has, with the columns marker and block beside theirs."""
        parts = [name.partition("_") for name in self.features.index]
        places = self.features.assign(
            marker=[channel.rpartition("_")[0] for _, _, channel in parts],
            block=["structure" if block == "mean" else f"harmonic {block[3:]}" for block, _, _ in parts],
        )
        return places[places["marker"].isin(self.marker_set.names)]

    def plot(self, ax: Axes | Sequence[Axes] | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : sequence of two matplotlib Axes, default None
            Where to draw bodies and table.

        Returns
        -------
        self
        """
        table = self.table()
        width, height = 0.75 * table.shape[1], max(5.4, 0.3 * len(table) + 1.0)
        self.axes_ = take_axes(ax, (3.6 + 1.4 + width, height), (3.6, width))
        self.figure_ = figure_of(self.axes_[0])
        self._draw_posture(self.axes_[0])
        _draw_table(self.axes_[1], table)
        self.axes_[0].set_title(self._title(), loc="left", fontsize="medium")
        return self

    def _title(self) -> str:
        value, mean, z = self.features.loc["frequency", ["value", "mean", "z"]]
        deviation = "no z" if np.isnan(z) else f"z = {write_number(z, '+.1f')}"
        return f"{self.name}\nstride frequency {value:.2f} Hz, group {mean:.2f} Hz, {deviation}"

    def _draw_posture(self, ax: Axes) -> None:
        azimuth = find_azimuth(self.view)
        mean = self._places().query("block == 'structure'")
        average, own = (project(self._posture(column), azimuth) for column in ("mean", "value"))
        draw_bodies(ax, self.marker_set, average[np.newaxis], gray=_GROUP, contrast=0.1)
        draw_sticks(ax, self.marker_set, own[np.newaxis], gray=0.1, contrast=0.1)
        largest = mean["z"].abs().groupby(mean["marker"]).max().reindex(list(self.marker_set.names))
        shown = largest.fillna(0.0).to_numpy()
        across, up = own[:, :2].T
        ax.scatter(across, up, s=_area(shown), c=shown, edgecolors="black", linewidths=0.8, zorder=5, **_SHADES)
        ax.set_aspect("equal", anchor="W")
        ax.set_axis_off()
        _add_legend(ax)

    def _posture(self, column: str) -> NDArray[np.float64]:
        """Return a mean posture, shape (n_markers, 3)."""
        names = [f"mean_{marker}_{axis}" for marker in self.marker_set.names for axis in "xyz"]
        return self.features.loc[names, column].to_numpy(dtype=np.float64).reshape(-1, 3)

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _area(deviations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the area of markers, in square points."""
    return 20.0 + 35.0 * np.minimum(deviations, _BLACK)


def _add_legend(ax: Axes) -> None:
    from matplotlib import colormaps
    from matplotlib.lines import Line2D

    shown = np.array([0.0, _LARGE, _BLACK])
    style: dict[str, Any] = {"ls": "", "marker": "o", "mec": "black", "mew": 0.8}
    handles = [
        Line2D([], [], ms=np.sqrt(area), mfc=colormaps[_SHADES["cmap"]](deviation / _BLACK), label=label, **style)
        for deviation, area, label in zip(shown, _area(shown), ("0", "2", "4 or more"), strict=True)
    ]
    handles += [Line2D([], [], color="black", label="this walker"), Line2D([], [], color=str(_GROUP), label="group")]
    title = "largest |z| of the\nmean posture"
    ax.legend(
        handles=handles,
        title=title,
        frameon=False,
        fontsize="small",
        title_fontsize="small",
        loc="upper left",
        bbox_to_anchor=(1.0, 1.0),
    )


def _draw_table(ax: Axes, table: pd.DataFrame) -> None:
    """Draw a heat map with its numbers."""
    values = table.to_numpy()
    ax.imshow(np.ma.masked_invalid(values), aspect="auto", **_SHADES)
    for (row, column), value in np.ndenumerate(values):
        text = "–" if np.isnan(value) else f"{value:.1f}"
        color = "white" if value > 0.55 * _BLACK else "black"
        weight = "bold" if round(value, 1) >= _LARGE else "normal"
        ax.text(column, row, text, ha="center", va="center", color=color, weight=weight, fontsize="small")
    ax.set_xticks(range(table.shape[1]), labels=[name.replace(" ", "\n") for name in table.columns])
    ax.set_yticks(range(len(table)), labels=[name.replace("_", " ") for name in table.index])
    ax.tick_params(length=0, labelsize="small", top=True, labeltop=True, bottom=False, labelbottom=False)
    ax.set_xlabel("root mean square of z", fontsize="small")
