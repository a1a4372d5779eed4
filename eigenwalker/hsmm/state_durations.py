"""How long each state of a walk to be generated lasts, in whole frames (Tilmanne et al. 2012, Eq. 9).

At another speed not all states change alike: those whose durations vary most take most of the change,

    d_k = m_k + rho s_k^2

with m_k and s_k^2 the mean and variance of state k and one rho for the walk: the most likely durations of that sum
(Yoshimura et al. 1998, Eq. 11 and 12, which the paper cites).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.utils import check_random_state

from eigenwalker.hsmm.duration import log_durations

__all__ = ["mean_durations", "sample_durations"]


def mean_durations(
    means: ArrayLike, variances: ArrayLike, *, n_frames: int | None = None, speed: float = 1.0
) -> NDArray[np.int_]:
    """Return the most likely durations of the states of a walk.

    Parameters
    ----------
    means, variances : array-like of shape (n_states,)
        Of the durations, in frames and frames squared, one state of the walk after the other.
    n_frames : int, default None
        Length of the walk; None is the sum of the means, divided by `speed`.
    speed : float, default 1
        How much shorter the walk is than the sum of the means. Only without `n_frames`.

    Returns
    -------
    ndarray of int of shape (n_states,)
        At least 1 each. Rounding hands its remainder on to the next state: each state ends within half a frame of
        where it would without rounding, and the sum is `n_frames`.

    Raises
    ------
    ValueError
        If the means and variances do not fit each other or are not positive, the speed is not positive or is given
        beside `n_frames`, or there are fewer frames than states.

    Examples
    --------
    >>> mean_durations([2.4, 2.4, 2.4, 2.4, 2.4], [1.0, 1.0, 1.0, 1.0, 1.0]).tolist()
    [2, 3, 2, 3, 2]
    >>> mean_durations([10.0, 10.0], [1.0, 3.0], n_frames=24).tolist()  # rho = 1
    [11, 13]
    """
    means, variances = _check(means, variances)
    if not 0 < speed < np.inf:
        raise ValueError(f"speed must be positive and finite, got {speed!r}")
    if n_frames is None:
        durations = _stretch(means, variances, max(means.sum() / speed, len(means)))
    elif speed != 1.0:
        raise ValueError(f"expected n_frames or speed, got both: n_frames={n_frames!r}, speed={speed!r}")
    elif n_frames < len(means):
        raise ValueError(f"n_frames must be at least one a state, {len(means)}, got {n_frames}")
    else:
        durations = _stretch(means, variances, float(n_frames))
    # Durations of 1 or more remain so: two ends that are a frame apart are so when rounded.
    ends = np.floor(np.cumsum(durations) + (0.5 + 1e-9)).astype(int)  # a half rounds up, whatever the sum's rounding
    return np.diff(ends, prepend=0)


def sample_durations(
    means: ArrayLike,
    variances: ArrayLike,
    *,
    speed: float = 1.0,
    random_state: int | np.random.RandomState | None = None,
) -> NDArray[np.int_]:
    """Return durations drawn from the Gaussians on whole frames of the model, see `log_durations`.

    Parameters
    ----------
    means, variances : array-like of shape (n_states,)
        Of the durations, in frames and frames squared, one state of the walk after the other.
    speed : float, default 1
        How much shorter the expected walk is; the means move as in `mean_durations`, the variances stay.
    random_state : int, RandomState or None, default None
        Seed.

    Returns
    -------
    ndarray of int of shape (n_states,)
        At least 1 each.

    Raises
    ------
    ValueError
        If the means and variances do not fit each other or are not positive, or the speed is not positive.

    Examples
    --------
    >>> sample_durations([5.0, 5.0, 5.0, 5.0], [1.0, 1.0, 1.0, 1.0], random_state=0).tolist()
    [5, 6, 5, 5]
    """
    means, variances = _check(means, variances)
    if not 0 < speed < np.inf:
        raise ValueError(f"speed must be positive and finite, got {speed!r}")
    if speed != 1.0:
        means = _stretch(means, variances, max(means.sum() / speed, len(means)))
    cumulated = np.cumsum(np.exp(log_durations(means, variances)), axis=1)
    drawn = check_random_state(random_state).uniform(size=(len(means), 1)) * cumulated[:, -1:]
    return 1 + (cumulated <= drawn).sum(axis=1)


def _check(means: ArrayLike, variances: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    means, variances = np.asarray(means, dtype=np.float64), np.asarray(variances, dtype=np.float64)
    if means.ndim != 1 or not len(means) or variances.shape != means.shape:
        raise ValueError(
            f"expected means and variances of shape (n_states,) of at least one state, got {means.shape} and "
            f"{variances.shape}"
        )
    if not ((means > 0) & (variances > 0) & np.isfinite(means) & np.isfinite(variances)).all():
        raise ValueError(
            f"expected positive, finite means and variances, got means from {means.min()} to {means.max()} and "
            f"variances from {variances.min()} to {variances.max()}"
        )
    return means, variances


def _stretch(means: NDArray, variances: NDArray, total: float) -> NDArray[np.float64]:
    """Return max(1, m_k + rho s_k^2) with the rho for which the sum is `total`, at least one a state.

    The sum is piecewise linear in rho, with a kink where a state reaches one frame.
    """
    kinks = (1.0 - means) / variances
    order = np.argsort(kinks)
    # With rho above the kinks of the first k states these have m + rho s^2, the others 1.
    n_others = len(means) - np.arange(1, len(means) + 1)
    rhos = (total - n_others - np.cumsum(means[order])) / np.cumsum(variances[order])
    fits = np.flatnonzero(rhos >= kinks[order] - 1e-12 * np.abs(kinks[order]))
    rho = rhos[fits[-1]] if len(fits) else kinks.min()
    return np.maximum(1.0, means + rho * variances)
