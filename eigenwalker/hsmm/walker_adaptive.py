"""Walker-adaptive training: states of which every walker is a transform.

Plain training takes what walkers differ in for spread of the states. Here each walker has transforms of channels and of
durations, z = A c + b and d_z = a d + e, and the states are those of z: the canonical model. Steps in turn, none of
which lowers the penalized likelihood: posteriors of each walk under its walker's transforms; each walker's transforms
given the states; the states given the transforms; and, as many canonical models are equally likely, the one whose
transforms are nearest to the identity (`nearest_to_identity`). With a prior that is the best of them; without one it is
a convention: that on average over walkers no channel is scaled or shifted.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm._walker_steps import Plan, count_durations, estimate_walker, expect_walks, penalty
from eigenwalker.hsmm.accumulation import ObservedWalk, add_statistics
from eigenwalker.hsmm.canonical_durations import fit_canonical_durations
from eigenwalker.hsmm.canonical_states import nearest_to_identity
from eigenwalker.hsmm.duration_transform import duration_units
from eigenwalker.hsmm.estimation import StateParameters, maximize_likelihood, overall_moments
from eigenwalker.hsmm.features import WINDOWS
from eigenwalker.hsmm.inference import Posterior
from eigenwalker.hsmm.training import check_observed
from eigenwalker.hsmm.transform_estimation import standard_units
from eigenwalker.hsmm.transformed_inference import (
    WalkerTransforms,
    accumulate_transformed,
    identity_walker,
    one_class,
)
from eigenwalker.hsmm.transforms import ChannelTransform, window_sums

__all__ = ["WalkerAdaptiveStates", "fit_walker_adaptive"]


class WalkerAdaptiveStates(NamedTuple):
    """What walker-adaptive training found.

    Attributes
    ----------
    parameters : StateParameters
        The canonical states: of transformed channels and durations. No walker walks like them; walks must be adapted
        to before they are scored.
    transforms : dict of str to WalkerTransforms
        Of each walker.
    objectives : ndarray of shape (n_iterations + 1,)
        Log-likelihood of all walks less what the priors take, of the start and after each iteration.
    converged : bool
        Whether the last gain was below `tol`.
    """

    parameters: StateParameters
    transforms: dict[str, WalkerTransforms]
    objectives: NDArray[np.float64]
    converged: bool


def fit_walker_adaptive(
    walks: Mapping[str, Sequence[ObservedWalk]],
    parameters: StateParameters,
    *,
    weight: float,
    duration_weight: float | None = None,
    state_classes: ArrayLike | None = None,
    duration_classes: ArrayLike | None = None,
    windows: Sequence[Sequence[float]] = WINDOWS,
    floors: ArrayLike = 0.0,
    duration_floor: float = 0.0,
    max_condition: float = 1e4,
    max_iter: int = 20,
    tol: float = 1e-4,
    n_jobs: int | None = None,
    report: Callable[[int, float], None] | None = None,
) -> WalkerAdaptiveStates:
    """Return the states that walkers share, and the transforms of each.

    Parameters
    ----------
    walks : mapping of str to sequence of ObservedWalk
        Walks of each walker: channels and their dynamics, at least one walk each.
    parameters : StateParameters
        Where to start: from plain training, as transforms start at the identity.
    weight : float
        Of the prior of each walker's transforms, see `estimate_transform`. Units are the mean and the standard
        deviation of each channel over all frames. Infinity holds all at the identity: plain training.
    duration_weight : float, default None
        The same for durations, in units of their standard deviation in the states. None is `weight`.
    state_classes, duration_classes : array-like of int, default None
        Class of each state, whose states share a transform. None is one for all.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of the windows that the observations are made of.
    floors, duration_floor : array-like of shape (n_features,), default 0.0, and float, default 0.0
        As of `maximize_likelihood`. Real walks need them: some combination of many channels hardly moves, and a
        transform that blows it up has any likelihood.
    max_condition : float, default 1e4
        As of `estimate_transform`.
    max_iter : int, default 20
        Largest number of iterations.
    tol : float, default 1e-4
        Gain of the objective per frame below which it stops.
    n_jobs : int, default None
        Number of threads for the posteriors, as in joblib. Results do not depend on it.
    report : callable, default None
        Called with the number of the iteration and the objective per frame after each E step.

    Returns
    -------
    WalkerAdaptiveStates

    Raises
    ------
    WalkError
        If walks have no path through the durations; all of them are named.
    ValueError
        If there are no walks, they do not fit the parameters, or a walker's frames do not determine transforms.

    References
    ----------
    Yamagishi & Kobayashi 2007, 4 (speaker-adaptive training of an HSMM, durations included); Tilmanne, Moinet & Dutoit
    2012, 5.1.2. Transforms there are maximum likelihood; here they may have a prior, without which walkers of few
    frames could not take part.
    """
    every = [walk for own in walks.values() for walk in own]
    check_observed(every, parameters)
    empty = [walker for walker, own in walks.items() if not len(own)]
    if empty:
        raise ValueError(f"expected at least one walk of each walker, got none of {', '.join(map(repr, empty))}")
    # About the mean of all frames, so that squares do not cancel where channels are far from zero.
    means, variances = (part[: parameters.means.shape[1] // len(windows)] for part in overall_moments(every))
    center = np.multiply.outer(window_sums(windows), means).ravel()
    scales = np.sqrt(np.maximum(variances, np.broadcast_to(floors, center.shape)[: len(means)]))
    plan = Plan(
        one_class(parameters, state_classes=state_classes, duration_classes=duration_classes),
        windows,
        weight,
        weight if duration_weight is None else duration_weight,
        standard_units(len(means), scales=scales),
        duration_units(parameters.duration_means, parameters.duration_variances),
        max_condition,
    )
    centered = [
        [walk._replace(observations=np.asarray(walk.observations) - center) for walk in own] for own in walks.values()
    ]
    states, transforms, objectives, converged = _iterate(
        centered,
        parameters._replace(
            means=parameters.means - center,
            variances=np.maximum(parameters.variances, floors),
            duration_variances=np.maximum(parameters.duration_variances, duration_floor),
        ),
        plan,
        floors=floors,
        duration_floor=duration_floor,
        max_iter=max_iter,
        tol=tol,
        n_jobs=n_jobs,
        report=report,
    )
    moved = [own._replace(channels=tuple(_uncenter(part, means) for part in own.channels)) for own in transforms]
    return WalkerAdaptiveStates(
        states._replace(means=states.means + center), dict(zip(walks, moved, strict=True)), objectives, converged
    )


def _uncenter(transform: ChannelTransform, origin: NDArray[np.float64]) -> ChannelTransform:
    """Return the transform of channels as they are from that of channels that count from an origin."""
    return ChannelTransform(transform.matrix, transform.bias + origin - transform.matrix @ origin)


def _iterate(
    walks: Sequence[Sequence[ObservedWalk]],
    states: StateParameters,
    plan: Plan,
    *,
    floors: ArrayLike,
    duration_floor: float,
    max_iter: int,
    tol: float,
    n_jobs: int | None,
    report: Callable[[int, float], None] | None,
) -> tuple[StateParameters, list[WalkerTransforms], NDArray[np.float64], bool]:
    n_frames = sum(len(walk.observations) for own in walks for walk in own)
    transforms = [identity_walker(plan.classes, len(plan.units.scales)) for _ in walks]
    objectives: list[float] = []
    converged = False
    for iteration in range(max_iter + 1):
        posteriors = _expect(walks, transforms, states, plan, n_jobs)
        likelihood = sum(posterior.log_likelihood for own in posteriors for posterior in own)
        objectives.append(likelihood - penalty(transforms, plan))
        if report is not None:
            report(iteration, objectives[-1] / n_frames)
        converged = iteration > 0 and objectives[-1] - objectives[-2] < tol * n_frames
        if converged or iteration == max_iter:
            break
        transforms = [
            estimate_walker(own, posterior, states, transform, plan)
            for own, posterior, transform in zip(walks, posteriors, transforms, strict=True)
        ]
        states = _estimate_states(walks, posteriors, transforms, states, plan, floors, duration_floor)
        states, transforms = nearest_to_identity(
            states,
            transforms,
            classes=plan.classes,
            units=plan.units,
            duration_units=plan.duration_units,
            windows=plan.windows,
            floors=floors,
            duration_floor=duration_floor,
        )
    return states, transforms, np.array(objectives), converged


def _expect(
    walks: Sequence[Sequence[ObservedWalk]],
    transforms: Sequence[WalkerTransforms],
    states: StateParameters,
    plan: Plan,
    n_jobs: int | None,
) -> list[list[Posterior]]:
    """Return the posteriors of each walker's walks."""
    every = [walk for own in walks for walk in own]
    of_each = [transform for own, transform in zip(walks, transforms, strict=True) for _ in own]
    posteriors = iter(expect_walks(every, of_each, states, plan, n_jobs))
    return [[next(posteriors) for _ in own] for own in walks]


def _estimate_states(
    walks: Sequence[Sequence[ObservedWalk]],
    posteriors: Sequence[Sequence[Posterior]],
    transforms: Sequence[WalkerTransforms],
    states: StateParameters,
    plan: Plan,
    floors: ArrayLike,
    duration_floor: float,
) -> StateParameters:
    """Return the states of all walks, given the transforms of their walkers."""
    sums = [
        accumulate_transformed(walk, posterior, states, of_walker.channels, classes=plan.classes, windows=plan.windows)
        for own, found, of_walker in zip(walks, posteriors, transforms, strict=True)
        for walk, posterior in zip(own, found, strict=True)
    ]
    moments = maximize_likelihood(reduce(add_statistics, sums), states, floors=floors)
    durations = fit_canonical_durations(
        [count_durations(own, found, states) for own, found in zip(walks, posteriors, strict=True)],
        [own.durations for own in transforms],
        states,
        duration_classes=plan.classes.durations,
        floor=duration_floor,
    )
    return StateParameters(moments.means, moments.variances, *durations)
