"""Means of persons whose walks come in parts."""

from collections.abc import Hashable, Iterator

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

__all__ = ["PersonMeans"]


class PersonMeans:
    """The mean over each person's walks, and how walks differ within persons.

    Attributes
    ----------
    counts : dict of hashable to int
        How many walks each person has.
    means : dict of hashable to ndarray of shape (n_features,)
        Their mean.
    squares : ndarray of shape (n_features,)
        Sum over all walks of the squared difference from their person's mean.
    """

    def __init__(self, n_features: int) -> None:
        self.counts: dict[Hashable, int] = {}
        self.means: dict[Hashable, NDArray[np.float64]] = {}
        self.squares = np.zeros(n_features)

    def update(self, vectors: NDArray[np.floating], groups: ArrayLike) -> None:
        """Add walks, shape (n_walks, n_features), and the person each is of."""
        for person, walks in _by_person(groups, len(vectors)):
            own = vectors[walks].astype(np.float64)
            mean = own.mean(axis=0)
            self.squares += ((own - mean) ** 2).sum(axis=0)
            self._join(person, len(own), mean)

    def merge(self, other: "PersonMeans") -> None:
        """Add the walks of others, or other walks of the same."""
        self.squares += other.squares
        for person, count in other.counts.items():
            self._join(person, count, other.means[person])

    def table(self) -> NDArray[np.float64]:
        """Return the means, persons in ascending order, shape (n_persons, n_features)."""
        persons = list(self.means)
        order = np.argsort(np.asarray(persons), kind="stable")
        return np.stack([self.means[persons[place]] for place in order])

    def within(self) -> NDArray[np.float64]:
        """Return the SD between walks of one person, pooled over persons, shape (n_features,)."""
        n_free = sum(self.counts.values()) - len(self.counts)
        if n_free < 1:
            raise ValueError(
                f"unit='noise' needs persons with two walks or more, got {len(self.counts)} persons with one each; "
                "use unit='features'"
            )
        return np.sqrt(self.squares / n_free)

    def _join(self, person: Hashable, count: int, mean: NDArray[np.float64]) -> None:
        known = self.counts.get(person, 0)
        gap = mean - self.means.get(person, mean)
        self.squares += gap**2 * (known * (count / (known + count)))
        self.counts[person] = known + count
        self.means[person] = mean - gap * (known / (known + count))


def _by_person(groups: ArrayLike, n_walks: int) -> Iterator[tuple[Hashable, NDArray[np.intp]]]:
    """Yield each person with the places of its walks."""
    persons = np.asarray(groups)
    if persons.shape != (n_walks,):
        raise ValueError(f"groups must have one entry a walk, {n_walks}, got shape {persons.shape}")
    if pd.isna(persons).any():
        raise ValueError(f"groups must name the person of every walk, got {int(pd.isna(persons).sum())} missing ones")
    names, numbers = np.unique(persons, return_inverse=True)
    places = np.argsort(numbers, kind="stable")
    yield from zip(names.tolist(), np.split(places, np.cumsum(np.bincount(numbers))[:-1]), strict=True)
