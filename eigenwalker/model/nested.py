"""Leave-one-out that chooses its number of Eigenwalkers, and leaves one out of that as well."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray
from sklearn.base import TransformerMixin

from eigenwalker._validation import check_choice
from eigenwalker.model._sample import Reduction, Sample, control_sample, take_components, take_labels, take_sample
from eigenwalker.model.leave_one_out import predict_by_others

__all__ = ["NestedResult", "nested_loo"]


class NestedResult(NamedTuple):
    """What `nested_loo` returns. With y of shape (n_walks,) there is no axis of traits.

    Parameters
    ----------
    predictions : ndarray of shape (n_walks, n_traits)
        Of each person, by the number of components that is best for the others among themselves.
    n_components : ndarray of shape (n_walks, n_traits)
        The number chosen for each walk's person.
    score : ndarray of shape (n_traits,)
        Accuracy, or mean squared error, of `predictions`.
    candidates : ndarray of shape (n_candidates,)
        The numbers to choose from.
    curve : ndarray of shape (n_candidates, n_traits)
        The same score of plain leave-one-out with each number. Its best value is optimistic: the number was chosen on
        the persons it is scored on.
    """

    predictions: NDArray[np.float64]
    n_components: NDArray[np.intp]
    score: NDArray[np.float64]
    candidates: NDArray[np.intp]
    curve: NDArray[np.float64]


def nested_loo(
    vectors: object,
    y: object,
    *,
    n_components: Iterable[int] | None = None,
    criterion: str = "auto",
    scaling: str | None = None,
    groups: ArrayLike | None = None,
    control: ArrayLike | None = None,
    n_scalars: int | None = None,
    weights: Mapping[str, float] | ArrayLike | None = None,
    linearizer: TransformerMixin | None = None,
    n_jobs: int | None = None,
) -> NestedResult:
    """Return predictions of persons left out, with the number of components chosen on the others alone.

    For each person, all others are left out in turn a second time, with every number of components; the best, the
    smallest of equals, then predicts the person. It is chosen for each trait by itself. Each person counts the same,
    however many walks there are. Nothing is approximated.

    Parameters
    ----------
    vectors : array-like of shape (n_walks, n_features), or list of Walk
        See `loo_predict`.
    y : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_traits)
        Labels; see `loo_predict`.
    n_components : sequence of int or None, default None
        The numbers to choose from. None is every number from 1 to the rank that is left with two persons out.
    criterion : {"auto", "accuracy", "error"}, default "auto"
        What is best: the highest accuracy, or the smallest mean squared error. "auto" is accuracy for traits with two
        groups (two words, or -1 and +1), error for numbers.
    scaling, groups, control, n_scalars, weights, linearizer
        See `loo_predict`.
    n_jobs : int, default None
        Processes, as joblib counts them. The result does not depend on it.

    Returns
    -------
    NestedResult

    Raises
    ------
    ValueError
        If there are fewer than four persons, or accuracy is asked for and a trait has no two groups.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import nested_loo
    >>> random = np.random.default_rng(0)
    >>> height = random.normal(size=30)
    >>> vectors = random.normal(size=(30, 6)) * [3.0, 2.0, 1.0, 0.5, 0.5, 0.5]
    >>> vectors[:, 1] += 3 * height
    >>> result = nested_loo(vectors, height)
    >>> result.predictions.shape, bool(result.score >= result.curve.min())
    ((30,), True)
    """
    check_choice(criterion, ("auto", "accuracy", "error"), name="criterion")
    sample = take_sample(
        vectors, groups, scaling, n_scalars=n_scalars, weights=weights, linearizer=linearizer, n_persons=4
    )
    labels = take_labels(y, len(sample.vectors))
    sample = control_sample(sample, control, labels)
    two_valued = np.array(labels.two_valued)
    if criterion == "accuracy" and not two_valued.all():
        wrong = [name for name, fits in zip(labels.names, two_valued, strict=True) if not fits]
        raise ValueError(f"criterion='accuracy' needs two groups, but {', '.join(map(repr, wrong))} has other numbers")
    by_accuracy = two_valued & (criterion != "error")
    numbers = take_components(n_components, sample, n_left_out=2)
    reduction = Reduction(int(numbers.max()), scaling)
    everyone = predict_by_others(sample, labels.codes, reduction, numbers)  # (n_candidates, n_walks, n_traits)
    without = [sample.persons != person for person in range(sample.n_persons)]
    chosen = Parallel(n_jobs=n_jobs)(
        delayed(_choose_without)(sample.take(others), labels.codes[others], reduction, numbers, by_accuracy)
        for others in without
    )
    choices = np.empty(labels.codes.shape, dtype=np.intp)
    for others, choice in zip(without, chosen, strict=True):
        choices[~others] = choice
    predictions = np.take_along_axis(everyone, choices[np.newaxis], axis=0)
    sign = np.where(by_accuracy, 1.0, -1.0)
    score = sign * _goodness(predictions, labels.codes, sample.persons, by_accuracy)[0]
    curve = sign * _goodness(everyone, labels.codes, sample.persons, by_accuracy)
    result = NestedResult(predictions[0], numbers[choices], score, numbers, curve)
    if not labels.is_single:
        return result
    return NestedResult(predictions[0, :, 0], numbers[choices][:, 0], score[0], numbers, curve[:, 0])


def _choose_without(
    sample: Sample,
    codes: NDArray[np.float64],
    reduction: Reduction,
    numbers: NDArray[np.intp],
    by_accuracy: NDArray[np.bool_],
) -> NDArray[np.intp]:
    """Return which of the numbers is best for some persons among themselves, for each trait."""
    predicted = predict_by_others(sample, codes, reduction, numbers)
    return _choose(_goodness(predicted, codes, sample.persons, by_accuracy))


def _goodness(
    predicted: NDArray[np.float64],
    codes: NDArray[np.float64],
    persons: NDArray[np.intp],
    by_accuracy: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """Return accuracy or minus the mean squared error, shape (n_candidates, n_traits), of the walks with a label."""
    known = ~np.isnan(codes)
    truth = np.where(known, codes, 0.0)
    value = np.where(by_accuracy, predicted * truth > 0, -((predicted - truth) ** 2))
    weights = np.stack([_weights(persons, column) for column in known.T], axis=1)  # (n_walks, n_traits)
    return (value * weights).sum(axis=1)


def _weights(persons: NDArray[np.intp], known: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return weights that sum to 1, the same for each person with a label, and so for the labelled walks of each."""
    counts = np.bincount(persons[known], minlength=int(persons.max()) + 1)
    return known / (np.maximum(counts, 1)[persons] * np.maximum((counts > 0).sum(), 1))


def _choose(goodness: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the position of the first candidate that is as good as the best, for each trait."""
    return np.argmax(goodness >= goodness.max(axis=0) - 1e-12, axis=0)
