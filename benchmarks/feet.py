"""Do the feet of synthesized walks stand? ``python -m benchmarks.feet [--short]``, on the walks of bandai2.

Each walk is synthesized for 10 s at 60 frames a second, written as BVH, read again and measured by `quality_table`,
whose rule for when a foot stands is not that by which feet are planted. Beside it, measured by the same rule: the
recording, and two plainer ways to make a walk of the same harmonics. *Positions* are harmonics of the 15 markers, heels
and toes, in which bones have no length; *lowest point* moves the root such that the lowest point of both feet stays
where it is. The walks are looked for where EIGENWALKER_TEST_DATA says, else in ../shared/data.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from benchmarks._command import run
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._recordings import find_recordings, not_there
from benchmarks._tables import print_table
from eigenwalker.io import read_walks, write_walk
from eigenwalker.motion import (
    JointWalk,
    Walk,
    evaluate_harmonics,
    fit_harmonics,
    prepare_walks,
    quality_table,
    sole_points,
    stride_frequency,
    synthesize,
)
from eigenwalker.motion.legs import find_legs, pose_legs
from eigenwalker.motion.posture import lean_back
from eigenwalker.motion.skeleton import TROJE15_AND_FEET

__all__ = ["LINES", "measure", "misses", "style"]

_DURATION, _FRAME_RATE, _N_HARMONICS = 10.0, 60.0, 3

LINES = {
    "bone_length_error_m": 1e-9,
    "worst_foot_slip_m_per_step": 0.001,
    "slides_further_m": 0.0,
    "foot_above_ground_m": 0.005,
    "lower_than_original_m": 0.005,
    "speed_error": 0.05,
    "root_jump_m_per_s": 0.4,
    "knee_change_deg": 15.0 + 1e-6,  # the bound itself, but for rounding
}
"""What each measure of a synthesized walk must not be above."""

_SHOWN = [*LINES, "trailing_foot_slide_m", "bone_length_variation_m", "jerk_m_per_s3"]


def findings(*, short: bool) -> list[Check]:
    """Measure the walks, print what is kept and what is not, and return it line by line."""
    folder = find_recordings("bandai2")
    print(describe_machine())
    if not folder.is_dir():
        return not_there(folder)
    files = pd.Series(sorted(folder.glob("*.bvh")))
    files = files[files.groupby(files.map(lambda file: style(file.stem))).cumcount() < (2 if short else len(files))]
    return _report(measure(read_walks(files)))


def style(name: str) -> str:
    """Return the style in the name of a walk of bandai2."""
    return name.split("_")[2]


def measure(recorded: Sequence[JointWalk]) -> dict[str, pd.DataFrame]:
    """Return a table of measures for each way of making walks, one row a walk, and that of the recordings."""
    walks = prepare_walks(recorded, representation="joints")
    originals = prepare_walks(recorded, representation="joints", treadmill=False)
    options = {"duration": _DURATION, "frame_rate": _FRAME_RATE, "n_harmonics": _N_HARMONICS}
    made, free = synthesize(walks, **options), synthesize(walks, **options, hold=False)
    with TemporaryDirectory() as folder:
        paths = [Path(folder, f"{walk.name}.bvh") for walk in made]
        for walk, original, path in zip(made, recorded, paths, strict=True):
            write_walk(lean_back(walk, original), path, unit="cm")
        read = read_walks(paths, unit="cm")
    tables = {
        "recorded": quality_table(originals),
        "synthesized": quality_table(read),
        "without reaching": quality_table(free),
        "positions": quality_table([_by_positions(walk) for walk in walks]),
        "lowest point": quality_table([_by_lowest_point(walk) for walk in free]),
    }
    original = tables["recorded"]
    for table in tables.values():
        table["slides_further_m"] = table["trailing_foot_slide_m"] - original["trailing_foot_slide_m"]
        table["lower_than_original_m"] = table["foot_below_ground_m"] - original["foot_below_ground_m"]
        table["speed_error"] = np.abs(table["speed_m_per_s"] / [walk.speed for walk in walks] - 1)
    pairs = list(zip(read, recorded, strict=True))
    tables["synthesized"]["bone_length_error_m"] = [_bone_error(*pair) for pair in pairs]
    tables["synthesized"]["knee_change_deg"] = [_knee_change(*pair) for pair in zip(made, free, strict=True)]
    return tables


def misses(table: pd.DataFrame) -> pd.DataFrame:
    """Return by how much each walk (rows) is above each line (columns), NaN where it is not."""
    above = table.set_index("name")[list(LINES)] - pd.Series(LINES)
    return above.where(~(above <= 0)).dropna(how="all")


def _bone_error(walk: JointWalk, original: JointWalk) -> float:
    """Return by how much a bone of a walk differs in any frame from that of another walk's skeleton, in metres."""
    places, parents = walk.joint_positions(), walk.skeleton.parents
    bones = [joint for joint in range(1, len(parents)) if joint != walk.skeleton.root]
    lengths = np.linalg.norm(places[:, bones] - places[:, parents[bones]], axis=2)
    return float(np.abs(lengths - np.linalg.norm(original.skeleton.offsets[bones], axis=1)).max())


def _knee_change(walk: JointWalk, free: JointWalk) -> float:
    """Return by how many degrees the flexion of a knee differs between two walks at most."""
    return float(np.abs(_flexion(walk) - _flexion(free)).max())


def _flexion(walk: JointWalk) -> NDArray[np.float64]:
    """Return the angles between thigh and shank, shape (n_frames, 2), in degrees."""
    legs, places = find_legs(walk.skeleton), walk.joint_positions()
    hip, knee, ankle = (places[:, legs.joints[column]] for column in legs.chain.T)
    thigh, shank = knee - hip, ankle - knee
    across = np.linalg.norm(np.cross(thigh, shank), axis=2)
    return np.rad2deg(np.arctan2(across, (thigh * shank).sum(axis=2)))


def _by_positions(walk: JointWalk) -> Walk:
    """Return a walk of harmonics of positions, over the floor at the speed of the recording."""
    markers = walk.to_markers()
    feet = sole_points(walk)[:, :, [0, 2]].reshape(walk.n_frames, 4, 3)  # (n_frames, 2, 2, 3) -> (n_frames, 4, 3)
    channels = np.concatenate((markers.positions, feet), axis=1).reshape(walk.n_frames, -1)
    frequency = stride_frequency(walk)
    times = np.arange(round(_DURATION * _FRAME_RATE)) / _FRAME_RATE
    coefficients = fit_harmonics(channels, walk.frame_rate, frequency, _N_HARMONICS)
    positions = evaluate_harmonics(coefficients, frequency, times).reshape(len(times), -1, 3)
    positions[..., 0] += walk.speed * times[:, np.newaxis]
    return Walk(positions, _FRAME_RATE, TROJE15_AND_FEET, walk.name)


def _by_lowest_point(walk: JointWalk) -> JointWalk:
    """Return a walk whose root goes such that the lowest point of both feet stays where it is."""
    legs = find_legs(walk.skeleton)
    points = pose_legs(walk.rotations, np.zeros((walk.n_frames, 3)), legs).soles.reshape(walk.n_frames, 6, 3)
    lowest = (points[1:, :, 2] + points[:-1, :, 2]).argmin(axis=1)
    steps = -np.diff(points[..., :2], axis=0)[np.arange(len(lowest)), lowest]
    root = np.zeros((walk.n_frames, 3))
    np.cumsum(steps, axis=0, out=root[1:, :2])
    root[:, 2] = -points[..., 2].min(axis=1)
    top = walk.skeleton.offsets[walk.skeleton.above(walk.skeleton.root)].sum(axis=0)
    return replace(walk, root=root - top)


def _report(tables: dict[str, pd.DataFrame]) -> list[Check]:
    for quantile, title in ((0.5, "Median over walks"), (1.0, "Largest")):
        values = {way: table.reindex(columns=_SHOWN).quantile(quantile) for way, table in tables.items()}
        rows = [[name, *(f"{values[way][name]:.3g}" for way in tables)] for name in _SHOWN]
        print_table(f"{title}, {len(tables['recorded'])} walks", ["", *tables], rows)
    made = tables["synthesized"]
    medians = made.groupby(made["name"].map(style))[_SHOWN].median()
    rows = [[name, *(f"{value:.3g}" for value in medians[name])] for name in _SHOWN]
    print_table("Synthesized, median of each style", ["", *medians.index], rows)
    missed = misses(made)
    if len(missed):
        columns = [name for name in LINES if missed[name].notna().any()]
        rows = [
            [str(name), *("" if np.isnan(value) else f"{value:.2g}" for value in row)]
            for name, row in zip(missed.index, missed[columns].to_numpy(), strict=True)
        ]
        print_table("Walks above a line, by how much", ["", *columns], rows)
    counts = {name: int((~(made[name] <= limit)).sum()) for name, limit in LINES.items()}
    return [
        Check(
            f"{name} at most {limit:g}", f"largest {made[name].max():.3g}, {counts[name]} walks above", not counts[name]
        )
        for name, limit in LINES.items()
    ]


if __name__ == "__main__":
    run(findings, __doc__, short="two walks of each style")
