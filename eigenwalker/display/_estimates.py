"""Estimates with their intervals, one below the other."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["check_columns", "draw_estimates", "label_rows", "row_height", "series_look"]

_MOST_NAMES = 40
_FILLS = ("black", "white", "0.6")
_MARKERS = ("o", "s", "D", "^", "v", "P", "X")


def check_columns(table: pd.DataFrame, columns: Sequence[str]) -> None:
    """Raise an error unless it is a table with rows and these columns."""
    if not isinstance(table, pd.DataFrame):
        raise TypeError(f"expected a DataFrame, got {type(table).__name__}")
    lacking = [name for name in columns if name not in table.columns]
    if lacking:
        raise ValueError(
            f"expected the columns {', '.join(map(str, columns))}, missing: {', '.join(map(str, lacking))}"
        )
    if not table.size:
        raise ValueError("expected a table with rows and columns, got an empty one")


def series_look(number: int) -> dict[str, Any]:
    """Return marker and fill of a series, told apart from others without color."""
    return {"marker": _MARKERS[number % len(_MARKERS)], "mfc": _FILLS[number % len(_FILLS)]}


def draw_estimates(ax: Axes, table: pd.DataFrame, places: ArrayLike, **look: Any) -> None:
    """Draw values as markers, and their intervals as lines through them.

    Parameters
    ----------
    ax : matplotlib Axes
        Where to draw.
    table : DataFrame
        The columns value, low and high. Rows without a value are left out; an interval that is NaN is not drawn.
    places : array-like of shape (n_rows,)
        Where on the vertical axis.
    **look : Any
        Of the markers.
    """
    known = table["value"].notna().to_numpy()
    values, low, high = table.loc[known, ["value", "low", "high"]].to_numpy(dtype=np.float64).T
    heights = np.asarray(places, dtype=np.float64)[known]
    ax.hlines(heights, low, high, color="black", lw=1.1, zorder=2)
    usual: dict[str, Any] = {"ls": "", "ms": 5, "mec": "black", "mew": 1.0, "zorder": 3}
    ax.plot(values, heights, **(usual | look))


def label_rows(ax: Axes, names: Sequence[Hashable], many: str) -> None:
    """Name rows that stand at 0, 1, ... from top to bottom; where they are too many, say what they are."""
    if len(names) <= _MOST_NAMES:
        ax.set_yticks(range(len(names)), labels=[str(name) for name in names])
    else:
        ax.set_yticks([])
        ax.set_ylabel(f"{len(names)} {many}")
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.tick_params(axis="y", length=0)
    ax.spines[["top", "right", "left"]].set_visible(False)


def row_height(n_rows: int, each: float) -> float:
    """Return the height of a figure with so many rows, each of so many inches where they have names."""
    return 0.9 + (each * n_rows if n_rows <= _MOST_NAMES else 6.0)
