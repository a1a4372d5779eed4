"""Training the states of a gait model on walks: those of every context first, then those that are tied.

The steps of the paper (Tilmanne et al. 2012, 5.1.1 to 5.2.1): states start from steps cut evenly; embedded EM; tying of
contexts that are alike; embedded EM again.
"""

from collections.abc import Callable, Hashable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.hsmm.accumulation import ObservedWalk
from eigenwalker.hsmm.estimation import (
    StateParameters,
    maximize_likelihood,
    overall_moments,
    start_parameters,
    variance_floors,
)
from eigenwalker.hsmm.gait_states import chain_of
from eigenwalker.hsmm.labeled_walks import LabeledWalk
from eigenwalker.hsmm.step_labels import CONTEXTS
from eigenwalker.hsmm.training import FittedStates, expect_all, fit_states
from eigenwalker.hsmm.tying import GAIT_GROUPS, Tying, pool_rows, tie_by, tie_durations, tie_states, untied
from eigenwalker.hsmm.walker_adaptive import fit_walker_adaptive

__all__ = ["Floors", "TrainedStates", "observe_walks", "train_states", "train_walkers"]

Array = NDArray[np.float64]

_LEAST = 1e-12  # of floors of trees, where there are none: their Gaussians need one


class Floors(NamedTuple):
    """Least variances, see `variance_floors`.

    Parameters
    ----------
    relative : float
        Share of the variance of each feature over all frames.
    absolute : float
        In squared units of the features.
    duration : float
        In frames squared.
    """

    relative: float
    absolute: float
    duration: float


class TrainedStates(NamedTuple):
    """What `train_states` returns.

    Parameters
    ----------
    fitted : FittedStates
        Gaussians of the tied states, and how the likelihood rose.
    states, duration_states : Tying
        Which state each context has.
    floors : ndarray of shape (n_features,)
        Least variances that were used.
    """

    fitted: FittedStates
    states: Tying
    duration_states: Tying
    floors: Array


def observe_walks(
    walks: Sequence[LabeledWalk],
    states: NDArray[np.int_],
    duration_states: NDArray[np.int_],
    windows: Sequence[Sequence[float]],
) -> list[ObservedWalk]:
    """Return walks as estimation takes them, from states (n_contexts, n_states) in the order of CONTEXTS."""
    return [
        ObservedWalk(
            walk.name,
            walk.observations(windows),
            chain_of(states, walk.labels),
            chain_of(duration_states, walk.labels),
        )
        for walk in walks
    ]


def train_states(
    walks: Sequence[LabeledWalk],
    *,
    n_states: int,
    windows: Sequence[Sequence[float]],
    tying: str | None,
    penalty: float,
    floors: Floors,
    max_iter: int,
    tol: float,
    n_jobs: int | None = None,
    report: Callable[[int, float], None] | None = None,
) -> TrainedStates:
    """Return the states of walks.

    Parameters
    ----------
    walks : sequence of LabeledWalk
        At least one.
    n_states : int
        Of a step.
    windows : sequence of sequences of float
        See `append_dynamics`.
    tying : {"tree", "paper", None}
        How contexts are tied: `tie_states` and `tie_durations`; as the paper's six; not at all.
    penalty : float
        Of the trees.
    floors : Floors
        Least variances.
    max_iter, tol, n_jobs, report
        See `fit_states`; of each of the two trainings.

    Raises
    ------
    WalkError
        If a step has fewer frames than states, or a walk has no path through the durations.
    """
    first = untied(CONTEXTS, n_states) if tying != "paper" else tie_by(CONTEXTS, GAIT_GROUPS, n_states)
    observed = observe_walks(walks, first.states, first.states, windows)
    least = variance_floors(observed, relative=floors.relative, absolute=floors.absolute)
    kept: dict[str, Any] = {"floors": least, "duration_floor": floors.duration}
    start = start_parameters(
        observed,
        [_cut_evenly(walk, n_states) for walk in walks],
        n_states=first.n_tied,
        n_duration_states=first.n_tied,
        **kept,
    )
    training: dict[str, Any] = {"max_iter": max_iter, "tol": tol, "n_jobs": n_jobs, "report": report, **kept}
    fitted = fit_states(observed, start, **training)
    if tying != "tree":
        seen = np.isin(first.states, np.concatenate([walk.states for walk in observed]))
        known = first._replace(states=np.where(seen, first.states, -1))
        return TrainedStates(fitted, known, known, least)
    states, durations, parameters = _tie(observed, fitted.parameters, penalty, least, floors, n_jobs)
    tied = observe_walks(walks, states.states, durations.states, windows)
    return TrainedStates(fit_states(tied, parameters, **training), states, durations, least)


def train_walkers(
    walks: Sequence[LabeledWalk],
    walkers: Sequence[Hashable],
    trained: TrainedStates,
    *,
    windows: Sequence[Sequence[float]],
    weight: float,
    duration_floor: float,
    max_iter: int,
    tol: float,
    n_jobs: int | None = None,
    report: Callable[[int, float], None] | None = None,
) -> TrainedStates:
    """Return states of which each walker is a transform, from those of all walkers; see `fit_walker_adaptive`.

    Parameters
    ----------
    walks : sequence of LabeledWalk
        Those that the states were trained on.
    walkers : sequence of hashable
        Whose each walk is.
    trained : TrainedStates
        From `train_states`.
    windows, weight, duration_floor, max_iter, tol, n_jobs, report
        See `fit_walker_adaptive`.

    Raises
    ------
    ValueError
        If there is not one walker a walk, or all walks are of one.
    """
    if len(walkers) != len(walks):
        raise ValueError(f"expected a walker for each of the {len(walks)} walks, got {len(walkers)}")
    if len(set(walkers)) < 2:
        raise ValueError(
            f"walker-adaptive training needs walks of several people, got walkers={sorted(map(str, set(walkers)))}; "
            "leave walkers out"
        )
    observed = observe_walks(walks, trained.states.states, trained.duration_states.states, windows)
    by_walker: dict[str, list[ObservedWalk]] = {}
    for walker, walk in zip(walkers, observed, strict=True):
        by_walker.setdefault(str(walker), []).append(walk)
    found = fit_walker_adaptive(
        by_walker,
        trained.fitted.parameters,
        weight=weight,
        windows=windows,
        floors=trained.floors,
        duration_floor=duration_floor,
        max_iter=max_iter,
        tol=tol,
        n_jobs=n_jobs,
        report=report,
    )
    return trained._replace(fitted=FittedStates(found.parameters, found.objectives, found.converged))


def _tie(
    observed: list[ObservedWalk],
    parameters: StateParameters,
    penalty: float,
    least: Array,
    floors: Floors,
    n_jobs: int | None,
) -> tuple[Tying, Tying, StateParameters]:
    """Return which states are one, and the Gaussians of those that are."""
    center, _ = overall_moments(observed)
    centered = [walk._replace(observations=walk.observations - center) for walk in observed]
    sums = expect_all(centered, parameters._replace(means=parameters.means - center), n_jobs)
    states = tie_states(sums, CONTEXTS, floors=np.maximum(least, _LEAST), penalty=penalty)
    durations = tie_durations(sums, CONTEXTS, floor=max(floors.duration, _LEAST), penalty=penalty)
    pooled = sums._replace(
        counts=pool_rows(sums.counts, states.states, states.n_tied),
        sums=pool_rows(sums.sums, states.states, states.n_tied),
        squares=pool_rows(sums.squares, states.states, states.n_tied),
        duration_counts=pool_rows(sums.duration_counts, durations.states, durations.n_tied),
    )
    rows, duration_rows = np.zeros(states.n_tied, dtype=int), np.zeros(durations.n_tied, dtype=int)
    # Every tied state was seen: what it keeps of these is nothing.
    some = StateParameters(
        parameters.means[rows],
        parameters.variances[rows],
        parameters.duration_means[duration_rows],
        parameters.duration_variances[duration_rows],
    )
    tied = maximize_likelihood(pooled, some, floors=least, duration_floor=floors.duration)
    return states, durations, tied._replace(means=tied.means + center)


def _cut_evenly(walk: LabeledWalk, n_states: int) -> NDArray[np.int64]:
    """Return where the states of each step start if all of a step last equally long, counted from the first step."""
    lengths = np.diff(walk.boundaries)
    if lengths.min() < n_states:
        at = int(lengths.argmin())
        raise WalkError(
            f"walk {walk.name!r}: expected at least {n_states} frames a step, one a state, got {lengths[at]} in step "
            f"{at}; resample to a higher frame_rate, take fewer states, or check its step labels"
        )
    edges = [np.linspace(start, end, n_states + 1)[:-1] for start, end in pairwise(walk.boundaries)]
    return np.rint(np.append(np.concatenate(edges), walk.boundaries[-1])).astype(np.int64) - walk.boundaries[0]
