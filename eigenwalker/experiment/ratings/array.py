"""The ratings among the answers of a study, as one array a trait: walkers, observers, views."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

__all__ = ["RatedTrait", "rated_traits"]

_NEEDED = ("participant", "task", "part", "trait", "stimulus", "view", "value")
_TRIAL = ["observer", "session", "trial"]


class RatedTrait(NamedTuple):
    """All ratings of one trait.

    Parameters
    ----------
    ratings : ndarray of shape (n_walkers, n_observers, n_views)
        From 1 to as many as there were buttons. The mean where one walker was rated repeatedly by one observer in one
        view, NaN where it never was.
    walkers, observers, views : Index
        What the axes stand for, sorted. Every one of them has at least one rating.
    """

    ratings: NDArray[np.float64]
    walkers: pd.Index
    observers: pd.Index
    views: pd.Index


def rated_traits(answers: pd.DataFrame) -> dict[str, RatedTrait]:
    """Return the ratings of every trait, without those of practice and attention trials.

    Parameters
    ----------
    answers : DataFrame
        Answers of a study, one row a trial: participant, task, part, trait, stimulus, view and value, maybe study and
        answer. Trials that were not answered have no row or no value; other tasks than "rating" are left alone.

    Returns
    -------
    dict of str to RatedTrait
        Traits in alphabetical order.

    Raises
    ------
    TypeError
        If it is no DataFrame.
    ValueError
        If columns are missing, there are no ratings, a rating is less than 1 or no number, it is not said who gave
        it, of what, in which view, or a trial was answered twice. All faults at once.
    """
    trials = _main_ratings(answers)
    return {str(trait): _spread(part) for trait, part in trials.groupby("trait", sort=True)}


def _main_ratings(answers: pd.DataFrame) -> pd.DataFrame:
    if not isinstance(answers, pd.DataFrame):
        raise TypeError(f"expected answers as a DataFrame, got {type(answers).__name__}")
    lacking = [name for name in _NEEDED if name not in answers.columns]
    if lacking:
        raise ValueError(f"expected the columns {', '.join(_NEEDED)}, missing: {', '.join(lacking)}")
    asked = answers[answers["task"] == "rating"]
    chosen = asked.assign(observer=_observers(asked))[asked["part"] == "main"]
    values = pd.to_numeric(chosen["value"], errors="coerce")
    _check_ratings(chosen, values)
    known = chosen[values.notna()]
    return pd.DataFrame(
        {
            "trait": known["trait"].astype(str),
            "walker": known["stimulus"].astype(str),
            "observer": known["observer"],
            "view": known["view"].astype(float),
            "value": values[values.notna()].astype(float),
        }
    )


def _observers(asked: pd.DataFrame) -> pd.Series:
    """Return who answered: participants of several studies are told apart by study and number."""
    if "study" in asked and asked["study"].nunique() > 1:
        return asked["study"].astype(str) + " " + asked["participant"].astype(str)
    return asked["participant"]


def _check_ratings(chosen: pd.DataFrame, values: pd.Series) -> None:
    """Raise with all faults of the main ratings, unless there are none."""
    given = chosen["answer" if "answer" in chosen else "value"]
    lost = given.notna() & (given.astype(str) != "") & values.isna()
    wrong = values.notna() & ~((values >= 1) & (values < np.inf))
    known = chosen[values.notna()]
    needed = ("participant", "trait", "stimulus", "view")
    blank = [name for name in needed if (known[name].isna() | (known[name] == "")).any()]
    twice = known[known.duplicated(_TRIAL)] if set(_TRIAL) <= set(known.columns) else known[:0]
    faults = []
    if not len(known):
        faults.append("there is none, of the task 'rating' and the part 'main' and with a value")
    if lost.any():
        faults.append(f"answers without a number as value: {lost.sum()}, the first is {given[lost].iloc[0]!r}")
    if wrong.any():
        faults.append(f"values less than 1 or infinite: {wrong.sum()}, the first is {values[wrong].iloc[0]:g}")
    if blank:
        faults.append(f"some have no {' and no '.join(blank)}")
    if len(twice):
        named = ", ".join(f"{name} {value}" for name, value in twice.iloc[0][_TRIAL].items())
        faults.append(f"trials answered before: {len(twice)}, the first is {named}; drop those that repeat")
    if faults:
        raise ValueError(
            f"expected ratings, once a trial, from 1 to as many as there were buttons, but {'; '.join(faults)}"
        )


def _spread(part: pd.DataFrame) -> RatedTrait:
    """Return the ratings of one trait as an array, repeated ones averaged."""
    factors = [pd.factorize(part[name], sort=True) for name in ("walker", "observer", "view")]
    shape = tuple(len(names) for _, names in factors)
    cells = np.ravel_multi_index([codes for codes, _ in factors], shape)
    sums = np.bincount(cells, part["value"], minlength=int(np.prod(shape)))
    counts = np.bincount(cells, minlength=int(np.prod(shape)))
    ratings = np.where(counts > 0, sums / np.maximum(counts, 1), np.nan).reshape(shape)
    return RatedTrait(ratings, *[pd.Index(names) for _, names in factors])
