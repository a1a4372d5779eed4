"""The scores of trait axes: of persons left out, of parts of the walk, against numbers of components and harmonics."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from sklearn.base import clone
from sklearn.pipeline import Pipeline

from eigenwalker.model._control import take_controls
from eigenwalker.model._labels import encode, learn_coding, tabulate
from eigenwalker.model._persons import number_persons
from eigenwalker.model._resampling import midpoints_without_each
from eigenwalker.model._sample import Reduction, Sample, take_components, take_labels, take_sample
from eigenwalker.model._scores import by_person, score_columns
from eigenwalker.model.blocks import PARTS, feature_parts, fitting_weights, take_weights
from eigenwalker.model.discriminant import TraitClassifier
from eigenwalker.model.eigenwalkers import settings_of
from eigenwalker.model.intervals import score_interval
from eigenwalker.model.leave_one_out import loo_predict, matrix_of_others
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.nested import nested_loo
from eigenwalker.model.permutation import PermutationResult, permutation_test
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = [
    "Study",
    "permute",
    "score_accuracy",
    "score_components",
    "score_harmonics",
    "score_left_out",
    "score_nested",
    "score_parts",
    "score_tempo",
    "take_study",
]

_MOST_COMPONENTS = 40
_Walks = Sequence[Walk | JointWalk]


@dataclass(frozen=True, eq=False)
class Study:
    """What the scores are of.

    Parameters
    ----------
    vectors : DataFrame of shape (n_walks, n_features)
        Walks, with names of features.
    codes : DataFrame of shape (n_walks, n_traits)
        Labels as numbers, two words as -1 and +1, NaN where missing.
    scores : list of str
        Which score each trait has: "auc" for two groups, else "r".
    persons : ndarray of shape (n_walks,)
        Number of the person each walk is of.
    controls : DataFrame of shape (n_walks, n_controls)
        What no axis may go along with.
    settings : dict
        Of `settings_of`.
    level : float
        Of confidence intervals.
    """

    vectors: pd.DataFrame
    codes: pd.DataFrame
    scores: list[str]
    persons: NDArray[np.intp]
    controls: pd.DataFrame
    settings: dict[str, Any]
    level: float

    @property
    def options(self) -> dict[str, Any]:
        """What every leave-one-out takes."""
        return {**self.settings, "groups": self.persons, "control": self.controls if self.controls.size else None}

    def rate(self, predicted: NDArray[np.float64], trait: int, score: str | None = None) -> list[float]:
        """Return score, and low and high end of its interval, of the predictions of a trait, shape (n_walks,).

        NaN where some are missing.
        """
        score = score or self.scores[trait]
        guess, truth = by_person(predicted, self.codes.iloc[:, trait].to_numpy(), self.persons)
        if np.isnan(guess).any():
            return [float("nan")] * 3
        value = float(score_columns(guess[:, np.newaxis], truth[:, np.newaxis], score)[0])
        return [value, *score_interval(guess, truth, score, level=self.level)]

    def rate_each(self, predicted: NDArray[np.float64], names: Sequence[str]) -> pd.DataFrame:
        """Return these three of every trait, under the given names, from predictions of shape (n_walks, n_traits)."""
        rows = [self.rate(column, trait) for trait, column in enumerate(predicted.T)]
        return pd.DataFrame(rows, index=self.codes.columns, columns=list(names))


def take_study(
    model: Pipeline,
    linearizer: FourierLinearizer,
    walks: _Walks,
    y: ArrayLike,
    groups: ArrayLike | None,
    control: ArrayLike | None,
    level: float,
) -> Study:
    """Return the study that a caller's arguments stand for."""
    codes = _take_codes(model, y)
    controls, names = take_controls(control, len(walks), list(codes))
    return Study(
        clone(linearizer).set_output(transform="pandas").fit_transform(walks),
        codes,
        ["auc" if two_valued else "r" for two_valued in take_labels(codes, len(codes)).two_valued],
        number_persons(groups, len(walks)),
        pd.DataFrame(controls, columns=names),
        settings_of(model),
        level,
    )


def _take_codes(model: Pipeline, y: ArrayLike) -> pd.DataFrame:
    """Return labels as the last step of a model codes them."""
    poles = getattr(model[-1], "poles", None)
    table = tabulate(y, poles)
    codings = learn_coding(table, poles)
    if isinstance(model[-1], TraitClassifier):  # numbers are names of its two groups
        ends = {name: tuple(np.unique(table[name].dropna())) for name in table} | dict(poles or {})
        codings = [coding._replace(poles=tuple(ends[coding.name]), two_valued=True) for coding in codings]
    return pd.DataFrame(encode(table, codings), columns=list(table))


def score_left_out(study: Study, predicted: NDArray[np.float64]) -> pd.DataFrame:
    """Return the score of persons left out, with its interval."""
    return study.rate_each(predicted, ["left_out", "left_out_low", "left_out_high"])


def score_accuracy(study: Study, predicted: NDArray[np.float64]) -> pd.DataFrame:
    """Return the balanced accuracy of two groups, with the boundary midway between them; NaN for numbers."""
    sample, reduction = _sample_of(study), _reduction_of(study)
    rows = np.full((study.codes.shape[1], 3), np.nan)
    grouped = np.flatnonzero(np.array(study.scores) == "auc")
    if len(grouped):
        with np.errstate(invalid="ignore"):  # NaN where a person is the only one of a group
            midpoints = midpoints_without_each(sample, study.codes.to_numpy()[:, grouped], reduction)
        for place, trait in enumerate(grouped):
            rows[trait] = study.rate(predicted[:, trait] - midpoints[:, place], int(trait), "balanced_accuracy")
    return pd.DataFrame(rows, index=study.codes.columns, columns=["accuracy", "accuracy_low", "accuracy_high"])


def score_nested(study: Study, n_jobs: int | None) -> pd.DataFrame:
    """Return the score with the number of components chosen on the others alone, and the median of these numbers."""
    options = study.options | {"n_components": _numbers(study, n_left_out=2), "criterion": "error"}
    result = nested_loo(study.vectors, study.codes, n_jobs=n_jobs, **options)
    table = study.rate_each(result.predictions, ["nested", "nested_low", "nested_high"])
    return table.assign(nested_components=np.median(result.n_components, axis=0))


def score_tempo(study: Study, walks: _Walks) -> NDArray[np.float64]:
    """Return the score of frequency, and of speed where it is known, alone; NaN with as many controls."""
    tempo = np.column_stack((study.vectors["frequency"], [walk.speed for walk in walks]))
    tempo = tempo[:, np.isfinite(tempo).all(axis=0)]
    if tempo.shape[1] <= study.controls.shape[1]:
        return np.full(study.codes.shape[1], np.nan)
    fixed = {"n_components": tempo.shape[1], "scaling": "features", "n_scalars": 0, "weights": None}
    predicted = loo_predict(tempo, study.codes, **study.options | fixed)
    return np.array([study.rate(column, trait)[0] for trait, column in enumerate(predicted.T)])


def score_parts(study: Study) -> pd.DataFrame:
    """Return the score of structure alone and of dynamics alone, with the interval, one row a trait and part."""
    names = list(study.vectors)
    weights = take_weights(study.settings["weights"], len(names), names)
    tables = {}
    for part in PARTS:
        alone = weights * (feature_parts(names) == part)
        table = study.rate_each(np.full(study.codes.shape, np.nan), ["alone", "alone_low", "alone_high"])
        most = min(int((alone > 0).sum()), len(_numbers(study)) + study.controls.shape[1])
        n_components = min(study.settings["n_components"], most)
        if n_components > study.controls.shape[1]:
            options = study.options | {"weights": alone, "n_components": n_components}
            table = study.rate_each(loo_predict(study.vectors, study.codes, **options), list(table))
        tables[part] = table
    return (
        pd.concat(tables, names=["part", "trait"])
        .swaplevel()
        .reindex(pd.MultiIndex.from_product([study.codes.columns, PARTS], names=["trait", "part"]))
    )


def score_components(study: Study) -> pd.DataFrame:
    """Return the score of persons left out with each number of components."""
    numbers = _numbers(study)
    predicted = loo_predict(study.vectors, study.codes, **study.options | {"n_components": numbers})
    rows = [[study.rate(column, trait)[0] for trait, column in enumerate(each.T)] for each in predicted]
    return pd.DataFrame(rows, index=pd.Index(numbers, name="components"), columns=study.codes.columns)


def score_harmonics(
    study: Study, linearizer: FourierLinearizer, walks: _Walks, n_harmonics: Sequence[int]
) -> pd.DataFrame:
    """Return the score of persons left out with each number of harmonics, all else equal.

    NaN where the model's weights do not fit, or leave fewer features than components.
    """
    rows = []
    for number in n_harmonics:
        other = clone(linearizer).set_params(n_harmonics=number).set_output(transform="pandas")
        vectors = study.vectors if number == linearizer.n_harmonics else other.fit_transform(walks)
        weights = fitting_weights(list(vectors), study.settings["weights"])
        try:
            predicted = loo_predict(vectors, study.codes, **study.options | {"weights": weights})
        except ValueError:
            predicted = np.full(study.codes.shape, np.nan)
        rows.append([study.rate(column, trait)[0] for trait, column in enumerate(predicted.T)])
    return pd.DataFrame(rows, index=pd.Index(list(n_harmonics), name="harmonics"), columns=study.codes.columns)


def permute(study: Study, n_permutations: int, random_state: int | None) -> dict[str, PermutationResult]:
    """Return the permutation test of each trait: labels go from person to person, or from walk to walk of a person.

    Walks without a label keep none: they count for the Eigenwalkers alone.
    """
    fixed: dict[str, Any] = {"n_permutations": n_permutations, "random_state": random_state}
    sample, reduction = _sample_of(study), _reduction_of(study)
    numbers = np.array([reduction.n_components])
    results = {}
    for score, (name, codes) in zip(study.scores, study.codes.items(), strict=True):
        labelled = codes.notna().to_numpy()
        matrix = matrix_of_others(sample, reduction, numbers, labelled)[0][np.ix_(labelled, labelled)]
        persons = study.persons[labelled]
        one_each = codes[labelled].groupby(persons).nunique().max() == 1
        who = {"groups" if one_each else "strata": persons}
        results[str(name)] = permutation_test(matrix, codes[labelled], score=score, **who, **fixed)
    return results


def _sample_of(study: Study) -> Sample:
    options = {name: study.settings[name] for name in ("scaling", "n_scalars", "weights")}
    return take_sample(study.vectors, study.persons, **options)._replace(controls=study.controls.to_numpy())


def _reduction_of(study: Study) -> Reduction:
    return Reduction(study.settings["n_components"], study.settings["scaling"])


def _numbers(study: Study, n_left_out: int = 1) -> list[int]:
    """Return the numbers of components to compare, those of the model among them where only one is left out."""
    own = study.settings["n_components"]
    numbers = take_components(None, _sample_of(study), n_left_out=n_left_out)
    wanted = {int(number) for number in numbers if number <= max(_MOST_COMPONENTS, own)}
    return sorted(wanted | {own} if n_left_out == 1 else wanted)
