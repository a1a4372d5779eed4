"""What a judge and a ruler make of walks of adapted models: recognition, naturalness, resemblance, feet and joints."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pandas as pd

from benchmarks._findings import Check
from benchmarks._style_splits import Recorded, StyleSplit
from benchmarks._tables import print_table
from eigenwalker.experiment import (
    cut_alike,
    discriminate_walks,
    judge_styles,
    make_style_judge,
    rate_correlation,
    recognition_difference,
    recognition_table,
    resemblance_table,
    stride_variability,
    style_rates,
    variance_ratio,
)
from eigenwalker.hsmm import GaitHSMM
from eigenwalker.io import read_walks, write_walk
from eigenwalker.motion import JointWalk, joint_limits_exceeded, prepare, quality_table, stand_upright
from eigenwalker.motion.posture import lean_back

__all__ = ["judge_splits", "make_walks", "measure_files"]

_N_STEPS, _N_MADE = 14, 4
_DURATION = 5.0  # seconds that judges see
_LIMITS = {"worst_foot_slip_m_per_step": 0.001, "root_jump_m_per_s": 0.4}
_JUDGES = {
    "everything": {"harmonics": (1, 2, 3), "mean": True, "frequency": True, "share": 1.0, "noise": 0.0},
    "harmonics 1 to 3": {"harmonics": (1, 2, 3), "share": 1.0, "noise": 0.0},
    "harmonic 1, 6 of 21 joints, noise of 3 degrees": {},
    "harmonic 1, 3 of 21 joints, noise of 3 degrees": {"share": 0.15},
    "harmonic 1, 3 of 21 joints, noise of 6 degrees": {"share": 0.15, "noise": np.deg2rad(6)},
}
_N_JUDGES = 4  # of a kind in a split, where joints are picked at random
_ERRS = 0.1  # of recorded walks, by the judge of which targets are told


class _Shown(NamedTuple):
    """What is judged in a split: walks that are learned from, held-out ones and synthetic ones, with their styles."""

    train: list[JointWalk]
    train_styles: list[str]
    originals: list[JointWalk]
    original_styles: list[str]
    synthetics: list[JointWalk]
    synthetic_styles: list[str]


def judge_splits(
    splits: Sequence[Mapping[str, StyleSplit]], models: Sequence[Mapping[str, GaitHSMM]], *, complete: bool
) -> list[Check]:
    """Print what judges say of all splits, and how much the walks vary; a few walks alone have no target."""
    shown = [_show(split, model, number) for number, (split, model) in enumerate(zip(splits, models, strict=True))]
    targets = _recognize(shown)
    _discriminate(shown)
    _resemble(shown)
    return (targets if complete else []) + _vary(splits, models)


def make_walks(model: GaitHSMM, n_walks: int, **options: object) -> list[JointWalk]:
    """Return synthetic walks prepared as recorded ones are, with steps that differ as those of the model do."""
    options = {"durations": "sample"} | options
    made = [model.synthesize(_N_STEPS, random_state=seed, **options) for seed in range(n_walks)]
    return [prepare(walk, representation="joints") for walk in made]


def _show(split: Mapping[str, StyleSplit], models: Mapping[str, GaitHSMM], number: int) -> _Shown:
    train = [(one.steady, style) for style, part in split.items() for one in (*part.train, *part.validation)]
    test = [(one.steady, style) for style, part in split.items() for one in part.test]
    made = [
        (replace(walk, name=f"{style}, model {number}"), style)  # answers to walks of one model are alike
        for style, model in models.items()
        for walk in make_walks(model, _N_MADE)
    ]
    series = [cut_alike([walk for walk, _ in part], duration=_DURATION) for part in (train, test, made)]
    styles = [[style for _, style in part] for part in (train, test, made)]
    return _Shown(series[0], styles[0], series[1], styles[1], series[2], styles[2])


def _recognize(shown: Sequence[_Shown]) -> list[Check]:
    rows, trials = [], {name: _ask(shown, seen) for name, seen in _JUDGES.items()}
    for name, answers in trials.items():
        table = recognition_table(answers, n_choices=len(set(shown[0].train_styles)))
        change = recognition_difference(answers)
        rates = [f"{row.rate:.0%} ({row.low:.0%} to {row.high:.0%})" for row in table.itertuples()]
        efficiencies = " / ".join(f"{value:.2f}" for value in table["efficiency"])
        rows.append([name, *rates, efficiencies, f"{change.value:+.0%} ({change.low:+.0%} to {change.high:+.0%})"])
    header = ("what the judge sees", "original", "synthetic", "efficiency", "difference")
    print_table(f"Recognized, {len(shown)} splits; 95 % intervals", header, rows)
    errs = [name for name, answers in trials.items() if style_rates(answers)["original"].mean() <= 1 - _ERRS]
    judge = errs[0] if errs else list(trials)[-1]
    rates = style_rates(trials[judge])
    rows = [[str(style), *(f"{value:.0%}" for value in row)] for style, row in rates.iterrows()]
    print_table(f"By style: {judge}", ("", *map(str, rates.columns)), rows)
    linked = rate_correlation(rates)
    print(f"correlation over styles {linked.value:.2f}, 95 % interval {linked.low:.2f} to {linked.high:.2f}")
    low = recognition_difference(trials[judge]).low
    return [Check(f"synthetic less original, {judge}: above -10 %", f"from {low:+.1%}", bool(low > -0.1))]


def _ask(shown: Sequence[_Shown], seen: Mapping[str, object]) -> pd.DataFrame:
    """Return the answers of judges of one kind to the walks of all splits."""
    n_judges = 1 if seen.get("share") == 1.0 else _N_JUDGES
    answers = [
        judge_styles(*one, judge=make_style_judge(random_state=100 * at + number, **seen))
        for at, one in enumerate(shown)
        for number in range(n_judges)
    ]
    return pd.concat(answers, ignore_index=True)


def _discriminate(shown: Sequence[_Shown]) -> None:
    """Print whether synthetic walks are told from original ones, in styles that the judge has not learned from."""
    originals = [walk for one in shown for walk in one.originals]
    made = [walk for one in shown for walk in one.synthetics]
    groups = {
        "original_groups": [style for one in shown for style in one.original_styles],
        "synthetic_groups": [style for one in shown for style in one.synthetic_styles],
    }
    n_styles = len(set(groups["original_groups"]))
    rows = []
    for name, seen in (("harmonics, mean and frequency", None), ("harmonic 1, noise of 3 degrees", {"share": 1.0})):
        judge = None if seen is None else make_style_judge(random_state=0, **seen)
        found = discriminate_walks(originals, made, **groups, judge=judge, n_splits=n_styles)
        rows.append([name, *(f"{one.value:.2f} ({one.low:.2f} to {one.high:.2f})" for one in found[:2])])
    print_table("Synthetic told from original, in unknown styles; 0.5 by chance", ("", "accuracy", "area"), rows)


def _resemble(shown: Sequence[_Shown]) -> None:
    tables = pd.concat([resemblance_table(*one[2:]) for one in shown])
    medians = tables.groupby(level="style").median().drop(columns=["n_originals", "n_synthetics"])
    rows = [[name, *(f"{value:.3g}" for value in medians[name])] for name in medians.columns]
    print_table("Resemblance, medians over splits", ("", *map(str, medians.index)), rows)


def _vary(splits: Sequence[Mapping[str, StyleSplit]], models: Sequence[Mapping[str, GaitHSMM]]) -> list[Check]:
    """Print variances over time with and without the term of variance, and what differs from stride to stride."""
    rows = []
    for style in splits[0]:
        found = np.median(
            [_variation(split[style].test, model[style]) for split, model in zip(splits, models, strict=True)], axis=0
        )
        rows.append([style, *found])
    header = ("", "without", "with", "motion: mean", "sampled", "duration: mean", "sampled")
    printed = [[style, *(f"{value:.2f}" for value in values)] for style, *values in rows]
    print_table("Variance over time, and from stride to stride, over that of recordings", header, printed)
    plain, exact = (float(np.median([row[at] for row in rows])) for at in (1, 2))
    closer = f"{plain:.2f} without, {exact:.2f} with"
    return [Check("variance nearer to recordings with global variance", closer, abs(exact - 1) < abs(plain - 1))]


def _variation(test: Sequence[Recorded], model: GaitHSMM) -> list[float]:
    originals = cut_alike([one.steady for one in test], duration=_DURATION)
    ways = {"without": {"global_variance": None}, "mean": {"durations": "mean"}, "sampled": {}}
    made = {way: cut_alike(make_walks(model, 2, **options), duration=_DURATION) for way, options in ways.items()}
    ratios = [float(np.median(variance_ratio(made[way], originals))) for way in ("without", "sampled")]
    theirs = np.nanmedian([stride_variability(walk) for walk in originals], axis=0)
    ours = [np.nanmedian([stride_variability(walk) for walk in made[way]], axis=0) for way in ("mean", "sampled")]
    return [*ratios, *(float(one[column] / theirs[column]) for column in (0, 1) for one in ours)]


def measure_files(split: Mapping[str, StyleSplit], models: Mapping[str, GaitHSMM]) -> list[Check]:
    """Print measures of synthesized walks that were written as BVH and read again."""
    made, references = [], []
    for style, model in models.items():
        for durations in ("mean", "sample"):
            name = f"{style}_{durations}"
            made.append(model.synthesize(_N_STEPS, durations=durations, random_state=0, name=name))
            references.append(split[style].test[0])
    with TemporaryDirectory() as folder:
        paths = [Path(folder, f"{walk.name}.bvh") for walk in made]
        for walk, reference, path in zip(made, references, paths, strict=True):
            write_walk(lean_back(walk, reference.file), path, unit="cm")
        read = read_walks(paths, unit="cm")
    table = quality_table(read).set_index("name")
    table["limits_exceeded"] = [len(joint_limits_exceeded(stand_upright(walk))) for walk in read]
    originals = quality_table([one.steady for part in split.values() for one in part.test])
    columns = ["speed_m_per_s", *_LIMITS, "trailing_foot_slide_m", "foot_above_ground_m", "foot_below_ground_m"]
    rows = [
        [str(name), *(f"{value:.3g}" for value in row)]
        for name, row in zip(table.index, table[[*columns, "limits_exceeded"]].to_numpy(), strict=True)
    ]
    rows.append(["recorded, median", *(f"{value:.3g}" for value in originals[columns].median()), ""])
    print_table("Synthesized walks, read from BVH", ("", *columns, "limits_exceeded"), rows)
    limits = _LIMITS | {"limits_exceeded": 0}
    return [
        Check(f"{name} at most {limit:g}", f"largest {table[name].max():.3g}", bool((table[name] <= limit).all()))
        for name, limit in limits.items()
    ]
