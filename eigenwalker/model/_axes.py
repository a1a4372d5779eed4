"""The linear algebra of trait axes, on arrays.

A trait t has a filter c_t, a row of C. With scores s and their mean m, a_t = c_t . (s - m) is the displacement of a
walker along the trait, in units of the label.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.model._control import free_directions, unit_columns
from eigenwalker.model._persons import mean_by_person

__all__ = ["ALPHA_UNITS", "DIRECTIONS", "Axes", "displacement", "fit_axes", "move", "unit_lengths"]

ALPHA_UNITS = ("sd", "label", "coefficient")
DIRECTIONS = ("pattern", "filter")


class Axes(NamedTuple):
    """Trait axes in a space of scores.

    Parameters
    ----------
    filters : ndarray of shape (n_traits, n_components)
        C, in label units per score unit.
    intercept : ndarray of shape (n_traits,)
        Predicted label of the average walker.
    center : ndarray of shape (n_components,)
        m, the average walker.
    covariance : ndarray of shape (n_components, n_components)
        Of the scores.
    spread : ndarray of shape (n_traits,)
        SD of the displacement over walkers, or over persons.
    """

    filters: NDArray[np.float64]
    intercept: NDArray[np.float64]
    center: NDArray[np.float64]
    covariance: NDArray[np.float64]
    spread: NDArray[np.float64]


def fit_axes(
    scores: NDArray[np.float64],
    labels: NDArray[np.float64],
    groups: NDArray[np.intp] | None = None,
    controls: NDArray[np.float64] | None = None,
) -> Axes:
    """Return the least-squares axes of labels on scores, with intercept (Troje 2002, Eq. 5).

    With controls they are the best of those whose displacement has no covariance with any control.

    Parameters
    ----------
    scores : ndarray of shape (n_walkers, n_components)
        Positions in Eigenwalker space.
    labels : ndarray of shape (n_walkers, n_traits)
        NaN where a walker has no label for a trait; the walker then counts for the mean and the covariance only.
    groups : ndarray of shape (n_walkers,), default None
        Number of the person each walk belongs to; the spread is then that of the persons' means.
    controls : ndarray of shape (n_walkers, n_controls), default None
        What no axis may go along with.

    Raises
    ------
    ValueError
        If the controls leave no direction.
    """
    center = scores.mean(axis=0)
    centered = scores - center
    controls = np.empty((len(scores), 0)) if controls is None else controls
    free = free_directions(centered, unit_columns(controls))
    if not free.shape[1]:
        raise ValueError(
            f"control leaves no direction for an axis: expected more components than the {controls.shape[1]} "
            f"control(s), got {scores.shape[1]}"
        )
    filters = np.empty((labels.shape[1], scores.shape[1]))
    intercept = np.empty(labels.shape[1])
    for trait, column in enumerate(labels.T):
        known = ~np.isnan(column)
        design = np.column_stack((np.ones(known.sum()), centered[known] @ free))
        solution = np.linalg.lstsq(design, column[known])[0]
        intercept[trait], filters[trait] = solution[0], free @ solution[1:]
    displacements = centered @ filters.T
    if groups is not None:
        displacements = mean_by_person(displacements, groups)
    n_free = max(len(scores) - 1, 1)
    spread = displacements.std(axis=0, ddof=1) if len(displacements) > 1 else np.zeros(labels.shape[1])
    return Axes(filters, intercept, center, centered.T @ centered / n_free, spread)


def displacement(axes: Axes, scores: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a = C (s - m), shape (n_walkers, n_traits), in label units."""
    return (scores - axes.center) @ axes.filters.T


def unit_lengths(axes: Axes, unit: str) -> NDArray[np.float64]:
    """Return how many label units one unit of alpha is, shape (n_traits,).

    "sd": the spread. "label": 1. "coefficient": c . c, so that alpha c is the step of Troje 2002, Eq. 6.
    """
    lengths = {
        "sd": axes.spread,
        "label": np.ones(len(axes.filters)),
        "coefficient": (axes.filters**2).sum(axis=1),
    }[unit]
    return lengths


def move(
    axes: Axes, displacements: NDArray[np.float64], traits: Sequence[int], *, direction: str, names: Sequence[str]
) -> NDArray[np.float64]:
    """Return the smallest step through the scores that has the given displacements of some traits.

    With the rows C_S of these traits: Cov C_S' (C_S Cov C_S')^-1 a for "pattern", where what goes along with a trait
    among the walkers goes along, smallest in the metric of their cloud; C_S' (C_S C_S')^-1 a for "filter". Other
    traits are free.

    Parameters
    ----------
    axes : Axes
        From `fit_axes`.
    displacements : ndarray of shape (n_steps, n_specified)
        In label units.
    traits : sequence of int
        Positions of the specified traits.
    direction : {"pattern", "filter"}
        See above.
    names : sequence of str
        Names of all traits, for the error.

    Returns
    -------
    ndarray of shape (n_steps, n_components)

    Raises
    ------
    ValueError
        If the specified traits cannot be set independently of each other.
    """
    chosen = axes.filters[list(traits)]
    spread = chosen @ axes.covariance if direction == "pattern" else chosen
    gram = spread @ chosen.T  # (n_specified, n_specified)
    lengths = np.sqrt(np.diagonal(gram))
    if not (lengths > 0).all() or np.linalg.cond(gram / np.outer(lengths, lengths)) > 1e12:
        listed = ", ".join(names[trait] for trait in traits)
        raise ValueError(
            f"the traits {listed} cannot be set independently of each other: their axes have no direction or are "
            "combinations of each other; give fewer of them, or use more components"
        )
    return np.linalg.solve(gram, displacements.T).T @ spread
