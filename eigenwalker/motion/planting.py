"""Where the body and the feet go when a walk is put on the floor, before any leg reaches for it.

Everything here is for a walk along x; arrays are time first, in metres and frames. Times may lie between frames.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.support import Stance, Support, smooth_step

__all__ = ["Hold", "Plan", "hold_feet", "plan_feet"]

_BLEND = 0.06  # strides before and after a hand-over during which the body follows both feet
_LOCK = 0.035  # strides before and after its stance during which a foot is held as well
_FADE = 0.10  # strides in which a foot comes into its hold and out of it

Array = NDArray[np.float64]


class Hold(NamedTuple):
    """When one foot is held, frame by frame; what `hold_feet` returns for each foot.

    Parameters
    ----------
    amount : ndarray of shape (n_frames,)
        How much it is held, 0 to 1.
    start, end : ndarray of shape (n_frames,)
        When the nearest stance of the foot starts and ends.
    middle : ndarray of int of shape (n_frames,)
        A frame of it in which the other foot swings.
    middles : ndarray of int of shape (n_stances,)
        The same of each stance of the foot.
    lock : float
        Frames for which it is held before and after that.
    """

    amount: Array
    start: Array
    end: Array
    middle: NDArray[np.intp]
    middles: NDArray[np.intp]
    lock: float


class Plan(NamedTuple):
    """What `plan_feet` returns.

    Parameters
    ----------
    root : ndarray of shape (n_frames, 3)
        Path of the root; it starts over the origin.
    shifts : ndarray of shape (n_frames, 2, 3)
        By how much the left and the right foot must go elsewhere than the joints put them.
    anchors : ndarray of shape (n_frames, 2)
        x of the root where each foot had all the weight; while the foot swings, on the way to the next such place.
    speed : float
        Mean advance of the root a frame, over whole strides where there is one.
    """

    root: Array
    shifts: Array
    anchors: Array
    speed: float


def hold_feet(stances: list[Stance], stride: float, n_frames: int) -> list[Hold]:
    """Return when the left and the right foot are held: through each stance and a little beyond it.

    Parameters
    ----------
    stances : list of Stance
        In their order, see `find_stances`.
    stride : float
        In frames.
    n_frames : int
        Of the walk.
    """
    frames, lock = np.arange(n_frames, dtype=np.float64), _LOCK * stride
    holds = []
    for foot in (0, 1):
        own = [stance for stance in stances if stance.foot == foot] or [Stance(foot, np.inf, np.inf)]
        starts, ends = np.array([[stance.start, stance.end] for stance in own]).T
        nearest = np.searchsorted((ends[:-1] + starts[1:]) / 2, frames)
        inside = np.clip([starts, ends], -0.25 * stride, n_frames - 1 + 0.25 * stride).mean(axis=0)
        middles = np.clip(np.rint(inside), 0, n_frames - 1).astype(np.intp)
        start, end = starts[nearest], ends[nearest]
        outside = np.maximum(start - lock - frames, frames - end - lock) / (_FADE * stride)
        holds.append(Hold(1.0 - smooth_step(outside), start, end, middles[nearest], middles, lock))
    return holds


def plan_feet(stances: list[Stance], stride: float, holds: list[Hold], support: Support, lowest: Array) -> Plan:
    """Return where the root goes, and what the feet lack to stand still.

    The root goes as the standing foot lets it go; around a hand-over of the weight as both do, in shares that pass
    smoothly from one to the other. Where a foot is held while the root follows the other one too, it lacks what it
    would slide; on the way down and up it lacks nothing but what keeps it out of the floor.

    Parameters
    ----------
    stances : list of Stance
        In their order, see `find_stances`.
    stride : float
        In frames.
    holds : list of Hold
        From `hold_feet`.
    support : Support
        From `find_support`.
    lowest : ndarray of shape (n_frames, 2)
        Height of the lowest point of each sole against the root.
    """
    n_frames = len(lowest)
    left = _share_of_left(stances, stride, n_frames)
    shares = np.column_stack((left, 1 - left))
    steps = ((shares[1:] + shares[:-1])[..., np.newaxis] / 2 * support.advance).sum(axis=1)
    root = np.zeros((n_frames, 3))
    np.cumsum(steps, axis=0, out=root[1:, :2])
    root[:, 2] = (shares * support.height).sum(axis=1)
    shifts, anchors = np.empty((n_frames, 2, 3)), np.empty((n_frames, 2))
    for foot, hold in enumerate(holds):
        slide = np.zeros((n_frames, 2))
        np.cumsum(steps - support.advance[:, foot], axis=0, out=slide[1:])
        shifts[:, foot] = _lack(hold, slide, lowest[:, foot] + root[:, 2])
        anchors[:, foot] = _anchors([stance for stance in stances if stance.foot == foot], hold, root[:, 0])
    return Plan(root, shifts, anchors, _speed(root[:, 0], stride))


def _share_of_left(stances: list[Stance], stride: float, n_frames: int) -> Array:
    """Return how much of the body the left foot leads, shape (n_frames,)."""
    frames, width = np.arange(n_frames, dtype=np.float64), _BLEND * stride
    over = np.array([stance.start for stance in stances[1:]])
    if not over.size:
        return np.full(n_frames, 1.0 - stances[0].foot)
    nearest = np.searchsorted((over[1:] + over[:-1]) / 2, frames)
    rise = smooth_step((frames - over[nearest] + width) / (2 * width))
    to_right = np.array([stance.foot for stance in stances[1:]])[nearest]
    return np.where(to_right == 1, 1.0 - rise, rise)


def _lack(hold: Hold, slide: Array, above: Array) -> Array:
    """Return what a foot lacks, shape (n_frames, 3), from what it slides (n_frames, 2) and its height (n_frames,).

    Inside of its stance, away from the hand-overs, it does not slide at all: there nothing is lacking. A foot that is
    still, or already, in the air is left there.
    """
    frames = np.arange(len(slide), dtype=np.float64)
    times = np.clip(frames, np.maximum(hold.start - hold.lock, 0.0), np.minimum(hold.end + hold.lock, len(slide) - 1.0))
    slid = np.column_stack([np.interp(times, frames, slide[:, axis]) for axis in (0, 1)])
    inward = np.minimum(frames - hold.start, hold.end - frames)
    down = smooth_step((inward + hold.lock) / (2 * hold.lock))
    upward = np.maximum(0.0, -above) - down * np.maximum(0.0, above)
    return np.column_stack((hold.amount[:, np.newaxis] * (slide[hold.middle] - slid), upward))


def _anchors(stances: list[Stance], hold: Hold, ahead: Array) -> Array:
    """Return where along the way a foot stands, and from where to where it swings, shape (n_frames,)."""
    if not stances:
        return ahead
    frames, places = np.arange(len(ahead), dtype=np.float64), ahead[hold.middles]
    leaves = np.array([stance.end for stance in stances[:-1]]) + hold.lock
    comes = np.array([stance.start for stance in stances[1:]]) - hold.lock
    if not leaves.size:
        return np.full(len(ahead), places[0])
    swing = np.maximum(np.searchsorted(leaves, frames) - 1, 0)  # the last one that has begun
    rise = smooth_step((frames - leaves[swing]) / np.maximum(comes - leaves, 1.0)[swing])
    return places[swing] + np.diff(places)[swing] * rise


def _speed(ahead: Array, stride: float) -> float:
    """Return the mean advance a frame, taken over whole strides: the sway of a stride is no part of it."""
    frames = np.arange(len(ahead), dtype=np.float64)
    lag = min(stride, frames[-1])
    start = frames[frames + lag <= frames[-1] + 1e-9]
    return float((np.interp(start + lag, frames, ahead) - ahead[: len(start)]).mean() / lag)
