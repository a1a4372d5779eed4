"""What every reader needs to bring a file to metres and to x forward, y left, z up."""

import math
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_choice
from eigenwalker.motion.walk import Walk

__all__ = ["check_leg_length", "check_up", "meters_per_unit", "to_package_axes"]

_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
_AXES = {"y": (2, 0, 1), "z": (0, 1, 2)}  # which axis of the file becomes x, y and z
_SHORTEST, _LONGEST = 0.3, 1.3
_TYPICAL = 0.85
_LIKELY = (0.5, 1.1)  # what a suggested unit must give: a child's to a tall adult's legs


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
        check_choice(unit, tuple(_UNITS), name="unit")
        return _UNITS[unit]
    if isinstance(unit, bool) or not isinstance(unit, Real):
        raise TypeError(f"unit must be one of {', '.join(map(repr, _UNITS))} or metres per unit, got {unit!r}")
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


def check_leg_length(walk: Walk, *, unit: str | float) -> None:
    """Raise unless the legs have a length that people have.

    The length is the median over frames and sides of hip to knee plus knee to ankle.

    Parameters
    ----------
    walk : Walk
        With hips, knees and ankles among its markers; its name opens the error. A walk without a
        frame in which they are all there is not judged.
    unit : str or float
        The unit it was read with.

    Raises
    ------
    WalkError
        If the legs are shorter than 0.3 m or longer than 1.3 m, with the unit to pass.
    """
    legs = _leg_lengths(walk)
    if not legs.size:
        return
    length = float(np.median(legs))
    if not _SHORTEST <= length <= _LONGEST:
        raise WalkError(
            f"{walk.name}: legs are {length:.3g} m long with unit={unit!r}, "
            f"expected {_SHORTEST} to {_LONGEST} m; {_advice(length / meters_per_unit(unit))}"
        )


def _leg_lengths(walk: Walk) -> NDArray[np.floating]:
    """Return the lengths of both legs in all frames where they are known, in one row."""
    hips, knees, ankles = (
        np.concatenate([walk.marker(f"{side}_{joint}") for side in ("left", "right")])  # (2 n_frames, 3)
        for joint in ("hip", "knee", "ankle")
    )
    with np.errstate(over="ignore", invalid="ignore"):  # numbers that large are refused by their length
        legs = np.linalg.norm(hips - knees, axis=-1) + np.linalg.norm(knees - ankles, axis=-1)
    known: NDArray[np.floating] = legs[~np.isnan(legs)]
    return known


def _advice(length: float) -> str:
    """Say which unit would make legs of `length` units of the file as long as people's."""
    if not (math.isfinite(length) and length > 0):
        return "the hips, knees and ankles of this file are not those of a body"
    likely = [name for name, meters in _UNITS.items() if _LIKELY[0] <= length * meters <= _LIKELY[1]]
    if likely:
        best = min(likely, key=lambda name: abs(math.log(length * _UNITS[name] / _TYPICAL)))
        return f"pass unit={best!r}"
    return f"pass unit=... in metres per unit of the file, about {_TYPICAL / length:.2g} for legs of {_TYPICAL} m"
