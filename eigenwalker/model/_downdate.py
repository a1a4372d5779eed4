"""The principal axes of everybody but some, from those of everybody, as changes of rank one.

All walks are decomposed once: centered vectors over their scales = U diag(s) V'. Leaving m walks out, with means and
all, changes diag(s^2), their scatter, by m matrices of rank one,

    diag(s^2) - Z' (1 + 1 1' / (n - m)) Z,    Z = the rows of U diag(s) that are left out.

A feature f whose scale changes by itself, x_f to x_f (1 + g)^(1/2), changes diag(s^2) as the Gram matrix of the walks,
U' X X' U, by the one matrix g w w', w = U' x_f. `_secular` follows these changes one by one.
"""

import numpy as np
from numpy.typing import NDArray

from eigenwalker.model._secular import add_rank_one, subtract_each, subtract_rank_one

__all__ = ["downdate", "downdate_each"]

Pairs = tuple[NDArray[np.float64], NDArray[np.float64]]


def downdate_each(lengths: NDArray[np.float64], rows: NDArray[np.float64], n_walks: int, n_axes: int) -> Pairs:
    """Return the principal axes without each of some walks, one at a time and with scales as they are.

    Parameters
    ----------
    lengths : ndarray of shape (rank,)
        s, in descending order.
    rows : ndarray of shape (n_rows, rank)
        The walks' rows of U.
    n_walks : int
        How many walks there are.
    n_axes : int
        How many axes are wanted.

    Returns
    -------
    squares : ndarray of shape (n_rows, n_axes)
        Sums of squares of the others' scores.
    axes : ndarray of shape (n_rows, n_axes, rank)
        Rows that take the rows of U, less the others' mean, to scores.
    """
    squares, axes = subtract_each(lengths**2, rows * (lengths * np.sqrt(n_walks / (n_walks - 1))), n_axes)
    axes *= lengths
    return squares, axes


def downdate(
    lengths: NDArray[np.float64],
    rows: NDArray[np.float64],
    n_walks: int,
    n_axes: int,
    features: NDArray[np.float64],
    changes: NDArray[np.float64],
) -> Pairs:
    """Return the principal axes without some walks at once, after some features have changed their scale.

    Parameters
    ----------
    lengths, rows, n_walks, n_axes
        As for `downdate_each`.
    features : ndarray of shape (n_features, rank)
        w of each feature whose scale changes.
    changes : ndarray of shape (n_features,)
        g of each of them.

    Returns
    -------
    squares : ndarray of shape (n_axes,)
    axes : ndarray of shape (n_axes, rank)
    """
    squares = lengths**2
    rank = len(lengths)
    turns: list[NDArray[np.float64]] = []
    for feature, change in zip(features, changes, strict=True):
        vector = _turn(feature * np.sqrt(abs(change)), turns)
        squares, turn = add_rank_one(squares, vector) if change > 0 else subtract_rank_one(squares, vector, rank)
        turns.append(turn)
    own = np.sqrt(np.maximum(squares, 0.0))
    steps: list[NDArray[np.float64]] = []
    for number, row in enumerate(_with_mean(rows, n_walks - len(rows)), start=1):
        vector = _turn(own * _turn(row, turns), steps)
        squares, step = subtract_rank_one(squares, vector, n_axes if number == len(rows) else rank)
        steps.append(step)
    axes = steps.pop()
    for step in reversed(steps):
        axes = axes @ step
    axes = axes * own
    for turn in reversed(turns):
        axes = axes @ turn
    return squares, axes


def _turn(vector: NDArray[np.float64], turns: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return a vector in the coordinates that the changes before it have led to."""
    for turn in turns:
        vector = turn @ vector
    return vector


def _with_mean(rows: NDArray[np.float64], n_others: int) -> NDArray[np.float64]:
    """Return (1 + 1 1' / n_others)^(1/2) times the rows, whose squares hold the change of the mean as well."""
    return rows + rows.mean(axis=0) * (np.sqrt(1.0 + len(rows) / n_others) - 1.0)
