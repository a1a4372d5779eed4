"""A style between two styles, or beyond them."""

from copy import copy
from typing import Any

import numpy as np

from eigenwalker.hsmm.estimation import StateParameters
from eigenwalker.hsmm.gait_generation import moments_in_channels
from eigenwalker.hsmm.gait_hsmm import GaitHSMM
from eigenwalker.hsmm.gait_states import GaitStates
from eigenwalker.hsmm.transforms import identity_transform

__all__ = ["blend"]


def blend(one: GaitHSMM, other: GaitHSMM, weight: float) -> GaitHSMM:
    """Return the model between two that were adapted from the same average model, or one of which is that model.

    State by state means of channels and of durations are interpolated along a line, and variances along a line of their
    logarithms, so that they stay positive beyond the two; so are the variances over time.

    Parameters
    ----------
    one, other : GaitHSMM
        Fitted or adapted.
    weight : float
        0 is `one`, 1 is `other`; beyond, the difference is exaggerated.

    Returns
    -------
    GaitHSMM
        Without transforms: its states describe the channels themselves.

    Raises
    ------
    ValueError
        If the models do not share their states or channels, or the weight is not finite.

    References
    ----------
    Tilmanne, Moinet & Dutoit 2012, section 7, names interpolation of styles as what the models are for.

    Examples
    --------
    >>> from eigenwalker.hsmm import GaitHSMM, blend
    >>> average = GaitHSMM().fit(neutral_walks)  # doctest: +SKIP
    >>> half_sad = blend(average, average.adapt(sad_walks), 0.5)  # doctest: +SKIP
    """
    if not np.isfinite(weight):
        raise ValueError(f"weight must be finite, got {weight!r}")
    models = [model._states() for model in (one, other)]
    _check_shared(*models)
    _check_same_walks(one, other)
    (means, variances), (other_means, other_variances) = (moments_in_channels(model) for model in models)
    mine, theirs = (model.parameters for model in models)
    parameters = StateParameters(
        _along(means, other_means, weight),
        np.exp(_along(np.log(variances), np.log(other_variances), weight)),
        np.maximum(_along(mine.duration_means, theirs.duration_means, weight), 1.0),
        np.exp(_along(np.log(mine.duration_variances), np.log(theirs.duration_variances), weight)),
    )
    n_channels = one.transforms_.shape[1]
    blended = copy(one)
    blended._keep_states(
        models[0]._replace(
            parameters=parameters,
            transforms=(identity_transform(n_channels),),
            classes=np.zeros(len(means), dtype=np.int64),
        )
    )
    tiny = np.finfo(np.float64).tiny
    mine_over_time, theirs_over_time = (np.log(np.maximum(model.global_variance_, tiny)) for model in (one, other))
    blended.global_variance_ = np.exp(_along(mine_over_time, theirs_over_time, weight))
    blended.walking_speed_ = float(_along(one.walking_speed_, other.walking_speed_, weight))
    blended.timing_share_ = float(np.clip(_along(one.timing_share_, other.timing_share_, weight), 0.0, 1.0))
    blended.is_canonical_ = one.is_canonical_ or other.is_canonical_
    for attribute in ("adaptation_", "history_", "n_iter_", "converged_"):  # it was not trained
        blended.__dict__.pop(attribute, None)
    return blended


def _along(one: Any, other: Any, weight: float) -> Any:
    return (1.0 - weight) * one + weight * other


def _check_same_walks(one: GaitHSMM, other: GaitHSMM) -> None:
    """Raise unless both models are of the same channels at the same frame rate."""
    rates = one.frame_rate_, other.frame_rate_
    names = [None if model.template_ is None else model.template_.channel_names for model in (one, other)]
    if names[0] != names[1] or not np.isclose(*rates, rtol=1e-4, equal_nan=True):
        raise ValueError(
            "expected two models adapted from one average model, of the same channels at one frame rate, got "
            f"{rates[0]:g} and {rates[1]:g} frames per second{'' if names[0] == names[1] else ' and other channels'}"
        )


def _check_shared(one: GaitStates, other: GaitStates) -> None:
    """Raise unless states of the same number mean the same."""
    same = (
        np.array_equal(one.states, other.states)
        and np.array_equal(one.duration_states, other.duration_states)
        and one.parameters.means.shape == other.parameters.means.shape
        and [tuple(window) for window in one.windows] == [tuple(window) for window in other.windows]
    )
    if not same:
        raise ValueError(
            "expected two models adapted from one average model, whose states correspond, got models with "
            f"{len(one.parameters.means)} and {len(other.parameters.means)} states that are tied differently; fit one "
            "average model and adapt it to both styles"
        )
