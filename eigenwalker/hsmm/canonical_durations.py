"""How long the states that walkers share last, given what each walker makes of durations (d_z = a d + e)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.duration_transform import DurationTransform, expected_log_durations, transformed_durations
from eigenwalker.hsmm.estimation import StateParameters

__all__ = ["fit_canonical_durations"]

_REACH = 6.0  # standard deviations, see `duration_support`
_MAX_STEPS = 20
_RARE = 1e-7  # of the counts of a state, see `expected_log_durations`


def fit_canonical_durations(
    counts: Sequence[NDArray[np.floating]],
    transforms: Sequence[DurationTransform],
    parameters: StateParameters,
    *,
    duration_classes: NDArray[np.integer],
    floor: float = 0.0,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return Gaussians of durations that make those of all walkers, each transformed, most likely.

    Where the likelihood is largest, mean and variance of the transformed durations are those that the Gaussians have on
    whole frames, over all walkers. The Gaussians start there, and are moved by what is still missed; the best on the
    way is returned, those so far among them. For walkers who are equal this is `fit_durations`.

    Parameters
    ----------
    counts : sequence of ndarray of shape (n_duration_states, n_durations)
        How often each state is expected to last d frames, of each walker.
    transforms : sequence of DurationTransform
        Of each walker.
    parameters : StateParameters
        Those so far, which a state without counts keeps.
    duration_classes : ndarray of int of shape (n_duration_states,)
        Class of each state.
    floor : float, default 0.0
        Least variance, in frames squared of the model, kept even if the likelihood falls.

    Returns
    -------
    means, variances : ndarray of shape (n_duration_states,)

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.hsmm.duration_transform import identity_durations
    >>> states = StateParameters(np.zeros((1, 1)), np.ones((1, 1)), np.array([9.0]), np.array([4.0]))
    >>> double = DurationTransform(np.array([2.0]), np.array([0.0]))
    >>> counts = [np.array([[0.0, 0, 0, 1, 0, 1]]), np.array([[0.0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1]])]  # 8, 12, 9, 11
    >>> means, variances = fit_canonical_durations(
    ...     counts, [double, identity_durations()], states, duration_classes=np.array([0])
    ... )
    >>> means.round(3), variances.round(3)
    (array([10.]), array([2.5]))
    """
    counts = [np.where(part > _RARE * part.sum(axis=1, keepdims=True), part, 0.0) for part in counts]
    totals = [part.sum(axis=1, keepdims=True) for part in counts]
    seen = np.sum(totals, axis=0)[:, 0] > 0

    def pairs(means: NDArray, variances: NDArray) -> list[tuple[NDArray, NDArray]]:
        """Return what the Gaussians are in the frames of each walker."""
        return [transformed_durations(own, means, variances, duration_classes=duration_classes) for own in transforms]

    def value(means: NDArray, variances: NDArray) -> NDArray:
        every = zip(counts, pairs(means, variances), strict=True)
        return np.sum([expected_log_durations(part, *pair) for part, pair in every], axis=0)

    best_means, best_variances = parameters.duration_means, np.maximum(parameters.duration_variances, floor)
    best = value(best_means, best_variances)
    wanted_means, wanted_variances = _moments(counts, transforms, duration_classes)
    means = np.where(seen, wanted_means, best_means)
    variances = np.where(seen, np.maximum(wanted_variances, max(floor, 1e-4)), best_variances)
    for _ in range(_MAX_STEPS):
        variances = np.maximum(variances, _covering(counts, transforms, duration_classes, means))
        reached = value(means, variances)
        better = reached > best
        best = np.where(better, reached, best)
        best_means, best_variances = np.where(better, means, best_means), np.where(better, variances, best_variances)
        expected = [
            total * np.exp(log_durations(*pair)) for total, pair in zip(totals, pairs(means, variances), strict=True)
        ]
        got_means, got_variances = _moments(expected, transforms, duration_classes)
        means = np.where(seen, means + wanted_means - got_means, means)
        moved = np.maximum(variances + wanted_variances - got_variances, np.maximum(0.5 * variances, floor))
        variances = np.where(seen, moved, variances)
    return best_means, best_variances


def _moments(
    parts: Sequence[NDArray], transforms: Sequence[DurationTransform], classes: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mean and variance of transformed durations of all walkers, each duration with its weight."""
    weights, values = _joined(parts, transforms, classes)
    shares = weights / np.maximum(weights.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    means = (shares * values).sum(axis=1)
    return means, (shares * (values - means[:, np.newaxis]) ** 2).sum(axis=1)


def _covering(
    counts: Sequence[NDArray], transforms: Sequence[DurationTransform], classes: NDArray, means: NDArray
) -> NDArray[np.float64]:
    """Return the variances whose support just holds all durations that were counted."""
    weights, values = _joined(counts, transforms, classes)
    farthest = np.where(weights > 0, np.abs(values - means[:, np.newaxis]), 0.0).max(axis=1)
    return (farthest * (1 + 1e-9) / _REACH) ** 2


def _joined(
    parts: Sequence[NDArray], transforms: Sequence[DurationTransform], classes: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return weights and transformed durations of all walkers side by side: (n_duration_states, n_columns)."""
    values = [
        np.multiply.outer(own.factors[classes], np.arange(1.0, part.shape[1] + 1)) + own.shifts[classes, np.newaxis]
        for own, part in zip(transforms, parts, strict=True)
    ]
    return np.concatenate(parts, axis=1), np.concatenate(values, axis=1)
