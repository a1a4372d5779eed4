"""The whole model as one Pipeline, and what its axes are made of (Troje 2002, sections 2 and 3)."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from sklearn.base import BaseEstimator, clone
from sklearn.decomposition import PCA
from sklearn.pipeline import Pipeline

from eigenwalker._validation import check_choice
from eigenwalker.model.blocks import PARTS, feature_parts
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.scaling import SCALINGS, BlockScaler
from eigenwalker.model.traits import TraitRegressor

__all__ = [
    "axis_features",
    "axis_shares",
    "eigenwalker_features",
    "make_eigenwalkers",
    "scale_changes",
    "settings_of",
    "shares_of",
    "split_model",
    "trait_axes",
]


def make_eigenwalkers(
    n_harmonics: int = 2,
    n_components: int | float | None = 15,
    *,
    scaling: str | None = "blocks",
    trait: BaseEstimator | None = None,
    extras: Sequence[str] = (),
    weights: Mapping[str, float] | None = None,
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
        ``fit(walks, y, scaler__groups=persons)``. None leaves metres and hertz as they are.
    trait : TraitRegressor or TraitClassifier, default None
        The last step; a clone of it is taken. None is `TraitRegressor()`.
    extras : sequence of {"speed", "size"}, default ()
        Further features of `FourierLinearizer`.
    weights : mapping of str to float, default None
        How much blocks of features count, {"dynamics": 2.0, "head": 0.5}; 0 leaves a block out, {"structure": 0}. See
        `block_weights` for the names.

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
    check_choice(scaling, SCALINGS, name="scaling")
    linearizer = FourierLinearizer(n_harmonics, extras=tuple(extras))
    if weights is not None:
        linearizer.set_output(transform="pandas")  # so that the scaler knows features by their names
    return Pipeline(
        [
            ("linearizer", linearizer),
            ("scaler", BlockScaler(1 + len(tuple(extras)), unit=scaling, weights=weights)),
            ("eigenwalkers", PCA(n_components, svd_solver="full")),
            ("trait", TraitRegressor() if trait is None else clone(trait)),
        ]
    )


def axis_features(model: Pipeline) -> pd.DataFrame:
    """Return what alpha = 1 on each trait axis changes in each feature.

    Parameters
    ----------
    model : Pipeline
        Fitted, from `make_eigenwalkers` or with the same kinds of steps.

    Returns
    -------
    DataFrame
        One row a trait, one column a feature, in the feature's own unit: metres, hertz, metres a second.
    """
    linearizer, reduction = split_model(model)[1:]
    names, trait = linearizer.get_feature_names_out(), trait_axes(model)
    steps = np.vstack([trait.step([[1.0]], [name]) for name in trait.trait_names_])
    average = trait.mean_[np.newaxis]
    changes = reduction.inverse_transform(average + steps) - reduction.inverse_transform(average)
    return pd.DataFrame(changes, index=pd.Index(trait.trait_names_, name="trait"), columns=names)


def axis_shares(model: Pipeline) -> pd.DataFrame:
    """Return which share of each trait axis is structure and which dynamics.

    Parameters
    ----------
    model : Pipeline
        Fitted, from `make_eigenwalkers` or with the same kinds of steps.

    Returns
    -------
    DataFrame
        One row a trait; the columns structure and dynamics sum to 1. They are shares of the axis' squared length in
        the space of the Eigenwalkers, that is, with features scaled as the model scales them.
    """
    return shares_of(model, axis_features(model))


def eigenwalker_features(model: Pipeline) -> pd.DataFrame:
    """Return what one SD over the training walkers along each Eigenwalker changes in each feature.

    Parameters
    ----------
    model : Pipeline
        Fitted, from `make_eigenwalkers` or with the same kinds of steps.

    Returns
    -------
    DataFrame
        One row an Eigenwalker, numbered from 1, one column a feature, in the feature's own unit.
    """
    linearizer, reduction = split_model(model)[1:]
    pca = reduction[-1]
    average = np.zeros((1, pca.n_components_))
    steps = np.diag(np.sqrt(pca.explained_variance_))
    changes = reduction.inverse_transform(steps) - reduction.inverse_transform(average)
    numbers = pd.RangeIndex(1, len(changes) + 1, name="eigenwalker")
    return pd.DataFrame(changes, index=numbers, columns=linearizer.get_feature_names_out())


def shares_of(model: Pipeline, changes: pd.DataFrame) -> pd.DataFrame:
    """Return which share of some changes of features is structure and which dynamics; see `axis_shares`."""
    squares = scale_changes(model, changes) ** 2
    totals = squares.T.groupby(feature_parts(changes.columns)).sum().T.reindex(columns=list(PARTS), fill_value=0.0)
    return totals.div(totals.sum(axis=1), axis=0)


def scale_changes(model: Pipeline, changes: pd.DataFrame) -> pd.DataFrame:
    """Return changes of features in the scale in which the model finds its Eigenwalkers."""
    return changes / getattr(model[-3], "scale_", 1.0)


def split_model(model: Pipeline) -> tuple[Pipeline | None, FourierLinearizer, Pipeline]:
    """Return the steps before the linearizer, the linearizer, and the steps between it and the trait."""
    for position, (_, step) in enumerate(model.steps):
        if isinstance(step, FourierLinearizer):
            return model[:position] if position else None, step, model[position + 1 : -1]
    raise ValueError(f"model must have a FourierLinearizer among its steps, got {[name for name, _ in model.steps]}")


def trait_axes(model: Pipeline) -> TraitRegressor:
    """Return the trait axes of a fitted model, those within a `TraitClassifier` as well."""
    return getattr(model[-1], "axis_", model[-1])


def settings_of(model: Pipeline) -> dict[str, Any]:
    """Return the settings of a model that statistics such as `loo_predict` take.

    Parameters
    ----------
    model : Pipeline
        From `make_eigenwalkers` or with the same kinds of steps; it need not be fitted.

    Returns
    -------
    dict
        n_components, scaling, n_scalars and weights, for ``loo_predict(vectors, y, **settings_of(model))``.

    Raises
    ------
    ValueError
        If the steps are others, or if the number of components is not a whole number.

    Examples
    --------
    >>> from eigenwalker.model import make_eigenwalkers, settings_of
    >>> settings_of(make_eigenwalkers(n_components=5))
    {'n_components': 5, 'scaling': 'blocks', 'n_scalars': 1, 'weights': None}
    """
    steps = [step for _, step in split_model(model)[2].steps]
    scaler = steps[0] if steps and isinstance(steps[0], BlockScaler) else BlockScaler(unit=None)
    kinds = [type(step) for step in steps if step is not scaler]
    if kinds != [PCA] or scaler.tolerance != BlockScaler().tolerance:
        listed = ", ".join(map(repr, steps))
        raise ValueError(
            f"expected a BlockScaler with its default tolerance, or none, and a PCA before the trait, got {listed}"
        )
    n_components = steps[-1].n_components
    if not isinstance(n_components, int | np.integer):
        raise ValueError(f"the PCA's n_components must be a whole number, got {n_components!r}")
    return {
        "n_components": int(n_components),
        "scaling": scaler.unit,
        "n_scalars": scaler.n_scalars,
        "weights": scaler.weights,
    }
