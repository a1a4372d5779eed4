"""The Eigenwalkers of everybody but one person, for each person in turn.

With the scalings None and "blocks" they follow from the decomposition of everybody, `_downdate`. A decomposition of the
others, `principal_axes`, takes its place

- with the scalings "features" and "noise", which change the scale of every feature in every fold;
- where a person has so many walks, more than 8 with the single features, that it is faster;
- where a variance that counts falls to less than 1e-4 without the person, who was nearly alone in a direction, and
  digits would be lost.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.model._downdate import downdate, downdate_each
from eigenwalker.model._principal import decompose, principal_axes
from eigenwalker.model._sample import Reduction, Sample
from eigenwalker.model.scaling import BlockScaler

__all__ = ["Batch", "Fold", "Folds", "learn_scales", "leave_out_persons"]

_BATCH_BYTES = 2**25
_MOST_CHANGES = 8
_SMALLEST_SHARE = 1e-4


class Fold(NamedTuple):
    """One person left out, and the Eigenwalkers of the others.

    Parameters
    ----------
    left_out, others : ndarray of int
        Positions of the walks.
    axes : ndarray of shape (n_axes, n_coordinates)
        Score j of a walk is ``axes[j] @ (coordinates - center)``, up to its sign.
    squares : ndarray of shape (n_axes,)
        Sums of squares of the others' scores.
    center : ndarray of shape (n_coordinates,)
        Mean of the others' coordinates.
    """

    left_out: NDArray[np.intp]
    others: NDArray[np.intp]
    axes: NDArray[np.float64]
    squares: NDArray[np.float64]
    center: NDArray[np.float64]


class Batch(NamedTuple):
    """Some folds at once: each person's walks, axes (n_persons, n_axes, n_coordinates), squares (n_persons, n_axes)."""

    left_out: list[NDArray[np.intp]]
    axes: NDArray[np.float64]
    squares: NDArray[np.float64]

    def folds(self, coordinates: NDArray[np.float64]) -> Iterator[Fold]:
        """Yield them one by one."""
        everybody = np.arange(len(coordinates))
        for left_out, axes, squares in zip(self.left_out, self.axes, self.squares, strict=True):
            others = np.delete(everybody, left_out)
            center = coordinates[left_out].sum(axis=0) / -len(others)
            yield Fold(left_out, others, axes, squares, center)


class Folds(NamedTuple):
    """Coordinates of all walks, shape (n_walks, n_coordinates), less their mean; and the folds, made on the way."""

    coordinates: NDArray[np.float64]
    batches: Iterator[Batch]


def leave_out_persons(sample: Sample, reduction: Reduction) -> Folds:
    """Return one fold for each person, with scales and Eigenwalkers of the others alone."""
    centered = sample.vectors - sample.vectors.mean(axis=0)
    if reduction.scaling in ("features", "noise"):
        return Folds(centered, _refit_each(sample, reduction, centered))
    scales = learn_scales(sample, reduction, slice(None))
    left, lengths, right = decompose(centered / scales, reduction.n_components)
    return Folds(left, _downdate_batches(sample, reduction, _Whole(centered, scales, left, lengths, right)))


def learn_scales(sample: Sample, reduction: Reduction, walks: NDArray[np.intp] | slice) -> NDArray[np.float64]:
    """Return what `BlockScaler` divides each feature by when it is fitted to some walks."""
    if reduction.scaling is None:
        return 1.0 / sample.weights
    scaler = BlockScaler(sample.n_scalars, unit=reduction.scaling, weights=sample.weights)
    return scaler.fit(sample.vectors[walks], groups=sample.persons[walks]).scale_


def _by_person(persons: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the positions of the walks, one person after the other, and where each person begins, and the end."""
    return np.argsort(persons, kind="stable"), np.concatenate(([0], np.cumsum(np.bincount(persons))))


def _refit_each(sample: Sample, reduction: Reduction, centered: NDArray[np.float64]) -> Iterator[Batch]:
    order, starts = _by_person(sample.persons)
    for left_out in np.split(order, starts[1:-1]):
        others = np.delete(np.arange(len(order)), left_out)
        scales = learn_scales(sample, reduction, others)
        part = centered[others]
        squares, axes = principal_axes((part - part.mean(axis=0)) / scales, reduction.n_components)
        yield Batch([left_out], (axes / scales)[np.newaxis], squares[np.newaxis])


class _Whole(NamedTuple):
    """The decomposition of everybody, centered / scales = U diag(lengths) V'."""

    centered: NDArray[np.float64]
    scales: NDArray[np.float64]
    left: NDArray[np.float64]
    lengths: NDArray[np.float64]
    right: NDArray[np.float64]


def _downdate_batches(sample: Sample, reduction: Reduction, whole: _Whole) -> Iterator[Batch]:
    order, starts = _by_person(sample.persons)
    everybody = np.split(order, starts[1:-1])
    changes = _changes_of_scale(sample, reduction, whole)
    n_axes = max(1, min(reduction.n_components, len(whole.lengths), len(order) - min(map(len, everybody)) - 1))
    size = max(1, _BATCH_BYTES // (8 * n_axes * len(whole.lengths)))
    for first in range(0, sample.n_persons, size):
        left_out, change = everybody[first : first + size], changes[first : first + size]
        if len(order) == sample.n_persons and not change.shape[1]:
            squares, axes = downdate_each(whole.lengths, whole.left[np.concatenate(left_out)], len(order), n_axes)
        else:
            squares, axes = _downdate_one_by_one(whole, left_out, change, n_axes)
        wrong = ~(squares >= _SMALLEST_SHARE * whole.lengths[:n_axes] ** 2).all(axis=1)
        for fold in np.flatnonzero(wrong):
            squares[fold], axes[fold] = _refit(sample, reduction, whole, left_out[fold], n_axes)
        yield Batch(left_out, axes, squares)


def _downdate_one_by_one(
    whole: _Whole, left_out: list[NDArray[np.intp]], changes: NDArray[np.float64], n_axes: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return squares and axes of some folds; squares of 0 where they are not to be had by changes of rank one."""
    n_walks, rank = whole.left.shape
    first_scalar = whole.right.shape[1] - changes.shape[1]
    features = (whole.right[:, first_scalar:] * whole.lengths[:, np.newaxis]).T
    squares, axes = np.zeros((len(left_out), n_axes)), np.zeros((len(left_out), n_axes, rank))
    for fold, (walks, change) in enumerate(zip(left_out, changes, strict=True)):
        n_found = min(n_axes, n_walks - len(walks) - 1)
        # A scale that shrinks a hundredfold would magnify the rounding of the decomposition.
        if len(walks) + len(change) <= _MOST_CHANGES and n_found > 0 and (change < 1 / _SMALLEST_SHARE).all():
            found = downdate(whole.lengths, whole.left[walks], n_walks, n_found, features, change)
            squares[fold, :n_found], axes[fold, :n_found] = found
    return squares, axes


def _refit(
    sample: Sample, reduction: Reduction, whole: _Whole, left_out: NDArray[np.intp], n_axes: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return squares and axes from a decomposition of the others, in the coordinates of everybody's."""
    others = np.delete(np.arange(len(sample.vectors)), left_out)
    scales = learn_scales(sample, reduction, others)
    part = whole.centered[others]
    found, directions = principal_axes((part - part.mean(axis=0)) / scales, min(n_axes, len(others) - 1))
    squares, axes = np.zeros(n_axes), np.zeros((n_axes, len(whole.lengths)))
    squares[: len(found)] = found
    axes[: len(found)] = directions * (whole.scales / scales) @ whole.right.T * whole.lengths
    return squares, axes


def _changes_of_scale(sample: Sample, reduction: Reduction, whole: _Whole) -> NDArray[np.float64]:
    """Return (scale / scale without a person)^2 - 1 of each single feature, shape (n_persons, n_scalars).

    The variances without a person come from sums over everybody less those of the person. Where that would leave less
    than a thousandth, `BlockScaler` itself decides, and tells a feature that no longer varies as well.
    """
    n_scalars = 0 if reduction.scaling is None else sample.n_scalars
    if n_scalars == 0:
        return np.empty((sample.n_persons, 0))
    order, starts = _by_person(sample.persons)
    n_posture = whole.centered.shape[1] - n_scalars
    squares = whole.centered**2
    parts = np.column_stack((squares[:, :n_posture].sum(axis=1), squares[:, n_posture:]))
    sums = np.add.reduceat(whole.centered[order], starts[:-1]) ** 2
    shifts = np.column_stack((sums[:, :n_posture].sum(axis=1), sums[:, n_posture:]))
    n_others = len(order) - np.diff(starts)[:, np.newaxis]
    # Sums of squares about the others' mean: of posture, then of each single feature.
    total = parts.sum(axis=0)
    rest = total - np.add.reduceat(parts[order], starts[:-1]) - shifts / n_others
    own = whole.scales[n_posture:] ** 2
    weighted = own * sample.weights[n_posture:] ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        changes = weighted * (rest[:, :1] / np.float64(n_posture)) / rest[:, 1:] - 1.0
    for person in np.flatnonzero((rest <= 1e-3 * total).any(axis=1)):
        others = np.flatnonzero(sample.persons != person)
        changes[person] = own / learn_scales(sample, reduction, others)[n_posture:] ** 2 - 1.0
    return changes
