"""Recordings named on the command line, read and prepared."""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from eigenwalker._collect import Refusal, collect
from eigenwalker.cli._file_names import name_depth, short_name
from eigenwalker.cli._preparation import (
    Preparation,
    add_preparation_arguments,
    find_walks,
    make_preparation,
)
from eigenwalker.io.formats import read_walk
from eigenwalker.motion.preparation import prepare
from eigenwalker.motion.walk import JointWalk

__all__ = [
    "Loaded",
    "add_collecting_arguments",
    "add_reading_arguments",
    "add_recording_arguments",
    "list_reasons",
    "load",
    "load_prepared",
    "reading_options",
]

_Prepared = tuple[list[Any], list[Refusal]]


class Loaded(NamedTuple):
    """What came of recordings.

    Parameters
    ----------
    walks : list of Walk, JointWalk or None
        One for each recording or each of its passes; None where it was refused.
    files : list of int
        Which of the files each of them is from.
    refusals : list of Refusal
        The reasons, in the same order.
    """

    walks: list[Any]
    files: list[int]
    refusals: list[Refusal]


def add_recording_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that say what the numbers in a file mean, and those of `add_preparation_arguments`."""
    add_reading_arguments(parser)
    add_preparation_arguments(parser)


def add_reading_arguments(parser: argparse.ArgumentParser, *, frame_rate: bool = True) -> None:
    """Add the arguments that say what the numbers in a file mean, with or without the frame rate."""
    group = parser.add_argument_group("what the numbers in the files mean")
    group.add_argument(
        "--unit", type=_unit, metavar="UNIT", help="unit of length: m, cm, mm, in or metres per unit (BVH: cm)"
    )
    group.add_argument("--up", choices=("y", "z"), help="axis that points up in the files (BVH: y)")
    if frame_rate:
        group.add_argument("--frame-rate", type=float, metavar="HZ", help="frames per second, in place of the files'")


def _unit(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


def add_collecting_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of commands that take many recordings."""
    group = parser.add_argument_group("many recordings")
    group.add_argument("--skip-bad", action="store_true", help="leave out recordings that cannot be used")
    group.add_argument("--jobs", type=int, metavar="N", help="number of processes for reading")


def load(
    paths: Sequence[Path], options: argparse.Namespace, *, feet: bool = False, n_jobs: int | None = None
) -> Loaded:
    """Return the prepared walks in files, and the refusals.

    Parameters
    ----------
    paths : sequence of Path
        The files.
    options : Namespace
        With the arguments of `add_recording_arguments`.
    feet : bool, default False
        Whether markers of heels and toes are kept where there are any.
    n_jobs : int, default None
        Number of processes.
    """
    reading = reading_options(options)
    return load_prepared(paths, make_preparation(options, reading=reading, feet=feet), reading=reading, n_jobs=n_jobs)


def load_prepared(
    paths: Sequence[Path], preparation: Preparation, *, reading: Mapping[str, object], n_jobs: int | None = None
) -> Loaded:
    """Return the walks in files, prepared in one way, and the refusals.

    Parameters
    ----------
    paths : sequence of Path
        The files.
    preparation : Preparation
        What becomes of every recording.
    reading : dict
        Arguments of `read_walk`.
    n_jobs : int, default None
        Number of processes.
    """
    job = partial(_read_and_prepare, reading=reading, preparation=preparation)
    depth = name_depth(paths)
    found, refusals = collect(
        job,
        [(path, short_name(path, depth)) for path in paths],
        [str(path) for path in paths],
        n_jobs=n_jobs,
        progress=True,
        description="reading",
    )
    unread = iter(refusals)
    outcomes: list[_Prepared] = [one if one is not None else ([None], [next(unread)]) for one in found]
    return Loaded(
        walks=_with_shared_joints([walk for walks, _ in outcomes for walk in walks]),
        files=[file for file, (walks, _) in enumerate(outcomes) for _ in walks],
        refusals=[refusal for _, refused in outcomes for refusal in refused],
    )


def _with_shared_joints(walks: list[Any]) -> list[Any]:
    """Return walks in which those in joint angles have the channels of all joints that turn in any of them."""
    turned = [walk for walk in walks if isinstance(walk, JointWalk)]
    if len({walk.skeleton.joint_names for walk in turned}) != 1:
        return walks  # those of different skeletons are refused where they are put together
    joints = tuple({joint for walk in turned for joint in walk.channel_joints or walk.skeleton.joint_names})
    return [replace(walk, channel_joints=joints) if isinstance(walk, JointWalk) else walk for walk in walks]


def reading_options(options: argparse.Namespace) -> dict[str, object]:
    """Return the arguments of `read_walk` that were given."""
    given = {name: getattr(options, name, None) for name in ("unit", "up", "frame_rate")}
    return {name: value for name, value in given.items() if value is not None}


def _read_and_prepare(file: tuple[Path, str], *, reading: Mapping[str, object], preparation: Preparation) -> _Prepared:
    path, name = file
    walks = find_walks(replace(read_walk(path, **reading), name=name), preparation)
    return collect(partial(prepare, **preparation.options), walks, [walk.name for walk in walks])


def list_reasons(refusals: Sequence[Refusal]) -> str:
    """Return one line a refusal."""
    return "\n".join(
        f"  {refusal.reason}" if refusal.name in refusal.reason else f"  {refusal.name}: {refusal.reason}"
        for refusal in refusals
    )
