"""Whether to believe a trait axis: leave-one-out prediction with everything refitted, and permutation tests."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import TransformerMixin, clone
from sklearn.utils import check_random_state

__all__ = ["PermutationResult", "loo_matrix", "permutation_test"]


class PermutationResult(NamedTuple):
    """What `permutation_test` returns.

    Parameters
    ----------
    accuracy : float
        Share of walkers whose group is predicted, leaving each out in turn.
    p_value : float
        Share of shuffled labels, the given ones counted in, that are predicted at least as well.
    null : ndarray of shape (n_permutations,)
        Accuracies with shuffled labels.
    """

    accuracy: float
    p_value: float
    null: NDArray[np.float64]


def loo_matrix(vectors: ArrayLike, reduction: TransformerMixin) -> NDArray[np.float64]:
    """Return the matrix M that turns labels into their leave-one-out predictions, M y.

    For each walker the reduction (scaling, PCA) is fitted on all others, labels are regressed on their scores with
    intercept (Troje 2002, Eq. 5), and the walker left out is predicted. All of it is linear in the labels, so that
    one matrix serves every trait and every permutation. Fitting the PCA on everyone instead leaks.

    Parameters
    ----------
    vectors : array-like of shape (n_walkers, n_features)
        From `FourierLinearizer`, which learns nothing across walkers.
    reduction : transformer
        A PCA, or a Pipeline of scaler and PCA. Clones of it are fitted.

    Returns
    -------
    ndarray of shape (n_walkers, n_walkers)
        With a zero diagonal.

    Examples
    --------
    >>> import numpy as np
    >>> from sklearn.decomposition import PCA
    >>> from eigenwalker.model import loo_matrix
    >>> vectors = np.arange(4.0)[:, np.newaxis] * [1.0, 2.0]
    >>> (loo_matrix(vectors, PCA(1)) @ [0.0, 1.0, 2.0, 3.0]).round(6) + 0
    array([0., 1., 2., 3.])
    """
    vectors = np.asarray(vectors, dtype=np.float64)
    matrix = np.zeros((len(vectors), len(vectors)))
    for left_out in range(len(vectors)):
        others = np.delete(np.arange(len(vectors)), left_out)
        fitted = clone(reduction).fit(vectors[others])
        scores = np.asarray(fitted.transform(vectors))
        design = np.column_stack((np.ones(len(vectors)), scores))
        matrix[left_out, others] = design[left_out] @ np.linalg.pinv(design[others])
    return matrix


def permutation_test(
    matrix: NDArray[np.float64],
    codes: ArrayLike,
    *,
    n_permutations: int = 10_000,
    random_state: int | np.random.RandomState | None = None,
) -> PermutationResult:
    """Return how well two groups are told apart, and how often shuffled labels do as well.

    Parameters
    ----------
    matrix : ndarray of shape (n_walkers, n_walkers)
        From `loo_matrix`.
    codes : array-like of shape (n_walkers,)
        -1 and +1.
    n_permutations : int, default 10000
        Number of shuffles.
    random_state : int, RandomState or None, default None
        Seed of the shuffles.

    Returns
    -------
    PermutationResult

    Raises
    ------
    ValueError
        If `codes` are not -1 and +1.
    """
    codes = np.asarray(codes, dtype=np.float64)
    if set(np.unique(codes)) != {-1.0, 1.0} or codes.shape != (len(matrix),):
        raise ValueError(f"codes must be -1 and +1, one for each of {len(matrix)} walkers, got {codes!r}")
    rng = check_random_state(random_state)
    accuracy = float(np.mean(matrix @ codes * codes > 0))
    shuffled = np.stack([rng.permutation(codes) for _ in range(n_permutations)], axis=1)
    null = np.mean((matrix @ shuffled) * shuffled > 0, axis=0)
    p_value = (1 + np.sum(null >= accuracy - 1e-12)) / (1 + n_permutations)
    return PermutationResult(accuracy, float(p_value), null)
