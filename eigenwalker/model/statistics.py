"""What is known about trait axes: how well they predict, how sure that is, how stable they are, what they move."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from sklearn.base import clone
from sklearn.pipeline import Pipeline
from sklearn.utils.validation import check_consistent_length

from eigenwalker.model._findings import find_faults, state_notes
from eigenwalker.model._guards import warn_leakage
from eigenwalker.model._study import (
    Study,
    permute,
    score_accuracy,
    score_components,
    score_harmonics,
    score_left_out,
    score_nested,
    score_parts,
    score_tempo,
    take_study,
)
from eigenwalker.model.bootstrap import BootstrapResult, bootstrap_axes
from eigenwalker.model.eigenwalkers import axis_features, axis_shares, scale_changes, split_model, trait_axes
from eigenwalker.model.leave_one_out import loo_predict
from eigenwalker.model.permutation import PermutationResult
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["AxisStatistics", "axis_statistics"]


@dataclass(frozen=True, eq=False)
class AxisStatistics:
    """What `axis_statistics` returns. Scores are areas under the curve for two groups, correlations for numbers.

    Parameters
    ----------
    model : Pipeline
        From the linearizer on, fitted to all walks.
    summary : DataFrame
        One row a trait: numbers of walks and persons with a label; poles; `unit`, how many label units one unit of
        alpha is; `score`, which one; `left_out`, the score of persons left out, with interval and permutation p;
        `nested`, the same with the number of components chosen without them; `accuracy`, the balanced accuracy of two
        groups with the boundary midway; `tempo`, the score of frequency and speed alone; `stability`, the median cosine
        between the axis and those of persons drawn again, and its 5 % quantile.
    components, harmonics : DataFrame
        Score of persons left out, one row a number of components or harmonics, one column a trait. The best value of
        such a curve is optimistic.
    parts : DataFrame
        One row a trait and part, structure and dynamics: share of the axis, and the score of that part alone.
    cosines : DataFrame
        Between axes, of features as the model scales them.
    permutations : dict of str to PermutationResult
        Of each trait.
    bootstrap : BootstrapResult
        Of all traits.
    predictions : DataFrame of shape (n_walks, n_traits)
        Of each walk, its person left out; two groups are -1 and +1.
    settings : dict
        What was done.
    faults, notes : tuple of str
        What speaks against an axis; what should be said of any.
    """

    model: Pipeline
    summary: pd.DataFrame
    components: pd.DataFrame
    harmonics: pd.DataFrame
    parts: pd.DataFrame
    cosines: pd.DataFrame
    permutations: dict[str, PermutationResult]
    bootstrap: BootstrapResult
    predictions: pd.DataFrame
    settings: dict[str, Any]
    faults: tuple[str, ...]
    notes: tuple[str, ...]


def axis_statistics(
    model: Pipeline,
    walks: Sequence[Walk | JointWalk],
    y: ArrayLike,
    *,
    groups: ArrayLike | None = None,
    control: ArrayLike | None = None,
    sources: ArrayLike | None = None,
    n_harmonics: Sequence[int] = (1, 2, 3, 4),
    level: float = 0.95,
    n_permutations: int = 10_000,
    n_resamples: int = 500,
    random_state: int | None = None,
    n_jobs: int | None = None,
) -> AxisStatistics:
    """Return what walks say about the trait axes of a model: everything is fitted anew without those it is tested on.

    Parameters
    ----------
    model : Pipeline
        From `make_eigenwalkers` or with the same kinds of steps; it need not be fitted, and is left as it is.
    walks : list of Walk or JointWalk
        What the model is for.
    y : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_traits)
        Labels, as for `TraitRegressor`.
    groups : array-like of shape (n_walks,), default None
        Which person each walk is of. None takes each walk for a person.
    control : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_controls), default None
        What no axis may go along with; see `TraitRegressor.fit`.
    sources : array-like of shape (n_walks,), default None
        In which session, place or data set each walk was recorded, to tell where a trait goes along with it. A source
        of one person only tells nothing.
    n_harmonics : sequence of int, default (1, 2, 3, 4)
        Numbers of harmonics to compare. NaN comes of those for which the model's weights do not fit, or leave fewer
        features than components.
    level : float, default 0.95
        Of the confidence intervals.
    n_permutations : int, default 10000
        Number of shuffles of the labels.
    n_resamples : int, default 500
        Number of times that persons are drawn again for the stability.
    random_state : int or None, default None
        Seed.
    n_jobs : int, default None
        Processes, as joblib counts them. Nothing depends on it.

    Returns
    -------
    AxisStatistics

    Raises
    ------
    ValueError
        If the model has other steps, or labels, groups or controls do not fit the walks.

    Warns
    -----
    LeakageWarning
        If names of walks look like several walks a person, and no groups are given.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.model import axis_statistics, make_eigenwalkers
    >>> walkers = make_walkers(40, random_state=0)
    >>> model = make_eigenwalkers(n_components=8)
    >>> options = {"n_harmonics": [2], "n_permutations": 99, "n_resamples": 20, "random_state": 0}
    >>> found = axis_statistics(model, walkers.data, walkers.target[["gender", "weight"]], **options)
    >>> found.summary.loc["gender", ["negative", "positive", "score"]].tolist(), float(found.summary.loc["gender", "p"])
    (['female', 'male', 'auc'], 0.01)
    """
    before, linearizer, _ = split_model(model)
    walks = list(walks) if before is None else clone(before).fit_transform(walks)
    check_consistent_length(walks, y, groups, control, sources)
    leak = warn_leakage([walk.name for walk in walks], groups)
    study = take_study(model, linearizer, walks, y, groups, control, level)
    fitted = _fit(model, walks, y, study)
    predicted = loo_predict(study.vectors, study.codes, **study.options)
    harmonics = score_harmonics(study, linearizer, walks, n_harmonics)
    permutations = permute(study, n_permutations, random_state)
    resampling: dict[str, Any] = {"n_resamples": n_resamples, "random_state": random_state, "n_jobs": n_jobs}
    direction = trait_axes(fitted).direction
    bootstrap = bootstrap_axes(
        study.vectors, study.codes, direction=direction, level=level, **study.options, **resampling
    )
    summary = pd.concat(
        [
            _describe(study, fitted),
            score_left_out(study, predicted),
            score_nested(study, n_jobs),
            score_accuracy(study, predicted),
        ],
        axis=1,
    ).assign(
        p=[result.p_value for result in permutations.values()],
        tempo=score_tempo(study, walks),
        stability=bootstrap.stability,
        stability_low=np.quantile(bootstrap.cosines, 0.05, axis=0),
    )
    summary = summary.rename_axis("trait")
    shares = axis_shares(fitted).rename_axis(columns="part").stack().rename("share")
    parts = score_parts(study).join(shares)[["share", "alone", "alone_low", "alone_high"]]
    components = score_components(study)
    settings = {
        "n_harmonics": linearizer.n_harmonics,
        **study.settings,
        "control": list(study.controls),
        "level": level,
        "n_permutations": n_permutations,
        "n_resamples": n_resamples,
        "alpha_unit": trait_axes(fitted).alpha_unit,
    }
    return AxisStatistics(
        model=fitted,
        summary=summary,
        components=components,
        harmonics=harmonics,
        parts=parts,
        cosines=_cosines(fitted),
        permutations=permutations,
        bootstrap=bootstrap,
        predictions=pd.DataFrame(predicted, columns=study.codes.columns, index=[walk.name for walk in walks]),
        settings=settings,
        faults=(*leak, *find_faults(summary, parts, components, study.codes, study.persons, sources, settings)),
        notes=state_notes(settings),
    )


def _fit(model: Pipeline, walks: Sequence[Walk | JointWalk], y: ArrayLike, study: Study) -> Pipeline:
    """Return the steps from the linearizer on, fitted to walks that are prepared already."""
    before = split_model(model)[0]
    fitted = clone(model[0 if before is None else len(before) :])
    names = [name for name, _ in fitted.steps]
    options: dict[str, Any] = {f"{names[-1]}__groups": study.persons, f"{names[-1]}__control": study.options["control"]}
    if study.settings["scaling"] == "noise":
        options[f"{names[1]}__groups"] = study.persons
    # The walks are linearized already; the vectors have names where those of this linearizer would.
    named = isinstance(fitted[0].fit(walks).transform(walks[:1]), pd.DataFrame)
    fitted[1:].fit(study.vectors if named else study.vectors.to_numpy(), y, **options)
    return fitted


def _describe(study: Study, fitted: Pipeline) -> pd.DataFrame:
    """Return who is labelled, the poles, and the unit of each axis."""
    axes, known = trait_axes(fitted), study.codes.notna()
    poles = [axes.poles_[name] for name in study.codes]
    return pd.DataFrame(
        {
            "n_walks": known.sum(),
            "n_persons": [len(np.unique(study.persons[column])) for column in known.to_numpy().T],
            "negative": [str(negative) for negative, _ in poles],
            "positive": [str(positive) for _, positive in poles],
            "unit": [axes.to_label(1.0, place) - axes.to_label(0.0, place) for place in range(len(poles))],
            "score": study.scores,
        },
        index=study.codes.columns,
    )


def _cosines(fitted: Pipeline) -> pd.DataFrame:
    """Return the cosines between axes, of scaled features."""
    axes = axis_features(fitted)
    scaled = scale_changes(fitted, axes).to_numpy()
    lengths = np.linalg.norm(scaled, axis=1, keepdims=True)
    unit = np.divide(scaled, lengths, out=np.zeros_like(scaled), where=lengths > 0)
    return pd.DataFrame(unit @ unit.T, index=axes.index, columns=list(axes.index))
