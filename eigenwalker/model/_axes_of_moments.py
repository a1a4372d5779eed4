"""Trait axes from moments: the least squares of `fit_axes`, on few rows that have the same scatter."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.model._axes import Axes
from eigenwalker.model._control import free_directions

__all__ = ["Labeled", "Scored", "axes_of_moments", "pole_scores", "unit_rows"]

_EPS = np.finfo(np.float64).eps


class Scored(NamedTuple):
    """All walkers as scores.

    Parameters
    ----------
    n_walks : int
        How many there are.
    rows : ndarray of shape (n_rows, n_components)
        With the scatter of their scores.
    controls : ndarray of shape (n_rows, n_controls)
        The same rows of the control variables, from `unit_rows`.
    persons : ndarray of shape (n_persons, n_components) or None
        Mean scores of persons, less those of all.
    """

    n_walks: int
    rows: NDArray[np.float64]
    controls: NDArray[np.float64]
    persons: NDArray[np.float64] | None


class Labeled(NamedTuple):
    """The walkers that have a label for a trait.

    Parameters
    ----------
    n_walks : int
        How many there are.
    offset : ndarray of shape (n_components,)
        Their mean score less that of all walkers.
    rows : ndarray of shape (n_rows, n_components)
        With the scatter of their scores.
    label : float
        Their mean label.
    label_rows : ndarray of shape (n_rows,)
        The same rows of the labels.
    """

    n_walks: int
    offset: NDArray[np.float64]
    rows: NDArray[np.float64]
    label: float
    label_rows: NDArray[np.float64]


def axes_of_moments(everyone: Scored, traits: list[Labeled]) -> Axes:
    """Return the axes that `fit_axes` finds in the walkers themselves.

    An orthogonal matrix on the left of design and labels changes neither the solution nor the singular values by which
    `numpy.linalg.lstsq` tells its rank. One that turns n rows into their mean times sqrt(n) and n - 1 rows without mean
    makes of the design (1, s) with n labels y the rows (sqrt(n), sqrt(n) mean of s) and (0, rows of s).

    Raises
    ------
    ValueError
        If the controls leave no direction.
    """
    n_components = everyone.rows.shape[1]
    free = free_directions(everyone.rows, everyone.controls, n_walkers=everyone.n_walks)
    if not free.shape[1]:
        raise ValueError(
            f"control leaves no direction for an axis: expected more components than the {everyone.controls.shape[1]} "
            f"control(s), got {n_components}"
        )
    solutions = [_least_squares(trait, free) for trait in traits]
    filters = np.stack([free @ solution[1:] for solution in solutions])
    n_free = max(everyone.n_walks - 1, 1)
    return Axes(
        filters,
        np.array([solution[0] for solution in solutions]),
        np.zeros(n_components),
        everyone.rows.T @ everyone.rows / n_free,
        _spread(everyone, filters),
    )


def _least_squares(trait: Labeled, free: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return intercept and filter, shape (1 + n_free,)."""
    root = np.sqrt(trait.n_walks)
    ones = np.zeros(1 + len(trait.rows))
    ones[0] = root
    design = np.column_stack((ones, np.vstack((root * trait.offset, trait.rows)) @ free))
    cutoff = _EPS * max(trait.n_walks, design.shape[1])  # what lstsq takes for that many walkers
    return np.linalg.lstsq(design, np.append(root * trait.label, trait.label_rows), rcond=cutoff)[0]


def _spread(everyone: Scored, filters: NDArray[np.float64]) -> NDArray[np.float64]:
    if everyone.persons is None:
        return np.linalg.norm(everyone.rows @ filters.T, axis=0) / np.sqrt(max(everyone.n_walks - 1, 1))
    if len(everyone.persons) < 2:
        return np.zeros(len(filters))
    return (everyone.persons @ filters.T).std(axis=0, ddof=1)


def pole_scores(trait: Labeled) -> NDArray[np.float64]:
    """Return the mean score of walkers labeled -1 and of those labeled +1, less that of all, shape (2, n_components).

    With n walkers, n_+ of them labeled +1, the mean of these is that of all n plus (sum of s y) / (2 n_+), centered.
    """
    n_positive = trait.n_walks * (1.0 + trait.label) / 2.0
    shared = trait.rows.T @ trait.label_rows
    return trait.offset + np.outer([-0.5 / (trait.n_walks - n_positive), 0.5 / n_positive], shared)


def unit_rows(rows: NDArray[np.float64], mean: NDArray[np.float64], n_walks: int) -> NDArray[np.float64]:
    """Return rows of controls divided by their lengths, as `unit_columns` does; constants become 0.

    Parameters
    ----------
    rows : ndarray of shape (n_rows, n_controls)
        With the scatter of the controls.
    mean : ndarray of shape (n_controls,)
        Of the controls. A control whose SD could be rounding is nowhere larger than that, to rounding.
    n_walks : int
        How many walkers there are.
    """
    lengths = np.linalg.norm(rows, axis=0)
    return np.divide(rows, lengths, out=np.zeros_like(rows), where=lengths > _EPS * n_walks * np.abs(mean))
