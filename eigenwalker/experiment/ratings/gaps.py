"""Ratings without gaps: who is left out so that everybody has rated everything."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import check_choice

__all__ = ["MISSING", "CompleteCases", "complete_cases"]

MISSING = ("error", "drop_walkers", "drop_observers")
"""What can be done about gaps."""


class CompleteCases(NamedTuple):
    """Ratings without gaps, and what was left out for it.

    Parameters
    ----------
    ratings : ndarray of shape (n_walkers, n_observers, ...)
        Without NaN.
    walkers_left_out, observers_left_out : list
        Names.
    """

    ratings: NDArray[np.float64]
    walkers_left_out: list
    observers_left_out: list


def complete_cases(
    ratings: NDArray[np.float64], walkers: Sequence, observers: Sequence, *, missing: str = "error"
) -> CompleteCases:
    """Return the ratings that have no gaps.

    Parameters
    ----------
    ratings : ndarray of shape (n_walkers, n_observers) or (n_walkers, n_observers, n_views)
        NaN where there is none.
    walkers, observers : sequence
        Names of rows and columns.
    missing : {"error", "drop_walkers", "drop_observers"}, default "error"
        What is done about gaps: raise, or leave out the walkers that somebody has not rated, or the observers who have
        not rated every walker.

    Returns
    -------
    CompleteCases

    Raises
    ------
    ValueError
        If there are gaps that shall be an error, or nothing is left without them.
    """
    check_choice(missing, MISSING, name="missing")
    gaps = np.isnan(ratings).any(axis=tuple(range(2, ratings.ndim)))  # (n_walkers, n_observers)
    whole_walkers, whole_observers = ~np.any(gaps, axis=1), ~np.any(gaps, axis=0)
    if not gaps.any():
        return CompleteCases(ratings, [], [])
    if missing == "drop_walkers" and whole_walkers.any():
        return CompleteCases(ratings[whole_walkers], _named(walkers, ~whole_walkers), [])
    if missing == "drop_observers" and whole_observers.any():
        return CompleteCases(ratings[:, whole_observers], [], _named(observers, ~whole_observers))
    raise ValueError(
        f"expected ratings of all {len(walkers)} walkers by all {len(observers)} observers, {np.isnan(ratings).sum()} "
        f"of {ratings.size} are missing; by observers, of so many walkers: {_listed(observers, gaps.sum(axis=0))}; of "
        f"walkers, by so many observers: {_listed(walkers, gaps.sum(axis=1))}; missing='drop_walkers' would leave "
        f"{whole_walkers.sum()} walkers, missing='drop_observers' {whole_observers.sum()} observers; or leave out some "
        "of both before"
    )


def _named(names: Sequence, chosen: NDArray[np.bool_]) -> list:
    return [name for name, kept in zip(names, chosen, strict=True) if kept]


def _listed(names: Sequence, counts: NDArray[np.int_]) -> str:
    """Return those with most gaps in words."""
    worst = [at for at in np.argsort(-counts, kind="stable") if counts[at]]
    more = f" and {len(worst) - 6} more" if len(worst) > 6 else ""
    return ", ".join(f"{names[at]} ({counts[at]})" for at in worst[:6]) + more
