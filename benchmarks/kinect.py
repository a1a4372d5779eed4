"""Sex, height, weight and age of people before a Kinect: ``python -m benchmarks.kinect [--short]``.

Every person is left out in turn with all recordings; everything that is learned is learned from the others. The
settings of the default were chosen by how often a recording's nearest neighbor is another recording of the same
person, which asks for no trait. A step that changed it by less than a hundredth was left out; 20 to 30 Eigenwalkers
do not differ by more than two, and 25 is their middle. The table shows what each step changed in that, and in telling
the sexes apart.
The recordings are looked for where EIGENWALKER_TEST_DATA says, else in ../shared/data.
"""

import time
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import pearsonr
from sklearn.decomposition import PCA
from sklearn.metrics import balanced_accuracy_score, roc_auc_score
from sklearn.model_selection import LeaveOneGroupOut, cross_val_predict
from sklearn.pipeline import Pipeline
from threadpoolctl import threadpool_limits

from benchmarks._command import run
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._recordings import find_recordings, not_there
from benchmarks._tables import print_table
from eigenwalker.io import read_walk
from eigenwalker.model import BlockScaler, FourierLinearizer, TraitClassifier, loo_matrix, permutation_test
from eigenwalker.motion import Walk, pool_walks, prepare_walks, split_passes

_PREPARATION = {"camera": "moving", "symmetrize": True, "frequency_range": (0.6, 1.3)}
_N_COMPONENTS = 25
_WANTED = {"balanced accuracy": 0.80, "AUC": 0.88}


def findings(*, short: bool) -> list[Check]:
    """Print what preparation changes and what the default tells about people; of 20 of them no rate is asked."""
    folder = find_recordings("kinect")
    print(describe_machine())
    if not folder.is_dir():
        return not_there(folder)
    with threadpool_limits(limits=1):
        recordings, people = _load(folder, 20 if short else None)
        rows = {name: _ROWS[name] for name in list(_ROWS)[4:6]} if short else _ROWS
        print_table("What preparation changes", _HEADER, _rows(recordings, people, rows))
        scores = _report_default(recordings, people, n_permutations=200 if short else 10_000)
    return [
        Check(f"sex of people: {name} {least}", f"{scores[name]:.3f}", None if short else bool(scores[name] >= least))
        for name, least in _WANTED.items()
    ]


def _load(folder: Path, n_people: int | None) -> tuple[list[Walk], pd.DataFrame]:
    """Return all recordings, named after person and file, and what is known about the people in them."""
    start = time.perf_counter()
    people = pd.read_csv(folder / "person-data.csv").dropna(subset="Gender").set_index("Individual")
    people = people[[(folder / person).is_dir() for person in people.index]][:n_people]
    files = [file for person in people.index for file in sorted((folder / person).glob("*.txt"))]
    walks = [read_walk(file, name=f"{file.parent.name}_{file.stem}") for file in files]
    print(f"read {len(files)} files of {len(people)} people in {time.perf_counter() - start:.1f} s, none refused")
    return walks, people


class Recordings(NamedTuple):
    """Recordings as vectors, with what became of them on the way."""

    vectors: NDArray[np.float64]
    persons: NDArray[np.str_]
    n_passes: int
    n_used: int
    explained_power: float


def _vectorize(
    walks: Sequence[Walk], *, split: bool = True, n_harmonics: int = 2, robust: bool = False, **preparation: Any
) -> Recordings:
    """Return one vector a recording: its passes prepared, put together, and linearized."""
    passes = [one for walk in walks for one in split_passes(walk)] if split else list(walks)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about passes that are refused; they are counted
        prepared = prepare_walks(passes, on_error="skip", **preparation)
        names = [walk.name.partition("_pass")[0] for walk in prepared]
        pooled = pool_walks(prepared, names, on_error="skip")
    linearizer = FourierLinearizer(n_harmonics, robust=robust, warn_below=-np.inf).fit(pooled)
    persons = np.array([walk.name.partition("_")[0] for walk in pooled])
    power = float(np.median(1 - linearizer.residual_power(pooled)))
    return Recordings(linearizer.transform(pooled), persons, len(passes), len(prepared), power)


def _reduction(scaling: str, n_components: int) -> Pipeline:
    return Pipeline([("scaler", BlockScaler(unit=scaling)), ("eigenwalkers", PCA(n_components, svd_solver="full"))])


def _options(scaling: str, persons: NDArray[np.str_]) -> dict[str, NDArray[np.str_]]:
    return {"scaler__groups": persons} if scaling == "noise" else {}


def _same_person_rate(recordings: Recordings, scaling: str, n_components: int) -> float:
    """Return how often the nearest other recording is of the same person. No trait label is used."""
    reduction = _reduction(scaling, n_components)
    scores = reduction.fit_transform(recordings.vectors, **_options(scaling, recordings.persons))
    distances = np.linalg.norm(scores[:, np.newaxis] - scores, axis=2)
    np.fill_diagonal(distances, np.inf)
    return float(np.mean(recordings.persons[distances.argmin(axis=1)] == recordings.persons))


def _decide(
    recordings: Recordings, sex: pd.Series, scaling: str, n_components: int, columns: slice = slice(None)
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return whether each person is a man, and the mean decision about the recordings of each, left out in turn."""
    steps = [*_reduction(scaling, n_components).steps, ("trait", TraitClassifier(boundary="midpoint"))]
    decisions = cross_val_predict(
        Pipeline(steps),
        recordings.vectors[:, columns],
        sex.loc[recordings.persons].to_numpy(),
        groups=recordings.persons,
        cv=LeaveOneGroupOut(),
        method="decision_function",
        params=_options(scaling, recordings.persons),
    )
    means = pd.Series(decisions).groupby(recordings.persons).mean()
    return (sex.loc[means.index] == "M").to_numpy(), means.to_numpy()


_DEFAULT = {"scaling": "noise", "n_components": _N_COMPONENTS, "split": True, "robust": True, **_PREPARATION}
_PLAIN = {"symmetrize": False, "frequency_range": None, "robust": False}
_ROWS: dict[str, Mapping[str, Any]] = {
    "file as it is": _PLAIN | {"split": False, "camera": "still"},
    "+ passes": _PLAIN | {"camera": "still"},
    "+ moving camera": _PLAIN,
    "+ 0.6 to 1.3 Hz": _PLAIN | {"frequency_range": _PREPARATION["frequency_range"]},
    "+ symmetrize": {"robust": False},
    "+ robust fits: the default": {},
    "with blocks scaled": {"scaling": "blocks"},
    "with features scaled": {"scaling": "features"},
    "with 15 Eigenwalkers": {"n_components": 15},
    "with 20 Eigenwalkers": {"n_components": 20},
    "with 30 Eigenwalkers": {"n_components": 30},
    "with 1 harmonic": {"n_harmonics": 1},
    "with 3 harmonics": {"n_harmonics": 3},
    "with low-pass at 6 Hz": {"cutoff": 6.0},
    "with size taken out": {"normalize_size": True},
    "with steady cadence": {"cadence": "steady"},
}
_HEADER = ("", "passes", "used", "explained", "same person", "balanced accuracy", "AUC")


def _rows(walks: Sequence[Walk], people: pd.DataFrame, changes: Mapping[str, Mapping[str, Any]]) -> list[list[str]]:
    rows = []
    for name, changed in changes.items():
        options = {**_DEFAULT, **changed}
        scaling, n_components = options.pop("scaling"), options.pop("n_components")
        recordings = _vectorize(walks, **options)
        is_man, decision = _decide(recordings, people["Gender"], scaling, n_components)
        rows.append(
            [
                name,
                f"{recordings.n_passes}",
                f"{recordings.n_used}",
                f"{recordings.explained_power:.1%}",
                f"{_same_person_rate(recordings, scaling, n_components):.1%}",
                f"{balanced_accuracy_score(is_man, decision > 0):.3f}",
                f"{roc_auc_score(is_man, decision):.3f}",
            ]
        )
    return rows


def _report_default(walks: Sequence[Walk], people: pd.DataFrame, *, n_permutations: int) -> dict[str, float]:
    options = {name: value for name, value in _DEFAULT.items() if name not in ("scaling", "n_components")}
    recordings = _vectorize(walks, **options)
    matrix = loo_matrix(recordings.vectors, groups=recordings.persons, n_components=_N_COMPONENTS, scaling="noise")
    is_man, decision = _decide(recordings, people["Gender"], "noise", _N_COMPONENTS)
    accuracy, area = balanced_accuracy_score(is_man, decision > 0), roc_auc_score(is_man, decision)
    codes = np.where(people["Gender"].loc[recordings.persons] == "M", 1.0, -1.0)
    test = permutation_test(
        matrix, codes, recordings.persons, score="auc", n_permutations=n_permutations, random_state=0
    )
    print(f"\nSex of {len(is_man)} people ({is_man.sum()} men), each left out in turn, the default:")
    low, high = _interval(is_man, decision)
    print(f"  balanced accuracy {accuracy:.3f}, AUC {area:.3f} (95 % of resampled people: {low:.2f} to {high:.2f})")
    print(f"  permutation p of the AUC {test.p_value:.4f} ({n_permutations} shuffles of people)")
    _report_parts(recordings, people["Gender"])
    _report_numbers(recordings, people, matrix)
    return {"balanced accuracy": accuracy, "AUC": area}


def _interval(is_man: NDArray[np.bool_], decision: NDArray[np.float64]) -> tuple[float, float]:
    """Return the middle 95 % of the AUC over resampled people, as many men and women as there are."""
    rng = np.random.default_rng(0)
    men, women = decision[is_man], decision[~is_man]
    areas = [
        roc_auc_score(np.sort(is_man)[::-1], np.concatenate((rng.choice(men, len(men)), rng.choice(women, len(women)))))
        for _ in range(1000)
    ]
    low, high = np.quantile(areas, [0.025, 0.975])
    return float(low), float(high)


def _report_parts(recordings: Recordings, sex: pd.Series) -> None:
    """Print what structure and dynamics alone tell, and which share of the axis lies in each."""
    n_channels = (recordings.vectors.shape[1] - 1) // 5
    for part, columns in (("structure", slice(0, n_channels)), ("dynamics", slice(n_channels, None))):
        is_man, decision = _decide(recordings, sex, "noise", _N_COMPONENTS, columns)
        accuracy, area = balanced_accuracy_score(is_man, decision > 0), roc_auc_score(is_man, decision)
        print(f"  {part} alone: balanced accuracy {accuracy:.3f}, AUC {area:.3f}")
    reduction = _reduction("noise", _N_COMPONENTS)
    scores = reduction.fit_transform(recordings.vectors, scaler__groups=recordings.persons)
    axis = TraitClassifier().fit(scores, sex.loc[recordings.persons].to_numpy(), recordings.persons)
    moved = axis.step([[1.0]], axis.trait_names_) @ reduction["eigenwalkers"].components_  # (1, n_features), in noise
    share = float((moved[0, :n_channels] ** 2).sum() / (moved**2).sum())
    print(f"  of what moves along the axis, in units of noise: structure {share:.0%}, dynamics {1 - share:.0%}")


def _report_numbers(recordings: Recordings, people: pd.DataFrame, matrix: NDArray[np.float64]) -> None:
    """Print how predictions of numbers go with the truth, over people left out."""
    for column in ("Height", "Weight (Kg)", "Age"):
        labels = people[column].loc[recordings.persons].to_numpy()
        known = ~np.isnan(labels)
        part = recordings.persons[known]
        if not known.all():
            matrix_known = loo_matrix(
                recordings.vectors[known], groups=part, n_components=_N_COMPONENTS, scaling="noise"
            )
        else:
            matrix_known = matrix
        pairs = pd.DataFrame({"truth": labels[known], "guess": matrix_known @ labels[known]}).groupby(part).mean()
        r, p = pearsonr(pairs["truth"], pairs["guess"])
        error = np.sqrt(np.mean((pairs["truth"] - pairs["guess"]) ** 2))
        spread = pairs["truth"].std()
        print(f"{column}: r = {r:.2f} over {len(pairs)} people (p {p:.4f}), error {error:.3g} of SD {spread:.3g}")


if __name__ == "__main__":
    run(findings, __doc__, short="20 people and few rows")
