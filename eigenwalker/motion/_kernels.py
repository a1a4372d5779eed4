"""Compiled loops of the Fourier model. Time is in frames, counted from the middle of the walk.

There the sums of sines times cosines vanish, so that all products of the basis functions

    1, sin(omega t), cos(omega t), sin(2 omega t), cos(2 omega t), ...

follow from a few sums over time, and the data are read once.
"""

import numpy as np
from numba import njit

__all__ = ["correlate", "line_and_wave_shares", "refine", "solve"]

_CHUNK = 128  # frames held at a time: few enough for the cache and for one thread of the matrix product


@njit(cache=True, nogil=True)
def _fill_basis(basis, first, n_frames, omega, n_harmonics, timed):
    """Write the basis functions (and, if timed, time times them) of the frames from `first` into rows of `basis`.

    Sine and cosine go on by recurrence from exact values in the first row.
    """
    n_columns = 2 * n_harmonics + 1
    time = first - 0.5 * (n_frames - 1)
    step_cosine, step_sine = np.cos(omega), np.sin(omega)
    cosine, sine = np.cos(omega * time), np.sin(omega * time)
    for row in range(len(basis)):
        basis[row, 0] = 1.0
        high_cosine, high_sine = cosine, sine
        for k in range(n_harmonics):
            basis[row, 2 * k + 1] = high_sine
            basis[row, 2 * k + 2] = high_cosine
            high_cosine, high_sine = (
                high_cosine * cosine - high_sine * sine,
                high_sine * cosine + high_cosine * sine,
            )
        cosine, sine = cosine * step_cosine - sine * step_sine, sine * step_cosine + cosine * step_sine
        if timed:
            for column in range(n_columns):
                basis[row, n_columns + column] = (time + row) * basis[row, column]


@njit(cache=True, nogil=True)
def _accumulate(channels, omega, n_harmonics, timed):
    n_frames, n_channels = channels.shape
    n_columns = (2 * n_harmonics + 1) * (2 if timed else 1)
    sums = np.zeros((n_columns, n_channels))
    basis = np.empty((_CHUNK, n_columns))
    chunk = np.empty((_CHUNK, n_channels))
    for first in range(0, n_frames, _CHUNK):
        count = min(_CHUNK, n_frames - first)
        _fill_basis(basis[:count], first, n_frames, omega, n_harmonics, timed)
        for row in range(count):
            for channel in range(n_channels):
                chunk[row, channel] = channels[first + row, channel]
        sums += np.dot(basis[:count].T, chunk[:count])  # (n_columns, count) @ (count, n_channels)
    return sums


@njit(cache=True, nogil=True)
def correlate(channels, omega, n_harmonics):
    """Return the sums over time of each basis function times each channel, shape (2 K + 1, n_channels).

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        float32 or float64; sums are float64.
    omega : float
        Fundamental frequency in radians per frame.
    n_harmonics : int
        Number K of harmonics.
    """
    return _accumulate(channels, omega, n_harmonics, False)


@njit(cache=True, nogil=True)
def _time_sums(n_frames, omega, highest):
    """Return sum cos(m omega t), sum t sin(m omega t) and sum t^2 cos(m omega t) for m = 0 .. highest."""
    sums = np.zeros((3, highest + 1))
    center = 0.5 * (n_frames - 1)
    wave_cosine, wave_sine = 1.0, 0.0
    step_cosine, step_sine = np.cos(omega), np.sin(omega)
    for frame in range(n_frames):
        time = frame - center
        if frame % _CHUNK == 0:
            wave_cosine = np.cos(omega * time)
            wave_sine = np.sin(omega * time)
        cosine, sine = 1.0, 0.0
        for m in range(highest + 1):
            sums[0, m] += cosine
            sums[1, m] += time * sine
            sums[2, m] += time * time * cosine
            cosine, sine = cosine * wave_cosine - sine * wave_sine, sine * wave_cosine + cosine * wave_sine
        wave_cosine, wave_sine = (
            wave_cosine * step_cosine - wave_sine * step_sine,
            wave_sine * step_cosine + wave_cosine * step_sine,
        )
    return sums


@njit(cache=True, nogil=True)
def _even_products(sums, n_harmonics):
    """Return the Gram matrix of the basis, weighted by the even function of time whose cosine sums are given."""
    n_rows = 2 * n_harmonics + 1
    gram = np.zeros((n_rows, n_rows))
    gram[0, 0] = sums[0]
    for j in range(1, n_harmonics + 1):
        gram[0, 2 * j] = gram[2 * j, 0] = sums[j]
        for k in range(1, n_harmonics + 1):
            gram[2 * j - 1, 2 * k - 1] = 0.5 * (sums[abs(j - k)] - sums[j + k])
            gram[2 * j, 2 * k] = 0.5 * (sums[abs(j - k)] + sums[j + k])
    return gram


@njit(cache=True, nogil=True)
def _odd_products(sums, n_harmonics):
    """Return the Gram matrix of the basis weighted by time, from the sums of t sin(m omega t)."""
    n_rows = 2 * n_harmonics + 1
    gram = np.zeros((n_rows, n_rows))
    for j in range(1, n_harmonics + 1):
        gram[0, 2 * j - 1] = gram[2 * j - 1, 0] = sums[j]
        for k in range(1, n_harmonics + 1):
            sign = 1.0 if j >= k else -1.0
            value = 0.5 * (sums[j + k] + sign * sums[abs(j - k)])
            gram[2 * j - 1, 2 * k] = gram[2 * k, 2 * j - 1] = value
    return gram


@njit(cache=True, nogil=True)
def _solve_positive(matrix, right):
    """Return the solution of a small symmetric positive definite system, by elimination without pivots."""
    n_rows = len(matrix)
    lower = matrix.copy()
    result = right.copy()
    for j in range(n_rows):
        for i in range(j + 1, n_rows):
            factor = lower[i, j] / lower[j, j]
            for k in range(j + 1, n_rows):
                lower[i, k] -= factor * lower[j, k]
            for channel in range(right.shape[1]):
                result[i, channel] -= factor * result[j, channel]
    for j in range(n_rows - 1, -1, -1):
        for k in range(j + 1, n_rows):
            for channel in range(right.shape[1]):
                result[j, channel] -= lower[j, k] * result[k, channel]
        for channel in range(right.shape[1]):
            result[j, channel] /= lower[j, j]
    return result


@njit(cache=True, nogil=True)
def solve(products, n_frames, omega, n_harmonics):
    """Return least-squares coefficients, shape (2 K + 1, n_channels), from the sums of `correlate`."""
    sums = np.empty(2 * n_harmonics + 1)
    sums[0] = n_frames
    for m in range(1, 2 * n_harmonics + 1):
        sums[m] = np.sin(0.5 * m * omega * n_frames) / np.sin(0.5 * m * omega)  # sum of cos(m omega t)
    return _solve_positive(_even_products(sums, n_harmonics), products)


@njit(cache=True, nogil=True)
def _project(channels, omega, n_harmonics):
    """Return explained sum of squares, its half derivative by omega, and Gauss-Newton's curvature.

    With basis F, coefficients b = (F'F)^-1 F'Y, residual r = Y - F b and derivative (t F) g of F b by omega
    (g_sin_k = -k c_k, g_cos_k = k s_k): the slope is <(t F) g, r>, the curvature ||(I - P) (t F) g||^2.
    """
    n_rows = 2 * n_harmonics + 1
    products = _accumulate(channels, omega, n_harmonics, True)
    plain, timed = products[:n_rows], products[n_rows:]
    sums = _time_sums(len(channels), omega, 2 * n_harmonics)
    gram0 = _even_products(sums[0], n_harmonics)
    coefficients = _solve_positive(gram0, plain)
    change = np.zeros_like(coefficients)
    for k in range(1, n_harmonics + 1):
        for channel in range(coefficients.shape[1]):
            change[2 * k - 1, channel] = -k * coefficients[2 * k, channel]
            change[2 * k, channel] = k * coefficients[2 * k - 1, channel]
    overlap = np.dot(_odd_products(sums[1], n_harmonics), change)
    spread = np.dot(_even_products(sums[2], n_harmonics), change)
    slope = _inner(change, timed) - _inner(overlap, coefficients)
    curvature = _inner(change, spread) - _inner(overlap, _solve_positive(gram0, overlap))
    return _inner(plain, coefficients), slope, curvature


@njit(cache=True, nogil=True)
def _inner(first, second):
    """Return the sum of products of two matrices."""
    total = 0.0
    for row in range(first.shape[0]):
        for column in range(first.shape[1]):
            total += first[row, column] * second[row, column]
    return total


@njit(cache=True, nogil=True)
def refine(channels, omega, n_harmonics, max_iter):
    """Return the frequency, in radians per frame, at which a harmonic series explains most, next to `omega`.

    Gauss-Newton steps, turned into secant steps once two slopes are known, halved while they lose power. Ends when
    a step is below 1e-5 of the frequency's standard error, or at rounding for data without noise.
    """
    n_frames, n_channels = channels.shape
    total = _inner(channels, channels)
    longest = 0.5 / n_frames  # radians a frame: a twelfth of a cycle over the whole walk
    best = omega
    power, slope, curvature = _project(channels, best, n_harmonics)
    for _ in range(max_iter):
        if curvature <= 0.0:
            break
        step = min(max(slope / curvature, -longest), longest)
        noise = max(total - power, 0.0) / (n_frames * n_channels)
        smallest = max(1e-5 * np.sqrt(noise / curvature), 4e-16 * best)
        trial_power, trial_slope, trial_curvature = _project(channels, best + step, n_harmonics)
        while trial_power < power * (1.0 - 1e-14) and abs(step) > smallest:
            step *= 0.5
            trial_power, trial_slope, trial_curvature = _project(channels, best + step, n_harmonics)
        if abs(step) <= smallest:
            break
        best += step
        # The change of slope over the step is the true curvature, which Gauss-Newton only approaches.
        secant = (slope - trial_slope) / step
        usable = 0.3 * trial_curvature < secant < 3.0 * trial_curvature
        power, slope, curvature = trial_power, trial_slope, secant if usable else trial_curvature
    return best


@njit(cache=True, nogil=True)
def line_and_wave_shares(signal, omegas):
    """Return which share of a signal's power about its straight line each sine and cosine pair explains.

    Parameters
    ----------
    signal : ndarray of shape (n_frames,)
        One channel.
    omegas : ndarray of shape (n_omegas,)
        In radians per frame.

    Returns
    -------
    ndarray of shape (n_omegas,)
        Between 0 and 1.
    """
    n_frames = len(signal)
    center = 0.5 * (n_frames - 1)
    squares = n_frames * (n_frames * n_frames - 1.0) / 12.0  # sum of t^2
    level = rise = 0.0
    for frame in range(n_frames):
        level += signal[frame] / n_frames
        rise += (frame - center) * signal[frame] / squares
    total = 0.0
    for frame in range(n_frames):
        total += (signal[frame] - level - rise * (frame - center)) ** 2
    shares = np.zeros(len(omegas))
    if total <= 0.0:
        return shares
    for position in range(len(omegas)):
        omega = omegas[position]
        step_cosine, step_sine = np.cos(omega), np.sin(omega)
        cosine, sine = np.cos(-omega * center), np.sin(-omega * center)
        along_cosine = along_sine = timed_sine = 0.0
        for frame in range(n_frames):
            flat = signal[frame] - level - rise * (frame - center)
            along_cosine += flat * cosine
            along_sine += flat * sine
            timed_sine += (frame - center) * sine
            cosine, sine = cosine * step_cosine - sine * step_sine, sine * step_cosine + cosine * step_sine
        # What remains of cosine and sine after the constant and the line are taken out of them.
        once = np.sin(0.5 * omega * n_frames) / np.sin(0.5 * omega)  # sum of cos(omega t)
        twice = np.sin(omega * n_frames) / np.sin(omega)
        free_cosine = 0.5 * (n_frames + twice) - once**2 / n_frames
        free_sine = 0.5 * (n_frames - twice) - timed_sine**2 / squares
        shares[position] = (along_cosine**2 / free_cosine + along_sine**2 / free_sine) / total
    return shares
