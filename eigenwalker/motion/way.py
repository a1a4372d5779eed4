"""The way that a walk takes over the floor: straight, along an arc, or through given points."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from eigenwalker._validation import check_array, check_finite

__all__ = ["Way", "find_way"]

_FINE = 64  # samples between two points of a path, along which its length is added up


class Way(NamedTuple):
    """A curve over the floor, by the length gone along it.

    Parameters
    ----------
    place : callable
        Takes lengths, shape (n,), in metres, and returns places, shape (n, 2).
    direction : callable
        Takes lengths and returns where the way leads there, shape (n,), in radians to the left of x.
    is_x_axis : bool, default False
        Whether the way is the x axis itself, on which nothing is bent.
    """

    place: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    direction: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    is_x_axis: bool = False

    def bend(
        self, points: NDArray[np.float64], along: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return points of a walk along x on this way, and by how much things are turned there.

        Parameters
        ----------
        points : ndarray of shape (n_frames, 3)
            In metres.
        along : ndarray of shape (n_frames,)
            At which length of the way each point belongs: all points of a rigid thing at one length stay rigid.
        """
        angles = self.direction(along)
        if self.is_x_axis:
            return points.copy(), angles
        places = self.place(along)
        x, y, cosine, sine = points[:, 0] - along, points[:, 1], np.cos(angles), np.sin(angles)
        bent = places + np.column_stack((cosine * x - sine * y, sine * x + cosine * y))
        return np.column_stack((bent, points[:, 2])), angles


def find_way(*, heading: float = 0.0, curvature: float = 0.0, path: ArrayLike | None = None) -> Way:
    """Return the way with a first heading and a constant curvature, or smoothly through points.

    Parameters
    ----------
    heading : float, default 0.0
        In radians to the left of x.
    curvature : float, default 0.0
        In 1/m; positive turns to the left.
    path : array-like of shape (n_points, 2), default None
        In metres. Before the first and beyond the last point the way is straight.

    Raises
    ------
    ValueError
        If a number is not finite, both kinds are given, or the points are not two or more different ones.
    """
    for name, value in (("heading", heading), ("curvature", curvature)):
        if not np.isfinite(value):
            raise ValueError(f"{name} must be finite, got {value!r}")
    if path is None:
        return _arc(float(heading), float(curvature))
    if heading or curvature:
        raise ValueError("a path says where the walk leads: give either path, or heading and curvature")
    points = np.asarray(check_array(path, shape=("n_points", 2), name="path"), dtype=np.float64)
    check_finite(points, ["path x", "path y"], walk="path")
    if len(points) < 2 or (np.linalg.norm(np.diff(points, axis=0), axis=1) == 0).any():
        raise ValueError("path must have two points or more, each different from the one before")
    return _through(points)


def _arc(heading: float, curvature: float) -> Way:
    def place(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
        half = curvature * lengths / 2
        chord = lengths * np.sinc(half / np.pi)  # sinc is sin(pi x) / (pi x), 1 for a straight way
        return chord[:, np.newaxis] * np.column_stack((np.cos(heading + half), np.sin(heading + half)))

    return Way(place, lambda lengths: heading + curvature * lengths, heading == curvature == 0)


def _through(points: NDArray[np.float64]) -> Way:
    """Return the way along the cubic spline through points, by chord length, from the first one on."""
    knots = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    spline = CubicSpline(knots, points, bc_type="natural")
    fine = np.linspace(0.0, knots[-1], _FINE * (len(points) - 1) + 1)
    slopes = spline(fine, 1)
    pace = np.linalg.norm(slopes, axis=1)
    lengths = np.concatenate(([0.0], np.cumsum((pace[1:] + pace[:-1]) / 2 * np.diff(fine))))
    angles = np.unwrap(np.arctan2(slopes[:, 1], slopes[:, 0]))
    ends = np.array([[np.cos(angle), np.sin(angle)] for angle in angles[[0, -1]]])

    def place(along: NDArray[np.float64]) -> NDArray[np.float64]:
        before, beyond = np.minimum(along, 0.0), np.maximum(along - lengths[-1], 0.0)
        inside = spline(np.interp(along, lengths, fine))
        return np.asarray(inside + before[:, np.newaxis] * ends[0] + beyond[:, np.newaxis] * ends[1])

    return Way(place, lambda along: np.interp(along, lengths, angles))
