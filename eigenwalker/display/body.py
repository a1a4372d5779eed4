"""A body of markers as an observer sees it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.skeleton import MarkerSet
from eigenwalker.motion.walk import JointWalk, Walk

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "VIEWS",
    "check_drawable",
    "check_views",
    "draw_bodies",
    "draw_sticks",
    "find_azimuth",
    "name_view",
    "project",
]

VIEWS = {"frontal": 0.0, "half-profile": 30.0, "side": 90.0}
"""Azimuth of the named views, in degrees (Troje 2002, section 4)."""


def find_azimuth(view: str | float) -> float:
    """Return where the observer of a view stands, in degrees; a number is an azimuth already."""
    if isinstance(view, str) and view not in VIEWS:
        raise ValueError(f"view must be one of {', '.join(VIEWS)} or an azimuth in degrees, got {view!r}")
    return VIEWS[view] if isinstance(view, str) else float(view)


def check_views(views: Sequence[str | float]) -> list[float]:
    """Return the azimuth of each of several views, one or more."""
    if isinstance(views, str) or not len(views):
        raise ValueError(f"views must be a sequence of one view or more, ('side',), got {views!r}")
    return [find_azimuth(view) for view in views]


def name_view(view: str | float) -> str:
    """Return what stands below the panel of a view."""
    return f"{view} view (m)" if isinstance(view, str) else f"view from {view:g}° (m)"


def check_drawable(walk: Walk | JointWalk) -> MarkerSet:
    """Return the markers of a walk that has a body to draw, or raise a TypeError that says how to get one."""
    if not isinstance(walk, Walk):
        raise TypeError(
            f"expected walks of markers (Walk), which have a body to draw, got {type(walk).__name__}; "
            "fit the model on [walk.to_markers() for walk in walks]"
        )
    return walk.marker_set


def project(positions: NDArray[np.floating], azimuth: float) -> NDArray[np.float64]:
    """Return what an observer sees of markers, by orthographic projection.

    Parameters
    ----------
    positions : ndarray of shape (..., 3)
        In metres; x forward, y left, z up.
    azimuth : float
        Where the observer stands, in degrees: 0 in front of the walker, 90 at its right side, so that it walks to
        the right of the picture.

    Returns
    -------
    ndarray of shape (..., 3)
        To the right in the picture, up, and towards the observer, in metres.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.display import project
    >>> project(np.array([1.0, 0.0, 1.7]), 90).round(6) + 0
    array([1. , 1.7, 0. ])
    """
    angle = np.deg2rad(azimuth)
    x, y, z = np.moveaxis(np.asarray(positions, dtype=np.float64), -1, 0)
    right = x * np.sin(angle) + y * np.cos(angle)
    near = x * np.cos(angle) - y * np.sin(angle)
    return np.stack((right, z, near), axis=-1)


def draw_bodies(
    ax: Axes, markers: MarkerSet, picture: NDArray[np.floating], *, gray: float = 0.4, contrast: float = 0.35
) -> None:
    """Draw bodies: sticks, and the markers as dots, a large one for the head.

    Parameters
    ----------
    ax : matplotlib Axes
        Where to draw.
    markers : MarkerSet
        Names and sticks.
    picture : ndarray of shape (n_bodies, n_markers, 3)
        From `project`.
    gray, contrast : float
        See `draw_sticks`; dots are as dark as the nearest sticks.
    """
    draw_sticks(ax, markers, picture, gray=gray, contrast=contrast)
    points, dot = picture[..., :2], str(round(max(gray - contrast, 0.0), 3))
    ax.scatter(points[..., 0].ravel(), points[..., 1].ravel(), s=7, color=dot, zorder=4, linewidths=0)
    if "head" in markers.names:
        head = points[:, markers.index("head")]
        ax.scatter(head[:, 0], head[:, 1], s=60, color=dot, zorder=4, linewidths=0)


def draw_sticks(
    ax: Axes, markers: MarkerSet, picture: NDArray[np.floating], *, gray: float = 0.4, contrast: float = 0.35
) -> None:
    """Draw the sticks of bodies, those nearer to the observer darker and on top.

    Parameters
    ----------
    ax : matplotlib Axes
        Where to draw.
    markers : MarkerSet
        Names and sticks; without sticks nothing is drawn.
    picture : ndarray of shape (n_bodies, n_markers, 3)
        From `project`.
    gray : float, default 0.4
        Of sticks in the middle of the body, between 0 for black and 1 for white.
    contrast : float, default 0.35
        How much darker those nearest to the observer are.
    """
    from matplotlib.collections import LineCollection

    if not markers.sticks:
        return
    ends = np.array([[markers.index(first), markers.index(second)] for first, second in markers.sticks], dtype=int)
    near = _nearness(picture[..., 2], ends).ravel()  # (n_bodies, n_sticks) -> (n_bodies n_sticks,)
    order = np.argsort(near, kind="stable")
    # (n_bodies, n_sticks, 2, 2) -> (n_bodies n_sticks, 2, 2)
    segments = picture[:, ends, :2].reshape(-1, 2, 2)[order]
    grays = [str(round(shade, 3)) for shade in np.clip(gray - contrast * near[order], 0.0, 1.0)]
    ax.add_collection(LineCollection(list(segments), colors=grays, linewidths=1.6, capstyle="round", zorder=2))


def _nearness(near: NDArray[np.floating], ends: NDArray[np.intp]) -> NDArray[np.floating]:
    """Return how near the sticks are to the observer, between -1 and 1, shape (n_bodies, n_sticks)."""
    depth = near - near.mean(axis=1, keepdims=True)
    return depth[:, ends].mean(axis=2) / max(float(np.abs(depth).max()), 1e-9)
