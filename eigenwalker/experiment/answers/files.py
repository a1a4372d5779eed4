"""Answers of people, read from the files in which they come, and written as a data set for others to read."""

from __future__ import annotations

import csv
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from eigenwalker._validation import WalkError
from eigenwalker._whole_files import write_whole
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS
from eigenwalker.experiment.answers.cells import NAMES
from eigenwalker.experiment.answers.jatos_results import (
    is_archive,
    is_result,
    is_upload,
    read_archive,
    read_result_lines,
)
from eigenwalker.experiment.answers.psych_ds import DATA, RAW, data_file_name, write_description
from eigenwalker.experiment.answers.rows import AnswerRow, Faults, make_answers, quoted
from eigenwalker.io._text import CUT, decode_lines, join_numbers

if TYPE_CHECKING:
    from eigenwalker.experiment.study import Study

__all__ = ["read_answers", "write_answers"]

_Source = str | os.PathLike[str]

_TABLES = (".csv",)
_RESULTS = (".txt", ".jsonl", ".zip", ".jrzip")
_SPREADSHEETS = (".xlsx", ".xls", ".ods", ".numbers", ".tsv")
_AS_CSV = "take the file as it was downloaded, or save it as CSV in UTF-8 with commas"
_WIDE_MARKS = (b"\xff\xfe", b"\xfe\xff")  # with which UTF-16 begins


def read_answers(source: _Source | Sequence[_Source], *, study: Study | None = None) -> pd.DataFrame:
    r"""Return the answers in a folder, a file, or several.

    Parameters
    ----------
    source : str, path or list of them
        - a folder: that of a study, whose ``data`` is read with all its folders except ``data/raw``, or any other; in
          it all files that end in .csv, .txt, .jsonl, .zip and .jrzip;
        - ``.csv``: a table as the page of a study downloads it, or as `write_answers` does; UTF-8, with commas;
        - ``.txt`` or ``.jsonl``: result data of JATOS as one text, see `read_result_lines`;
        - ``.zip`` or ``.jrzip``: an archive of results of JATOS, see `read_archive`. Unpacked it is a folder.
    study : Study, default None
        Whose answers they must be, trial by trial as in its design, and with its buttons. None takes those of any one
        study, with the numbers of buttons of the papers: six for ratings, five for pairs.

    Returns
    -------
    DataFrame
        One row an answer, with the columns and types of `ANSWER_COLUMNS`, sorted by participant, session and trial.
        Empty numbers are NaN, empty words "". An answer that stands in several places, alike, is there once.

    Raises
    ------
    WalkError
        If there are no answers; or with the first ten of all faults, each with its file and line: columns, cells or
        rows that are not as they should be; answers to several studies, to another one than `study`, or not to its
        design; answers to one trial that contradict each other; and files that are cut off, no text, or changed by a
        spreadsheet program.
    OSError
        If a file cannot be opened.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder, "answers.csv")
    ...     _ = table.write_text("study;participant;trial\nab12cd34ef56;1;1\n")
    ...     read_answers(table)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    eigenwalker._validation.WalkError: ...answers.csv, line 1: expected columns with commas between them, got ';': ...
    """
    sources = [source] if isinstance(source, (str, os.PathLike)) else list(source)
    faults = Faults()
    rows = [row for path in _find_files(sources) for row in _read_file(path, faults)]
    if not rows and not faults.found:
        named = ", ".join(str(one) for one in sources) or "no files"
        raise WalkError(f"{named}: expected at least one answer, got none")
    return make_answers(rows, faults, study)


def write_answers(answers: pd.DataFrame, folder: _Source, *, study: Study | None = None) -> list[Path]:
    """Write answers as a data set of Psych-DS: a file for each participant and task, and a description of the columns.

    Parameters
    ----------
    answers : DataFrame
        With the columns of `ANSWER_COLUMNS`.
    folder : str or path
        Of the data set; made where it is missing. Tables go to its ``data``, ``participant-3_task-rating_data.csv``
        and so on, each as a whole or not at all. A ``dataset_description.json`` that is there stays.
    study : Study, default None
        Whose answers they are, see `read_answers`.

    Returns
    -------
    list of Path
        The tables.

    Raises
    ------
    TypeError
        If the answers are no DataFrame.
    WalkError
        If they are not as `read_answers` returns them, or a table that is there has answers that these are without.

    Notes
    -----
    Numbers are written with all their digits: reading them gives the same answers.
    """
    if not isinstance(answers, pd.DataFrame):
        raise TypeError(f"expected answers as a DataFrame, got {type(answers).__name__}")
    _check_header("the answers", 0, [str(name) for name in answers.columns])
    rows = list(_rows_of(answers))
    make_answers(rows, Faults(), study)
    parts: dict[str, list[Sequence[str]]] = {}
    for words in sorted({tuple(row.words) for row in rows}, key=_order):
        name = data_file_name(int(words[NAMES.index("participant")]), words[NAMES.index("task")])
        parts.setdefault(name, []).append(words)
    data = Path(folder, DATA)
    data.mkdir(parents=True, exist_ok=True)
    texts = {data / name: _csv_text(part) for name, part in parts.items()}
    _keep_answers(texts)
    for path, text in texts.items():
        write_whole(path, text.encode())
    if study is not None or not Path(folder, "dataset_description.json").exists():
        write_description(folder, study)
    return list(texts)


# ---- files


def _find_files(sources: Iterable[_Source]) -> Iterator[Path]:
    for source in sources:
        path = Path(source)
        if path.is_dir():
            yield from _files_in(path)
        else:
            yield path  # opening it says what is wrong with it


def _files_in(folder: Path) -> Iterator[Path]:
    """Yield the files of a folder that may hold answers, or raise for those that should have been saved otherwise."""
    base = folder / DATA if (folder / DATA).is_dir() else folder
    found = [path for path in sorted(base.rglob("*")) if path.is_file() and not _is_other(path.relative_to(base))]
    sheets = [str(path) for path in found if path.suffix.lower() in _SPREADSHEETS]
    if sheets:
        raise WalkError(f"{', '.join(sheets[:10])}: expected answers as CSV, got a spreadsheet; {_AS_CSV}")
    yield from (path for path in found if path.suffix.lower() in (*_TABLES, *_RESULTS))


def _is_other(path: Path) -> bool:
    """Return whether a file of a folder is hidden, raw, or was uploaded to JATOS beside the answers."""
    return any(part.startswith(".") for part in path.parts) or path.parts[0] == RAW or is_upload(path.as_posix())


def _read_file(path: Path, faults: Faults) -> Iterator[AnswerRow]:
    """Yield the rows of a file, and note what is wrong with it."""
    data = path.read_bytes()
    try:
        if is_archive(data):
            for name, part in read_archive(data, str(path), faults):
                yield from read_result_lines(part, f"{path}, {name}", faults)
        elif path.suffix.lower() in _TABLES:
            yield from _read_table(data, str(path), faults)
        elif data.strip() or not is_result(path.as_posix()):  # a page that was opened and closed leaves an empty one
            yield from read_result_lines(data, str(path), faults)
    except WalkError as error:
        faults.add(str(path), str(error))


def _read_table(data: bytes, file: str, faults: Faults) -> Iterator[AnswerRow]:
    """Yield the rows of a CSV file."""
    if data.startswith(_WIDE_MARKS):
        faults.add(f"{file}, line 1", f"expected UTF-8, got UTF-16 of a spreadsheet program; {_AS_CSV}")
        return
    try:
        lines = decode_lines(data, "a table of answers")
    except WalkError as error:
        faults.add(f"{file}, {str(error).partition(':')[0]}", str(error).partition(": ")[2])
        return
    header: list[str] | None = None
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        cells = _split(line, f"{file}, line {number}", faults, is_last=number == len(lines))
        if cells is None:
            continue
        if header is None:
            header = cells
            try:
                _check_header(file, number, header)
            except WalkError as error:
                faults.found.append(str(error))
                return
        elif len(cells) != len(header):
            cut = f"; {CUT}" if number == len(lines) and len(cells) < len(header) else ""
            faults.add(f"{file}, line {number}", f"expected {len(header)} cells, got {len(cells)}{cut}")
        else:
            by_name = dict(zip(header, cells, strict=True))
            yield AnswerRow(file, f"line {number}", [by_name[name] for name in NAMES])
    if header is None:
        faults.add(f"{file}, line 1", f"expected a header, {', '.join(NAMES[:4])} and so on, got an empty file")


def _split(line: str, place: str, faults: Faults, *, is_last: bool) -> list[str] | None:
    """Return the cells of a line; one by one, as a quote that is not closed would take the lines that follow."""
    try:
        (cells,) = csv.reader([line], strict=True)
    except csv.Error as error:
        faults.add(place, f"expected cells with commas between them, but {error}{f'; {CUT}' if is_last else ''}")
        return None
    return cells


def _check_header(file: str, line: int, header: Sequence[str]) -> None:
    """Raise unless a header has all columns, each once, and no others."""
    place = f"{file}, line {line}: " if line else f"{file}: "
    separators = [mark for mark in ";\t" if any(mark in cell for cell in header)]
    if separators or header[:1] == ["sep="]:
        mark = repr((separators or [","])[0])
        raise WalkError(f"{place}expected columns with commas between them, got {mark}: {_AS_CSV}")
    lacking = [name for name in NAMES if name not in header]
    unknown = [quoted(name) for name in dict.fromkeys(header) if name not in NAMES]
    twice = [quoted(name) for name, count in Counter(header).items() if count > 1]
    faults = [
        f"{what} {', '.join(names[:10])}{' and more' if len(names) > 10 else ''}"
        for what, names in (("without", lacking), ("with the unknown", unknown), ("with twice", twice))
        if names
    ]
    if faults:
        raise WalkError(
            f"{place}expected the columns of answers, {', '.join(NAMES[:4])} and so on, got a header "
            f"{' and '.join(faults)}"
        )


# ---- tables


def _rows_of(answers: pd.DataFrame) -> Iterator[AnswerRow]:
    """Yield the rows of a table as they would stand in a file."""
    columns = [_words(answers[name].tolist(), column.kind) for name, column in ANSWER_COLUMNS.items()]
    for label, words in zip(answers.index, zip(*columns, strict=True), strict=True):
        yield AnswerRow("the answers", f"row {label}", words)


def _words(values: Sequence[Any], kind: str) -> list[str]:
    if kind == "str":
        return ["" if pd.isna(value) else str(value) for value in values]
    return [_number_word(value) for value in values]


def _number_word(value: Any) -> str:
    """Return a number as it is written, without a point where it is whole; anything else as it is, to be refused."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return join_numbers([value], "").removesuffix(".0")
    return str(value)


def _order(words: Sequence[str]) -> tuple[int, ...]:
    return tuple(int(words[NAMES.index(name)]) for name in ("participant", "session", "trial"))


def _csv_text(rows: Sequence[Sequence[str]]) -> str:
    lines = [_csv_line(words) for words in (NAMES, *rows)]
    return "\n".join(lines) + "\n"


def _csv_line(words: Sequence[str]) -> str:
    """Return a line of a table; words with a comma or a quote stand in quotes."""
    return ",".join(
        '"' + word.replace('"', '""') + '"' if any(mark in word for mark in ',"') or word.strip() != word else word
        for word in words
    )


def _keep_answers(texts: dict[Path, str]) -> None:
    """Raise where a table would lose answers by being written anew."""
    for path, text in texts.items():
        lost = set(path.read_text(encoding="utf-8").splitlines()) - set(text.splitlines()) if path.is_file() else set()
        if lost:
            raise WalkError(
                f"{path}: expected all of its answers among those to be written, {len(lost)} lines of it are not; "
                "read both together, read_answers([folder, ...]), or write to another folder"
            )
