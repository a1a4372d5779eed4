"""How often each answer was given, with intervals."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pandas as pd

from eigenwalker.display._canvas import figure_of, take_axes, to_png
from eigenwalker.display._estimates import check_columns

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["ShareDisplay"]

_COLUMNS = ("n_answers", "n_trials", "share", "low", "high")
_LOOKS: tuple[dict[str, Any], ...] = (
    {"color": "0.35"},
    {"color": "0.95", "hatch": "////"},
    {"color": "0.75"},
    {"color": "0.95", "hatch": ".."},
)


class ShareDisplay:
    """Shares of answers as bars with intervals, those of several series side by side, and numbers of answers above.

    With the answers "real", "synthetic" and "don't know" to original and synthetic walks this is Fig. 5 of Tilmanne,
    Moinet & Dutoit 2012, and with the five levels of resemblance its Fig. 8, both with intervals.

    Parameters
    ----------
    table : DataFrame
        Index: the answers, or series and answers. Columns: n_answers, n_trials, share, low, high.
    xlabel, ylabel : str
        What the answers are, and the shares.

    Attributes
    ----------
    ax_ : matplotlib Axes
        What was drawn on.
    figure_ : matplotlib Figure
        The figure it belongs to.

    Examples
    --------
    >>> import pandas as pd
    >>> from eigenwalker.display import ShareDisplay
    >>> counts = {"n_answers": [3, 1], "n_trials": 4, "share": [0.75, 0.25], "low": [0.3, 0.05], "high": [0.95, 0.7]}
    >>> ShareDisplay.from_frame(pd.DataFrame(counts, index=["real", "synthetic"])).ax_.get_ylabel()
    'share of answers (%)'
    """

    def __init__(self, table: pd.DataFrame, *, xlabel: str, ylabel: str) -> None:
        self.table = table
        self.xlabel = xlabel
        self.ylabel = ylabel

    @classmethod
    def from_frame(
        cls,
        table: pd.DataFrame,
        *,
        xlabel: str = "answer",
        ylabel: str = "share of answers (%)",
        ax: Axes | None = None,
    ) -> Self:
        """Draw a table of shares.

        Parameters
        ----------
        table : DataFrame
            Index: the answers, or two levels: series and answers. Columns: n_answers; n_trials, of all answers of the
            series; share, low and high, from 0 to 1.
        xlabel : str, default "answer"
            What the answers are.
        ylabel : str, default "share of answers (%)"
            What the shares are.
        ax : matplotlib Axes, default None
            Where to draw. None makes a new figure.

        Returns
        -------
        ShareDisplay

        Raises
        ------
        TypeError, ValueError
            If it is no such table.
        """
        check_columns(table, _COLUMNS)
        if table.index.nlevels > 2 or table.index.has_duplicates:
            raise ValueError(
                "expected one row an answer, or a series and an answer, got more levels or some that repeat"
            )
        return cls(table, xlabel=xlabel, ylabel=ylabel).plot(ax=ax)

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
        answers, series = list(dict.fromkeys(self.table.index.get_level_values(-1))), self._series()
        (ax,) = take_axes(ax, (1.4 + max(1.0, 0.55 * len(series)) * len(answers), 3.6))
        self.ax_, self.figure_ = ax, figure_of(ax)
        width = 0.8 / len(series)
        for number, (name, rows) in enumerate(series.items()):
            places = np.arange(len(answers)) + (number - (len(series) - 1) / 2) * width
            _draw_bars(ax, places, rows.reindex(answers), width, name, number)
        ax.set_xticks(range(len(answers)), labels=[fill(str(answer), 11) for answer in answers])
        ax.set(xlabel=self.xlabel, ylabel=self.ylabel)
        ax.set_ylim(0, min(112.0, 100 * float(self.table["high"].max()) + 10))
        ax.tick_params(axis="x", length=0)
        ax.spines[["top", "right"]].set_visible(False)
        if self.table.index.nlevels > 1:
            ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False, fontsize="small")
        return self

    def _series(self) -> dict[str, pd.DataFrame]:
        if self.table.index.nlevels == 1:
            return {"": self.table}
        return {str(name): self.table.xs(name, level=0) for name in self.table.index.get_level_values(0).unique()}

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _draw_bars(ax: Axes, places: np.ndarray, rows: pd.DataFrame, width: float, name: str, number: int) -> None:
    """Draw the shares of one series in percent, with intervals and, above them, how many answers they are."""
    known = rows["share"].notna().to_numpy()
    rows, places = rows[known], places[known]
    shares, low, high = 100 * rows[["share", "low", "high"]].to_numpy(dtype=np.float64).T
    label = f"{name}, {int(rows['n_trials'].iloc[0])} answers"
    ax.bar(places, shares, 0.92 * width, edgecolor="black", lw=0.8, label=label, **_LOOKS[number % len(_LOOKS)])
    ax.vlines(places, low, high, color="white", lw=3.4, zorder=2)  # a rim, so that they show on any bar
    ax.vlines(places, low, high, color="black", lw=1.4, zorder=3)
    for place, top, count in zip(places, high, rows["n_answers"], strict=True):
        ax.annotate(str(int(count)), (place, top), (0, 2), textcoords="offset points", ha="center", fontsize="small")
