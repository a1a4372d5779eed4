"""Studies for PsychoPy: a table of conditions for each session, and the movies that they name.

PsychoPy evaluates the cells of such tables. So there are none of anyone's words in them: only numbers, words of this
package, and names of files and stimuli that are numbered here. What these stand for is said in tables for people.
"""

from __future__ import annotations

import csv
import io
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from eigenwalker._whole_files import write_whole
from eigenwalker.display._numbers import check_number
from eigenwalker.display.screen import Screen
from eigenwalker.experiment.running.study_movies import Shown, write_stimuli
from eigenwalker.experiment.study import Study
from eigenwalker.experiment.tasks import Task

__all__ = ["write_psychopy"]

_NONE = "none"
_MOVIES = "movies"
_OURS = re.compile(r"participant-[0-9]+_session-[0-9]+\.csv|stimulus_[0-9]+(_view-[0-9.e-]+)?(_showing-[0-9]+)?\.mp4")
_COLUMNS = (
    *("participant", "session", "trial", "task", "part", "trait", "stimulus", "reference", "left", "view", "kind"),
    *("condition", "expected", "movie", "reference_movie", "duration", "blank"),
)
_STIMULI = ("id", "name", "style", "kind", "condition", "reference")
_BUTTONS = ("task", "trait", "word", "button", "text", "answer", "value")


def write_psychopy(
    study: Study,
    folder: str | os.PathLike[str],
    *,
    rate: float = 60.0,
    screen: Screen | None = None,
    n_jobs: int | None = None,
) -> list[Path]:
    """Write what PsychoPy needs to run a study: tables of conditions, and movies.

    ``participant-1_session-1.csv`` and so on have a row a trial and the columns

    - participant, session, trial, task, part, view, kind and condition as in the study's design;
    - stimulus, reference: ``stimulus_001`` and so on;
    - trait: ``trait_1`` and so on, of rating tasks in their order;
    - left: of a rating "first" or "second", the pole at the leftmost button; of a pair the stimulus on the left;
    - expected: the number of the button that an attention trial asks for, see ``buttons.csv``;
    - movie, reference_movie: ``movies/stimulus_001_view-90.mp4``; where tasks show a stimulus in several ways,
      ``_showing-2`` and so on behind it;
    - duration, blank: how long the movie lasts, of a pair the longer one, and the blank screen behind it, in seconds.

    Where there is nothing to say a cell is "none". Two tables are for people, with words as they are; **do not give
    them to PsychoPy**, which evaluates what stands in cells: ``stimuli.csv`` says which stimulus is which, and
    ``buttons.csv`` which buttons a task has, with their texts, answers and values.

    Parameters
    ----------
    study : Study
        With the walks of its stimuli.
    folder : str or path
        Made where it is missing. Tables and movies of a study that was there before are removed.
    rate : float, default 60.0
        Frames per second of the movies.
    screen : Screen, default None
        Distance, pixels and size of the picture, on which angles depend. None is `Screen()`.
    n_jobs : int, default None
        Number of processes, as in joblib.

    Returns
    -------
    list of Path
        The tables of conditions.

    Raises
    ------
    WalkError
        If stimuli cannot be shown; then there are no new tables.
    ImportError
        If ffmpeg is not installed.
    """
    screen = Screen() if screen is None else screen
    rate = check_number(rate, "rate", above=0, unit="frames per second")
    base = Path(folder)
    (base / _MOVIES).mkdir(parents=True, exist_ok=True)
    names = _Names(study)
    rows = [names.row(row) for row in study.design.to_dict("records")]
    wanted = [(base / file, shown) for file, shown in names.movies.items()]
    lengths = dict(zip(names.movies, write_stimuli(wanted, rate=rate, screen=screen, n_jobs=n_jobs), strict=True))
    tables: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows:
        table = tables.setdefault(f"participant-{row['participant']}_session-{row['session']}.csv", [])
        table.append({**row, "duration": _longest(row, lengths)})
    _remove_others(base, {*tables, *(Path(file).name for file in lengths)})
    for name, table in tables.items():
        _write_table(base / name, _COLUMNS, table)
    for_people = {"stimuli.csv": (_STIMULI, names.stimuli()), "buttons.csv": (_BUTTONS, names.buttons())}
    for name, (columns, words) in for_people.items():
        _write_table(base / name, columns, words, quoting=csv.QUOTE_ALL)
    return [base / name for name in tables]


class _Names:
    """What is called how in the tables of a study, and the movies that were asked for."""

    def __init__(self, study: Study) -> None:
        self.study = study
        digits = max(3, len(str(len(study.stimuli))))
        self.known = {one.name: one for one in study.stimuli}
        self.ids = {name: f"stimulus_{number:0{digits}d}" for number, name in enumerate(self.known, start=1)}
        rated = [task.trait for task in study.tasks if task.trait]
        self.traits = {trait: f"trait_{number}" for number, trait in enumerate(rated, start=1)} | {"": _NONE}
        self.tasks: dict[tuple[str, str], Task] = {(task.name, task.trait): task for task in study.tasks}
        self.looks: dict[tuple[str, str], list[Any]] = {}
        self.movies: dict[str, Shown] = {}

    def row(self, row: Mapping[str, Any]) -> dict[str, Any]:
        """Return a row of the design in these names, without its duration."""
        task = self.tasks[row["task"], row["trait"]]
        reference = row["reference"]
        answers = [button.answer for button in task.buttons]
        return {
            **{name: row[name] for name in ("participant", "session", "trial", "task", "part", "view")},
            **{name: row[name] or _NONE for name in ("kind", "condition")},
            "trait": self.traits[row["trait"]],
            "stimulus": self.ids[row["stimulus"]],
            "reference": self.ids[reference] if reference else _NONE,
            "left": self._left(task, row["left"]),
            "expected": 1 + answers.index(row["expected"]) if row["expected"] else _NONE,
            "movie": self._movie(row["stimulus"], row["view"], task),
            "reference_movie": self._movie(reference, row["view"], task) if reference else _NONE,
            "blank": task.showing.blank,
        }

    def _left(self, task: Any, left: str) -> str:
        if task.is_pair:
            return self.ids[left]
        return ("first", "second")[task.poles.index(left)] if left else _NONE

    def _movie(self, name: str, view: float, task: Task) -> str:
        """Return the file of a movie, and remember what it shows."""
        stimulus = self.known[name]
        seen = "" if stimulus.movie is not None else f"_view-{view % 360:.10g}"
        shown = Shown(stimulus, float(view), task.showing)
        looks = self.looks.setdefault((name, seen), [])
        if shown.look not in looks:
            looks.append(shown.look)
        number = 1 + looks.index(shown.look)
        file = f"{_MOVIES}/{self.ids[name]}{seen}{f'_showing-{number}' if number > 1 else ''}.mp4"
        self.movies.setdefault(file, shown)
        return file

    def stimuli(self) -> Iterable[dict[str, str]]:
        """Yield what the stimuli are, for people."""
        for name, stimulus in self.known.items():
            words = {"name": name, "style": stimulus.style, "kind": stimulus.kind, "condition": stimulus.condition}
            yield {"id": self.ids[name], **words, "reference": self.ids.get(stimulus.reference, "")}

    def buttons(self) -> Iterable[dict[str, Any]]:
        """Yield the buttons of the tasks, for people."""
        for task in self.study.tasks:
            for number, button in enumerate(task.buttons, start=1):
                worth = "" if button.value is None else button.value
                words = {"text": button.text, "answer": button.answer, "value": worth}
                yield {
                    "task": task.name,
                    "trait": self.traits[task.trait],
                    "word": task.trait,
                    "button": number,
                    **words,
                }


def _longest(row: Mapping[str, Any], lengths: Mapping[str, float]) -> float | str:
    length = max(lengths[row[name]] for name in ("movie", "reference_movie") if row[name] != _NONE)
    return _NONE if math.isnan(length) else round(length, 6)


def _remove_others(base: Path, kept: set[str]) -> None:
    """Remove tables and movies of an earlier study."""
    for path in (*base.iterdir(), *(base / _MOVIES).iterdir()):
        if path.is_file() and _OURS.fullmatch(path.name) and path.name not in kept:
            path.unlink()


def _write_table(
    path: Path, columns: Sequence[str], rows: Iterable[Mapping[str, Any]], *, quoting: Any = csv.QUOTE_MINIMAL
) -> None:
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n", quoting=quoting)
    writer.writeheader()
    writer.writerows({name: _plain(value) for name, value in row.items()} for row in rows)
    write_whole(path, text.getvalue().encode())


def _plain(value: Any) -> Any:
    return int(value) if isinstance(value, float) and value.is_integer() else value
