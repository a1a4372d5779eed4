"""Styles from a dozen steps, and what a judge makes of them: ``python -m benchmarks.hsmm_styles [--short]``.

An average walk of bandai2's normal walks is adapted to each of the six other styles with 12 steps from inside of 3
walks, and asked how likely walks are that it has not seen, in nats a frame: the steps inside of them, as those it was
adapted to, and whole walks, first and last steps included. Weights of priors are those that `GaitHSMM.adapt` finds, by
holding the adaptation walks out in turn; classes and mixing are chosen on validation walks of the style. Then models
adapted to three whole walks, which start and stop, make walks, and a classifier that has learned styles from recorded
walks is asked about recorded and synthetic ones, as people were in the paper (section 6). Splits are at random; a style
is one source's in bandai2, so that styles of different sources may differ in their actor as well. The short form has
three styles, half of the average's walks, one split and given weights.
"""

import time
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import pandas as pd
from joblib import Parallel, delayed
from threadpoolctl import threadpool_limits

from benchmarks._command import finish, suite_parser
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._recordings import find_recordings, not_there
from benchmarks._style_judgment import judge_splits, measure_files
from benchmarks._style_splits import AVERAGE, Labeled, StyleSplit, load_styles, split_styles, take_steps
from benchmarks._tables import print_table
from eigenwalker.hsmm import GaitHSMM

_SHORT_STYLES = (AVERAGE, "elderly", "feminine")
_ALONE, _BEST = "style alone", "CSMAPLR + MAP"
_METHODS = {
    _ALONE: {"method": "map", "map_weight": 0.0},
    "MAP alone": {"method": "map"},
    "CMLLR": {"method": "cmllr"},
    "CMLLR + MAP": {"method": "cmllr+map"},
    _BEST: {"method": "csmaplr+map"},
    "CSMAPLR": {"method": "csmaplr"},
}
_N_WHOLE = 3  # walks of which walks are made: starts and stops are learned from starts and stops
_VARIANTS = {
    "joints, 1 class": {"mixing": "joints", "n_classes": 1},
    "none, 1 class": {"mixing": "none", "n_classes": 1},
    "joints, 4 classes": {"mixing": "joints", "n_classes": 4},
    "none, 4 classes": {"mixing": "none", "n_classes": 4},
}
_GIVEN = {"transform_weight": 10.0, "map_weight": 10.0}
_CURVE = (3, 6, 12, 24, 48)


class _Task(NamedTuple):
    """One style of one split, and what is done with it."""

    style: str
    seed: int
    split: StyleSplit
    average: GaitHSMM
    complete: bool


class _Done(NamedTuple):
    """Likelihoods, of methods, of variants and of numbers of steps, and the adapted model."""

    scores: list[dict[str, object]]
    variants: list[dict[str, object]]
    curve: list[dict[str, object]]
    weights: dict[str, object]
    model: GaitHSMM


def main() -> None:
    """Adapt, judge, and print what is reached."""
    parser = suite_parser(__doc__, short="three styles, one split, given weights")
    parser.add_argument("--splits", type=int, default=2, help="number of splits of the full form")
    arguments = parser.parse_args()
    finish(findings(short=arguments.short, n_splits=arguments.splits), arguments.out)


def findings(*, short: bool, n_splits: int = 2) -> list[Check]:
    """Adapt, judge, print what is reached, and return what is asked of it."""
    folder = find_recordings("bandai2")
    print(describe_machine())
    if not folder.is_dir():
        return not_there(folder)
    started = time.perf_counter()
    with threadpool_limits(limits=1):
        recorded = load_styles(folder, _SHORT_STYLES if short else None)
        print(f"{sum(map(len, recorded.values()))} walks of {len(recorded)} styles at 60 frames a second")
        seeds = [0] if short else list(range(n_splits))
        splits = [split_styles(recorded, seed) for seed in seeds]
        averages = Parallel(n_jobs=2)(delayed(_train_average)(split[AVERAGE], short) for split in splits)
        tasks = [
            _Task(style, seed, split[style], average, not short)
            for seed, split, average in zip(seeds, splits, averages, strict=True)
            for style in split
            if style != AVERAGE
        ]
        done = Parallel(n_jobs=2)(delayed(_adapt)(task) for task in tasks)
        checks = _print_likelihoods(done)
        models = [{AVERAGE: average} for average in averages]
        for task, found in zip(tasks, done, strict=True):
            models[seeds.index(task.seed)][task.style] = found.model
        checks += judge_splits(splits, models, complete=not short)
        checks += measure_files(splits[0], models[0])
    print(f"\n{time.perf_counter() - started:.0f} s")
    return checks


def _train_average(split: StyleSplit, short: bool) -> GaitHSMM:
    walks = [one.whole for one in split.train]
    with threadpool_limits(limits=1):
        return GaitHSMM().fit(walks[: len(walks) // 2] if short else walks)


def _adapt(task: _Task) -> _Done:
    """Return what all methods make of a style; those of a few steps alone have floors and states of the average."""
    steps, test = take_steps(task.split.train, 12), _held_out(task.split)
    who = {"style": task.style, "split": task.seed}
    scores, weights = [who | {"method": "average"} | _score(task.average, test)], {}
    with warnings.catch_warnings(), threadpool_limits(limits=1):
        warnings.simplefilter("ignore")  # of classes for which frames are too few: then there are fewer
        for name, method in _METHODS.items():
            given = {} if task.complete else _GIVEN
            model = task.average.adapt(*steps, **(given | method | _known(name, weights)))
            scores.append(who | {"method": name} | _score(model, test))
            weights[name] = {key: model.adaptation_[key] for key in _GIVEN}
        whole = [one.whole for one in task.split.train[:_N_WHOLE]]
        model = task.average.adapt(whole, method="csmaplr+map", **weights[_BEST])
        scores.append(who | {"method": f"{_BEST}, {_N_WHOLE} whole walks"} | _score(model, test))
        variants = _try_variants(task, steps, weights[_BEST], test) if task.complete else []
        curve = _curve(task, weights, test) if task.complete and task.seed == 0 else []
    return _Done(scores, [who | row for row in variants], [who | row for row in curve], who | weights, model)


def _known(name: str, weights: dict[str, dict[str, float]]) -> dict[str, float]:
    """Return the weight of transforms alone: that which was found for transforms with MAP."""
    return {"transform_weight": weights[_BEST]["transform_weight"]} if name == "CSMAPLR" else {}


def _held_out(split: StyleSplit) -> dict[str, Labeled]:
    """Return what is asked about; whole walks find their own steps."""
    return {
        "inside": take_steps(split.test),
        "whole": Labeled([one.whole for one in split.test], None),
        "validation": take_steps(split.validation),
    }


def _score(model: GaitHSMM, held_out: dict[str, Labeled]) -> dict[str, float]:
    return {name: model.score(*walks) for name, walks in held_out.items()}


def _try_variants(task: _Task, steps: Labeled, weights: dict, test: dict[str, Labeled]) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = [
        {"variant": name} | _score(task.average.adapt(*steps, method="csmaplr+map", **weights, **variant), test)
        for name, variant in _VARIANTS.items()
    ]
    return [*rows, max(rows, key=lambda row: row["validation"]) | {"variant": "chosen on validation walks"}]


def _curve(task: _Task, weights: dict, test: dict[str, Labeled]) -> list[dict[str, object]]:
    """Return likelihoods over the number of steps, at the weights that were found with 12."""
    rows: list[dict[str, object]] = []
    for n_steps in _CURVE:
        steps = take_steps(task.split.train, n_steps)
        for name in (_ALONE, "MAP alone", _BEST):
            model = task.average.adapt(*steps, **(weights[name] | _METHODS[name]))
            rows.append({"method": name, "steps": n_steps, "inside": model.score(*test["inside"])})
    return rows


def _print_likelihoods(done: Sequence[_Done]) -> list[Check]:
    scores = pd.DataFrame([row for part in done for row in part.scores])
    for where in ("inside", "whole"):
        table = scores.pivot_table(index=["style", "split"], columns="method", values=where)
        _print_methods(f"Held-out log-likelihood a frame, nats, {where} walks, 12 steps", table)
    chosen = pd.DataFrame([part.weights for part in done]).set_index(["style", "split"])
    rows = [
        [name, *(", ".join(f"{key:g}" for key in sorted({one[kind] for one in chosen[name]})) for kind in _GIVEN)]
        for name in _METHODS
    ]
    print_table("Weights that were chosen", ("", *_GIVEN), rows)
    if done[0].variants:
        variants = pd.DataFrame([row for part in done for row in part.variants])
        table = variants.pivot_table(index=["style", "split"], columns="variant", values="inside")
        _print_methods(f"{_BEST}: classes and mixing, inside walks", table[[*_VARIANTS, "chosen on validation walks"]])
        curve = pd.DataFrame([row for part in done for row in part.curve])
        medians = curve.pivot_table(index="method", columns="steps", values="inside", aggfunc="median")
        rows = [[str(name), *(f"{value:.4g}" for value in row)] for name, row in medians.iterrows()]
        print_table(
            "Over the number of steps: median of styles, inside walks, one split, weights of 12 steps",
            ("", *map(str, medians.columns)),
            rows,
        )
    return _compare(scores)


def _print_methods(title: str, table: pd.DataFrame) -> None:
    """Print medians of the styles and over all, how far the middle half of all reaches, and how often each is best."""
    by_style = table.groupby(level="style").median()
    best = table[[name for name in table if "whole walks" not in str(name)]].idxmax(axis=1)  # those have more steps
    order = table.median().sort_values().index
    rows = [
        [
            str(name),
            *(f"{value:.4g}" for value in by_style[name]),
            f"{table[name].median():.4g}",
            " to ".join(f"{table[name].quantile(q):.4g}" for q in (0.25, 0.75)),
            f"{(best == name).sum()} of {len(table)}",
        ]
        for name in order
    ]
    print_table(title, ("", *by_style.index, "median", "middle half", "best"), rows)


def _compare(scores: pd.DataFrame) -> list[Check]:
    table = scores.pivot_table(index=["style", "split"], columns="method", values="inside")
    checks = []
    for better, worse in ((_BEST, _ALONE), (_BEST, "MAP alone"), ("CMLLR + MAP", _ALONE), (_BEST, "average")):
        ahead = table[better] - table[worse]
        wins = int((ahead > 0).sum())
        measured = f"by {ahead.median():+.4g} nats a frame, in {wins} of {len(ahead)}"
        checks.append(Check(f"{better} above {worse} in most styles and splits", measured, wins > len(ahead) / 2))
    return checks


if __name__ == "__main__":
    main()
