"""From the names and positions in a file to a walk of markers, and back: what all formats of markers share."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.io._text import listed
from eigenwalker.motion.body import check_leg_length
from eigenwalker.motion.skeleton import TROJE15, MarkerSet
from eigenwalker.motion.walk import Walk, check_marker_walk

__all__ = ["check_different", "check_markers", "check_words", "make_walk", "marker_set_of"]


def marker_set_of(names: Sequence[str]) -> MarkerSet:
    """Return the marker set of some names: `TROJE15` if they are its 15, else the names as they are.

    The sticks of `TROJE15` join those of its markers that are among the names.

    Examples
    --------
    >>> marker_set_of(["right_ankle", "heel", "right_knee"]).sticks
    (('right_knee', 'right_ankle'),)
    """
    if set(names) == set(TROJE15.names):
        return TROJE15
    return MarkerSet(tuple(names), tuple(stick for stick in TROJE15.sticks if set(stick) <= set(names)))


def make_walk(
    positions: NDArray[np.floating],
    frame_rate: float,
    names: Sequence[str],
    *,
    path: str | PathLike[str],
    name: str,
    unit: str | float,
    **known: Any,
) -> Walk:
    """Return the walk of markers that a file holds, with legs of a person's length.

    Parameters
    ----------
    positions : ndarray of shape (n_frames, n_markers, 3)
        In metres, x forward, y left, z up. NaN marks gaps.
    frame_rate : float
        Frames per second.
    names : sequence of str
        Different names of the markers, in the order of `positions`. The names of `TROJE15` and no others are put in
        its order.
    path, name : str or path, and str
        The file, for errors; the walk's name.
    unit : str or float
        The unit the file was read with, for errors.
    **known
        Other fields of the walk that the file knows: speed, size, events.

    Raises
    ------
    WalkError
        If positions are infinite, or if the legs are shorter than 0.3 m or longer than 1.3 m.
    """
    marker_set = marker_set_of(names)
    places = {marker: place for place, marker in enumerate(names)}
    order = [places[marker] for marker in marker_set.names]
    walk = Walk(positions[:, order], frame_rate, marker_set, name, **known)
    infinite = np.isinf(walk.positions).any(axis=(0, 2))
    if infinite.any():
        found = listed([marker for marker, bad in zip(marker_set.names, infinite, strict=True) if bad])
        raise WalkError(f"{path}: expected finite positions with unit={unit!r}, got infinite ones for {found}")
    with np.errstate(over="ignore", invalid="ignore"):
        check_leg_length(replace(walk, name=str(path)), unit=unit)
    return walk


def check_different(names: Sequence[str], line: int, *, what: str = "marker") -> None:
    """Raise a WalkError that names the line unless all names differ and there are any."""
    if not names:
        raise WalkError(f"line {line}: expected at least one {what}, got none")
    repeated = sorted(name for name, count in Counter(names).items() if count > 1)
    if repeated:
        raise WalkError(f"line {line}: expected a new name for each {what}, got {listed(repeated)} more than once")


def check_markers(walk: object) -> Walk:
    """Return `walk` if it is a walk of markers that a file can hold, or raise.

    Raises
    ------
    TypeError
        If it has joints, or is no walk at all.
    WalkError
        If it has no markers or infinite positions.
    """
    walk = check_marker_walk(walk)
    if not walk.marker_set.names or np.isinf(walk.positions).any():
        wrong = "infinite positions" if walk.marker_set.names else "no markers"
        raise WalkError(f"walk {walk.name!r}: expected markers with finite positions or gaps (NaN), got {wrong}")
    return walk


def check_words(words: Sequence[str], *, what: str) -> None:
    """Raise a WalkError about words that a table of text cannot keep: with tabs, line breaks or spaces at an end."""
    wrong = [word for word in words if word != word.strip() or not word.isprintable()]
    if wrong:
        raise WalkError(
            f"expected {what} of printable characters without spaces at their ends, got {wrong[0]!r}; "
            "rename it, or write NPZ, which keeps every name"
        )
