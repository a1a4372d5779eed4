"""Synthetic walks whose strides differ from each other, with known phase zeros."""

import numpy as np

from eigenwalker.motion import Walk

__all__ = ["make_varying_walk"]


def make_varying_walk(
    rng,
    coefficients,
    *,
    frequency=0.93,
    n_strides=10,
    time_sd=0.02,
    shape_sd=0.04,
    noise=0.001,
    frame_rate=60.0,
    drift=0.0,
    **fields,
):
    """Return a walk of independent strides, with a bit of one more at both ends, and its phase zeros in frames.

    Coefficients have the shape (2 K + 1, 45). Those of each stride differ by `shape_sd` of their amplitude, and mean
    posture by a tenth of that in metres; stride times differ by `time_sd` of their mean, and drift by `drift` to both
    sides of it.
    """
    numbers = n_strides + 2
    amplitudes = np.hypot(coefficients[1::2], coefficients[2::2])
    scales = np.vstack((np.full((1, coefficients.shape[1]), 0.1), np.repeat(amplitudes, 2, axis=0)))
    own = coefficients + shape_sd * scales * rng.normal(size=(numbers, *coefficients.shape))
    durations = 1 + time_sd * rng.normal(size=numbers) + drift * np.linspace(-1, 1, numbers)
    zeros = np.concatenate(([0.0], np.cumsum(durations / frequency)))
    first, last = zeros[1] - rng.uniform(0.05, 0.3), zeros[-2] + rng.uniform(0.05, 0.3)
    times = np.arange(first, last, 1 / frame_rate)
    counts = np.interp(times, zeros, np.arange(numbers + 1))
    angles = 2 * np.pi * np.outer(counts, np.arange(1, len(amplitudes) + 1))
    waves = np.stack((np.sin(angles), np.cos(angles)), axis=2).reshape(len(times), -1)
    basis = np.column_stack((np.ones(len(times)), waves))
    channels = np.einsum("tk,tkc->tc", basis, own[counts.astype(int)])
    channels = channels + noise * rng.normal(size=channels.shape)
    return Walk(channels.reshape(len(times), -1, 3), frame_rate, **fields), (zeros[1:-1] - first) * frame_rate
