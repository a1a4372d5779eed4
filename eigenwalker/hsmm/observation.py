"""How likely each state makes each frame: Gaussians with diagonal covariance.

    log b_j(o_t) = -1/2 sum_i [log(2 pi sigma_ji^2) + (o_ti - mu_ji)^2 / sigma_ji^2]

The sum is over the values of a frame that were observed: NaN leaves a term out, which is the exact marginal density.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["accumulate_over_time", "log_densities"]


def log_densities(
    observations: NDArray[np.floating], means: NDArray[np.floating], variances: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return the log-density of every frame in every state.

    Parameters
    ----------
    observations : ndarray of shape (n_frames, n_features)
        A walk with its dynamics. NaN is what was not observed.
    means, variances : ndarray of shape (n_states, n_features)
        Of each state. Variances must be positive.

    Returns
    -------
    ndarray of shape (n_states, n_frames)
        Natural logarithms. Time is last, as that is how the sums over it run.

    Raises
    ------
    ValueError
        If shapes do not fit, or a variance is not positive.

    Examples
    --------
    >>> import numpy as np
    >>> log_densities(np.array([[0.0], [1.0]]), np.array([[0.0]]), np.array([[1.0]])).round(3)
    array([[-0.919, -1.419]])
    """
    observations, means, variances = (
        np.ascontiguousarray(array, dtype=np.float64) for array in (observations, means, variances)
    )
    n_features = observations.shape[-1]
    if observations.ndim != 2 or means.ndim != 2 or means.shape != variances.shape or means.shape[1] != n_features:
        raise ValueError(
            "expected observations of shape (n_frames, n_features), means and variances of shape "
            f"(n_states, n_features), got {observations.shape}, {means.shape} and {variances.shape}"
        )
    if not (variances > 0).all():
        state, feature = np.argwhere(~(variances > 0))[0]
        raise ValueError(
            f"variances must be positive, got {variances[state, feature]} for feature {feature} of state {state}; "
            "estimate them with a floor"
        )
    whole = np.isfinite(observations.sum(axis=1))
    result = _fill(observations, whole, means, 1.0 / variances)
    result -= 0.5 * (n_features * np.log(2 * np.pi) + np.log(variances).sum(axis=1))[:, np.newaxis]
    if not whole.all():
        result[:, ~whole] = _log_marginals(observations[~whole], means, variances)
    return result


def _log_marginals(
    observations: NDArray[np.float64], means: NDArray[np.float64], variances: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the same for frames of which some values were not observed."""
    terms = np.log(2 * np.pi * variances) + (observations[:, np.newaxis] - means) ** 2 / variances
    return -0.5 * np.nansum(terms, axis=2).T  # (n_states, n_frames)


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _fill(observations, whole, means, precisions):
    """Return the quadratic parts, four frames at a time, so that a state is fetched once for all of them.

    Squares of differences, rather than products of matrices, because those cancel where means are far from zero.
    """
    n_frames, n_features = observations.shape
    n_states = len(means)
    result = np.empty((n_states, n_frames))
    for start in range(0, n_frames, 4):
        # The last frames are done together with as many copies of the very last as are missing.
        a, b, c, d = (
            start,
            min(start + 1, n_frames - 1),
            min(start + 2, n_frames - 1),
            min(start + 3, n_frames - 1),
        )
        if not (whole[a] or whole[b] or whole[c] or whole[d]):
            continue
        for state in range(n_states):
            sum_a = sum_b = sum_c = sum_d = 0.0
            for i in range(n_features):
                mean, precision = means[state, i], precisions[state, i]
                sum_a += (observations[a, i] - mean) ** 2 * precision
                sum_b += (observations[b, i] - mean) ** 2 * precision
                sum_c += (observations[c, i] - mean) ** 2 * precision
                sum_d += (observations[d, i] - mean) ** 2 * precision
            result[state, a] = -0.5 * sum_a
            result[state, b] = -0.5 * sum_b
            result[state, c] = -0.5 * sum_c
            result[state, d] = -0.5 * sum_d
    return result


def accumulate_over_time(values: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return running sums over the frames before each boundary between frames.

    The log-density of frames s, ..., e - 1 in a state is the difference of its sums at e and s.

    Parameters
    ----------
    values : ndarray of shape (n_states, n_frames)
        Log-densities.

    Returns
    -------
    ndarray of shape (n_states, n_frames + 1)
        Zero in the first column.

    Examples
    --------
    >>> import numpy as np
    >>> accumulate_over_time(np.array([[1.0, 2.0, 3.0]]))
    array([[0., 1., 3., 6.]])
    """
    sums = np.zeros((values.shape[0], values.shape[1] + 1))
    np.cumsum(values, axis=1, out=sums[:, 1:])
    return sums
