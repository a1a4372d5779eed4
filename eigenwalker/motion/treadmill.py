"""The treadmill frame: the path of the pelvis over the floor, taken out of all markers."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.motion.fourier import estimate_frequency
from eigenwalker.motion.heading import floor_points, turn, turn_points
from eigenwalker.motion.path import Path, fit_path, stance_speed
from eigenwalker.motion.walk import Walk

__all__ = ["belt_speed", "refine_frequency", "smooth_path", "straighten", "without_path"]

_MAX_ROUNDS = 20
_SETTLED = 1e-8  # metres of a path at which its search ends
_SLOWEST = 0.2  # of its mean speed; where a path is slower, its direction says nothing


def refine_frequency(walk: Walk, start: float) -> float:
    """Return the stride frequency of a walk without its path, near `start` unless it is known."""
    if not np.isnan(walk.frequency):
        return walk.frequency
    return estimate_frequency(walk.channels, walk.frame_rate, start=start, precision=1e-6)


def smooth_path(walk: Walk, frequency: float) -> tuple[Path, float]:
    """Return the path of the pelvis, and the stride frequency.

    The path is fitted together with harmonics of a frequency that is found in the walk without its path; the two are
    repeated until they agree.

    Parameters
    ----------
    walk : Walk
        One that travels. A `frequency` of its own is kept.
    frequency : float
        First guess, in hertz.
    """
    before = 0.0
    path = fit_path(floor_points(walk, "pelvis"), walk.frame_rate, frequency)
    for _ in range(_MAX_ROUNDS):
        if abs(frequency - before) <= 1e-9 * frequency:
            break
        frequency, before = refine_frequency(without_path(walk, path.points), frequency), frequency
        path = fit_path(floor_points(walk, "pelvis"), walk.frame_rate, frequency)
    return path, frequency


def without_path(walk: Walk, points: NDArray[np.float64]) -> Walk:
    """Take a path, shape (n_frames, 2), out of all markers; its mean velocity is the speed of the belt."""
    positions = walk.positions - np.pad(points, ((0, 0), (0, 1)))[:, np.newaxis]
    velocity = (points[-1] - points[0]) * walk.frame_rate / max(walk.n_frames - 1, 1)
    return replace(walk, positions=positions, speed=walk.size * float(np.hypot(*velocity)))


def belt_speed(walk: Walk, direction: NDArray[np.float64]) -> float:
    """Return the speed of the belt under a walk that stays in place, in m/s: its own, else that of the stance feet."""
    if not np.isnan(walk.speed):
        return walk.speed
    left, right = (floor_points(walk, f"{side}_ankle") @ direction for side in ("left", "right"))
    return walk.size * stance_speed(left, right, walk.frame_rate)


def straighten(walk: Walk, frequency: float, *, treadmill: bool) -> Walk:
    """Turn each frame by the direction of the path there, so that the path becomes a straight line along x.

    Turned that way, sway across a curve is a series of harmonics, which it is not over the floor: what the walk
    still drifts then is added to the path until nothing is left.

    Parameters
    ----------
    walk : Walk
        One that travels.
    frequency : float
        First guess, in hertz.
    treadmill : bool
        Whether the straight line is taken out.

    Raises
    ------
    WalkError
        If the path nearly stops.
    """
    path, frequency = smooth_path(walk, frequency)
    points = path.points
    for _ in range(_MAX_ROUNDS):
        steps = _steps(walk, points)
        straight = turn(without_path(walk, points), steps)
        frequency = refine_frequency(straight, frequency)
        rest = fit_path(floor_points(straight, "pelvis"), walk.frame_rate, frequency).points
        if np.abs(rest).max() <= _SETTLED:
            break
        points = points + turn_points(rest, steps * [1.0, -1.0])
    lengths = np.linalg.norm(steps, axis=1)
    if treadmill:
        return replace(straight, speed=walk.size * float(lengths.mean() * walk.frame_rate))
    along = np.concatenate(([0.0], np.cumsum((lengths[1:] + lengths[:-1]) / 2)))
    positions = straight.positions + along[:, np.newaxis, np.newaxis] * [1.0, 0.0, 0.0]
    return replace(straight, positions=positions, speed=walk.speed)


def _steps(walk: Walk, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the steps of a path from frame to frame, shape (n_frames, 2), or raise where it has no direction."""
    steps = np.gradient(points, axis=0, edge_order=2)
    lengths = np.linalg.norm(steps, axis=1)
    if lengths.min() < _SLOWEST * lengths.mean():
        raise WalkError(
            f"walk {walk.name!r}: expected a path that leads on throughout, for heading='curve', but in frame "
            f"{np.argmin(lengths)} of {len(points)} it nearly stops; cut the walk with clip='steady' or "
            "split_passes, or take heading='path'"
        )
    return steps
