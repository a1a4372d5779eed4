"""Estimating the states of gait models from sums over walks: the M step, its floors, and a start.

Means and variances of observations are those of the frames of a state, weighted by posteriors; durations see
`fit_durations`. States that positions of walks share are one row of the sums already.
"""

from collections.abc import Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm.accumulation import ObservedWalk, Statistics, accumulate_walk, add_statistics
from eigenwalker.hsmm.duration import fit_durations
from eigenwalker.hsmm.inference import certain_posterior

__all__ = ["StateParameters", "maximize_likelihood", "overall_moments", "start_parameters", "variance_floors"]

_FEWEST = 1e-6  # frames or durations below which a state keeps what it has: what is left of them is rounding


class StateParameters(NamedTuple):
    """Gaussians of observations and of durations.

    Attributes
    ----------
    means, variances : ndarray of shape (n_states, n_features)
        Of observations.
    duration_means, duration_variances : ndarray of shape (n_duration_states,)
        In frames and frames squared.
    """

    means: NDArray[np.float64]
    variances: NDArray[np.float64]
    duration_means: NDArray[np.float64]
    duration_variances: NDArray[np.float64]


def maximize_likelihood(
    statistics: Statistics,
    parameters: StateParameters,
    *,
    floors: ArrayLike = 0.0,
    duration_floor: float = 0.0,
) -> StateParameters:
    """Return the parameters that make expected sums most likely (the M step).

    Parameters
    ----------
    statistics : Statistics
        Of all walks together.
    parameters : StateParameters
        Those so far, which a state keeps for what it has not seen.
    floors : array-like of shape (n_features,), default 0.0
        Least variance of each feature, as from `variance_floors`.
    duration_floor : float, default 0.0
        Least variance of a duration, in frames squared.

    Returns
    -------
    StateParameters

    Raises
    ------
    ValueError
        If a variance is zero and its floor is, too.
    """
    seen = statistics.counts > _FEWEST
    counts = np.where(seen, statistics.counts, 1.0)
    means = np.where(seen, statistics.sums / counts, parameters.means)
    variances = np.where(seen, statistics.squares / counts - means**2, parameters.variances)
    variances = np.maximum(variances, floors)
    if not (variances > 0).all():
        flat = np.argwhere(~(variances > 0))
        listed = ", ".join(f"{feature} of state {state}" for state, feature in flat[:4])
        raise ValueError(
            f"variances must be positive, but {len(flat)} are zero, of feature {listed}"
            f"{', ...' if len(flat) > 4 else ''}; give floors, or more walks"
        )
    durations = np.where(
        statistics.duration_counts.sum(axis=1, keepdims=True) > _FEWEST, statistics.duration_counts, 0.0
    )
    return StateParameters(
        means,
        variances,
        *fit_durations(durations, parameters.duration_means, parameters.duration_variances, floor=duration_floor),
    )


def variance_floors(
    walks: Sequence[ObservedWalk], *, relative: float = 0.01, absolute: float = 1e-6
) -> NDArray[np.float64]:
    """Return the least variance that states may have, of each feature.

    Parameters
    ----------
    walks : sequence of ObservedWalk
        Whose features' variances over all frames of all walks are what `relative` is of.
    relative : float, default 0.01
        Share of that variance.
    absolute : float, default 1e-6
        Squared units of the features: for channels that hardly move, whose likelihood would outweigh all others. In
        radians the default is the square of 0.06 degrees.

    Returns
    -------
    ndarray of shape (n_features,)
        The larger of the two.
    """
    _, variances = overall_moments(walks)
    return np.maximum(relative * variances, absolute)


def overall_moments(walks: Sequence[ObservedWalk]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mean and variance of each feature over all frames in which it was observed; zero if it never was."""
    n_features = walks[0].observations.shape[1]
    counts, sums, squares = np.zeros((3, n_features))
    for walk in walks:
        counts += np.isfinite(walk.observations).sum(axis=0)
        sums += np.nansum(walk.observations, axis=0)
    means = sums / np.maximum(counts, 1)
    for walk in walks:
        squares += np.nansum((walk.observations - means) ** 2, axis=0)
    return means, squares / np.maximum(counts, 1)


def start_parameters(
    walks: Sequence[ObservedWalk],
    boundaries: Sequence[ArrayLike],
    *,
    n_states: int,
    n_duration_states: int,
    floors: ArrayLike = 0.0,
    duration_floor: float = 1.0,
) -> StateParameters:
    """Return the parameters of walks that are cut by hand, or evenly, to start from.

    Parameters
    ----------
    walks : sequence of ObservedWalk
        The walks.
    boundaries : sequence of array-like of int, each of shape (n_positions + 1,)
        First frame of each position, and the number of frames.
    n_states, n_duration_states : int
        Number of states. Those that no walk has get the moments of all frames and of all durations.
    floors, duration_floor : array-like of shape (n_features,), default 0.0, and float, default 1.0
        As of `maximize_likelihood`.

    Returns
    -------
    StateParameters
    """
    means, variances = overall_moments(walks)
    lengths = np.concatenate([np.diff(np.asarray(edges)) for edges in boundaries])
    overall = StateParameters(
        np.tile(means, (n_states, 1)),
        np.tile(np.maximum(variances, floors), (n_states, 1)),
        np.full(n_duration_states, lengths.mean()),
        np.full(n_duration_states, max(lengths.var(), duration_floor)),
    )
    sizes = {"n_states": n_states, "n_duration_states": n_duration_states}
    sums = [
        accumulate_walk(walk, certain_posterior(edges), **sizes) for walk, edges in zip(walks, boundaries, strict=True)
    ]
    return maximize_likelihood(reduce(add_statistics, sums), overall, floors=floors, duration_floor=duration_floor)
