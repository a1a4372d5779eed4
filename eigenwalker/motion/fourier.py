r"""The Fourier model of one walk (Troje 2002, Eq. 1): fit, frequency, phase and evaluation.

.. math:: p(t) = p_0 + \sum_{k=1}^{K} s_k \sin(k \omega t) + c_k \cos(k \omega t) + err

Coefficients are arrays of shape (2 K + 1, n_channels) with the rows mean, sin1, cos1, sin2, cos2 ...
All functions work on plain arrays, time first. Frequencies are in hertz, times in seconds.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import WalkError, check_frame_rate
from eigenwalker.motion._kernels import block_means, fit_series, line_and_wave_shares, refine, residual_power

__all__ = [
    "amplitude_phase",
    "check_sampling",
    "coarse_frequency",
    "estimate_frequency",
    "evaluate_harmonics",
    "explained_by",
    "explained_power",
    "fit_harmonics",
    "reference_phase",
    "shift_phase",
]

SEARCH_HARMONICS = 4
FREQUENCY_RANGE = (0.3, 2.5)
_MAX_STEPS = 50
_TRIALS = 48  # least number of frequencies tried for it
_TRIALS_PER_CYCLE = 4  # and least number from one more cycle in the signal to the next
_FRAMES_PER_WAVE = 6  # that suffice for the first guess, and of the highest harmonic for the first steps from it
_FEW_FRAMES = 50  # of which no blocks are made
_WEAK = 0.2  # share of the reference below which its best sine is no period


def fit_harmonics(
    channels: NDArray[np.floating], frame_rate: float, frequency: float, n_harmonics: int
) -> NDArray[np.float64]:
    """Return the least-squares coefficients of a harmonic series (Troje 2002, Eq. 1).

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        The walk.
    frame_rate : float
        Frames per second.
    frequency : float
        Fundamental frequency in hertz.
    n_harmonics : int
        Number K of harmonics, the fundamental included.

    Returns
    -------
    ndarray of shape (2 K + 1, n_channels)
        Rows mean, sin1, cos1, ..., with time zero in the first frame.

    Raises
    ------
    ValueError
        If there are fewer frames than coefficients, or if harmonic K reaches half the frame rate.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import fit_harmonics
    >>> t = np.arange(120) / 60
    >>> fit_harmonics(1 + 2 * np.sin(2 * np.pi * t)[:, None], 60, 1.0, 1).round(6).ravel() + 0
    array([1., 2., 0.])
    """
    check_sampling(len(channels), frame_rate, frequency, n_harmonics)
    return fit_series(_as_compiled(channels), 2 * np.pi * frequency / frame_rate, n_harmonics)


def _as_compiled(channels: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return channels as the one kind of array that the compiled loops take: every other kind is compiled anew."""
    array = np.ascontiguousarray(channels, dtype=np.float64)
    if not array.flags.writeable:
        return array
    view = array.view()
    view.flags.writeable = False
    return view


def check_sampling(n_frames: int, frame_rate: float, frequency: float, n_harmonics: int) -> None:
    """Raise unless so many frames carry so many harmonics."""
    check_frame_rate(frame_rate)
    if n_harmonics < 1:
        raise ValueError(f"n_harmonics must be at least 1, got {n_harmonics}")
    if not 0 < frequency < np.inf:
        raise ValueError(f"frequency must be positive and finite, in hertz, got {frequency}")
    if n_harmonics * frequency >= frame_rate / 2:
        raise ValueError(
            f"harmonic {n_harmonics} of {frequency:.4g} Hz must lie below half the frame rate, "
            f"{frame_rate / 2:.4g} Hz; use fewer harmonics or a higher frame rate"
        )
    if n_frames < 2 * n_harmonics + 1:
        raise ValueError(f"expected at least {2 * n_harmonics + 1} frames for {n_harmonics} harmonics, got {n_frames}")


def evaluate_harmonics(coefficients: NDArray[np.floating], frequency: float, times: ArrayLike) -> NDArray[np.float64]:
    """Return the walk that coefficients stand for (Troje 2002, Eq. 1 without its residual).

    Parameters
    ----------
    coefficients : ndarray of shape (2 K + 1, n_channels)
        Rows mean, sin1, cos1, ...
    frequency : float
        Fundamental frequency in hertz.
    times : array-like of shape (n_times,)
        In seconds.

    Returns
    -------
    ndarray of shape (n_times, n_channels)
    """
    times = np.asarray(times, dtype=np.float64)
    n_harmonics = (len(coefficients) - 1) // 2
    angles = 2 * np.pi * frequency * times[:, np.newaxis] * np.arange(1, n_harmonics + 1)
    basis = np.ones((len(times), len(coefficients)))
    np.sin(angles, out=basis[:, 1::2])
    np.cos(angles, out=basis[:, 2::2])
    return basis @ coefficients


def shift_phase(coefficients: NDArray[np.floating], phase: float) -> NDArray[np.float64]:
    """Return the coefficients of the walk that starts `phase` radians of the fundamental later.

    With t' = t - phase / omega: s'_k = s_k cos(k phase) - c_k sin(k phase) and
    c'_k = s_k sin(k phase) + c_k cos(k phase).

    Parameters
    ----------
    coefficients : ndarray of shape (2 K + 1, n_channels)
        Rows mean, sin1, cos1, ...
    phase : float
        In radians.

    Returns
    -------
    ndarray of shape (2 K + 1, n_channels)
    """
    shifted = np.array(coefficients, dtype=np.float64)
    sines, cosines = shifted[1::2], shifted[2::2]
    angles = phase * np.arange(1, len(sines) + 1)[:, None]
    shifted[1::2], shifted[2::2] = (
        sines * np.cos(angles) - cosines * np.sin(angles),
        sines * np.sin(angles) + cosines * np.cos(angles),
    )
    return shifted


def amplitude_phase(coefficients: NDArray[np.floating]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return amplitude and phase of each harmonic (Tilmanne & Dutoit 2012, Eq. 5 and 6).

    The harmonic is amplitude cos(k omega t + phase): amplitude = hypot(s, c) and phase = atan2(-s, c). Their
    Eq. 6 prints an arc tangent of the quotient, which loses the quadrant.

    Parameters
    ----------
    coefficients : ndarray of shape (2 K + 1, n_channels)
        Rows mean, sin1, cos1, ...

    Returns
    -------
    amplitude, phase : ndarray of shape (K, n_channels)
        In the unit of the channels, and in radians.
    """
    sines, cosines = coefficients[1::2], coefficients[2::2]
    return np.hypot(sines, cosines), np.arctan2(-sines, cosines)


def reference_phase(coefficients: NDArray[np.floating], weights: NDArray[np.floating]) -> float:
    """Return the phase at which the first harmonic of a weighted sum of channels has its maximum.

    Shifting by it makes that first harmonic a pure cosine with positive sign.

    Parameters
    ----------
    coefficients : ndarray of shape (2 K + 1, n_channels)
        Rows mean, sin1, cos1, ...
    weights : ndarray of shape (n_channels,)
        Weight of each channel in the reference.

    Returns
    -------
    float
        In radians.
    """
    return float(np.arctan2(coefficients[1] @ weights, coefficients[2] @ weights))


def explained_power(channels: NDArray[np.floating], frame_rate: float, frequency: float, n_harmonics: int) -> float:
    """Return the share of a walk's power that its harmonics explain, between 0 and 1.

    1 - SS_residual / SS, both sums of squares pooled over all channels, about each channel's mean over time.
    Troje (2002, section 2) reports "less than 3 %" of the power as residual without a denominator, so the two
    figures are not the same quantity.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        The walk.
    frame_rate, frequency : float
        In hertz.
    n_harmonics : int
        Number of harmonics.

    Returns
    -------
    float
    """
    coefficients = fit_harmonics(channels, frame_rate, frequency, n_harmonics)
    return explained_by(coefficients, channels, frame_rate, frequency)


def explained_by(
    coefficients: NDArray[np.floating], channels: NDArray[np.floating], frame_rate: float, frequency: float
) -> float:
    """Return the `explained_power` of coefficients that `fit_harmonics` has fitted already."""
    omega = 2 * np.pi * frequency / frame_rate
    left, total = residual_power(_as_compiled(channels), _as_compiled(coefficients), omega)
    return 1.0 - left / total if total > 0 else 0.0


def estimate_frequency(
    channels: NDArray[np.floating],
    frame_rate: float,
    *,
    start: float,
    n_harmonics: int = SEARCH_HARMONICS,
    precision: float = 1e-3,
) -> float:
    """Return the fundamental frequency that explains most power in all channels, by variable projection.

    For each trial frequency the coefficients are the least-squares ones, so that only the frequency is searched:
    Gauss-Newton on the residual with Kaufman's gradient, from `start`, until what is left is a small part
    of the frequency's standard error, or rounding. With white noise the error is at the Cramer-Rao bound.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        The walk.
    frame_rate : float
        Frames per second.
    start : float
        First guess in hertz, from `coarse_frequency` for instance; within about 0.1 / duration of the result.
    n_harmonics : int, default 4
        Harmonics in the search. More than are kept later, because a 3rd and 4th harmonic that are left out of the
        search bias it. Lowered where the frame rate or the number of frames does not carry them.
    precision : float, default 1e-3
        Largest error of the search itself, in standard errors of the frequency.

    Returns
    -------
    float
        In hertz.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import estimate_frequency
    >>> t = np.arange(400) / 100
    >>> wave = np.c_[np.sin(2 * np.pi * 0.93 * t), np.cos(4 * np.pi * 0.93 * t)]
    >>> round(estimate_frequency(wave, 100, start=0.95), 9)
    0.93
    """
    carried = max(1, min(n_harmonics, int(0.45 * frame_rate / start), (len(channels) - 2) // 3))
    check_sampling(len(channels), frame_rate, start, carried)
    omega, ratio = 2 * np.pi * start / frame_rate, 1.0
    block = int(frame_rate / (_FRAMES_PER_WAVE * carried * start))
    channels = _as_compiled(channels)
    if block > 1:  # the first steps on fewer frames
        means = _as_compiled(block_means(channels, block))
        omega, ratio = refine(means, omega * block, carried, ratio, 0.01, _MAX_STEPS)
        omega /= block
    omega, _ = refine(channels, omega, carried, ratio, precision, _MAX_STEPS)
    return float(omega * frame_rate / (2 * np.pi))


def coarse_frequency(
    reference: NDArray[np.floating],
    frame_rate: float,
    *,
    frequency_range: tuple[float, float] = FREQUENCY_RANGE,
    name: str = "",
) -> float:
    """Return a first guess of the stride frequency from one signal, such as left minus right ankle, forward.

    Left and right steps are mirror images, so that in a difference of the two sides the fundamental stands alone:
    twice the stride frequency cancels and nothing is found at half of it. That is what guards against octave errors.
    The guess is the frequency whose sine and cosine, fitted together with a straight line, explain most power.

    Parameters
    ----------
    reference : ndarray of shape (n_frames,)
        A signal whose fundamental is that of the gait.
    frame_rate : float
        Frames per second.
    frequency_range : tuple of float, default (0.3, 2.5)
        In hertz. Frequencies with less than one cycle in the signal are left out.
    name : str, default ""
        The walk's name, for the error.

    Returns
    -------
    float
        In hertz, good to about 0.05 / duration.

    Raises
    ------
    WalkError
        If the signal is shorter than one stride or has no period in the range.
    """
    check_frame_rate(frame_rate)
    block = max(1, min(int(frame_rate / (_FRAMES_PER_WAVE * frequency_range[1])), len(reference) // _FEW_FRAMES))
    signal = block_means(_as_compiled(np.reshape(reference, (-1, 1))), block).ravel()
    rate = frame_rate / block
    duration = len(signal) / rate
    low, high = max(frequency_range[0], 0.6 / duration), min(frequency_range[1], 0.4 * rate)
    if low >= high:
        raise WalkError(
            f"walk {name!r}: expected at least one stride, got {len(reference)} frames, {duration:.3g} s; "
            f"no frequency between {frequency_range[0]:g} and {frequency_range[1]:g} Hz fits into that"
        )
    n_trials = max(_TRIALS, int((high - low) * duration * _TRIALS_PER_CYCLE))
    frequencies = low + (high - low) / (n_trials - 1) * np.arange(n_trials, dtype=np.float64)
    shares = line_and_wave_shares(signal, 2 * np.pi * frequencies / rate)
    best = int(np.argmax(shares))
    if shares[best] < _WEAK or best in (0, len(shares) - 1):
        raise WalkError(
            f"walk {name!r}: expected a periodic part between {low:.2g} and {high:.2g} Hz, but the best sine explains "
            f"{shares[best]:.0%} of left minus right, at {frequencies[best]:.2g} Hz; is it a walk, longer than a "
            "stride, with left and right where the names say?"
        )
    return _top_of_parabola(frequencies, shares, best)


def _top_of_parabola(grid: NDArray[np.float64], values: NDArray[np.float64], best: int) -> float:
    """Return where the parabola through the best grid point and its neighbours is highest."""
    before, top, after = values[best - 1 : best + 2]
    bend = before - 2 * top + after
    return float(grid[best] + 0.5 * (grid[1] - grid[0]) * ((before - after) / bend if bend < 0 else 0.0))
