"""Smoothing over time without delay, and other frame rates."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline, make_lsq_spline
from scipy.signal import butter, sosfiltfilt

from eigenwalker._validation import WalkError, check_finite, check_frame_rate
from eigenwalker.motion.rotations import unroll_rotvec
from eigenwalker.motion.walk import AnyWalk, JointWalk, Walk

__all__ = ["along_time", "low_pass", "resample"]

_PADDING = 3.0  # cycles of the cutoff by which both ends are continued; beyond it the filter has forgotten them
_DEGREE = 5  # of splines: a quintic one follows a harmonic of 4 Hz at 30 frames a second to 1e-5 of its amplitude
_FINE = 4  # samples a new frame from which a spline is fitted; with fewer, frames halfway between knots are not held


def low_pass(walk: AnyWalk, *, cutoff: float = 6.0, order: int = 4) -> AnyWalk:
    r"""Return a walk without what is faster than a cutoff frequency, and without delay.

    A Butterworth filter of half the order runs over the walk forward and backward, which takes out its delay and
    doubles its order. The gain at frequency f, for f_s frames a second and cutoff f_c, is

    .. math:: |H(f)| = \left[ 1 + (\sqrt 2 - 1) \left( \frac{\tan(\pi f / f_s)}{\tan(\pi f_c / f_s)}
              \right)^{order} \right]^{-1}

    that is 1 at zero and 1 / sqrt(2), -3 dB, at the cutoff: each single pass has a higher cutoff, so that both
    together have this one (Winter 2009, Biomechanics and Motor Control of Human Movement, 4th ed.). Both ends are
    continued by their point reflection, which leaves the first and the last frame where they are; the few frames
    next to them are some 2 mm less sure than those inside.

    Parameters
    ----------
    walk : Walk or JointWalk
        Without gaps. Joint rotations are unrolled and filtered as exponential maps, and paths of joints as they are.
    cutoff : float, default 6.0
        In hertz, below half the frame rate. 6 Hz, what Winter takes for walking, is the sixth harmonic of the stride.
    order : int, default 4
        Of both passes together: 2, 4, 6 ...

    Returns
    -------
    Walk or JointWalk
        Everything else, events and frequency too, as in `walk`.

    Raises
    ------
    WalkError
        If a value is not finite, or the walk is shorter than one cycle of the cutoff.
    ValueError
        If the cutoff is not between zero and half the frame rate, or the order is odd or less than 2.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import low_pass
    >>> walk = make_walkers(1, noise=0.01, random_state=0).data[0]
    >>> smooth = low_pass(walk)
    >>> smooth.n_frames == walk.n_frames
    True
    """
    _check_walk(walk)
    if isinstance(order, bool) or order != int(order) or order < 2 or order % 2:
        raise ValueError(f"order must be an even whole number, 2 or more, of both passes together; got {order!r}")
    if not 0 < cutoff < walk.frame_rate / 2:
        raise ValueError(
            f"cutoff must lie between 0 and half the frame rate, {walk.frame_rate / 2:g} Hz, got {cutoff!r}; "
            "a walk with so few frames a second holds nothing above that"
        )
    if walk.duration < 1 / cutoff:
        raise WalkError(
            f"walk {walk.name!r}: expected at least one cycle of the cutoff, {1 / cutoff:.3g} s, got "
            f"{walk.duration:.3g} s; use a longer recording"
        )
    return along_time(walk, lambda paths: filter_paths(paths, walk.frame_rate, cutoff, order))


def filter_paths(paths: NDArray[np.float64], frame_rate: float, cutoff: float, order: int) -> NDArray[np.float64]:
    """Return paths (n_frames, n_paths) through the filter of `low_pass`, forward and backward."""
    half = order // 2
    # Butterworth's |H|^2 = 1 / (1 + r^order) is squared by two passes: (1 + r^order)^2 = 2 where |H|^4 is one half.
    # The bilinear transform keeps r a ratio of tangents.
    tangent = math.tan(math.pi * cutoff / frame_rate) / (math.sqrt(2) - 1) ** (1 / order)
    single = math.atan(tangent) / math.pi * frame_rate
    sections = butter(half, single, fs=frame_rate, output="sos")
    padding = min(len(paths) - 1, math.ceil(_PADDING * frame_rate / cutoff))
    return sosfiltfilt(sections, paths, axis=0, padlen=padding)


def resample(walk: AnyWalk, *, frame_rate: float) -> AnyWalk:
    """Return a walk at another frame rate, from the same first frame on, as long as the last frame reaches.

    Upward, new frames lie on the quintic spline through the recorded ones. Downward, they lie on the quintic spline
    with one knot a new frame that is nearest to the recorded walk: a projection, which leaves out what is too fast for
    the new frame rate, so that it does not come back as something slow. Up by a whole number and down again gives the
    walk back.

    Parameters
    ----------
    walk : Walk or JointWalk
        Without gaps. Joint rotations are unrolled and interpolated as exponential maps.
    frame_rate : float
        New frames per second. Any number, not only a multiple or a part of the old one.

    Returns
    -------
    Walk or JointWalk
        Time zero, events and everything else as in `walk`. The last frame is the last new one that is not later than
        the last recorded one: nothing is extrapolated.

    Raises
    ------
    WalkError
        If a value is not finite, or there are fewer than 6 frames before or after.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import resample
    >>> walk = make_walkers(1, random_state=0).data[0]
    >>> slow = resample(walk, frame_rate=walk.frame_rate / 4)
    >>> bool(abs(slow.positions - walk.positions[::4]).max() < 0.01)
    True
    """
    _check_walk(walk)
    frame_rate = check_frame_rate(frame_rate)
    if frame_rate == walk.frame_rate:
        return replace(walk)
    n_frames = int((walk.n_frames - 1) * frame_rate / walk.frame_rate + 1e-6) + 1
    if min(walk.n_frames, n_frames) <= _DEGREE:
        raise WalkError(
            f"walk {walk.name!r}: expected at least {_DEGREE + 1} frames before and after, got {walk.n_frames} at "
            f"{walk.frame_rate:g} and {n_frames} at {frame_rate:g} frames a second; use a longer recording"
        )
    # Times in old frames. The last one may miss the last old frame by rounding, never by more.
    times = np.minimum(np.arange(n_frames) * (walk.frame_rate / frame_rate), walk.n_frames - 1)
    change = resample_paths if frame_rate > walk.frame_rate else project_paths
    return along_time(walk, lambda paths: change(paths, times), frame_rate=frame_rate)


def resample_paths(paths: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the quintic spline through paths (n_frames, n_paths) at times in frames."""
    return make_interp_spline(np.arange(len(paths), dtype=np.float64), paths, k=_DEGREE)(times)


def project_paths(paths: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return, at evenly spaced times in frames, the nearest quintic spline that has these times as its knots.

    It is fitted to the frames, or, where these are fewer than four a knot, to as many points of the spline through
    them: with knots and frames of nearly the same spacing there are places where every other frame is free to leap.
    """
    n_between = math.ceil(_FINE / (times[1] - times[0]))
    fine = np.arange(int(times[-1] * n_between + 1e-6) + 1) / n_between
    samples = resample_paths(paths, fine) if n_between > 1 else paths[: len(fine)]
    # The two knots next to each end are left out, as in the spline through the same times.
    knots = np.concatenate((np.repeat(times[0], _DEGREE + 1), times[3:-3], np.repeat(times[-1], _DEGREE + 1)))
    return make_lsq_spline(fine, samples, knots, k=_DEGREE)(times)


def _check_walk(walk: object) -> None:
    """Raise unless all that moves in a walk is known."""
    if not isinstance(walk, (Walk, JointWalk)):
        raise TypeError(f"expected a Walk or a JointWalk, got {type(walk).__name__}")
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    if isinstance(walk, JointWalk):
        for joint, path in {"root": walk.root, **walk.translations}.items():
            check_finite(path, [f"{joint} position {axis}" for axis in "xyz"], walk=walk.name)


def along_time(walk: AnyWalk, change: Callable[[NDArray[np.float64]], NDArray[np.float64]], **fields: Any) -> AnyWalk:
    """Return a walk in which `change` was made to all that moves, as one matrix of shape (n_frames, n_paths)."""
    if isinstance(walk, Walk):
        return walk.with_channels(change(np.asarray(walk.channels, dtype=np.float64)), **fields)
    n_angles = 3 * len(walk.skeleton.joint_names)
    turning = unroll_rotvec(walk.rotations).reshape(walk.n_frames, n_angles)  # (n_frames, n_joints, 3) before
    changed = change(np.hstack((turning, walk.root, *walk.translations.values())))
    paths = np.split(changed[:, n_angles:], 1 + len(walk.translations), axis=1)
    translations = dict(zip(walk.translations, paths[1:], strict=True))
    rotations = changed[:, :n_angles].reshape(len(changed), -1, 3)  # (n_frames, 3 n_joints) -> (n_frames, n_joints, 3)
    return replace(walk, rotations=rotations, root=paths[0], translations=translations, **fields)
