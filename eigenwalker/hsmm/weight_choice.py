"""Weights of priors chosen on walks held out: too weak ones follow the few steps, too strong ones ignore them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from eigenwalker.hsmm.adaptation import AdaptationSettings, adapt_states
from eigenwalker.hsmm.gait_states import GaitStates, score_walk
from eigenwalker.hsmm.labeled_walks import LabeledWalk

__all__ = ["ChosenWeights", "choose_weights", "held_out_score"]

_TRANSFORM_WEIGHTS = (1.0, 10.0, 100.0, 1000.0, 1e4)
_MAP_WEIGHTS = (3.0, 10.0, 30.0, 100.0)
_USUAL_TRANSFORM, _USUAL_MAP = 1000.0, 30.0  # what was chosen most often, for a single walk
_MOST_FOLDS = 3


class ChosenWeights(NamedTuple):
    """What `choose_weights` returns.

    Parameters
    ----------
    settings : AdaptationSettings
        With the weights of the largest score.
    scores : tuple of tuple of float
        Weight of transforms, weight of MAP, and mean log-likelihood per frame of what was held out, of each trial.
    """

    settings: AdaptationSettings
    scores: tuple[tuple[float, float, float], ...]


def choose_weights(
    walks: Sequence[LabeledWalk],
    model: GaitStates,
    settings: AdaptationSettings,
    *,
    transform_weight: float | None = None,
    map_weight: float | None = None,
) -> ChosenWeights:
    """Return the weights that make held-out walks most likely: of transforms first, then of MAP.

    Half of a walk tells little of another walk: from its other half it looks as if weak priors would do. So a single
    walk is not cut for it, and has the usual weights, 1000 and 30.

    Parameters
    ----------
    walks : sequence of LabeledWalk
        Of the style; each is held out in turn, in three groups at most.
    model : GaitStates
        Of the average walk.
    settings : AdaptationSettings
        Everything else.
    transform_weight, map_weight : float, default None
        Those that are known.
    """
    transforms, maps = _weights_of(settings.method, transform_weight, map_weight, several=len(walks) > 1)
    usual = settings._replace(
        transform_weight=_USUAL_TRANSFORM if len(transforms) > 1 else transforms[0],
        map_weight=_USUAL_MAP if len(maps) > 1 else maps[0],
    )
    scores: dict[tuple[float, float], float] = {}
    best = usual
    if len(transforms) > 1:
        best = _best(walks, model, [best._replace(transform_weight=weight) for weight in transforms], scores)
    if len(maps) > 1:
        best = _best(walks, model, [best._replace(map_weight=weight) for weight in maps], scores)
    return ChosenWeights(best, tuple((*weights, score) for weights, score in scores.items()))


def _weights_of(
    method: str, transform_weight: float | None, map_weight: float | None, *, several: bool
) -> tuple[Sequence[float], Sequence[float]]:
    """Return the weights of transforms and of MAP to choose from; one that no prior has is zero."""
    transforms = _TRANSFORM_WEIGHTS if several else (_USUAL_TRANSFORM,)
    maps = _MAP_WEIGHTS if several else (_USUAL_MAP,)
    if transform_weight is not None:
        transforms = (transform_weight,)
    if map_weight is not None:
        maps = (map_weight,)
    return transforms if method.startswith("csmaplr") else (0.0,), maps if method.endswith("map") else (0.0,)


def held_out_score(walks: Sequence[LabeledWalk], model: GaitStates, settings: AdaptationSettings) -> float:
    """Return the mean log-likelihood per frame of walks that a model adapted to the others gives."""
    n_folds = min(_MOST_FOLDS, len(walks))
    total, n_frames = 0.0, 0
    for fold in range(n_folds):
        adapted = adapt_states([part for at, part in enumerate(walks) if at % n_folds != fold], model, settings).model
        for walk in walks[fold::n_folds]:
            total += score_walk(walk, adapted)
            n_frames += walk.n_frames
    return total / n_frames


def _best(
    walks: Sequence[LabeledWalk],
    model: GaitStates,
    candidates: Sequence[AdaptationSettings],
    scores: dict[tuple[float, float], float],
) -> AdaptationSettings:
    """Return the settings of the largest score, the last of equal ones, and keep all scores."""
    weights = [(settings.transform_weight, settings.map_weight) for settings in candidates]
    for pair, settings in zip(weights, candidates, strict=True):
        if pair not in scores:
            scores[pair] = held_out_score(walks, model, settings)
    found = [scores[pair] for pair in weights]
    return candidates[len(found) - 1 - int(np.argmax(found[::-1]))]
