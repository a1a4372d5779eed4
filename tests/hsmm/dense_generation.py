"""Parameter generation with dense matrices, in the plainest way; and random models of a walk."""

import numpy as np

from eigenwalker.hsmm.features import WINDOWS

__all__ = ["dense_equations", "dense_windows", "random_states"]


def dense_windows(n_frames, windows=WINDOWS):
    """Return W, shape (n_windows, n_frames, n_frames), with no row for windows that reach over the edge."""
    matrices = np.zeros((len(windows), n_frames, n_frames))
    for matrix, window in zip(matrices, windows, strict=True):
        reach = len(window) // 2
        for frame in range(reach, n_frames - reach):
            matrix[frame, frame - reach : frame + reach + 1] = window
    return matrices


def dense_equations(means, variances, windows=WINDOWS):
    """Return W'PW, shape (n_channels, n_frames, n_frames), and W'P mu, shape (n_channels, n_frames)."""
    n_frames = len(means)
    rows = dense_windows(n_frames, windows).reshape(-1, n_frames)  # (n_windows * n_frames, n_frames)
    by_channel = (2, 1, 0)  # from (n_frames, n_windows, n_channels)
    means, precisions = (
        values.reshape(n_frames, len(windows), -1).transpose(by_channel).reshape(-1, len(rows))
        for values in (means, 1 / variances)
    )
    matrices = np.array([rows.T * precision @ rows for precision in precisions])
    return matrices, (precisions * means) @ rows


def random_states(rng, n_states, n_frames_a_state, n_channels, n_windows=3):
    """Return means and variances of frames, shape (n_frames, n_windows * n_channels), constant within states."""
    shape = (n_states, n_windows * n_channels)
    scales = np.repeat([1.0, 0.2, 0.05][:n_windows], n_channels)
    means, variances = rng.normal(size=shape) * scales, (rng.uniform(0.3, 0.8, shape) * scales) ** 2
    return np.repeat(means, n_frames_a_state, axis=0), np.repeat(variances, n_frames_a_state, axis=0)
