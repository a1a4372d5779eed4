"""Recordings of ordinary walks and of a style, as gait models take them."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from eigenwalker._collect import collect
from eigenwalker.cli._label_table import labels_from_table
from eigenwalker.cli._preparation import Preparation
from eigenwalker.cli._recordings import list_reasons, load_prepared, reading_options
from eigenwalker.hsmm.step_labels import Steps, label_steps
from eigenwalker.motion.template import check_alike
from eigenwalker.motion.walk import JointWalk

__all__ = ["StyleWalks", "load_style_walks", "read_walkers"]


class StyleWalks(NamedTuple):
    """Walks of one kind, whose steps are known.

    Parameters
    ----------
    walks : list of JointWalk
        Whole walks in joint angles.
    files : list of Path
        The file of each.
    n_steps : int
        Of all of them.
    """

    walks: list[JointWalk]
    files: list[Path]
    n_steps: int


def load_style_walks(
    average: Sequence[Path], style: Sequence[Path], options: argparse.Namespace
) -> tuple[StyleWalks, StyleWalks]:
    """Return the walks of the average model, and those of the style, all with the channels of the same joints.

    Parameters
    ----------
    average, style : sequence of Path
        Their files; one may be among both.
    options : Namespace
        With the arguments for reading, with `rate`, to which all are resampled, and `skip_bad`.

    Raises
    ------
    ValueError
        If recordings are refused and may not be left out, all of them at once; if none is left; or if their joints
        differ.
    """
    files = list(dict.fromkeys([*average, *style]))
    preparation = Preparation(
        joints=True, options={"representation": "joints", "clip": "whole", "frame_rate": options.rate}
    )
    loaded = load_prepared(files, preparation, reading=reading_options(options), n_jobs=options.jobs)
    found = [(files[at], walk) for at, walk in zip(loaded.files, loaded.walks, strict=True) if walk is not None]
    labeled, unlabeled = collect(label_steps, [walk for _, walk in found], [walk.name for _, walk in found])
    refusals = [*loaded.refusals, *unlabeled]
    reasons = list_reasons(refusals)
    if refusals and not options.skip_bad:
        raise ValueError(
            f"{len(refusals)} of {len(files)} recordings were refused; mend them, or leave them out with --skip-bad:\n"
            f"{reasons}"
        )
    known = {file: (walk, steps) for (file, walk), steps in zip(found, labeled, strict=True) if steps is not None}
    for what, wanted in (("average walk", average), ("style", style)):
        if wanted and not set(wanted) & set(known):
            raise ValueError(f"all {len(wanted)} recordings of the {what} were refused:\n{reasons}")
    if refusals:
        print(f"refused: {len(refusals)} of {len(files)}\n{reasons}")
    walks = [walk for walk, _ in known.values()]
    check_alike(walks, walks[0])
    return _pick(average, known), _pick(style, known)


def _pick(files: Sequence[Path], known: dict[Path, tuple[JointWalk, Steps]]) -> StyleWalks:
    """Return the walks of files that were not refused, each once."""
    own = [file for file in dict.fromkeys(files) if file in known]
    return StyleWalks([known[file][0] for file in own], own, sum(len(known[file][1].labels) for file in own))


def read_walkers(table: Path, files: Sequence[Path]) -> dict[Path, str]:
    """Return who walks in each file.

    Parameters
    ----------
    table : Path
        A CSV file with the columns file and walker, see `labels_from_table`.
    files : sequence of Path
        Those of the average walk.

    Raises
    ------
    ValueError
        If the table is not of these files, or a walker is missing.
    """
    walkers = labels_from_table(table, files, ["walker"])["walker"]
    missing = walkers.index[walkers.isna()].tolist()
    if missing:
        raise ValueError(f"{table}: expected a walker in each row, got none for {', '.join(missing[:10])}")
    return dict(zip(files, walkers.astype(str), strict=True))
