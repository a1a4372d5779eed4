"""Compiled loops of the Fourier model. Time is in frames, counted from the middle of the walk.

There the sums of sines times cosines vanish, so that all products of the basis functions

    1, sin(omega t), cos(omega t), sin(2 omega t), cos(2 omega t), ...

follow from closed sums over time, and the data are read once, by one matrix product.
"""

import numpy as np
from numba import njit

__all__ = ["block_means", "fit_series", "line_and_wave_shares", "refine", "residual_power"]

# Multiplications in a matrix product, up to which OpenBLAS keeps to one thread: waking a second one takes longer.
_ONE_THREAD = 262_144
_CACHED = 131_072  # numbers of which the cache holds a copy


@njit(cache=True, nogil=True)
def _read_ahead(channels):
    """Bring a walk into the cache, and return zero.

    One number of each cache line is read, in four places side by side, which keeps the memory busier than loops that
    also compute. Longer walks than the cache holds are left alone.
    """
    if channels.size > _CACHED:
        return 0.0
    flat = channels.reshape(channels.size)
    quarter = channels.size // 4
    first = second = third = fourth = 0.0
    for position in range(0, quarter, 8):
        first += flat[position]
        second += flat[position + quarter]
        third += flat[position + 2 * quarter]
        fourth += flat[position + 3 * quarter]
    return 0.0 * (first + second + third + fourth)  # used, or the compiler would drop the reading


@njit(cache=True, nogil=True)
def _fill_basis(basis, time, omega, n_harmonics):
    """Write the basis functions of the frames from `time` on into rows of `basis`, shape (n_functions, n_frames).

    If it has more than 2 K + 1 rows, time times the waves follows. Each round of the first loop doubles the frames
    whose sine and cosine are known, by turning them on.
    """
    n_functions, n_frames = basis.shape
    basis[0, 0], basis[1, 0], basis[2, 0] = 1.0, np.sin(omega * time), np.cos(omega * time)
    known = 1
    while known < n_frames:
        sine, cosine = np.sin(omega * known), np.cos(omega * known)
        for frame in range(known, min(2 * known, n_frames)):
            basis[0, frame] = 1.0
            basis[1, frame] = basis[1, frame - known] * cosine + basis[2, frame - known] * sine
            basis[2, frame] = basis[2, frame - known] * cosine - basis[1, frame - known] * sine
        known *= 2
    for k in range(3, 2 * n_harmonics + 1, 2):
        for frame in range(n_frames):
            basis[k, frame] = basis[k - 2, frame] * basis[2, frame] + basis[k - 1, frame] * basis[1, frame]
            basis[k + 1, frame] = basis[k - 1, frame] * basis[2, frame] - basis[k - 2, frame] * basis[1, frame]
    for row in range(2 * n_harmonics + 1, n_functions):
        for frame in range(n_frames):
            basis[row, frame] = (time + frame) * basis[row - 2 * n_harmonics, frame]


@njit(cache=True, nogil=True)
def _correlate(channels, omega, n_harmonics, n_functions):
    """Return the sums over time of each basis function times each channel, shape (n_functions, n_channels).

    With 4 K + 1 functions instead of 2 K + 1, also those of time times the waves.
    """
    n_frames, n_channels = channels.shape
    n_rows = max(16, _ONE_THREAD // (n_functions * n_channels))
    sums = np.zeros((n_functions, n_channels))
    for first in range(0, n_frames, n_rows):
        last = min(first + n_rows, n_frames)
        basis = np.empty((n_functions, last - first))
        _fill_basis(basis, first - 0.5 * (n_frames - 1), omega, n_harmonics)
        # Quicker than its transpose: (n_channels, n_rows) @ (n_rows, n_functions)
        part = np.dot(channels[first:last].T, basis.T)
        for row in range(n_functions):
            for channel in range(n_channels):
                sums[row, channel] += part[channel, row]
    return sums


@njit(cache=True, nogil=True)
def _time_sums(n_frames, omega, highest):
    """Return sum cos(m omega t), sum t sin(m omega t) and sum t^2 cos(m omega t) for m = 0 .. highest.

    With x = m omega and N frames the first is D(x) = sin(N x / 2) / sin(x / 2); the others are -D' and -D''.
    """
    sums = np.zeros((3, highest + 1))
    sums[0, 0] = n_frames
    sums[2, 0] = n_frames * (n_frames * n_frames - 1.0) / 12.0
    for m in range(1, highest + 1):
        half = 0.5 * m * omega
        sine, cosine = np.sin(half), np.cos(half)
        level = np.sin(n_frames * half) / sine
        slope = 0.5 * (n_frames * np.cos(n_frames * half) - level * cosine) / sine
        sums[0, m] = level
        sums[1, m] = -slope
        sums[2, m] = 0.25 * (n_frames * n_frames - 1.0) * level + slope * cosine / sine
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
            if factor != 0.0:  # half of the products of sines and cosines are zero
                for k in range(j + 1, n_rows):
                    lower[i, k] -= factor * lower[j, k]
                for channel in range(right.shape[1]):
                    result[i, channel] -= factor * result[j, channel]
    for j in range(n_rows - 1, -1, -1):
        for k in range(j + 1, n_rows):
            if lower[j, k] != 0.0:
                for channel in range(right.shape[1]):
                    result[j, channel] -= lower[j, k] * result[k, channel]
        for channel in range(right.shape[1]):
            result[j, channel] /= lower[j, j]
    return result


@njit(cache=True, nogil=True)
def fit_series(channels, omega, n_harmonics):
    """Return least-squares coefficients, shape (2 K + 1, n_channels), with time zero in the first frame.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        float64, contiguous.
    omega : float
        Fundamental frequency in radians per frame.
    n_harmonics : int
        Number K of harmonics.
    """
    n_frames, n_channels = channels.shape
    gram = _even_products(_time_sums(n_frames, omega, 2 * n_harmonics)[0], n_harmonics)
    zero = _read_ahead(channels)
    products = _correlate(channels, omega, n_harmonics, len(gram))
    products[0, 0] += zero
    coefficients = _solve_positive(gram, products)
    for k in range(1, n_harmonics + 1):
        angle = 0.5 * k * omega * (n_frames - 1)
        cosine, sine = np.cos(angle), np.sin(angle)
        for channel in range(n_channels):
            along_sine, along_cosine = coefficients[2 * k - 1, channel], coefficients[2 * k, channel]
            coefficients[2 * k - 1, channel] = along_sine * cosine + along_cosine * sine
            coefficients[2 * k, channel] = along_cosine * cosine - along_sine * sine
    return coefficients


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def residual_power(channels, coefficients, omega):
    """Return the sum of squares that coefficients leave, and that about each channel's mean.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        float64, contiguous.
    coefficients : ndarray of shape (2 K + 1, n_channels)
        float64, contiguous, with time zero in the first frame.
    omega : float
        Fundamental frequency in radians per frame.
    """
    n_frames, n_channels = channels.shape
    means = np.zeros(n_channels)
    for frame in range(n_frames):
        for channel in range(n_channels):
            means[channel] += channels[frame, channel]
    means /= n_frames
    fitted = np.empty(n_channels)
    left = total = 0.0
    for frame in range(n_frames):
        fitted[:] = coefficients[0]
        for k in range(1, len(coefficients) // 2 + 1):
            sine, cosine = np.sin(k * omega * frame), np.cos(k * omega * frame)
            for channel in range(n_channels):
                fitted[channel] += sine * coefficients[2 * k - 1, channel] + cosine * coefficients[2 * k, channel]
        for channel in range(n_channels):
            residual, about = channels[frame, channel] - fitted[channel], channels[frame, channel] - means[channel]
            left += residual * residual
            total += about * about
    return left, total


@njit(cache=True, nogil=True)
def _multiply(small, matrix):
    """Return the matrix product of a small square matrix, half of which is zero, and another."""
    product = np.zeros_like(matrix)
    for row in range(len(small)):
        for k in range(len(small)):
            if small[row, k] != 0.0:
                for channel in range(matrix.shape[1]):
                    product[row, channel] += small[row, k] * matrix[k, channel]
    return product


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _inner(first, second):
    """Return the sum of products of two matrices."""
    total = 0.0
    for row in range(first.shape[0]):
        for column in range(first.shape[1]):
            total += first[row, column] * second[row, column]
    return total


@njit(cache=True, nogil=True)
def _project(channels, omega, n_harmonics):
    """Return explained sum of squares, its half derivative by omega, and Gauss-Newton's curvature.

    With basis F, coefficients b = (F'F)^-1 F'Y, residual r = Y - F b and derivative (t F) g of F b by omega
    (g_sin_k = -k c_k, g_cos_k = k s_k): the slope is <(t F) g, r>, the curvature ||(I - P) (t F) g||^2.
    """
    n_rows = 2 * n_harmonics + 1
    products = _correlate(channels, omega, n_harmonics, 2 * n_rows - 1)
    plain, timed = products[:n_rows], products[n_rows:]
    sums = _time_sums(len(channels), omega, 2 * n_harmonics)
    gram = _even_products(sums[0], n_harmonics)
    coefficients = _solve_positive(gram, plain)
    change = np.zeros_like(coefficients)
    for k in range(1, n_harmonics + 1):
        for channel in range(coefficients.shape[1]):
            change[2 * k - 1, channel] = -k * coefficients[2 * k, channel]
            change[2 * k, channel] = k * coefficients[2 * k - 1, channel]
    overlap = _multiply(_odd_products(sums[1], n_harmonics), change)
    spread = _multiply(_even_products(sums[2], n_harmonics), change)
    slope = _inner(change[1:], timed) - _inner(overlap, coefficients)
    curvature = _inner(change, spread) - _inner(overlap, _solve_positive(gram, overlap))
    return _inner(plain, coefficients), slope, curvature


@njit(cache=True, nogil=True)
def block_means(channels, block):
    """Return the means of blocks of frames: a walk of the same frequencies at a lower frame rate.

    Frames that fill no block are left out.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        float64, contiguous.
    block : int
        Number of frames in a block.

    Returns
    -------
    ndarray of shape (n_frames // block, n_channels)
    """
    n_blocks, n_channels = len(channels) // block, channels.shape[1]
    means = np.zeros((n_blocks, n_channels))
    if n_blocks > 0:
        means[0, 0] = _read_ahead(channels)
    for position in range(n_blocks):
        for frame in range(position * block, (position + 1) * block):
            for channel in range(n_channels):
                means[position, channel] += channels[frame, channel]
        for channel in range(n_channels):
            means[position, channel] /= block
    return means


@njit(cache=True, nogil=True)
def refine(channels, omega, n_harmonics, ratio, precision, max_iter):
    """Return the frequency next to `omega` that explains most, and the ratio of true to Gauss-Newton's curvature.

    Gauss-Newton steps, divided by that ratio once two slopes have shown it, halved while they lose power. Ends with
    the step whose error, judged by how well the ratio is known, is below `precision` standard errors of the
    frequency, or below rounding.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        float64, contiguous.
    omega : float
        Start, in radians per frame.
    n_harmonics : int
        Number K of harmonics.
    ratio : float
        From the same walk at another frame rate; 1 if unknown.
    precision : float
        In standard errors, which come from the power that the harmonics leave.
    max_iter : int
        Largest number of projections.
    """
    n_frames, n_channels = channels.shape
    longest = 0.5 / n_frames  # radians a frame: a twelfth of a cycle over the whole walk
    flat = channels.reshape(1, n_frames * n_channels)
    total = _inner(flat, flat)
    doubt = abs(ratio - 1.0) if ratio != 1.0 else 1.0
    best, step, smallest = omega, 0.0, 0.0
    power = slope = 0.0
    for _ in range(max_iter):
        trial_power, trial_slope, curvature = _project(channels, best + step, n_harmonics)
        if trial_power < power * (1.0 - 1e-14) and abs(step) > smallest:
            step *= 0.5
            continue
        if 0.0 < abs(step) <= smallest:
            break
        if step != 0.0:
            seen = (slope - trial_slope) / (step * curvature)
            seen = seen if 0.3 < seen < 3.0 else 1.0
            doubt, ratio = abs(seen - ratio), seen
        best += step
        power, slope = trial_power, trial_slope
        if curvature <= 0.0:
            break
        step = min(max(slope / (ratio * curvature), -longest), longest)
        noise = max(total * (1.0 - 1e-13) - power, 0.0) / (n_frames * n_channels)  # less what rounding may leave
        smallest = max(precision * np.sqrt(noise / curvature), 4e-16 * best)
        if abs(step) * (doubt + abs(step) / longest) <= smallest:
            best += step
            break
    return best, ratio


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
    cosine, sine = np.cos(-center * omegas), np.sin(-center * omegas)
    step_cosine, step_sine = np.cos(omegas), np.sin(omegas)
    along_cosine, along_sine = np.zeros_like(omegas), np.zeros_like(omegas)
    total = 0.0
    for frame in range(n_frames):
        flat = signal[frame] - level - rise * (frame - center)
        total += flat * flat
        for position in range(len(omegas)):  # innermost, so that all recurrences go on side by side
            old_cosine, old_sine = cosine[position], sine[position]
            along_cosine[position] += flat * old_cosine
            along_sine[position] += flat * old_sine
            cosine[position] = old_cosine * step_cosine[position] - old_sine * step_sine[position]
            sine[position] = old_sine * step_cosine[position] + old_cosine * step_sine[position]
    shares = np.zeros_like(omegas)
    if total <= 0.0:
        return shares
    for position in range(len(omegas)):
        # What remains of cosine and sine after the constant and the line are taken out of them.
        sums = _time_sums(n_frames, omegas[position], 2)
        free_cosine = 0.5 * (n_frames + sums[0, 2]) - sums[0, 1] ** 2 / n_frames
        free_sine = 0.5 * (n_frames - sums[0, 2]) - sums[1, 1] ** 2 / squares
        shares[position] = (along_cosine[position] ** 2 / free_cosine + along_sine[position] ** 2 / free_sine) / total
    return shares
