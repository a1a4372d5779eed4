"""How well predictions agree with labels: one score for each of many columns."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from eigenwalker.model._persons import mean_by_person

__all__ = ["SCORES", "TWO_VALUED_SCORES", "by_person", "score_columns"]

Columns = NDArray[np.float64]


def score_columns(predicted: Columns, labels: Columns, score: str) -> Columns:
    """Return the score of each column of predictions.

    Parameters
    ----------
    predicted, labels : ndarray of shape (n_walks, n_columns)
        Predictions and labels; -1 and +1 for all scores but "r".
    score : {"accuracy", "balanced_accuracy", "auc", "r"}
        Which score; see `permutation_test`.

    Returns
    -------
    ndarray of shape (n_columns,)
        NaN where there is only one class; an r of 0 where nothing varies.
    """
    return SCORES[score](predicted, labels)


def by_person(
    predicted: NDArray[np.float64], labels: NDArray[np.float64], persons: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean prediction and the label of each person; of each walk where persons have several labels.

    Walks without a label (NaN) do not count.

    Parameters
    ----------
    predicted, labels : ndarray of shape (n_walks,)
        Of one trait.
    persons : ndarray of int of shape (n_walks,)
        Which person each walk is of.
    """
    known = ~np.isnan(labels)
    predicted, labels = predicted[known], labels[known]
    _, firsts, numbers = np.unique(persons[known], return_index=True, return_inverse=True)
    if not np.array_equal(labels[firsts][numbers], labels):
        return predicted, labels
    return mean_by_person(predicted[:, np.newaxis], numbers)[:, 0], labels[firsts]


def _accuracies(predicted: Columns, labels: Columns) -> Columns:
    return np.mean(predicted * labels > 0, axis=0)


def _balanced_accuracies(predicted: Columns, labels: Columns) -> Columns:
    right = predicted * labels > 0
    positive = labels > 0
    n_positive = positive.sum(axis=0)
    with np.errstate(invalid="ignore"):
        shares = (
            (right & positive).sum(axis=0) / n_positive,
            (right & ~positive).sum(axis=0) / (len(labels) - n_positive),
        )
    return (shares[0] + shares[1]) / 2


def _areas(predicted: Columns, labels: Columns) -> Columns:
    """Return the area under the curve: how often a +1 is predicted above a -1, ties counting half (Mann-Whitney)."""
    order = np.argsort(predicted, axis=0)
    ranked = np.take_along_axis(predicted, order, axis=0)
    positive = np.take_along_axis(labels > 0, order, axis=0)
    n_positive = positive.sum(axis=0)
    sums = np.arange(1.0, 1 + len(labels)) @ positive
    tied = (np.diff(ranked, axis=0) == 0).any(axis=0)
    if tied.any():
        sums[tied] = np.where(labels[:, tied] > 0, rankdata(predicted[:, tied], axis=0), 0.0).sum(axis=0)
    with np.errstate(invalid="ignore"):
        return (sums - n_positive * (n_positive + 1) / 2) / (n_positive * (len(labels) - n_positive))


def _correlations(predicted: Columns, labels: Columns) -> Columns:
    guesses, truths = predicted - predicted.mean(axis=0), labels - labels.mean(axis=0)
    lengths = np.sqrt((guesses**2).sum(axis=0) * (truths**2).sum(axis=0))
    products = (guesses * truths).sum(axis=0)
    return np.divide(products, lengths, out=np.zeros_like(products), where=lengths > 0)


SCORES: dict[str, Callable[[Columns, Columns], Columns]] = {
    "accuracy": _accuracies,
    "balanced_accuracy": _balanced_accuracies,
    "auc": _areas,
    "r": _correlations,
}
TWO_VALUED_SCORES = ("accuracy", "balanced_accuracy", "auc")
