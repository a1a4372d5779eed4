"""``eigenwalker fit``: recordings and labels become a model."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sklearn.pipeline import Pipeline

from eigenwalker.cli._label_table import labels_from_names, labels_from_table
from eigenwalker.cli._prediction import report_prediction
from eigenwalker.cli._recordings import (
    Loaded,
    add_collecting_arguments,
    add_recording_arguments,
    list_reasons,
    load,
)
from eigenwalker.cli._styles import one_against_rest, poles_of, style_columns
from eigenwalker.model.eigenwalkers import make_eigenwalkers
from eigenwalker.model.traits import TraitRegressor
from eigenwalker.motion.strides import pool_walks
from eigenwalker.persistence import save_model

HELP = "learn trait axes from recordings and labels"
DESCRIPTION = (
    "Read recordings, bring them to the treadmill frame, find the Eigenwalkers, learn a trait axis for each --trait, "
    "predict every person left out of the training, and save the model."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="recordings")
    parser.add_argument("--out", required=True, type=Path, metavar="MODEL", help="file for the model, such as my.skops")
    _add_label_arguments(parser.add_argument_group("labels"))
    model = parser.add_argument_group("the model")
    model.add_argument(
        "--representation",
        choices=("markers", "joints"),
        default="markers",
        help="what is learned: paths of 15 markers, or joint angles, for files with a skeleton such as BVH (markers)",
    )
    model.add_argument("--components", type=int, default=15, metavar="N", help="number of Eigenwalkers (15)")
    model.add_argument("--harmonics", type=int, default=2, metavar="N", help="number of harmonics (2)")
    model.add_argument(
        "--scaling",
        choices=("blocks", "features", "noise", "none"),
        default="blocks",
        help="what is brought to one scale: frequency and posture; every feature; every feature by how much it varies "
        "within a person (--group), for noisy sensors; or nothing (blocks)",
    )
    add_collecting_arguments(parser)
    add_recording_arguments(parser)


def _add_label_arguments(group: argparse._ArgumentGroup) -> None:
    source = group.add_mutually_exclusive_group(required=True)
    source.add_argument("--labels", type=Path, metavar="CSV", help="table with columns file, person, TRAIT ...")
    source.add_argument(
        "--label-pattern",
        metavar="REGEX",
        help="labels out of the file names, such as 'walk_(?P<style>[a-z]+)_', or out of the paths, if there is a / in "
        "it, such as '(?P<person>[^/]+)/[^/]+$'",
    )
    group.add_argument(
        "--trait",
        required=True,
        action="append",
        metavar="NAME",
        help="what to learn: numbers, two words, or more words, each of which becomes an axis against the rest, "
        "style=sad; may be repeated",
    )
    group.add_argument("--group", metavar="COLUMN", help="column or pattern group that says which person a file is of")
    group.add_argument(
        "--pool",
        choices=("recording", "person"),
        help="put walks together, stride by stride: all --passes of a recording, or all walks of a person (--group)",
    )


def run(options: argparse.Namespace) -> None:
    """Learn, predict, print and save."""
    _check(options)
    columns = list(dict.fromkeys([*options.trait, *([options.group] if options.group else [])]))
    if options.labels:
        labels = labels_from_table(options.labels, options.files, columns)
    else:
        labels = labels_from_names(options.label_pattern, options.files, columns)
    loaded = load(options.files, options, n_jobs=options.jobs)
    labels = labels.iloc[loaded.files]
    used = np.array([walk is not None for walk in loaded.walks])
    _report_refusals(loaded, labels, used, options)
    walks = [walk for walk in loaded.walks if walk is not None]
    labels = labels[used]
    if options.pool is not None:
        walks, labels = _pool(walks, labels, options)
    persons = labels[options.group].to_numpy() if options.group else None
    groups = persons if persons is not None else labels.index.to_numpy()  # passes of a recording stay together
    styles = style_columns(labels[options.trait])
    traits = one_against_rest(labels[options.trait], groups)
    model = make_eigenwalkers(
        options.harmonics,
        options.components,
        scaling=None if options.scaling == "none" else options.scaling,
        trait=TraitRegressor(poles=poles_of(styles) or None),
    )
    _check_size(options.components, groups)
    noise = {"scaler__groups": persons} if options.scaling == "noise" and persons is not None else {}
    model.fit(walks, traits, trait__groups=persons, **noise)
    _report_model(model, walks)
    who = "recording" if persons is None else "person"
    report_prediction(model, walks, traits, groups, noise, who=who, styles=styles)
    save_model(model, options.out)
    print(f"saved {options.out}; see a walk with:")
    ending = "bvh" if options.representation == "joints" else "png"
    print(f"  eigenwalker walk {options.out} --alpha {traits.columns[0]}=2 --out walk.{ending}")


def _check(options: argparse.Namespace) -> None:
    """Raise before all the reading if arguments do not go together."""
    pool, noise = options.pool, options.scaling == "noise"
    group = "needs --group, the column that says which person a file is of"
    faults = [
        (pool is not None and options.representation == "joints", "--pool puts walks of markers together, not joints"),
        (pool == "recording" and not options.passes, "--pool recording puts passes together; it needs --passes"),
        (pool == "person" and options.group is None, f"--pool person {group}"),
        (noise and options.group is None, f"--scaling noise {group}"),
        (noise and pool == "person", "--scaling noise compares a person's walks, but --pool person leaves only one"),
    ]
    if any(is_there for is_there, _ in faults):
        raise ValueError("; ".join(fault for is_there, fault in faults if is_there))


def _report_refusals(
    loaded: Loaded, labels: pd.DataFrame, used: NDArray[np.bool_], options: argparse.Namespace
) -> None:
    """Print how many walks of each label were refused, and why; stop unless they may be skipped."""
    what = "recordings" if not options.passes else "passes"
    counted = f"recordings: {len(options.files)}, " + (f"passes: {len(used)}, " if options.passes else "")
    print(f"{counted}refused: {len(loaded.refusals)}")
    if not loaded.refusals:
        return
    for trait in options.trait:
        if labels[trait].nunique() <= 10:
            counts = pd.DataFrame({"label": labels[trait].to_numpy(), "refused": ~used})
            for label, refused in counts.groupby("label")["refused"]:
                print(f"  {trait} {label}: {int(refused.sum())} of {len(refused)} refused")
    reasons = list_reasons(loaded.refusals)
    if used.sum() == 0 or not options.skip_bad:
        advice = "" if options.skip_bad else "; mend them, or leave them out with --skip-bad"
        raise ValueError(f"{len(loaded.refusals)} of {len(used)} {what} were refused{advice}:\n{reasons}")
    print(reasons)


def _pool(walks: list[Any], labels: pd.DataFrame, options: argparse.Namespace) -> tuple[list[Any], pd.DataFrame]:
    """Return one walk a recording or person, and its labels."""
    owners = np.array(
        [str(owner) for owner in (labels.index if options.pool == "recording" else labels[options.group])]
    )
    varied = labels.groupby(owners)[options.trait].nunique(dropna=False).gt(1)
    faults = [f"{trait} of {', '.join(varied.index[varied[trait]][:10])}" for trait in varied if varied[trait].any()]
    if faults:
        raise ValueError(f"--pool person makes one walk with one label, but there are several: {'; '.join(faults)}")
    pooled = pool_walks(walks, owners, on_error="skip" if options.skip_bad else "raise")
    print(f"pooled: {len(walks)} walks of {len(pooled)} {options.pool}s")
    firsts = labels.set_index(owners)
    return pooled, firsts[~firsts.index.duplicated()].loc[[walk.name for walk in pooled]]


def _check_size(n_components: int, groups: NDArray) -> None:
    largest = int(pd.Series(groups).value_counts().max())
    if len(groups) - largest <= n_components + 1:
        raise ValueError(
            f"{n_components} Eigenwalkers and a trait need more than {n_components + 1 + largest} walks, so that one "
            f"person can be left out, got {len(groups)}; give more recordings or fewer --components"
        )


def _report_model(model: Pipeline, walks: list[Any]) -> None:
    powers = 1 - model["linearizer"].residual_power(walks)
    print(f"explained power of {model['linearizer'].n_harmonics} harmonics: median {np.median(powers):.1%}")
    pca = model["eigenwalkers"]
    print(f"{pca.n_components_} Eigenwalkers hold {pca.explained_variance_ratio_.sum():.1%} of the variance")
