"""What each style is taken for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Self

import numpy as np
import pandas as pd

from eigenwalker.display._canvas import figure_of, take_axes, to_png
from eigenwalker.display._estimates import check_columns

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["ConfusionDisplay"]


class ConfusionDisplay:
    """Confusion matrices side by side, one a kind of walk, with the same styles in the same order.

    Cells are darker the more often the style of the row got the answer of the column, and have that share in percent;
    cells of right answers have a frame. This is Table 2 of Tilmanne, Moinet & Dutoit 2012.

    Parameters
    ----------
    tables : dict of str to DataFrame
        Rows are styles, columns answers; shares from 0 to 1, NaN where a style was not shown.

    Attributes
    ----------
    axes_ : list of matplotlib Axes
        What was drawn on, one a table.
    figure_ : matplotlib Figure
        The figure they belong to.

    Examples
    --------
    >>> import pandas as pd
    >>> from eigenwalker.display import ConfusionDisplay
    >>> table = pd.DataFrame([[0.7, 0.3], [0.4, 0.6]], index=["cool", "sad"], columns=["cool", "sad"])
    >>> display = ConfusionDisplay.from_tables({"original": table, "synthetic": table})
    >>> [ax.get_title() for ax in display.axes_]
    ['original', 'synthetic']
    """

    def __init__(self, tables: dict[str, pd.DataFrame]) -> None:
        self.tables = tables

    @classmethod
    def from_tables(cls, tables: Mapping[str, pd.DataFrame], *, ax: Axes | Sequence[Axes] | None = None) -> Self:
        """Draw confusion matrices.

        Parameters
        ----------
        tables : mapping of str to DataFrame
            One a kind, all with the same rows and columns, as `confusion_tables` returns them.
        ax : sequence of matplotlib Axes, default None
            Where to draw, one a table. None makes a new figure.

        Returns
        -------
        ConfusionDisplay

        Raises
        ------
        TypeError, ValueError
            If there are no tables, or they differ in rows or columns, or hold other than shares from 0 to 1.
        """
        if not tables:
            raise ValueError("expected at least one table, got none")
        first = next(iter(tables.values()))
        for name, table in tables.items():
            check_columns(table, ())
            if not (table.index.equals(first.index) and table.columns.equals(first.columns)):
                raise ValueError(f"expected tables with the same rows and columns, those of {name!r} are others")
            if ((table < 0) | (table > 1)).any(axis=None):
                raise ValueError(
                    f"expected shares from 0 to 1, got others in {name!r}; divide numbers by their row sums"
                )
        return cls({str(name): table for name, table in tables.items()}).plot(ax=ax)

    def plot(self, ax: Axes | Sequence[Axes] | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : sequence of matplotlib Axes, default None
            Where to draw, one a table.

        Returns
        -------
        self
        """
        n_rows, n_columns = next(iter(self.tables.values())).shape
        size = (1.5 + 0.36 * n_columns * len(self.tables), 1.6 + 0.36 * n_rows)
        self.axes_ = take_axes(ax, size, [1.0] * len(self.tables))
        self.figure_ = figure_of(self.axes_[0])
        for panel, (name, table) in zip(self.axes_, self.tables.items(), strict=True):
            _draw_matrix(panel, table)
            panel.set_title(name, fontsize="medium")
            panel.set_xlabel("answer")
        self.axes_[0].set_yticks(range(n_rows), labels=[str(style) for style in table.index])
        self.axes_[0].set_ylabel("style")
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _draw_matrix(ax: Axes, table: pd.DataFrame) -> None:
    """Draw a matrix with its numbers, in percent; none where they are 0, a dash where there is nothing to know."""
    from matplotlib.patches import Rectangle

    shares = table.to_numpy(dtype=np.float64)
    ax.imshow(np.ma.masked_invalid(shares), cmap="Greys", vmin=0.0, vmax=1.0)
    for (row, column), share in np.ndenumerate(shares):
        text = "–" if np.isnan(share) else f"{100 * share:.0f}"
        if text != "0":
            color = "white" if share > 0.55 else "black"
            ax.text(column, row, text, ha="center", va="center", color=color, fontsize="small")
        if table.index[row] == table.columns[column]:
            ax.add_patch(Rectangle((column - 0.5, row - 0.5), 1, 1, fill=False, ec="black", lw=1.4))
    ax.set_xticks(range(shares.shape[1]), labels=[str(name) for name in table.columns], rotation=90)
    ax.set_yticks([])
    ax.tick_params(length=0)
    ax.spines[:].set_color("0.7")
