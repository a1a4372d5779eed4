r"""Left and right: a walk in the mirror, the walk that is its own mirror image, and how far a walk is from it.

A symmetric walk does on the left what it did half a stride before on the right: with the mirror image M w and the
duration T of a stride, w(t) = M w(t + T / 2).
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from eigenwalker._validation import WalkError, check_finite
from eigenwalker.motion.fourier import fit_harmonics, shift_phase
from eigenwalker.motion.heading import check_in_place, one_stride
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.walk import Walk

__all__ = ["Asymmetry", "asymmetry_index", "mirror_walk", "symmetrize_walk"]

_OTHER_SIDE = {"left": "right", "right": "left"}
_WRAPPED = 8  # frames of the other end that continue a walk which lacks the last frame of its stride


class Asymmetry(NamedTuple):
    """What `asymmetry_index` returns.

    Parameters
    ----------
    posture : float
        Root mean square over markers of half the distance from the mean posture to its mirror image, in metres.
    motion : float
        Share, 0 to 1, of the power of the motion that is antisymmetric.
    markers : DataFrame of shape (n_markers, 2)
        Both of each marker, by its name: `posture` in metres; `motion`, a share of the power of the marker and its
        partner on the other side together, NaN where neither moves.
    """

    posture: float
    motion: float
    markers: pd.DataFrame


def mirror_walk(walk: Walk) -> Walk:
    """Return the walk seen in a mirror: y changes sign, and left and right change places.

    Parameters
    ----------
    walk : Walk
        With markers whose names start with left_ and right_ in pairs. The mirror is the plane y = 0.

    Returns
    -------
    Walk
        Events of the left foot are the right one's, and the other way round.

    Raises
    ------
    TypeError
        If `walk` holds joint rotations.
    ValueError
        If a marker has no partner on the other side.
    """
    _check_markers(walk)
    events = tuple(event._replace(side=_OTHER_SIDE.get(event.side, event.side)) for event in walk.events)
    return replace(walk, positions=_mirror(walk.positions, walk, 0.0), events=events)


def symmetrize_walk(walk: Walk) -> Walk:
    r"""Return the mean of a walk and its mirror image half a stride apart.

    .. math:: w'(t) = \tfrac12 \left[ w(t) + M w(t \pm T / 2) \right]

    with the mirror image M w about the upright plane along x through the mean position of the pelvis, and the
    duration T of a stride from `stride_frequency`. Half a stride later is taken at the start of the walk, half a
    stride earlier at its end, and where both are known they are faded linearly from one into the other, so that
    nothing jumps. Values between frames come from the quintic spline through the frames.

    A walk that repeats itself exactly becomes exactly symmetric, w'(t) = M w'(t + T / 2), and a symmetric one stays as
    it is. What differs from stride to stride is averaged over neighboring half strides, not taken out, and keeps a
    recorded walk from being exactly symmetric. It erases what a limp is: see `asymmetry_index` before.

    Parameters
    ----------
    walk : Walk
        In place and leading along x, from `prepare`; at least one stride long.

    Returns
    -------
    Walk
        As long as `walk`. Without its events: left and right strikes of a symmetric walk are half a stride apart,
        those of the recording need not be; `detect_events` finds the new ones.

    Raises
    ------
    TypeError
        If `walk` holds joint rotations.
    WalkError
        If the walk travels, has gaps, no pelvis or no period, or is shorter than one stride.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import asymmetry_index, prepare, symmetrize_walk
    >>> walk = prepare(make_walkers(1, random_state=0).data[0])
    >>> before, after = asymmetry_index(walk), asymmetry_index(symmetrize_walk(walk))
    >>> after.motion < 0.01 * before.motion
    True
    """
    frequency = _frequency_in_place(walk)
    later = half_stride_apart(walk.channels, walk.frame_rate, frequency).reshape(walk.positions.shape)
    mirrored = _mirror(later, walk, _mirror_plane(walk, frequency))
    return replace(walk, positions=0.5 * (walk.positions + mirrored), events=())


def asymmetry_index(walk: Walk, *, n_harmonics: int = 2) -> Asymmetry:
    r"""Return how far a walk is from its mirror image half a stride later: 0 where it is symmetric.

    With Fourier coefficients C_0 (the mean posture), C_1, ... C_K, and the mirror image M about the upright plane along
    x through the mean position of the pelvis, the antisymmetric part is

    .. math:: A_k = \tfrac12 \left[ C_k - (-1)^k M C_k \right]

    because half a stride turns harmonic k by k pi. For markers m,

    .. math:: posture = \sqrt{\operatorname{mean}_m \| A_{0m} \|^2}, \qquad
              motion = \frac{\sum_{k \ge 1} \sum_m \| A_{km} \|^2}{\sum_{k \ge 1} \sum_m \| C_{km} \|^2}

    The symmetric part C - A is orthogonal to A, so that `motion` is a share of the power, and neither depends on
    where in its stride the walk starts. The symmetry index 2 (L - R) / (L + R) of Robinson, Herzog & Nigg (1987, J.
    Manipulative Physiol. Ther. 10, 172-176) compares one number of the left with one of the right; this one
    compares the whole motion, its timing too, and divides by no difference that may vanish.

    Parameters
    ----------
    walk : Walk
        In place and leading along x, from `prepare`; at least one stride long.
    n_harmonics : int, default 2
        Harmonics K of the motion.

    Returns
    -------
    Asymmetry

    Raises
    ------
    TypeError
        If `walk` holds joint rotations.
    WalkError
        If the walk travels, has gaps, no pelvis or no period, or is shorter than one stride.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import asymmetry_index, prepare
    >>> walk = prepare(make_walkers(1, random_state=0).data[0])
    >>> posture, motion, markers = asymmetry_index(walk)
    >>> posture < 0.05, motion < 0.05, markers.shape
    (True, True, (15, 2))
    """
    frequency = _frequency_in_place(walk)
    rows = fit_harmonics(walk.channels, walk.frame_rate, frequency, n_harmonics)
    later = shift_phase(rows, np.pi).reshape(len(rows), -1, 3)  # (2 K + 1, 3 n_markers) -> (2 K + 1, n_markers, 3)
    mirrored = later[:, walk.marker_set.mirror] * np.array([1.0, -1.0, 1.0])
    mirrored[0, :, 1] += 2 * _mirror_plane(walk, frequency)
    rows = rows.reshape(later.shape)
    uneven = ((rows - mirrored) / 2) ** 2
    posture, power = uneven[0].sum(axis=1), uneven[1:].sum(axis=(0, 2))  # (n_markers,)
    whole = (rows[1:] ** 2).sum(axis=(0, 2))
    pairs = (whole + whole[walk.marker_set.mirror]) / 2
    shares = np.divide(power, pairs, out=np.full(len(pairs), np.nan), where=pairs > 0)
    markers = pd.DataFrame({"posture": np.sqrt(posture), "motion": shares}, index=list(walk.marker_set.names))
    return Asymmetry(float(np.sqrt(posture.mean())), float(power.sum() / whole.sum()), markers)


def half_stride_apart(channels: NDArray[np.floating], frame_rate: float, frequency: float) -> NDArray[np.float64]:
    """Return channels (n_frames, n_channels) half a stride later, or earlier, or between: see `symmetrize_walk`.

    Where a single stride lacks its last frame, and so for a moment neither later nor earlier is known, the walk is
    continued by its other end.
    """
    stride = frame_rate / frequency  # in frames, as all times here
    frames = np.arange(len(channels), dtype=np.float64)
    last = frames[-1]
    end = max(last, stride)
    spline = make_interp_spline(*one_stride_at_least(frames, channels, stride), k=5)
    later = spline(np.minimum(frames + stride / 2, end))
    earlier = spline(np.maximum(frames - stride / 2, last - end))
    # Both are known from half a stride after the start to half a stride before the end.
    fade = np.clip((frames - stride / 2) / (last - stride), 0.0, 1.0) if last > stride else 1.0 * (frames > last / 2)
    return later + fade[:, np.newaxis] * (earlier - later)


def one_stride_at_least(
    frames: NDArray[np.float64], channels: NDArray[np.floating], stride: float
) -> tuple[NDArray[np.float64], NDArray[np.floating]]:
    """Return times and channels, with those of the other end a stride apart where they last less than one stride."""
    if frames[-1] >= stride:
        return frames, channels
    first = int(np.argmax(frames + stride > frames[-1] + 0.5))
    ahead, behind = slice(first, first + _WRAPPED), slice(len(frames) - first - _WRAPPED, len(frames) - first)
    times = np.concatenate((frames[behind] - stride, frames, frames[ahead] + stride))
    return times, np.concatenate((channels[behind], channels, channels[ahead]))


def _mirror(positions: NDArray[np.floating], walk: Walk, plane: float) -> NDArray[np.floating]:
    """Return the mirror image about the plane y = `plane` of positions with the markers of a walk."""
    return positions[:, walk.marker_set.mirror] * np.array([1.0, -1.0, 1.0]) + np.array([0.0, 2 * plane, 0.0])


def _mirror_plane(walk: Walk, frequency: float) -> float:
    """Return the mean y of the pelvis, its sway taken out: the mean over frames has part of a stride in it."""
    return float(one_stride(walk.marker("pelvis")[:, 1:2], walk.frame_rate, frequency).mean())


def _check_markers(walk: object) -> None:
    if not isinstance(walk, Walk):
        raise TypeError(
            f"expected a Walk, got {type(walk).__name__}: mirror images are those of markers; for joint rotations "
            "take walk.to_markers() first"
        )


def _frequency_in_place(walk: Walk) -> float:
    """Return the stride frequency, or raise unless the walk stays in place."""
    _check_markers(walk)
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    if "pelvis" not in walk.marker_set.names:
        raise WalkError(
            f"walk {walk.name!r}: the mirror stands at the marker pelvis; it has {', '.join(walk.marker_set.names)}"
        )
    check_in_place(walk)
    return stride_frequency(walk)
