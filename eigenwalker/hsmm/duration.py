"""How long a state lasts: a Gaussian on whole frames, instead of the decay of an ordinary hidden Markov model.

    p(d) = exp(-(d - m)^2 / (2 s^2)) / Z    for d = 1, 2, ... frames within 6 s of m

with Z such that the sum is one (Tilmanne et al. 2012, 5.1.1, where the density is not normalised over frames).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["duration_moments", "duration_support", "fit_durations", "log_durations"]

_REACH = 6.0  # standard deviations: beyond lies 2e-9 of the mass
_MAX_STEPS = 20
_RARE = 1e-12  # of the counts, below which a duration may leave the support; the likelihood falls by no more than that


def duration_support(means: ArrayLike, variances: ArrayLike) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return the shortest and the longest duration of each state, in frames.

    All whole numbers from 1 on within 6 standard deviations of the mean, and those next to the mean in any case.

    Parameters
    ----------
    means, variances : array-like of shape (n_states,)
        In frames and frames squared.

    Returns
    -------
    shortest, longest : ndarray of int of shape (n_states,)

    Raises
    ------
    ValueError
        If a mean is not finite, or a variance is not positive.

    Examples
    --------
    >>> shortest, longest = duration_support([7.5, 2.0], [1.0, 1.0])
    >>> shortest.tolist(), longest.tolist()
    ([2, 1], [13, 8])
    """
    means, variances = np.asarray(means, dtype=np.float64), np.asarray(variances, dtype=np.float64)
    if not (np.isfinite(means).all() and (variances > 0).all() and np.isfinite(variances).all()):
        raise ValueError(
            "durations must have finite means and positive, finite variances, in frames, "
            f"got means {means} and variances {variances}"
        )
    reach = _REACH * np.sqrt(variances)
    shortest = np.minimum(np.ceil(means - reach), np.floor(means))
    longest = np.maximum(np.floor(means + reach), np.ceil(means))
    return np.maximum(shortest, 1).astype(int), np.maximum(longest, 1).astype(int)


def log_durations(means: ArrayLike, variances: ArrayLike) -> NDArray[np.float64]:
    """Return the log-probability of each duration in each state.

    Parameters
    ----------
    means, variances : array-like of shape (n_states,)
        Of the Gaussians, in frames and frames squared. Near whole frames, or near 1, those of the durations differ.

    Returns
    -------
    ndarray of shape (n_states, n_durations)
        Column d - 1 is a duration of d frames; minus infinity outside the support; each row sums to one in exp.

    Raises
    ------
    ValueError
        If a mean is not finite, or a variance is not positive.

    Examples
    --------
    >>> import numpy as np
    >>> np.exp(log_durations([2.0], [0.25])).round(3)
    array([[0.106, 0.787, 0.106, 0.   , 0.   ]])
    """
    shortest, longest = duration_support(means, variances)
    durations = np.arange(1, longest.max() + 1)
    distances = (durations - np.asarray(means, dtype=np.float64)[:, np.newaxis]) ** 2
    logs = -0.5 * distances / np.asarray(variances, dtype=np.float64)[:, np.newaxis]
    outside = (durations < shortest[:, np.newaxis]) | (durations > longest[:, np.newaxis])
    logs[outside] = -np.inf
    logs -= logs.max(axis=1, keepdims=True)
    return logs - np.log(np.exp(logs).sum(axis=1, keepdims=True))


def duration_moments(means: ArrayLike, variances: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mean and variance of the durations of each state, which are whole and at least one frame.

    Parameters
    ----------
    means, variances : array-like of shape (n_states,)
        Of the Gaussians, see `log_durations`.

    Returns
    -------
    means, variances : ndarray of shape (n_states,)
        In frames and frames squared. They are those of the Gaussians unless these reach down to one frame.

    Examples
    --------
    >>> means, variances = duration_moments([1.0, 9.0], [9.0, 1.0])
    >>> means.round(2), variances.round(2)
    (array([3.09, 9.  ]), array([3.56, 1.  ]))
    """
    return _moments(np.exp(log_durations(means, variances)))


def fit_durations(
    counts: NDArray[np.floating], means: ArrayLike, variances: ArrayLike, *, floor: float = 0.0
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    r"""Return the Gaussians that make expected counts of durations most likely.

    The maximum of :math:`Q = \sum_d n(d) \log p(d)` has the mean and variance of the counts as those of the durations,
    which are nearly, because durations are whole, those of the Gaussian. So the Gaussian starts there, and is moved by
    what its durations still miss and widened where its support would lose a duration. The best of all on the way is
    returned, the parameters so far among them: Q never falls. A state without counts keeps what it has.

    Parameters
    ----------
    counts : ndarray of shape (n_states, n_durations)
        Column d - 1 is how often a state is expected to last d frames.
    means, variances : array-like of shape (n_states,)
        The parameters so far.
    floor : float, default 0.0
        Least variance in frames squared, kept even if Q falls. Without one it is 1e-4 frames squared, at which a state
        always lasts equally long.

    Returns
    -------
    means, variances : ndarray of shape (n_states,)

    Examples
    --------
    >>> import numpy as np
    >>> means, variances = fit_durations(np.array([[0.0, 1.0, 2.0, 1.0]]), [2.0], [1.0])
    >>> means.round(3), variances.round(3)
    (array([3.]), array([0.502]))
    """
    counts = np.asarray(counts, dtype=np.float64)
    counts = np.where(counts > _RARE * counts.sum(axis=1, keepdims=True), counts, 0.0)
    best_means, best_variances = np.array(means, dtype=np.float64), np.array(variances, dtype=np.float64)
    best_variances = np.maximum(best_variances, floor)
    seen = counts.sum(axis=1) > 0
    if not seen.any():
        return best_means, best_variances
    best_means[seen], best_variances[seen] = _climb(counts[seen], best_means[seen], best_variances[seen], floor)
    return best_means, best_variances


def _climb(
    counts: NDArray[np.float64], best_means: NDArray[np.float64], best_variances: NDArray[np.float64], floor: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    best = _expected_log(counts, best_means, best_variances)
    wanted_means, wanted_variances = _moments(counts / counts.sum(axis=1, keepdims=True))
    means, variances = wanted_means, np.maximum(wanted_variances, max(floor, 1e-4))
    for _ in range(_MAX_STEPS):
        variances = np.maximum(variances, _covering(counts, means))
        value = _expected_log(counts, means, variances)
        better = value > best
        best = np.where(better, value, best)
        best_means, best_variances = np.where(better, means, best_means), np.where(better, variances, best_variances)
        got_means, got_variances = _moments(np.exp(log_durations(means, variances)))
        means = np.maximum(means + wanted_means - got_means, 1.0)
        variances = np.maximum(variances + wanted_variances - got_variances, np.maximum(0.5 * variances, floor))
    return best_means, best_variances


def _covering(counts: NDArray[np.float64], means: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the variances whose support just holds all durations that were counted."""
    durations = np.arange(1, counts.shape[1] + 1)
    farthest = np.where(counts > 0, np.abs(durations - means[:, np.newaxis]), 0.0).max(axis=1)
    return (farthest * (1 + 1e-9) / _REACH) ** 2


def _moments(shares: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mean and variance of distributions of durations, one a row."""
    durations = np.arange(1, shares.shape[1] + 1)
    means = shares @ durations
    return means, (shares * (durations - means[:, np.newaxis]) ** 2).sum(axis=1)


def _expected_log(
    counts: NDArray[np.float64], means: NDArray[np.float64], variances: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return Q of each state; minus infinity if a duration that was counted is outside the support."""
    logs = log_durations(means, variances)
    width = max(counts.shape[1], logs.shape[1])
    logs = np.pad(logs, ((0, 0), (0, width - logs.shape[1])), constant_values=-np.inf)
    counts = np.pad(counts, ((0, 0), (0, width - counts.shape[1])))
    return np.where(counts > 0, counts * np.where(counts > 0, logs, 0.0), 0.0).sum(axis=1)
