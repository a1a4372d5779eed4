"""The whole model as one Pipeline, and walks along its axes (Troje 2002, sections 2 and 3)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, clone
from sklearn.decomposition import PCA
from sklearn.pipeline import Pipeline

from eigenwalker._validation import check_choice
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.scaling import BlockScaler
from eigenwalker.model.traits import TraitRegressor
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["make_eigenwalkers", "walk_along_axis", "walk_at"]


def make_eigenwalkers(
    n_harmonics: int = 2,
    n_components: int | float | None = 15,
    *,
    scaling: str | None = "blocks",
    trait: BaseEstimator | None = None,
    extras: Sequence[str] = (),
) -> Pipeline:
    """Return the Pipeline from walks to traits: linearizer, scaler, eigenwalkers, trait.

    Every step has an exact inverse, the projection on the Eigenwalkers apart, so that
    ``model.inverse_transform([[2.0]])`` is a walk with alpha = 2.

    Parameters
    ----------
    n_harmonics : int, default 2
        Of `FourierLinearizer`.
    n_components : int, float or None, default 15
        Of `sklearn.decomposition.PCA`: how many Eigenwalkers, or the share of variance they hold.
    scaling : {"blocks", "features", "noise", None}, default "blocks"
        `BlockScaler`: what is brought to one scale before PCA. "noise" is for noisy sensors and several walks a person,
        ``fit(walks, y, scaler__groups=persons)``. None leaves metres and hertz as they are, and there is no step
        `scaler`.
    trait : TraitRegressor or TraitClassifier, default None
        The last step; a clone of it is taken. None is `TraitRegressor()`.
    extras : sequence of {"speed", "size"}, default ()
        Further features of `FourierLinearizer`.

    Returns
    -------
    sklearn.pipeline.Pipeline

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.model import make_eigenwalkers
    >>> walkers = make_walkers(24, random_state=0)
    >>> model = make_eigenwalkers(n_components=5).fit(walkers.data, walkers.target["gender"])
    >>> walk = model.inverse_transform([[2.0]])[0]
    >>> model.transform([walk]).round(6)
    array([[2.]])
    """
    check_choice(scaling, ("blocks", "features", "noise", None), name="scaling")
    steps = [("linearizer", FourierLinearizer(n_harmonics, extras=tuple(extras)))]
    if scaling is not None:
        steps.append(("scaler", BlockScaler(1 + len(tuple(extras)), unit=scaling)))
    steps.append(("eigenwalkers", PCA(n_components, svd_solver="full")))
    steps.append(("trait", TraitRegressor() if trait is None else clone(trait)))
    return Pipeline(steps)


def walk_along_axis(
    model: Pipeline,
    trait: str | int,
    alphas: ArrayLike,
    base: Walk | JointWalk | None = None,
    *,
    hold: Sequence[str] = (),
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

    Returns
    -------
    list of Walk or JointWalk
        On the treadmill. With a base they are base + step(alpha - alpha of the base): each *has* its alpha, and keeps
        all else of the base, including what the Eigenwalkers leave out.

    Raises
    ------
    ValueError
        If the trait is unknown, or an alpha is so far out that the frequency is not positive.

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
    return _walks(model, [name], alphas[:, np.newaxis], base, [_trait_name(model, held) for held in hold])


def walk_at(
    model: Pipeline,
    alphas: Mapping[str, float],
    base: Walk | JointWalk | None = None,
    *,
    hold: Sequence[str] = (),
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

    Returns
    -------
    Walk or JointWalk
        On the treadmill.
    """
    names = [_trait_name(model, name) for name in alphas]
    values = np.array([list(alphas.values())], dtype=np.float64)
    return _walks(model, names, values, base, [_trait_name(model, held) for held in hold])[0]


def _walks(
    model: Pipeline, names: list[str], alphas: NDArray[np.float64], base: Walk | JointWalk | None, hold: list[str]
) -> list[Walk | JointWalk]:
    both = sorted(set(names) & set(hold))
    if both:
        raise ValueError(f"a trait is either set or held, got both for {', '.join(both)}")
    trait, specified = model[-1], [*names, *hold]
    before, linearizer, reduction = _split(model)
    kept: dict[str, Any] = {}
    if base is None:
        score, rest = trait.mean_[np.newaxis], np.zeros(1)
        start = np.zeros(len(specified))
    else:
        base = before.transform([base])[0] if before else base
        vector = linearizer.transform([base])
        score = reduction.transform(vector)
        start = np.asarray(trait.transform(score))[0, [trait.trait_names_.index(name) for name in specified]]
        score = np.asarray(score)
        rest = np.asarray(vector) - reduction.inverse_transform(score)  # what the Eigenwalkers leave out of the base
        kept = {name: getattr(base, name) for name in ("speed", "size") if name not in linearizer.extras}
    wanted = np.hstack((alphas, np.tile(start[len(names) :], (len(alphas), 1))))
    vectors = rest + reduction.inverse_transform(score + trait.step(wanted - start, specified))
    walks = linearizer.inverse_transform(vectors)
    return [replace(walk, name=_label(names, row), **kept) for walk, row in zip(walks, alphas, strict=True)]


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


def _split(model: Pipeline) -> tuple[Pipeline | None, FourierLinearizer, Pipeline]:
    """Return the steps before the linearizer, the linearizer, and the steps between it and the trait."""
    for position, (_, step) in enumerate(model.steps):
        if isinstance(step, FourierLinearizer):
            return model[:position] if position else None, step, model[position + 1 : -1]
    raise ValueError(f"model must have a FourierLinearizer among its steps, got {[name for name, _ in model.steps]}")
