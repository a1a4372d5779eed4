"""Labels of traits: names, numbers for words, and missing entries."""

from collections.abc import Hashable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

__all__ = ["Coding", "are_numbers", "default_names", "encode", "encode_one", "learn_coding", "many_classes", "tabulate"]

Poles = Mapping[str, Sequence[Hashable]]


class Coding(NamedTuple):
    """How one trait's labels become numbers.

    Parameters
    ----------
    name : str
        The trait.
    poles : tuple
        Words for the negative and the positive end.
    two_valued : bool
        Whether the labels are the two poles themselves, coded -1 and +1, or numbers.
    """

    name: str
    poles: tuple[Hashable, Hashable]
    two_valued: bool


def tabulate(y: object, poles: Poles | None = None, *, name: str = "y") -> pd.DataFrame:
    """Return labels as a DataFrame with one column a trait.

    Parameters
    ----------
    y : DataFrame, Series or array-like of shape (n_walkers,) or (n_walkers, n_traits)
        Labels. Names come from columns or the Series; labels without a name take those of `poles` when their
        numbers agree, else "trait", or "trait_0", "trait_1" ...
    poles : mapping of str to pair, default None
        Words for the ends of the traits.
    name : str, default "y"
        What `y` is called in errors.

    Raises
    ------
    ValueError
        If `y` has another shape, or two columns have one name.
    """
    if isinstance(y, pd.DataFrame):
        table = y.reset_index(drop=True).rename(columns=str)
        if not table.columns.is_unique:
            twice = ", ".join(map(repr, table.columns[table.columns.duplicated()].unique()))
            raise ValueError(f"{name} must have columns with different names, got {twice} more than once")
        return table
    if isinstance(y, pd.Series):
        column = str(y.name) if y.name is not None else default_names(1, poles)[0]
        return y.reset_index(drop=True).to_frame(column)
    array = np.asarray(y) if not isinstance(y, np.ndarray) else y
    if array.ndim not in (1, 2):
        raise ValueError(f"{name} must have shape (n_walkers,) or (n_walkers, n_traits), got {array.shape}")
    columns = array[:, np.newaxis] if array.ndim == 1 else array
    return pd.DataFrame(columns, columns=default_names(columns.shape[1], poles))


def default_names(n_traits: int, poles: Poles | None) -> list[str]:
    """Return names of traits whose labels have none: those of `poles` where their numbers agree."""
    if poles and len(poles) == n_traits:
        return list(poles)
    return ["trait"] if n_traits == 1 else [f"trait_{number}" for number in range(n_traits)]


def learn_coding(table: pd.DataFrame | Mapping[str, pd.Series], poles: Poles | None) -> list[Coding]:
    """Return how each column of labels becomes numbers.

    Raises
    ------
    ValueError
        If a column has no labels, one class only, more than two words, or words that differ from its poles; if
        `poles` names a trait that is not there. All faults at once.
    """
    poles = dict(poles or {})
    faults = [f"poles name the trait {name!r}, which is not among {list(table)}" for name in poles if name not in table]
    codings = []
    for name in table:
        try:
            codings.append(_learn_one(name, table[name].dropna(), poles.get(name)))
        except ValueError as error:
            faults.append(str(error))
    if faults:
        raise ValueError("; ".join(faults))
    return codings


def _learn_one(name: str, known: pd.Series, poles: Sequence[Hashable] | None) -> Coding:
    if poles is not None and (isinstance(poles, str) or len(poles) != 2 or poles[0] == poles[1]):
        raise ValueError(f"poles of trait {name!r} must be two different words, negative end first, got {poles!r}")
    if known.empty:
        raise ValueError(f"trait {name!r}: expected labels, got none but missing ones")
    if are_numbers(known):
        return Coding(name, (poles[0], poles[1]) if poles is not None else ("low", "high"), two_valued=False)
    values = sorted(known.unique().tolist(), key=str)
    if len(values) == 1:
        raise ValueError(f"trait {name!r}: expected two classes, got one class only, {values[0]!r}")
    if len(values) > 2:
        raise many_classes(name, values)
    if poles is not None and set(poles) != set(values):
        raise ValueError(f"trait {name!r}: its labels are {values}, but its poles are {list(poles)}")
    low, high = poles if poles is not None else values
    return Coding(name, (low, high), two_valued=True)


def many_classes(name: str, values: Sequence[Hashable]) -> ValueError:
    """Return the error of a trait with more than two words."""
    shown = ", ".join(map(repr, values[:6])) + (" ..." if len(values) > 6 else "")
    are_texts = all(isinstance(value, str) for value in values)
    is_number = are_texts and pd.to_numeric(pd.Series(values), errors="coerce").notna().all()
    mend = "; these are numbers written as text, use labels.astype(float)" if is_number else ""
    return ValueError(f"trait {name!r}: expected numbers or two classes, got {len(values)} classes, {shown}{mend}")


def are_numbers(known: pd.Series) -> bool:
    """Return whether labels, none of them missing, are numbers, not words or truth values."""
    known = _as_numbers(known)
    return pd.api.types.is_numeric_dtype(known) and not pd.api.types.is_bool_dtype(known)


def _as_numbers(labels: pd.Series) -> pd.Series:
    """Turn a column of objects that are all numbers into numbers; leave others as they are."""
    return labels.infer_objects() if labels.dtype == object else labels


def encode(table: pd.DataFrame, codings: Sequence[Coding]) -> NDArray[np.float64]:
    """Return labels as numbers, shape (n_walkers, n_traits), NaN where they are missing.

    Raises
    ------
    ValueError
        If a label is none of the words that the coding knows, or an infinite number.
    """
    if table.shape[1] != len(codings):
        raise ValueError(f"expected labels of {len(codings)} traits, got {table.shape[1]}")
    return np.column_stack([encode_one(table[name], coding) for coding, name in zip(codings, table, strict=True)])


def encode_one(labels: pd.Series, coding: Coding) -> NDArray[np.float64]:
    """Return the labels of one trait as numbers, shape (n_walkers,); see `encode`."""
    if coding.two_valued:
        codes = {coding.poles[0]: -1.0, coding.poles[1]: 1.0}
        unknown = [value for value in labels.dropna().unique() if value not in codes]
        if unknown:
            raise ValueError(f"trait {coding.name!r}: expected {list(codes)}, got {unknown[0]!r}")
        return labels.map(codes).to_numpy(dtype=np.float64, na_value=np.nan)
    numbers = _as_numbers(labels).to_numpy(dtype=np.float64, na_value=np.nan)
    if np.isinf(numbers).any():
        raise ValueError(f"Input y, trait {coding.name!r}, contains infinity; use NaN for a missing label")
    return numbers
