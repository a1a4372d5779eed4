"""Where the body and the feet go when a walk is put on the floor, before any leg reaches for it.

Everything here is for a walk along x; arrays are time first, in metres and frames. Times may lie between frames.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from eigenwalker.motion.softening import soften_path
from eigenwalker.motion.support import Stance, Support, rise, smooth_step

__all__ = ["Hold", "Plan", "hold_feet", "plan_feet"]

_BLEND = 0.06  # strides before and after a hand-over during which the body follows both feet
_TOUCH = 0.035  # strides before its stance in which a foot comes to rest
_HELD = 0.095  # strides after its stance for which a foot stands on behind the other one, until its toes leave
_LEAVE = 0.04  # strides after that in which it comes up to the speed of its swing
_FADE = 0.14  # strides before and after all that in which it comes to where it is held, and back to where it was
_SOFT = 0.006  # metres of depth over which the floor comes to hold a foot that comes or goes
_MAX_GAIN = 0.03  # of the speed that the legs say, by which a walk may go faster or slower

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
    behind : ndarray of int of shape (n_frames,)
        The last such frame, when the body is about to follow the other foot as well.
    middles : ndarray of int of shape (n_stances,)
        The same of each stance of the foot.
    late : float
        Frames after its stance for which it stands on.
    """

    amount: Array
    still: Array
    down: Array
    middle: NDArray[np.intp]
    behind: NDArray[np.intp]
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
    holds = []
    for foot in (0, 1):
        own = [stance for stance in stances if stance.foot == foot] or [Stance(foot, np.inf, np.inf)]
        starts, ends = np.array([[stance.start for stance in own], [stance.end for stance in own]])
        nearest, amount, still, down = _hold(starts, ends, float(stride), n_frames)
        begun, left = np.clip([starts, ends], -0.25 * stride, n_frames - 1 + 0.25 * stride)
        middles = np.clip(np.rint((begun + left) / 2), 0, n_frames - 1).astype(np.intp)
        lasts = np.clip(np.floor(left - _BLEND * stride), middles, n_frames - 1).astype(np.intp)
        holds.append(Hold(amount, still, down, middles[nearest], lasts[nearest], middles, _HELD * stride))
    return holds


@njit(cache=True, nogil=True, error_model="numpy")
def _hold(starts, ends, stride, n_frames):
    """Return the nearest stance of each frame, and the first three parts of a `Hold`."""
    nearest = np.empty(n_frames, np.int64)
    amount, still, down = np.empty(n_frames), np.empty(n_frames), np.empty(n_frames)
    stance = 0
    for t in range(n_frames):
        while stance + 1 < len(starts) and t > (ends[stance] + starts[stance + 1]) / 2:
            stance += 1
        early, late = (starts[stance] - t) / stride, (t - ends[stance]) / stride  # strides out of stance
        touch = rise(1 - early / _TOUCH)
        nearest[t] = stance
        amount[t] = rise(1 - max(early, late - _HELD) / _FADE)
        still[t] = min(touch, rise(1 - (late - _HELD) / _LEAVE))
        down[t] = min(touch, rise(1 - late / _HELD))
    return nearest, amount, still, down


def plan_feet(
    stances: list[Stance],
    stride: float,
    holds: list[Hold],
    support: Support,
    *,
    frame_rate: float = math.nan,
    speed: float = math.nan,
) -> Plan:
    """Return where the root goes, and what the feet lack to stand still.

    The root goes as the standing foot lets it go; around a hand-over of the weight as both do, in shares that pass
    smoothly from one to the other. Where a foot is held while the root follows the other one too, it lacks what it
    would slide; on the way down and up it lacks nothing but what keeps it out of the floor.

    The legs say how fast the body goes. It goes up to 3 % faster or slower where another speed is wanted: while one
    foot stands alone the body gains on it, or loses, and the foot comes down so much further ahead, or less far, that
    behind the body it stands as the legs say.

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
    frame_rate : float, default NaN
        Frames per second, by which a body whose legs reach is kept from jolts, see `soften_path`. NaN lets it be.
    speed : float, default NaN
        In metres a frame, what is wanted of feet that are held. NaN is as the legs say.
    """
    n_frames = len(support.height)
    left = _share_of_left(stances, stride, n_frames)
    share = (left[1:] + left[:-1]) / 2
    by_left, by_right = support.advance.transpose(1, 2, 0)  # (2, n_frames - 1) each: time last is quicker
    steps = (share * by_left + (1 - share) * by_right).T
    steps[:, 0] += _gain(steps[:, 0], holds, stride, speed)
    root = np.zeros((n_frames, 3))
    np.cumsum(steps, axis=0, out=root[1:, :2])
    root[:, 2] = left * support.height[:, 0] + (1 - left) * support.height[:, 1]
    if holds and frame_rate > 0:
        root = soften_path(root, frame_rate, stride)
        steps = np.diff(root[:, :2], axis=0)
    shifts, anchors = np.zeros((n_frames, 2, 3)), np.zeros((n_frames, 2))
    for foot, hold in enumerate(holds):
        slide = steps - support.advance[:, foot]
        above = support.lowest[:, foot] + root[:, 2]
        _write_lack(hold.amount, hold.still, hold.down, hold.behind, slide, above, shifts[:, foot])
        anchors[:, foot] = _anchors([stance for stance in stances if stance.foot == foot], hold, root[:, 0])
    return Plan(root, shifts, anchors, _speed(root[:, 0], stride))


def _gain(steps: Array, holds: list[Hold], stride: float, speed: float) -> Array:
    """Return by how much the body goes further in each step than it would, shape (n_frames - 1,), to reach a speed.

    It is the same share of each step in which one foot is still, and nothing while both are.
    """
    planned = _speed(_path(steps), stride) if holds and speed > 0 else 0.0
    if planned <= 0:
        return np.zeros_like(steps)
    both = holds[0].still * holds[1].still
    alone = (1.0 - (both[1:] + both[:-1]) / 2) * steps
    most = _MAX_GAIN * planned
    wanted = np.clip(speed - planned, -most, most)
    return wanted / max(_speed(_path(alone), stride), most) * alone  # where no foot is alone for long, as much again


def _path(steps: Array) -> Array:
    """Return where steps, shape (n_frames - 1,), lead from zero on, shape (n_frames,)."""
    return np.concatenate(([0.0], np.cumsum(steps)))


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


@njit(cache=True, nogil=True)
def _write_lack(amount, still, down, behind, slide, above, out):
    """Write what a foot lacks, (n_frames, 3), from its slide in each step, (n_frames - 1, 2), and its height.

    Inside of its stance, away from the hand-overs, it slides by what the body gains on it alone. At the end of that
    nothing is lacking.
    """
    n_frames = len(amount)
    kept = np.zeros((n_frames, 2))  # of the slide, what must be undone
    for t in range(1, n_frames):
        for axis in range(2):
            kept[t, axis] = kept[t - 1, axis] + 0.5 * (still[t] + still[t - 1]) * slide[t - 1, axis]
    for t in range(n_frames):
        for axis in range(2):
            out[t, axis] = amount[t] * (kept[behind[t], axis] - kept[t, axis])
        out[t, 2] = (1.0 - down[t]) * _out_of_floor(-above[t]) - down[t] * above[t]


@njit(cache=True, nogil=True)
def _out_of_floor(depth):
    """Return how far a foot at some depth under the floor rises: to no more than 3 mm under it."""
    x = min(1.0, max(0.0, depth / _SOFT))
    integral = x**4 * (2.5 - 3.0 * x + x * x)  # of the smooth step
    return _SOFT * integral + max(depth - _SOFT, 0.0)


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
