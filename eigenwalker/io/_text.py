"""Tables in text files: decoding, rows of words, numbers with gaps, and the line of whatever is wrong.

Errors start with ``line 12:``; `name_file` puts the file's name before them.
"""

import csv
import math
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError

__all__ = [
    "CUT",
    "Row",
    "decimal",
    "decode_lines",
    "join_numbers",
    "listed",
    "name_file",
    "number_table",
    "plain_numbers",
    "shown",
    "split_rows",
    "write_lines",
]

CUT = "the file seems to be cut off; get it again"

_DECIMAL = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")  # no two ways to read a digit
_GAPS = ("", "nan", "n/a")
_MOST_LISTED, _LONGEST_NAME = 60, 60


class Row(NamedTuple):
    """One line of a table: its number in the file and its fields."""

    line: int
    words: list[str]


@contextmanager
def name_file(path: str | PathLike[str], *, before: str = ", ") -> Iterator[None]:
    """Put the file's name and `before`, a comma where a line follows, before any WalkError."""
    try:
        yield
    except WalkError as error:
        raise WalkError(f"{path}{before}{error}") from None


def decode_lines(data: bytes, kind: str) -> list[str]:
    """Return the lines of a UTF-8 file, without their ends and without empty lines at the end of the file.

    Parameters
    ----------
    data : bytes
        The file. A byte order mark is dropped; line feeds, carriage returns and both together end lines.
    kind : str
        What the file should be, for the error: "a TRC file".
    """
    if b"\0" in data:
        line = data.count(b"\n", 0, data.index(b"\0")) + 1
        raise WalkError(f"line {line}: expected the text of {kind}, got binary data (a zero byte)")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise WalkError(
            f"line {line}: expected UTF-8 text, got byte 0x{data[error.start]:02x}; "
            f"if this is {kind} with accented names, save it as UTF-8"
        ) from None
    return text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n").split("\n")


def shown(text: str) -> str:
    """Return `text` in quotes, shortened, for an error."""
    text = text.strip()
    return repr(text if len(text) <= 40 else text[:37] + "...")


def listed(names: Collection[str]) -> str:
    """Return names with commas between them for an error: no more than can be read, and in quotes what is no name.

    >>> listed(["heel", "toe"]), listed([f"m{number}" for number in range(500)])[-17:]
    ('heel, toe', ' m59 and 440 more')
    """
    some = islice(names, _MOST_LISTED)
    first = ", ".join(name if name.isprintable() and len(name) <= _LONGEST_NAME else shown(name) for name in some)
    return first + (f" and {len(names) - _MOST_LISTED} more" if len(names) > _MOST_LISTED else "")


def decimal(text: str) -> float | None:
    """Return the finite number that `text` writes, or None."""
    if _DECIMAL.fullmatch(text) is None:
        return None
    value = float(text)
    return value if math.isfinite(value) else None


def split_rows(lines: Sequence[str], *, separator: str, first: int = 1, quotes: bool = True) -> list[Row]:
    """Return the fields of each line that is not empty.

    Parameters
    ----------
    lines : sequence of str
        As from `decode_lines`.
    separator : str
        The character between fields.
    first : int, default 1
        Number of the first of the lines in the file.
    quotes : bool, default True
        Whether fields may stand in double quotes.
    """
    reader = csv.reader(
        lines, delimiter=separator, quoting=csv.QUOTE_MINIMAL if quotes else csv.QUOTE_NONE, strict=True
    )
    try:
        rows = [Row(first - 1 + reader.line_num, words) for words in reader]
    except csv.Error as error:
        line = first - 1 + reader.line_num
        raise WalkError(f"line {line}: expected fields separated by {separator!r}, but {error}") from None
    return [row for row in rows if len(row.words) > 1 or "".join(row.words).strip()]


def number_table(rows: Sequence[Row], n_columns: int, *, columns: Sequence[int] | None = None) -> NDArray[np.float64]:
    """Return the numbers in rows of `n_columns` fields, shape (n_rows, n_picked), with NaN for gaps.

    Parameters
    ----------
    rows : sequence of Row
        Their number is the number of frames, whatever a header says.
    n_columns : int
        How many fields each row must have.
    columns : sequence of int, default None
        The columns that are picked, in this order. None is all.

    Returns
    -------
    ndarray of shape (n_rows, n_picked)
        A gap, NaN, is an empty field, ``nan`` or ``n/a``.

    Examples
    --------
    >>> number_table([Row(2, ["1.5", ""]), Row(3, ["nan", "-2e-3"])], 2)
    array([[ 1.5  ,    nan],
           [   nan, -0.002]])
    """
    for row in rows:
        if len(row.words) != n_columns:
            cut = f"; {CUT}" if row is rows[-1] and len(row.words) < n_columns else ""
            raise WalkError(f"line {row.line}: expected {n_columns} fields, got {len(row.words)}{cut}")
    picked = range(n_columns) if columns is None else columns
    numbers = plain_numbers([row.words[column] for row in rows for column in picked])
    if numbers is None:
        numbers = np.array([_number(row, column) for row in rows for column in picked])
    return numbers.reshape(len(rows), len(picked))  # (n_rows n_picked,) -> (n_rows, n_picked)


def plain_numbers(words: Sequence[str]) -> NDArray[np.float64] | None:
    """Return all the numbers at once, NaN for empty words, or None if a word needs a closer look."""
    together = "".join(words)
    if "_" in together or not together.isascii():  # Python reads 1_0 and other scripts' digits as numbers
        return None
    try:
        numbers = np.array([float(word or "nan") for word in words], dtype=np.float64)
    except ValueError:
        return None
    return None if np.isinf(numbers).any() else numbers


def _number(row: Row, column: int) -> float:
    word = row.words[column].strip()
    if word.lower() in _GAPS:
        return math.nan
    value = decimal(word)
    if value is None:
        raise WalkError(
            f"line {row.line}: expected a finite number or a gap as value {column + 1} of {len(row.words)}, "
            f"got {shown(word)}"
        )
    return value


def join_numbers(numbers: Iterable[float], separator: str, *, gap: str = "") -> str:
    """Return the numbers as text that reads back as exactly the same numbers, with `gap` for NaN."""
    return separator.join(gap if number != number else repr(number) for number in numbers)


def write_lines(path: str | PathLike[str], lines: Iterable[str]) -> None:
    """Write a UTF-8 file with a line feed behind each line."""
    with Path(path).open("w", encoding="utf-8", newline="") as file:
        file.writelines(line + "\n" for line in lines)
