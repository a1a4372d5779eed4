"""Confidence intervals of accuracies, of areas under the curve, and of correlations."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ndtri

from eigenwalker._validation import check_choice
from eigenwalker.model._scores import SCORES, TWO_VALUED_SCORES, score_columns

__all__ = ["score_interval", "wilson_interval"]

Interval = tuple[float, float]
_INWARD = 1e-9


def score_interval(
    predicted: NDArray[np.float64], labels: NDArray[np.float64], score: str, *, level: float = 0.95
) -> Interval:
    """Return a confidence interval of a score.

    - "accuracy": Wilson's interval of a share.
    - "balanced_accuracy": from the Wilson intervals of both shares (Newcombe 1998, method 10, for half their sum).
    - "auc": the areas from which the one seen is no further than so many of their own standard errors (Newcombe 2006,
      method 5), with the standard error of Hanley and McNeil (1982).
    - "r": Fisher's transformation; 3 persons or fewer leave it open.

    An accuracy or an area of 1 is no certainty: its interval ends there, but begins below. Predictions are taken for
    independent of each other; those of persons left out in turn nearly are.

    Parameters
    ----------
    predicted, labels : ndarray of shape (n_persons,)
        Predictions and labels; -1 and +1 for all scores but "r".
    score : {"accuracy", "balanced_accuracy", "auc", "r"}
        Which score; see `permutation_test`.
    level : float, default 0.95
        Between 0 and 1.

    Returns
    -------
    low, high : float
        NaN where the score is not defined.

    Raises
    ------
    ValueError
        If there is not one prediction a label, if values are missing, or if labels are others than the score is for.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import score_interval
    >>> labels = np.repeat([-1.0, 1.0], 10)
    >>> low, high = score_interval(labels, labels, "accuracy")
    >>> round(low, 2), round(high, 2)
    (0.84, 1.0)
    """
    check_choice(score, tuple(SCORES), name="score")
    if not 0 < level < 1:
        raise ValueError(f"level must be between 0 and 1, got {level!r}")
    predicted, labels = (np.asarray(values, dtype=np.float64) for values in (predicted, labels))
    _check(predicted, labels, score)
    value = float(score_columns(predicted[:, np.newaxis], labels[:, np.newaxis], score)[0])
    if not np.isfinite(value):
        return float("nan"), float("nan")
    return _INTERVALS[score](value, predicted, labels, float(ndtri((1 + level) / 2)))


def _check(predicted: NDArray[np.float64], labels: NDArray[np.float64], score: str) -> None:
    if predicted.ndim != 1 or predicted.shape != labels.shape or not len(labels):
        raise ValueError(f"expected one prediction and one label a person, got {predicted.shape} and {labels.shape}")
    if not np.isfinite([predicted, labels]).all():
        raise ValueError("expected predictions and labels of all persons, got missing or infinite ones; leave them out")
    if score in TWO_VALUED_SCORES and not np.isin(labels, (-1.0, 1.0)).all():
        raise ValueError(f"score={score!r} needs labels of -1 and +1, got others; use score='r' for numbers")


def wilson_interval(share: float, n_trials: float, z: float) -> Interval:
    """Return Wilson's interval (1927) of a share of right answers, `z` standard errors to either side.

    Parameters
    ----------
    share : float
        That was seen, 0 to 1.
    n_trials : float
        Number of answers; not a whole one where answers depend on each other.
    z : float
        1.96 for an interval of 95 %.
    """
    middle = share + z**2 / (2 * n_trials)
    half = z * np.sqrt(share * (1 - share) / n_trials + z**2 / (4 * n_trials**2))
    scale = 1 + z**2 / n_trials
    low, high = float((middle - half) / scale), float((middle + half) / scale)
    return max(0.0, min(low, share)), min(1.0, max(high, share))  # but for rounding the share is within


def _accuracy(value: float, predicted: NDArray[np.float64], labels: NDArray[np.float64], z: float) -> Interval:
    return wilson_interval(value, len(labels), z)


def _balanced_accuracy(value: float, predicted: NDArray[np.float64], labels: NDArray[np.float64], z: float) -> Interval:
    below, above = 0.0, 0.0
    for group in (labels > 0, labels < 0):
        share = float(np.mean(predicted[group] * labels[group] > 0))
        low, high = wilson_interval(share, int(group.sum()), z)
        below, above = below + (share - low) ** 2, above + (high - share) ** 2
    return value - float(np.sqrt(below)) / 2, value + float(np.sqrt(above)) / 2


def _area(value: float, predicted: NDArray[np.float64], labels: NDArray[np.float64], z: float) -> Interval:
    n_positive, n_negative = int((labels > 0).sum()), int((labels < 0).sum())

    def distance(area: float) -> float:
        """Return how many squared standard errors the area seen is away, less those that are allowed."""
        larger = (n_positive + n_negative) / 2 - 1
        spread = 1 + larger * (1 - area) / (2 - area) + larger * area / (1 + area)
        return (value - area) ** 2 - z**2 * area * (1 - area) * spread / (n_positive * n_negative)

    # At its own place the area seen is within, unless the standard error is 0 there.
    low = 0.0 if value <= 0 else float(brentq(distance, 0.0, min(value, 1 - _INWARD)))
    high = 1.0 if value >= 1 else float(brentq(distance, max(value, _INWARD), 1.0))
    return low, high


def _correlation(value: float, predicted: NDArray[np.float64], labels: NDArray[np.float64], z: float) -> Interval:
    if len(labels) <= 3:
        return -1.0, 1.0
    center, half = np.arctanh(np.clip(value, -1 + 1e-12, 1 - 1e-12)), z / np.sqrt(len(labels) - 3)
    return float(np.tanh(center - half)), float(np.tanh(center + half))


_INTERVALS: dict[str, Callable[[float, NDArray[np.float64], NDArray[np.float64], float], Interval]] = {
    "accuracy": _accuracy,
    "balanced_accuracy": _balanced_accuracy,
    "auc": _area,
    "r": _correlation,
}
