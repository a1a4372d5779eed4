"""Walks of the same person."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.utils.validation import check_consistent_length

__all__ = ["mean_by_person", "number_persons"]


def number_persons(groups: ArrayLike | None, n_walks: int) -> NDArray[np.intp]:
    """Return the number of the person each walk is of; without groups each walk is a person."""
    if groups is None:
        return np.arange(n_walks)
    check_consistent_length(np.empty(n_walks), groups)
    return np.unique(np.asarray(groups), return_inverse=True)[1]


def mean_by_person(values: NDArray[np.float64], persons: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return the mean over each person's walks, shape (n_persons, n_columns)."""
    sums = np.zeros((int(persons.max()) + 1, values.shape[1]))
    np.add.at(sums, persons, values)
    return sums / np.bincount(persons)[:, np.newaxis]
