"""Heel strikes from marker paths, without the Fourier model, to judge its frequencies by."""

import numpy as np
from scipy.signal import butter, filtfilt, find_peaks

__all__ = ["heel_strikes", "stride_frequency_from_strikes"]


def heel_strikes(walk, side):
    """Return the times of heel strikes of one foot, in seconds.

    Zeni, Richards & Higginson (2008): the heel strikes when the foot is furthest in front of the pelvis. 5 Hz
    zero-phase low-pass, peaks with a prominence of 0.35 of the range, refined by a parabola.
    """
    ahead = walk.marker(f"{side}_ankle")[:, 0] - walk.marker("pelvis")[:, 0]
    smooth = filtfilt(*butter(2, 5, fs=walk.frame_rate), ahead)
    peaks, _ = find_peaks(smooth, prominence=0.35 * np.ptp(smooth))
    before, top, after = smooth[peaks - 1], smooth[peaks], smooth[peaks + 1]
    return (peaks + 0.5 * (before - after) / (before - 2 * top + after)) / walk.frame_rate


def stride_frequency_from_strikes(walk):
    """Return strides per second, counted between first and last strike of the same foot, both feet averaged."""
    durations, counts = [], []
    for side in ("left", "right"):
        times = heel_strikes(walk, side)
        if len(times) > 1:
            durations.append(times[-1] - times[0])
            counts.append(len(times) - 1)
    return sum(counts) / sum(durations)
