"""Which frames of a recording are walked, and a walk cut to them."""

import warnings
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.fourier import coarse_frequency
from eigenwalker.motion.heading import floor_points, leg_difference
from eigenwalker.motion.path import steady_stretch
from eigenwalker.motion.runs import longest_run
from eigenwalker.motion.walk import AnyWalk, Walk

__all__ = ["cut", "guess_frequency", "steady_frames", "whole_frames", "without_leaps"]

_ROUNDING = 1e-6  # seconds by which an event in the first frame may miss it
_JUMP_SPEED = 15.0  # m/s of the pelvis between two frames; no body moves like that
_JUMP = 0.25  # metres of a marker against the pelvis between two frames
_FLIPPED = 3  # markers that must jump
_END = 2  # steps between frames from either end in which a calibration posture is looked for
_ENOUGH_STRIDES = 2.0  # a steady part with fewer is widened


def cut(walk: AnyWalk, frames: slice) -> AnyWalk:
    """Keep a stretch of frames, and the events in it."""
    start, end = frames.start / walk.frame_rate, frames.stop / walk.frame_rate
    inside = [event for event in walk.events if start - _ROUNDING <= event.time < end]
    events = tuple(event._replace(time=max(event.time - start, 0.0)) for event in inside)
    if isinstance(walk, Walk):
        return replace(walk, positions=walk.positions[frames], events=events)
    moving = {joint: path[frames] for joint, path in walk.translations.items()}
    return replace(walk, rotations=walk.rotations[frames], root=walk.root[frames], translations=moving, events=events)


def whole_frames(walk: Walk) -> slice:
    """Return the frames from the first to the last one that has all markers, and say how many are left out."""
    whole = np.flatnonzero(np.isfinite(walk.channels).all(axis=1))
    if not whole.size or whole[-1] - whole[0] + 1 == walk.n_frames:
        return slice(0, walk.n_frames)
    warnings.warn(
        f"walk {walk.name!r}: not all markers were seen yet, or any more; kept frames {whole[0]} to {whole[-1]} of "
        f"{walk.n_frames} and left the other {walk.n_frames - 1 - whole[-1] + whole[0]} out",
        stacklevel=3,
    )
    return slice(int(whole[0]), int(whole[-1]) + 1)


def without_leaps(walk: Walk) -> slice:
    """Return the longest run of frames in which nothing leaps, and say which frames are left out.

    The pelvis leaps where frames of zeros stand in a file, and limbs do where a calibration posture stands at one of
    its ends. One or two markers that flip, or more in the midst of a walk, are noise, and no leap.
    """
    pelvis = walk.marker("pelvis")
    body = np.linalg.norm(np.diff(pelvis, axis=0), axis=1) * walk.frame_rate > _JUMP_SPEED
    leaps = body | _limbs_leap(walk)
    if not leaps.any():
        return slice(0, walk.n_frames)
    first, last = longest_run(~leaps)
    what = "pelvis leaps" if body.any() else "limbs leap, from another posture,"
    warnings.warn(
        f"walk {walk.name!r}: the {what} between two frames; kept frames {first} to {last} of {walk.n_frames} and left "
        f"the other {walk.n_frames - 1 - last + first} out",
        stacklevel=3,
    )
    return slice(first, last + 1)


def _limbs_leap(walk: Walk) -> NDArray[np.bool_]:
    """Return whether three markers or more leap against the pelvis next to an end of the walk, (n_frames - 1,)."""
    limbs = walk.positions - walk.marker("pelvis")[:, np.newaxis]
    leaps = np.zeros(walk.n_frames - 1, dtype=bool)
    for part in (slice(0, _END), slice(max(0, len(leaps) - _END), len(leaps))):
        steps = np.linalg.norm(np.diff(limbs[part.start : part.stop + 1], axis=0), axis=2)
        leaps[part] = (steps > _JUMP).sum(axis=1) >= _FLIPPED
    return leaps


def guess_frequency(walk: Walk, direction: NDArray[np.float64], frequency_range: tuple[float, float]) -> float:
    """Return a first guess of the stride frequency of a walk that leads along a direction, shape (2,)."""
    if not np.isnan(walk.frequency):
        return walk.frequency
    difference = leg_difference(walk) @ direction
    return coarse_frequency(difference, walk.frame_rate, frequency_range=frequency_range, name=walk.name)


def steady_frames(walk: Walk, direction: NDArray[np.float64], frequency_range: tuple[float, float]) -> slice:
    """Return the frames of even speed; the limit is widened until they hold two strides."""
    frequency = guess_frequency(walk, direction, frequency_range)
    pelvis = floor_points(walk, "pelvis")
    for tolerance in np.arange(0.2, 1.0, 0.1):
        frames = steady_stretch(pelvis, walk.frame_rate, frequency, tolerance=tolerance)
        if (frames.stop - frames.start) * frequency / walk.frame_rate >= _ENOUGH_STRIDES:
            return frames
    return slice(0, walk.n_frames)
