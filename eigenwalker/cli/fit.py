"""``eigenwalker fit``: recordings and labels become a model."""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sklearn.linear_model import LinearRegression
from sklearn.metrics import balanced_accuracy_score
from sklearn.model_selection import LeaveOneGroupOut, cross_val_predict
from sklearn.pipeline import Pipeline
from tqdm import tqdm

from eigenwalker._collect import Refusal
from eigenwalker.cli._label_table import labels_from_names, labels_from_table
from eigenwalker.cli._recordings import add_reading_arguments, load, reading_options
from eigenwalker.model.eigenwalkers import make_eigenwalkers
from eigenwalker.model.traits import TraitRegressor
from eigenwalker.motion.walk import Walk
from eigenwalker.persistence import save_model

HELP = "learn trait axes from recordings and labels"
DESCRIPTION = (
    "Read recordings, bring them to the treadmill frame, find the Eigenwalkers, learn a trait axis for each --trait, "
    "predict every person left out of the training, and save the model."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="recordings")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--labels", type=Path, metavar="CSV", help="table with columns file, person, TRAIT ...")
    source.add_argument(
        "--label-pattern", metavar="REGEX", help="labels out of the file names, such as 'walk_(?P<style>[a-z]+)_'"
    )
    parser.add_argument(
        "--trait", required=True, action="append", metavar="NAME", help="what to learn; may be repeated"
    )
    parser.add_argument("--group", metavar="COLUMN", help="column or pattern group that says which person a file is of")
    parser.add_argument("--out", required=True, type=Path, metavar="MODEL", help="file for the model, such as my.skops")
    parser.add_argument("--components", type=int, default=15, metavar="N", help="number of Eigenwalkers (15)")
    parser.add_argument("--harmonics", type=int, default=2, metavar="N", help="number of harmonics (2)")
    parser.add_argument("--skip-bad", action="store_true", help="leave out recordings that cannot be used")
    parser.add_argument("--jobs", type=int, metavar="N", help="number of processes for reading")
    add_reading_arguments(parser)


def run(options: argparse.Namespace) -> None:
    """Learn, predict, print and save."""
    columns = list(dict.fromkeys([*options.trait, *([options.group] if options.group else [])]))
    if options.labels:
        labels = labels_from_table(options.labels, options.files, columns)
    else:
        labels = labels_from_names(options.label_pattern, options.files, columns)
    walks, refusals = load(
        options.files, reading=reading_options(options), markers=options.markers, n_jobs=options.jobs
    )
    used = np.array([walk is not None for walk in walks])
    _report_refusals(refusals, labels, used, options)
    kept = [walk for walk in walks if walk is not None]
    traits = labels.loc[used, options.trait]
    persons = labels.loc[used, options.group].to_numpy() if options.group else None
    model = make_eigenwalkers(options.harmonics, options.components)
    _check_size(options.components, len(kept), persons)
    model.fit(kept, traits, trait__groups=persons)
    _report_model(model, kept)
    _report_prediction(model, kept, traits, persons)
    save_model(model, options.out)
    print(f"saved {options.out}; see a walk with:")
    print(f"  eigenwalker walk {options.out} --alpha {options.trait[0]}=2 --out walk.png")


def _report_refusals(
    refusals: Sequence[Refusal], labels: pd.DataFrame, used: NDArray[np.bool_], options: argparse.Namespace
) -> None:
    """Print how many recordings of each label were refused, and why; stop unless they may be skipped."""
    print(f"recordings: {len(used)}, refused: {len(refusals)}")
    if not refusals:
        return
    for trait in options.trait:
        if labels[trait].nunique() <= 10:
            counts = pd.DataFrame({"label": labels[trait].to_numpy(), "refused": ~used})
            for label, refused in counts.groupby("label")["refused"]:
                print(f"  {trait} {label}: {int(refused.sum())} of {len(refused)} refused")
    reasons = "\n".join(f"  {refusal.reason}" for refusal in refusals)
    if used.sum() == 0 or not options.skip_bad:
        advice = "" if options.skip_bad else "; mend them, or leave them out with --skip-bad"
        raise ValueError(f"{len(refusals)} of {len(used)} recordings were refused{advice}:\n{reasons}")
    print(reasons)


def _check_size(n_components: int, n_walks: int, persons: NDArray | None) -> None:
    largest = 1 if persons is None else int(pd.Series(persons).value_counts().max())
    if n_walks - largest <= n_components + 1:
        raise ValueError(
            f"{n_components} Eigenwalkers and a trait need more than {n_components + 1 + largest} walks, so that one "
            f"person can be left out, got {n_walks}; give more recordings or fewer --components"
        )


def _report_model(model: Pipeline, walks: list[Walk]) -> None:
    powers = 1 - model["linearizer"].residual_power(walks)
    print(f"explained power of {model['linearizer'].n_harmonics} harmonics: median {np.median(powers):.1%}")
    pca = model["eigenwalkers"]
    print(f"{pca.n_components_} Eigenwalkers hold {pca.explained_variance_ratio_.sum():.1%} of the variance")


def _report_prediction(model: Pipeline, walks: list[Walk], traits: pd.DataFrame, persons: NDArray | None) -> None:
    """Print how well each trait is predicted for persons left out, beside what tempo alone gives."""
    groups = np.arange(len(walks)) if persons is None else persons
    vectors = model["linearizer"].transform(walks)
    tempo = np.column_stack((vectors[:, -1], [walk.speed for walk in walks]))
    who = "one person" if persons is not None else "one recording"
    for trait in tqdm(traits.columns, desc="leaving out", delay=2):
        known = traits[trait].notna().to_numpy()
        labels, parts = traits.loc[known, [trait]], groups[known]
        axis = Pipeline([*model.steps[1:-1], ("trait", TraitRegressor())])
        guess = cross_val_predict(axis, vectors[known], labels, groups=parts, cv=LeaveOneGroupOut()).ravel()
        fitted = TraitRegressor().fit(vectors[known], labels)
        codes = fitted.encode(labels)[:, 0]
        print(f"{trait}, leaving out {who} at a time: {_agreement(codes, guess, fitted.is_two_valued(trait))}")
        if np.isfinite(tempo[known]).all():
            plain = cross_val_predict(LinearRegression(), tempo[known], codes, groups=parts, cv=LeaveOneGroupOut())
            print(f"  frequency and speed alone: {_agreement(codes, plain, fitted.is_two_valued(trait))}")
        if fitted.is_two_valued(trait):
            means = model["trait"].alpha_means_[trait]
            print("  mean alpha: " + ", ".join(f"{group} {alpha:+.2f}" for group, alpha in means.items()))
    if persons is None:
        print("every recording was taken for another person; if persons recur, name them with --group")


def _agreement(codes: NDArray[np.float64], guess: NDArray[np.float64], two_valued: bool) -> str:
    if not two_valued:
        return f"r = {np.corrcoef(codes, guess)[0, 1]:.2f} over {len(codes)} recordings"
    sides = np.where(guess > 0, 1.0, -1.0)
    larger = max(np.mean(codes > 0), np.mean(codes < 0))
    return (
        f"accuracy {np.mean(sides == codes):.1%}, balanced {balanced_accuracy_score(codes, sides):.1%} "
        f"over {len(codes)} recordings (always the larger group: {larger:.1%})"
    )
