"""Feature vectors out of tables that hold other things as well."""

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

__all__ = ["shorten", "take_vectors"]

_IS_COEFFICIENT = re.compile(r"(mean|sin\d+|cos\d+)_")
_BLOCK = 4096  # rows that are looked through at a time


def take_vectors(X: ArrayLike, names: Sequence[str] | None) -> NDArray[np.floating]:
    """Return feature vectors as an array of float32 or float64; from a DataFrame by the names of features.

    Raises
    ------
    ValueError
        If columns are missing, double, no numbers, or coefficients of another model; if values are not finite.
    """
    vectors = np.asarray(_pick(X, names) if isinstance(X, pd.DataFrame) else X)
    vectors = vectors if vectors.dtype == np.float32 else vectors.astype(np.float64, copy=False)
    if vectors.ndim != 2 or (names is not None and vectors.shape[1] != len(names)):
        n_features = "n_features" if names is None else len(names)
        raise ValueError(f"X must have shape (n_walks, {n_features}), got {vectors.shape}")
    _check_finite(vectors, names)
    return vectors


def _pick(table: pd.DataFrame, names: Sequence[str] | None) -> pd.DataFrame:
    table = table if names is None else _find(table, names)
    words = [str(name) for name, kind in table.dtypes.items() if not pd.api.types.is_numeric_dtype(kind)]
    if words:
        raise ValueError(f"expected columns of numbers, got others in {shorten(words)}; give feature_names")
    return table


def _find(table: pd.DataFrame, names: Sequence[str]) -> pd.DataFrame:
    columns = [str(name) for name in table.columns]
    wanted, counts = set(names), Counter(columns)
    faults = {
        "missing": [name for name in names if not counts[name]],
        "more than once": [name for name in names if counts[name] > 1],
        "of another model": [name for name in columns if name not in wanted and _IS_COEFFICIENT.match(name)],
    }
    if any(faults.values()):
        listed = "; ".join(f"{len(found)} {what}: {shorten(found)}" for what, found in faults.items() if found)
        raise ValueError(f"expected the {len(names)} features of the linearizer among the columns, got {listed}")
    return table.set_axis(columns, axis=1)[names]


def _check_finite(vectors: NDArray[np.floating], names: Sequence[str] | None) -> None:
    for start in range(0, len(vectors), _BLOCK):
        finite = np.isfinite(vectors[start : start + _BLOCK])
        if not finite.all():
            row, column = np.argwhere(~finite)[0]
            name = column if names is None else names[column]
            raise ValueError(
                f"expected finite features, got {vectors[start + row, column]} in row {start + row}, feature {name}; "
                "leave out walks that were refused"
            )


def shorten(names: Sequence[str]) -> str:
    """Return the first names of many, for an error."""
    return ", ".join(names[:6]) + (" ..." if len(names) > 6 else "")
