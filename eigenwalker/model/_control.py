"""Least squares subject to no covariance with control variables.

With centered scores S and centered controls Z a filter c is controlled where Z' S c = 0: what it reads from the
training walkers is uncorrelated with the controls.
"""

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from eigenwalker.model._labels import encode, learn_coding, tabulate

__all__ = ["free_directions", "tabulate_controls", "take_controls", "take_out", "unit_columns"]

_EPS = np.finfo(np.float64).eps
_VANISHES = 1e-10  # correlation of controls and scores, below which it is rounding


def take_controls(control: ArrayLike | None, n_walks: int, traits: list[str]) -> tuple[NDArray[np.float64], list[str]]:
    """Return control variables as numbers, shape (n_walks, n_controls), and their names.

    Raises
    ------
    ValueError
        If there are not as many as walks, a value is missing, or a trait would be controlled for itself.
    """
    if control is None:
        return np.empty((n_walks, 0)), []
    table = tabulate_controls(control, n_walks, traits)
    return encode(table, learn_coding(table, None)), list(table)


def tabulate_controls(control: ArrayLike, n_walks: int, traits: list[str]) -> pd.DataFrame:
    """Return control variables as they are, one column each; see `take_controls` for the errors."""
    table = tabulate(control, name="control")
    if getattr(control, "columns", getattr(control, "name", None)) is None:  # no names of its own
        table.columns = [str(name).replace("trait", "control") for name in table]
    names = list(table)
    if len(table) != n_walks:
        raise ValueError(f"control must have one row a walk, {n_walks}, got {len(table)}")
    missing = table.isna().any(axis=1)
    if missing.any():
        raise ValueError(
            f"control must have no missing values, got {int(missing.sum())} of {n_walks} walks with one among "
            f"{', '.join(names)}; leave these walks out"
        )
    itself = [name for name in names if name in traits]
    if itself:
        raise ValueError(f"a trait cannot be controlled for itself, got {', '.join(itself)} as trait and as control")
    return table


def unit_columns(controls: NDArray[np.float64], weights: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
    """Return centered controls of length 1; times the roots of the weights, if there are any. Constants become 0."""
    weights = np.ones(len(controls)) if weights is None else weights
    centered = controls - weights @ controls / weights.sum()
    centered = centered * np.sqrt(weights)[:, np.newaxis]
    lengths = np.linalg.norm(centered, axis=0)
    varies = lengths > _EPS * len(controls) * np.abs(controls).max(axis=0, initial=0.0)
    return np.divide(centered, lengths, out=np.zeros_like(centered), where=varies)


def take_out(moments: NDArray[np.float64], shared: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return moments less their projection on what scores share with controls.

    Parameters
    ----------
    moments : ndarray of shape (..., n_components, n_traits)
        T' y, with uncorrelated scores T of length 1.
    shared : ndarray of shape (..., n_components, n_controls)
        T' Z, with controls of length 1.
    """
    if not shared.shape[-1]:
        return moments
    left, lengths, _ = np.linalg.svd(shared, full_matrices=False)
    left = left * (lengths > _VANISHES)[..., np.newaxis, :]
    return moments - left @ (np.swapaxes(left, -1, -2) @ moments)


def free_directions(
    scores: NDArray[np.float64], controls: NDArray[np.float64], *, n_walkers: int | None = None
) -> NDArray[np.float64]:
    """Return a basis B of all controlled filters, Z' S B = 0, shape (n_components, n_free).

    Parameters
    ----------
    scores : ndarray of shape (n_walkers, n_components)
        Centered.
    controls : ndarray of shape (n_walkers, n_controls)
        From `unit_columns`.
    n_walkers : int, default None
        How many walkers there are, if `scores` and `controls` are fewer rows with the same scatter.
    """
    if not controls.shape[1]:
        return np.eye(scores.shape[1])
    lengths = np.linalg.norm(scores, axis=0)
    counts = lengths > _EPS * max(scores.shape[1], n_walkers or len(scores)) * lengths.max(initial=0.0)
    directions = scores[:, counts] / lengths[counts]
    left, strengths, _ = np.linalg.svd(directions.T @ controls, full_matrices=True)
    n_taken = int(np.sum(strengths > _VANISHES))
    basis = np.zeros((len(lengths), int(counts.sum()) - n_taken))
    basis[counts] = left[:, n_taken:] / lengths[counts, np.newaxis]
    return basis
