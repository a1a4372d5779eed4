"""Principal axes from the smaller of two Gram matrices, or from an SVD where that would lose digits."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

__all__ = ["decompose", "inverse_squares", "principal_axes"]

_EPS = np.finfo(np.float64).eps
_LARGE = 100  # from here on some eigenvectors take less time than all

# A Gram matrix has the squares of the singular values, each off by rounding of the largest. Where one that matters is
# smaller than this share of it they are taken from an SVD, so that at least 11 digits remain.
_SMALLEST_SQUARE = 1e-4


def principal_axes(centered: NDArray[np.float64], n_axes: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the first principal axes of centered vectors.

    Parameters
    ----------
    centered : ndarray of shape (n_walks, n_features)
        Less their mean.
    n_axes : int
        How many; fewer are returned where the smaller side of `centered` is shorter.

    Returns
    -------
    squares : ndarray of shape (n_axes,)
        Sums of squares of the scores, in descending order.
    axes : ndarray of shape (n_axes, n_features)
        Unit vectors.
    """
    n_walks, n_features = centered.shape
    size = min(n_walks, n_features)
    n_axes = min(n_axes, size)
    gram = centered @ centered.T if n_walks < n_features else centered.T @ centered
    if size > _LARGE and 4 * n_axes < size:
        squares, vectors = eigh(gram, subset_by_index=(size - n_axes, size - 1), overwrite_a=True, check_finite=False)
    else:
        squares, vectors = np.linalg.eigh(gram)
    squares, axes = squares[: -n_axes - 1 : -1], vectors.T[: -n_axes - 1 : -1]
    if squares[-1] <= _SMALLEST_SQUARE * squares[0]:
        _, lengths, directions = np.linalg.svd(centered, full_matrices=False)
        return lengths[:n_axes] ** 2, directions[:n_axes]
    if n_walks < n_features:
        axes = axes @ centered / np.sqrt(squares)[:, np.newaxis]
    return squares, axes


def decompose(
    centered: NDArray[np.float64], n_axes: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return U, s and V' of centered vectors = U diag(s) V', exact as far as the first axes are concerned.

    Parameters
    ----------
    centered : ndarray of shape (n_walks, n_features)
        Less their mean.
    n_axes : int
        How many of the axes matter. Those after them may be off by rounding of the first.

    Returns
    -------
    left : ndarray of shape (n_walks, rank)
    lengths : ndarray of shape (rank,)
        In descending order.
    right : ndarray of shape (rank, n_features)
    """
    n_walks, n_features = centered.shape
    wide = n_walks < n_features
    squares, vectors = np.linalg.eigh(centered @ centered.T if wide else centered.T @ centered)
    squares, vectors = squares[::-1], vectors[:, ::-1]
    if squares[min(n_axes, len(squares)) - 1] <= _SMALLEST_SQUARE * squares[0]:
        left, lengths, right = np.linalg.svd(centered, full_matrices=False)
        rank = max(1, int(np.sum(lengths > _EPS * max(centered.shape) * lengths[0])))
        return left[:, :rank].copy(), lengths[:rank], right[:rank]
    rank = int(np.sum(squares > _EPS * max(centered.shape) * squares[0]))
    lengths, vectors = np.sqrt(squares[:rank]), vectors[:, :rank]
    if wide:
        return vectors.copy(), lengths, vectors.T @ centered / lengths[:, np.newaxis]
    return centered @ vectors / lengths, lengths, vectors.T


def inverse_squares(squares: NDArray[np.float64], n_walks: int) -> NDArray[np.float64]:
    """Return 1 / square of each axis, and 0 where least squares on the scores would take them for zero.

    Parameters
    ----------
    squares : ndarray of shape (..., n_axes)
        Sums of squares of the scores.
    n_walks : int
        How many walks they are of.
    """
    lengths = np.sqrt(np.maximum(squares, 0.0))
    # As `numpy.linalg.lstsq` has it for a design of a column of ones beside the scores.
    largest = np.maximum(np.sqrt(n_walks), lengths.max(axis=-1, keepdims=True))
    smallest = _EPS * max(n_walks, 1 + squares.shape[-1]) * largest
    return np.divide(1.0, squares, out=np.zeros_like(lengths), where=lengths > smallest)
