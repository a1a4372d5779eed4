"""Rates or means of groups with their intervals, such as recognition rates of styles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

import numpy as np
import pandas as pd

from eigenwalker.display._canvas import figure_of, take_axes, to_png
from eigenwalker.display._estimates import check_columns, draw_estimates, label_rows, row_height, series_look

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["EstimateDisplay"]

_Reference = float | tuple[float, float, float]


class EstimateDisplay:
    """Rates or means of groups as markers with intervals, several series of them side by side.

    With recognition rates of styles, of original and of synthetic walks, and chance as the reference this is Fig. 6 of
    Tilmanne, Moinet & Dutoit 2012; with the mean scores of styles and the overall mean Fig. 5 of Tilmanne & Dutoit
    2012, both with intervals.

    Parameters
    ----------
    table : DataFrame
        Index: the groups, or groups and series. Columns: value, low, high.
    reference : float or (float, float, float), default None
        What the values are compared with: a line; with its own interval, a band.
    reference_name : str, default ""
        What it is.
    xlabel : str
        What the values are, with their unit.
    xlim : (float, float), default None
        The least and the largest value there can be; None leaves it to the values.

    Attributes
    ----------
    ax_ : matplotlib Axes
        What was drawn on.
    figure_ : matplotlib Figure
        The figure it belongs to.

    Examples
    --------
    >>> import pandas as pd
    >>> from eigenwalker.display import EstimateDisplay
    >>> scores = pd.DataFrame({"value": [1.6, 3.4], "low": [1.2, 3.1], "high": [2.0, 3.7]}, index=["drunk", "manly"])
    >>> display = EstimateDisplay.from_frame(scores, reference=2.9, reference_name="overall mean", xlabel="mean score")
    >>> display.ax_.get_xlabel()
    'mean score'
    """

    def __init__(
        self,
        table: pd.DataFrame,
        *,
        reference: _Reference | None = None,
        reference_name: str = "",
        xlabel: str,
        xlim: tuple[float, float] | None = None,
    ) -> None:
        self.table = table
        self.reference = reference
        self.reference_name = reference_name
        self.xlabel = xlabel
        self.xlim = xlim

    @classmethod
    def from_frame(
        cls,
        table: pd.DataFrame,
        *,
        reference: _Reference | None = None,
        reference_name: str = "",
        xlabel: str = "",
        xlim: tuple[float, float] | None = None,
        sort: bool = False,
        ax: Axes | None = None,
    ) -> Self:
        """Draw a table of estimates.

        Parameters
        ----------
        table : DataFrame
            Index: the groups, or two levels: groups and series. Columns: value, low, high. A value that is NaN leaves
            its place empty.
        reference : float or (float, float, float), default None
            What the values are compared with; with its own low and high as a band.
        reference_name : str, default ""
            What it is, in the legend.
        xlabel : str, default ""
            What the values are, with their unit.
        xlim : (float, float), default None
            The least and the largest value there can be.
        sort : bool, default False
            Whether groups are sorted by the values of the first series, the largest at the top; else they are in the
            order of the table.
        ax : matplotlib Axes, default None
            Where to draw. None makes a new figure.

        Returns
        -------
        EstimateDisplay

        Raises
        ------
        TypeError, ValueError
            If it is no such table, or a group has two rows of a series.
        """
        check_columns(table, ("value", "low", "high"))
        if table.index.nlevels > 2 or table.index.has_duplicates:
            raise ValueError("expected one row a group, or a group and a series, got more levels or rows that repeat")
        if sort:
            first = table if table.index.nlevels == 1 else table.xs(table.index[0][1], level=1)
            order = first["value"].sort_values(ascending=False, kind="stable").index
            groups = table.index.get_level_values(0).unique()
            order = [*order, *(name for name in groups if name not in order)]
            table = table.loc[order]
        return cls(table, reference=reference, reference_name=reference_name, xlabel=xlabel, xlim=xlim).plot(ax=ax)

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
        groups, series = self._groups(), self._series()
        (ax,) = take_axes(ax, (6.0, row_height(len(groups), 0.2 + 0.12 * len(series))))
        self.ax_, self.figure_ = ax, figure_of(ax)
        self._draw_reference(ax)
        offsets = (np.arange(len(series)) - (len(series) - 1) / 2) * 0.55 / max(1, len(series) - 1)
        for number, (name, rows) in enumerate(series.items()):
            places = np.arange(len(groups)) + offsets[number]
            draw_estimates(ax, rows.reindex(groups), places, label=name, **series_look(number))
        label_rows(ax, groups, "groups")
        for line in np.arange(len(groups) - 1) + 0.5 if len(series) > 1 else []:
            ax.axhline(line, color="0.9", lw=0.6, zorder=0)
        ax.set_xlabel(self.xlabel)
        if self.xlim is not None:
            margin = 0.02 * (self.xlim[1] - self.xlim[0])
            ax.set_xlim(self.xlim[0] - margin, self.xlim[1] + margin)
        if len(series) > 1 or self.reference is not None:
            ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, frameon=False, fontsize="small")
        return self

    def _groups(self) -> list[str]:
        return list(dict.fromkeys(self.table.index.get_level_values(0)))

    def _series(self) -> dict[str, pd.DataFrame]:
        """Return the rows of each series by its name; a single one has none, and no place in the legend."""
        if self.table.index.nlevels == 1:
            return {"_": self.table}
        return {str(name): self.table.xs(name, level=1) for name in self.table.index.get_level_values(1).unique()}

    def _draw_reference(self, ax: Axes) -> None:
        if self.reference is None:
            return
        value, low, high = self.reference if isinstance(self.reference, tuple) else (self.reference,) * 3
        if low < high:
            ax.axvspan(low, high, color="0.88", lw=0, zorder=0)
        ax.axvline(value, color="0.35", lw=1.2, ls="--", zorder=1, label=self.reference_name or "_")

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)
