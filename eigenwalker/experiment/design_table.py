"""A design as plain values, and back."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from eigenwalker.experiment.answer_columns import DESIGN_COLUMNS

__all__ = ["design_from_values", "design_values"]

_TYPES = {"int": np.int64, "float": np.float64, "str": object}


def design_values(design: pd.DataFrame) -> dict[str, list[Any]]:
    """Return the columns of a design as lists, ready for JSON."""
    return {name: design[name].tolist() for name in DESIGN_COLUMNS}


def design_from_values(values: Mapping[str, Any]) -> pd.DataFrame:
    """Return a design from its columns, in the types that they have."""
    table = pd.DataFrame({name: values[name] for name in DESIGN_COLUMNS})
    return table.astype({name: _TYPES[column.kind] for name, column in DESIGN_COLUMNS.items()})
