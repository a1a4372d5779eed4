"""What speaks against a trait axis, in words, and what should be said of any."""

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

__all__ = ["find_faults", "state_notes"]

_CEILING = 0.99
_STABLE = 0.8  # by chance alone 1 / sqrt(2): the noise of the axis, beside as much again of the resample
_MOST_EXPLAINED = 0.5
_FEWEST_PERSONS = 2  # to each component


def find_faults(
    summary: pd.DataFrame,
    parts: pd.DataFrame,
    components: pd.DataFrame,
    codes: pd.DataFrame,
    persons: NDArray[np.intp],
    sources: ArrayLike | None,
    settings: dict[str, Any],
) -> list[str]:
    """Return a sentence for each thing that speaks against an axis."""
    faults = []
    for trait, row in summary.iterrows():
        alone = parts.loc[trait, "alone"]
        found = [
            _confounded(codes[trait], persons, sources),
            _by_chance(row),
            _at_the_ceiling(row, alone),
            _by_tempo(row),
            _optimistic(row, components[trait]),
            _unstable(row),
            _few(row, settings["n_components"]),
        ]
        faults += [f"{trait}: {text}" for text in found if text]
    return faults


def _confounded(labels: pd.Series, persons: NDArray[np.intp], sources: ArrayLike | None) -> str:
    """Tell whether the label follows from where a walk was recorded; sources of one person each cannot tell."""
    if sources is None:
        return ""
    columns = {"label": labels.to_numpy(), "person": persons, "source": np.asarray(sources, dtype=object)}
    table = pd.DataFrame(columns).dropna().drop_duplicates()
    table = table[table.groupby("source", sort=False)["person"].transform("nunique") > 1]
    groups = table.groupby("source", sort=False)["label"]
    total = table["label"].var()
    if groups.ngroups < 2 or not total > 0:
        return ""
    # Each variance over what is free in it, so that many small sources do not explain more than two large ones.
    within = ((table["label"] - groups.transform("mean")) ** 2).sum() / (len(table) - groups.ngroups)
    share = 1 - within / total
    if share < _MOST_EXPLAINED:
        return ""
    how = "always" if share > 1 - 1e-12 else f"to {share:.0%} of its variance"
    return (
        f"confounded with the source: where a walk was recorded tells its label {how} ({groups.ngroups} sources); the "
        "axis may be about the source. Record walkers of all labels in all sources"
    )


def _by_chance(row: pd.Series) -> str:
    if row["p"] <= 0.05:
        return ""
    return f"not told from chance: shuffled labels do as well in {row['p']:.0%} of cases"


def _at_the_ceiling(row: pd.Series, alone: pd.Series) -> str:
    if row["score"] != "auc" or not (alone >= _CEILING).all():
        return ""
    return (
        "too good: structure alone and dynamics alone both tell the groups apart without fault. Do groups differ in "
        "how, where or by whom they were recorded?"
    )


def _by_tempo(row: pd.Series) -> str:
    if not row["tempo"] >= row["left_out_low"] or row["p"] > 0.05:
        return ""
    return (
        f"frequency and speed alone do about as well ({_score(row)} {row['tempo']:.2f} beside {row['left_out']:.2f}): "
        "the axis may be about tempo"
    )


def _optimistic(row: pd.Series, curve: pd.Series) -> str:
    if not curve.max() > row["nested_high"]:
        return ""
    return (
        f"the best of all numbers of components, {curve.idxmax()}, has {curve.max():.2f}, but chosen without those it "
        f"is tested on {row['nested']:.2f}: report the second"
    )


def _unstable(row: pd.Series) -> str:
    if row["stability"] >= _STABLE:
        return ""
    return (
        f"unstable: with persons drawn again the median cosine to this axis is {row['stability']:.2f}; what it moves "
        "is not known well"
    )


def _few(row: pd.Series, n_components: int) -> str:
    if row["n_persons"] >= _FEWEST_PERSONS * n_components:
        return ""
    return (
        f"few persons: {row['n_persons']} for {n_components} components; at least {_FEWEST_PERSONS} persons a "
        "component are advisable, use fewer components"
    )


def _score(row: pd.Series) -> str:
    return "area under the curve" if row["score"] == "auc" else "r"


def state_notes(settings: dict[str, Any]) -> tuple[str, ...]:
    """Return what should be said of any axis."""
    notes = [
        "An axis is an association in this sample: walkers who differ in the trait also differ in this way. It does "
        "not say that the trait causes the difference, nor that other samples show it.",
        "Scores are of persons left out, for whom scaling, Eigenwalkers and axis are fitted to all others. The null of "
        "such a score is not its value by chance; the p-value counts how often shuffled labels do as well.",
    ]
    if settings["control"]:
        notes.append(
            f"Controlled for {', '.join(settings['control'])}: the axes have no covariance with it among the walkers "
            "they are learned from. What the controls do not measure, and what they do to the walk in other than "
            "linear ways, is not taken out."
        )
    return tuple(notes)
