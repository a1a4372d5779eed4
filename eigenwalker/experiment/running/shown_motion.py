"""A walk as an observer is shown it frame by frame: a body that goes forward along x, and the way it goes."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_finite
from eigenwalker.motion.heading import floor_velocity, travels, turn
from eigenwalker.motion.skeleton import MarkerSet
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["ShownMotion", "shown_markers", "shown_motion"]


class ShownMotion(NamedTuple):
    """A body and its way.

    Parameters
    ----------
    frame_rate : float
        Frames per second.
    marker_set : MarkerSet
        Names and sticks.
    positions : ndarray of shape (n_frames, n_markers, 3)
        In metres, with the pelvis over zero in every frame.
    path : ndarray of shape (n_frames, 2)
        Of the pelvis over the floor, in metres, from zero on; NaN where the speed of a walk in place is unknown.
    """

    frame_rate: float
    marker_set: MarkerSet
    positions: NDArray[np.float64]
    path: NDArray[np.float64]


def shown_markers(walk: Walk | JointWalk) -> Walk:
    """Return the markers of a walk, in life size."""
    markers = walk.to_markers() if isinstance(walk, JointWalk) else walk
    return markers if markers.size == 1 else replace(markers, positions=markers.size * markers.positions, size=1.0)


def shown_motion(walk: Walk | JointWalk) -> ShownMotion:
    """Return a walk as it is shown frame by frame, from its first frame to its last.

    A walk that travels is turned so that it goes along x. One that stays in place goes with its `speed`.

    Parameters
    ----------
    walk : Walk or JointWalk
        With a pelvis; a JointWalk of a skeleton whose joints are known by their names.

    Returns
    -------
    ShownMotion

    Raises
    ------
    WalkError
        If frames are missing, or there is no pelvis.
    """
    markers = shown_markers(walk)
    if "pelvis" not in markers.marker_set.names:
        raise WalkError(
            f"walk {walk.name!r}: expected a marker pelvis, by which a walk is put in place, got "
            f"{', '.join(markers.marker_set.names)}; use walk.to_markers(...)"
        )
    check_finite(markers.channels, markers.channel_names, walk=walk.name)
    goes = travels(markers)
    body = turn(markers, floor_velocity(markers)) if goes else markers
    positions = np.array(body.positions, dtype=np.float64)
    path = positions[:, body.marker_set.index("pelvis"), :2].copy()
    positions[..., :2] -= path[:, np.newaxis]
    path -= path[0]
    if not goes:
        path[:, 0] += walk.speed * np.arange(len(path)) / walk.frame_rate
    return ShownMotion(float(walk.frame_rate), body.marker_set, positions, path)
