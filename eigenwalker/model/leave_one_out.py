"""Predictions of each person by the others, with scaling, PCA and trait axis refitted: exact, without the refits."""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import solve_triangular
from sklearn.base import TransformerMixin

from eigenwalker.model._control import free_directions, take_controls, take_out, unit_columns
from eigenwalker.model._folds import Fold, leave_out_persons
from eigenwalker.model._principal import inverse_squares
from eigenwalker.model._sample import (
    Reduction,
    Sample,
    control_sample,
    take_components,
    take_labels,
    take_sample,
)

__all__ = ["loo_matrix", "loo_predict", "matrix_of_others", "predict_by_others"]

_SMALLEST_DIAGONAL = 1e-6  # over the largest; below, digits would be lost


def loo_predict(
    vectors: object,
    y: object,
    *,
    n_components: int | Iterable[int] | None = 15,
    scaling: str | None = None,
    groups: ArrayLike | None = None,
    control: ArrayLike | None = None,
    n_scalars: int | None = None,
    weights: Mapping[str, float] | ArrayLike | None = None,
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
        How many Eigenwalkers, more than controls. None is every number up to the rank.
    scaling : {"blocks", "features", "noise", None}, default None
        `BlockScaler`: what is brought to one scale before PCA.
    groups : array-like of shape (n_walks,), default None
        Which person each walk is of; all walks of a person are left out together. None takes each walk for a person.
    control : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_controls), default None
        What no axis may go along with among those it is learned from; see `TraitRegressor.fit`.
    n_scalars : int, default None
        Of `BlockScaler`. None is 1, the frequency, and one more for each of the linearizer's extras.
    weights : mapping of str to float or array-like of shape (n_features,), default None
        Of `BlockScaler`; see `block_weights`. Names need a linearizer or a DataFrame.
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
    sample = take_sample(vectors, groups, scaling, n_scalars=n_scalars, weights=weights, linearizer=linearizer)
    labels = take_labels(y, len(sample.vectors))
    sample = control_sample(sample, control, labels)
    numbers = take_components(n_components, sample)
    reduction = Reduction(int(numbers.max()), scaling)
    predicted = predict_by_others(sample, labels.codes, reduction, numbers)
    predicted = predicted[..., 0] if labels.is_single else predicted
    return predicted[0] if isinstance(n_components, int | np.integer) else predicted


def loo_matrix(
    vectors: object,
    *,
    n_components: int | Iterable[int] | None = 15,
    scaling: str | None = None,
    groups: ArrayLike | None = None,
    control: ArrayLike | None = None,
    n_scalars: int | None = None,
    weights: Mapping[str, float] | ArrayLike | None = None,
    linearizer: TransformerMixin | None = None,
) -> NDArray[np.float64]:
    """Return the matrix M that turns labels into their leave-one-out predictions, M y.

    All of `loo_predict` is linear in the labels, so that one matrix serves every trait and every permutation.

    Parameters
    ----------
    vectors : array-like of shape (n_walks, n_features), or list of Walk
        See `loo_predict`.
    n_components, scaling, groups, control, n_scalars, weights, linearizer
        See `loo_predict`. `settings_of` has those of a model.

    Returns
    -------
    ndarray of shape (n_walks, n_walks)
        Zero where both walks are of one person. With several numbers of components one matrix each, shape
        (n_numbers, n_walks, n_walks).

    Raises
    ------
    ValueError
        As `loo_predict`.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import loo_matrix
    >>> vectors = np.arange(4.0)[:, np.newaxis] * [1.0, 2.0]
    >>> (loo_matrix(vectors, n_components=1) @ [0.0, 1.0, 2.0, 3.0]).round(6) + 0
    array([0., 1., 2., 3.])
    """
    sample = take_sample(vectors, groups, scaling, n_scalars=n_scalars, weights=weights, linearizer=linearizer)
    sample = sample._replace(controls=take_controls(control, len(sample.vectors), [])[0])
    numbers = take_components(n_components, sample)
    matrices = matrix_of_others(sample, Reduction(int(numbers.max()), scaling), numbers)
    return matrices[0] if isinstance(n_components, int | np.integer) else matrices


def predict_by_others(
    sample: Sample, codes: NDArray[np.float64], reduction: Reduction, numbers: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the predictions of every walk, shape (n_numbers, n_walks, n_traits); see `loo_predict`."""
    folds = leave_out_persons(sample, reduction)
    complete = ~np.isnan(codes).any(axis=0)
    n_complete = int(complete.sum())
    means = codes[:, complete].mean(axis=0)
    columns = np.column_stack((codes[:, complete] - means, unit_columns(sample.controls)))
    moments = folds.coordinates.T @ columns  # (n_coordinates, n_complete + n_controls)
    predicted = np.empty((len(numbers), *codes.shape))
    whole = np.empty((len(numbers), len(codes), n_complete))
    singly = sample.n_persons == len(sample.persons)
    for batch in folds.batches:
        if singly and n_complete:
            walks = np.concatenate(batch.left_out)
            some = batch.axes, batch.squares, folds.coordinates[walks], columns[walks]
            whole[:, walks] = _predict_singly(*some, moments, numbers, n_complete, len(codes))
        if singly and complete.all():
            continue
        for fold in batch.folds(folds.coordinates):
            if n_complete and not singly:
                whole[:, fold.left_out] = _predict_persons(
                    fold, folds.coordinates, columns, moments, numbers, n_complete
                )
            for trait in np.flatnonzero(~complete):
                rows = _predict_partial(fold, folds.coordinates, codes[:, trait], sample.controls, numbers)
                predicted[:, fold.left_out, trait] = rows
    predicted[..., complete] = whole + means
    return predicted


def _predict_persons(
    fold: Fold,
    coordinates: NDArray[np.float64],
    columns: NDArray[np.float64],
    moments: NDArray[np.float64],
    numbers: NDArray[np.intp],
    n_traits: int,
) -> NDArray[np.float64]:
    """Return mean + sum_j score_j (axis_j . moment) / square_j of the others, shape (n_numbers, n_left_out, n_traits).

    `columns`, labels and then controls, are centered over all walks, and `moments` are their products with all
    coordinates: the person's share is taken out.
    """
    slopes, total = _others_slopes(fold, coordinates, columns, moments)
    scores = (coordinates[fold.left_out] - fold.center) @ fold.axes.T  # (n_left_out, n_axes)
    inverses = inverse_squares(fold.squares, len(fold.others))
    steps = _sum_steps(scores[np.newaxis], slopes[np.newaxis], inverses[np.newaxis], numbers, n_traits)
    return steps[:, 0] - total[:n_traits] / len(fold.others)


def _others_slopes(
    fold: Fold, coordinates: NDArray[np.float64], columns: NDArray[np.float64], moments: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return products of the others' scores and columns, shape (n_axes, n_columns), and the sums of those left out."""
    rows, removed = coordinates[fold.left_out], columns[fold.left_out]
    total = removed.sum(axis=0)
    moment = moments - rows.T @ removed + np.multiply.outer(fold.center, total)
    return fold.axes @ moment, total


def _predict_singly(
    axes: NDArray[np.float64],
    squares: NDArray[np.float64],
    rows: NDArray[np.float64],
    removed: NDArray[np.float64],
    moments: NDArray[np.float64],
    numbers: NDArray[np.intp],
    n_traits: int,
    n_walks: int,
) -> NDArray[np.float64]:
    """Return the same for many persons with one walk each, shape (n_numbers, n_persons, n_traits)."""
    factor = n_walks / (n_walks - 1)  # a walk's distance from the mean of the others, over that from everybody's
    along = factor * (axes @ rows[:, :, np.newaxis])[..., 0]  # (n_persons, n_axes)
    slopes = axes @ moments - along[:, :, np.newaxis] * removed[:, np.newaxis]
    inverses = inverse_squares(squares, n_walks - 1)
    steps = _sum_steps(along[:, np.newaxis], slopes, inverses, numbers, n_traits)
    return steps[:, :, 0] - removed[:, :n_traits] / (n_walks - 1)


def _sum_steps(
    scores: NDArray[np.float64],
    slopes: NDArray[np.float64],
    inverses: NDArray[np.float64],
    numbers: NDArray[np.intp],
    n_traits: int,
) -> NDArray[np.float64]:
    """Return what the first components add to the mean label, shape (n_numbers, n_folds, n_left_out, n_traits).

    Parameters
    ----------
    scores : ndarray of shape (n_folds, n_left_out, n_axes)
        Of those left out.
    slopes : ndarray of shape (n_folds, n_axes, n_traits + n_controls)
        Products of the others' scores with labels and controls.
    inverses : ndarray of shape (n_folds, n_axes)
        1 over the others' sums of squares.
    numbers : ndarray of int
        Of components.
    n_traits : int
        The columns after these are controls.
    """
    n_axes = inverses.shape[1]
    if slopes.shape[2] == n_traits:
        weighted = scores * inverses[:, np.newaxis]
        steps = weighted[..., np.newaxis] * slopes[:, np.newaxis]  # (n_folds, n_left_out, n_axes, n_traits)
        return np.moveaxis(np.cumsum(steps, axis=2)[:, :, np.minimum(numbers, n_axes) - 1], 2, 0)
    roots = np.sqrt(inverses)
    scores, slopes = scores * roots[:, np.newaxis], slopes * roots[:, :, np.newaxis]
    return np.stack(
        [
            scores[..., :number] @ take_out(slopes[:, :number, :n_traits], slopes[:, :number, n_traits:])
            for number in numbers
        ]
    )


def _predict_partial(
    fold: Fold,
    coordinates: NDArray[np.float64],
    labels: NDArray[np.float64],
    controls: NDArray[np.float64],
    numbers: NDArray[np.intp],
) -> NDArray[np.float64]:
    """Return the predictions of one trait by those of the others who have a label, shape (n_numbers, n_left_out)."""
    known = ~np.isnan(labels[fold.others])
    if not known.any():
        raise ValueError("expected a label for at least one walk beside those left out, got none but missing ones")
    target = labels[fold.others[known]]
    found = _predict_by_triangles(fold, coordinates, known, target, controls, numbers)
    if found is not None:
        return found
    designs = [_designs(fold, coordinates, controls, int(number)) for number in numbers]
    return np.stack([left_out @ np.linalg.lstsq(others[known], target)[0] for others, left_out in designs])


def _predict_by_triangles(
    fold: Fold,
    coordinates: NDArray[np.float64],
    known: NDArray[np.bool_],
    target: NDArray[np.float64],
    controls: NDArray[np.float64],
    numbers: NDArray[np.intp],
) -> NDArray[np.float64] | None:
    """Return the same for all numbers from one decomposition, design = Q R; None where R is nearly singular.

    The first k columns of design R^-1 are orthonormal, and span the first k of the design.
    """
    most = int(numbers.max())
    axes = fold.axes[:most]
    others, left_out = ((coordinates[walks] - fold.center) @ axes.T for walks in (fold.others, fold.left_out))
    design = np.column_stack((np.ones(int(known.sum())), others[known]))
    if len(design) < design.shape[1]:
        return None
    basis, triangle = np.linalg.qr(design)
    sizes = np.abs(np.diagonal(triangle))
    if sizes.min() < _SMALLEST_DIAGONAL * sizes.max():
        return None
    shared = np.zeros((design.shape[1], controls.shape[1]))
    shared[1:] = others.T @ unit_columns(controls[fold.others])
    shared = solve_triangular(triangle, shared, trans="T", check_finite=False)
    rows = np.column_stack((np.ones(len(left_out)), left_out)).T
    rows = solve_triangular(triangle, rows, trans="T", check_finite=False).T
    moments = (basis.T @ target)[:, np.newaxis]
    if not controls.shape[1]:
        return np.cumsum(rows * moments[:, 0], axis=1)[:, numbers].T
    return np.stack([(rows[:, : 1 + n] @ take_out(moments[: 1 + n], shared[: 1 + n]))[:, 0] for n in numbers])


def _designs(
    fold: Fold, coordinates: NDArray[np.float64], controls: NDArray[np.float64], number: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return a column of ones beside what the others may be told apart by, and the same of those left out."""
    axes = fold.axes[:number]
    scores = [(coordinates[walks] - fold.center) @ axes.T for walks in (fold.others, fold.left_out)]
    free = free_directions(scores[0], unit_columns(controls[fold.others]))
    others, left_out = (np.column_stack((np.ones(len(part)), part @ free)) for part in scores)
    return others, left_out


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
    coordinates, controls = folds.coordinates, unit_columns(sample.controls)
    control_moments = coordinates.T @ controls
    matrices = np.zeros((len(numbers), len(coordinates), len(coordinates)))
    weights = np.zeros((len(numbers), *coordinates.shape))  # of each coordinate in the prediction of each walk
    for batch in folds.batches:
        for fold in batch.folds(coordinates):
            if known is not None and not known.all():
                _fill_partial(matrices, fold, sample.controls, coordinates, known, numbers)
                continue
            shared = _others_slopes(fold, coordinates, controls, control_moments)[0]
            for weight, number in zip(weights, numbers, strict=True):
                weight[fold.left_out] = _weigh_axes(fold, coordinates, shared[:number])
            matrices[:, fold.left_out] = 1.0 / len(fold.others) - (weights[:, fold.left_out] @ fold.center)[..., None]
    if known is None or known.all():
        matrices += weights @ coordinates.T
        matrices[:, sample.persons[:, np.newaxis] == sample.persons] = 0.0
    return matrices


def _weigh_axes(fold: Fold, coordinates: NDArray[np.float64], shared: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the weight of each coordinate of the others, by the first axes, shape (n_left_out, n_coordinates)."""
    axes = fold.axes[: len(shared)]
    roots = np.sqrt(inverse_squares(fold.squares, len(fold.others)))[: len(shared), np.newaxis]
    scores = axes @ (coordinates[fold.left_out] - fold.center).T * roots  # (n_axes, n_left_out)
    return (take_out(scores, shared * roots) * roots).T @ axes


def _fill_partial(
    matrices: NDArray[np.float64],
    fold: Fold,
    controls: NDArray[np.float64],
    coordinates: NDArray[np.float64],
    known: NDArray[np.bool_],
    numbers: NDArray[np.intp],
) -> None:
    labelled = known[fold.others]
    columns = fold.others[labelled]
    for matrix, number in zip(matrices, numbers, strict=True):
        others, left_out = _designs(fold, coordinates, controls, int(number))
        inverse = np.linalg.lstsq(others[labelled], np.eye(len(columns)))[0]
        matrix[np.ix_(fold.left_out, columns)] = left_out @ inverse
