"""Walks that nobody has walked: along trait axes, and with the structure of one walker and the dynamics of another."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.pipeline import Pipeline

from eigenwalker.model.blocks import in_part
from eigenwalker.model.eigenwalkers import split_model, trait_axes
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.stepping import Start, check_traits, label_of, start_from, step_from, trait_name
from eigenwalker.motion.limits import warn_joint_limits
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["hybrid_walk", "walk_along_axis", "walk_at"]


def walk_along_axis(
    model: Pipeline,
    trait: str | int,
    alphas: ArrayLike,
    base: Walk | JointWalk | None = None,
    *,
    hold: Sequence[str] = (),
    part: str | None = None,
) -> list[Walk | JointWalk]:
    """Return walks along a trait axis (Troje 2002, Eq. 6).

    Parameters
    ----------
    model : Pipeline
        Fitted, from `make_eigenwalkers` or with the same kinds of steps.
    trait : str or int
        Name or position of the trait.
    alphas : array-like of shape (n_walks,)
        Positions on the axis, in the trait step's `alpha_unit`.
    base : Walk or JointWalk, default None
        The walk that is changed. None is the average walker, alpha = 0 on every axis.
    hold : sequence of str, default ()
        Traits that stay as they are in the base; all others are free to go along.
    part : {"structure", "dynamics"}, default None
        What is moved, see `feature_parts`; the other part stays that of the base. Such a walk has only a part of its
        alpha, that which `axis_shares` speaks of. None moves both.

    Returns
    -------
    list of Walk or JointWalk
        On the treadmill. With a base they are base + step(alpha - alpha of the base): each *has* its alpha, and keeps
        all else of the base, including what the Eigenwalkers leave out.

    Raises
    ------
    ValueError
        If a trait or part is unknown, or an alpha is not finite or so far out that the frequency is not positive; the
        error says how far alpha can go.

    Warns
    -----
    OutsideDataWarning
        If walks lie further from the training walkers than 99 % of walkers of their kind; see
        `TraitRegressor.distance_limit`.
    JointLimitWarning
        If joints of joint walks turn further than those of people; see `joint_limits_exceeded`.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.model import make_eigenwalkers, walk_along_axis
    >>> walkers = make_walkers(24, random_state=0)
    >>> model = make_eigenwalkers(n_components=5).fit(walkers.data, walkers.target["weight"])
    >>> light, heavy = walk_along_axis(model, "weight", [-2, 2], base=walkers.data[0])
    >>> model.transform([light, heavy]).round(6).ravel()
    array([-2.,  2.])
    """
    name = trait_name(model, trait)
    alphas = np.asarray(alphas, dtype=np.float64)
    if alphas.ndim != 1:
        raise ValueError(f"alphas must have shape (n_walks,), got {alphas.shape}")
    return _walks(model, [name], alphas[:, np.newaxis], base, hold, part)


def walk_at(
    model: Pipeline,
    alphas: Mapping[str, float],
    base: Walk | JointWalk | None = None,
    *,
    hold: Sequence[str] = (),
    part: str | None = None,
) -> Walk | JointWalk:
    """Return the walk that has given positions on several trait axes at once.

    Parameters
    ----------
    model : Pipeline
        Fitted; see `walk_along_axis`.
    alphas : mapping of str to float
        Position on each specified axis.
    base : Walk or JointWalk, default None
        The walk that is changed. None is the average walker.
    hold : sequence of str, default ()
        Traits that stay as they are in the base; all others are free to go along.
    part : {"structure", "dynamics"}, default None
        See `walk_along_axis`, as for errors and warnings.

    Returns
    -------
    Walk or JointWalk
        On the treadmill.
    """
    if not alphas:
        raise ValueError("alphas must have one trait or more, {'happy': 1.0}, got none")
    names = [trait_name(model, name) for name in alphas]
    values = np.array([list(alphas.values())], dtype=np.float64)
    return _walks(model, names, values, base, hold, part)[0]


def hybrid_walk(
    model: Pipeline | FourierLinearizer, *, structure: Walk | JointWalk, dynamics: Walk | JointWalk
) -> Walk | JointWalk:
    """Return a walk with the structure of one walker and the dynamics of another.

    Parameters
    ----------
    model : Pipeline or FourierLinearizer
        Fitted; of a Pipeline its steps up to the linearizer.
    structure : Walk or JointWalk
        Gives mean posture and size.
    dynamics : Walk or JointWalk
        Gives harmonics, frequency and speed.

    Returns
    -------
    Walk or JointWalk
        On the treadmill.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.model import FourierLinearizer, hybrid_walk
    >>> one, other = make_walkers(2, random_state=0).data
    >>> linearizer = FourierLinearizer().fit([one, other])
    >>> vector = linearizer.transform([hybrid_walk(linearizer, structure=one, dynamics=other)])
    >>> bool(abs(vector - linearizer.transform([one]))[0, :45].max() < 1e-9)
    True
    """
    before, linearizer = split_model(model)[:2] if isinstance(model, Pipeline) else (None, model)
    pair = [structure, dynamics] if before is None else before.transform([structure, dynamics])
    vectors = np.asarray(linearizer.transform(pair))
    is_structure = in_part(linearizer.get_feature_names_out(), "structure")
    walk = linearizer.inverse_transform(np.where(is_structure, *vectors)[np.newaxis])[0]
    owners = {"size": pair[0], "speed": pair[1]}
    kept: dict[str, Any] = {name: getattr(owner, name) for name, owner in owners.items()}
    kept = {name: value for name, value in kept.items() if name not in linearizer.extras}
    return replace(walk, name=f"structure of {structure.name}, dynamics of {dynamics.name}", **kept)


def _start(model: Pipeline, base: Walk | JointWalk | None) -> Start:
    before, _, reduction = split_model(model)
    if base is None:
        score = model[-1].mean_[np.newaxis]
        return Start(np.zeros((1, len(model[-1].trait_names_))), score, reduction.inverse_transform(score), {})
    return start_from(model, before.transform([base])[0] if before else base)


def _walks(
    model: Pipeline,
    names: list[str],
    alphas: NDArray[np.float64],
    base: Walk | JointWalk | None,
    hold: Sequence[str],
    part: str | None,
) -> list[Walk | JointWalk]:
    held = check_traits(model, names, alphas, hold)
    if not len(alphas):
        return []
    start = _start(model, base)
    own = start.alphas[:, [trait_axes(model).trait_names_.index(name) for name in names]]
    labels = [label_of(names, row) for row in alphas]
    vectors = step_from(model, start, names, alphas - own, held, labels, part=part, stacklevel=5)
    walks = split_model(model)[1].inverse_transform(vectors)
    walks = [replace(walk, name=label, **start.kept) for walk, label in zip(walks, labels, strict=True)]
    warn_joint_limits(walks, stacklevel=4)
    return walks
