"""From an average model and some steps to a model of their style: what `GaitHSMM.adapt` does."""

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import check_choice
from eigenwalker.hsmm.adaptation import METHODS, AdaptationSettings, adapt_states
from eigenwalker.hsmm.gait_states import GaitStates
from eigenwalker.hsmm.labeled_walks import LabeledWalk
from eigenwalker.hsmm.transform_estimation import StandardUnits
from eigenwalker.hsmm.weight_choice import choose_weights

__all__ = ["adapt_model", "mixed_channels", "units_of_states"]

_LEAST_SCALE = 1e-3  # radians, of a channel that hardly moves
_DURATION_WEIGHT = 3.0  # steps


def adapt_model(
    walks: Sequence[LabeledWalk],
    model: GaitStates,
    *,
    method: str,
    weights: tuple[float | None, float | None],
    n_classes: int,
    mixing: str,
    max_iter: int,
    floors: NDArray[np.float64],
    noise: float,
    duration_floor: float,
    n_jobs: int | None = None,
) -> tuple[GaitStates, dict[str, Any]]:
    """Return the adapted states, and how they were adapted; arguments as of `GaitHSMM.adapt`.

    Parameters
    ----------
    walks : sequence of LabeledWalk
        Of the style.
    model : GaitStates
        Of the average walk.
    weights : tuple of float or None
        Of the priors of transforms and of MAP.
    floors, noise, duration_floor
        See `AdaptationSettings`.
    """
    check_choice(method, METHODS, name="method")
    check_choice(mixing, ("joints", "all", "none"), name="mixing")
    _check_numbers(weights, n_classes, max_iter)
    n_channels = walks[0].channels.shape[1]
    settings = AdaptationSettings(
        method=method,
        transform_weight=0.0,
        map_weight=0.0,
        duration_weight=_DURATION_WEIGHT,
        n_classes=n_classes,
        max_iter=max_iter,
        blocks=mixed_channels(n_channels, mixing),
        units=units_of_states(model, n_channels),
        floors=floors,
        noise=noise,
        duration_floor=duration_floor,
        n_jobs=n_jobs,
    )
    chosen = choose_weights(walks, model, settings, transform_weight=weights[0], map_weight=weights[1])
    adapted = adapt_states(walks, model, chosen.settings)
    if adapted.n_used < adapted.n_wanted:
        warnings.warn(
            f"{adapted.n_frames:.0f} frames are too few for {adapted.n_wanted} classes of states with transforms of "
            f"their own: took {adapted.n_used or 'none'}; give more steps, or a smaller n_classes",
            stacklevel=3,
        )
    return adapted.model, {
        "method": method,
        "transform_weight": chosen.settings.transform_weight,
        "map_weight": chosen.settings.map_weight,
        "mixing": mixing,
        "n_classes_wanted": adapted.n_wanted,
        "n_classes": adapted.n_used,
        "n_frames": adapted.n_frames,
        "held_out": chosen.scores,
    }


def mixed_channels(n_channels: int, mixing: str) -> list[NDArray[np.int64]]:
    """Return the channels that a transform mixes with each other: "joints", "all" or "none".

    Raises
    ------
    ValueError
        If channels are not three a joint.

    Examples
    --------
    >>> [block.tolist() for block in mixed_channels(6, "joints")]
    [[0, 1, 2], [3, 4, 5]]
    """
    if mixing == "joints" and n_channels % 3:
        raise ValueError(
            f"mixing='joints' takes three channels a joint, got {n_channels} channels; take mixing='none' or 'all'"
        )
    size = {"joints": 3, "all": n_channels, "none": 1}[mixing]
    return list(np.arange(n_channels).reshape(-1, size))  # (n_blocks, size)


def units_of_states(model: GaitStates, n_channels: int) -> StandardUnits:
    """Return mean and standard deviation of each static channel over the states, in which transforms are compared."""
    means, variances = model.parameters.means[:, :n_channels], model.parameters.variances[:, :n_channels]
    scales = np.sqrt(means.var(axis=0) + variances.mean(axis=0))
    return StandardUnits(means.mean(axis=0), np.maximum(scales, _LEAST_SCALE))


def _check_numbers(weights: tuple[float | None, float | None], n_classes: int, max_iter: int) -> None:
    faults = [
        f"{name} must be zero or more, or None, got {weight!r}"
        for name, weight in zip(("transform_weight", "map_weight"), weights, strict=True)
        if weight is not None and not weight >= 0
    ]
    faults += [
        f"{name} must be 1 or more, got {value!r}"
        for name, value in (("n_classes", n_classes), ("max_iter", max_iter))
        if value < 1
    ]
    if faults:
        raise ValueError("\n".join(faults))
