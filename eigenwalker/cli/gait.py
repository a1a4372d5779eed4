"""``eigenwalker gait``: spatio-temporal measures of recordings."""

import argparse
from pathlib import Path

import pandas as pd

from eigenwalker.cli._recordings import add_collecting_arguments, add_recording_arguments, list_reasons, load
from eigenwalker.motion.gait import gait_table
from eigenwalker.motion.quality import walk_quality
from eigenwalker.motion.skeleton import TROJE15_AND_FEET
from eigenwalker.motion.walk import Walk

HELP = "cadence, speed, step length and so on of recordings"
DESCRIPTION = (
    "Read recordings, bring them to the treadmill frame, and print a table with one row a walk: steps, cadence, speed, "
    "stride length, step width, stance ratio, asymmetry, stride frequency, and the share of the motion that two "
    "harmonics of it explain. Markers of heels and toes are used where there are any."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="recordings")
    parser.add_argument("--out", type=Path, metavar="TABLE.csv", help="file for the table, with all digits")
    add_collecting_arguments(parser)
    add_recording_arguments(parser)


def run(options: argparse.Namespace) -> None:
    """Measure, print and write."""
    if options.out is not None and options.out.suffix.lower() != ".csv":
        raise ValueError(f"--out must end in .csv, got {options.out.name}")
    loaded = load(options.files, options, feet=True, n_jobs=options.jobs)
    walks = [walk for walk in loaded.walks if walk is not None]
    reasons = list_reasons(loaded.refusals)
    if loaded.refusals and not (options.skip_bad and walks):
        advice = "" if options.skip_bad else "; mend them, or leave them out with --skip-bad"
        raise ValueError(f"{len(loaded.refusals)} of {len(loaded.walks)} walks were refused{advice}:\n{reasons}")
    table = _measure(walks)
    print(table.round(3).to_string(index=False))
    if loaded.refusals:
        print(f"refused: {len(loaded.refusals)} of {len(loaded.walks)}\n{reasons}")
    if options.out is not None:
        table.to_csv(options.out, index=False)
        print(f"wrote {options.out}")


def _measure(walks: list[Walk]) -> pd.DataFrame:
    quality = [walk_quality(_without_feet(walk)) for walk in walks]
    return gait_table(walks).assign(
        frequency_hz=[one.frequency for one in quality], explained_power=[one.explained_power for one in quality]
    )


def _without_feet(walk: Walk) -> Walk:
    """Return the walk of the 15 markers, of which explained power is said, with or without heels and toes."""
    return walk.to_markers() if walk.marker_set is TROJE15_AND_FEET else walk
