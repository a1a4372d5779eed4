"""Where the body and the feet go when a walk is put on the floor, before any leg reaches for it.

Everything here is for a walk along x; arrays are time first, in metres and frames. Times may lie between frames.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.support import Stance, Support, smooth_step

__all__ = ["Hold", "Plan", "hold_feet", "plan_feet"]

_BLEND = 0.06  # strides before and after a hand-over during which the body follows both feet
_TOUCH = 0.035  # strides before its stance in which a foot comes to rest
_HELD = 0.095  # strides after its stance for which a foot stands on behind the other one, until its toes leave
_LEAVE = 0.04  # strides after that in which it comes up to the speed of its swing
_FADE = 0.14  # strides before and after all that in which it comes to where it is held, and back to where it was
_SOFT = 0.006  # metres of depth over which the floor comes to hold a foot that comes or goes

Array = NDArray[np.float64]


class Hold(NamedTuple):
    """When one foot is held, frame by frame; what `hold_feet` returns for each foot.

    Parameters
    ----------
    amount : ndarray of shape (n_frames,)
        How much it is held, 0 to 1.
    still : ndarray of shape (n_frames,)
        How much it must not slide, 0 to 1.
    down : ndarray of shape (n_frames,)
        How much it must be on the floor, 0 to 1.
    middle : ndarray of int of shape (n_frames,)
        A frame of its nearest stance in which the other foot swings.
    middles : ndarray of int of shape (n_stances,)
        The same of each stance of the foot.
    late : float
        Frames after its stance for which it stands on.
    """

    amount: Array
    still: Array
    down: Array
    middle: NDArray[np.intp]
    middles: NDArray[np.intp]
    late: float


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
    """Return when the left and the right foot are held: through each stance, and on until the toes leave the floor.

    Parameters
    ----------
    stances : list of Stance
        In their order, see `find_stances`.
    stride : float
        In frames.
    n_frames : int
        Of the walk.
    """
    frames = np.arange(n_frames, dtype=np.float64)
    holds = []
    for foot in (0, 1):
        own = [stance for stance in stances if stance.foot == foot] or [Stance(foot, np.inf, np.inf)]
        starts, ends = np.array([[stance.start, stance.end] for stance in own]).T
        nearest = np.searchsorted((ends[:-1] + starts[1:]) / 2, frames)
        inside = np.clip([starts, ends], -0.25 * stride, n_frames - 1 + 0.25 * stride).mean(axis=0)
        middles = np.clip(np.rint(inside), 0, n_frames - 1).astype(np.intp)
        early, late = (starts[nearest] - frames) / stride, (frames - ends[nearest]) / stride  # strides out of stance
        touch = smooth_step(1 - early / _TOUCH)
        amount = smooth_step(1 - np.maximum(early, late - _HELD) / _FADE)
        still = np.minimum(touch, smooth_step(1 - (late - _HELD) / _LEAVE))
        down = np.minimum(touch, smooth_step(1 - late / _HELD))
        holds.append(Hold(amount, still, down, middles[nearest], middles, _HELD * stride))
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
        From `hold_feet`; none where no leg will reach, then shifts and anchors are zero.
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
    shifts, anchors = np.zeros((n_frames, 2, 3)), np.zeros((n_frames, 2))
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

    Inside of its stance, away from the hand-overs, it does not slide at all: there nothing is lacking.
    """
    kept = np.zeros_like(slide)  # of the slide, what must be undone
    np.cumsum((hold.still[1:] + hold.still[:-1])[:, np.newaxis] / 2 * np.diff(slide, axis=0), axis=0, out=kept[1:])
    upward = (1.0 - hold.down) * _out_of_floor(-above) - hold.down * above
    return np.column_stack((hold.amount[:, np.newaxis] * (kept[hold.middle] - kept), upward))


def _out_of_floor(depth: Array) -> Array:
    """Return how far a foot at some depth under the floor, shape (n_frames,), rises: to no more than 3 mm under it."""
    x = np.clip(depth / _SOFT, 0.0, 1.0)
    integral = x**4 * (2.5 - 3.0 * x + x * x)  # of the smooth step
    return _SOFT * integral + np.maximum(depth - _SOFT, 0.0)


def _anchors(stances: list[Stance], hold: Hold, ahead: Array) -> Array:
    """Return where along the way a foot stands, and from where to where it swings, shape (n_frames,)."""
    if not stances:
        return ahead
    frames, places = np.arange(len(ahead), dtype=np.float64), ahead[hold.middles]
    leaves = np.array([stance.end for stance in stances[:-1]]) + hold.late
    comes = np.array([stance.start for stance in stances[1:]])
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
