"""Rows of answers as they stand in files, checked cell by cell, row by row, and against each other.

Every fault names its file and line, what was expected there and what stood there; all are collected before any is
raised.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache, partial
from operator import itemgetter
from typing import TYPE_CHECKING, Any, NamedTuple

import pandas as pd

from eigenwalker._validation import WalkError
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS, DESIGN_COLUMNS
from eigenwalker.experiment.answers.cells import NAMES, TIME, Cell, parse_cell
from eigenwalker.experiment.tasks import TASKS

if TYPE_CHECKING:
    from eigenwalker.experiment.study import Study

__all__ = ["AnswerRow", "Faults", "make_answers", "quoted"]

_KEY = itemgetter(1, 2, 3)  # participant, session, trial, behind the study
_ALIKE = itemgetter(*range(4, 3 + len(DESIGN_COLUMNS) + 1), NAMES.index("answer"), NAMES.index("value"))
_ANSWER, _TIME = NAMES.index("answer"), NAMES.index("answered_at")
_TYPES = {"int": "int64", "float": "float64", "str": "str"}
_MOST_SHOWN, _LONGEST = 10, 60

_Values = tuple[Any, ...]
_One = dict[str, Any]
_Worth = dict[str, float | None]  # of the answers that can be given
_Complaint = tuple[str, str, Any]  # column, what was expected, what stood there


class AnswerRow(NamedTuple):
    """One row: where it stands, "line 12" of a file, and its cells in the order of the columns."""

    file: str
    line: str
    words: Sequence[str]

    @property
    def place(self) -> str:
        """File and line, for errors."""
        return f"{self.file}, {self.line}"


_Sound = tuple[AnswerRow, _Values]


class Faults:
    """What is wrong, in the order in which it was found."""

    def __init__(self) -> None:
        self.found: list[str] = []

    def add(self, place: str, text: str) -> None:
        """Note a fault of a place."""
        self.found.append(f"{place}: {text}")

    def complain(self, row: AnswerRow, column: str, wanted: str, got: Any) -> None:
        """Note a cell that is not as it should be."""
        self.add(row.place, f"{column}: expected {wanted}, got {quoted(got)}")

    def report(self) -> None:
        """Raise a WalkError with the first ten faults, if there are any."""
        if len(self.found) == 1:
            raise WalkError(self.found[0])
        if self.found:
            listed = "".join(f"\n  {fault}" for fault in self.found[:_MOST_SHOWN])
            more = len(self.found) - _MOST_SHOWN
            raise WalkError(f"{len(self.found)} faults:{listed}" + (f"\n  and {more} more" if more > 0 else ""))


def quoted(got: Any) -> str:
    """Return a value for an error, shortened."""
    if not isinstance(got, str):
        return "nothing" if math.isnan(got) else f"{got:.15g}"
    return repr(got if len(got) <= _LONGEST else got[:_LONGEST] + "...") if got else "nothing"


def make_answers(rows: Sequence[AnswerRow], faults: Faults, study: Study | None = None) -> pd.DataFrame:
    """Return the table of rows that are as they should be, or raise what is wrong with them.

    Parameters
    ----------
    rows : sequence of AnswerRow
        From one file or several.
    faults : Faults
        What was wrong with the files already.
    study : Study, default None
        Whose answers they must be. None takes those of any one study with the buttons of the papers.

    Returns
    -------
    DataFrame
        Sorted by participant, session and trial, without repetitions.

    Raises
    ------
    WalkError
        With the first ten faults.
    """
    columns = [_parse_column(name, rows, faults) for name in NAMES]
    sound = [pair for pair in zip(rows, zip(*columns, strict=True), strict=True) if None not in pair[1]]
    _check_rows(_own_answers(sound, faults, study), faults, study)
    kept = _drop_repetitions(sound, faults)
    faults.report()
    table = pd.DataFrame.from_records(sorted(kept, key=_KEY), columns=list(NAMES))
    return table.astype({name: _TYPES[column.kind] for name, column in ANSWER_COLUMNS.items()})


def _parse_column(name: str, rows: Sequence[AnswerRow], faults: Faults) -> list[Any]:
    """Return the values of a column, None for those that are noted as faults."""
    at = NAMES.index(name)
    known: dict[str, Cell] = {}
    values = []
    for row in rows:
        word = row.words[at]
        if word not in known:
            known[word] = parse_cell(name, word)
        values.append(known[word].value)
        if known[word].value is None:
            faults.complain(row, name, known[word].wanted, word)
    return values


def _own_answers(sound: Sequence[_Sound], faults: Faults, study: Study | None) -> list[_Sound]:
    """Return the answers to the study, or to that of the first one, and note those to others, once a file."""
    if not sound:
        return []
    first, (own, *_) = sound[0]
    wanted, where = (study.id, "") if study is not None else (own, f", as in {first.place}")
    noted = set()
    for row, (got, *_) in sound:
        if got != wanted and (row.file, got) not in noted:
            noted.add((row.file, got))
            faults.complain(row, "study", f"{wanted}{where}", got)
    return [pair for pair in sound if pair[1][0] == wanted]


def _check_rows(sound: Sequence[_Sound], faults: Faults, study: Study | None) -> None:
    """Note rows whose cells do not fit together, or not the design."""
    known: dict[tuple[str, ...], list[_Complaint]] = {}  # most rows differ in times alone
    worth = cache(partial(_worth, study=study))
    design = None if study is None else _Design(study)
    for row, values in sound:
        alike = _ALIKE(row.words)
        if alike not in known:
            one = dict(zip(NAMES, values, strict=True))
            known[alike] = [*_wrong_words(one), *_wrong_answer(one, worth(one["task"], one["trait"]), study)]
        complaints = known[alike] if design is None else [*known[alike], *design.wrong(values)]
        for complaint in complaints:
            faults.complain(row, *complaint)
        if values[_ANSWER] and not values[_TIME]:
            faults.complain(row, "answered_at", TIME, "")


def _wrong_words(values: _One) -> Iterator[_Complaint]:
    """Yield cells that do not fit the task and the part."""
    task = TASKS[values["task"]]
    is_rating, is_attention = task.name == "rating", values["part"] == "attention"
    for column, is_needed, kind in (
        ("trait", is_rating, f"{task.name} trials"),
        ("reference", task.is_pair, f"{task.name} trials"),
        ("expected", is_attention, f"{values['part']} trials"),
    ):
        if (values[column] != "") != is_needed:
            yield column, f"{'a word' if is_needed else 'nothing'} in {kind}", values[column]
    if task.is_pair and values["left"] not in (values["stimulus"], values["reference"]):
        yield "left", f"{quoted(values['stimulus'])} or {quoted(values['reference'])}, as in the pair", values["left"]
    if not task.is_pair and (values["left"] != "") != is_rating:
        yield "left", f"{'a word' if is_rating else 'nothing'} in {task.name} trials", values["left"]


def _wrong_answer(values: _One, worth: _Worth | None, study: Study | None) -> Iterator[_Complaint]:
    """Yield an answer that is on no button, or a value that is not that of the answer."""
    answer, value = values["answer"], values["value"]
    if worth is not None and answer and answer not in worth:
        hint = "" if study is not None else " (if the study has other buttons, pass study=...)"
        yield "answer", f"one of {', '.join(worth)}{hint}", answer
        return
    right = None if worth is None else worth.get(answer)
    if not (math.isnan(value) if right is None else value == right):
        yield "value", f"{'nothing' if right is None else f'{right:g}'} for the answer {quoted(answer)}", value


def _worth(name: str, trait: str, *, study: Study | None) -> _Worth | None:
    """Return the answers that can be given and what they are worth; None where any word can be one."""
    if study is None:
        asked = [] if name == "recognition" else [TASKS[name]()]
    else:
        asked = [task for task in study.tasks if (task.name, task.trait) == (name, trait)]
    return {button.answer: button.value for button in asked[0].buttons} if asked else None


class _Design:
    """What a study shows in each trial."""

    def __init__(self, study: Study) -> None:
        rows = zip(*(study.design[name].tolist() for name in DESIGN_COLUMNS), strict=True)
        self.trials = {row[:3]: row for row in rows}
        self.participants = {participant for participant, _, _ in self.trials}

    def wrong(self, values: _Values) -> Iterator[_Complaint]:
        """Yield the cells that are others than in the design."""
        given = values[1 : 1 + len(DESIGN_COLUMNS)]
        participant, session, trial = given[:3]
        planned = self.trials.get((participant, session, trial))
        if participant not in self.participants:
            yield "participant", f"one of the {len(self.participants)} of the study's design", participant
        elif planned is None:
            yield "trial", f"one of participant {participant}, session {session} of the study's design", trial
        elif planned != given:
            for name, wanted, got in zip(DESIGN_COLUMNS, planned, given, strict=True):
                if got != wanted:
                    yield name, f"{quoted(wanted)}, as in the study's design", got


def _drop_repetitions(sound: Sequence[_Sound], faults: Faults) -> list[_Values]:
    """Return the answer to each trial once, and note answers to one trial that contradict each other."""
    kept: dict[tuple[Any, ...], _Sound] = {}
    for row, values in sound:
        first, known = kept.setdefault(values[:4], (row, values))
        if known is values or repr(values) == repr(known):  # NaN is not itself, but nan is
            continue
        at = next(at for at, pair in enumerate(zip(values, known, strict=True)) if repr(pair[0]) != repr(pair[1]))
        wanted = f"{quoted(known[at])}, as in {first.place}, of the same participant, session and trial"
        faults.complain(row, NAMES[at], wanted, values[at])
    return [values for _, values in kept.values()]
