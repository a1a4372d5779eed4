"""What every reader needs to bring a file to metres and to x forward, y left, z up."""

import math
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import check_choice
from eigenwalker.motion.body import UNITS

__all__ = ["check_up", "meters_per_unit", "to_package_axes"]

_AXES = {"y": (2, 0, 1), "z": (0, 1, 2)}  # which axis of the file becomes x, y and z


def meters_per_unit(unit: str | float) -> float:
    """Return how many metres one unit of length of a file is.

    Parameters
    ----------
    unit : {"m", "cm", "mm", "in"} or float
        A name, or the metres per unit.

    Examples
    --------
    >>> meters_per_unit("cm"), meters_per_unit(0.0564)
    (0.01, 0.0564)
    """
    if isinstance(unit, str):
        check_choice(unit, tuple(UNITS), name="unit")
        return UNITS[unit]
    if isinstance(unit, bool) or not isinstance(unit, Real):
        raise TypeError(f"unit must be one of {', '.join(map(repr, UNITS))} or metres per unit, got {unit!r}")
    if not (math.isfinite(unit) and unit > 0):
        raise ValueError(f"unit must be positive and finite, in metres per unit of the file, got {unit!r}")
    return float(unit)


def check_up(up: str) -> None:
    """Raise a ValueError unless `up` names an axis that a file may have pointing up."""
    check_choice(up, tuple(_AXES), name="up")


def to_package_axes(vectors: NDArray[np.floating], up: str) -> NDArray[np.floating]:
    """Return positions or exponential maps, shape (..., 3), in x forward, y left, z up.

    With ``up="y"`` the file's z is forward and its x is left, so that the axes are permuted
    cyclically, (z, x, y). That is a proper rotation B, and a rotation with the exponential map r
    becomes B exp(r) B' = exp(B r): the same permutation holds for both. With ``up="z"`` nothing changes.
    """
    return vectors[..., _AXES[up]]
