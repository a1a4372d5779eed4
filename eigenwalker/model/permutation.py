"""Permutation tests of trait axes: how often shuffled labels do as well."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import TransformerMixin
from sklearn.utils import check_random_state

from eigenwalker._validation import check_choice
from eigenwalker.model._persons import mean_by_person, number_persons
from eigenwalker.model._sample import (
    Labels,
    control_sample,
    take_labels,
    take_reduction,
    take_sample,
)
from eigenwalker.model._scores import SCORES, TWO_VALUED_SCORES, score_columns
from eigenwalker.model.leave_one_out import matrix_of_others

__all__ = ["PermutationResult", "permutation_test"]

_CHUNK = 2**22  # predictions at a time


class PermutationResult(NamedTuple):
    """What `permutation_test` returns.

    Parameters
    ----------
    score : float, or ndarray of shape (n_traits,)
        Of the predictions, leaving each person out in turn.
    p_value : float, or ndarray of shape (n_traits,)
        Share of shuffled labels, the given ones counted in, that are predicted at least as well.
    null : ndarray of shape (n_permutations,) or (n_permutations, n_traits)
        Scores with shuffled labels.
    """

    score: float | NDArray[np.float64]
    p_value: float | NDArray[np.float64]
    null: NDArray[np.float64]


def permutation_test(
    vectors: object,
    y: object,
    groups: ArrayLike | None = None,
    *,
    score: str = "accuracy",
    strata: ArrayLike | None = None,
    n_permutations: int = 10_000,
    random_state: int | np.random.RandomState | None = None,
    n_components: int | None = None,
    scaling: str | None = None,
    control: ArrayLike | None = None,
    n_scalars: int | None = None,
    weights: Mapping[str, float] | ArrayLike | None = None,
    linearizer: TransformerMixin | None = None,
) -> PermutationResult:
    """Return how well labels are predicted for persons left out, and how often shuffled labels do as well.

    With B shuffles p = (1 + number of shuffles with a score of at least that of the given labels) / (1 + B), ties
    counted against the labels, so that P(p <= a) <= a when the labels mean nothing. Each shuffle is a leave-one-out of
    its own, with everything refitted: all of them are one product with `loo_matrix`.

    Parameters
    ----------
    vectors : ndarray of shape (n_walks, n_walks), or as for `loo_predict`
        The matrix of `loo_matrix`; or vectors or walks, beside `n_components`.
    y : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_traits)
        Numbers, or two words. The labels of all traits are shuffled together. A walk without a label (NaN) keeps none,
        and needs vectors in place of a matrix, because the matrix depends on who has one.
    groups : array-like of shape (n_walks,), default None
        Which person each walk is of, as for `loo_matrix`: a person has one label, the mean prediction of a person's
        walks counts, and labels are shuffled between persons.
    score : {"accuracy", "balanced_accuracy", "auc", "r"}, default "accuracy"
        Share of persons whose group is predicted, which is the sign; the mean of that over both groups; the area under
        the receiver operating characteristic curve, which asks for no boundary between the groups; or the correlation
        of prediction and label. The boundary is at 0, as with ``TraitClassifier(boundary="zero")``. That of "midpoint"
        is not linear in the labels; with groups of unequal size take "auc".
    strata : array-like of shape (n_walks,), default None
        Labels are shuffled only among persons of the same stratum. For labels that differ between the walks of one
        person pass the persons as `strata`, and a matrix of ``loo_matrix(..., groups=persons)``, without `groups` here.
    n_permutations : int, default 10000
        Number of shuffles.
    random_state : int, RandomState or None, default None
        Seed of the shuffles.
    n_components : int, default None
        How many Eigenwalkers, when `vectors` is not a matrix.
    scaling, control, n_scalars, weights, linearizer
        See `loo_predict`. Control variables stay with their walks; where labels go along with them, shuffle within
        `strata` of about equal control.

    Returns
    -------
    PermutationResult

    Raises
    ------
    ValueError
        If labels or strata differ between walks of a person, if the labels are not two groups but the score asks for
        them, or if the matrix is not square.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import permutation_test
    >>> vectors = np.column_stack((np.arange(8.0), np.arange(8.0) % 3))
    >>> weight = [50, 53, 58, 60, 68, 70, 74, 79]
    >>> test = permutation_test(vectors, weight, n_components=2, score="r", n_permutations=999, random_state=0)
    >>> round(test.score, 2), test.p_value
    (0.99, 0.001)
    """
    check_choice(score, tuple(SCORES), name="score")
    if n_permutations < 1:
        raise ValueError(f"n_permutations must be at least 1, got {n_permutations!r}")
    if n_components is None:
        if control is not None:
            raise ValueError("control needs vectors and n_components; a matrix has it from loo_matrix(control=...)")
        matrix = _check_matrix(vectors)
        persons = number_persons(groups, len(matrix))
    else:
        sample = take_sample(vectors, groups, scaling, n_scalars=n_scalars, weights=weights, linearizer=linearizer)
        persons = sample.persons
    labels = take_labels(y, len(persons))
    if n_components is not None:
        sample = control_sample(sample, control, labels)
        reduction = take_reduction(n_components, scaling, sample)
    _check_score(labels, score)
    codes = _one_each(labels.codes, persons, "labels")
    blocks = np.zeros(len(persons)) if strata is None else number_persons(strata, len(persons)).astype(np.float64)
    blocks = _one_each(blocks[:, np.newaxis], persons, "strata")[:, 0]
    unlabelled = np.isnan(labels.codes)
    if n_components is None and unlabelled.any():
        raise ValueError("y must have no missing labels beside a matrix; pass vectors and n_components instead")
    seed = check_random_state(random_state).randint(2**31 - 1)
    scores = np.empty((1 + n_permutations, codes.shape[1]))
    for trait, own in enumerate(codes.T):
        if n_components is not None and (trait == 0 or (unlabelled[:, trait] != unlabelled[:, trait - 1]).any()):
            matrix = matrix_of_others(sample, reduction, np.array([reduction.n_components]), ~unlabelled[:, trait])[0]
        # All traits see the same shuffles.
        keys = _shuffle_keys(np.random.RandomState(seed), n_permutations, blocks)
        scores[:, trait] = _score_shuffles(_between_persons(matrix, persons), own, blocks, keys, score)
    # Equal scores may differ in their rounding.
    p_values = np.sum(scores >= scores[0] - 1e-12, axis=0) / (1 + n_permutations)
    if labels.is_single:
        return PermutationResult(float(scores[0, 0]), float(p_values[0]), scores[1:, 0])
    return PermutationResult(scores[0], p_values, scores[1:])


def _check_matrix(matrix: object) -> NDArray[np.float64]:
    array = np.asarray(matrix, dtype=np.float64)
    if array.ndim != 2 or array.shape[0] != array.shape[1]:
        raise ValueError(
            f"expected the square matrix of loo_matrix, got shape {array.shape}; pass n_components beside vectors"
        )
    return array


def _check_score(labels: Labels, score: str) -> None:
    """Refuse labels other than two groups where the score asks for these, all faults at once."""
    if score not in TWO_VALUED_SCORES:
        return
    many = [name for name, two_valued in zip(labels.names, labels.two_valued, strict=True) if not two_valued]
    if many:
        raise ValueError(
            f"score={score!r} needs two groups, as two words or -1 and +1, but {', '.join(map(repr, many))} has other "
            "numbers; use score='r'"
        )


def _one_each(values: NDArray[np.float64], persons: NDArray[np.intp], name: str) -> NDArray[np.float64]:
    """Return the one value of each person, shape (n_persons, n_columns)."""
    first = np.unique(persons, return_index=True)[1]
    if not np.array_equal(values, values[first][persons], equal_nan=True):
        raise ValueError(
            f"{name} must be the same for all walks of a person, but some persons have several; to shuffle the walks "
            "of a person among each other, pass the persons as strata and not as groups"
        )
    return values[first]


def _between_persons(matrix: NDArray[np.float64], persons: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return the matrix that turns the labels of persons into the mean predictions of their walks."""
    sums = np.zeros((int(persons.max()) + 1, len(matrix)))
    np.add.at(sums, persons, matrix.T)
    return mean_by_person(sums.T, persons)


def _shuffle_keys(
    random: np.random.RandomState, n_permutations: int, blocks: NDArray[np.float64]
) -> Iterator[NDArray[np.float64]]:
    """Yield numbers whose order is that of the shuffles, shape (n_some, n_persons), strata one after the other."""
    n_rows = max(1, _CHUNK // len(blocks))
    for start in range(0, n_permutations, n_rows):
        yield blocks + random.random_sample((min(n_rows, n_permutations - start), len(blocks)))


def _score_shuffles(
    matrix: NDArray[np.float64],
    labels: NDArray[np.float64],
    blocks: NDArray[np.float64],
    keys: Iterator[NDArray[np.float64]],
    score: str,
) -> NDArray[np.float64]:
    """Return the score of the labels and of each shuffle; persons without a label keep none and do not count."""
    known = ~np.isnan(labels)
    matrix, labels = matrix[np.ix_(known, known)], labels[known]
    scores = [score_columns((matrix @ labels)[:, np.newaxis], labels[:, np.newaxis], score)]
    places = np.argsort(blocks[known], kind="stable")  # of the strata, one after the other
    for some in keys:
        shuffled = np.empty((len(some), len(labels)))
        shuffled[:, places] = labels[np.argsort(some[:, known], axis=1)]
        scores.append(score_columns((shuffled @ matrix.T).T, shuffled.T, score))
    return np.concatenate(scores)
