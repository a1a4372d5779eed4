"""Many movies from a table, one a row."""

from __future__ import annotations

import inspect
import os
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import check_names, check_walks
from eigenwalker.display.conditions import make_display
from eigenwalker.display.movie import Movie, plan_movie, write_movie
from eigenwalker.display.screen import Screen
from eigenwalker.display.stimuli import PointLightDisplay
from eigenwalker.motion.walk import Walk

__all__ = ["write_movies"]

_CONDITIONS = tuple(inspect.signature(make_display).parameters)[1:]
_TIMES = ("duration", "rate")
_COLUMNS = ("walk", "file", *_TIMES, *_CONDITIONS)
_FLAGS = {"true": True, "yes": True, "1": True, "1.0": True, "false": False, "no": False, "0": False, "0.0": False}


class _Job(NamedTuple):
    """One movie to write."""

    display: PointLightDisplay
    path: Path
    times: dict[str, float | None]
    screen: Screen


def write_movies(
    table: pd.DataFrame,
    folder: str | os.PathLike[str],
    walks: Sequence[Walk],
    *,
    screen: Screen | None = None,
    on_error: str = "raise",
    n_jobs: int | None = None,
) -> pd.DataFrame:
    """Write a movie for each row of a table.

    All rows are checked before the first movie is written, and all faults are reported at once. A bar shows the
    progress of more than two seconds.

    Parameters
    ----------
    table : DataFrame
        One column a parameter, all optional but the first, empty cells for the defaults:

        - ``walk``: the name of one of `walks`;
        - ``file``: the name of the movie, ending in .mp4 or .gif; without it, the row's label and .mp4;
        - ``duration`` and ``rate``: see `write_movie`;
        - those of `make_display`, ``random_state`` among them: the seed.
    folder : str or path
        Where the movies go; made where it is missing.
    walks : list of Walk
        With names of their own.
    screen : Screen, default None
        For all of them. None is `Screen()`.
    on_error : {"raise", "skip"}, default "raise"
        Whether a row that cannot become a movie is an error, or is left out with a warning. With "raise" nothing is
        written then.
    n_jobs : int, default None
        Number of processes, as in joblib. Movies do not depend on it.

    Returns
    -------
    DataFrame
        The rows that were written, with the columns ``file``, ``n_frames``, ``duration`` and ``rate`` as they are in
        the movies.

    Raises
    ------
    ValueError
        If columns are unknown, names of walks or files repeat, or rows are refused.
    ImportError
        If ffmpeg, or Pillow for a GIF, is not installed.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import pandas as pd
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import write_movies
    >>> walks = make_walkers(2, random_state=0).data
    >>> table = pd.DataFrame({"walk": ["walker_000", "walker_001"], "inversion": ["none", "whole"], "duration": 0.2})
    >>> with TemporaryDirectory() as folder:
    ...     write_movies(table.assign(file=["a.gif", "b.gif"]), folder, walks)[["file", "n_frames"]]
        file  n_frames
    0  a.gif        10
    1  b.gif        10
    """
    known = _by_name(walks)
    files = _check_table(table)
    Path(folder).mkdir(parents=True, exist_ok=True)
    prepare = partial(_prepare, walks=known, folder=Path(folder), screen=Screen() if screen is None else screen)
    rows = [{**row, "file": file} for row, file in zip(table.to_dict("records"), files, strict=True)]
    labels = [f"row {label}" for label in table.index]
    jobs, refusals = collect(prepare, rows, labels)
    report_refusals(refusals, len(rows), on_error=on_error, what="rows")
    kept = {position: job for position, job in enumerate(jobs) if job is not None}
    movies, failures = collect(
        _write,
        list(kept.values()),
        [labels[position] for position in kept],
        n_jobs=n_jobs,
        progress=True,
        description="writing movies",
    )
    report_refusals(failures, len(kept), on_error=on_error, what="movies")
    written = {position: movie for position, movie in zip(kept, movies, strict=True) if movie is not None}
    return _describe(table.iloc[list(written)], list(written.values()))


def _by_name(walks: Sequence[Walk]) -> dict[str, Walk]:
    checked = check_walks(walks, kind=Walk)
    return dict(zip(check_names([walk.name for walk in checked], name="names of walks"), checked, strict=True))


def _check_table(table: pd.DataFrame) -> list[str]:
    """Return the names of the files, or raise for what is wrong with the table as a whole."""
    if not isinstance(table, pd.DataFrame):
        raise TypeError(f"table must be a DataFrame, got {type(table).__name__}")
    unknown = [str(column) for column in table.columns if column not in _COLUMNS]
    if unknown or "walk" not in table.columns:
        fault = f"unknown: {', '.join(unknown)}" if unknown else "'walk' is missing"
        raise ValueError(f"expected columns out of {', '.join(_COLUMNS)}, 'walk' among them; {fault}")
    if table.empty:
        raise ValueError("expected a table with at least one row, got an empty one")
    named = table["file"] if "file" in table.columns else pd.Series(None, index=table.index, dtype=object)
    files = [f"{label}.mp4" if pd.isna(file) else str(file) for label, file in named.items()]
    repeated = sorted({file for file in files if files.count(file) > 1})
    if repeated:
        raise ValueError(f"each row needs a file of its own, but these repeat: {', '.join(repeated[:10])}")
    return files


def _prepare(row: Mapping[str, Any], *, walks: Mapping[str, Walk], folder: Path, screen: Screen) -> _Job:
    """Return what a row asks for; whatever is wrong with it is a ValueError."""
    given = {name: value for name, value in row.items() if isinstance(value, (list, tuple)) or not pd.isna(value)}
    name, file = given.pop("walk", None), given.pop("file")
    if name not in walks:
        raise ValueError(f"walk must be the name of one of the walks, {_some(walks)}, got {name!r}")
    if Path(file).name != file:
        raise ValueError(f"file must be a name without folders, got {file!r}")
    times = {key: given.pop(key, None) for key in _TIMES}
    if "translating" in given:
        given["translating"] = _as_flag(given["translating"])
    if "random_state" in given:
        given["random_state"] = _as_seed(given["random_state"])
    if isinstance(given.get("view"), str) and given["view"].lstrip("+-").replace(".", "", 1).isdigit():
        given["view"] = float(given["view"])  # among names a column of a file holds numbers as text
    try:
        display = make_display(walks[name], **given)
        plan_movie(display, folder / file, screen=screen, **times)
    except TypeError as error:
        raise ValueError(str(error)) from None
    return _Job(display, folder / file, times, screen)


def _write(job: _Job) -> Movie:
    return write_movie(job.display, job.path, screen=job.screen, **job.times)


def _as_flag(value: object) -> bool:
    if str(value).lower() not in _FLAGS:
        raise ValueError(f"translating must be true or false, got {value!r}")
    return _FLAGS[str(value).lower()]


def _as_seed(value: Any) -> int:
    """Return a seed as a whole number; in a column with gaps it is a float."""
    try:
        seed = int(value)
    except (TypeError, ValueError):
        seed = -1
    if seed != value or not 0 <= seed < 2**32:
        raise ValueError(f"random_state must be a whole number from 0 to 2**32 - 1, got {value!r}")
    return seed


def _some(names: Mapping[str, Walk]) -> str:
    listed = list(names)
    return ", ".join(listed[:6]) + (f" and {len(listed) - 6} more" if len(listed) > 6 else "")


def _describe(table: pd.DataFrame, movies: list[Movie]) -> pd.DataFrame:
    return table.assign(
        file=[movie.path.name for movie in movies],
        n_frames=[len(movie.times) for movie in movies],
        duration=[movie.duration for movie in movies],
        rate=[movie.rate for movie in movies],
    )
