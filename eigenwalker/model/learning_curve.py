"""How well persons who were never seen are predicted, against how many were."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import TransformerMixin
from sklearn.utils import check_random_state

from eigenwalker._validation import check_choice
from eigenwalker.model._resampling import fit_weighted, predict_weighted, varies
from eigenwalker.model._sample import Reduction, Sample, control_sample, take_labels, take_reduction, take_sample
from eigenwalker.model._scores import SCORES, TWO_VALUED_SCORES, by_person, score_columns

__all__ = ["LearningCurve", "learning_curve_walkers"]

_MOST_DRAWS = 100


class LearningCurve(NamedTuple):
    """What `learning_curve_walkers` returns. With y of shape (n_walks,) there is no axis of traits.

    Parameters
    ----------
    n_persons : ndarray of shape (n_sizes,)
        Numbers of persons learned from.
    scores : ndarray of shape (n_sizes, n_repeats, n_traits)
        Of the persons kept apart.
    mean, sd : ndarray of shape (n_sizes, n_traits)
        Over the repeats. The SD holds both who is learned from and who is predicted.
    """

    n_persons: NDArray[np.intp]
    scores: NDArray[np.float64]
    mean: NDArray[np.float64]
    sd: NDArray[np.float64]


def learning_curve_walkers(
    vectors: object,
    y: object,
    *,
    n_persons: Iterable[int] | None = None,
    n_components: int = 15,
    scaling: str | None = None,
    groups: ArrayLike | None = None,
    control: ArrayLike | None = None,
    score: str = "auto",
    n_test: int | None = None,
    n_repeats: int = 50,
    random_state: int | np.random.RandomState | None = None,
    n_scalars: int | None = None,
    weights: Mapping[str, float] | ArrayLike | None = None,
    linearizer: TransformerMixin | None = None,
) -> LearningCurve:
    """Return the score of persons kept apart, against the number of persons learned from.

    In each repeat `n_test` persons drawn at random are kept apart, and the first few of the others, in random order,
    are learned from: the same test for all numbers of persons. Everything is fitted on the persons learned from.

    Parameters
    ----------
    vectors : array-like of shape (n_walks, n_features), or list of Walk
        See `loo_predict`.
    y : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_traits)
        Labels; see `loo_predict`.
    n_persons : sequence of int, default None
        Numbers of persons to learn from. None is five of them, evenly spaced, from `n_components` + 2 to all that are
        not kept apart.
    n_components, scaling, groups, control
        See `loo_predict`.
    score : {"auto", "accuracy", "balanced_accuracy", "auc", "r"}, default "auto"
        See `permutation_test`. Where a person has one label, the mean prediction of the person's walks counts. "auto"
        is "auc" when all traits have two groups, else "r".
    n_test : int, default None
        How many persons are kept apart. None is a fifth, at least 3.
    n_repeats : int, default 50
        Number of draws. Draws with one label only, in the test or in the smallest number to learn from, are repeated.
    random_state : int, RandomState or None, default None
        Seed of the draws.
    n_scalars, weights, linearizer
        See `loo_predict`.

    Returns
    -------
    LearningCurve

    Raises
    ------
    ValueError
        If a number of persons is too small for `n_components` or too large, or hardly a draw has two different labels.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import learning_curve_walkers
    >>> random = np.random.default_rng(0)
    >>> weight = random.normal(size=60)
    >>> vectors = random.normal(size=(60, 8)) + weight[:, np.newaxis] * np.linspace(1, 0, 8)
    >>> curve = learning_curve_walkers(vectors, weight, n_persons=[8, 48], n_components=4, random_state=0)
    >>> bool(curve.mean[1] > curve.mean[0])
    True
    """
    check_choice(score, ("auto", *SCORES), name="score")
    sample = take_sample(
        vectors, groups, scaling, n_scalars=n_scalars, weights=weights, linearizer=linearizer, n_persons=6
    )
    labels = take_labels(y, len(sample.vectors))
    sample = control_sample(sample, control, labels)
    if score == "auto":
        score = "auc" if all(labels.two_valued) else "r"
    if score in TWO_VALUED_SCORES and not all(labels.two_valued):
        raise ValueError(f"score={score!r} needs two groups, as two words or -1 and +1, for every trait; use 'r'")
    reduction = take_reduction(n_components, scaling, sample)
    n_test = max(3, sample.n_persons // 5) if n_test is None else n_test
    sizes = _take_sizes(n_persons, sample.n_persons - n_test, reduction.n_components)
    random = check_random_state(random_state)
    scores = np.empty((len(sizes), n_repeats, labels.codes.shape[1]))
    for repeat in range(n_repeats):
        order = _draw(sample, labels.codes, n_test, int(sizes.min()), random)
        for row, size in zip(scores, sizes, strict=True):
            counts = np.zeros(sample.n_persons, dtype=np.intp)
            counts[order[n_test : n_test + size]] = 1
            row[repeat] = _score_apart(sample, labels.codes, counts, order[:n_test], reduction, score)
    scores = scores[..., 0] if labels.is_single else scores
    return LearningCurve(sizes, scores, scores.mean(axis=1), scores.std(axis=1, ddof=1 if n_repeats > 1 else 0))


def _take_sizes(n_persons: Iterable[int] | None, n_most: int, n_components: int) -> NDArray[np.intp]:
    n_fewest = n_components + 2
    if n_persons is None and n_fewest <= n_most:
        return np.unique(np.linspace(n_fewest, n_most, 5).round().astype(np.intp))
    sizes = np.asarray(list(n_persons or []), dtype=np.intp)
    if not len(sizes) or sizes.min() < n_fewest or sizes.max() > n_most:
        raise ValueError(
            f"n_persons must be between n_components + 2 = {n_fewest} and the {n_most} who are not kept apart, "
            f"got {sizes.tolist() or 'no such number'}; use fewer components or a smaller n_test"
        )
    return sizes


def _draw(
    sample: Sample, codes: NDArray[np.float64], n_test: int, n_fewest: int, random: np.random.RandomState
) -> NDArray[np.intp]:
    """Return persons in random order: those kept apart, then those to learn from."""
    for _ in range(_MOST_DRAWS):
        order = random.permutation(sample.n_persons)
        counts = np.zeros((2, sample.n_persons), dtype=np.intp)
        counts[0, order[:n_test]] = 1
        counts[1, order[n_test : n_test + n_fewest]] = 1
        if varies(counts, sample.persons, codes).all():
            return order
    raise ValueError(
        f"expected draws with two different labels of every trait, got none in {_MOST_DRAWS}; raise n_test or n_persons"
    )


def _score_apart(
    sample: Sample,
    codes: NDArray[np.float64],
    counts: NDArray[np.intp],
    tested: NDArray[np.intp],
    reduction: Reduction,
    score: str,
) -> NDArray[np.float64]:
    """Return the score of the persons kept apart, shape (n_traits,)."""
    walks = np.isin(sample.persons, tested)
    predicted = predict_weighted(fit_weighted(sample, codes, counts, reduction), sample.vectors[walks])
    pairs = [by_person(*pair, sample.persons[walks]) for pair in zip(predicted.T, codes[walks].T, strict=True)]
    return np.array([score_columns(guess[:, np.newaxis], truth[:, np.newaxis], score)[0] for guess, truth in pairs])
