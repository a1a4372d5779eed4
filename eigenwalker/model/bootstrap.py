"""The bootstrap of trait axes over persons: what of an axis would other persons show as well."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, ndtri
from sklearn.base import TransformerMixin
from sklearn.utils import check_random_state

from eigenwalker._validation import check_choice
from eigenwalker.model._axes import DIRECTIONS
from eigenwalker.model._resampling import feature_axes, fit_weighted, fit_without_each, varies
from eigenwalker.model._sample import Reduction, Sample, control_sample, take_labels, take_reduction, take_sample

__all__ = ["BootstrapResult", "bootstrap_axes"]

_MOST_DRAWS = 100


class BootstrapResult(NamedTuple):
    """What `bootstrap_axes` returns. With y of shape (n_walks,) there is no axis of traits.

    Parameters
    ----------
    axes : ndarray of shape (n_traits, n_features)
        What one SD of each trait changes in each feature, in the feature's own unit.
    low, high : ndarray of shape (n_traits, n_features)
        Ends of the interval of each feature.
    cosines : ndarray of shape (n_resamples, n_traits)
        Between the axis of all persons and that of each resample, with features over their scales: 1 is the same
        direction.
    stability : ndarray of shape (n_traits,)
        Median of the cosines.
    """

    axes: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    cosines: NDArray[np.float64]
    stability: NDArray[np.float64]


def bootstrap_axes(
    vectors: object,
    y: object,
    *,
    n_components: int = 15,
    scaling: str | None = None,
    groups: ArrayLike | None = None,
    control: ArrayLike | None = None,
    direction: str = "pattern",
    level: float = 0.95,
    n_resamples: int = 1000,
    random_state: int | np.random.RandomState | None = None,
    n_jobs: int | None = None,
    n_scalars: int | None = None,
    weights: Mapping[str, float] | ArrayLike | None = None,
    linearizer: TransformerMixin | None = None,
) -> BootstrapResult:
    """Return how stable trait axes are when persons are drawn again, with replacement.

    Scaling, PCA and least squares are fitted to each resample. The intervals are bias-corrected and accelerated (BCa,
    Efron 1987): with G the normal distribution, z0 = G^-1 of the share of resamples below the estimate, and a the
    skewness of the estimates with one person left out over 6, the ends are the quantiles at

    G(z0 + (z0 + z) / (1 - a (z0 + z))),  z = G^-1((1 - level) / 2) and G^-1((1 + level) / 2).

    Parameters
    ----------
    vectors : array-like of shape (n_walks, n_features), or list of Walk
        See `loo_predict`.
    y : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_traits)
        Labels; see `loo_predict`.
    n_components : int, default 15
        How many Eigenwalkers.
    scaling, groups, control
        See `loo_predict`. A person is drawn with all walks; one drawn twice counts as two persons.
    direction : {"pattern", "filter"}, default "pattern"
        Which axis; see `TraitRegressor`.
    level : float, default 0.95
        Of the intervals of each feature, one by one.
    n_resamples : int, default 1000
        Resamples in which all are of one label are drawn again.
    random_state : int, RandomState or None, default None
        Seed of the draws.
    n_jobs : int, default None
        Processes, as joblib counts them. The result does not depend on it.
    n_scalars, weights, linearizer
        See `loo_predict`.

    Returns
    -------
    BootstrapResult

    Raises
    ------
    ValueError
        If an argument is out of range, or hardly a resample has two different labels.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import bootstrap_axes
    >>> random = np.random.default_rng(0)
    >>> weight = random.normal(size=40)
    >>> vectors = random.normal(size=(40, 3)) * [2.0, 1.0, 1.0] + weight[:, np.newaxis] * [4.0, 0.0, 0.0]
    >>> result = bootstrap_axes(vectors, weight, n_components=2, n_resamples=200, random_state=0)
    >>> bool(result.low[0] > 0), bool(result.stability > 0.95)
    (True, True)
    """
    check_choice(direction, DIRECTIONS, name="direction")
    if not 0 < level < 1:
        raise ValueError(f"level must be between 0 and 1, got {level!r}")
    if n_resamples < 2:
        raise ValueError(f"n_resamples must be at least 2, got {n_resamples!r}")
    sample = take_sample(vectors, groups, scaling, n_scalars=n_scalars, weights=weights, linearizer=linearizer)
    labels = take_labels(y, len(sample.vectors))
    sample = control_sample(sample, control, labels)
    reduction = take_reduction(n_components, scaling, sample)
    draws = _draw(sample, labels.codes, n_resamples, check_random_state(random_state))
    whole = fit_weighted(sample, labels.codes, np.ones(sample.n_persons, dtype=np.intp), reduction)
    estimate = feature_axes(whole, direction)
    jackknife = np.stack([feature_axes(fit, direction) for fit in fit_without_each(sample, labels.codes, reduction)])
    parts = np.array_split(draws, max(1, n_resamples // 50))
    found = Parallel(n_jobs=n_jobs)(delayed(_fit_each)(sample, labels.codes, p, reduction, direction) for p in parts)
    resampled = np.concatenate(found)  # (n_resamples, n_traits, n_features)
    low, high = bca_interval(estimate, resampled, jackknife, level)
    cosines = _cosines(resampled, estimate, whole.scales)
    estimate, low, high = (_among_all(values, sample.kept) for values in (estimate, low, high))
    result = BootstrapResult(estimate, low, high, cosines, np.median(cosines, axis=0))
    if not labels.is_single:
        return result
    return BootstrapResult(estimate[0], low[0], high[0], cosines[:, 0], result.stability[0])


def _among_all(values: NDArray[np.float64], kept: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return values of all features, 0 for those that are left out."""
    everything = np.zeros((len(values), len(kept)))
    everything[:, kept] = values
    return everything


def _draw(
    sample: Sample, codes: NDArray[np.float64], n_resamples: int, random: np.random.RandomState
) -> NDArray[np.intp]:
    """Return how often each person is drawn, shape (n_resamples, n_persons)."""
    counts = np.empty((n_resamples, sample.n_persons), dtype=np.intp)
    wanted = np.arange(n_resamples)
    for _ in range(_MOST_DRAWS):
        drawn = random.randint(sample.n_persons, size=(len(wanted), sample.n_persons))
        counts[wanted] = [np.bincount(row, minlength=sample.n_persons) for row in drawn]
        wanted = wanted[~varies(counts[wanted], sample.persons, codes)]
        if not len(wanted):
            return counts
    raise ValueError(
        f"expected resamples with two different labels of every trait, got {len(wanted)} of {n_resamples} without in "
        f"{_MOST_DRAWS} attempts; too few persons have a label, or all but a few the same"
    )


def _fit_each(
    sample: Sample, codes: NDArray[np.float64], counts: NDArray[np.intp], reduction: Reduction, direction: str
) -> NDArray[np.float64]:
    """Return the axes of each resample, shape (n_resamples, n_traits, n_features)."""
    return np.stack([feature_axes(fit_weighted(sample, codes, row, reduction), direction) for row in counts])


def _cosines(
    resampled: NDArray[np.float64], estimate: NDArray[np.float64], scales: NDArray[np.float64]
) -> NDArray[np.float64]:
    one, other = resampled / scales, estimate / scales
    products = (one * other).sum(axis=-1)
    lengths = np.linalg.norm(one, axis=-1) * np.linalg.norm(other, axis=-1)
    return np.divide(products, lengths, out=np.zeros_like(products), where=lengths > 0)


def bca_interval(
    estimate: NDArray[np.float64], resampled: NDArray[np.float64], jackknife: NDArray[np.float64], level: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ends of BCa intervals.

    Parameters
    ----------
    estimate : ndarray of any shape
        From all persons.
    resampled : ndarray of shape (n_resamples, ...)
        From each resample.
    jackknife : ndarray of shape (n_persons, ...)
        From all persons but one.
    level : float
        Between 0 and 1.

    Returns
    -------
    low, high : ndarray
        In the shape of `estimate`.
    """
    n_resamples = len(resampled)
    below = np.mean(resampled < estimate, axis=0) + np.mean(resampled == estimate, axis=0) / 2
    bias = ndtri(np.clip(below, 0.5 / n_resamples, 1 - 0.5 / n_resamples))
    deviations = jackknife.mean(axis=0) - jackknife
    squares = (deviations**2).sum(axis=0)
    skewness = np.divide((deviations**3).sum(axis=0), squares**1.5, out=np.zeros_like(squares), where=squares > 0)
    ordered = np.sort(resampled, axis=0)
    ends = []
    for tail in ((1 - level) / 2, (1 + level) / 2):
        shifted = bias + ndtri(tail)
        place = ndtr(bias + shifted / (1 - skewness / 6 * shifted)) * (n_resamples - 1)
        lower = np.floor(place).astype(np.intp)
        upper = np.minimum(lower + 1, n_resamples - 1)
        first, second = (np.take_along_axis(ordered, at[np.newaxis], axis=0)[0] for at in (lower, upper))
        ends.append(first + (place - lower) * (second - first))
    return ends[0], ends[1]
