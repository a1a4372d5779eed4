"""The whole model on persons drawn again: those drawn twice count twice."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.model._control import free_directions, take_out, unit_columns
from eigenwalker.model._folds import Fold, leave_out_persons
from eigenwalker.model._persons import mean_by_person
from eigenwalker.model._principal import inverse_squares, principal_axes
from eigenwalker.model._sample import Reduction, Sample
from eigenwalker.model.scaling import BlockScaler, feature_scales

__all__ = [
    "WeightedFit",
    "feature_axes",
    "fit_weighted",
    "fit_without_each",
    "midpoints_without_each",
    "predict_weighted",
    "varies",
]


class WeightedFit(NamedTuple):
    """Scales and Eigenwalkers of some persons, and their trait axes.

    Parameters
    ----------
    mean, scales : ndarray of shape (n_features,)
        Of the features.
    axes : ndarray of shape (n_components, n_features)
        Eigenwalkers, of scaled features.
    variances : ndarray of shape (n_components,)
        Of the scores.
    filters : ndarray of shape (n_traits, n_components)
        C of Troje 2002, Eq. 5.
    intercept : ndarray of shape (n_traits,)
        Predicted label of the average walker.
    spread : ndarray of shape (n_traits,)
        SD of the displacement over persons.
    """

    mean: NDArray[np.float64]
    scales: NDArray[np.float64]
    axes: NDArray[np.float64]
    variances: NDArray[np.float64]
    filters: NDArray[np.float64]
    intercept: NDArray[np.float64]
    spread: NDArray[np.float64]


def fit_weighted(
    sample: Sample, codes: NDArray[np.float64], counts: NDArray[np.intp], reduction: Reduction
) -> WeightedFit:
    """Fit scaler, PCA and trait axes to persons of whom each counts `counts` times, as if they were as many persons."""
    walks = np.flatnonzero(counts[sample.persons])
    weights = counts[sample.persons[walks]].astype(np.float64)
    vectors, total = sample.vectors[walks], weights.sum()
    mean = weights @ vectors / total
    centered = vectors - mean
    scales = _learn_scales(sample, walks, counts, reduction, weights @ centered**2 / total)
    scaled, roots = centered / scales, np.sqrt(weights)[:, np.newaxis]
    squares, axes = principal_axes(scaled * roots, min(reduction.n_components, int(total) - 1))
    scores = scaled @ axes.T
    intercept, filters = _fit_traits(scores, codes[walks], weights, squares, sample.controls[walks])
    spread = _spread(scores @ filters.T, sample.persons[walks], counts)
    return WeightedFit(mean, scales, axes, squares / (total - 1), filters, intercept, spread)


def _learn_scales(
    sample: Sample,
    walks: NDArray[np.intp],
    counts: NDArray[np.intp],
    reduction: Reduction,
    variances: NDArray[np.float64],
) -> NDArray[np.float64]:
    if reduction.scaling is None:
        return 1.0 / sample.weights
    options: dict[str, Any] = {"n_scalars": sample.n_scalars, "unit": reduction.scaling, "weights": sample.weights}
    if reduction.scaling != "noise":
        tolerance = BlockScaler().tolerance
        return feature_scales(sample.vectors[walks], np.sqrt(variances), tolerance=tolerance, **options)
    repeated = np.repeat(walks, counts[sample.persons[walks]])
    # Copies of a person are as many persons: copy c of person q has the number c n_persons + q.
    copies = np.concatenate([np.arange(count) for count in counts[sample.persons[walks]]])
    return (
        BlockScaler(**options)
        .fit(sample.vectors[repeated], groups=copies * len(counts) + sample.persons[repeated])
        .scale_
    )


def _fit_traits(
    scores: NDArray[np.float64],
    codes: NDArray[np.float64],
    weights: NDArray[np.float64],
    squares: NDArray[np.float64],
    controls: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return intercept, shape (n_traits,), and filters, shape (n_traits, n_components), each from labelled walks."""
    known, roots = ~np.isnan(codes), np.sqrt(weights)
    controls = unit_columns(controls, weights)
    weighted = scores * roots[:, np.newaxis]
    if known.all():  # scores are uncorrelated
        intercept = weights @ codes / weights.sum()
        inverses = np.sqrt(inverse_squares(squares, int(weights.sum())))[:, np.newaxis]
        moments = weighted.T @ (roots[:, np.newaxis] * (codes - intercept))
        return intercept, (take_out(moments * inverses, weighted.T @ controls * inverses) * inverses).T
    free = free_directions(weighted, controls)
    design = np.column_stack((np.ones(len(scores)), scores @ free))
    solutions = np.stack(
        [
            np.linalg.lstsq(design[k] * roots[k, np.newaxis], column[k] * roots[k])[0]
            for column, k in zip(codes.T, known.T, strict=True)
        ]
    )
    return solutions[:, 0], solutions[:, 1:] @ free.T


def _spread(
    displacements: NDArray[np.float64], persons: NDArray[np.intp], counts: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the SD over persons, shape (n_traits,), of whom each counts as often as drawn."""
    drawn, numbers = np.unique(persons, return_inverse=True)
    means, weights = mean_by_person(displacements, numbers), counts[drawn].astype(np.float64)
    centered = means - weights @ means / weights.sum()
    return np.sqrt(np.asarray(weights @ centered**2 / max(weights.sum() - 1, 1.0), dtype=np.float64))


class _Others(NamedTuple):
    """A fold with the others' scores, shape (n_others, n_components), and the axes learned from them."""

    fold: Fold
    scores: NDArray[np.float64]
    intercept: NDArray[np.float64]
    filters: NDArray[np.float64]


def _learn_without_each(sample: Sample, codes: NDArray[np.float64], reduction: Reduction) -> Iterator[_Others]:
    folds = leave_out_persons(sample, reduction)
    for batch in folds.batches:
        for fold in batch.folds(folds.coordinates):
            scores = (folds.coordinates[fold.others] - fold.center) @ fold.axes.T
            ones, controls = np.ones(len(fold.others)), sample.controls[fold.others]
            intercept, filters = _fit_traits(scores, codes[fold.others], ones, fold.squares, controls)
            yield _Others(fold, scores, intercept, filters)


def fit_without_each(sample: Sample, codes: NDArray[np.float64], reduction: Reduction) -> Iterator[WeightedFit]:
    """Yield the fit without each person in turn, from `leave_out_persons`; the scales are within the axes."""
    for fold, scores, intercept, filters in _learn_without_each(sample, codes, reduction):
        vectors, n_others = sample.vectors[fold.others], len(fold.others)
        mean = vectors.mean(axis=0)
        everybody = np.ones(sample.n_persons, dtype=np.intp)
        spread = _spread(scores @ filters.T, sample.persons[fold.others], everybody)
        # What a score of 1 changes in the features: their covariance with it over its variance.
        axes = scores.T @ (vectors - mean) * inverse_squares(fold.squares, n_others)[:, np.newaxis]
        variances = fold.squares / (n_others - 1)
        yield WeightedFit(mean, np.ones(len(mean)), axes, variances, filters, intercept, spread)


def midpoints_without_each(sample: Sample, codes: NDArray[np.float64], reduction: Reduction) -> NDArray[np.float64]:
    """Return midway between the groups' mean fitted labels among the others, shape (n_walks, n_traits).

    It is the boundary of ``TraitClassifier(boundary="midpoint")`` without each person in turn; for traits coded -1, +1.
    """
    midpoints = np.empty_like(codes)
    for fold, scores, intercept, filters in _learn_without_each(sample, codes, reduction):
        fitted, others = intercept + scores @ filters.T, codes[fold.others]
        means = [np.where(others == code, fitted, 0.0).sum(axis=0) / (others == code).sum(axis=0) for code in (-1, 1)]
        midpoints[fold.left_out] = (means[0] + means[1]) / 2
    return midpoints


def predict_weighted(fit: WeightedFit, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return predicted labels, shape (n_walks, n_traits)."""
    return fit.intercept + (vectors - fit.mean) / fit.scales @ fit.axes.T @ fit.filters.T


def feature_axes(fit: WeightedFit, direction: str) -> NDArray[np.float64]:
    """Return what alpha = 1, one SD of each trait over persons, changes in each feature, shape (n_traits, n_features).

    The step of scores s with c . s = SD is Cov c / (c . Cov c) SD for "pattern" and c / (c . c) SD for "filter".
    """
    steps = fit.filters * fit.variances if direction == "pattern" else fit.filters
    products = (steps * fit.filters).sum(axis=1)
    lengths = np.divide(fit.spread, products, out=np.zeros_like(products), where=products > 0)
    return (steps * lengths[:, np.newaxis]) @ fit.axes * fit.scales


def varies(counts: NDArray[np.intp], persons: NDArray[np.intp], codes: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which rows of counts draw persons with two different labels of every trait."""
    drawn = counts[:, persons] > 0  # (n_rows, n_walks)
    lowest = [np.where(drawn & ~np.isnan(column), column, np.inf).min(axis=1) for column in codes.T]
    highest = [np.where(drawn & ~np.isnan(column), column, -np.inf).max(axis=1) for column in codes.T]
    return np.logical_and.reduce(np.array(lowest) < np.array(highest), axis=0)
