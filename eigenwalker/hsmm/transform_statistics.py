"""Sums over frames from which transforms of channels are estimated, and what they say of a transform.

With zeta = (window of c, sum of the window's coefficients) and W = (A b), row i of W zeta is channel i of the window
of z. Given posteriors gamma_t(s) the expected log-density of the frames of a class of states is

    Q(W) = beta log |det A| - 1/2 sum_i (w_i G_i w_i' - 2 w_i k_i') + constant

    G_i = sum_s sum_w sum_t gamma_t(s) / sigma_swi^2 zeta_tw zeta_tw'
    k_i = sum_s sum_w sum_t gamma_t(s) mu_swi / sigma_swi^2 zeta_tw'

with beta the sum of gamma over all frames and their observed windows: each has a Jacobian of its own.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm.features import WINDOWS
from eigenwalker.hsmm.transforms import ChannelTransform, split_windows, window_sums

__all__ = [
    "TransformStatistics",
    "accumulate_transform",
    "add_transform_statistics",
    "select_classes",
    "transform_objective",
]


class TransformStatistics(NamedTuple):
    """Sums over frames, windows and states, for each class of states. They add over walks.

    Attributes
    ----------
    n_frames : ndarray of shape (n_classes,)
        Sum of posteriors over frames.
    n_volumes : ndarray of shape (n_classes,)
        beta: the same over frames and observed windows.
    quadratic : ndarray of shape (n_classes, n_channels, n_channels + 1, n_channels + 1)
        G_i of each channel; the bias is last.
    linear : ndarray of shape (n_classes, n_channels, n_channels + 1)
        k_i of each channel.
    constants : ndarray of shape (n_classes,)
        What makes Q the sum of log-densities, rather than that up to a constant.
    """

    n_frames: NDArray[np.float64]
    n_volumes: NDArray[np.float64]
    quadratic: NDArray[np.float64]
    linear: NDArray[np.float64]
    constants: NDArray[np.float64]


def accumulate_transform(
    observations: NDArray[np.floating],
    state_posteriors: NDArray[np.floating],
    *,
    states: ArrayLike,
    means: NDArray[np.floating],
    variances: NDArray[np.floating],
    state_classes: ArrayLike | None = None,
    n_classes: int = 1,
    windows: Sequence[Sequence[float]] = WINDOWS,
) -> TransformStatistics:
    """Return the sums of one walk.

    Parameters
    ----------
    observations : ndarray of shape (n_frames, n_windows * n_channels)
        Channels c and their dynamics, not transformed. NaN is what was not observed, a whole window of a frame.
    state_posteriors : ndarray of shape (n_frames, n_positions)
        gamma, from `infer_states` under the transform so far.
    states : array-like of int of shape (n_positions,)
        State of each position.
    means, variances : ndarray of shape (n_states, n_windows * n_channels)
        mu and sigma^2 of all states, of transformed channels z.
    state_classes : array-like of int of shape (n_states,), default None
        Class of each state. None is one class for all.
    n_classes : int, default 1
        Number of classes.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of each window.

    Returns
    -------
    TransformStatistics

    Raises
    ------
    ValueError
        If shapes do not fit, classes are not from 0 to n_classes - 1, or part of a window is NaN.

    References
    ----------
    Gales 1998, Eq. 43 to 46 for constrained transforms; here of windows that share one transform, so that beta counts
    windows.

    Examples
    --------
    >>> import numpy as np
    >>> statistics = accumulate_transform(
    ...     np.array([[1.0], [3.0]]), np.ones((2, 1)), states=[0], means=np.array([[4.0]]),
    ...     variances=np.array([[2.0]]), windows=((1.0,),)
    ... )
    >>> statistics.n_volumes, statistics.quadratic[0, 0], statistics.linear[0, 0]
    (array([2.]), array([[5., 2.],
           [2., 1.]]), array([8., 4.]))
    """
    means = np.asarray(means, dtype=np.float64)
    n_channels = means.shape[1] // len(windows)
    classes = _check_classes(state_classes, len(means), n_classes)
    parts = split_windows(observations, n_channels, windows)
    observed = _observed_windows(parts)
    sums = np.broadcast_to(window_sums(windows)[:, np.newaxis], (*observed.shape, 1))
    zetas = np.concatenate((np.where(observed[..., np.newaxis], parts, 0.0), sums), axis=2)
    used, weights = _sum_positions(np.asarray(state_posteriors, dtype=np.float64), np.asarray(states))
    result = _empty(n_classes, n_channels)
    for group in range(n_classes):
        chosen = classes[used] == group
        if chosen.any():
            moments = _frame_moments(zetas, observed, weights[:, chosen])
            shape = (-1, n_channels)  # (n_chosen * n_windows, n_channels)
            centers, spreads = (np.asarray(part)[used[chosen]].reshape(shape) for part in (means, variances))
            _add_class(result, group, moments, centers, 1.0 / spreads)
    return result


def _add_class(result: TransformStatistics, group: int, moments: tuple, means: NDArray, precisions: NDArray) -> None:
    """Add the moments of states and windows, each weighted by its precisions, to those of a class."""
    counts, firsts, seconds, n_frames = moments
    n_channels, size = result.linear.shape[1:]
    result.n_frames[group] = n_frames
    result.n_volumes[group] = counts.sum()
    result.quadratic[group] = (precisions.T @ seconds.reshape(len(seconds), -1)).reshape(n_channels, size, size)
    result.linear[group] = (precisions * means).T @ firsts
    result.constants[group] = -0.5 * counts @ (np.log(2 * np.pi / precisions) + means**2 * precisions).sum(axis=1)


def _frame_moments(zetas: NDArray, observed: NDArray, weights: NDArray) -> tuple[NDArray, NDArray, NDArray, float]:
    """Return, for states and windows, sums of gamma, gamma zeta and gamma zeta zeta' over frames; and of gamma."""
    n_windows, size = zetas.shape[1:]
    counts, firsts = np.empty((weights.shape[1], n_windows)), np.empty((weights.shape[1], n_windows, size))
    seconds = np.empty((weights.shape[1], n_windows, size, size))
    for state, gamma in enumerate(weights.T):
        for window in range(n_windows):
            frames = np.flatnonzero((gamma > 0) & observed[:, window])
            zeta = zetas[frames, window]
            weighted = gamma[frames, np.newaxis] * zeta
            counts[state, window] = gamma[frames].sum()
            firsts[state, window] = weighted.sum(axis=0)
            seconds[state, window] = weighted.T @ zeta
    # (n_states * n_windows, ...)
    return counts.ravel(), firsts.reshape(-1, size), seconds.reshape(-1, size, size), float(weights.sum())


def _sum_positions(state_posteriors: NDArray, states: NDArray) -> tuple[NDArray, NDArray]:
    """Return which states a walk has, and gamma of each: (n_frames, n_used)."""
    used, columns = np.unique(states, return_inverse=True)
    weights = np.zeros((len(state_posteriors), len(used)))
    for position, column in enumerate(columns):
        weights[:, column] += state_posteriors[:, position]
    return used, weights


def _observed_windows(parts: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which windows of which frames were observed, or raise where that holds for some channels only."""
    missing = np.isnan(parts)
    torn = missing.any(axis=2) & ~missing.all(axis=2)
    if torn.any():
        frame, window = np.argwhere(torn)[0]
        raise ValueError(
            f"windows must be observed in all channels or in none, but some of window {window} are NaN in frame "
            f"{frame}, and {int(torn.sum())} windows in all; fill the gaps first"
        )
    return np.asarray(~missing.any(axis=2))


def _check_classes(state_classes: ArrayLike | None, n_states: int, n_classes: int) -> NDArray[np.integer]:
    classes = np.zeros(n_states, dtype=int) if state_classes is None else np.asarray(state_classes)
    if classes.shape != (n_states,) or (n_states and not (classes.min() >= 0 and classes.max() < n_classes)):
        raise ValueError(
            f"state_classes must be one class from 0 to {n_classes - 1} for each of {n_states} states, "
            f"got {classes.tolist()}"
        )
    return classes


def _empty(n_classes: int, n_channels: int) -> TransformStatistics:
    size = n_channels + 1
    frames, volumes, constants = np.zeros((3, n_classes))
    quadratic, linear = np.zeros((n_classes, n_channels, size, size)), np.zeros((n_classes, n_channels, size))
    return TransformStatistics(frames, volumes, quadratic, linear, constants)


def add_transform_statistics(one: TransformStatistics, other: TransformStatistics) -> TransformStatistics:
    """Return the sums of both walks, or sets of walks."""
    return TransformStatistics(*(mine + theirs for mine, theirs in zip(one, other, strict=True)))


def select_classes(statistics: TransformStatistics, classes: ArrayLike) -> TransformStatistics:
    """Return the sums of some classes, which stay apart."""
    chosen = np.atleast_1d(np.asarray(classes))
    return TransformStatistics(*(part[chosen] for part in statistics))


def transform_objective(statistics: TransformStatistics, transforms: Sequence[ChannelTransform]) -> float:
    """Return Q: the expected log-density of frames under transforms, posteriors given.

    Parameters
    ----------
    statistics : TransformStatistics
        Of n_classes classes.
    transforms : sequence of ChannelTransform
        One a class.

    Returns
    -------
    float
        In nats. The entropy of the posteriors and the log-probabilities of durations are not in it.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.hsmm.transforms import identity_transform
    >>> statistics = accumulate_transform(
    ...     np.array([[1.0]]), np.ones((1, 1)), states=[0], means=np.array([[1.0]]), variances=np.array([[1.0]]),
    ...     windows=((1.0,),)
    ... )
    >>> round(transform_objective(statistics, [identity_transform(1)]), 3)  # the density of a Gaussian at its mean
    -0.919
    """
    total = 0.0
    for group, transform in enumerate(transforms):
        rows = np.column_stack((transform.matrix, transform.bias))
        products = (statistics.quadratic[group] @ rows[..., np.newaxis])[..., 0]  # G_i w_i'
        total += statistics.n_volumes[group] * transform.log_volume + statistics.constants[group]
        total -= 0.5 * float((rows * (products - 2 * statistics.linear[group])).sum())
    return float(total)
