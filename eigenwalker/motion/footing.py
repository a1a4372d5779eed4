"""When which foot stands on the floor, and how far it slides on it."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.gait import SIDES, heel_strikes, toe_offs
from eigenwalker.motion.heading import floor_points, turn
from eigenwalker.motion.rig import Place, Rig, sources
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.skeleton import FEET, TROJE15_AND_FEET
from eigenwalker.motion.sole import sole_points
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["Footing", "contact_path", "find_footing", "marker_walk", "path_velocity"]

_ROUNDING = 1e-6  # frames by which a time that lies on a frame may miss it
_AROUND = 0.5  # seconds before and after a frame over which its velocity is taken: about a stride
_TRAVEL_SPEED = 0.15  # m/s; slower is swaying on a treadmill, not going anywhere


class Footing(NamedTuple):
    """Where the feet of a walk are, and when they stand.

    Parameters
    ----------
    points : ndarray of shape (n_frames, 2, n_points, 3)
        Points of the left and of the right foot that may touch the floor, as they move over it, in metres.
    supports : list of (int, slice)
        Which foot stands alone, 0 for the left one, and in which frames.
    handovers : list of (int, slice)
        Which foot is still on the floor behind the other one that has struck it, and in which frames.
    """

    points: NDArray[np.float64]
    supports: list[tuple[int, slice]]
    handovers: list[tuple[int, slice]]


def find_footing(walk: Walk | JointWalk, rig: Rig | Mapping[str, Place] | None = None) -> Footing:
    """Return where the feet of a walk are, and when they stand.

    Events come from the motion of the feet against the pelvis alone, `heel_strikes` and `toe_offs` with the heel and
    the tip of the toes: nothing that a method which plants feet has to know of, and no events that a file or such a
    method wrote down. A foot stands alone from the toe off to the heel strike of the other one; it trails from the
    heel strike of the other one to its own toe off. Of both only whole frames count, two at least.

    Parameters
    ----------
    walk : Walk or JointWalk
        Over the floor, straight or not (`path_velocity`); or in place along x, then the floor moves with its `speed`.
    rig : Rig or dict, default None
        Which joints or markers make the 15 markers; None recognises the rigs in `RIGS`.

    Returns
    -------
    Footing
        With the points heel, ball and tip for joints, heel and toe for markers, and the ankle for markers without
        feet. Over a floor that moves at an unknown speed the points are NaN across it.
    """
    markers = marker_walk(walk, rig)
    points = _foot_points(walk, markers, rig)
    seen = replace(_with_feet(markers, points), events=())
    velocity = path_velocity(markers)
    seen = seen if velocity is None else turn(seen, velocity)
    strikes = [heel_strikes(seen, side) for side in SIDES]
    offs = [toe_offs(seen, side) for side in SIDES]
    points = walk.size * points
    if velocity is None:
        points = points.copy()
        points[..., 0] += walk.speed * (np.arange(walk.n_frames) / walk.frame_rate)[:, np.newaxis, np.newaxis]
    none = np.empty(0)
    supports = [(1 - foot, span) for foot in (0, 1) for span in _spans(offs[foot], strikes[foot], none)]
    handovers = [(foot, span) for foot in (0, 1) for span in _spans(strikes[1 - foot], offs[foot], strikes[foot])]
    return Footing(points, _frames(supports, walk.frame_rate), _frames(handovers, walk.frame_rate))


def contact_path(points: NDArray[np.floating]) -> float:
    """Return how far one foot slides over the floor, in metres.

    From each frame to the next the point counts that is the lowest of the foot, on average of the two frames: a foot
    that rolls from heel to toe without sliding has a path of zero.

    Parameters
    ----------
    points : ndarray of shape (n_frames, n_points, 3)
        Of one foot while it stands.

    Examples
    --------
    >>> import numpy as np
    >>> heel, toe = [[0, 0, 0], [0, 0, 0], [0.1, 0, 0.1]], [[0.2, 0, 0.1], [0.2, 0, 0], [0.2, 0, 0]]
    >>> contact_path(np.stack((heel, toe), axis=1))
    0.0
    """
    lowest = (points[:-1, :, 2] + points[1:, :, 2]).argmin(axis=1)
    moved = np.diff(points[..., :2], axis=0)[np.arange(len(lowest)), lowest]  # (n_frames - 1, 2)
    return float(np.hypot(moved[:, 0], moved[:, 1]).sum())


def path_velocity(markers: Walk) -> NDArray[np.float64] | None:
    """Return where a walk leads, frame by frame, or None where it stays in place.

    Parameters
    ----------
    markers : Walk
        With a pelvis.

    Returns
    -------
    ndarray of shape (n_frames, 2) or None
        The velocity of the pelvis over the floor in m/s, from half a second before to half a second after each frame,
        so that it follows curves but not the sway of a stride. None if its median is below 0.15 m/s.
    """
    pelvis = markers.size * np.asarray(floor_points(markers, "pelvis"), dtype=np.float64)
    frames, reach = np.arange(len(pelvis)), max(1, round(_AROUND * markers.frame_rate))
    first, last = np.maximum(frames - reach, 0), np.minimum(frames + reach, len(pelvis) - 1)
    lasting = np.maximum(last - first, 1)[:, np.newaxis] / markers.frame_rate
    velocity = (pelvis[last] - pelvis[first]) / lasting
    speeds = np.hypot(velocity[:, 0], velocity[:, 1])
    if np.median(speeds) <= _TRAVEL_SPEED:
        return None
    return np.where(speeds[:, np.newaxis] > 0, velocity, velocity.mean(axis=0))  # who stops still looks ahead


def marker_walk(walk: Walk | JointWalk, rig: Rig | Mapping[str, Place] | None = None) -> Walk:
    """Return the 15 markers of a walk, with those of its feet where it has them."""
    if isinstance(walk, JointWalk):
        return walk.to_markers(rig)
    names = set(walk.marker_set.names)
    places = rig if isinstance(rig, Mapping) else (find_rig(names) if rig is None else rig).markers
    feet = all(marker in places and sources(places[marker]) <= names for marker in FEET)
    return walk.to_markers(rig, feet=feet)


def _foot_points(walk: Walk | JointWalk, markers: Walk, rig: Rig | Mapping[str, Place] | None) -> NDArray[np.float64]:
    """Return the points of the feet in the unit of the walk, shape (n_frames, 2, n_points, 3)."""
    if isinstance(walk, JointWalk):
        return sole_points(walk, rig)
    ends = ("heel", "toe") if set(FEET) <= set(markers.marker_set.names) else ("ankle",)
    places = [[markers.marker_set.index(f"{side}_{end}") for end in ends] for side in SIDES]
    return np.asarray(markers.positions[:, places], dtype=np.float64)


def _with_feet(markers: Walk, points: NDArray[np.float64]) -> Walk:
    """Return the 15 markers with heels and tips of the toes, which events are found by."""
    if points.shape[2] == 1 or set(FEET) <= set(markers.marker_set.names):
        return markers
    ends = points[:, :, [0, -1]].reshape(len(points), 4, 3)  # (n_frames, 2, 2, 3) -> (n_frames, 4, 3)
    return replace(markers, positions=np.concatenate((markers.positions, ends), axis=1), marker_set=TROJE15_AND_FEET)


def _spans(
    starts: NDArray[np.float64], ends: NDArray[np.float64], breaks: NDArray[np.float64]
) -> list[tuple[float, float]]:
    """Return each start with the first end behind it, unless another start or a break comes before that."""
    found = []
    for start in starts:
        following = ends[ends > start]
        others = np.concatenate((starts, breaks))
        if following.size and not ((others > start) & (others < following[0])).any():
            found.append((float(start), float(following[0])))
    return found


def _frames(spans: list[tuple[int, tuple[float, float]]], frame_rate: float) -> list[tuple[int, slice]]:
    """Return the frames within spans of time, where there are two at least, in the order of time."""
    frames = [
        (foot, slice(int(np.ceil(start * frame_rate - _ROUNDING)), int(np.floor(end * frame_rate + _ROUNDING)) + 1))
        for foot, (start, end) in spans
    ]
    return sorted((item for item in frames if item[1].stop - item[1].start > 1), key=lambda item: item[1].start)
