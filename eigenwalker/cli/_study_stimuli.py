"""Recordings and movies named on the command line, as what people are shown."""

import argparse
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from eigenwalker._collect import Refusal, collect
from eigenwalker.cli._file_names import name_depth, short_name
from eigenwalker.cli._label_table import labels_from_names, labels_from_table
from eigenwalker.cli._marker_map import read_marker_map
from eigenwalker.cli._recordings import list_reasons, load, reading_options
from eigenwalker.experiment.stimulus import AVERAGE, CONDITIONS, KINDS, Stimulus, cross_stimuli
from eigenwalker.io.formats import read_walk
from eigenwalker.motion.heading import travels
from eigenwalker.motion.rig import Rig
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["judged_stimuli", "rated_stimuli", "write_sources"]

_MOVIE = ".mp4"
_CONDITION = "condition"

Found = tuple[list[Stimulus], dict[str, Path]]  # and the file that each is from


def rated_stimuli(options: argparse.Namespace) -> Found:
    """Return prepared walks in place, or movies, and the file of each.

    Parameters
    ----------
    options : Namespace
        With walkers, and the arguments of `add_recording_arguments` and `add_collecting_arguments`.

    Raises
    ------
    ValueError
        If recordings are refused and may not be left out, or movies and recordings are mixed.
    """
    files = options.walkers
    if _are_movies(files):
        depth = name_depth(files)
        movies = [Stimulus(short_name(file, depth), movie=file) for file in files]
        return movies, {stimulus.name: file for stimulus, file in zip(movies, files, strict=True)}
    loaded = load(files, options, n_jobs=options.jobs)
    _report_refusals(loaded.refusals, len(loaded.walks), options)
    used = [(walk, files[at]) for walk, at in zip(loaded.walks, loaded.files, strict=True) if walk is not None]
    stimuli = [Stimulus(walk.name or "", walk) for walk, _ in used]
    return stimuli, {stimulus.name: file for stimulus, (_, file) in zip(stimuli, used, strict=True)}


def judged_stimuli(options: argparse.Namespace) -> Found:
    """Return original and synthetic walks as they are, under all conditions, or movies, and the file of each.

    Parameters
    ----------
    options : Namespace
        With walkers, synthetic, average, label_pattern or labels_table, conditions, and the arguments for reading.

    Raises
    ------
    ValueError
        If recordings are refused and may not be left out, styles are missing, or originals and synthetic walks do not
        fit each other.
    """
    files = [*options.walkers, *options.synthetic]
    twice = sorted(str(file) for file, number in Counter(files).items() if number > 1)
    if twice:
        raise ValueError(f"expected each file once, as original or synthetic, got twice: {', '.join(twice[:10])}")
    everything = files if options.average is None else [*files, options.average]
    if _are_movies(everything):
        return _movies(files, _labels(options, files, with_condition=True), options)
    labels = _labels(options, files)["style"]
    walks = _read(everything, options)
    series = [
        _by_style([(label, walks[file]) for file, label in zip(files, labels, strict=True) if file in group])
        for group in (options.walkers, options.synthetic)
    ]
    stimuli = cross_stimuli(*series, average=walks.get(options.average), conditions=_conditions(walks, options))
    owners = {id(walk): file for file, walk in walks.items()}
    return stimuli, {stimulus.name: owners[id(stimulus.walk)] for stimulus in stimuli}


def write_sources(path: Path, stimuli: Sequence[Stimulus], sources: Mapping[str, Path]) -> None:
    """Write a table that says which file each stimulus is from."""
    columns = ("style", "kind", "condition", "reference")
    rows = [
        {"stimulus": stimulus.name, "file": str(sources[stimulus.name])}
        | {name: getattr(stimulus, name) for name in columns}
        for stimulus in stimuli
    ]
    table = pd.DataFrame(rows)
    table.loc[:, (table != "").any()].to_csv(path, index=False, lineterminator="\n")


def _are_movies(files: Sequence[Path]) -> bool:
    movies = [file for file in files if file.suffix.lower() == _MOVIE]
    if movies and len(movies) < len(files):
        other = next(file for file in files if file not in movies)
        raise ValueError(f"expected movies only, or recordings only, got {movies[0]} and {other}")
    return bool(movies)


def _labels(options: argparse.Namespace, files: Sequence[Path], *, with_condition: bool = False) -> pd.DataFrame:
    """Return style, and maybe condition, of each file."""
    table, pattern = options.labels_table, options.label_pattern
    if table is not None:
        has_condition = with_condition and _CONDITION in pd.read_csv(table, nrows=0).columns
    else:
        has_condition = with_condition and f"(?P<{_CONDITION}>" in pattern
    columns = ["style", _CONDITION] if has_condition else ["style"]
    found = labels_from_table(table, files, columns) if table else labels_from_names(pattern, files, columns)
    missing = found.index[found["style"].isna() | (found["style"].astype(str) == "")].tolist()
    if missing:
        raise ValueError(f"expected a style of each file, got none of {', '.join(map(str, missing[:10]))}")
    return found.fillna("").astype(str)


def _read(files: Sequence[Path], options: argparse.Namespace) -> dict[Path, Any]:
    """Return the walks in files as they were recorded."""
    rig = None if options.markers is None else read_marker_map(options.markers)
    depth = name_depth(files)
    walks, refusals = collect(
        partial(_read_one, reading=reading_options(options), rig=rig),
        [(file, short_name(file, depth)) for file in files],
        [str(file) for file in files],
        n_jobs=options.jobs,
        progress=True,
        description="reading",
    )
    if refusals:
        raise ValueError(
            f"{len(refusals)} of {len(files)} recordings were refused; mend them, or leave them out of the command:\n"
            f"{list_reasons(refusals)}"
        )
    return dict(zip(files, walks, strict=True))


def _read_one(file: tuple[Path, str], *, reading: Mapping[str, object], rig: Rig | None) -> Walk | JointWalk:
    path, name = file
    return replace(read_walk(path, **reading).to_markers(rig), name=name)


def _conditions(walks: Mapping[Path, Any], options: argparse.Namespace) -> tuple[str, ...]:
    """Return the conditions that were asked for, or those that all walks can be shown under."""
    still, moving = CONDITIONS
    asked = tuple(dict.fromkeys(options.conditions or CONDITIONS))
    staying = [str(file) for file, walk in walks.items() if not (np.isfinite(walk.speed) or travels(walk))]
    if moving not in asked or not staying:
        return asked
    words = f"{len(staying)} of {len(walks)} walks stay in place, and their speed is not known: "
    if options.conditions is not None:
        raise ValueError(f"--conditions: {words}{', '.join(staying[:10])}; leave {moving} out")
    print(f"{words}all are shown in place, {still}")
    return (still,)


def _report_refusals(refusals: Sequence[Refusal], n_walks: int, options: argparse.Namespace) -> None:
    """Print the recordings that were refused, or stop unless they may be left out."""
    if not refusals:
        return
    reasons = list_reasons(refusals)
    if not options.skip_bad or len(refusals) == n_walks:
        advice = "" if options.skip_bad else "; mend them, or leave them out with --skip-bad"
        raise ValueError(f"{len(refusals)} of {n_walks} recordings were refused{advice}:\n{reasons}")
    print(f"refused: {len(refusals)} of {n_walks}\n{reasons}")


def _by_style(labeled: Sequence[tuple[str, Any]]) -> dict[str, list[Any]]:
    return {style: [walk for label, walk in labeled if label == style] for style in dict.fromkeys(dict(labeled))}


class _Movie(NamedTuple):
    """A movie that becomes a stimulus."""

    file: Path
    kind: str
    style: str
    condition: str

    def name(self, number: int, n_alike: int) -> str:
        """Return what a movie is called that is one of several alike."""
        own = "" if n_alike == 1 else str(number + 1)
        return "_".join(part for part in (self.style, self.kind, own, self.condition) if part)


def _movies(files: Sequence[Path], labels: pd.DataFrame, options: argparse.Namespace) -> Found:
    """Return movies as stimuli; a synthetic one refers to the original of its style and condition."""
    if options.conditions is not None:
        raise ValueError(
            "movies are shown as they are; leave --conditions out, and say the condition of each with a group "
            "(?P<condition>static|displacement) of --label-pattern, or a column condition"
        )
    conditions = labels[_CONDITION] if _CONDITION in labels else [""] * len(labels)
    kinds = [KINDS[file in options.synthetic] for file in files]
    movies = [_Movie(*row) for row in zip(files, kinds, labels["style"], conditions, strict=True)]
    alike: dict[tuple[str, str, str], list[_Movie]] = {}
    for movie in movies:
        alike.setdefault((movie.kind, movie.style, movie.condition), []).append(movie)
    stimuli, sources, faults = [], {}, []
    for (kind, style, condition), group in alike.items():
        originals = alike.get((KINDS[0], style, condition), [])
        if kind == KINDS[1] and len(originals) not in (1, len(group)):
            faults.append(f"{' '.join(filter(None, (style, condition)))} ({len(originals)} and {len(group)})")
            continue
        for number, movie in enumerate(group):
            at = 0 if len(originals) == 1 else number
            reference = originals[at].name(at, len(originals)) if kind == KINDS[1] else ""
            name = movie.name(number, len(group))
            stimuli.append(Stimulus(name, None, movie.file, style, kind, condition, reference))
            sources[name] = movie.file
    if faults:
        raise ValueError(
            f"expected one original movie of a style, or as many as synthetic ones, got {', '.join(faults)}"
        )
    if options.average is not None:
        stimuli.append(Stimulus("average", movie=options.average, style=AVERAGE, kind=KINDS[1]))
        sources["average"] = options.average
    return stimuli, sources
