"""What single strides say about how strides differ: their coefficients, durations and correlation."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from eigenwalker._validation import WalkError
from eigenwalker.motion.fourier import evaluate_harmonics
from eigenwalker.motion.single_strides import phase_zeros, stride_counts, whole_counts
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = [
    "degrees_of_freedom",
    "lag_one_correlation",
    "stride_features",
    "stride_waves",
]

_STRONGEST = 0.9  # correlation from stride to stride beyond which none is believed


def stride_features(
    walk: Walk | JointWalk, n_harmonics: int, phase_reference: str | Mapping[str, float]
) -> NDArray[np.float64]:
    """Return coefficients and duration over its mean of each whole stride, shape (n_strides, n_features)."""
    counts = stride_counts(walk, phase_reference=phase_reference)
    channels = np.asarray(walk.channels, dtype=np.float64)
    whole = whole_counts(counts)
    within = [(counts >= first) & (counts < first + 1) for first in whole[:-1]]
    few = [int(frames.sum()) for frames in within if frames.sum() < 2 * n_harmonics + 1]
    if few:
        raise WalkError(
            f"walk {walk.name!r}: expected at least {2 * n_harmonics + 1} frames a stride for {n_harmonics} harmonics, "
            f"got {few[0]}; use fewer harmonics"
        )
    rows = [
        np.linalg.lstsq(stride_waves(counts[frames], n_harmonics), channels[frames])[0].ravel() for frames in within
    ]
    durations = np.diff(phase_zeros(counts))
    if not rows:
        return np.empty((0, (2 * n_harmonics + 1) * channels.shape[1] + 1))
    return np.column_stack((np.array(rows), durations / durations.mean()))


def stride_waves(counts: NDArray[np.float64], n_harmonics: int) -> NDArray[np.float64]:
    """Return 1, sin, cos, ... at counted strides, shape (n_times, 2 K + 1)."""
    return evaluate_harmonics(np.eye(2 * n_harmonics + 1), 1.0, counts)


def _autocorrelation(n_strides: int, correlation: float) -> NDArray[np.float64]:
    return correlation ** np.abs(np.subtract.outer(range(n_strides), range(n_strides))).astype(np.float64)


def _center(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Take the mean over rows and over columns out of a covariance of strides."""
    rows = matrix - matrix.mean(axis=0)
    return rows - rows.mean(axis=1, keepdims=True)


def degrees_of_freedom(lengths: Sequence[int], correlation: float) -> float:
    """Return the expected sum of squared deviations from the means of walks of some strides, over the variance.

    Without correlation n - 1 a walk; strides that are alike deviate less from their mean.
    """
    return float(sum(np.trace(_center(_autocorrelation(length, correlation))) for length in lengths))


def lag_one_correlation(blocks: Sequence[NDArray[np.float64]]) -> float:
    """Return the correlation under which the ratio of sum d_j d_(j + 1) and sum d_j^2 is expected as it is.

    Deviations from a mean over n strides are correlated by about -1 / n if the strides are not.
    """
    products = sum(float((block[:-1] * block[1:]).sum()) for block in blocks)
    squares = sum(float((block**2).sum()) for block in blocks)
    ratio = products / squares if squares > 0 else 0.0
    limits = (-_STRONGEST, _STRONGEST)
    gap = partial(_lag_gap, ratio=ratio, lengths=[len(block) for block in blocks])
    ends = [gap(limit) for limit in limits]
    if ends[0] >= 0 or ends[1] <= 0:
        return float(limits[0] if ends[0] >= 0 else limits[1])
    return float(brentq(gap, *limits))


def _lag_gap(correlation: float, ratio: float, lengths: Sequence[int]) -> float:
    """Return the expected ratio of `lag_one_correlation` less the one that was found."""
    centered = [_center(_autocorrelation(length, correlation)) for length in lengths]
    expected = sum(np.trace(one, offset=1) for one in centered) / sum(np.trace(one) for one in centered)
    return float(expected) - ratio
