"""Intraclass correlations: how much of what ratings differ in is the walkers (Shrout & Fleiss 1979)."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.special import fdtri

from eigenwalker._validation import check_choice
from eigenwalker.experiment.ratings.gaps import complete_cases
from eigenwalker.experiment.ratings.generalized_limits import generalized_interval

__all__ = ["ICC_INTERVALS", "ICC_KINDS", "IntraclassCorrelation", "check_level", "intraclass_correlation"]

ICC_KINDS = ("ICC(1,1)", "ICC(2,1)", "ICC(3,1)", "ICC(1,k)", "ICC(2,k)", "ICC(3,k)")
"""Names of Shrout & Fleiss 1979."""

ICC_INTERVALS = ("satterthwaite", "generalized")
"""How intervals of ICC(2,1) and ICC(2,k) are made."""


class IntraclassCorrelation(NamedTuple):
    """An intraclass correlation, its confidence interval, and what it is of.

    Parameters
    ----------
    value, low, high : float
        NaN where nobody tells walkers apart.
    n_walkers, n_observers : int
        That were used.
    left_out : tuple
        Walkers or observers that were not, because of gaps.
    """

    value: float
    low: float
    high: float
    n_walkers: int
    n_observers: int
    left_out: tuple = ()


def intraclass_correlation(
    ratings: pd.DataFrame | ArrayLike,
    *,
    kind: str = "ICC(2,1)",
    level: float = 0.95,
    interval: str = "satterthwaite",
    missing: str = "error",
) -> IntraclassCorrelation:
    r"""Return an intraclass correlation of ratings, with its confidence interval.

    Of n walkers, rated by k observers, an analysis of variance gives the mean squares of walkers R, of observers C, of
    error E, and W within walkers. Then

    .. math::
        ICC(1,1) = \frac{R - W}{R + (k - 1) W} \qquad
        ICC(2,1) = \frac{R - E}{R + (k - 1) E + k (C - E) / n} \qquad
        ICC(3,1) = \frac{R - E}{R + (k - 1) E}

    and, with k ICC / (1 + (k - 1) ICC), those of means of k ratings, ICC(1,k), ICC(2,k) and ICC(3,k). The intervals
    are those of McGraw & Wong (1996, Table 7): the limits are the same ratios with W, E and C times F, a quantile of
    the F distribution with n - 1 and n (k - 1) or (n - 1)(k - 1) degrees of freedom. Normally distributed effects make
    them exact for the first and third kinds. For the second, F has Satterthwaite's degrees of freedom and they are
    approximate.

    Which kind says to what it generalizes:

    - 1: each walker is rated by other observers, all of them taken at random.
    - 2: the same observers rate all walkers, and stand for all others: that some are harsher than others is error.
    - 3: these observers only, and how harsh each is does not matter: do they put the walkers into the same order?

    Parameters
    ----------
    ratings : DataFrame or array-like of shape (n_walkers, n_observers)
        One row a walker, one column an observer; NaN where there is no rating.
    kind : {"ICC(1,1)", "ICC(2,1)", "ICC(3,1)", "ICC(1,k)", "ICC(2,k)", "ICC(3,k)"}, default "ICC(2,1)"
        Of a single rating, 1, or of the mean over the k observers.
    level : float, default 0.95
        Of confidence, between 0 and 1.
    interval : {"satterthwaite", "generalized"}, default "satterthwaite"
        How that of the second kind is made: as published, or as `generalized_interval` has it. The published one is
        too narrow where few observers rate many walkers and are not equally harsh. In 2,000 simulated studies of 80
        walkers and 3 observers it missed the truth in 13 % where observers had the same variance as walkers and error,
        in 16 % where they had three times as much; the generalized one in 4 to 6 %. With 10 observers these are 7 to 8
        and 4 to 6 %.
    missing : {"error", "drop_walkers", "drop_observers"}, default "error"
        What is done about gaps: raise, or leave out the walkers that somebody has not rated, or the observers who have
        not rated every walker. The result says whom.

    Returns
    -------
    IntraclassCorrelation
        Estimates can be below 0. Those of means have no lower bound: minus infinity where walkers do not differ
        enough for a ratio. NaN where every observer gives all walkers the same rating.

    Raises
    ------
    ValueError
        If there are fewer than two walkers or observers, gaps, infinite ratings, or an unknown option.

    Notes
    -----
    Where the estimate is negative, Satterthwaite's degrees of freedom are taken at 0, which no published formula does:
    otherwise they can fall to nearly none, and an interval at nearly all there is.

    References
    ----------
    Shrout & Fleiss 1979, Psychological Bulletin 86, 420-428, whose example is the one below (Tables 2 and 4). McGraw &
    Wong 1996, Psychological Methods 1, 30-46; their ICC(A,1) is ICC(2,1), and ICC(C,1) is ICC(3,1).

    Examples
    --------
    >>> ratings = [[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]]
    >>> found = intraclass_correlation(ratings, kind="ICC(2,1)")
    >>> [round(part, 2) for part in found[:3]]
    [0.29, 0.02, 0.76]
    >>> round(intraclass_correlation(ratings, kind="ICC(3,k)").value, 2)
    0.91
    """
    check_choice(kind, ICC_KINDS, name="kind")
    check_choice(interval, ICC_INTERVALS, name="interval")
    check_level(level)
    table, walkers, observers = _take(ratings)
    whole = complete_cases(table, walkers, observers, missing=missing)
    n_walkers, n_observers = whole.ratings.shape
    if n_walkers < 2 or n_observers < 2:
        left = " without gaps" if whole.ratings.size < table.size else ""
        raise ValueError(f"expected two walkers and observers or more{left}, got {n_walkers} and {n_observers}")
    found = _estimate(whole.ratings, kind, interval, level)
    return IntraclassCorrelation(*found, n_walkers, n_observers, (*whole.walkers_left_out, *whole.observers_left_out))


def check_level(level: float) -> None:
    """Raise a ValueError unless a level of confidence is between 0 and 1."""
    if not 0 < level < 1:
        raise ValueError(f"level must be between 0 and 1, got {level!r}")


def _take(ratings: pd.DataFrame | ArrayLike) -> tuple[NDArray[np.float64], list, list]:
    """Return ratings as an array, and the names of its rows and columns."""
    table = ratings if isinstance(ratings, pd.DataFrame) else pd.DataFrame(np.asarray(ratings))
    try:
        array = table.to_numpy(dtype=np.float64, na_value=np.nan)
    except (TypeError, ValueError) as error:
        raise ValueError(f"expected ratings as numbers, one row a walker, one column an observer: {error}") from None
    if np.isinf(array).any():
        raise ValueError(f"expected finite ratings, or NaN for gaps, got {np.isinf(array).sum()} infinite ones")
    return array, list(table.index), list(table.columns)


class _MeanSquares(NamedTuple):
    """Of walkers R, observers C, error E, and within walkers W."""

    walkers: float
    observers: float
    error: float
    within: float


def _mean_squares(ratings: NDArray[np.float64]) -> _MeanSquares:
    """Return the two-way analysis of variance of ratings, shape (n_walkers, n_observers)."""
    n_walkers, n_observers = ratings.shape
    walkers, observers = ratings.mean(axis=1, keepdims=True), ratings.mean(axis=0)
    error = ((ratings - walkers - observers + ratings.mean()) ** 2).sum() / ((n_walkers - 1) * (n_observers - 1))
    return _MeanSquares(
        n_observers * float(walkers.var(ddof=1)),
        n_walkers * float(observers.var(ddof=1)),
        float(error),
        float(ratings.var(axis=1, ddof=1).mean()),
    )


def _estimate(ratings: NDArray[np.float64], kind: str, interval: str, level: float) -> tuple[float, float, float]:
    """Return the coefficient and its limits."""
    if (np.ptp(ratings, axis=0) <= 1e-12 * np.abs(ratings).max()).all():
        return (float("nan"),) * 3
    squares, shape = _mean_squares(ratings), ratings.shape
    if kind.startswith("ICC(2") and interval == "generalized":
        low, high = generalized_interval(squares[:3], *shape, level=level)
        if kind.endswith("k)"):
            low, high = _of_mean(low, shape[1]), _of_mean(high, shape[1])
        return _coefficient(squares, shape, kind=kind), low, high
    free = _degrees_of_freedom(squares, shape, kind)
    quantiles = (1.0, *[float(fdtri(shape[0] - 1, free, share)) for share in ((1 + level) / 2, (1 - level) / 2)])
    value, low, high = (_coefficient(squares, shape, kind=kind, quantile=quantile) for quantile in quantiles)
    return value, low, high


def _coefficient(squares: _MeanSquares, shape: tuple[int, int], *, kind: str, quantile: float = 1.0) -> float:
    """Return the coefficient for a quantile of F, or its estimate for 1."""
    n_walkers, n_observers = shape
    noise = squares.within if kind.startswith("ICC(1") else squares.error
    harshness = n_observers * (squares.observers - squares.error) / n_walkers if kind.startswith("ICC(2") else 0.0
    rest = harshness / n_observers if kind.endswith("k)") else (n_observers - 1) * noise + harshness
    below = squares.walkers + quantile * rest
    return (squares.walkers - quantile * noise) / below if below > 0 else -np.inf


def _of_mean(single: float, n_observers: int) -> float:
    """Return the coefficient of a mean over observers for that of a single one."""
    below = 1 + (n_observers - 1) * single
    return n_observers * single / below if below > 0 else -np.inf


def _degrees_of_freedom(squares: _MeanSquares, shape: tuple[int, int], kind: str) -> float:
    """Return those of the denominator of F, Satterthwaite's for the second kind."""
    n_walkers, n_observers = shape
    if kind.startswith("ICC(1"):
        return float(n_walkers * (n_observers - 1))
    free = float((n_walkers - 1) * (n_observers - 1))
    if kind.startswith("ICC(3"):
        return free
    share = max(_coefficient(squares, shape, kind="ICC(2,1)"), 0.0)
    # a and b of McGraw & Wong's Table 7, both times n (1 - ICC), which may be 0.
    observers = n_observers * share * squares.observers
    error = (n_walkers * (1 - share) + n_observers * share * (n_walkers - 1)) * squares.error
    if observers + error == 0:
        return free
    return (observers + error) ** 2 / (observers**2 / (n_observers - 1) + error**2 / free)
