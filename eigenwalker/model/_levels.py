"""Labels that come in parts: numbers for them before it is known which labels there are."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker.model._labels import Coding, are_numbers, encode_one, many_classes

__all__ = ["Levels", "add_levels", "encode_part", "numbers_of"]

_TOLD_APART = 3  # with one more than two it is known that there are not two


class Levels(NamedTuple):
    """The first three different labels of a column, in the order in which they came.

    Words are -1 and +1 in this order, whatever their poles are; `numbers_of` says so.

    Parameters
    ----------
    name : str
        Of the column.
    seen : Series
        The labels, as they were given.
    """

    name: str
    seen: pd.Series


def encode_part(levels: Levels, labels: pd.Series) -> tuple[Levels, NDArray[np.float64]]:
    """Return the levels with those of more labels, and these labels as numbers, NaN where they are missing.

    Raises
    ------
    ValueError
        If there are more than two words, words and numbers, or an infinite number.
    """
    if isinstance(labels.dtype, pd.CategoricalDtype):
        labels = labels.astype(labels.cat.categories.dtype)
    known = labels.dropna()
    levels = _include(levels, known)
    two_valued = len(levels.seen) > 0 and not are_numbers(levels.seen)
    if known.empty:
        return levels, np.full(len(labels), np.nan)
    if not two_valued:
        return levels, encode_one(labels, Coding(levels.name, ("low", "high"), two_valued=False))
    codes = dict(zip(levels.seen, (-1.0, 1.0), strict=False))
    return levels, labels.map(codes).to_numpy(dtype=np.float64, na_value=np.nan)


def add_levels(one: Levels, other: Levels) -> tuple[Levels, float]:
    """Return the levels of both, and what the numbers of the other are multiplied by to be numbers of both."""
    levels = _include(one, other.seen)
    if not len(other.seen) or are_numbers(other.seen):
        return levels, 1.0
    return levels, 1.0 if levels.seen.iloc[0] == other.seen.iloc[0] else -1.0


def numbers_of(levels: Levels) -> dict[object, float]:
    """Return the number that stands for each label in `Levels.seen`."""
    numbers = levels.seen.astype(float) if are_numbers(levels.seen) else (-1.0, 1.0)
    return dict(zip(levels.seen, numbers, strict=False))


def _include(levels: Levels, known: pd.Series) -> Levels:
    """Return the levels with those among known labels."""
    if known.empty:
        return levels
    if levels.seen.empty:
        return _check(levels._replace(seen=known.drop_duplicates().reset_index(drop=True)))
    if are_numbers(levels.seen) != are_numbers(known):
        raise ValueError(
            f"trait {levels.name!r}: expected numbers or two words in all parts, got both, "
            f"{levels.seen.tolist()[0]!r} and {known.tolist()[0]!r}"
        )
    if are_numbers(known) and len(levels.seen) == _TOLD_APART:
        return levels
    new = known[~known.isin(levels.seen)].drop_duplicates()
    return levels if new.empty else _check(levels._replace(seen=pd.concat([levels.seen, new], ignore_index=True)))


def _check(levels: Levels) -> Levels:
    if len(levels.seen) > 2 and not are_numbers(levels.seen):
        raise many_classes(levels.name, levels.seen.tolist())
    return levels._replace(seen=levels.seen.iloc[:_TOLD_APART])
