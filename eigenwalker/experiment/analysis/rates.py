"""Shares of right answers and their difference, with intervals that know which answers belong together."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from eigenwalker.model.intervals import wilson_interval

__all__ = ["Estimated", "rate_difference", "rate_interval"]


class Estimated(NamedTuple):
    """A number and its confidence interval.

    Parameters
    ----------
    value, low, high : float
        NaN where there is nothing to estimate it from.
    """

    value: float
    low: float
    high: float


def rate_interval(right: ArrayLike, groups: ArrayLike | None = None, *, level: float = 0.95) -> Estimated:
    r"""Return the share of right answers with Wilson's interval.

    Answers to one walk, or of one person, are alike: n of them say less than n independent ones. The interval is that
    of n / D independent answers (Korn & Graubard 1998, Survey Methodology 24, 193-201), where D is how much larger the
    variance of the share p is than if the answers were independent,

    .. math:: D = \frac{G}{G - 1} \frac{\sum_g (r_g - p\, n_g)^2}{n\, p (1 - p)}

    with r_g right ones among the n_g answers of group g, of G groups. D is taken to be 1 at least, and G independent
    answers are left; they are all that is left where p is 0 or 1 and tells nothing of D.

    Parameters
    ----------
    right : array-like of bool of shape (n_trials,)
        Whether each answer is right.
    groups : array-like of shape (n_trials,), default None
        To which walk or person an answer belongs. None: every answer stands for itself.
    level : float, default 0.95
        Of confidence, between 0 and 1.

    Returns
    -------
    Estimated
        NaN if there are no trials.

    Raises
    ------
    ValueError
        If there is not one group a trial, or the level is not between 0 and 1.

    Examples
    --------
    >>> [round(part, 4) for part in rate_interval([True] * 161 + [False] * 85)]  # 65.45 % of 246, Fig. 5 of the paper
    [0.6545, 0.5931, 0.7111]
    >>> [round(part, 2) for part in rate_interval([True, True, False, False], groups=[0, 0, 1, 1])]
    [0.5, 0.09, 0.91]
    """
    _check_level(level)
    answers, sums = _by_group(right, groups)
    if not len(answers):
        return Estimated(*[float("nan")] * 3)
    rate = float(answers.mean())
    low, high = wilson_interval(rate, _effective_trials(rate, sums), float(ndtri((1 + level) / 2)))
    return Estimated(rate, low, high)


def rate_difference(
    first: ArrayLike,
    second: ArrayLike,
    first_groups: ArrayLike | None = None,
    second_groups: ArrayLike | None = None,
    *,
    level: float = 0.95,
) -> Estimated:
    """Return how much larger the share of right answers in the second series is than in the first.

    The interval comes from those of both shares (Newcombe 1998, Statistics in Medicine 17, 873-890, method 10), and
    from the correlation of the shares over the groups that both series have (Zou & Donner 2008, Statistics in Medicine
    27, 1693-1702): a walk that is hard to recognize is hard to recognize in its synthesis as well.

    Parameters
    ----------
    first, second : array-like of bool of shape (n_trials,)
        Whether each answer is right.
    first_groups, second_groups : array-like of shape (n_trials,), default None
        To which walk or person an answer belongs, see `rate_interval`; both or none.
    level : float, default 0.95
        Of confidence, between 0 and 1.

    Returns
    -------
    Estimated
        Between -1 and 1.

    Raises
    ------
    ValueError
        If the groups of one series only are given, or as `rate_interval`.

    Examples
    --------
    >>> natural = [True] * 128 + [False] * 126, [True] * 161 + [False] * 85  # synthetic and original walks, Fig. 5
    >>> [round(part, 3) for part in rate_difference(*natural)]
    [0.151, 0.064, 0.234]
    """
    if (first_groups is None) != (second_groups is None):
        raise ValueError("expected the groups of both series or of none, got those of one")
    one = rate_interval(first, first_groups, level=level)
    two = rate_interval(second, second_groups, level=level)
    shared = 0.0
    if first_groups is not None and second_groups is not None:
        shared = _correlation(first, second, first_groups, second_groups)
    below = _distance(two.value - two.low, one.high - one.value, shared)
    above = _distance(two.high - two.value, one.value - one.low, shared)
    difference = two.value - one.value
    return Estimated(difference, difference - below, difference + above)


def _distance(one: float, other: float, correlation: float) -> float:
    return float(np.sqrt(max(one**2 - 2 * correlation * one * other + other**2, 0.0)))


def _check_level(level: float) -> None:
    if not 0 < level < 1:
        raise ValueError(f"level must be between 0 and 1, got {level!r}")


def _by_group(right: ArrayLike, groups: ArrayLike | None) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return the answers, and of each group how many are right and how many there are, shape (n_groups, 2)."""
    answers = np.asarray(right, dtype=bool)
    numbers = np.arange(len(answers)) if groups is None else np.unique(np.asarray(groups), return_inverse=True)[1]
    if answers.ndim != 1 or numbers.shape != answers.shape:
        raise ValueError(f"expected one group a trial, got {numbers.shape} groups of {answers.shape} trials")
    return answers, np.column_stack((np.bincount(numbers, answers), np.bincount(numbers)))


def _effective_trials(rate: float, sums: NDArray[np.float64]) -> float:
    """Return as how many independent answers those of the groups are, see `rate_interval`."""
    n_groups, n_trials = len(sums), float(sums[:, 1].sum())
    if n_groups == n_trials or n_groups == 1:
        return float(n_groups)
    if not 0 < rate < 1:
        return float(n_groups)
    scatter = n_groups / (n_groups - 1) * float(((sums[:, 0] - rate * sums[:, 1]) ** 2).sum())
    effect = scatter / (n_trials * rate * (1 - rate))
    return max(float(n_groups), n_trials / max(effect, 1.0)) if effect > 0 else n_trials


def _correlation(first: ArrayLike, second: ArrayLike, first_groups: ArrayLike, second_groups: ArrayLike) -> float:
    """Return the correlation of both shares over the groups that they have in common, 0 where one does not vary.

    A positive one is corrected for continuity, as Newcombe does for pairs of answers (1998, Statistics in Medicine 17,
    2635-2650, method 10): a few groups that agree exactly leave some doubt.
    """
    rates = [
        dict(zip(np.unique(np.asarray(groups)).tolist(), sums[:, 0] - sums[:, 1] * answers.mean(), strict=True))
        for groups, (answers, sums) in (
            (first_groups, _by_group(first, first_groups)),
            (second_groups, _by_group(second, second_groups)),
        )
    ]
    apart = np.array([[part.get(group, 0.0) for part in rates] for group in sorted(set(rates[0]) | set(rates[1]))])
    lengths = float(np.sqrt(np.prod((apart**2).sum(axis=0))))
    together = float(np.prod(apart, axis=1).sum())
    return (max(together - 0.5, 0.0) if together > 0 else together) / lengths if lengths > 0 else 0.0
