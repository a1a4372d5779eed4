"""Lengths of the body that a walk's markers carry."""

import math

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.motion.walk import Walk

__all__ = ["UNITS", "check_leg_length", "leg_length", "stature"]

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
"""Metres per named unit of length."""

_SHORTEST, _LONGEST = 0.3, 1.3
_TYPICAL = 0.85
_LIKELY = (0.5, 1.1)  # what a suggested unit must give: a child's to a tall adult's legs

_LEG = ("hip", "knee", "ankle")
_SIDES = ("left", "right")


def leg_length(walk: Walk) -> float:
    """Return hip to knee plus knee to ankle, the median over frames and sides, in metres.

    NaN for marker sets without hips, knees and ankles, and for walks without a frame that has them all.
    """
    if not {f"{side}_{joint}" for side in _SIDES for joint in _LEG} <= set(walk.marker_set.names):
        return float("nan")
    chains = [_chain_length(walk, *(f"{side}_{joint}" for joint in _LEG)) for side in _SIDES]
    lengths = np.concatenate(chains)
    lengths = lengths[~np.isnan(lengths)]
    return float(np.median(lengths)) if lengths.size else float("nan")


def stature(walk: Walk) -> float:
    """Return the height of the body's markers when stretched out: leg, pelvis to clavicle, clavicle to head, in metres.

    Medians over frames, so that bent knees and a stoop do not make a person smaller.

    Raises
    ------
    WalkError
        If the walk lacks one of the markers.
    """
    missing = [name for name in ("head", "clavicle", "pelvis") if name not in walk.marker_set.names]
    leg = leg_length(walk)
    if missing or math.isnan(leg):
        lacks = ", ".join(missing) or "hips, knees or ankles"
        raise WalkError(f"walk {walk.name!r}: its size cannot be measured without the markers {lacks}")
    return leg + float(np.median(_chain_length(walk, "pelvis", "clavicle", "head")))


def _chain_length(walk: Walk, *markers: str) -> NDArray[np.floating]:
    """Length of the chain of sticks through some markers, shape (n_frames,)."""
    points = np.stack([walk.marker(name) for name in markers])  # (n_markers, n_frames, 3)
    with np.errstate(over="ignore", invalid="ignore"):
        return np.linalg.norm(np.diff(points, axis=0), axis=2).sum(axis=0)


def check_leg_length(walk: Walk, *, unit: str | float = "m") -> None:
    """Raise unless the legs have a length that people have.

    Parameters
    ----------
    walk : Walk
        Walks without hips, knees and ankles, and walks whose size was taken out, are not judged.
    unit : str or float, default "m"
        The unit it was read with, a name of `UNITS` or metres per unit.

    Raises
    ------
    WalkError
        If the legs are shorter than 0.3 m or longer than 1.3 m, with the unit to use.
    """
    length = leg_length(walk)
    if math.isnan(length) or walk.size != 1.0 or _SHORTEST <= length <= _LONGEST:
        return
    read_as = UNITS[unit] if isinstance(unit, str) else unit
    raise WalkError(
        f"walk {walk.name!r}: legs are {length:.3g} m long with unit={unit!r}, "
        f"expected {_SHORTEST} to {_LONGEST} m; {_advice(length / read_as)}"
    )


def _advice(length: float) -> str:
    """Say which unit would make legs of `length` units as long as people's."""
    if not (math.isfinite(length) and length > 0):
        return "its hips, knees and ankles are not those of a body"
    likely = [name for name, meters in UNITS.items() if _LIKELY[0] <= length * meters <= _LIKELY[1]]
    if likely:
        best = min(likely, key=lambda name: abs(math.log(length * UNITS[name] / _TYPICAL)))
        return f"read it with unit={best!r}"
    return f"read it with unit=... in metres per unit, about {_TYPICAL / length:.2g} for legs of {_TYPICAL} m"
