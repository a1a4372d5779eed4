"""Blocks of features: mean posture, harmonics, frequency; structure and dynamics; and how much each of them counts."""

from collections.abc import Collection, Iterable, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import check_choice

__all__ = ["PARTS", "block_weights", "feature_parts", "fitting_weights", "in_part", "take_weights"]

PARTS = ("structure", "dynamics")
_SCALARS = ("frequency", "speed", "size")
_STRUCTURE = ("mean", "size")


def feature_parts(names: Iterable[str]) -> NDArray[np.str_]:
    """Return to which part of a walk each feature belongs.

    Structure is the mean posture and size; dynamics are harmonics, frequency and speed.

    Parameters
    ----------
    names : iterable of str
        From `FourierLinearizer.get_feature_names_out`.

    Returns
    -------
    ndarray of str of shape (n_features,)
        "structure" or "dynamics".

    Examples
    --------
    >>> from eigenwalker.model import feature_parts
    >>> feature_parts(["mean_head_x", "sin1_head_x", "frequency"]).tolist()
    ['structure', 'dynamics', 'dynamics']
    """
    parts = ["structure" if name.split("_")[0] in _STRUCTURE else "dynamics" for name in names]
    return np.array(parts, dtype=np.str_)


def in_part(names: Collection[str], part: str | None) -> NDArray[np.bool_]:
    """Return which features are of a part; of the whole where it is None."""
    if part is None:
        return np.ones(len(names), dtype=bool)
    check_choice(part, PARTS, name="part")
    return feature_parts(names) == part


def block_weights(names: Iterable[str], weights: Mapping[str, float]) -> NDArray[np.float64]:
    """Return the weight of each feature.

    Parameters
    ----------
    names : iterable of str
        From `FourierLinearizer.get_feature_names_out`.
    weights : mapping of str to float
        Keys are "structure" and "dynamics"; blocks, "mean", "harmonic1" (or its halves "sin1" and "cos1"),
        "frequency", "speed", "size"; markers or joints, "left_wrist"; their channels, "left_wrist_x"; or single
        features, "cos1_left_wrist_x". 0 leaves out. Weights of a feature with several keys are multiplied.

    Returns
    -------
    ndarray of shape (n_features,)
        1 where nothing is said.

    Raises
    ------
    ValueError
        If a key fits no feature, a weight is negative or not a number, or nothing is left; all faults at once.

    Examples
    --------
    >>> from eigenwalker.model import block_weights
    >>> block_weights(["mean_head_x", "mean_hip_x", "sin1_head_x", "frequency"], {"structure": 0.5, "head": 0})
    array([0. , 0.5, 0. , 1. ])
    """
    keys = [_keys(name) for name in names]
    known = dict.fromkeys(key for several in keys for key in several)
    faults = [f"{key!r} fits no feature" for key in weights if key not in known]
    faults += [f"{key!r} has the weight {value!r}" for key, value in weights.items() if not _is_weight(value)]
    if faults:
        shown = [key for key in known if key.count("_") < 2][:30]
        raise ValueError(
            f"weights: {'; '.join(faults)}; expected numbers of 0 or more for any of {', '.join(shown)} ..., "
            "or for channels or single features"
        )
    found = np.array([np.prod([weights.get(key, 1.0) for key in several]) for several in keys])
    return _check_any(found)


def _is_weight(value: object) -> bool:
    return isinstance(value, int | float | np.integer | np.floating) and bool(0 <= value < np.inf)


def fitting_weights(
    names: Iterable[str], weights: Mapping[str, float] | ArrayLike | None
) -> Mapping[str, float] | ArrayLike | None:
    """Return weights by name without those that fit no feature; other weights as they are."""
    if not isinstance(weights, Mapping):
        return weights
    known = {key for name in names for key in _keys(name)}
    return {key: value for key, value in weights.items() if key in known}


def _keys(name: str) -> tuple[str, ...]:
    """Return the words by which a feature can be meant: its part, its block, its marker, its channel, itself."""
    part = str(feature_parts([name])[0])
    block, _, channel = name.partition("_")
    if name in _SCALARS:
        return part, name
    harmonic = (f"harmonic{block[3:]}",) if block[:3] in ("sin", "cos") else ()
    return part, *harmonic, block, channel.rpartition("_")[0], channel, name


def take_weights(
    weights: Mapping[str, float] | ArrayLike | None, n_features: int, names: Iterable[str] | None
) -> NDArray[np.float64]:
    """Return the weight of each feature from what a caller gives; None is 1 for all.

    Raises
    ------
    ValueError
        If there are names, but not of the features, or if the weights are wrong.
    """
    if weights is None:
        return np.ones(n_features)
    if isinstance(weights, Mapping):
        if names is None:
            raise ValueError(
                f"weights by name, {', '.join(weights)}, need features with names, but these have none; call "
                "linearizer.set_output(transform='pandas'), or give one number a feature"
            )
        return block_weights(names, weights)
    found = np.asarray(weights, dtype=np.float64)
    if found.shape != (n_features,) or not ((found >= 0) & np.isfinite(found)).all():
        raise ValueError(
            f"weights must be {n_features} numbers of 0 or more, got {np.array2string(found, threshold=6)}"
        )
    return _check_any(found)


def _check_any(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    if not weights.any():
        raise ValueError("weights leave no feature in; at least one must be above 0")
    return weights
