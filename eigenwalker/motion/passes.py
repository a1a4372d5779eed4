"""A recording with turns and stops, split into passes: stretches of walking in one direction."""

from dataclasses import replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter, uniform_filter1d

from eigenwalker._validation import WalkError, check_finite
from eigenwalker.motion.clip import cut
from eigenwalker.motion.heading import across_pairs, leftward, leg_difference
from eigenwalker.motion.runs import find_runs
from eigenwalker.motion.walk import Walk, check_marker_walk

__all__ = ["split_passes"]

_NEEDED = ("left_hip", "right_hip", "left_ankle", "right_ankle")
_WINDOW = 1.0  # seconds, about a stride: its twist of the trunk is no turn
_STRIDE = 1.2  # seconds over which the swing of the legs is measured
_STANDING = 0.5  # of the swing of the legs while walking, below which a person stands
_STILL = 0.05  # metres of that swing in which nobody walks, and noise of a sensor may lie


def split_passes(walk: Walk, *, turn_rate: float = 0.8, min_duration: float = 2.0) -> list[Walk]:
    """Return the passes of a recording: the stretches in which the person walks and does not turn around.

    The body's direction, across hips and shoulders, is smoothed over a second by a median; where it turns faster than
    `turn_rate` a pass ends. Gentle curves stay in a pass; ``heading="curve"`` of `prepare` straightens them. Frames in
    which the legs swing less than half as wide as in the walking part are standing, and belong to no pass. All of it
    is seen from the body, so that recordings in place, and cameras that follow the walker, are split as well.

    Parameters
    ----------
    walk : Walk
        With the markers left and right hip and ankle; shoulders are used where there are any.
    turn_rate : float, default 0.8
        In radians per second; 0.8 is 46 degrees a second.
    min_duration : float, default 2.0
        Length of the shortest pass, in seconds.

    Returns
    -------
    list of Walk
        In their order, in the axes of the recording, with the events in them; called ``name_pass1``, ``name_pass2``...
        so that the part before ``_pass`` joins labels.

    Raises
    ------
    WalkError
        If a marker is missing or has gaps, or if there is no pass.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import split_passes
    >>> walk = make_walkers(1, treadmill=False, random_state=0).data[0]
    >>> [one.name for one in split_passes(walk)]
    ['walker_000_pass1']
    """
    _check(walk)
    turning = _turn_rate(leftward(walk), walk.frame_rate)
    stretches = find_runs((np.abs(turning) < turn_rate) & _is_walking(walk))
    frames = [slice(*run) for run in stretches if run[1] - run[0] >= min_duration * walk.frame_rate]
    if not frames:
        raise WalkError(
            f"walk {walk.name!r}: expected at least one pass of {min_duration:g} s without a turn or a stop, got none "
            f"in {walk.duration:.3g} s; lower min_duration, or raise turn_rate={turn_rate:g} radians a second"
        )
    passes = [cut(walk, stretch) for stretch in frames]
    return [replace(one, name=f"{walk.name}_pass{number}") for number, one in enumerate(passes, 1)]


def _check(walk: Walk) -> None:
    check_marker_walk(walk)
    missing = [name for name in _NEEDED if name not in walk.marker_set.names]
    if missing:
        raise WalkError(
            f"walk {walk.name!r}: expected the markers {', '.join(_NEEDED)}, but {', '.join(missing)} are missing; "
            f"it has {', '.join(walk.marker_set.names)}"
        )
    for name in dict.fromkeys((*_NEEDED, *chain.from_iterable(across_pairs(walk)))):
        check_finite(walk.marker(name), [f"{name}_{axis}" for axis in "xyz"], walk=walk.name)


def _turn_rate(across: NDArray[np.float64], frame_rate: float) -> NDArray[np.float64]:
    """Return how fast a direction turns, in radians per second: its change over a second around each frame."""
    width = max(3, round(_WINDOW * frame_rate) | 1)
    smooth = median_filter(across, size=(width, 1), mode="nearest")
    angles = np.unwrap(np.arctan2(smooth[:, 1], smooth[:, 0]))
    padded = np.pad(angles, width // 2, mode="edge")
    return (padded[width - 1 :] - padded[: 1 - width]) * frame_rate / (width - 1)


def _is_walking(walk: Walk) -> NDArray[np.bool_]:
    """Return for each frame whether the legs swing in the stride around it."""
    difference = leg_difference(walk)
    width = max(3, round(_STRIDE * walk.frame_rate) | 1)
    mean = uniform_filter1d(difference, width, axis=0, mode="nearest")
    swing = np.sqrt(uniform_filter1d((difference - mean) ** 2, width, axis=0, mode="nearest").sum(axis=1))
    moving = swing[swing > _STILL / walk.size]  # however long a person stood before
    return swing >= _STANDING * (np.quantile(moving, 0.75) if moving.size else np.inf)
