"""Predictions of each person by the others, with scaling, PCA and trait axis refitted: exact, without the refits."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import TransformerMixin
from sklearn.decomposition import PCA
from sklearn.pipeline import Pipeline

from eigenwalker.model._folds import Batch, Fold, leave_out_persons
from eigenwalker.model._principal import inverse_squares
from eigenwalker.model._sample import Reduction, Sample, take_components, take_labels, take_sample
from eigenwalker.model.scaling import BlockScaler

__all__ = ["loo_matrix", "loo_predict", "matrix_of_others", "predict_by_others"]


def loo_predict(
    vectors: object,
    y: object,
    *,
    n_components: int | Iterable[int] | None = 15,
    scaling: str | None = None,
    groups: ArrayLike | None = None,
    n_scalars: int | None = None,
    linearizer: TransformerMixin | None = None,
) -> NDArray[np.float64]:
    """Return the labels that are predicted for each person by all others.

    Scaling, PCA and least squares (Troje 2002, Eq. 5) are fitted without the person. The result is that of
    `cross_val_predict` with the steps of `make_eigenwalkers` and a `TraitRegressor`, to rounding; fitting the PCA on
    everybody instead leaks. No fold is fitted anew where what it lacks is a change of low rank: with ``scaling`` None
    and "blocks". With "features" and "noise" each fold takes one symmetric eigenproblem.

    Parameters
    ----------
    vectors : array-like of shape (n_walks, n_features), or list of Walk
        Feature vectors, or walks beside a `linearizer`.
    y : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_traits)
        Labels, as for `TraitRegressor`: numbers, or two words, which count as -1 and +1 in alphabetical order. A walk
        without a label (NaN) counts for the PCA alone; it is predicted like the others.
    n_components : int, sequence of int or None, default 15
        How many Eigenwalkers. None is every number from 1 to the rank.
    scaling : {"blocks", "features", "noise", None}, default None
        `BlockScaler`: what is brought to one scale before PCA.
    groups : array-like of shape (n_walks,), default None
        Which person each walk is of; all walks of a person are left out together. None takes each walk for a person.
    n_scalars : int, default None
        Of `BlockScaler`. None is 1, the frequency, and one more for each of the linearizer's extras.
    linearizer : FourierLinearizer, default None
        Turns walks into vectors, once: it learns nothing across walks.

    Returns
    -------
    ndarray of shape (n_walks,) or (n_walks, n_traits)
        As `y` is. With several numbers of components one such array each, shape (n_numbers, ...).

    Raises
    ------
    ValueError
        If there are fewer than three persons, a number of components is out of range, or a label is missing for all
        others.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import loo_predict
    >>> vectors = np.arange(4.0)[:, np.newaxis] * [1.0, 2.0]
    >>> loo_predict(vectors, [0.0, 1.0, 2.0, 3.0], n_components=1).round(6) + 0
    array([0., 1., 2., 3.])
    """
    sample = take_sample(vectors, groups, scaling, n_scalars=n_scalars, linearizer=linearizer)
    labels = take_labels(y, len(sample.vectors))
    numbers = take_components(n_components, sample)
    reduction = Reduction(int(numbers.max()), scaling, sample.n_scalars)
    predicted = predict_by_others(sample, labels.codes, reduction, numbers)
    predicted = predicted[..., 0] if labels.is_single else predicted
    return predicted[0] if isinstance(n_components, int | np.integer) else predicted


def loo_matrix(
    vectors: object,
    reduction: TransformerMixin | None = None,
    groups: ArrayLike | None = None,
    *,
    n_components: int | Iterable[int] | None = 15,
    scaling: str | None = None,
    n_scalars: int | None = None,
    linearizer: TransformerMixin | None = None,
) -> NDArray[np.float64]:
    """Return the matrix M that turns labels into their leave-one-out predictions, M y.

    All of `loo_predict` is linear in the labels, so that one matrix serves every trait and every permutation.

    Parameters
    ----------
    vectors : array-like of shape (n_walks, n_features), or list of Walk
        See `loo_predict`.
    reduction : PCA or Pipeline, default None
        The steps of a model between linearizer and trait, ``model[1:-1]``, in place of the arguments that follow
        `groups`: a PCA, after a `BlockScaler` or none. They need not be fitted.
    groups : array-like of shape (n_walks,), default None
        Which person each walk is of.
    n_components, scaling, n_scalars, linearizer
        See `loo_predict`.

    Returns
    -------
    ndarray of shape (n_walks, n_walks)
        Zero where both walks are of one person. With several numbers of components one matrix each, shape
        (n_numbers, n_walks, n_walks).

    Raises
    ------
    ValueError
        As `loo_predict`, or if `reduction` has other steps.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import loo_matrix
    >>> vectors = np.arange(4.0)[:, np.newaxis] * [1.0, 2.0]
    >>> (loo_matrix(vectors, n_components=1) @ [0.0, 1.0, 2.0, 3.0]).round(6) + 0
    array([0., 1., 2., 3.])
    """
    tolerance = Reduction._field_defaults["tolerance"]
    if reduction is not None:
        n_components, scaling, n_scalars, tolerance = _settings_of(reduction)
    sample = take_sample(vectors, groups, scaling, n_scalars=n_scalars, linearizer=linearizer)
    numbers = take_components(n_components, sample)
    settings = Reduction(int(numbers.max()), scaling, sample.n_scalars, tolerance)
    matrices = matrix_of_others(sample, settings, numbers)
    return matrices[0] if isinstance(n_components, int | np.integer) else matrices


def _settings_of(reduction: TransformerMixin) -> tuple[int, str | None, int, float]:
    steps = [step for _, step in reduction.steps] if isinstance(reduction, Pipeline) else [reduction]
    scaler = steps[0] if isinstance(steps[0], BlockScaler) and len(steps) == 2 else None
    if not isinstance(steps[-1], PCA) or len(steps) != (1 if scaler is None else 2):
        listed = ", ".join(type(step).__name__ for step in steps)
        raise ValueError(f"reduction must be a PCA, after a BlockScaler or none, got {listed}")
    n_components = steps[-1].n_components
    if not isinstance(n_components, int | np.integer):
        raise ValueError(f"the PCA's n_components must be a whole number, got {n_components!r}")
    if scaler is None:
        return int(n_components), None, 1, Reduction._field_defaults["tolerance"]
    return int(n_components), scaler.unit, scaler.n_scalars, scaler.tolerance


def predict_by_others(
    sample: Sample, codes: NDArray[np.float64], reduction: Reduction, numbers: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the predictions of every walk, shape (n_numbers, n_walks, n_traits); see `loo_predict`."""
    folds = leave_out_persons(sample, reduction)
    complete = ~np.isnan(codes).any(axis=0)
    means = codes[:, complete].mean(axis=0)
    centered = codes[:, complete] - means
    moments = folds.coordinates.T @ centered  # (n_coordinates, n_traits)
    predicted = np.empty((len(numbers), *codes.shape))
    whole = predicted if complete.all() else np.empty((len(numbers), *centered.shape))
    singly = sample.n_persons == len(sample.persons)
    for batch in folds.batches:
        if singly and complete.any():
            walks = np.concatenate(batch.left_out)
            rows, removed = folds.coordinates[walks], centered[walks]
            whole[:, walks] = _predict_singly(batch, rows, removed, moments, numbers, len(codes))
        if singly and complete.all():
            continue
        for fold in batch.folds(folds.coordinates):
            if complete.any() and not singly:
                whole[:, fold.left_out] = _predict_persons(fold, folds.coordinates, centered, moments, numbers)
            for trait in np.flatnonzero(~complete):
                labels = codes[:, trait]
                predicted[:, fold.left_out, trait] = _predict_partial(fold, folds.coordinates, labels, numbers)
    predicted[..., complete] = whole + means
    return predicted


def _predict_persons(
    fold: Fold,
    coordinates: NDArray[np.float64],
    labels: NDArray[np.float64],
    moments: NDArray[np.float64],
    numbers: NDArray[np.intp],
) -> NDArray[np.float64]:
    """Return mean + sum_j score_j (axis_j . moment) / square_j of the others, shape (n_numbers, n_left_out, n_traits).

    `labels` are centered over all walks, and `moments` are their products with all coordinates: the person's share is
    taken out.
    """
    rows, removed = coordinates[fold.left_out], labels[fold.left_out]
    total = removed.sum(axis=0)
    moment = moments - rows.T @ removed + np.multiply.outer(fold.center, total)
    scores = (rows - fold.center) @ fold.axes.T  # (n_left_out, n_axes)
    slopes = (fold.axes @ moment) * inverse_squares(fold.squares, len(fold.others))[:, np.newaxis]  # (n_axes, n_traits)
    steps = scores.T[:, :, np.newaxis] * slopes[:, np.newaxis]  # (n_axes, n_left_out, n_traits)
    return np.cumsum(steps, axis=0)[np.minimum(numbers, len(steps)) - 1] - total / len(fold.others)


def _predict_singly(
    batch: Batch,
    rows: NDArray[np.float64],
    removed: NDArray[np.float64],
    moments: NDArray[np.float64],
    numbers: NDArray[np.intp],
    n_walks: int,
) -> NDArray[np.float64]:
    """Return the same for many persons with one walk each, shape (n_numbers, n_persons, n_traits)."""
    factor = n_walks / (n_walks - 1)  # a walk's distance from the mean of the others, over that from everybody's
    along = (batch.axes @ rows[:, :, np.newaxis])[..., 0]  # (n_persons, n_axes)
    slopes = batch.axes @ moments - factor * along[:, :, np.newaxis] * removed[:, np.newaxis]
    weights = factor * along * inverse_squares(batch.squares, n_walks - 1)
    steps = weights[:, :, np.newaxis] * slopes  # (n_persons, n_axes, n_traits)
    predicted = np.cumsum(steps, axis=1)[:, np.minimum(numbers, steps.shape[1]) - 1]
    return predicted.transpose(1, 0, 2) - removed / (n_walks - 1)


def _predict_partial(
    fold: Fold, coordinates: NDArray[np.float64], labels: NDArray[np.float64], numbers: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the predictions of one trait by those of the others who have a label, shape (n_numbers, n_left_out)."""
    known = fold.others[~np.isnan(labels[fold.others])]
    if not len(known):
        raise ValueError("expected a label for at least one walk beside those left out, got none but missing ones")
    design = _design(coordinates[known], fold)
    target = _design(coordinates[fold.left_out], fold)
    return np.stack(
        [target[:, : 1 + number] @ np.linalg.lstsq(design[:, : 1 + number], labels[known])[0] for number in numbers]
    )


def _design(coordinates: NDArray[np.float64], fold: Fold) -> NDArray[np.float64]:
    """Return a column of ones beside the scores."""
    return np.column_stack((np.ones(len(coordinates)), (coordinates - fold.center) @ fold.axes.T))


def matrix_of_others(
    sample: Sample, reduction: Reduction, numbers: NDArray[np.intp], known: NDArray[np.bool_] | None = None
) -> NDArray[np.float64]:
    """Return the matrices of `loo_matrix`, shape (n_numbers, n_walks, n_walks).

    Parameters
    ----------
    sample, reduction
        What is left out of, and what is fitted.
    numbers : ndarray of int
        Of components.
    known : ndarray of shape (n_walks,), default None
        Which walks have a label; the columns of the others are zero. None is all.
    """
    folds = leave_out_persons(sample, reduction)
    coordinates = folds.coordinates
    matrices = np.zeros((len(numbers), len(coordinates), len(coordinates)))
    weights = np.zeros((len(numbers), *coordinates.shape))  # of each coordinate in the prediction of each walk
    for batch in folds.batches:
        for fold in batch.folds(coordinates):
            if known is not None and not known.all():
                _fill_partial(matrices, fold, coordinates, known, numbers)
                continue
            inverses = inverse_squares(fold.squares, len(fold.others))
            scores = (coordinates[fold.left_out] - fold.center) @ fold.axes.T * inverses
            for weight, number in zip(weights, numbers, strict=True):
                weight[fold.left_out] = scores[:, :number] @ fold.axes[:number]
            matrices[:, fold.left_out] = 1.0 / len(fold.others) - (weights[:, fold.left_out] @ fold.center)[..., None]
    if known is None or known.all():
        matrices += weights @ coordinates.T
        matrices[:, sample.persons[:, np.newaxis] == sample.persons] = 0.0
    return matrices


def _fill_partial(
    matrices: NDArray[np.float64],
    fold: Fold,
    coordinates: NDArray[np.float64],
    known: NDArray[np.bool_],
    numbers: NDArray[np.intp],
) -> None:
    columns = fold.others[known[fold.others]]
    design, target = _design(coordinates[columns], fold), _design(coordinates[fold.left_out], fold)
    for matrix, number in zip(matrices, numbers, strict=True):
        inverse = np.linalg.lstsq(design[:, : 1 + number], np.eye(len(columns)))[0]
        matrix[np.ix_(fold.left_out, columns)] = target[:, : 1 + number] @ inverse
