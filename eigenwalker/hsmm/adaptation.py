"""Adapting a gait model to a style from few steps (Tilmanne et al. 2012, 5.1.3 and 5.2.2).

Transforms first, which all states of a class share: z = A c + b is what the Gaussians describe. Then MAP, which moves
each state by the frames it has. Both alternate with the E step, as training does.
"""

from collections.abc import Sequence
from functools import partial, reduce
from typing import NamedTuple

import numpy as np
from joblib import parallel_config
from numpy.typing import NDArray

from eigenwalker._collect import collect
from eigenwalker._validation import WalkError
from eigenwalker.hsmm.accumulation import ObservedWalk, Statistics, accumulate_walk, add_statistics
from eigenwalker.hsmm.duration_transform import estimate_duration_transform, transformed_durations
from eigenwalker.hsmm.estimation import StateParameters
from eigenwalker.hsmm.gait_states import GaitStates, chain_of, infer_walk
from eigenwalker.hsmm.inference import Posterior
from eigenwalker.hsmm.labeled_walks import LabeledWalk
from eigenwalker.hsmm.map_adaptation import map_states
from eigenwalker.hsmm.transform_estimation import StandardUnits
from eigenwalker.hsmm.transform_statistics import TransformStatistics, accumulate_transform, add_transform_statistics
from eigenwalker.hsmm.transform_tree import RegressionTree, TreeTransforms, estimate_along_tree, split_states

__all__ = ["METHODS", "AdaptationSettings", "AdaptedStates", "adapt_states"]

METHODS = ("csmaplr+map", "csmaplr", "cmllr+map", "cmllr", "map")

_GAIN = 1e-3  # nats a frame, below which an iteration is the last


class AdaptationSettings(NamedTuple):
    """How a model is adapted, see `GaitHSMM.adapt`.

    Parameters
    ----------
    method : str
        One of METHODS.
    transform_weight, map_weight, duration_weight : float
        Of the priors.
    n_classes : int
        Most classes of states, each with a transform of its own.
    max_iter : int
        Most iterations of transforms, and of MAP.
    blocks : sequence of ndarray of int
        Channels that transforms mix with each other.
    units : StandardUnits
        In which transforms are compared.
    floors : ndarray of shape (n_features,)
        Least variances.
    noise : float
        Variance, in squared units of the channels, that transforms take channels to have beside what they show. Without
        it a direction in which a joint cannot turn would be blown up until it fills the model's variance.
    duration_floor : float
        The same of durations, in frames squared.
    n_jobs : int or None
        Number of threads.
    """

    method: str
    transform_weight: float
    map_weight: float
    duration_weight: float
    n_classes: int
    max_iter: int
    blocks: Sequence[NDArray[np.integer]]
    units: StandardUnits
    floors: NDArray[np.float64]
    noise: float
    duration_floor: float
    n_jobs: int | None = None


class AdaptedStates(NamedTuple):
    """What `adapt_states` returns.

    Parameters
    ----------
    model : GaitStates
        The adapted states.
    n_wanted : int
        Classes of states that were to have a transform.
    n_used : int
        Those that had frames enough for one of their own; 0 for MAP alone, or if not even one for all had.
    n_frames : float
        Of the walks.
    """

    model: GaitStates
    n_wanted: int
    n_used: int
    n_frames: float


def adapt_states(walks: Sequence[LabeledWalk], model: GaitStates, settings: AdaptationSettings) -> AdaptedStates:
    """Return the states of a model adapted to walks.

    Parameters
    ----------
    walks : sequence of LabeledWalk
        Of the style.
    model : GaitStates
        Of the average walk, not adapted before.
    settings : AdaptationSettings
        How.

    Raises
    ------
    WalkError
        If walks have no path through the durations of the model; all of them are named.
    """
    n_frames = float(sum(walk.n_frames for walk in walks))
    adapted = AdaptedStates(model, 0, 0, n_frames)
    if settings.method != "map":
        adapted = _transform(walks, model, settings)
    adapted = adapted._replace(n_frames=n_frames)
    if settings.method.endswith("map"):
        adapted = adapted._replace(model=_map(walks, adapted.model, settings))
    return adapted


def _transform(walks: Sequence[LabeledWalk], model: GaitStates, settings: AdaptationSettings) -> AdaptedStates:
    """Return the model with transforms of channels, one a class, and of durations, one for all."""
    n_channels = walks[0].channels.shape[1]
    tree = split_states(
        model.parameters.means[:, :n_channels],
        n_leaves=min(settings.n_classes, len(model.parameters.means)),
        scales=settings.units.scales,
    )
    weight = settings.transform_weight if settings.method.startswith("csmaplr") else 0.0
    means, variances = model.parameters.duration_means, model.parameters.duration_variances
    current, found, longer, before = model, None, None, -np.inf
    for _ in range(settings.max_iter):
        posteriors = _infer_all(walks, current, settings.n_jobs)
        likelihood = sum(part.log_likelihood for part in posteriors)
        sums = _with_noise(_sum_transforms(walks, posteriors, model, tree), settings.noise)
        if found is not None and likelihood - before < _GAIN * sums.n_frames.sum():
            break
        before = likelihood
        found = estimate_along_tree(
            sums,
            tree,
            weight=weight,
            blocks=settings.blocks,
            units=settings.units,
            start=None if found is None else found.transforms,
        )
        longer = estimate_duration_transform(
            _sum_durations(walks, posteriors, model), means, variances, weight=settings.duration_weight, start=longer
        )
        in_frames = transformed_durations(longer, means, variances)
        parameters = StateParameters(model.parameters.means, model.parameters.variances, *in_frames)
        current = _replace_transforms(model, tree, found)._replace(parameters=parameters)
    leaves = np.unique(tree.state_nodes)
    used = np.unique(found.sources[leaves]) if found is not None else np.array([-1])
    return AdaptedStates(current, len(leaves), int((used >= 0).sum()), float(sums.n_frames.sum()))


def _replace_transforms(model: GaitStates, tree: RegressionTree, found: TreeTransforms) -> GaitStates:
    """Return the model with the transforms of the nodes that states have, each once."""
    own = [*found.transforms, model.transforms[0]]  # the identity is last, at the place that -1 says
    sources, classes = np.unique(found.sources[tree.state_nodes], return_inverse=True)
    return model._replace(transforms=tuple(own[source] for source in sources), classes=classes.astype(np.int64))


def _map(walks: Sequence[LabeledWalk], model: GaitStates, settings: AdaptationSettings) -> GaitStates:
    """Return the model with states moved towards the frames they have; the prior stays that of the beginning."""
    current, before = model, -np.inf
    for _ in range(settings.max_iter):
        posteriors = _infer_all(walks, current, settings.n_jobs)
        sums = reduce(
            add_statistics, [_sum_states(walk, part, model) for walk, part in zip(walks, posteriors, strict=True)]
        )
        if sums.log_likelihood - before < _GAIN * sums.n_frames:
            break
        before = sums.log_likelihood
        parameters = map_states(
            sums,
            model.parameters,
            weight=settings.map_weight,
            duration_weight=settings.duration_weight,
            floors=settings.floors,
            duration_floor=settings.duration_floor,
        )
        current = model._replace(parameters=parameters)
    return current


def _infer_all(walks: Sequence[LabeledWalk], model: GaitStates, n_jobs: int | None) -> list[Posterior]:
    with parallel_config("threading", n_jobs=n_jobs):
        found, refusals = collect(partial(infer_walk, model=model), walks, [walk.name for walk in walks])
    if refusals:
        raise WalkError("\n".join(refusal.reason for refusal in refusals))
    return [part for part in found if part is not None]


def _sum_transforms(
    walks: Sequence[LabeledWalk], posteriors: Sequence[Posterior], model: GaitStates, tree: RegressionTree
) -> TransformStatistics:
    sums = [
        accumulate_transform(
            walk.observations(model.windows),
            posterior.state_posteriors,
            states=chain_of(model.states, walk.labels),
            means=model.parameters.means,
            variances=model.parameters.variances,
            state_classes=tree.state_nodes,
            n_classes=len(tree.parents),
            windows=model.windows,
        )
        for walk, posterior in zip(walks, posteriors, strict=True)
    ]
    return reduce(add_transform_statistics, sums)


def _with_noise(sums: TransformStatistics, noise: float) -> TransformStatistics:
    """Return the sums that frames would have whose static channels had some more variance.

    G_i of the bias alone is the sum of gamma / sigma^2 over frames; as much times the noise is added for each channel.
    """
    quadratic = np.array(sums.quadratic)
    channels = np.arange(quadratic.shape[1])
    quadratic[:, :, channels, channels] += noise * quadratic[:, :, -1, -1, np.newaxis]
    return sums._replace(quadratic=quadratic)


def _sum_durations(
    walks: Sequence[LabeledWalk], posteriors: Sequence[Posterior], model: GaitStates
) -> NDArray[np.float64]:
    """Return how often each state lasts d frames, shape (n_duration_states, n_durations)."""
    width = max(part.duration_counts.shape[1] for part in posteriors)
    counts = np.zeros((len(model.parameters.duration_means), width))
    for walk, part in zip(walks, posteriors, strict=True):
        own = part.duration_counts
        np.add.at(counts[:, : own.shape[1]], chain_of(model.duration_states, walk.labels), own)
    return counts


def _sum_states(walk: LabeledWalk, posterior: Posterior, model: GaitStates) -> Statistics:
    """Return the sums of one walk, of each state in the channels that its class has been transformed to."""
    chain, durations = chain_of(model.states, walk.labels), chain_of(model.duration_states, walk.labels)
    sizes = {"n_states": len(model.parameters.means), "n_duration_states": len(model.parameters.duration_means)}
    parts = []
    for number, transform in enumerate(model.transforms):
        moved = walk._replace(channels=transform.apply(walk.channels))
        own = model.classes[chain] == number
        masked = posterior._replace(state_posteriors=posterior.state_posteriors * own)
        observed = ObservedWalk(walk.name, moved.observations(model.windows), chain, durations)
        parts.append(accumulate_walk(observed, masked, **sizes))
    whole = reduce(add_statistics, parts)
    return whole._replace(
        log_likelihood=parts[0].log_likelihood, n_frames=parts[0].n_frames, duration_counts=parts[0].duration_counts
    )
