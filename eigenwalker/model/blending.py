"""Blends of walks and of styles: between them, and beyond."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.pipeline import Pipeline

from eigenwalker._validation import WalkError, check_walks
from eigenwalker.model._guards import distances, warn_outside
from eigenwalker.model.eigenwalkers import split_model, trait_axes
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.stepping import with_names
from eigenwalker.motion.limits import warn_joint_limits
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["blend"]

_ROUNDING = 1e-6  # by which the sum of the weights may differ from one


def blend(
    walks: Sequence[Walk | JointWalk] | Mapping[str, Walk | JointWalk | Sequence[Walk | JointWalk]],
    weights: Sequence[float] | Mapping[str, float],
    *,
    labels: ArrayLike | None = None,
    model: Pipeline | FourierLinearizer | None = None,
) -> Walk | JointWalk:
    r"""Return a blend of walks, or of styles: between them, or beyond them.

    .. math:: x = \sum_i w_i x_i, \quad \sum_i w_i = 1

    with the vectors x_i of walks, in the same phase (`FourierLinearizer`), or the mean vectors of the walks of each
    style. Weights from 0 to 1 lie between; one above 1, with others below 0, exaggerates: 1.5 sad and -0.5 normal goes
    on from normal past sad. Frequency is blended with the rest.

    Parameters
    ----------
    walks : list of Walk or JointWalk, or mapping of str to walks
        Prepared, of one kind, with the same channels. A mapping has the walks of each style, or one walk.
    weights : sequence of float, or mapping of str to float
        One a walk; or one a style, by its label, where styles that are not named have none. They sum to one.
    labels : array-like of shape (n_walks,), default None
        The style of each walk of a list, for weights of styles.
    model : Pipeline or FourierLinearizer, default None
        Fitted; it says how many harmonics there are, how long the walk becomes, and what its other features are. Of a
        Pipeline the steps up to the linearizer count, and its traits for the warning. None is a `FourierLinearizer`
        with its defaults.

    Returns
    -------
    Walk or JointWalk
        On the treadmill, called "0.5 sad + 0.5 happy", of the kind of the walks. `speed` and `size` are blended; speed
        is NaN where one is unknown, or where it would be negative. Skeleton, bones and the place of the root of joint
        walks are those of the model's template, without a model those of the first walk with a weight.

    Raises
    ------
    TypeError
        If walks of both kinds are mixed, or weights do not go with walks.
    ValueError
        If weights are not finite, do not sum to one, name an unknown style or are not as many as walks; if frequency or
        size of the blend would not be positive; as the linearizer.

    Warns
    -----
    OutsideDataWarning
        If the model has trait axes, and the blend lies further from the training walkers than 99 % of their kind.
    JointLimitWarning
        If joints of the blend turn further than those of people, see `joint_limits_exceeded`.

    Examples
    --------
    >>> from eigenwalker import blend, make_walkers
    >>> one, other, third = make_walkers(3, random_state=0).data
    >>> blend([one, other], [0.5, 0.5]).name
    '0.5 walker_000 + 0.5 walker_001'
    >>> beyond = blend({"sad": [one, third], "normal": [other]}, {"sad": 1.5, "normal": -0.5})
    >>> beyond.name
    '1.5 sad - 0.5 normal'
    """
    groups = _of_styles(walks, weights, labels) if _has_styles(walks, labels) else _of_walks(walks, weights)
    _check_sum([group.weight for group in groups])
    groups = [group for group in groups if group.weight]
    members = [walk for group in groups for walk in group.walks]
    _check_alike(members)
    linearizer, members = _linearize_with(model, members)
    shares = np.concatenate([np.full(len(group.walks), group.weight / len(group.walks)) for group in groups])
    vector = shares @ np.asarray(linearizer.transform(members))
    name = _name(groups)
    fields = _other_fields(name, linearizer, members, shares, vector)
    if isinstance(model, Pipeline) and hasattr(model[-1], "trait_names_"):
        _warn_distance(model, vector, name)
    blended = replace(linearizer.inverse_transform(vector[np.newaxis])[0], name=name, **fields)
    warn_joint_limits([blended])
    return blended


class _Group(NamedTuple):
    """Walks whose mean has a weight."""

    name: str
    walks: list[Any]
    weight: float


def _has_styles(walks: object, labels: ArrayLike | None) -> bool:
    if isinstance(walks, Mapping) and labels is not None:
        raise TypeError(
            "labels go with a list of walks; the keys of a mapping say already of which style its walks are"
        )
    return isinstance(walks, Mapping) or labels is not None


def _of_walks(walks: Any, weights: Any) -> list[_Group]:
    """Return every walk of a list as a group of its own."""
    listed = check_walks(walks, kind=(Walk, JointWalk))
    if isinstance(weights, Mapping):
        raise TypeError(
            "weights of styles need walks of styles, {'sad': [walk, ...], ...}, or labels, one a walk; for a list of "
            f"walks alone give a list of weights, got {weights!r}"
        )
    values = np.asarray(weights, dtype=np.float64)
    if values.shape != (len(listed),):
        raise ValueError(f"weights must have shape ({len(listed)},), one a walk, got {values.shape}")
    return [
        _Group(walk.name or f"walk {place}", [walk], weight)
        for place, (walk, weight) in enumerate(zip(listed, values.tolist(), strict=True))
    ]


def _of_styles(walks: Any, weights: Any, labels: ArrayLike | None) -> list[_Group]:
    """Return the walks of each style that has a weight as a group."""
    styles = dict(walks) if isinstance(walks, Mapping) else _by_label(walks, labels)
    if not isinstance(weights, Mapping):
        raise TypeError(f"weights of styles must be a mapping, {{{next(iter(styles), 'sad')!r}: 1.0}}, got {weights!r}")
    unknown = [style for style in weights if style not in styles]
    if unknown:
        raise ValueError(
            f"weights name {', '.join(map(repr, unknown))}, but there are walks of {', '.join(map(repr, styles))} only"
        )
    found = {style: styles[style] for style in weights}
    found = {style: [one] if isinstance(one, (Walk, JointWalk)) else one for style, one in found.items()}
    return [
        _Group(str(style), check_walks(found[style], kind=(Walk, JointWalk)), float(weight))
        for style, weight in weights.items()
    ]


def _by_label(walks: Any, labels: Any) -> dict[Any, list[Any]]:
    listed, owners = check_walks(walks, kind=(Walk, JointWalk)), np.asarray(labels, dtype=object).tolist()
    if len(owners) != len(listed):
        raise ValueError(f"labels must have one style a walk, {len(listed)}, got {len(owners)}")
    styles: dict[Any, list[Any]] = {}
    for owner, walk in zip(owners, listed, strict=True):
        styles.setdefault(owner, []).append(walk)
    return styles


def _check_sum(weights: Sequence[float]) -> None:
    total = sum(weights)
    if not abs(total - 1) <= _ROUNDING:  # also NaN
        raise ValueError(
            "weights must be finite and sum to one, so that the blend of a walk with itself is that walk, got "
            f"{', '.join(f'{weight:g}' for weight in weights)}, sum {total:g}"
        )


def _check_alike(walks: Sequence[Walk | JointWalk]) -> None:
    """Raise if walks are of both kinds, or some joints count from the axes of a file."""
    kinds = sorted({type(walk).__name__ for walk in walks})
    if len(kinds) > 1:
        raise TypeError(f"walks must be of one kind, got {' and '.join(kinds)}; prepare all with one representation")
    axes = {walk.skeleton.upright for walk in walks if isinstance(walk, JointWalk)}
    if len(axes) > 1:
        raise WalkError(
            "joints must count from one posture, but only some of the walks are upright; prepare all of them with "
            "representation='joints'"
        )


def _linearize_with(
    model: Pipeline | FourierLinearizer | None, walks: list[Any]
) -> tuple[FourierLinearizer, list[Walk | JointWalk]]:
    """Return the fitted linearizer, and the walks as the steps before it leave them."""
    if model is None:
        return FourierLinearizer().fit(walks), walks
    if not isinstance(model, Pipeline):
        return model, walks
    before, linearizer, _ = split_model(model)
    return linearizer, before.transform(walks) if before else walks


def _name(groups: Sequence[_Group]) -> str:
    """Return "1.5 sad - 0.5 normal"."""
    terms = [f"{'-' if group.weight < 0 else '+'} {abs(group.weight):g} {group.name}" for group in groups]
    return " ".join(terms).removeprefix("+ ")


def _other_fields(
    name: str,
    linearizer: FourierLinearizer,
    walks: Sequence[Walk | JointWalk],
    shares: NDArray[np.float64],
    vector: NDArray[np.float64],
) -> dict[str, Any]:
    """Return speed and size beside those that the vector has, or raise if the blend cannot be walked."""
    features = list(linearizer.get_feature_names_out())
    known = dict(zip(features, vector, strict=True))
    kept = {
        field: float(shares @ [getattr(walk, field) for walk in walks])
        for field in ("speed", "size")
        if field not in linearizer.extras
    }
    known |= kept
    faults = [f"its frequency would be {known['frequency']:.3g} Hz"] if known["frequency"] <= 0 else []
    faults += [f"its size would be {known['size']:.3g}"] if known["size"] <= 0 else []
    if faults:
        raise ValueError(f"{name}: no walk lies that far out, {', '.join(faults)}; use weights nearer to 0 and 1")
    return kept | ({"speed": float("nan")} if known["speed"] < 0 else {})


def _warn_distance(model: Pipeline, vector: NDArray[np.float64], name: str) -> None:
    axes, (_, linearizer, reduction) = trait_axes(model), split_model(model)
    scores = reduction.transform(with_names(vector[np.newaxis], linearizer.get_feature_names_out(), reduction))
    warn_outside(
        distances(np.asarray(scores) - axes.mean_, axes.covariance_), axes.distance_limit(), [name], stacklevel=4
    )
