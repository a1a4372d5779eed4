"""Gaps in marker paths: where they are, and how short ones are filled from what is known around them."""

from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from eigenwalker.motion.rigid import fit_rigid
from eigenwalker.motion.runs import find_runs
from eigenwalker.motion.walk import Walk

__all__ = ["Gap", "fill_gaps", "find_gaps"]

_STIFF = 0.005  # metres; markers on one segment keep their places within it, across a joint they do not
_THIN = 0.1  # height over longest side, below which a triangle hardly shows how it turns about that side
_LEAST_SHARED = 0.5  # seconds, half a stride, in which four markers must be seen together to be called rigid
_MOST_NEIGHBORS = 8  # the stiffest ones, of which bodies are made
_MOST_TRIED = 100  # frames, spread over the walk, on which a body is tried
_SUPPORT = 3  # known frames in a row on each side of what a spline bridges
_REACH = 10  # frames on each side that it passes through; those further off hardly matter to it


class Gap(NamedTuple):
    """Frames in a row in which a marker was not seen. A list of them makes a DataFrame.

    Parameters
    ----------
    marker : str
        The marker's name.
    first_frame, last_frame : int
        The first and the last frame without it.
    start, duration : float
        Time of the first frame, and number of frames over frame rate, in seconds.
    """

    marker: str
    first_frame: int
    last_frame: int
    start: float
    duration: float


class _Body(NamedTuple):
    """Three markers, where they are in one frame, and the root mean square error with which they carry a fourth."""

    markers: list[int]
    shape: NDArray[np.float64]
    error: float


def find_gaps(walk: Walk) -> list[Gap]:
    """Return the gaps of a walk: all runs of frames in which a coordinate of a marker is not finite.

    Parameters
    ----------
    walk : Walk
        With any markers.

    Returns
    -------
    list of Gap
        In the order of the markers, then of time. Before `fill_gaps` against after tells what was filled.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import MarkerSet, Walk, find_gaps
    >>> positions = np.zeros((200, 2, 3))
    >>> positions[50:60, 1] = np.nan
    >>> find_gaps(Walk(positions, 100, MarkerSet(("head", "heel"))))
    [Gap(marker='heel', first_frame=50, last_frame=59, start=0.5, duration=0.1)]
    """
    _check_markers(walk)
    known = np.isfinite(walk.positions).all(axis=2)
    return [
        Gap(name, first, stop - 1, first / walk.frame_rate, (stop - first) / walk.frame_rate)
        for marker, name in enumerate(walk.marker_set.names)
        for first, stop in find_runs(~known[:, marker])
    ]


def fill_gaps(walk: Walk, *, max_gap: float = 0.2) -> Walk:
    """Return the walk with its short gaps filled, each from what was measured around it.

    Where three other markers have been seen to form a rigid body with the marker, they carry it across the gap:
    its place in their body is interpolated linearly from the frame before to the frame after, so that its path is met
    at both ends. At the start and the end of the walk it keeps the place it has at the one known end. Else a cubic
    spline through its known frames bridges the gap; it needs three known frames in a row on each side, and one or two
    frames seen in between count as part of the gap and are met. What neither can fill stays NaN, and known
    coordinates stay as they are.

    Markers are a rigid body when the motion of the three (`fit_rigid`) predicts the fourth to a root mean square of 5
    mm over all frames where all four are known, half a second of them at least. Markers on one segment move less than
    that against each other, by soft tissue and noise; across a joint they move by several times that much. Of several
    bodies, the stiffest that is known throughout the gap is taken.

    Parameters
    ----------
    walk : Walk
        With NaN where a marker was not seen. A marker with one coordinate missing was not seen.
    max_gap : float, default 0.2
        Longest gap that is filled, in seconds. 0.2 s, a fifth of a stride, is where a cubic spline stops being the
        better choice (Howarth & Callaghan 2010, Comput. Methods Biomech. Biomed. Eng. 13, 847-855); raise it where
        markers come in rigid clusters. 0 fills nothing.

    Returns
    -------
    Walk
        All but the positions as before. `find_gaps` lists what is left.

    Raises
    ------
    TypeError
        If `walk` holds joint rotations.
    ValueError
        If `max_gap` is negative or not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from dataclasses import replace
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import fill_gaps, find_gaps
    >>> walk = make_walkers(1, noise=0.0, random_state=0).data[0]
    >>> positions = walk.positions.copy()
    >>> positions[100:110, 5] = np.nan
    >>> positions[200:300, 7] = np.nan
    >>> filled = fill_gaps(replace(walk, positions=positions))
    >>> [gap.marker for gap in find_gaps(filled)]
    ['right_wrist']
    >>> bool(np.abs(filled.positions - walk.positions)[:, 5].max() < 0.002)
    True
    """
    _check_markers(walk)
    if not 0 <= max_gap < np.inf:
        raise ValueError(f"max_gap must be a finite number of seconds, zero or more, got {max_gap!r}")
    known = np.isfinite(walk.positions).all(axis=2)
    longest = int(max_gap * walk.frame_rate * (1 + 1e-9))
    shared = max(1, int(_LEAST_SHARED * walk.frame_rate))
    positions, filled = walk.positions.astype(np.float64), walk.positions.copy()
    for marker in np.flatnonzero(~known.all(axis=0)).tolist():
        path = _across_gaps(positions, known, marker, longest, shared, _STIFF / walk.size)
        missing = ~np.isfinite(filled[:, marker]) & np.isfinite(path)
        filled[:, marker][missing] = path[missing]
    return replace(walk, positions=filled)


def _check_markers(walk: object) -> None:
    if not isinstance(walk, Walk):
        raise TypeError(
            f"expected a Walk, got {type(walk).__name__}: gaps are those of markers; for joint rotations take "
            "walk.to_markers() first"
        )


def _across_gaps(
    positions: NDArray[np.float64],
    known: NDArray[np.bool_],
    marker: int,
    longest: int,
    shared: int,
    tolerance: float,
) -> NDArray[np.float64]:
    """Return the path (n_frames, 3) of one marker in the gaps that can be filled, NaN in all other frames."""
    path = np.where(known[:, marker, np.newaxis], positions[:, marker], np.nan)
    filled = _spline(path, known[:, marker], longest)
    short = [(first, stop) for first, stop in find_runs(~known[:, marker]) if stop - first <= longest]
    bodies = _rigid_bodies(positions, known, marker, shared, tolerance) if short else []
    for first, stop in short:
        start = max(first - 1, 0)  # with the known frame on either side
        body = next((body for body in bodies if known[start : stop + 1, body.markers].all()), None)
        if body is not None:
            carried = _carry(path[start : stop + 1], positions[start : stop + 1, body.markers], body.shape)
            gap = slice(first - start, stop - start)
            filled[first:stop] = np.where(np.isfinite(carried[gap]), carried[gap], filled[first:stop])
    return filled


def _spline(path: NDArray[np.float64], known: NDArray[np.bool_], longest: int) -> NDArray[np.float64]:
    """Return the path (n_frames, 3) where enough frames around a gap support a spline, NaN in all other frames."""
    filled = np.full_like(path, np.nan)
    firm = np.zeros_like(known)
    for first, stop in find_runs(known):
        firm[first:stop] = stop - first >= _SUPPORT
    frames = np.arange(len(path))
    for first, stop in find_runs(~firm):
        if first > 0 and stop < len(path) and stop - first <= longest:
            near = known & (frames >= first - _REACH) & (frames < stop + _REACH)
            missing = frames[first:stop][~known[first:stop]]
            filled[missing] = CubicSpline(frames[near], path[near])(missing)
    return filled


def _rigid_bodies(
    positions: NDArray[np.float64], known: NDArray[np.bool_], marker: int, shared: int, tolerance: float
) -> list[_Body]:
    """Return the bodies of three other markers that carry a marker within the tolerance, the stiffest first."""
    bodies = []
    for triple in combinations(_stiff_neighbors(positions, known, marker, shared, tolerance), 3):
        markers = list(triple)
        together = np.flatnonzero(known[:, [marker, *markers]].all(axis=1))
        if len(together) < shared:
            continue
        shape = positions[together[len(together) // 2], markers]
        if not _is_thin(shape):
            tried = together[:: -(-len(together) // _MOST_TRIED)]
            places = _places(positions[tried, marker], positions[tried][:, markers], shape)[0]
            bodies.append(_Body(markers, shape, float(np.sqrt(places.var(axis=0).sum()))))
    return sorted((body for body in bodies if body.error <= tolerance), key=lambda body: body.error)


def _stiff_neighbors(
    positions: NDArray[np.float64], known: NDArray[np.bool_], marker: int, shared: int, tolerance: float
) -> list[int]:
    """Return the markers whose distance to one marker has the least standard deviation, if within the tolerance."""
    deviations = {}
    for other in range(positions.shape[1]):
        together = known[:, marker] & known[:, other]
        if other != marker and together.sum() >= shared:
            apart = positions[together, other] - positions[together, marker]
            deviations[other] = np.linalg.norm(apart, axis=1).std()
    stiff = [other for other in sorted(deviations, key=deviations.__getitem__) if deviations[other] <= tolerance]
    return stiff[:_MOST_NEIGHBORS]


def _is_thin(triangle: NDArray[np.float64]) -> bool:
    """Tell whether three points, shape (3, 3), lie nearly on one line."""
    sides = np.roll(triangle, 1, axis=0) - triangle
    longest = np.linalg.norm(sides, axis=1).max()
    return bool(np.linalg.norm(np.cross(sides[0], sides[1])) <= _THIN * longest**2)  # twice the area


def _places(
    path: NDArray[np.float64], body: NDArray[np.float64], shape: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return a marker's place in a body (n_frames, 3, 3) in each frame, and the body's rotation and translation."""
    rotation, translation = fit_rigid(shape, body)
    return np.einsum("tji,tj->ti", rotation, path - translation), rotation, translation


def _carry(path: NDArray[np.float64], body: NDArray[np.float64], shape: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a path with a gap, (n_frames, 3), as a body carries it; its place there changes linearly."""
    places, rotation, translation = _places(path, body, shape)
    frames, seen = np.arange(len(path)), np.isfinite(places).all(axis=1)
    if not seen.any():  # the body has run together on one line
        return np.full_like(path, np.nan)
    between = np.column_stack([np.interp(frames, frames[seen], axis[seen]) for axis in places.T])
    return np.einsum("tij,tj->ti", rotation, between) + translation
