"""What may stand in each cell of a table of answers: words to values, or what was expected in their place."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from datetime import datetime
from typing import Any, NamedTuple

from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS
from eigenwalker.experiment.stimulus import CONDITIONS, KINDS
from eigenwalker.experiment.tasks import TASKS
from eigenwalker.io._text import decimal

__all__ = ["NAMES", "PARTS", "TIME", "Cell", "parse_cell"]

NAMES = tuple(ANSWER_COLUMNS)
"""Names of the columns of answers, in order."""

PARTS = ("practice", "main", "attention")
"""What a trial can be."""

TIME = "a time such as 2026-11-23T10:00:00.000Z"
"""How times are written."""

_WHOLE = re.compile(r"0|[1-9][0-9]{0,14}")
_COMMA = re.compile(r"[+-]?[0-9]+,[0-9]+")
_STUDY = re.compile(r"[0-9a-f]{12}")
_TIME = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}(\.[0-9]{1,6})?Z")


class Cell(NamedTuple):
    """What a word stands for.

    Parameters
    ----------
    value : int, float, str or None
        None where the word is wrong.
    wanted : str, default ""
        What was expected in its place.
    """

    value: Any
    wanted: str = ""


def parse_cell(column: str, word: str) -> Cell:
    """Return the value of a word in a column.

    Parameters
    ----------
    column : str
        One of `NAMES`.
    word : str
        Of a file: a number is written plainly, with a decimal point; nothing is NaN.

    Returns
    -------
    Cell

    Examples
    --------
    >>> parse_cell("response_time_s", "2.5"), parse_cell("trial", "2.5")
    (Cell(value=2.5, wanted=''), Cell(value=None, wanted='a whole number from 1'))
    """
    kind = ANSWER_COLUMNS[column].kind
    wanted, is_right = _RULES.get(column, (_KINDS[kind], _is_anything))
    value = _PARSERS[kind](word)
    if value is not None and is_right(value):
        return Cell(value)
    has_comma = kind != "str" and _COMMA.fullmatch(word) is not None
    hint = "; a spreadsheet program has put a decimal comma, take the file as it was before" if has_comma else ""
    return Cell(None, wanted + hint)


def _parse_whole(word: str) -> int | None:
    return int(word) if _WHOLE.fullmatch(word) else None


def _parse_number(word: str) -> float | None:
    return math.nan if word == "" else decimal(word)


def _parse_text(word: str) -> str | None:
    """Return the text, or None for what a line of a file cannot hold."""
    broken = any(letter in "\0\n\r" or "\ud800" <= letter <= "\udfff" for letter in word)
    return None if broken else word


def _is_time(word: str) -> bool:
    if not _TIME.fullmatch(word):
        return word == ""
    try:
        datetime.fromisoformat(word)
    except ValueError:
        return False
    return True


def _is_anything(_: Any) -> bool:
    return True


def _one_of(choices: Sequence[str]) -> tuple[str, Callable[[Any], bool]]:
    return f"one of {', '.join(choice or 'nothing' for choice in choices)}", lambda value: value in choices


_PARSERS: dict[str, Callable[[str], Any]] = {"int": _parse_whole, "float": _parse_number, "str": _parse_text}
_KINDS = {"int": "a whole number", "float": "a number or nothing", "str": "text in one line"}
_FROM_1: tuple[str, Callable[[Any], bool]] = ("a whole number from 1", lambda value: value >= 1)
_FROM_0: tuple[str, Callable[[Any], bool]] = ("a number of at least 0, or nothing", lambda value: not value < 0)
_ABOVE_0: tuple[str, Callable[[Any], bool]] = ("a number above 0, or nothing", lambda value: not value <= 0)
_RULES: dict[str, tuple[str, Callable[[Any], bool]]] = {
    "study": ("12 hexadecimal digits", lambda value: _STUDY.fullmatch(value) is not None),
    **dict.fromkeys(("participant", "session", "trial", "visit"), _FROM_1),
    "task": _one_of(tuple(TASKS)),
    "part": _one_of(PARTS),
    "stimulus": ("the name of a stimulus", lambda value: value != ""),
    "view": ("an azimuth in degrees", math.isfinite),
    "kind": _one_of(("", *KINDS)),
    "condition": _one_of(("", *CONDITIONS)),
    **dict.fromkeys(("response_time_s", "shown_s"), _FROM_0),
    **dict.fromkeys(("refresh_hz", "pixels_per_degree", "pixel_ratio"), _ABOVE_0),
    "answered_at": (f"{TIME}, or nothing", _is_time),
}
