"""Embedded EM: the states of gait models from whole walks.

Embedded means that only the order of the states of a walk is given, not where each begins: the E step weighs all cuts
of the walk (`infer_states`), the M step takes what fell to each state (`maximize_likelihood`).
"""

from collections.abc import Callable, Sequence
from functools import partial, reduce
from typing import NamedTuple

import numpy as np
from joblib import parallel_config
from numpy.typing import ArrayLike, NDArray

from eigenwalker._collect import collect
from eigenwalker._validation import WalkError
from eigenwalker.hsmm.accumulation import ObservedWalk, Statistics, accumulate_walk, add_statistics
from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.estimation import StateParameters, maximize_likelihood, overall_moments
from eigenwalker.hsmm.inference import infer_states
from eigenwalker.hsmm.observation import accumulate_over_time, log_densities

__all__ = ["FittedStates", "check_observed", "expect_all", "expect_statistics", "fit_states"]


class FittedStates(NamedTuple):
    """What embedded EM found.

    Attributes
    ----------
    parameters : StateParameters
        Those of the last entry of `log_likelihoods`.
    log_likelihoods : ndarray of shape (n_iterations + 1,)
        Of all walks together, of the start and after each M step.
    converged : bool
        Whether the last gain was below `tol`.
    """

    parameters: StateParameters
    log_likelihoods: NDArray[np.float64]
    converged: bool


def expect_statistics(walk: ObservedWalk, parameters: StateParameters) -> Statistics:
    """Return the expected sums of a walk (the E step).

    Parameters
    ----------
    walk : ObservedWalk
        The walk.
    parameters : StateParameters
        Of all states.

    Returns
    -------
    Statistics

    Raises
    ------
    WalkError
        If no durations add up to the length of the walk.
    """
    used, positions = np.unique(walk.states, return_inverse=True)
    densities = log_densities(walk.observations, parameters.means[used], parameters.variances[used])
    durations = log_durations(parameters.duration_means, parameters.duration_variances)
    posterior = infer_states(
        accumulate_over_time(densities)[positions], durations[walk.duration_states], walk=walk.name
    )
    return accumulate_walk(
        walk, posterior, n_states=len(parameters.means), n_duration_states=len(parameters.duration_means)
    )


def fit_states(
    walks: Sequence[ObservedWalk],
    parameters: StateParameters,
    *,
    floors: ArrayLike = 0.0,
    duration_floor: float = 0.0,
    max_iter: int = 20,
    tol: float = 1e-4,
    n_jobs: int | None = None,
    report: Callable[[int, float], None] | None = None,
) -> FittedStates:
    """Return the states of walks, by embedded EM from given ones.

    Parameters
    ----------
    walks : sequence of ObservedWalk
        At least one.
    parameters : StateParameters
        Where to start.
    floors, duration_floor : array-like of shape (n_features,), default 0.0, and float, default 0.0
        As of `maximize_likelihood`. Without floors the likelihood never falls.
    max_iter : int, default 20
        Largest number of M steps.
    tol : float, default 1e-4
        Gain of the log-likelihood per frame below which it stops.
    n_jobs : int, default None
        Number of threads, as in joblib. Sums are taken in the order of the walks, so results do not depend on it.
    report : callable, default None
        Called with the number of the iteration and the log-likelihood per frame after each E step.

    Returns
    -------
    FittedStates

    Raises
    ------
    WalkError
        If walks have no path through the durations; all of them are named.
    ValueError
        If there are no walks, or they do not fit the parameters.

    References
    ----------
    Tilmanne, Moinet & Dutoit 2012, 5.1.1 and 5.1.2, and Yoshimura et al. 1998 for the durations, which there are
    estimated from posteriors of an ordinary hidden Markov model, and here from those of the explicit durations.
    """
    check_observed(walks, parameters)
    # About the mean of all frames, so that squares do not cancel where channels are far from zero.
    center, _ = overall_moments(walks)
    centered = [walk._replace(observations=np.asarray(walk.observations) - center) for walk in walks]
    current = parameters._replace(means=parameters.means - center)
    history: list[float] = []
    converged = False
    for iteration in range(max_iter + 1):
        statistics = expect_all(centered, current, n_jobs)
        history.append(statistics.log_likelihood)
        if report is not None:
            report(iteration, history[-1] / statistics.n_frames)
        converged = iteration > 0 and history[-1] - history[-2] < tol * statistics.n_frames
        if converged or iteration == max_iter:
            break
        current = maximize_likelihood(statistics, current, floors=floors, duration_floor=duration_floor)
    return FittedStates(current._replace(means=current.means + center), np.array(history), converged)


def expect_all(walks: Sequence[ObservedWalk], parameters: StateParameters, n_jobs: int | None = None) -> Statistics:
    """Return the expected sums of all walks together; arguments as of `fit_states`."""
    with parallel_config("threading", n_jobs=n_jobs):
        sums, refusals = collect(
            partial(expect_statistics, parameters=parameters), walks, [walk.name for walk in walks]
        )
    if refusals:
        raise WalkError("\n".join(refusal.reason for refusal in refusals))
    return reduce(add_statistics, [part for part in sums if part is not None])


def check_observed(walks: Sequence[ObservedWalk], parameters: StateParameters) -> None:
    """Raise one error with all walks whose arrays do not fit each other or the parameters."""
    if not walks:
        raise ValueError("expected at least one walk, got an empty list")
    n_features, sizes = parameters.means.shape[1], (len(parameters.means), len(parameters.duration_means))
    faults = []
    for walk in walks:
        if walk.observations.ndim != 2 or walk.observations.shape[1] != n_features:
            faults.append(f"walk {walk.name!r}: expected {n_features} features, got shape {walk.observations.shape}")
        if len(walk.states) != len(walk.duration_states) or not len(walk.states):
            faults.append(
                f"walk {walk.name!r}: expected as many states as duration_states and at least one, "
                f"got {len(walk.states)} and {len(walk.duration_states)}"
            )
        for label, size in zip(("states", "duration_states"), sizes, strict=True):
            wrong = [int(state) for state in getattr(walk, label) if not 0 <= state < size]
            if wrong:
                faults.append(f"walk {walk.name!r}: expected {label} from 0 to {size - 1}, got {wrong}")
    if faults:
        raise ValueError("\n".join(faults))
