"""Maximum a posteriori (MAP) estimation of states: those with many frames follow them, those with few stay.

The prior is worth `weight` frames of each state, drawn from the state as it was. With n, x and x2 the count, sum and
sum of squares of a feature of a state, and mu_0, sigma_0^2 its mean and variance before,

    mu      = (weight mu_0 + x) / (weight + n)
    sigma^2 = (weight (sigma_0^2 + (mu_0 - mu)^2) + x2 - 2 mu x + n mu^2) / (weight + n)

the maximum of the expected log-density of the frames and, as if there were `weight` more, of frames from the prior.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm.accumulation import Statistics
from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.estimation import StateParameters, maximize_likelihood

__all__ = ["map_states"]


def map_states(
    statistics: Statistics,
    parameters: StateParameters,
    *,
    weight: ArrayLike,
    duration_weight: float | None = None,
    floors: ArrayLike = 0.0,
    duration_floor: float = 0.0,
) -> StateParameters:
    """Return the parameters of largest posterior density, with the parameters so far as prior.

    Parameters
    ----------
    statistics : Statistics
        Expected sums of the walks to adapt to, counted feature by feature. After a transform of channels: those of the
        transformed walks.
    parameters : StateParameters
        The prior.
    weight : array-like, broadcast to (n_states, n_features)
        Frames that the prior is worth. 0 is `maximize_likelihood`, infinity the prior untouched. 10 to 20 is usual.
    duration_weight : float, default None
        Durations that the prior is worth; they are drawn from the prior's on whole frames. None is `weight`, which
        must be a number then.
    floors, duration_floor : array-like of shape (n_features,), default 0.0, and float, default 0.0
        As of `maximize_likelihood`.

    Returns
    -------
    StateParameters

    Raises
    ------
    ValueError
        If a weight is negative, or as `maximize_likelihood`.

    References
    ----------
    Gauvain & Lee 1994, Eq. 25 and 26 for one Gaussian, with tau = weight, alpha - p = weight and u = weight sigma_0^2;
    Tilmanne, Moinet & Dutoit 2012, 5.1.3, where it follows the linear transforms.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.hsmm.accumulation import ObservedWalk, accumulate_walk
    >>> from eigenwalker.hsmm.inference import certain_posterior
    >>> walk = ObservedWalk("a", np.array([[3.0], [5.0]]), np.array([0]), np.array([0]))
    >>> statistics = accumulate_walk(walk, certain_posterior([0, 2]), n_states=1, n_duration_states=1)
    >>> prior = StateParameters(np.array([[0.0]]), np.array([[1.0]]), np.array([5.0]), np.array([1.0]))
    >>> adapted = map_states(statistics, prior, weight=2.0)
    >>> adapted.means, adapted.variances  # of -1, 1 (mean and variance of the prior), 3 and 5
    (array([[2.]]), array([[5.]]))
    """
    weights = np.broadcast_to(np.asarray(weight, dtype=np.float64), parameters.means.shape)
    if duration_weight is None:
        if np.ndim(weight):
            raise ValueError(f"duration_weight must be given where weight is an array, of shape {np.shape(weight)}")
        duration_weight = float(weights.flat[0])
    if not ((weights >= 0).all() and duration_weight >= 0):
        raise ValueError(f"weights must not be negative, got {weights.min()} and, of durations, {duration_weight}")
    fixed, means = np.isinf(weights), parameters.means
    frames = np.where(fixed, 0.0, weights)
    # About the prior's means, where squares of a state that has moved little do not cancel.
    squares = statistics.squares - 2 * means * statistics.sums + statistics.counts * means**2
    joined = statistics._replace(
        counts=np.where(fixed, 0.0, statistics.counts + frames),
        sums=statistics.sums - statistics.counts * means,
        squares=np.maximum(squares, 0.0) + frames * parameters.variances,
        duration_counts=_add_durations(statistics.duration_counts, parameters, duration_weight),
    )
    about = parameters._replace(means=np.zeros_like(means))
    adapted = maximize_likelihood(joined, about, floors=floors, duration_floor=duration_floor)
    durations = parameters[2:] if np.isinf(duration_weight) else adapted[2:]
    variances = np.where(fixed, parameters.variances, adapted.variances)
    return StateParameters(means + adapted.means, variances, *durations)


def _add_durations(counts: NDArray[np.float64], parameters: StateParameters, weight: float) -> NDArray[np.float64]:
    """Return counts of durations and `weight` of the prior's."""
    if np.isinf(weight):
        return counts
    prior = weight * np.exp(log_durations(parameters.duration_means, parameters.duration_variances))
    width = max(counts.shape[1], prior.shape[1])
    counts, prior = (np.pad(part, ((0, 0), (0, width - part.shape[1]))) for part in (counts, prior))
    return counts + prior
