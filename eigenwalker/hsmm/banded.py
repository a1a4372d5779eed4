"""Symmetric banded systems, one a dimension and all of them at once: A = L D L' without pivots.

Dimensions are the last axis, so that the innermost loops run over them and one instruction serves several. The bands
may lie `step` columns apart: with the windows of the paper (Eq. 2 and 3) only frames an even number apart are coupled,
every other band of W'PW is zero, and leaving those out halves the work.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = [
    "count_negative",
    "factorize",
    "factorize_row",
    "multiply_banded",
    "solve_banded",
    "solve_factorized",
    "substitute_back_row",
    "substitute_row",
]


def factorize(
    bands: NDArray[np.float64], *, step: int = 1, shift: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Return the factors of A + diag(shift), A = L D L' with L unit lower triangular, for each dimension.

    Parameters
    ----------
    bands : ndarray of shape (n_rows, n_bands, n_dims)
        ``bands[t, k]`` is A[t, t - k * step]; what lies left of the first column is not read.
    step : int, default 1
        How many columns the bands are apart.
    shift : ndarray of shape (n_dims,) or (n_rows, n_dims), default None
        What is added to the diagonal of each dimension's matrix; None is nothing.

    Returns
    -------
    ndarray of shape (n_rows, n_bands, n_dims)
        ``[t, 0]`` is 1 / D[t], ``[t, k]`` is L[t, t - k * step].

    Notes
    -----
    Without pivots: exact for positive definite matrices. Others have as many negative D as negative eigenvalues (see
    `count_negative`), at less precision.

    Examples
    --------
    >>> import numpy as np
    >>> bands = np.array([[4.0, 0.0], [4.0, 2.0]])[:, :, np.newaxis]  # the matrix [[4, 2], [2, 4]]
    >>> factorize(bands)[:, :, 0]
    array([[0.25      , 0.        ],
           [0.33333333, 0.5       ]])
    """
    factors = np.array(bands, dtype=np.float64, order="C")
    if shift is not None:
        factors[:, 0] += shift
    _factorize(factors, step)
    return factors


def solve_factorized(factors: NDArray[np.float64], right: NDArray[np.float64], *, step: int = 1) -> NDArray[np.float64]:
    """Return the solution x of A x = right from the factors of A.

    Parameters
    ----------
    factors : ndarray of shape (n_rows, n_bands, n_dims)
        From `factorize`.
    right : ndarray of shape (n_rows, n_dims)
        Right-hand sides.
    step : int, default 1
        How many columns the bands are apart.

    Returns
    -------
    ndarray of shape (n_rows, n_dims)
    """
    values = np.array(right, dtype=np.float64, order="C")
    _solve(factors, values, step)
    return values


def solve_banded(bands: NDArray[np.float64], right: NDArray[np.float64], *, step: int = 1) -> NDArray[np.float64]:
    """Return the solution x of A x = right for symmetric positive definite A.

    Parameters
    ----------
    bands : ndarray of shape (n_rows, n_bands, n_dims)
        ``bands[t, k]`` is A[t, t - k * step]; what lies left of the first column is not read.
    right : ndarray of shape (n_rows, n_dims)
        Right-hand sides.
    step : int, default 1
        How many columns the bands are apart.

    Returns
    -------
    ndarray of shape (n_rows, n_dims)

    Raises
    ------
    ValueError
        If a matrix is not positive definite.

    Examples
    --------
    >>> import numpy as np
    >>> bands = np.array([[4.0, 0.0], [4.0, 2.0]])[:, :, np.newaxis]
    >>> solve_banded(bands, np.array([[6.0], [6.0]])).ravel()
    array([1., 1.])
    """
    factors = factorize(bands, step=step)
    bad = np.flatnonzero(~((factors[:, 0] > 0) & np.isfinite(factors[:, 0])).all(axis=0))
    if len(bad):
        raise ValueError(f"expected positive definite matrices, got others in dimensions {bad.tolist()}")
    return solve_factorized(factors, right, step=step)


def count_negative(factors: NDArray[np.float64]) -> NDArray[np.int_]:
    """Return how many negative eigenvalues each dimension's matrix has, shape (n_dims,) (Sylvester's law of inertia).

    Parameters
    ----------
    factors : ndarray of shape (n_rows, n_bands, n_dims)
        From `factorize`.
    """
    return np.count_nonzero(factors[:, 0] < 0, axis=0)


def multiply_banded(bands: NDArray[np.float64], values: NDArray[np.float64], *, step: int = 1) -> NDArray[np.float64]:
    """Return A values for each dimension, shape (n_rows, n_dims).

    Parameters
    ----------
    bands : ndarray of shape (n_rows, n_bands, n_dims)
        ``bands[t, k]`` is A[t, t - k * step].
    values : ndarray of shape (n_rows, n_dims)
        One vector a dimension.
    step : int, default 1
        How many columns the bands are apart.
    """
    product = bands[:, 0] * values
    for band in range(1, bands.shape[1]):
        apart = band * step
        product[apart:] += bands[apart:, band] * values[:-apart]
        product[:-apart] += bands[apart:, band] * values[apart:]
    return product


# One row each, also for compiled callers who make and use it while it is in the cache. Written into the loops that call
# them: a call costs as much as a row of 50 dimensions.
@njit(nogil=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def factorize_row(bands, unscaled, row, step):
    """Replace a row of bands by its factors, once those above it are; `unscaled` (n_bands, n_dims) is scratch.

    u_k = A[t, t-k] - sum_{m > k} u_m L[t-k, t-m], L_k = u_k / D[t-k], D[t] = A[t, t] - sum_k u_k L_k.
    """
    _, n_bands, n_dims = bands.shape
    last = min(n_bands - 1, row // step)
    pivot = bands[row, 0]
    for band in range(last, 0, -1):
        column, entry, kept = row - band * step, bands[row, band], unscaled[band]
        for further in range(band + 1, last + 1):
            left, above = unscaled[further], bands[column, further - band]
            for dim in range(n_dims):
                entry[dim] -= left[dim] * above[dim]
        inverse = bands[column, 0]
        for dim in range(n_dims):
            kept[dim] = entry[dim]
            entry[dim] = kept[dim] * inverse[dim]
            pivot[dim] -= kept[dim] * entry[dim]
    for dim in range(n_dims):
        pivot[dim] = 1.0 / pivot[dim]


@njit(nogil=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def substitute_row(factors, values, row, step):
    """Replace a row of right-hand sides by that of y with L y = values, once those above it are."""
    _, n_bands, n_dims = factors.shape
    value = values[row]
    for band in range(1, min(n_bands - 1, row // step) + 1):
        factor, other = factors[row, band], values[row - band * step]
        for dim in range(n_dims):
            value[dim] -= factor[dim] * other[dim]


@njit(nogil=True, error_model="numpy", fastmath={"contract"}, forceinline=True)
def substitute_back_row(factors, values, row, step):
    """Replace a row of y by that of x with D L' x = y, once those below it are."""
    n_rows, n_bands, n_dims = factors.shape
    value, inverse = values[row], factors[row, 0]
    for dim in range(n_dims):
        value[dim] *= inverse[dim]
    for band in range(1, min(n_bands - 1, (n_rows - 1 - row) // step) + 1):
        factor, other = factors[row + band * step, band], values[row + band * step]
        for dim in range(n_dims):
            value[dim] -= factor[dim] * other[dim]


# Only these two are called from Python and kept on disk: numba mixes up functions that are kept both by themselves and
# within another.
@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _factorize(bands, step):
    unscaled = np.empty(bands.shape[1:])
    for row in range(len(bands)):
        factorize_row(bands, unscaled, row, step)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _solve(factors, values, step):
    for row in range(len(values)):
        substitute_row(factors, values, row, step)
    for row in range(len(values) - 1, -1, -1):
        substitute_back_row(factors, values, row, step)
