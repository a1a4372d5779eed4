"""Steady cadence: where in its stride a walk is at each moment, and the walk without drift of its cadence."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline
from scipy.signal import fftconvolve

from eigenwalker._validation import WalkError, check_finite
from eigenwalker.motion.filtering import along_time
from eigenwalker.motion.fourier import SEARCH_HARMONICS
from eigenwalker.motion.heading import check_in_place
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.walk import AnyWalk, JointWalk, Walk

__all__ = ["StridePhase", "fit_phase", "steady_cadence", "stride_phase"]

_MAX_STEPS = 50
_PRECISION = 1e-7  # radians of phase at which the search ends
_LARGEST_STEP = 0.5  # radians anywhere in one step of Gauss-Newton; longer ones may jump to the next stride
_SLOWEST = 0.2  # of the mean cadence; a phase that nearly stops or turns back is no drift


class StridePhase(NamedTuple):
    """Where in its stride a walk is, frame by frame.

    Parameters
    ----------
    phase : ndarray of shape (n_frames,)
        In radians, rising by 2 pi a stride, zero in the first frame.
    frequency : float
        Mean stride frequency in hertz, from the first frame to the last.
    """

    phase: NDArray[np.floating]
    frequency: float


def stride_phase(
    walk: Walk | JointWalk, *, n_terms: int | None = None, phase_reference: str | Mapping[str, float] = "auto"
) -> StridePhase:
    r"""Return the slowly varying phase of a walk, estimated from all its channels.

    .. math:: \varphi(t) = 2 \pi f t + \sum_{j=1}^{J} a_j P_j(t)

    with Legendre polynomials P_j over the length of the walk. For each trial phase the walk is a series of 4
    harmonics with least-squares coefficients, so that only the a_j are searched (variable projection, Gauss-Newton).
    The search starts from the phase of the phase reference over two strides around each moment.

    Parameters
    ----------
    walk : Walk or JointWalk
        Prepared: without its path over the floor.
    n_terms : int, default None
        Number J of terms. None is one for every two strides; a walk of less than two strides keeps its cadence.
    phase_reference : "auto" or mapping of str to float, default "auto"
        See `phase_weights`.

    Returns
    -------
    StridePhase

    Raises
    ------
    WalkError
        If the walk travels, has values that are not finite, no period or less than one stride, or if no phase that
        rises throughout fits it.
    ValueError
        If `n_terms` is not a whole number of 0 or more.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import stride_phase
    >>> walk = make_walkers(1, random_state=0).data[0]
    >>> phase, frequency = stride_phase(walk)
    >>> phase.shape == (walk.n_frames,)
    True
    """
    channels = np.asarray(walk.channels, dtype=np.float64)
    check_finite(channels, walk.channel_names, walk=walk.name)
    if n_terms is not None and (n_terms != int(n_terms) or n_terms < 0):
        raise ValueError(f"n_terms must be a whole number of 0 or more, or None, got {n_terms!r}")
    if isinstance(walk, Walk) and "pelvis" in walk.marker_set.names:
        check_in_place(walk)
    frequency = stride_frequency(walk, phase_reference=phase_reference)
    n_strides = walk.duration * frequency
    n_terms = int(n_strides / 2) if n_terms is None else int(n_terms)
    n_harmonics = max(1, min(SEARCH_HARMONICS, int(0.45 * walk.frame_rate / frequency)))
    phase = 2 * np.pi * frequency / walk.frame_rate * np.arange(walk.n_frames)
    if n_terms:
        start = phase + _first_drift(channels @ phase_weights(walk, phase_reference), phase, n_terms)
        phase = fit_phase(channels, start, n_terms=n_terms, n_harmonics=n_harmonics)
    steps = np.diff(phase)
    if steps.size == 0 or steps.min() < _SLOWEST * steps.mean():
        raise WalkError(
            f"walk {walk.name!r}: expected a phase that rises throughout, got one that stops or turns back; "
            f"use fewer than n_terms={n_terms}, or a part of the walk without a stop"
        )
    return StridePhase(phase - phase[0], float(steps.mean() * walk.frame_rate / (2 * np.pi)))


def _first_drift(reference: NDArray[np.floating], phase: NDArray[np.floating], n_terms: int) -> NDArray[np.floating]:
    """Return how far the phase of a signal (n_frames,) runs ahead of a steady one, as a Legendre polynomial.

    The signal is demodulated: its product with exp(-i phase) turns slowly. Hann's window over two strides leaves the
    other harmonics and the mean out.
    """
    half = round(2 * np.pi / (phase[1] - phase[0]))  # frames of a stride
    window = np.hanning(2 * half + 1)
    turning = fftconvolve((reference - reference.mean()) * np.exp(-1j * phase), window, mode="full")
    turning = turning[half : half + len(phase)]
    angles, certainty = np.unwrap(np.angle(turning)), np.abs(turning)[:, np.newaxis]
    basis = legvander(np.linspace(-1.0, 1.0, len(phase)), n_terms)
    terms = np.linalg.lstsq(certainty * basis, certainty[:, 0] * angles)[0]
    return basis[:, 1:] @ terms[1:]


def fit_phase(
    channels: NDArray[np.floating], start: NDArray[np.floating], *, n_terms: int, n_harmonics: int
) -> NDArray[np.floating]:
    """Return the phase near `start` in which a harmonic series explains most of all channels.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        The walk.
    start : ndarray of shape (n_frames,)
        First guess, in radians.
    n_terms : int
        Number of Legendre polynomials that may be added to it.
    n_harmonics : int
        Harmonics in the search.

    Returns
    -------
    ndarray of shape (n_frames,)
        In radians. Its constant is that of `start`, because a shift of phase changes nothing.
    """
    drift = legvander(np.linspace(-1.0, 1.0, len(channels)), n_terms)[:, 1:]  # (n_frames, n_terms)
    phase = start
    best, change = _project(channels, phase, drift, n_harmonics)
    for _ in range(_MAX_STEPS):
        change *= min(1.0, _LARGEST_STEP / max(np.abs(change).max(), 1e-300))
        trial, next_change = _project(channels, phase + change, drift, n_harmonics)
        if trial > best * (1 + 1e-12):
            change = change / 2  # too far
            if np.abs(change).max() < _PRECISION:
                break
            continue
        phase, best, change = phase + change, trial, next_change
        if np.abs(change).max() < _PRECISION:
            break
    return phase


def _project(
    channels: NDArray[np.floating], phase: NDArray[np.floating], drift: NDArray[np.floating], n_harmonics: int
) -> tuple[float, NDArray[np.floating]]:
    """Return the sum of squares that a phase leaves, and Gauss-Newton's change of the phase, shape (n_frames,).

    With the basis F = Q R, coefficients B, residual r and the motion's derivative by phase g = F' B, the change by
    term j is (I - Q Q') (P_j g); the least-squares solution of all of them for r is found from its normal equations.
    """
    orders = np.arange(1, n_harmonics + 1)
    angles = np.outer(phase, orders)
    sines, cosines = np.sin(angles), np.cos(angles)
    orthogonal, triangle = np.linalg.qr(np.column_stack((np.ones(len(phase)), sines, cosines)))
    along = orthogonal.T @ channels
    residual = channels - orthogonal @ along
    coefficients = np.linalg.solve(triangle, along)[1:]
    slope = np.column_stack((orders * cosines, -orders * sines)) @ coefficients  # (n_frames, n_channels)
    weight = (slope * slope).sum(axis=1)
    gram = drift.T @ (weight[:, np.newaxis] * drift)
    # What of each P_j g lies in the basis: (n_functions, n_terms, n_channels)
    inside = np.einsum("tf,tj,tc->fjc", orthogonal, drift, slope, optimize=True)
    gram -= np.einsum("fjc,fkc->jk", inside, inside, optimize=True)
    right = drift.T @ (slope * residual).sum(axis=1)  # r is orthogonal to the basis, so g need not be projected
    return float(np.vdot(residual, residual)), drift @ np.linalg.lstsq(gram, right)[0]


def steady_cadence(
    walk: AnyWalk, *, n_terms: int | None = None, phase_reference: str | Mapping[str, float] = "auto"
) -> AnyWalk:
    """Return the walk at constant cadence, with its mean frequency, first and last frame unchanged.

    What drifts is the time a stride takes and nothing else: each frame of the result shows the posture that the walk
    had when it was in that phase. Without it, drift of cadence would count as noise; with it, the drift is gone, which
    is why `prepare` does this only when asked.

    Parameters
    ----------
    walk : Walk or JointWalk
        Prepared: without its path over the floor.
    n_terms : int, default None
        See `stride_phase`.
    phase_reference : "auto" or mapping of str to float, default "auto"
        See `phase_weights`.

    Returns
    -------
    Walk or JointWalk
        As many frames at the same rate. Events move to the frames of their phase.

    Raises
    ------
    WalkError
        See `stride_phase`.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import steady_cadence, walk_quality
    >>> walk = make_walkers(1, random_state=0).data[0]
    >>> bool(walk_quality(steady_cadence(walk)).explained_power >= walk_quality(walk).explained_power)
    True
    """
    phase, frequency = stride_phase(walk, n_terms=n_terms, phase_reference=phase_reference)
    frames = np.arange(walk.n_frames, dtype=np.float64)
    degree = min(5, walk.n_frames - 1)
    sources = make_interp_spline(phase, frames, k=min(3, degree))(np.linspace(0.0, phase[-1], walk.n_frames))
    sources = np.clip(sources, 0.0, frames[-1])  # the ends, against rounding
    known = walk.frequency if np.isnan(walk.frequency) else frequency
    events = tuple(event._replace(time=_moved(event.time, sources, walk.frame_rate)) for event in walk.events)
    return along_time(
        replace(walk, events=events, frequency=known),
        lambda paths: make_interp_spline(frames, paths, k=degree)(sources),
    )


def _moved(time: float, sources: NDArray[np.float64], frame_rate: float) -> float:
    """Return when the result shows what the walk showed at a time; times before and after the walk stay."""
    shifts = np.arange(len(sources)) - sources  # zero in the first and in the last frame
    return time + float(np.interp(time * frame_rate, sources, shifts)) / frame_rate
