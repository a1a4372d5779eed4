"""Intervals of answers that two things make alike: whose they are, and about which walk."""

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, stdtrit

from eigenwalker.experiment.analysis.means import mean_interval
from eigenwalker.experiment.analysis.rates import Estimated, rate_difference, rate_interval

__all__ = ["crossed_difference", "crossed_interval", "crossed_mean", "crossed_rate", "groupings"]

_SUREST = 1 - 1e-12  # 7 standard errors: what t of two groups asks for, 12.7 of them, is no number below 1


def groupings(trials: pd.DataFrame) -> pd.DataFrame:
    """Return what makes answers alike: the columns participant and walk of trials, as far as they have them."""
    return trials[[name for name in ("participant", "walk") if name in trials.columns]]


def crossed_interval(interval: Callable[[ArrayLike | None], Estimated], groups: pd.DataFrame) -> Estimated:
    r"""Return an interval for answers with up to two groupings, made of intervals that know one of them.

    Every participant answers about several walks, and every walk is answered about by several participants. The
    variance is that by participants and that by walks, less that of single answers, which both of them hold (Cameron,
    Gelbach & Miller 2011, Journal of Business & Economic Statistics 29, 238-249, Eq. 2.8). Here it is taken of the
    distance of each limit from the estimate m, as for a difference of shares (Zou & Donner 2008, Statistics in
    Medicine 27, 1693-1702):

    .. math:: (m - low)^2 = (m - low_{participants})^2 + (m - low_{walks})^2 - (m - low_{answers})^2

    and the same above. Such an interval is about other participants *and* other walks than those of the study. It is
    as wide as the wider one at least, unless pairs make the interval of a difference narrower.

    Parameters
    ----------
    interval : callable
        Takes the group of each answer, or None where every answer stands for itself; returns an Estimated.
    groups : DataFrame
        One row an answer, one column a grouping: none, one or two.

    Returns
    -------
    Estimated

    Raises
    ------
    ValueError
        If there are more than two groupings.

    Examples
    --------
    >>> right = [True, True, True, True, True, False, True, False, False]
    >>> groups = pd.DataFrame({"participant": [1, 1, 1, 2, 2, 2, 3, 3, 3], "walk": list("abcabcabc")})
    >>> [round(part, 2) for part in rate_interval(right)]
    [0.67, 0.35, 0.88]
    >>> [round(part, 2) for part in crossed_interval(lambda group: rate_interval(right, group), groups)]
    [0.67, 0.25, 0.92]
    """
    if groups.shape[1] > 2:
        raise ValueError(f"expected two groupings at most, got {', '.join(map(str, groups.columns))}")
    if groups.shape[1] == 0:
        return interval(None)
    if groups.shape[1] == 1:
        return interval(groups.iloc[:, 0].to_numpy())
    single = interval(groups.groupby(list(groups.columns), sort=False).ngroup().to_numpy())
    parts = [_distances(interval(groups[name].to_numpy())) for name in groups.columns]
    below, above = np.sqrt(np.maximum(parts[0] ** 2 + parts[1] ** 2 - _distances(single) ** 2, 0.0)).tolist()
    return Estimated(single.value, single.value - below, single.value + above)


def _distances(found: Estimated) -> NDArray[np.float64]:
    return np.array([found.value - found.low, found.high - found.value])


def crossed_rate(right: ArrayLike, groups: pd.DataFrame, *, level: float = 0.95) -> Estimated:
    """Return the share of right answers, with an interval that knows participants and walks.

    Where there are groups, the interval is as much wider as Student's t, of one degree of freedom less than there are
    groups, is larger than the normal distribution's quantile, as in Korn & Graubard 1998.

    Parameters
    ----------
    right : array-like of bool of shape (n_answers,)
        Whether each answer is right.
    groups : DataFrame
        See `groupings`.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    Estimated
        See `rate_interval` and `crossed_interval`; within 0 and 1.
    """
    found = crossed_interval(lambda group: rate_interval(right, group, level=_wider(level, group)), groups)
    return _within(found, 0.0, 1.0)


def crossed_difference(
    first: ArrayLike,
    second: ArrayLike,
    first_groups: pd.DataFrame,
    second_groups: pd.DataFrame,
    *,
    level: float = 0.95,
) -> Estimated:
    """Return how much larger the share of right answers in the second series is, knowing participants and walks.

    Parameters
    ----------
    first, second : array-like of bool of shape (n_answers,)
        Whether each answer is right.
    first_groups, second_groups : DataFrame
        See `groupings`; the columns that both have are used.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    Estimated
        See `rate_difference`, `crossed_interval` and `crossed_rate`; within -1 and 1.
    """
    n_first = len(first_groups)

    def interval(group: ArrayLike | None) -> Estimated:
        if group is None:
            return rate_difference(first, second, level=level)
        named = np.asarray(group)
        return rate_difference(first, second, named[:n_first], named[n_first:], level=_wider(level, named))

    groups = pd.concat([first_groups, second_groups], join="inner", ignore_index=True)
    return _within(crossed_interval(interval, groups), -1.0, 1.0)


def crossed_mean(
    values: ArrayLike, groups: pd.DataFrame, *, within: tuple[float, float], level: float = 0.95
) -> Estimated:
    """Return the mean of scores, with an interval that knows participants and walks.

    Parameters
    ----------
    values : array-like of float of shape (n_answers,)
        Scores.
    groups : DataFrame
        See `groupings`.
    within : (float, float)
        The least and the largest score that can be given, which the interval ends at.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    Estimated
        See `mean_interval` and `crossed_interval`.
    """
    found = crossed_interval(lambda group: mean_interval(values, group, level=level), groups)
    return _within(found, *within)


def _wider(level: float, group: ArrayLike | None) -> float:
    """Return the level whose normal quantile is that of Student's t at `level`, for so many groups."""
    if group is None or not 0 < level < 1:
        return level
    n_groups = len(np.unique(np.asarray(group)))
    if n_groups < 2 or n_groups == np.size(group):
        return level
    return min(float(2 * ndtr(stdtrit(n_groups - 1, (1 + level) / 2)) - 1), _SUREST)


def _within(found: Estimated, least: float, most: float) -> Estimated:
    """Return an interval that ends where there is nothing beyond; a NaN stays one."""
    return Estimated(found.value, float(np.maximum(found.low, least)), float(np.minimum(found.high, most)))
