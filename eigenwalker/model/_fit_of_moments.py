"""The steps of a model after its linearizer, fitted to moments as their `fit` fits them to walks."""

from collections.abc import Callable, Hashable, Sequence

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from sklearn.decomposition import PCA
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import validate_data

from eigenwalker._validation import check_choice
from eigenwalker.model._axes_of_moments import Labeled, Scored, axes_of_moments, pole_scores, unit_rows
from eigenwalker.model._labels import Coding, default_names, learn_coding
from eigenwalker.model._levels import Levels, numbers_of
from eigenwalker.model._scatter import Scatter, centered_rows
from eigenwalker.model.discriminant import TraitClassifier
from eigenwalker.model.moments import Total
from eigenwalker.model.scaling import BlockScaler
from eigenwalker.model.traits import TraitRegressor

__all__ = ["fit_steps"]

Project = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def fit_steps(
    total: Total,
    scaler: BlockScaler | None,
    pca: PCA,
    trait: TraitRegressor | TraitClassifier,
    names: Sequence[str] | None,
) -> None:
    """Fit the steps to moments.

    Parameters
    ----------
    total : Total
        Of feature vectors.
    scaler, pca, trait : estimators
        They are fitted. Alphas of the training walkers are not known but where there are persons.
    names : sequence of str or None
        Names of the features, if the scaler would be given a DataFrame.
    """
    if total.everyone.n_walks < 2:
        raise ValueError(f"expected at least 2 walks, got {total.everyone.n_walks}")
    rows = centered_rows(total.everyone.rows[:, : total.n_features])
    vectors = rows if names is None else pd.DataFrame(rows, columns=names)
    scale = np.ones(total.n_features)
    if scaler is not None:
        _fit_scaler(scaler, vectors, total)
        vectors, scale = scaler.transform(vectors), scaler.scale_
    _fit_pca(pca, vectors, total.everyone.mean[: total.n_features] / scale, total.everyone.n_walks)
    validate_data(trait, pca.transform(vectors), dtype=np.float64)
    fit = _fit_classifier if isinstance(trait, TraitClassifier) else _fit_regressor
    fit(trait, total, lambda rows: (rows / scale) @ pca.components_.T)


def _fit_scaler(scaler: BlockScaler, vectors: ArrayLike, total: Total) -> None:
    validate_data(scaler, vectors, dtype=np.float64)
    everyone, features = total.everyone, slice(total.n_features)
    spread = np.linalg.norm(everyone.rows[:, features], axis=0) / np.sqrt(everyone.n_walks)
    counted = spread
    if scaler.unit == "noise":
        if total.persons is None:
            raise ValueError("unit='noise' needs to know which person each walk is of; pass groups in every part")
        counted = total.persons.within()
    mean = everyone.mean[features]  # where the SD could be rounding, the largest value is the mean, to rounding
    scaler._learn(mean, spread, counted, mean[np.newaxis])


def _fit_pca(pca: PCA, vectors: ArrayLike, mean: NDArray[np.float64], count: int) -> None:
    """Fit PCA to rows with the scatter of all vectors, and tell it their mean and number.

    What scikit-learn does with singular values and vectors it does itself; the sign of each component among it, which
    since 1.5 depends on the component alone. The rows are as many as the vectors, or at least one more than features,
    so that there are as many components either way.
    """
    pca.fit(vectors)
    share = (pca.n_samples_ - 1) / (count - 1)  # of its divisor in that of all vectors
    pca.explained_variance_ = pca.explained_variance_ * share
    pca.noise_variance_ = pca.noise_variance_ * share
    pca.mean_, pca.n_samples_ = mean, count


def _fit_regressor(trait: TraitRegressor, total: Total, project: Project) -> None:
    names = [levels.name for levels in total.traits]
    names = names if total.has_names else default_names(len(names), trait.poles)
    seen = {name: levels.seen for name, levels in zip(names, total.traits, strict=True)}
    codings = learn_coding(seen, trait.poles)
    codes = [
        _recode(levels, coding.poles) if coding.two_valued else (1.0, 0.0)
        for levels, coding in zip(total.traits, codings, strict=True)
    ]
    labeled = _fit_axis(trait, total, project, codings, codes, is_single=total.is_single)
    trait._report_groups(
        {coding.name: _pole_means(trait, labeled, place) for place, coding in enumerate(codings) if coding.two_valued}
    )


def _fit_classifier(trait: TraitClassifier, total: Total, project: Project) -> None:
    check_choice(trait.boundary, ("zero", "midpoint"), name="boundary")
    name = total.traits[0].name if total.has_names else default_names(1, trait.poles)[0]
    _check_classes(total, name)
    trait.axis_ = trait._make_axis(total.traits[0].seen.rename(name))
    trait.axis_.n_features_in_ = trait.n_features_in_
    codings = learn_coding({name: pd.Series([-1.0, 1.0])}, trait.axis_.poles)
    codes = [_recode(total.traits[0], codings[0].poles)]
    labeled = _fit_axis(trait.axis_, total, project, codings, codes, is_single=True)
    trait.axis_._report_groups({})  # of its codes, which are numbers
    trait._report_groups(_pole_means(trait.axis_, labeled, 0))


def _check_classes(total: Total, name: str) -> None:
    if len(total.traits) != 1:
        raise ValueError(f"y must have one column, got {len(total.traits)}; use TraitRegressor for many traits")
    n_walks, n_labeled = total.everyone.n_walks, total.labeled[0].n_walks if total.labeled[0] else 0
    if n_labeled < n_walks:
        raise ValueError(
            f"Input y, trait {name!r}, contains NaN: {n_walks - n_labeled} of {n_walks} labels are missing; leave "
            "these walkers out, or use TraitRegressor"
        )
    check_classification_targets(total.traits[0].seen.to_numpy())


def _recode(levels: Levels, poles: tuple[Hashable, Hashable]) -> tuple[float, float]:
    """Return slope and intercept of the line from the numbers of two labels to -1 and +1."""
    numbers = numbers_of(levels)
    low, high = (numbers[pole] for pole in poles)
    slope = 2.0 / (high - low)
    return slope, -1.0 - slope * low


def _fit_axis(
    axis: TraitRegressor,
    total: Total,
    project: Project,
    codings: list[Coding],
    codes: list[tuple[float, float]],
    *,
    is_single: bool,
) -> list[Labeled]:
    """Fit trait axes to labels that codes of `_recode` make numbers of; return the walkers with a label of each."""
    axis._check_settings()
    everyone = _score(total, project)
    places = zip(
        total.labeled, range(total.n_features + len(total.controls), len(total.everyone.mean)), codes, strict=True
    )
    traits = [_label(total, labeled, column, code, project) for labeled, column, code in places if labeled is not None]
    control_names = [levels.name for levels in total.controls]
    axis._learn(axes_of_moments(everyone, traits), codings, control_names, is_single=is_single)
    if everyone.persons is None:
        axis._n_walkers = everyone.n_walks
    else:
        axis.alphas_ = axis._alphas(everyone.persons)
    return traits


def _pole_means(axis: TraitRegressor, labeled: list[Labeled], trait: int) -> list[float]:
    """Return the mean alphas of the walkers labeled -1 and +1."""
    return axis._alphas(pole_scores(labeled[trait]))[:, trait].tolist()


def _score(total: Total, project: Project) -> Scored:
    """Return all walkers as scores."""
    features = slice(total.n_features)
    controls = slice(total.n_features, total.n_features + len(total.controls))
    learn_coding({levels.name: levels.seen for levels in total.controls}, None)  # or raise
    rows, count = total.everyone.rows, total.everyone.n_walks
    means = None if total.persons is None else total.persons.table() - total.everyone.mean[features]
    return Scored(
        count,
        project(rows[:, features]),
        unit_rows(rows[:, controls], total.everyone.mean[controls], count),
        None if means is None else project(means),
    )


def _label(total: Total, labeled: Scatter, column: int, code: tuple[float, float], project: Project) -> Labeled:
    """Return the walkers with a label of a trait, which is in a column of their scatter; the code is `_recode`'s."""
    everyone, features, (slope, intercept) = total.everyone, slice(total.n_features), code
    gap = (labeled.origin - everyone.origin) + (labeled.shift - everyone.shift)
    return Labeled(
        labeled.n_walks,
        project(gap[features]),
        project(labeled.rows[:, features]),
        slope * labeled.mean[column] + intercept,
        slope * labeled.rows[:, column],
    )
