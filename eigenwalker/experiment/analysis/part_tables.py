"""Tables of all walks, of each condition and of each style, below each other."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

__all__ = ["PART_LEVELS", "rows_of_parts", "stack_parts"]

PART_LEVELS = ("by", "group")
"""The first index levels of such tables: "all", "condition" or "style", and "all walks", "static", "sad" and so on."""


def stack_parts(tables: Mapping[Any, pd.DataFrame], names: Sequence[str] = PART_LEVELS) -> pd.DataFrame:
    """Return tables below each other, in their order, with their keys before their index.

    Parameters
    ----------
    tables : mapping of tuple of str to DataFrame
        By part.
    names : sequence of str, default PART_LEVELS
        Of the keys' places.

    Examples
    --------
    >>> table = pd.DataFrame({"n": [1, 2]}, index=pd.Index(["real", "don't know"], name="answer"))
    >>> stack_parts({("all", "all walks"): table, ("style", "sad"): table}).loc[("style", "sad")]
                n
    answer
    real        1
    don't know  2
    """
    return _in_order(pd.concat(tables, names=list(names)))


def rows_of_parts(rows: Mapping[tuple[str, str], Mapping[str, float]], columns: Sequence[str]) -> pd.DataFrame:
    """Return a table with one row a part.

    Parameters
    ----------
    rows : mapping of (str, str) to mapping
        Values by column, by part; there may be none.
    columns : sequence of str
        Names.
    """
    index = pd.MultiIndex.from_tuples(list(rows), names=PART_LEVELS)
    return _in_order(pd.DataFrame(list(rows.values()), index=index, columns=list(columns)))


def _in_order(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table whose index levels are in the order of its rows: pandas looks up parts of sorted ones alone."""
    parts = [pd.factorize(table.index.get_level_values(level)) for level in range(table.index.nlevels)]
    codes, levels = zip(*parts, strict=True)
    return table.set_axis(pd.MultiIndex(levels=levels, codes=codes, names=table.index.names), axis=0)
