"""Data sets after Psych-DS: what lies where, what files are called, and what is said of their columns.

Psych-DS (psych-ds.github.io, schema 1) asks for a ``dataset_description.json`` with a name, a description and all
columns, and for tables under ``data`` that are called after pairs of keyword and value,
``participant-3_task-rating_data.csv``. *participant* is not among its recommended keywords, which is a warning there
and no error; "subject" is, but a participant is what answers have.
"""

from __future__ import annotations

import csv
import json
import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigenwalker._validation import WalkError
from eigenwalker._whole_files import write_whole
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS, Column
from eigenwalker.io._text import decode_lines

if TYPE_CHECKING:
    from eigenwalker.experiment.study import Study

__all__ = ["DATA", "RAW", "check_dataset", "data_file_name", "dataset_description", "write_description"]

DATA, RAW = "data", "raw"
"""Folder of the tables, and the one in it that is for anything else."""

_DESCRIPTION = "dataset_description.json"
_CONTEXT = "https://schema.org/"
_NAME = re.compile(r"([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.csv")
_TITLE, _ABOUT = "Answers of a perception study of walks", "Answers of observers who were shown walks, one row a trial."


def data_file_name(participant: int, task: str) -> str:
    """Return what the table of a participant's answers to one task is called.

    >>> data_file_name(3, "rating")
    'participant-3_task-rating_data.csv'
    """
    return f"participant-{participant}_task-{task}_data.csv"


def dataset_description(title: str = _TITLE, description: str = _ABOUT, **more: Any) -> dict[str, Any]:
    """Return what a data set of answers says of itself, in the words of schema.org.

    Parameters
    ----------
    title, description : str
        What it is called, and what it is.
    **more
        Other properties of a Dataset of schema.org: identifier, author, license, citation, funder, url, keywords.

    Returns
    -------
    dict
        Ready for JSON. Each column of `ANSWER_COLUMNS` is a PropertyValue with name, description and maybe unitText.

    Examples
    --------
    >>> dataset_description("Moods")["variableMeasured"][10]  # doctest: +NORMALIZE_WHITESPACE
    {'@type': 'PropertyValue', 'name': 'view', 'description': 'azimuth of the observer: 0 in front of the walker, 90 at
    its right side', 'unitText': 'degrees'}
    """
    return {
        "@context": _CONTEXT,
        "@type": "Dataset",
        "name": title,
        "description": description,
        **more,
        "variableMeasured": [_variable(name, column) for name, column in ANSWER_COLUMNS.items()],
    }


def _variable(name: str, column: Column) -> dict[str, str]:
    said = {"@type": "PropertyValue", "name": name, "description": column.description}
    return said | ({"unitText": column.unit} if column.unit else {})


def write_description(folder: str | os.PathLike[str], study: Study | None = None) -> None:
    """Write the description of a data set of answers, as a whole or not at all.

    Parameters
    ----------
    folder : str or path
        Of the data set.
    study : Study, default None
        Whose answers they are: its title and tasks are said.
    """
    if study is None:
        said = dataset_description()
    else:
        tasks = ", ".join(f"{task.name} of {task.trait}" if task.trait else task.name for task in study.tasks)
        counts = f"{len(study.stimuli)} stimuli, {study.n_participants} participants planned"
        about = f"{_ABOUT} Tasks: {tasks}. {counts}."
        said = dataset_description(study.title.strip() or _TITLE, about, identifier=study.id)
    text = json.dumps(said, indent=1, ensure_ascii=False) + "\n"
    write_whole(Path(folder, _DESCRIPTION), text.encode())


def check_dataset(folder: str | os.PathLike[str]) -> list[str]:
    """Return what is wrong with a data set, by the rules of Psych-DS.

    Checked are: that the description is there, is JSON in UTF-8, and is a Dataset of schema.org with a name, a
    description and variableMeasured, a list of words or PropertyValues with names; that there is at least one table
    under ``data``, ``data/raw`` apart, and all of them end in ``_data.csv`` and are called after keywords and values;
    that tables are UTF-8 with commas and a header, have as many cells in each row as there, and no value twice in a
    column ``row_id``. Beyond its rules the columns of each table must be the very ones in variableMeasured. Other files
    are not looked at, nor the descriptions of single tables or folders (sidecars), nor what is only recommended.

    Parameters
    ----------
    folder : str or path
        Of the data set.

    Returns
    -------
    list of str
        One line a fault; empty where there are none.

    Examples
    --------
    >>> check_dataset("no such folder")
    ['dataset_description.json: expected in the folder, got none', 'data: expected a folder of tables, got none']
    """
    base = Path(folder)
    faults, variables = _check_description(base / _DESCRIPTION)
    if not (base / DATA).is_dir():
        return [*faults, f"{DATA}: expected a folder of tables, got none"]
    tables = [path for path in sorted((base / DATA).rglob("*.csv")) if path.relative_to(base / DATA).parts[0] != RAW]
    if not tables:
        faults.append(f"{DATA}: expected at least one table, ..._data.csv, got none")
    for path in tables:
        name = path.relative_to(base).as_posix()
        faults += [f"{name}: {fault}" for fault in _check_table(path, variables)]
    return faults


def _check_description(path: Path) -> tuple[list[str], set[str] | None]:
    """Return what is wrong with a description, and the columns that it names if there is no doubt about them."""
    if not path.is_file():
        return [f"{path.name}: expected in the folder, got none"], None
    try:
        said = json.loads(path.read_bytes().decode("utf-8"))
    except (ValueError, RecursionError) as error:
        return [f"{path.name}: expected JSON in UTF-8, got {type(error).__name__}: {error}"], None
    if not isinstance(said, dict):
        return [f"{path.name}: expected a JSON object, got {type(said).__name__}"], None
    faults = [
        f"{path.name}: {key}: expected {wanted}, got {str(said.get(key))[:60]!r}"
        for key, wanted, is_right in (
            (
                "@context",
                _CONTEXT,
                str(said.get("@context")).rstrip("/") in ("https://schema.org", "http://schema.org"),
            ),
            ("@type", "Dataset", said.get("@type") in ("Dataset", "https://schema.org/Dataset")),
            *(
                (key, "words", isinstance(said.get(key), str) and said[key].strip() != "")
                for key in ("name", "description")
            ),
        )
        if not is_right
    ]
    variables = _names(said.get("variableMeasured"))
    if variables is None or len(set(variables)) < len(variables):
        faults.append(
            f"{path.name}: variableMeasured: expected a list of words or PropertyValues, with different names"
        )
        return faults, None
    return faults, set(variables)


def _names(measured: object) -> list[str] | None:
    """Return the names in variableMeasured, or None where it is not as it should be."""
    if not isinstance(measured, list):
        return None
    names = [
        one.get("name") if isinstance(one, dict) and one.get("@type", one.get("type")) == "PropertyValue" else one
        for one in measured
    ]
    strings = [name for name in names if isinstance(name, str) and name]
    return strings if len(strings) == len(names) else None


def _check_table(path: Path, variables: set[str] | None) -> Iterator[str]:
    if not _NAME.fullmatch(path.name):
        yield "expected a name of keywords and values, participant-3_task-rating_data.csv"
    try:
        lines = decode_lines(path.read_bytes(), "a table")
        rows = [row for row in csv.reader(lines, strict=True) if row]
    except (WalkError, csv.Error) as error:
        yield str(error)
        return
    if not rows or not all(rows[0]):
        yield "expected a header, a name over each column"
        return
    header = rows[0]
    uneven = sum(len(row) != len(header) for row in rows)
    if uneven:
        yield f"expected {len(header)} cells in each row, as in the header, got others in {uneven} rows"
    elif "row_id" in header and len({row[header.index("row_id")] for row in rows}) < len(rows):
        yield "expected different values in row_id, got some twice"
    yield from _compare(header, variables)


def _compare(header: Sequence[str], variables: set[str] | None) -> Iterator[str]:
    if variables is None:
        return
    unsaid = [name for name in header if name not in variables]
    lacking = sorted(variables - set(header))
    if unsaid:
        yield f"expected columns out of variableMeasured, got {', '.join(unsaid)} too"
    if lacking:
        yield f"expected all columns of variableMeasured, got none called {', '.join(lacking)}"
    if len(set(header)) < len(header):
        yield "expected different columns, got some twice"
