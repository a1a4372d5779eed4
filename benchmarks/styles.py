"""Are synthesized walks recognized as the style they were made in? ``python -m benchmarks.styles [--short]``.

A judge, principal components and linear discriminant analysis on Fourier coefficients of joint angles, learns the seven
styles of bandai2 from recorded clips, and is asked about clips that it has not seen and about their synthesis: the
Fourier model of the clip, with strides that differ as those of the style do and feet that stand, linearized anew like a
recording. The
styles are acted, by few people, and each comes from one of three recording sources: with everything that a clip shows
any judge is at its ceiling, and agrees with any synthesis. So the judge is made worse, in the steps of the table, until
it errs: speed, frequency and mean posture are taken out, then harmonics, joints at random (others in each split), and
noise is added to the coefficients of all walks alike. A harmonic that the synthesis leaves out counts against it where
the judge sees it.

Rates are over clips and splits; intervals are of the mean difference between a clip and its synthesis over resampled
clips. The walks are looked for where EIGENWALKER_TEST_DATA says, else in ../shared/data.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sklearn.decomposition import PCA
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.model_selection import StratifiedShuffleSplit
from sklearn.pipeline import Pipeline, make_pipeline
from threadpoolctl import threadpool_limits

from benchmarks._command import run
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._recordings import find_recordings, not_there
from benchmarks._tables import print_table
from eigenwalker.io import read_walks
from eigenwalker.model import FourierLinearizer
from eigenwalker.motion import JointWalk, StrideVariation, prepare_walks, synthesize
from eigenwalker.motion.clip import cut

_JUDGED_HARMONICS = 3
_MADE_HARMONICS = 3
_HELD_OUT = 0.4
_WORSE = 0.05  # rate by which synthesis may be recognized less than recordings


class Judge(NamedTuple):
    """What a judge sees of a walk."""

    mean: bool = False
    frequency: bool = False
    harmonics: tuple[int, ...] = (1, 2, 3)
    joints: float = 1.0  # share
    noise: float = 0.0  # degrees


_JUDGES = {
    "everything": Judge(mean=True, frequency=True),
    "harmonics 1 to 3 only": Judge(),
    "harmonics 1 and 2": Judge(harmonics=(1, 2)),
    "harmonic 1": Judge(harmonics=(1,)),
    "harmonic 1, 6 of 21 joints": Judge(harmonics=(1,), joints=0.3),
    "harmonic 1, 6 joints, noise of 3 degrees": Judge(harmonics=(1,), joints=0.3, noise=3.0),
    "harmonics 1 to 3, 6 joints, noise of 3 degrees": Judge(joints=0.3, noise=3.0),
    "harmonic 3, 6 joints": Judge(harmonics=(3,), joints=0.3),
}
_SHORT = ("everything", "harmonic 1, 6 joints, noise of 3 degrees")
_JUDGED = "harmonic 1, 6 joints, noise of 3 degrees"  # the least that errs by more than a tenth


def findings(*, short: bool) -> list[Check]:
    """Print how often recordings and syntheses are recognized; of few clips and splits no rate is asked."""
    folder = find_recordings("bandai2")
    print(describe_machine())
    if not folder.is_dir():
        return not_there(folder)
    with threadpool_limits(limits=1):
        walks, styles = _load(folder, 8 if short else None)
        n_splits, n_seeds = (2, 1) if short else (20, 2)
        judges = {name: _JUDGES[name] for name in _SHORT} if short else _JUDGES
        low = _report(walks, styles, judges, n_splits=n_splits, n_seeds=n_seeds)
    wanted = f"synthesis less recorded, {_JUDGED}: above {-_WORSE:.0%}"
    return [Check(wanted, f"from {low:+.1%}", None if short else bool(low > -_WORSE))]


def _load(folder: Path, n_clips: int | None) -> tuple[list[JointWalk], NDArray[np.str_]]:
    """Return walks in joint angles and their styles."""
    files = pd.Series(sorted(folder.glob("*.bvh")))
    files = files[files.groupby(files.map(_style)).cumcount() < (n_clips or len(files))]
    walks = prepare_walks(read_walks(files), representation="joints")
    styles = files.map(_style).to_numpy(dtype=str)
    print(f"{len(walks)} walks of {len(set(styles))} styles, of {len(walks[0].channel_joints)} joints")
    return walks, styles


def _style(file: Path) -> str:
    return file.stem.split("_")[2]


def synthesize_like(walk: JointWalk, clip: JointWalk, variation: StrideVariation, seed: int) -> JointWalk:
    """Return the synthesis of a walk, as long as a clip, with strides that vary, feet on a treadmill.

    It starts at another phase; the judge linearizes it like a recording, frequency and phase included.
    """
    start = int(np.random.default_rng(seed).integers(round(clip.frame_rate)))
    made = synthesize(
        walk,
        duration=(clip.n_frames + start) / clip.frame_rate,
        frame_rate=clip.frame_rate,
        n_harmonics=variation.n_harmonics,
        travel=False,
        variation=variation,
        random_state=seed,
    )
    return replace(cut(made, slice(start, start + clip.n_frames)), frequency=np.nan)


class _Asked(NamedTuple):
    """Whether a clip, its synthesis, and the mean of its style were recognized in one split by one judge."""

    judge: str
    clip: int
    style: str
    recorded: bool
    synthesis: float
    style_mean: float


def _report(
    walks: Sequence[JointWalk],
    styles: NDArray[np.str_],
    judges: dict[str, Judge],
    *,
    n_splits: int,
    n_seeds: int,
) -> float:
    """Print rates, and return by how much synthesis may be recognized less, at the lower end of the interval."""
    seen = FourierLinearizer(_JUDGED_HARMONICS).fit(walks)
    vectors = seen.transform(walks)
    tempo = np.column_stack((vectors[:, -1], [walk.speed for walk in walks]))
    splits = StratifiedShuffleSplit(n_splits, test_size=_HELD_OUT, random_state=0).split(vectors, styles)
    asked, plain = [], []
    for split, (train, test) in enumerate(splits):
        made, means = _synthesize(walks, styles, train, test, n_seeds=n_seeds, seed=1000 * split)
        made_vectors = [seen.transform(some) for some in made]
        mean_vectors = seen.transform(means)
        plain.append(LinearDiscriminantAnalysis().fit(tempo[train], styles[train]).score(tempo[test], styles[test]))
        for name, judge in judges.items():
            view = _View(judge, seen, np.random.default_rng(split))
            recognizes = view.learn(vectors[train], styles[train])
            right = [recognizes(some, styles[test]) for some in (vectors[test], *made_vectors)]
            right_means = pd.Series(recognizes(mean_vectors, np.unique(styles)), np.unique(styles))
            asked += [
                _Asked(
                    name,
                    clip,
                    styles[clip],
                    right[0][row],
                    np.mean([r[row] for r in right[1:]]),
                    right_means[styles[clip]],
                )
                for row, clip in enumerate(test)
            ]
    table = pd.DataFrame(asked)
    _print(table, judges, n_splits)
    print(f"frequency and speed of recordings alone: {np.mean(plain):.1%}; by chance {1 / len(set(styles)):.1%}")
    _print_styles(table)
    return _difference(table[table["judge"] == _JUDGED])[1]


def _synthesize(
    walks: Sequence[JointWalk],
    styles: NDArray[np.str_],
    train: NDArray[np.intp],
    test: NDArray[np.intp],
    *,
    n_seeds: int,
    seed: int,
) -> tuple[list[list[JointWalk]], list[JointWalk]]:
    """Return for each seed a synthesis of every clip in `test`, and one of each style's mean over `train`."""
    linearizer = FourierLinearizer(_MADE_HARMONICS).fit(walks)
    vectors = linearizer.transform(walks)
    typical = {
        name: linearizer.inverse_transform(vectors[[one for one in train if styles[one] == name]].mean(axis=0)[None])[0]
        for name in np.unique(styles)
    }
    names = np.unique(styles)
    of_style = {name: [one for one in train if styles[one] == name] for name in names}
    varied = {
        name: StrideVariation.from_walks([walks[one] for one in clips], n_harmonics=_MADE_HARMONICS)
        for name, clips in of_style.items()
    }
    made = [
        [
            synthesize_like(walks[clip], walks[clip], varied[styles[clip]], seed + 100 * turn + place)
            for place, clip in enumerate(test)
        ]
        for turn in range(n_seeds)
    ]
    means = [
        synthesize_like(typical[name], walks[of_style[name][0]], varied[name], seed + place)
        for place, name in enumerate(names)
    ]
    return made, means


class _View:
    """The features that a judge sees, other joints and other noise in every split."""

    def __init__(self, judge: Judge, linearizer: FourierLinearizer, random: np.random.Generator) -> None:
        self._judge, self._random = judge, random
        joints = linearizer.template_.channel_joints
        picked = random.choice(len(joints), max(1, round(judge.joints * len(joints))), replace=False)
        blocks = ([0] if judge.mean else []) + [row for k in judge.harmonics for row in (2 * k - 1, 2 * k)]
        channels = (3 * np.sort(picked)[:, np.newaxis] + np.arange(3)).ravel()
        n_channels = 3 * len(joints)
        self._columns = np.concatenate([n_channels * block + channels for block in blocks])
        self._last = [(2 * linearizer.n_harmonics + 1) * n_channels] if judge.frequency else []

    def see(self, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
        angles = vectors[:, self._columns]
        noisy = angles + np.deg2rad(self._judge.noise) * self._random.normal(size=angles.shape)
        return np.column_stack((noisy, vectors[:, self._last]))

    def learn(self, vectors: NDArray[np.float64], styles: NDArray[np.str_]):
        """Return a function that says of walks whether they are recognized."""
        seen = self.see(vectors)
        n_components = min(40, seen.shape[1], len(seen) // 2)
        judge: Pipeline = make_pipeline(PCA(n_components, random_state=0), LinearDiscriminantAnalysis())
        judge.fit(seen, styles)
        return lambda some, truth: judge.predict(self.see(some)) == truth


def _difference(table: pd.DataFrame) -> tuple[float, float, float]:
    """Return by how much synthesis is recognized more often than recordings, and its 95 % interval over clips."""
    clips = (table["synthesis"] - table["recorded"]).groupby(table["clip"]).agg(["sum", "count"]).to_numpy(dtype=float)
    random = np.random.default_rng(0)
    drawn = clips[random.integers(len(clips), size=(4000, len(clips)))].sum(axis=1)
    low, high = np.quantile(drawn[:, 0] / drawn[:, 1], [0.025, 0.975])
    total = clips.sum(axis=0)
    return float(total[0] / total[1]), float(low), float(high)


def _print(table: pd.DataFrame, judges: dict[str, Judge], n_splits: int) -> None:
    rows = []
    for name in judges:
        part = table[table["judge"] == name]
        mean, low, high = _difference(part)
        rates = [f"{part[column].mean():.1%}" for column in ("recorded", "synthesis", "style_mean")]
        rows.append([name, *rates, f"{mean:+.1%}", f"{low:+.1%} to {high:+.1%}"])
    header = ("what the judge sees", "recorded", "synthesis", "mean of style", "difference", "95 % interval")
    print_table(f"Recognized among {table['style'].nunique()} styles, {n_splits} splits", header, rows)


def _print_styles(table: pd.DataFrame) -> None:
    part = table[table["judge"] == _JUDGED]
    rates = part.groupby("style")[["recorded", "synthesis", "style_mean"]].mean()
    rows = [
        [str(style), *(f"{rate:.1%}" for rate in row)] for style, row in zip(rates.index, rates.to_numpy(), strict=True)
    ]
    print_table(f"By style: {_JUDGED}", ("style", "recorded", "synthesis", "mean of style"), rows)


if __name__ == "__main__":
    run(findings, __doc__, short="few clips, splits and judges")
