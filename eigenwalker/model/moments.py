"""What a model needs to know of walks that come in parts: sums that can be added up, whoever added them."""

from collections.abc import Iterable, Iterator
from copy import copy, deepcopy
from functools import reduce
from typing import Any, NamedTuple, Self

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import check_names
from eigenwalker.model._columns import shorten, take_vectors
from eigenwalker.model._control import tabulate_controls
from eigenwalker.model._labels import tabulate
from eigenwalker.model._levels import Levels, add_levels, encode_part
from eigenwalker.model._person_means import PersonMeans
from eigenwalker.model._scatter import Scatter, add_scatters, few_rows, scale_columns, scatter_of

__all__ = ["Moments"]

_BLOCK = 2048  # rows that are added at a time, and held in float64 until then


class Total(NamedTuple):
    """What moments come to.

    Parameters
    ----------
    n_features : int
        How many of the columns are features; controls come next, then traits.
    controls, traits : list of Levels
        Their labels.
    has_names, is_single : bool
        Whether the labels had names, and were 1-D.
    everyone : Scatter
        Of all columns, over all walks.
    labeled : list of Scatter or None
        The same over the walks that have a label, one a trait; None where there are none.
    persons : PersonMeans or None
        Of the features.
    """

    n_features: int
    controls: list[Levels]
    traits: list[Levels]
    has_names: bool
    is_single: bool
    everyone: Scatter
    labeled: list[Scatter | None]
    persons: PersonMeans | None


class _Columns(NamedTuple):
    """What must be the same in every part."""

    n_features: int
    traits: list[str]
    has_names: bool
    is_single: bool
    controls: list[str] | None
    has_groups: bool

    def describe(self) -> str:
        controls = "no controls" if self.controls is None else f"the controls {', '.join(self.controls)}"
        shape = "1-D" if self.is_single else "2-D"
        return (
            f"{self.n_features} features, the {shape} labels {', '.join(self.traits)}, {controls} and "
            f"{'' if self.has_groups else 'no '}groups"
        )


class Moments:
    """Counts, means and scatter of feature vectors and their labels, added up part by part.

    They are exact: which part a walk comes in, and in which order parts are added, changes rounding only. Moments of
    parts can be had on other machines, pickled, and added: ``moments + others``, or, without copies,
    ``reduce(Moments.merge, several, Moments())``. `fit_moments` makes a model of them.

    What is held does not grow with the number of walks. With d features, labels and controls it is at most 2 d^2
    numbers (0.8 MB for 226 features) for each of the different patterns of missing labels there are, and where groups
    are given one vector a person (1.8 kB); beside them wait up to 2048 walks.

    Parameters
    ----------
    feature_names : sequence of str, default None
        From `FourierLinearizer.get_feature_names_out`. Features are then taken from a DataFrame by these names, beside
        whatever else is in it. None takes all columns, and their names from the first DataFrame.

    Attributes
    ----------
    feature_names : list of str or None
        Names of the features.
    n_walks : int
        How many there were so far.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import Moments
    >>> vectors = np.array([[0.0, 1.0], [2.0, 5.0], [4.0, 3.0]])
    >>> one = Moments().update(vectors[:1], ["f"])
    >>> both = one + Moments().update(vectors[1:], ["m", "f"])
    >>> both
    Moments(3 walks, 2 features, traits: trait)
    >>> both.mean, both.scatter
    (array([2., 3.]), array([[8., 4.], [4., 8.]]))
    """

    def __init__(self, feature_names: Iterable[str] | None = None) -> None:
        self.feature_names = None if feature_names is None else list(check_names(feature_names, name="feature_names"))
        self._columns: _Columns | None = None
        self._levels: list[Levels] = []  # of controls, then of traits
        self._scatters: dict[tuple[bool, ...], Scatter] = {}  # by which traits have a label
        self._waiting: list[NDArray[np.float64]] = []  # rows of all columns, missing labels NaN
        self._persons: PersonMeans | None = None

    def update(
        self, X: ArrayLike, y: ArrayLike, *, control: ArrayLike | None = None, groups: ArrayLike | None = None
    ) -> Self:
        """Add walks.

        Parameters
        ----------
        X : DataFrame or array-like of shape (n_walks, n_features)
            Feature vectors. Sums of float32 are those of the same numbers in float64.
        y : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_traits)
            Labels, as `TraitRegressor` takes them.
        control : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_controls), default None
            As `TraitRegressor` takes them; in every part or in none.
        groups : array-like of shape (n_walks,), default None
            Which person each walk is of; in every part or in none. A person may be in several parts.

        Returns
        -------
        self
            As it was before, where an error is raised.

        Raises
        ------
        ValueError
            If columns are missing, values are not finite, or a part has other columns than those before.
        """
        vectors = take_vectors(X, self.feature_names)
        table = tabulate(y)
        _check_length("y", len(table), len(vectors))
        named = getattr(y, "columns", getattr(y, "name", None)) is not None
        is_single = len(getattr(y, "shape", np.shape(np.asarray(y)))) == 1
        controls = None if control is None else tabulate_controls(control, len(vectors), list(table))
        names = None if controls is None else list(controls)
        columns = _Columns(vectors.shape[1], list(table), named, is_single, names, groups is not None)
        self._check_columns(columns)
        if not len(vectors):
            return self
        labels = table if controls is None else pd.concat([controls, table], axis=1)
        known_levels = self._levels or [Levels(name, pd.Series(dtype=float)) for name in labels]
        pairs = [encode_part(levels, labels[levels.name]) for levels in known_levels]
        persons = PersonMeans(vectors.shape[1]) if groups is not None else None
        if persons is not None:
            persons.update(vectors, np.asarray(groups))
        self._columns, self._levels = columns, [levels for levels, _ in pairs]
        self.feature_names = self.feature_names or ([*map(str, X.columns)] if isinstance(X, pd.DataFrame) else None)
        self._add_persons(persons)
        self._add_rows(vectors, np.column_stack([numbers for _, numbers in pairs]))
        return self

    def merge(self, other: "Moments") -> Self:
        """Add the walks of other moments, which stay as they are.

        Parameters
        ----------
        other : Moments
            Of the same features, traits and controls.

        Returns
        -------
        self
            As it was before, where an error is raised.

        Raises
        ------
        ValueError
            If they are of other columns, or if their labels do not go together.
        """
        if not isinstance(other, Moments):
            raise TypeError(f"expected Moments, got {type(other).__name__}")
        if None not in (self.feature_names, other.feature_names) and self.feature_names != other.feature_names:
            raise ValueError(
                f"expected moments of the same features in the same order, got {_others(self.feature_names, other)}"
            )
        self._settle()
        other._settle()
        if other._columns is None:
            return self
        if self._columns is None:
            self.__dict__ |= deepcopy(other.__dict__) | {"feature_names": self.feature_names or other.feature_names}
            return self
        self._check_columns(other._columns)
        pairs = [add_levels(*levels) for levels in zip(self._levels, other._levels, strict=True)]
        signs = np.array([1.0] * other._columns.n_features + [sign for _, sign in pairs])
        self._levels = [levels for levels, _ in pairs]
        self.feature_names = self.feature_names or other.feature_names
        self._add_persons(deepcopy(other._persons))
        for pattern, scatter in other._scatters.items():
            self._add_scatter(pattern, scale_columns(scatter, signs))
        return self

    def __add__(self, other: "Moments") -> "Moments":
        if not isinstance(other, Moments):
            return NotImplemented
        self._settle()
        total = copy(self)
        total._scatters, total._persons, total._waiting = dict(self._scatters), deepcopy(self._persons), []
        return total.merge(other)

    def __radd__(self, other: int) -> "Moments":
        return self if other == 0 else NotImplemented  # sum() begins with 0

    def __getstate__(self) -> dict[str, Any]:
        self._settle()
        return self.__dict__.copy()

    def __repr__(self) -> str:
        if self._columns is None:
            return "Moments(0 walks)"
        return f"Moments({self.n_walks:,} walks, {self._columns.n_features} features, traits: {', '.join(self.traits)})"

    @property
    def n_walks(self) -> int:
        """How many walks there were so far."""
        return sum(scatter.n_walks for scatter in self._scatters.values()) + sum(map(len, self._waiting))

    @property
    def traits(self) -> list[str]:
        """Names of the traits."""
        return [] if self._columns is None else list(self._columns.traits)

    @property
    def mean(self) -> NDArray[np.float64]:
        """Mean of the features, shape (n_features,)."""
        return self.total().everyone.mean[: self._seen().n_features]

    @property
    def scatter(self) -> NDArray[np.float64]:
        """Sum over walks of (x - mean) (x - mean)', shape (n_features, n_features)."""
        rows = self.total().everyone.rows[:, : self._seen().n_features]
        return rows.T @ rows

    def total(self) -> Total:
        """Return what the moments come to, for `fit_moments`."""
        self._settle()
        columns = self._seen()
        n_controls = len(columns.controls or ())
        everyone = self._sum(list(self._scatters))
        groups = [[key for key in self._scatters if key[trait]] for trait in range(len(columns.traits))]
        return Total(
            columns.n_features,
            self._levels[:n_controls],
            self._levels[n_controls:],
            columns.has_names,
            columns.is_single,
            everyone,
            [everyone if len(keys) == len(self._scatters) else self._sum(keys) if keys else None for keys in groups],
            self._persons,
        )

    def _sum(self, patterns: list[tuple[bool, ...]]) -> Scatter:
        """Return the scatter of all walks whose labels are known or missing in one of these patterns."""
        return reduce(add_scatters, (self._scatters[pattern] for pattern in sorted(patterns)))

    def _seen(self) -> _Columns:
        if self._columns is None:
            raise ValueError("expected moments of at least one walk, got none; call update first")
        return self._columns

    def _check_columns(self, columns: _Columns) -> None:
        if self._columns is not None and columns != self._columns:
            raise ValueError(f"expected every part to have {self._columns.describe()}; got {columns.describe()}")

    def _add_persons(self, persons: PersonMeans | None) -> None:
        if self._persons is None:
            self._persons = persons
        elif persons is not None:
            self._persons.merge(persons)

    def _add_rows(self, vectors: NDArray[np.floating], numbers: NDArray[np.float64]) -> None:
        for start in range(0, len(vectors), _BLOCK):
            block = slice(start, start + _BLOCK)
            self._waiting.append(np.column_stack((vectors[block], numbers[block])))
            if sum(map(len, self._waiting)) >= _BLOCK:
                self._settle()

    def _settle(self) -> None:
        """Take rows that wait, so that parts of few rows are not taken one by one, into the scatters."""
        if not self._waiting:
            return
        rows = self._waiting[0] if len(self._waiting) == 1 else np.concatenate(self._waiting)
        self._waiting = []
        labels = rows[:, -len(self.traits) :]
        known = ~np.isnan(labels)
        labels[~known] = 0.0  # constant where they are missing, so that they have no part in any scatter
        for pattern, walks in _by_pattern(known):
            self._add_scatter(pattern, scatter_of(rows[walks]))

    def _add_scatter(self, pattern: tuple[bool, ...], scatter: Scatter) -> None:
        before = self._scatters.get(pattern)
        scatter = scatter._replace(rows=few_rows(scatter.rows)) if before is None else add_scatters(before, scatter)
        self._scatters[pattern] = scatter


def _others(names: list[str] | None, other: Moments) -> str:
    foreign = [name for name in other.feature_names or () if name not in set(names or ())]
    return f"also {shorten(foreign)}" if foreign else f"{len(other.feature_names or ())} in another order or number"


def _check_length(name: str, length: int, expected: int) -> None:
    if length != expected:
        raise ValueError(f"{name} must have one row a walk, {expected}, got {length}")


def _by_pattern(known: NDArray[np.bool_]) -> Iterator[tuple[tuple[bool, ...], NDArray[np.intp] | slice]]:
    """Yield each pattern of known labels with the places of its rows."""
    if known.all():
        yield (True,) * known.shape[1], slice(None)
        return
    packed = np.packbits(known, axis=1)
    _, first, numbers = np.unique(packed.view(f"S{packed.shape[1]}"), return_index=True, return_inverse=True)
    for number, row in enumerate(first):
        yield tuple(known[row].tolist()), np.flatnonzero(numbers.ravel() == number)
