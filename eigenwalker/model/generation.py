"""Walks that nobody has walked: along trait axes, and with the structure of one walker and the dynamics of another."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from sklearn.pipeline import Pipeline

from eigenwalker._validation import check_choice
from eigenwalker.model._guards import distances, warn_outside
from eigenwalker.model.blocks import in_part
from eigenwalker.model.eigenwalkers import split_model, trait_axes
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.motion.limits import warn_joint_limits
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["hybrid_walk", "walk_along_axis", "walk_at", "with_names"]


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
    name = _trait_name(model, trait)
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
    names = [_trait_name(model, name) for name in alphas]
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


class _Start(NamedTuple):
    """Where a step begins: alphas, score and vector, shape (1, ...), and what the features do not hold."""

    alphas: NDArray[np.float64]
    score: NDArray[np.float64]
    vector: NDArray[np.float64]
    kept: dict[str, Any]


def _start(model: Pipeline, base: Walk | JointWalk | None) -> _Start:
    before, linearizer, reduction = split_model(model)
    if base is None:
        score = model[-1].mean_[np.newaxis]
        return _Start(np.zeros((1, len(model[-1].trait_names_))), score, reduction.inverse_transform(score), {})
    base = before.transform([base])[0] if before else base
    vector = linearizer.transform([base])
    kept = {name: getattr(base, name) for name in ("speed", "size") if name not in linearizer.extras}
    score = reduction.transform(vector)
    return _Start(np.asarray(model[-1].transform(score)), np.asarray(score), np.asarray(vector), kept)


def _walks(
    model: Pipeline,
    names: list[str],
    alphas: NDArray[np.float64],
    base: Walk | JointWalk | None,
    hold: Sequence[str],
    part: str | None,
) -> list[Walk | JointWalk]:
    if isinstance(hold, str):
        raise ValueError(f"hold must be a sequence of traits, ({hold!r},), got {hold!r}")
    if not np.isfinite(alphas).all():
        raise ValueError(f"alphas must be finite, got {', '.join(map(str, alphas[~np.isfinite(alphas)]))}")
    hold = list(dict.fromkeys(_trait_name(model, held) for held in hold))
    both = sorted(set(names) & set(hold))
    if both:
        raise ValueError(f"a trait is either set or held, got both for {', '.join(both)}")
    if not len(alphas):
        return []
    axes, specified = trait_axes(model), [*names, *hold]
    _, linearizer, reduction = split_model(model)
    start = _start(model, base)
    own = start.alphas[:, [axes.trait_names_.index(name) for name in specified]]
    wanted = np.hstack((alphas, np.tile(own[:, len(names) :], (len(alphas), 1))))
    scores = start.score + axes.step(wanted - own, specified)
    # What the Eigenwalkers leave out of the base stays.
    changes = reduction.inverse_transform(scores) - reduction.inverse_transform(start.score)
    features = linearizer.get_feature_names_out()
    vectors = start.vector + np.where(in_part(features, part), changes, 0.0)
    labels = [_label(names, row) for row in alphas]
    column = list(features).index("frequency")
    _check_reachable(start.vector[0, column], vectors[:, column], own[0, : len(names)], alphas, labels)
    # With a part alone these are not the scores stepped to.
    reached = np.asarray(reduction.transform(with_names(vectors, features, reduction)))
    warn_outside(distances(reached - axes.mean_, axes.covariance_), axes.distance_limit(), labels, stacklevel=4)
    walks = linearizer.inverse_transform(vectors)
    walks = [replace(walk, name=label, **start.kept) for walk, label in zip(walks, labels, strict=True)]
    warn_joint_limits(walks, stacklevel=4)
    return walks


def with_names(vectors: NDArray[np.float64], names: NDArray[np.object_], steps: Pipeline) -> ArrayLike:
    """Return vectors as steps were fitted to them: with the names of features, or without."""
    return pd.DataFrame(vectors, columns=names) if hasattr(steps[0], "feature_names_in_") else vectors


def _check_reachable(
    frequency: float,
    frequencies: NDArray[np.float64],
    own: NDArray[np.float64],
    alphas: NDArray[np.float64],
    labels: list[str],
) -> None:
    """Raise if a walk's frequency is not positive, and say which alphas, on the way to it, come near to 0."""
    worst = int(np.argmin(frequencies))
    if frequencies[worst] > 0:
        return
    reach = own + (alphas[worst] - own) * frequency / (frequency - frequencies[worst])  # frequency is linear in alpha
    raise ValueError(
        f"{labels[worst]}: no walk lies that far out, its frequency would be {frequencies[worst]:.3g} Hz; on the way "
        f"there it becomes 0 at alpha = {', '.join(f'{alpha:.3g}' for alpha in reach)}, stay well before that"
    )


def _label(names: list[str], alphas: NDArray[np.float64]) -> str:
    return ", ".join(f"{name} {alpha:+g}" if alpha else f"{name} 0" for name, alpha in zip(names, alphas, strict=True))


def _trait_name(model: Pipeline, trait: str | int) -> str:
    names = model[-1].trait_names_
    if isinstance(trait, int) and not isinstance(trait, bool):
        if not -len(names) <= trait < len(names):
            raise ValueError(f"trait must be a position below {len(names)} or one of {names}, got {trait}")
        return names[trait]
    check_choice(trait, names, name="trait")
    return str(trait)
