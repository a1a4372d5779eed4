"""What a page of walkers is told: one plain dictionary of words, numbers, and arrays written as text."""

import base64
import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.exceptions import NotFittedError
from sklearn.pipeline import Pipeline
from sklearn.utils.validation import check_is_fitted

from eigenwalker.display.body import check_drawable
from eigenwalker.model.blocks import in_part
from eigenwalker.model.eigenwalkers import split_model, trait_axes
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.traits import TraitRegressor
from eigenwalker.motion.skeleton import MarkerSet
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["check_alphas", "model_contents", "take_axes", "walk_contents"]

_UNITS = {"sd": "standard deviations", "label": "units of the label", "coefficient": "lengths of the filter"}
_DUST = 1e-12  # relative size of rounding
_REACH = 6.0  # of the sliders, in standard deviations of the training walkers


def take_axes(model: Pipeline) -> TraitRegressor:
    """Return the trait axes of a model.

    Parameters
    ----------
    model : Pipeline
        Fitted, from `make_eigenwalkers` or with the same kinds of steps.

    Raises
    ------
    TypeError, ValueError
        If there are none, or one has no direction.
    NotFittedError
        If the model is not fitted.
    """
    last = model[-1] if isinstance(model, Pipeline) else model
    if not hasattr(last, "trait_names_") and not hasattr(last, "alpha_unit"):
        raise TypeError(
            f"expected a model that ends with trait axes, TraitRegressor or TraitClassifier, got {type(last).__name__} "
            "at its end; fit make_eigenwalkers() to walks and labels, or give the walks themselves, view(walks)"
        )
    try:
        check_is_fitted(last)
    except NotFittedError:
        raise NotFittedError("expected a fitted model, got one that is not; call fit(walks, labels) first") from None
    axes = trait_axes(model)
    parts = zip(axes.trait_names_, axes.alpha_sd_, axes.intercept_, strict=True)
    flat = [name for name, spread, label in parts if not spread > _DUST * abs(label)]
    if flat or not axes.trait_names_:
        raise ValueError(
            f"expected at least one trait, all with a direction in which walkers differ, got none for "
            f"{', '.join(flat) or 'any'}; fit the model without them"
        )
    return axes


def model_contents(model: Pipeline, walks: Sequence[Walk | JointWalk] | None) -> dict[str, Any]:
    """Return what a page says of a model and of walkers that can be loaded into it.

    Positions are linear in the scores: features = center + scores . basis, with scores counted from the average
    walker. Alphas are filters . scores, and steps are what alpha = 1 on one trait moves when the others are free; the
    steps for several traits are combinations of these.

    Parameters
    ----------
    model : Pipeline
        Fitted, from `make_eigenwalkers` or with the same kinds of steps.
    walks : list of Walk or JointWalk, default None
        They go into the page as their scores, not as they are.

    Returns
    -------
    dict
        Ready for JSON. Arrays are float64, little-endian, as base64.

    Raises
    ------
    TypeError, ValueError
        If the model has no trait axes, or none that a body can be drawn along.
    NotFittedError
        If it is not fitted.
    """
    axes = take_axes(model)
    before, linearizer, reduction = split_model(model)
    mean, scores = axes.mean_[np.newaxis], np.empty((0, len(axes.mean_)))
    names: list[str] = []
    if walks is not None:
        names = _names(walks)
        scores = reduction.transform(linearizer.transform(before.transform(walks) if before else walks)) - mean
    center = reduction.inverse_transform(mean)
    basis = reduction.inverse_transform(mean + np.eye(mean.shape[1])) - center
    limit = axes.distance_limit()
    return {
        **_body(linearizer),
        "kind": "model",
        "names": names,
        "scores": _encode(scores),
        "center": _encode(center),
        "basis": _encode(basis),
        "traits": [_trait(axes, trait) for trait in range(len(axes.trait_names_))],
        "unit": _UNITS[axes.alpha_unit],
        "filters": _encode(axes.transform(mean + np.eye(mean.shape[1])).T),
        "steps": _encode(np.vstack([axes.step([[1.0]], [name]) for name in axes.trait_names_])),
        "whitener": _encode(_whitener(axes.covariance_)),
        "n_components": mean.shape[1],
        "distance_limit": limit if math.isfinite(limit) else None,
    }


def walk_contents(walks: Sequence[Walk], n_harmonics: int) -> dict[str, Any]:
    """Return what a page says of walks without a model: their Fourier coefficients.

    Each walk is an axis of its own, with the average of all walks as origin.

    Parameters
    ----------
    walks : list of Walk
        Prepared walks with the same markers.
    n_harmonics : int
        Number of harmonics.

    Returns
    -------
    dict
        As from `model_contents`, without traits.
    """
    linearizer = FourierLinearizer(n_harmonics).fit(walks)
    vectors = linearizer.transform(walks)
    center = vectors.mean(axis=0, keepdims=True)
    nothing = np.empty((0, len(vectors)))
    return {
        **_body(linearizer),
        "kind": "walks",
        "names": _names(walks),
        "scores": _encode(np.eye(len(vectors))),
        "center": _encode(center),
        "basis": _encode(vectors - center),
        "traits": [],
        "unit": "",
        **{name: _encode(nothing) for name in ("filters", "steps", "whitener")},
        "n_components": len(vectors),
        "distance_limit": None,
    }


def check_alphas(alphas: Mapping[str, float], traits: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Return alphas as numbers, or raise an error that lists all that are wrong.

    Parameters
    ----------
    alphas : mapping of str to float
        Positions on trait axes.
    traits : sequence of dict
        From `model_contents`.

    Raises
    ------
    TypeError, ValueError
        If it is no mapping; if a trait is unknown, or a number none, or beyond the slider.
    """
    if not isinstance(alphas, Mapping):
        raise TypeError(f"alphas must be a mapping such as {{'happy': 2.0}}, got {type(alphas).__name__}")
    reaches = {trait["name"]: trait["reach"] for trait in traits}
    faults = [f"no trait {name!r}" for name in alphas if name not in reaches]
    faults += [
        f"{name} = {value!r} is no number from {-reaches[name]:g} to {reaches[name]:g}"
        for name, value in alphas.items()
        if name in reaches and not _is_within(value, reaches[name])
    ]
    if faults:
        known = ", ".join(f"{name} (±{reach:g})" for name, reach in reaches.items()) or "none, it has no model"
        raise ValueError(f"alphas: {'; '.join(faults)}; the page has the traits {known}")
    return {name: float(value) for name, value in alphas.items()}


def _body(linearizer: FourierLinearizer) -> dict[str, Any]:
    """Return markers and sticks, and how features are made of them."""
    markers: MarkerSet = check_drawable(linearizer.template_)
    names = linearizer.get_feature_names_out()
    return {
        "markers": list(markers.names),
        "sticks": [[markers.index(start), markers.index(end)] for start, end in markers.sticks],
        "n_harmonics": int(linearizer.n_harmonics),
        "n_features": len(names),
        "structure": "".join("1" if structure else "0" for structure in in_part(names, "structure")),
    }


def _trait(axes: TraitRegressor, trait: int) -> dict[str, Any]:
    """Return the words of a trait, where its data end, and how far its slider goes."""
    name, alphas = axes.trait_names_[trait], axes.training_alphas()[:, trait]
    spread = axes.alpha_sd_[trait] / (axes.to_label(1.0, trait) - axes.to_label(0.0, trait))
    negative, positive = axes.poles_[name]
    reach = max(_REACH * spread, float(np.abs(alphas).max()))
    return {
        "name": name,
        "negative": str(negative),
        "positive": str(positive),
        "low": float(alphas.min()),
        "high": float(alphas.max()),
        "reach": _round_up(reach),
    }


def _round_up(value: float) -> float:
    """Return the next number of two digits."""
    size = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(round(value / size, 6)) * size:.12g}")


def _whitener(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the matrix that turns centered scores into standard deviations: |W s| is their Mahalanobis distance."""
    variances, directions = np.linalg.eigh(covariance)
    varies = variances > np.finfo(np.float64).eps * len(variances) * variances.max(initial=0.0)
    return (directions[:, varies] / np.sqrt(variances[varies])).T


def _names(walks: Sequence[Walk | JointWalk]) -> list[str]:
    return [walk.name or f"walk {number}" for number, walk in enumerate(walks, start=1)]


def _encode(array: ArrayLike) -> str:
    return base64.b64encode(np.ascontiguousarray(array, dtype="<f8").tobytes()).decode("ascii")


def _is_within(value: object, reach: float) -> bool:
    return isinstance(value, Real) and abs(float(value)) <= reach
