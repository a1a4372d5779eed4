"""Means of scores, with intervals that know which answers belong together."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from eigenwalker.experiment.analysis.rates import Estimated

__all__ = ["mean_interval"]


def mean_interval(values: ArrayLike, groups: ArrayLike | None = None, *, level: float = 0.95) -> Estimated:
    r"""Return the mean of scores with the interval of Student's t.

    Scores that one person gives are alike: the variance of the mean m of n scores is that of their groups,

    .. math:: V = \frac{G}{G - 1} \frac{\sum_g \left(\sum_{i \in g} (x_i - m)\right)^2}{n^2}

    of G groups, and t has G - 1 degrees of freedom. Where groups differ less than chance lets them, V is taken to be
    that of independent scores, which is also what groups of one score each have: the standard deviation squared over n.

    Parameters
    ----------
    values : array-like of float of shape (n_answers,)
        Scores.
    groups : array-like of shape (n_answers,), default None
        To which person, or walk, a score belongs. None: every score stands for itself.
    level : float, default 0.95
        Of confidence, between 0 and 1.

    Returns
    -------
    Estimated
        A single score, or group, leaves the interval open, from minus to plus infinity; NaN if there are no scores.

    Raises
    ------
    ValueError
        If a score is missing or infinite, there is not one group a score, or the level is not between 0 and 1.

    Examples
    --------
    >>> [round(part, 2) for part in mean_interval([4, 3, 4, 2])]
    [3.25, 1.73, 4.77]
    >>> [round(part, 2) for part in mean_interval([4, 4, 2, 2, 3, 3], groups=[1, 1, 2, 2, 3, 3])]
    [3.0, 0.52, 5.48]
    """
    scores, numbers = _by_group(values, groups)
    if not 0 < level < 1:
        raise ValueError(f"level must be between 0 and 1, got {level!r}")
    if not len(scores):
        return Estimated(*[float("nan")] * 3)
    mean, n_groups = float(scores.mean()), int(numbers.max()) + 1
    if n_groups == 1:
        return Estimated(mean, -np.inf, np.inf)
    sums = np.bincount(numbers, scores - mean)
    grouped = n_groups / (n_groups - 1) * float((sums**2).sum()) / len(scores) ** 2
    variance = max(grouped, float(scores.var(ddof=1)) / len(scores))
    half = float(stdtrit(n_groups - 1, (1 + level) / 2) * np.sqrt(variance))
    return Estimated(mean, mean - half, mean + half)


def _by_group(values: ArrayLike, groups: ArrayLike | None) -> tuple[np.ndarray, np.ndarray]:
    scores = np.asarray(values, dtype=np.float64)
    numbers = np.arange(len(scores)) if groups is None else np.unique(np.asarray(groups), return_inverse=True)[1]
    if scores.ndim != 1 or numbers.shape != scores.shape:
        raise ValueError(f"expected one group a score, got {numbers.shape} groups of {scores.shape} scores")
    missing = int((~np.isfinite(scores)).sum())
    if missing:
        raise ValueError(f"expected finite scores, got {missing} missing or infinite ones; leave them out")
    return scores, numbers
