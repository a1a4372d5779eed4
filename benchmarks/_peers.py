"""The same Fourier fits by other means, each written as a good user of that tool would write it.

Each fit takes channels (n_frames, n_channels), the frame rate and the frequency, and returns coefficients
(5, n_channels): mean, sin1, cos1, sin2, cos2, with time zero in the first frame.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len, rfft
from scipy.optimize import curve_fit

__all__ = [
    "fit_by_curve_fit",
    "fit_by_lstsq",
    "fit_by_normal_equations",
    "frequency_by_fft",
    "make_fit_by_scikit_fda",
    "refine_by_gauss_newton",
]

Array = NDArray[np.float64]


def _design(n_frames: int, frame_rate: float, frequency: float) -> Array:
    angles = 2 * np.pi * frequency / frame_rate * np.arange(n_frames)
    return np.column_stack((np.ones(n_frames), np.sin(angles), np.cos(angles), np.sin(2 * angles), np.cos(2 * angles)))


def fit_by_lstsq(channels: Array, frame_rate: float, frequency: float) -> Array:
    """Fit with `numpy.linalg.lstsq` on a matrix of sines and cosines."""
    return np.linalg.lstsq(_design(len(channels), frame_rate, frequency), channels)[0]


def fit_by_normal_equations(channels: Array, frame_rate: float, frequency: float) -> Array:
    """Fit with one matrix product and a 5 x 5 system."""
    design = _design(len(channels), frame_rate, frequency)
    return np.linalg.solve(design.T @ design, design.T @ channels)


def make_fit_by_scikit_fda():
    """Return a fit by scikit-fda's `FDataGrid.to_basis`, all channels of a walk as the samples of one data grid."""
    import skfda
    from skfda.representation.basis import FourierBasis

    def fit(channels: Array, frame_rate: float, frequency: float) -> Array:
        times = np.arange(len(channels)) / frame_rate
        basis = FourierBasis(domain_range=(times[0], times[-1]), n_basis=5, period=1 / frequency)
        coefficients = skfda.FDataGrid(channels.T, times).to_basis(basis).coefficients.T
        # Its basis functions have unit norm over a period.
        return coefficients * np.sqrt(np.array([1, 2, 2, 2, 2]) * frequency)[:, np.newaxis]

    return fit


def fit_by_curve_fit(channels: Array, frame_rate: float, frequency: float) -> Array:
    """Fit one channel after the other with `scipy.optimize.curve_fit`."""
    angles = 2 * np.pi * frequency / frame_rate * np.arange(len(channels))

    def series(x, mean, sin1, cos1, sin2, cos2):
        return mean + sin1 * np.sin(x) + cos1 * np.cos(x) + sin2 * np.sin(2 * x) + cos2 * np.cos(2 * x)

    return np.column_stack([curve_fit(series, angles, channel)[0] for channel in channels.T])


def frequency_by_fft(
    signals: Array, frame_rate: float, *, padding: int = 4, parabola: bool = True, n_harmonics: int = 1
) -> float:
    """Return the peak of the summed power spectrum of some signals (n_frames, n_signals), in hertz.

    Parameters
    ----------
    padding : int
        The transform is so many times as long as the signals.
    parabola : bool
        Whether the top of a parabola through the peak and its neighbors is returned, or the peak's bin.
    n_harmonics : int
        With more than 1 the peak of the sum over harmonics, harmonic k with weight 1 / k.
    """
    length = next_fast_len(padding * len(signals), real=True)
    power = (np.abs(rfft((signals - signals.mean(axis=0)).T, length)) ** 2).sum(axis=0)  # (n_signals, bins) -> (bins,)
    low, high = max(1, int(0.3 * length / frame_rate)), int(2.5 * length / frame_rate) + 1
    if n_harmonics > 1:
        bins = np.arange(low - 1, high + 1)
        power = sum(power[np.minimum(k * bins, len(power) - 1)] / k for k in range(1, n_harmonics + 1))
        low, high = 1, len(bins) - 1
        first = bins[0]
    else:
        first = 0
    best = low + int(np.argmax(power[low:high]))
    before, top, after = power[best - 1 : best + 2]
    bend = before - 2 * top + after
    beside = 0.5 * (before - after) / bend if parabola and bend < 0 else 0.0
    return float((first + best + beside) * frame_rate / length)


def refine_by_gauss_newton(
    channels: Array, frame_rate: float, frequency: float, *, n_harmonics: int = 4, max_iter: int = 10
) -> float:
    """Return the frequency by variable projection with matrix products, from a start nearby.

    Until the step is below 1e-10 of the frequency.
    """
    times = np.arange(len(channels)) - 0.5 * (len(channels) - 1)
    orders = np.repeat(np.arange(1, n_harmonics + 1), 2)[:, np.newaxis]
    omega = 2 * np.pi * frequency / frame_rate
    design = np.ones((len(channels), 2 * n_harmonics + 1))
    for _ in range(max_iter):
        wave = np.exp(1j * omega * times)
        power = wave
        for k in range(1, n_harmonics + 1):
            design[:, 2 * k - 1], design[:, 2 * k] = power.imag, power.real
            power = power * wave
        gram = design.T @ design
        coefficients = np.linalg.solve(gram, design.T @ channels)
        residual = channels - design @ coefficients
        turned = np.empty_like(coefficients[1:])
        turned[0::2], turned[1::2] = -coefficients[2::2], coefficients[1::2]
        slope = times[:, np.newaxis] * (design[:, 1:] @ (orders * turned))  # (n_frames, n_channels)
        overlap = design.T @ slope
        curvature = np.vdot(slope, slope) - np.vdot(overlap, np.linalg.solve(gram, overlap))
        step = np.vdot(slope, residual) / curvature
        omega += step
        if abs(step) <= 1e-10 * omega:
            break
    return float(omega * frame_rate / (2 * np.pi))
