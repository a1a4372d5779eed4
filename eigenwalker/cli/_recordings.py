"""Recordings named on the command line, read and prepared."""

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from eigenwalker._collect import Refusal, collect
from eigenwalker.cli._marker_map import read_marker_map
from eigenwalker.io.formats import read_walk
from eigenwalker.motion.preparation import prepare
from eigenwalker.motion.rig import Rig
from eigenwalker.motion.walk import Walk

__all__ = ["add_reading_arguments", "load", "reading_options"]


def add_reading_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that say what the numbers in a file mean."""
    parser.add_argument(
        "--unit", type=_unit, metavar="UNIT", help="unit of length: m, cm, mm, in or metres per unit (BVH: cm)"
    )
    parser.add_argument("--up", choices=("y", "z"), help="axis that points up in the files (BVH: y)")
    parser.add_argument("--frame-rate", type=float, metavar="HZ", help="frames per second, in place of the files'")
    parser.add_argument(
        "--markers",
        type=Path,
        metavar="MAP.json",
        help='which recorded markers make the 15, {"head": "HEAD", "left_knee": {"LKNE": 0.5, "LKNM": 0.5}, ...}',
    )


def _unit(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


def reading_options(options: argparse.Namespace) -> dict[str, object]:
    """Return the arguments of `read_walk` that were given."""
    given = {"unit": options.unit, "up": options.up, "frame_rate": options.frame_rate}
    return {name: value for name, value in given.items() if value is not None}


def load(
    paths: Sequence[Path], *, reading: dict[str, object], markers: Path | None = None, n_jobs: int | None = None
) -> tuple[list[Walk | None], list[Refusal]]:
    """Return the prepared walks, None where a file or its walk is refused, and the refusals.

    Parameters
    ----------
    paths : sequence of Path
        The files.
    reading : dict
        Arguments of `read_walk`.
    markers : Path, default None
        JSON file that says which recorded markers make the 15; see `read_marker_map`. None recognises known sets.
    n_jobs : int, default None
        Number of processes.
    """
    names = [str(path) for path in paths]
    rig = read_marker_map(markers) if markers is not None else None
    job = partial(_read_and_prepare, reading=reading, rig=rig)
    return collect(job, paths, names, n_jobs=n_jobs, progress=True, description="reading")


def _read_and_prepare(path: Path, *, reading: dict[str, object], rig: Rig | None) -> Walk:
    walk = read_walk(path, **reading)
    return prepare(walk if rig is None else walk.to_markers(rig))
