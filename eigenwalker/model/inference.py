"""Whether to believe a trait axis: leave-one-out prediction with everything refitted, and permutation tests."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import rankdata
from sklearn.base import TransformerMixin, clone
from sklearn.pipeline import Pipeline
from sklearn.utils import check_random_state
from sklearn.utils.validation import check_consistent_length

from eigenwalker._validation import check_choice

__all__ = ["PermutationResult", "loo_matrix", "permutation_test"]


class PermutationResult(NamedTuple):
    """What `permutation_test` returns.

    Parameters
    ----------
    score : float
        Accuracy or area under the curve of the predictions, leaving each walker out in turn.
    p_value : float
        Share of shuffled labels, the given ones counted in, that are predicted at least as well.
    null : ndarray of shape (n_permutations,)
        Scores with shuffled labels.
    """

    score: float
    p_value: float
    null: NDArray[np.float64]


def loo_matrix(vectors: ArrayLike, reduction: TransformerMixin, groups: ArrayLike | None = None) -> NDArray[np.float64]:
    """Return the matrix M that turns labels into their leave-one-out predictions, M y.

    For each walker the reduction (scaling, PCA) is fitted on all others, labels are regressed on their scores with
    intercept (Troje 2002, Eq. 5), and the walker left out is predicted. All of it is linear in the labels, so that
    one matrix serves every trait and every permutation. Fitting the PCA on everyone instead leaks.

    Parameters
    ----------
    vectors : array-like of shape (n_walks, n_features)
        From `FourierLinearizer`, which learns nothing across walkers.
    reduction : transformer
        A PCA, or a Pipeline of scaler and PCA. Clones of it are fitted.
    groups : array-like of shape (n_walks,), default None
        Which person each walk is of; all walks of a person are left out together. None takes each walk for a person.

    Returns
    -------
    ndarray of shape (n_walks, n_walks)
        Zero where both walks are of one person.

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
    persons = _numbered(groups, len(vectors))
    matrix = np.zeros((len(vectors), len(vectors)))
    for person in range(persons.max() + 1):
        others, left_out = np.flatnonzero(persons != person), persons == person
        fitted = clone(reduction).fit(vectors[others], **_group_options(reduction, persons[others]))
        scores = np.asarray(fitted.transform(vectors))
        design = np.column_stack((np.ones(len(vectors)), scores))
        matrix[np.ix_(left_out, others)] = design[left_out] @ np.linalg.pinv(design[others])
    return matrix


def _numbered(groups: ArrayLike | None, n_walks: int) -> NDArray[np.intp]:
    """Return the number of the person each walk is of."""
    if groups is None:
        return np.arange(n_walks)
    check_consistent_length(np.empty(n_walks), groups)
    return np.unique(np.asarray(groups), return_inverse=True)[1]


def _group_options(reduction: TransformerMixin, persons: NDArray[np.intp]) -> dict[str, Any]:
    """Return the argument of fit by which a Pipeline's step that scales by noise learns who is who."""
    steps = reduction.steps if isinstance(reduction, Pipeline) else []
    return {f"{name}__groups": persons for name, step in steps if getattr(step, "unit", None) == "noise"}


def permutation_test(
    matrix: NDArray[np.float64],
    codes: ArrayLike,
    groups: ArrayLike | None = None,
    *,
    score: str = "accuracy",
    n_permutations: int = 10_000,
    random_state: int | np.random.RandomState | None = None,
) -> PermutationResult:
    """Return how well two groups are told apart, and how often shuffled labels do as well.

    Parameters
    ----------
    matrix : ndarray of shape (n_walks, n_walks)
        From `loo_matrix`.
    codes : array-like of shape (n_walks,)
        -1 and +1.
    groups : array-like of shape (n_walks,), default None
        Which person each walk is of, as for `loo_matrix`: the mean prediction of a person's walks counts, and labels
        are shuffled between persons.
    score : {"accuracy", "auc"}, default "accuracy"
        Share of persons whose group is predicted, or the area under the receiver operating characteristic curve, which
        asks for no boundary between the groups.
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
        If `codes` are not -1 and +1, or differ between walks of a person.
    """
    check_choice(score, ("accuracy", "auc"), name="score")
    codes = np.asarray(codes, dtype=np.float64)
    if set(np.unique(codes)) != {-1.0, 1.0} or codes.shape != (len(matrix),):
        raise ValueError(f"codes must be -1 and +1, one for each of {len(matrix)} walks, got {codes!r}")
    persons = _numbered(groups, len(codes))
    counts = np.bincount(persons)
    of_person = np.bincount(persons, weights=codes) / counts
    if (np.abs(of_person) != 1.0).any():
        raise ValueError("codes must be the same for all walks of a person, but some persons have both -1 and +1")
    rng = check_random_state(random_state)
    shuffled = np.stack([of_person, *(rng.permutation(of_person) for _ in range(n_permutations))], axis=1)
    predicted = matrix @ shuffled[persons]  # (n_walks, 1 + n_permutations)
    means = np.zeros_like(shuffled)
    np.add.at(means, persons, predicted / counts[persons, np.newaxis])
    scores = np.mean(means * shuffled > 0, axis=0) if score == "accuracy" else _areas(means, shuffled)
    p_value = np.sum(scores >= scores[0] - 1e-12) / (1 + n_permutations)
    return PermutationResult(float(scores[0]), float(p_value), scores[1:])


def _areas(predicted: NDArray[np.float64], codes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the area under the curve in each column: how often a +1 is predicted above a -1 (Mann-Whitney)."""
    positive = codes > 0
    n_positive = positive.sum(axis=0)
    ranks = rankdata(predicted, axis=0)
    above = np.where(positive, ranks, 0.0).sum(axis=0) - n_positive * (n_positive + 1) / 2
    return above / (n_positive * (len(codes) - n_positive))
