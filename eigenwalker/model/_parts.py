"""Walks and their labels in parts, as they are given to `fit_stream`."""

import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from sklearn.pipeline import Pipeline

from eigenwalker._validation import WalkError
from eigenwalker.model._columns import shorten
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["LabelColumns", "SharedNames", "is_fitted", "measure", "name_part", "part_reader"]


def part_reader(parts: Iterable[Any] | Callable[[], Iterable[Any]], *, twice: bool) -> Callable[[], Iterable[Any]]:
    """Return a function that reads the parts from the first on."""
    if callable(parts):
        return parts
    if isinstance(parts, (str, bytes, tuple, pd.DataFrame, np.ndarray)) or not isinstance(parts, Iterable):
        raise TypeError(f"parts must be a list of parts, or a function that returns one, got {type(parts).__name__}")
    if twice and iter(parts) is parts:
        raise ValueError(
            "parts can be read once only, but the alphas of the training walkers need a second reading; give a list, "
            "or a function that returns the parts anew, or alphas=False"
        )
    return lambda: parts


class LabelColumns(NamedTuple):
    """Where labels come from, by which column of a part, and which columns of them are no traits."""

    table: pd.DataFrame | pd.Series | None
    by: str
    control: list[str]
    groups: str | None

    def pair(self, part: Any) -> tuple[Any, Any]:
        """Return the vectors or walks of a part, and their labels."""
        is_pair = isinstance(part, tuple) and len(part) == 2
        if is_pair != (self.table is None):
            wanted = "a pair (X, y)" if self.table is None else "X alone, as labels are given"
            raise TypeError(f"expected {wanted}, got {'a pair' if is_pair else type(part).__name__}")
        return part if self.table is None else (part, _find_labels(self.table, part, self.by))

    def split(self, y: Any) -> tuple[Any, pd.DataFrame | None, pd.Series | None]:
        """Return labels, controls and groups."""
        others = [*self.control, *([self.groups] if self.groups is not None else [])]
        if not others:
            return y, None, None
        lacking = [name for name in others if name not in getattr(y, "columns", ())]
        if lacking:
            raise ValueError(f"expected labels with the columns {', '.join(others)}, {', '.join(lacking)} not found")
        persons = y[self.groups] if self.groups is not None else None
        return y.drop(columns=others), y[self.control] if self.control else None, persons


def _find_labels(table: pd.DataFrame | pd.Series, part: Any, by: str) -> pd.DataFrame | pd.Series:
    """Return the labels of the walks of a part, by their names or another column."""
    if isinstance(part, pd.DataFrame) and by in part:
        names = part[by].tolist()
    elif are_walks(part) and by == "name":
        names = [walk.name for walk in part]
    else:
        walks = "walks, or a table" if by == "name" else "a table"
        raise ValueError(
            f"expected {walks} with a column {by}, to find their labels, got {type(part).__name__}; give pairs (X, y)"
        )
    unknown = [str(name) for name in names if name not in table.index]
    if unknown:
        raise ValueError(
            f"{len(unknown)} of {len(names)} walks have no row in labels by their {by}: {shorten(unknown)}; "
            f"{_other_column(table, part, by)}leave them out, or labels.reindex(names) if they are not labeled"
        )
    found = table.loc[names]
    if len(found) != len(names):
        twice = table.index[table.index.duplicated()].unique()
        raise ValueError(f"expected one row a walk in labels, got several for {shorten(list(map(str, twice)))}")
    return found


def _other_column(table: pd.DataFrame | pd.Series, part: Any, by: str) -> str:
    """Return advice where labels are by another column of a part."""
    columns = [other for other in ("name", "file") if other != by and isinstance(part, pd.DataFrame) and other in part]
    fit = [other for other in columns if part[other].isin(table.index).any()]
    return f"they have by {fit[0]}, labels_by={fit[0]!r}; or " if fit else ""


class SharedNames:
    """Names that walks in several files have: they find one row of labels, which may be that of one of them."""

    def __init__(self, columns: LabelColumns) -> None:
        index = pd.Index([]) if columns.table is None else columns.table.index
        self._is_asked = columns.by == "name" and len(index) > 0 and index.is_unique
        self._index = index
        self._files = np.zeros(len(index), dtype=np.uint64)
        self._shared: set[int] = set()

    def add(self, part: Any) -> None:
        """Take in the names and files of a part."""
        if not self._is_asked or not isinstance(part, pd.DataFrame) or "file" not in part:
            return
        files = pd.util.hash_array(part["file"].to_numpy(dtype=object)) | np.uint64(1)  # 0 is a name not yet seen
        for place, file in zip(self._index.get_indexer(part["name"]), files, strict=True):
            if self._files[place] not in (0, file):
                self._shared.add(int(place))
            self._files[place] = file

    def warn(self, stacklevel: int) -> None:
        """Warn of names in several files."""
        if self._shared:
            names = [str(self._index[place]) for place in sorted(self._shared)]
            warnings.warn(
                f"walks in several files have the same name, and so one row of labels: {shorten(names)}; if they are "
                "of different people, give labels by files and labels_by='file'",
                stacklevel=stacklevel + 1,
            )


def are_walks(X: Any) -> bool:
    """Return whether these are walks, not vectors."""
    return isinstance(X, Sequence) and len(X) > 0 and isinstance(X[0], (Walk, JointWalk))


def measure(X: Any, head: Pipeline) -> Any:
    """Return the feature vectors of walks, or vectors as they are; steps that are not fitted are fitted to the walks.

    Parameters
    ----------
    X : list of walks, DataFrame or array-like
        Of a part.
    head : Pipeline
        The steps up to the linearizer.
    """
    if are_walks(X):
        if not is_fitted(head[-1]):
            head.fit(X)
        return np.asarray(head.transform(X))
    if not is_fitted(head[-1]):
        raise ValueError(
            "expected a model that knows which channels the coefficients are of, got one whose linearizer is not "
            "fitted; give template=walk, one of the walks that they were measured on"
        )
    if isinstance(X, str | bytes | PathLike):
        raise TypeError(f"expected feature vectors or walks, got {X!r}; read the file first")
    return X


def is_fitted(linearizer: FourierLinearizer) -> bool:
    """Return whether a linearizer knows its channels."""
    return hasattr(linearizer, "template_")


@contextmanager
def name_part(number: int) -> Iterator[None]:
    """Say in an error in which part it is."""
    try:
        yield
    except (TypeError, ValueError) as error:
        kind = type(error) if type(error) in (TypeError, ValueError, WalkError) else ValueError
        raise kind(f"part {number}: {error}") from error
