"""Traits with more than two words, such as styles: one axis a word, against the rest."""

from collections.abc import Hashable, Sequence

import numpy as np
import pandas as pd

__all__ = ["one_against_rest", "poles_of", "style_columns"]


def style_columns(traits: pd.DataFrame) -> dict[str, list[str]]:
    """Return the axes that each trait with more than two words becomes, ``{"style": ["style=active", ...]}``."""
    return {
        str(trait): [f"{trait}={word}" for word in _words(traits[trait])]
        for trait in traits
        if len(_words(traits[trait])) > 2
    }


def one_against_rest(traits: pd.DataFrame, groups: Sequence[Hashable]) -> pd.DataFrame:
    """Return traits in which each with more than two words is replaced by one column a word.

    Parameters
    ----------
    traits : DataFrame
        One row a walk.
    groups : sequence
        Which person each walk is of.

    Returns
    -------
    DataFrame
        A column ``style=elderly`` has the words elderly and "not elderly". Missing labels stay missing.

    Raises
    ------
    ValueError
        If a word is that of one person only, so that no other is left when that one is left out; all of them at once.
    """
    spread = style_columns(traits)
    faults = [fault for trait in spread if (fault := _fault(traits[trait], groups))]
    if faults:
        raise ValueError("; ".join(faults))
    columns: dict[str, pd.Series] = {}
    for trait in traits:
        if trait not in spread:
            columns[str(trait)] = traits[trait]
            continue
        for word, name in zip(_words(traits[trait]), spread[str(trait)], strict=True):
            known = np.where(traits[trait] == word, str(word), f"not {word}")
            columns[name] = pd.Series(known, traits.index, dtype=object).where(traits[trait].notna(), None)
    return pd.DataFrame(columns)


def poles_of(spread: dict[str, list[str]]) -> dict[str, tuple[str, str]]:
    """Return the words of the axes of `style_columns`: the negative end is "not elderly", the positive one elderly."""
    words = {name: name.removeprefix(f"{trait}=") for trait, names in spread.items() for name in names}
    return {name: (f"not {word}", word) for name, word in words.items()}


def _words(labels: pd.Series) -> list[object]:
    """Return the different words of a trait, sorted; none for numbers."""
    known = labels.dropna().infer_objects()
    if pd.api.types.is_numeric_dtype(known):
        return []
    return sorted(known.unique().tolist(), key=str)


def _fault(labels: pd.Series, groups: Sequence[Hashable]) -> str:
    table = pd.DataFrame({"label": labels.to_numpy(), "person": list(groups)}).dropna(subset="label")
    lonely = [str(label) for label, persons in table.groupby("label")["person"].nunique().items() if persons < 2]
    if not lonely:
        return ""
    return (
        f"trait {labels.name!r} has {table['label'].nunique()} different labels, and each becomes an axis against the "
        f"rest; that takes at least two persons or recordings of each, but there is only one of "
        f"{', '.join(lonely[:10])}{' ...' if len(lonely) > 10 else ''}"
    )
