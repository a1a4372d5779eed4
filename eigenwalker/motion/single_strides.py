"""Single strides: a walk cut each time that it passes phase zero, every stride with its own duration."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_finite
from eigenwalker.motion.clip import cut
from eigenwalker.motion.fourier import SEARCH_HARMONICS, reference_phase
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["count_strides", "phase_zeros", "split_strides", "stride_counts", "whole_counts"]

_MAX_ROUNDS = 50
_PRECISION = 1e-4  # strides at which the search ends
_LACKING = 1.5  # frames that the first and the last stride may lack, where a walk was cut from stride to stride
_ROUNDING = 1e-6  # frames by which a start that lies on a frame may miss it


def split_strides(walk: Walk | JointWalk, *, phase_reference: str | Mapping[str, float] = "auto") -> list[Any]:
    """Return the single strides of a walk, from phase zero to phase zero, each with its own `frequency`.

    Phase zero is where the phase reference is furthest ahead, see `phase_weights`; when it is passed is found from all
    channels, see `count_strides`. What comes before the first and after the last phase zero is left out.

    Parameters
    ----------
    walk : Walk or JointWalk
        Prepared: without its path over the floor.
    phase_reference : "auto" or mapping of str to float, default "auto"
        See `phase_weights`.

    Returns
    -------
    list of Walk or JointWalk
        In their order, called ``name_stride1``, ``name_stride2`` ...; with `frequency` = 1 / duration of the stride,
        which need not be a whole number of frames. Empty where phase zero is not passed twice.

    Raises
    ------
    WalkError
        If the walk has values that are not finite, no period or less than one stride, or if its phase turns back.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion.single_strides import split_strides
    >>> walk = make_walkers(1, random_state=0).data[0]
    >>> strides = split_strides(walk)
    >>> strides[0].name, len(strides) <= walk.duration / strides[0].duration
    ('walker_000_stride1', True)
    """
    counts = stride_counts(walk, phase_reference=phase_reference)
    zeros = pairwise(phase_zeros(counts))
    return [_cut_stride(walk, start, end, number) for number, (start, end) in enumerate(zeros, 1)]


def stride_counts(
    walk: Walk | JointWalk, *, phase_reference: str | Mapping[str, float] = "auto"
) -> NDArray[np.floating]:
    """Return `count_strides` of a walk, or raise a WalkError as `split_strides` does."""
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    step = stride_frequency(walk, phase_reference=phase_reference) / walk.frame_rate
    counts = count_strides(walk.channels, step, phase_weights(walk, phase_reference))
    if np.diff(counts).min() <= 0:
        raise WalkError(
            f"walk {walk.name!r}: expected strides one after the other, got a phase that turns back; is "
            f"{step * walk.frame_rate:.3g} Hz its stride frequency? Else take the part of the walk without a stop"
        )
    return counts


def count_strides(channels: NDArray[np.floating], step: float, weights: NDArray[np.floating]) -> NDArray[np.floating]:
    r"""Return how many strides have passed in each frame, a whole number wherever the phase is zero.

    .. math:: n(t) = n_j + \frac{t - t_j}{t_{j + 1} - t_j} \text{ for } t_j \le t < t_{j + 1}

    Within each stride the cadence is steady, from stride to stride it is not; n_j are whole numbers, and the times t_j
    of phase zero are what is searched. By turns, the coefficients of a harmonic series in n(t), about a mean posture
    that is linear between the t_j, are fitted to all channels, and the t_j are moved such that it comes nearest to the
    motion (Gauss-Newton), until nothing moves. A window that slides over the walk would even neighboring strides out,
    and maxima of the phase reference alone would take the variation of one ankle for one of the cadence.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        The walk.
    step : float
        Mean stride frequency over frame rate.
    weights : ndarray of shape (n_channels,)
        From `phase_weights`.

    Returns
    -------
    ndarray of shape (n_frames,)
        Before the first and after the last phase zero with the cadence of the stride beside it.
    """
    channels = np.asarray(channels, dtype=np.float64)
    n_harmonics = max(1, min(SEARCH_HARMONICS, int(0.45 / step)))
    counts = step * np.arange(len(channels))
    for _ in range(_MAX_ROUNDS):
        coefficients, slope, rest = _fit_series(channels, counts, n_harmonics)
        counts = counts - reference_phase(coefficients, weights) / (2 * np.pi)
        hats = _hats(counts)
        gram = hats.T @ ((slope * slope).sum(axis=1)[:, np.newaxis] * hats)
        change = hats @ np.linalg.lstsq(gram, hats.T @ (slope * rest).sum(axis=1))[0]
        counts = counts + change
        if np.abs(change).max() < _PRECISION:
            break
    return counts


def _fit_series(
    channels: NDArray[np.floating], counts: NDArray[np.floating], n_harmonics: int
) -> tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.floating]]:
    """Return coefficients, the derivative of the series by strides, and what it leaves of the channels.

    The first row of the coefficients, (2 K + 1, n_channels), is the mean posture at the last phase zero.
    """
    orders = np.arange(1, n_harmonics + 1)
    angles = 2 * np.pi * np.outer(counts, orders)
    sines, cosines = np.sin(angles), np.cos(angles)
    waves = np.stack((sines, cosines), axis=2).reshape(len(counts), -1)  # (n_frames, K, 2) -> (n_frames, 2 K)
    turned = np.stack((orders * cosines, -orders * sines), axis=2).reshape(len(counts), -1)
    basis = np.column_stack((_hats(counts), waves))
    solution = np.linalg.lstsq(basis.T @ basis, basis.T @ channels)[0]
    coefficients = solution[-2 * n_harmonics - 1 :]
    return coefficients, 2 * np.pi * turned @ coefficients[1:], channels - basis @ solution


def _hats(counts: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return functions that are 1 at one phase zero, 0 at all others and linear between, (n_frames, n_functions).

    They go on at both ends; where there are no two phase zeros there is one constant function.
    """
    whole = whole_counts(counts)
    if len(whole) < 2:
        return np.ones((len(counts), 1))
    left = np.clip(np.floor(counts - whole[0]).astype(np.intp), 0, len(whole) - 2)
    share = counts - whole[0] - left
    hats = np.zeros((len(counts), len(whole)))
    frames = np.arange(len(counts))
    hats[frames, left], hats[frames, left + 1] = 1 - share, share
    return hats


def whole_counts(counts: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return the whole numbers that the counts pass, or come near to at an end."""
    first, last = counts[1] - counts[0], counts[-1] - counts[-2]
    return np.arange(np.ceil(counts[0] - _LACKING * first), np.floor(counts[-1] + _LACKING * last) + 1)


def phase_zeros(counts: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the frames, which need not be whole, in which `whole_counts` are reached."""
    return np.interp(whole_counts(counts), _beyond_ends(counts), np.arange(-2.0, len(counts) + 2))


def _beyond_ends(counts: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return the counts, continued by two frames at both ends."""
    first, last = counts[1] - counts[0], counts[-1] - counts[-2]
    return np.concatenate((counts[0] + first * np.array([-2, -1]), counts, counts[-1] + last * np.array([1, 2])))


def _cut_stride(walk: Any, start: float, end: float, number: int) -> Any:
    """Keep the frames from a start to before the next; both need not lie on a frame."""
    frames = slice(max(0, int(np.ceil(start - _ROUNDING))), int(np.ceil(end - _ROUNDING)))
    name, frequency = f"{walk.name}_stride{number}", float(walk.frame_rate / (end - start))
    return replace(cut(walk, frames), name=name, frequency=frequency)
