"""Results of JATOS, as it exports them: archives, and result data as text with a JSON object a trial."""

from __future__ import annotations

import io
import json
import re
import zipfile
import zlib
from collections.abc import Iterator
from typing import Any

from eigenwalker._validation import WalkError
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS
from eigenwalker.experiment.answers.cells import NAMES
from eigenwalker.experiment.answers.rows import AnswerRow, Faults, quoted
from eigenwalker.io._text import CUT, decode_lines

__all__ = ["is_archive", "is_result", "is_upload", "read_archive", "read_result_lines"]

_RESULT = re.compile(r"(.*/)?comp[-_]result_[0-9]+/data\.txt", re.DOTALL)
_UPLOAD = re.compile(r"(.*/)?comp[-_]result_[0-9]+/files/.*", re.DOTALL)
_LARGEST = 2**28  # bytes of one result: 300,000 trials
_DAMAGED = (
    *(zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, OverflowError),
    *(RuntimeError, NotImplementedError, MemoryError, KeyError),
)
"""What reading a damaged archive, or one with a password, raises."""


class _Number(str):
    """A number as it stands in JSON."""


def is_archive(data: bytes) -> bool:
    """Return whether a file is a ZIP archive, by its first bytes."""
    return data[:2] == b"PK" and data[2:4] in (b"\3\4", b"\5\6", b"\7\b")


def is_result(name: str) -> bool:
    """Return whether a file of an archive holds the result data of one run of a page."""
    return _RESULT.fullmatch(name) is not None


def is_upload(name: str) -> bool:
    """Return whether a file of an archive was uploaded beside the result data."""
    return _UPLOAD.fullmatch(name) is not None


def read_archive(data: bytes, file: str, faults: Faults) -> Iterator[tuple[str, bytes]]:
    """Yield the name and the contents of all result data in an archive of results of JATOS that are not empty.

    Such an archive (``.zip``, ``.jrzip`` before JATOS 3.10) holds ``study_result_<id>/comp-result_<id>/data.txt`` for
    each run of a page; its handbook writes ``comp_result_<id>``. Files uploaded beside it, in ``files``, and
    ``metadata.json`` are not read: who answered what stands in the answers.

    Parameters
    ----------
    data : bytes
        The archive.
    file : str
        Its name, for errors.
    faults : Faults
        Takes note of what cannot be read.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            entries = [entry for entry in archive.infolist() if is_result(entry.filename)]
            if not entries:
                faults.add(
                    file, "expected results of JATOS, study_result_.../comp-result_.../data.txt, got another archive"
                )
            for entry in entries:
                if entry.file_size > _LARGEST:
                    raise ValueError(f"{entry.file_size:,} bytes in {entry.filename}")
                part = archive.read(entry)
                if part.strip():
                    yield entry.filename, part
    except _DAMAGED as error:
        faults.add(file, f"expected a whole archive without a password, got {type(error).__name__}: {error}; {CUT}")


def read_result_lines(data: bytes, file: str, faults: Faults) -> Iterator[AnswerRow]:
    """Yield the answers in result data of JATOS: a JSON object a trial, with the columns of answers as keys.

    The page of a study appends a line a trial, the same line again where it does not know whether it has arrived.
    JATOS exports the data of all runs as one text, with line ends between them. Objects may also stand one behind the
    other in a line. A number that is not known is null.

    Parameters
    ----------
    data : bytes
        Text in UTF-8.
    file : str
        Its name, for errors.
    faults : Faults
        Takes note of what is no such object.
    """
    try:
        lines = decode_lines(data, "result data of JATOS")
    except WalkError as error:
        faults.add(f"{file}, {str(error).partition(':')[0]}", str(error).partition(": ")[2])
        return
    if not any(line.strip() for line in lines):
        faults.add(f"{file}, line 1", "expected a JSON object a line, got an empty file")
    for number, line in enumerate(lines, start=1):
        try:
            objects = list(_objects(line))
        except (ValueError, RecursionError) as error:
            cut = f"; {CUT}" if number == len(lines) else ""
            said = str(error) if type(error) is ValueError else "what is none"
            faults.add(f"{file}, line {number}", f"expected a JSON object, got {said}, {quoted(line.strip())}{cut}")
            continue
        for one in objects:
            words = _words(one, f"{file}, line {number}", faults)
            if words is not None:
                yield AnswerRow(file, f"line {number}", words)


def _objects(line: str) -> Iterator[dict[str, Any]]:
    """Yield the objects that stand one behind the other in a line."""
    at = _skip_blanks(line, 0)
    while at < len(line):
        one, at = _DECODER.raw_decode(line, at)
        if not isinstance(one, dict):
            raise ValueError("something else")
        yield one
        at = _skip_blanks(line, at)


def _skip_blanks(line: str, at: int) -> int:
    while at < len(line) and line[at].isspace():
        at += 1
    return at


def _as_dict(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    names = [name for name, _ in pairs]
    if len(set(names)) < len(names):
        raise ValueError("one with a key twice")
    return dict(pairs)


def _refuse(word: str) -> Any:
    raise ValueError(f"one with the number {word}")


_DECODER = json.JSONDecoder(
    object_pairs_hook=_as_dict, parse_int=_Number, parse_float=_Number, parse_constant=_refuse, strict=True
)


def _words(given: dict[str, Any], place: str, faults: Faults) -> list[str] | None:
    """Return the cells of an object as they would stand in a table, or None if it has other keys or kinds."""
    lacking = [name for name in NAMES if name not in given]
    unknown = [quoted(name) for name in given if name not in ANSWER_COLUMNS]
    if lacking or unknown:
        what = [f"without {', '.join(lacking[:10])}"] if lacking else []
        what += [f"with the unknown {', '.join(unknown[:10])}"] if unknown else []
        faults.add(
            place, f"expected an answer with the keys {', '.join(NAMES[:4])} and so on, got one {' and '.join(what)}"
        )
        return None
    words = [_word(given[name], column.kind) for name, column in ANSWER_COLUMNS.items()]
    wrong = [name for name, word in zip(NAMES, words, strict=True) if word is None]
    for name in wrong:
        wanted = "text" if ANSWER_COLUMNS[name].kind == "str" else "a number"
        faults.add(place, f"{name}: expected {wanted}, got {_said(given[name])}")
    return None if wrong else [str(word) for word in words]


def _said(value: Any) -> str:
    """Return a value that is of the wrong kind, for an error."""
    if isinstance(value, _Number):
        return f"the number {str(value)[:60]}"
    if isinstance(value, str):
        return f"the text {quoted(value)}"
    if isinstance(value, (dict, list)):
        return "an object" if isinstance(value, dict) else "a list"
    return json.dumps(value)


def _word(value: Any, kind: str) -> str | None:
    if value is None and kind == "float":
        return ""
    right = isinstance(value, str) and isinstance(value, _Number) == (kind != "str")
    return str(value) if right else None
