"""Mean and scatter of rows that come in parts: exact in one pass and in any order."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

__all__ = ["Scatter", "add_scatters", "centered_rows", "few_rows", "scale_columns", "scatter_of"]


class Scatter(NamedTuple):
    """How many rows there were, their mean, and few rows that have their scatter.

    Parameters
    ----------
    n_walks : int
        Number of rows, n.
    origin : ndarray of shape (n_columns,)
        The first row. Sums are of what rows differ from it, so that a mean far from zero costs no digits.
    shift : ndarray of shape (n_columns,)
        Mean of the rows less `origin`.
    rows : ndarray of shape (n_rows, n_columns)
        R with R' R = sum of (x - mean) (x - mean)' over all rows x; n - 1 of them, or fewer, see `few_rows`. R itself
        is kept because R' R has the squares of its singular values, and half of their digits.
    """

    n_walks: int
    origin: NDArray[np.float64]
    shift: NDArray[np.float64]
    rows: NDArray[np.float64]

    @property
    def mean(self) -> NDArray[np.float64]:
        """Mean of the rows."""
        return self.origin + self.shift


def scatter_of(values: NDArray[np.floating]) -> Scatter:
    """Return the scatter of some rows, shape (n, n_columns), n > 0; float32 is summed in float64.

    A reflection that turns the vector of n ones into its length times the first unit vector turns n rows into
    sqrt(n) mean and n - 1 rows without mean. Those are x_i - c, i = 2 .. n, with rows x counted from the first of them
    and c = mean sqrt(n) / (sqrt(n) - 1).
    """
    count = len(values)
    rows = np.subtract(values[1:], values[0], dtype=np.float64)
    shift = rows.sum(axis=0) / count
    if count > 1:
        root = np.sqrt(count)
        rows -= shift * (root / (root - 1.0))
    return Scatter(count, values[0].astype(np.float64), shift, rows)


def add_scatters(one: Scatter, other: Scatter) -> Scatter:
    """Return the scatter of the rows of both.

    Chan, Golub & LeVeque 1983, "Algorithms for computing the sample variance", pairwise: with the gap d between the two
    means, S = S_1 + S_2 + d d' n_1 n_2 / (n_1 + n_2), here one row more.
    """
    count = one.n_walks + other.n_walks
    gap = (other.origin - one.origin) + (other.shift - one.shift)
    between = np.sqrt(one.n_walks * (other.n_walks / count)) * gap
    shift = one.shift + gap * (other.n_walks / count)
    return Scatter(count, one.origin, shift, few_rows(one.rows, other.rows, between[np.newaxis]))


def scale_columns(scatter: Scatter, factors: NDArray[np.float64]) -> Scatter:
    """Return the scatter of rows whose columns are multiplied by factors."""
    return Scatter(scatter.n_walks, *(part * factors for part in scatter[1:]))


def few_rows(*parts: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return at most 2 n_columns rows with the same R' R: all there are, or the triangle R of their QR."""
    n_rows, n_columns = sum(map(len, parts)), parts[0].shape[1]
    if n_rows <= 2 * n_columns:
        return np.concatenate(parts)
    stacked = np.empty((n_rows, n_columns), order="F")  # as LAPACK wants it
    np.concatenate(parts, out=stacked)
    return qr(stacked, overwrite_a=True, mode="raw", check_finite=False)[1]


def centered_rows(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return one row more than given, with mean zero and the same scatter R' R: the reflection in `scatter_of`, undone.

    With s the sum of q - 1 rows r_i the q rows are s / sqrt(q) and r_i - s / (q - sqrt(q)).
    """
    count = len(rows) + 1
    total = rows.sum(axis=0, keepdims=True)
    if count == 1:
        return total
    return np.concatenate((total / np.sqrt(count), rows - total / (count - np.sqrt(count))))
