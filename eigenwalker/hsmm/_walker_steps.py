"""Steps that adaptation and walker-adaptive training share: posteriors of walks, and transforms of one walker."""

from collections.abc import Sequence
from functools import partial, reduce
from typing import NamedTuple

import numpy as np
from joblib import parallel_config
from numpy.typing import NDArray

from eigenwalker._collect import collect
from eigenwalker._validation import WalkError
from eigenwalker.hsmm.accumulation import ObservedWalk
from eigenwalker.hsmm.duration_transform import DurationTransform, duration_penalty, estimate_duration_transform
from eigenwalker.hsmm.estimation import StateParameters
from eigenwalker.hsmm.inference import Posterior
from eigenwalker.hsmm.transform_estimation import StandardUnits, estimate_transform, transform_penalty
from eigenwalker.hsmm.transform_statistics import TransformStatistics, add_transform_statistics, select_classes
from eigenwalker.hsmm.transformed_inference import (
    TransformClasses,
    WalkerTransforms,
    accumulate_walk_transform,
    expect_transformed,
)
from eigenwalker.hsmm.transforms import ChannelTransform

__all__ = [
    "Plan",
    "count_durations",
    "estimate_durations",
    "estimate_walker",
    "expect_walks",
    "penalty",
    "sum_transform",
]


class Plan(NamedTuple):
    """What stays the same through all steps: classes and windows, and how strongly transforms are held."""

    classes: TransformClasses
    windows: Sequence[Sequence[float]]
    weight: float
    duration_weight: float
    units: StandardUnits
    duration_units: StandardUnits
    max_condition: float


def expect_walks(
    walks: Sequence[ObservedWalk],
    transforms: Sequence[WalkerTransforms],
    parameters: StateParameters,
    plan: Plan,
    n_jobs: int | None = None,
) -> list[Posterior]:
    """Return the posterior of each walk under its own transforms, or raise one WalkError for all without a path."""

    def expect(pair: tuple[ObservedWalk, WalkerTransforms]) -> Posterior:
        return expect_transformed(pair[0], parameters, pair[1], classes=plan.classes, windows=plan.windows)

    pairs = list(zip(walks, transforms, strict=True))
    with parallel_config("threading", n_jobs=n_jobs):
        posteriors, refusals = collect(expect, pairs, [walk.name for walk in walks])
    if refusals:
        raise WalkError("\n".join(refusal.reason for refusal in refusals))
    return [posterior for posterior in posteriors if posterior is not None]


def sum_transform(
    walks: Sequence[ObservedWalk], posteriors: Sequence[Posterior], parameters: StateParameters, plan: Plan
) -> TransformStatistics:
    """Return the sums of a walker's walks from which channels' transforms are estimated."""
    one = partial(accumulate_walk_transform, parameters=parameters, classes=plan.classes, windows=plan.windows)
    return reduce(
        add_transform_statistics, [one(walk, posterior) for walk, posterior in zip(walks, posteriors, strict=True)]
    )


def count_durations(
    walks: Sequence[ObservedWalk], posteriors: Sequence[Posterior], parameters: StateParameters
) -> NDArray[np.float64]:
    """Return how often each state is expected to last d frames: (n_duration_states, n_durations)."""
    width = max(posterior.duration_counts.shape[1] for posterior in posteriors)
    counts = np.zeros((len(parameters.duration_means), width))
    for walk, posterior in zip(walks, posteriors, strict=True):
        np.add.at(counts[:, : posterior.duration_counts.shape[1]], walk.duration_states, posterior.duration_counts)
    return counts


def estimate_durations(
    counts: NDArray[np.float64], parameters: StateParameters, start: DurationTransform, plan: Plan
) -> DurationTransform:
    """Return a walker's transform of durations, given the states."""
    return estimate_duration_transform(
        counts,
        parameters.duration_means,
        parameters.duration_variances,
        weight=plan.duration_weight,
        duration_classes=plan.classes.durations,
        n_classes=plan.classes.n_durations,
        units=plan.duration_units,
        start=start,
    )


def estimate_walker(
    walks: Sequence[ObservedWalk],
    posteriors: Sequence[Posterior],
    parameters: StateParameters,
    start: WalkerTransforms,
    plan: Plan,
) -> WalkerTransforms:
    """Return a walker's transforms given the states, the prior of each about the identity.

    A class of which the walker has no frames keeps its transform.
    """
    statistics = sum_transform(walks, posteriors, parameters, plan)
    channels: list[ChannelTransform] = list(start.channels)
    for group in np.flatnonzero(statistics.n_frames > 0):
        channels[group] = estimate_transform(
            select_classes(statistics, group),
            weight=plan.weight,
            units=plan.units,
            start=start.channels[group],
            max_condition=plan.max_condition,
        )
    counts = count_durations(walks, posteriors, parameters)
    return WalkerTransforms(tuple(channels), estimate_durations(counts, parameters, start.durations, plan))


def penalty(transforms: Sequence[WalkerTransforms], plan: Plan) -> float:
    """Return what the priors take from the log-likelihood of all walkers."""
    return sum(
        transform_penalty(own.channels, weight=plan.weight, units=plan.units)
        + duration_penalty(own.durations, plan.duration_weight, plan.duration_units)
        for own in transforms
    )
