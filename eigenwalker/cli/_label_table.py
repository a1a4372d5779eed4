"""Labels on the command line: from a table, or from the names of the files."""

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from eigenwalker.cli._file_names import name_depth, short_name

__all__ = ["labels_from_names", "labels_from_table"]


def labels_from_table(table_path: Path, paths: Sequence[Path], columns: Sequence[str]) -> pd.DataFrame:
    """Return the labels of each file, in the order of the files.

    Parameters
    ----------
    table_path : Path
        A CSV file with a column ``file`` and one column a trait or group. Files may be written with or without suffix
        and folders; where files of the same name lie in several folders, with as many folders as tell them apart.
    paths : sequence of Path
        The files.
    columns : sequence of str
        The columns that are wanted.

    Returns
    -------
    DataFrame
        One row a file. Empty fields are missing.

    Raises
    ------
    ValueError
        If a column is missing, a file has no row or more than one, or a row has no file. All of them at once.
    """
    table = pd.read_csv(table_path, dtype={"file": str})
    missing = [name for name in ("file", *columns) if name not in table]
    if missing:
        raise ValueError(
            f"{table_path}: expected the columns file, {', '.join(columns)}; {', '.join(missing)} not found, "
            f"it has {', '.join(map(str, table.columns))}"
        )
    depth = name_depth(paths)
    wanted = [short_name(path, depth) for path in paths]
    listed = table["file"].fillna("").map(lambda name: short_name(Path(name or " "), depth))
    faults = _mismatches(table_path, listed.tolist(), wanted)
    if faults:
        raise ValueError("; ".join(faults))
    return table.set_index(listed).loc[wanted, list(columns)]


def _mismatches(table_path: Path, listed: list[str], wanted: list[str]) -> list[str]:
    groups = {
        "files without a row in the table": sorted(set(wanted) - set(listed)),
        "rows without a file": sorted(set(listed) - set(wanted)),
        "files with more than one row": sorted(name for name, count in Counter(listed).items() if count > 1),
        "files of the same name": sorted(name for name, count in Counter(wanted).items() if count > 1),
    }
    return [
        f"{table_path}: {len(names)} {what}: {', '.join(names[:10])}{' ...' if len(names) > 10 else ''}"
        for what, names in groups.items()
        if names
    ]


def labels_from_names(pattern: str, paths: Sequence[Path], columns: Sequence[str]) -> pd.DataFrame:
    """Return labels that are part of the files' names.

    Parameters
    ----------
    pattern : str
        A regular expression, searched in each file's name, or in its path if the expression has a slash in it. Its
        named groups are columns, (?P<style>[a-z]+); a single group without a name is the only wanted column.
    paths : sequence of Path
        The files.
    columns : sequence of str
        The columns that are wanted.

    Returns
    -------
    DataFrame
        One row a file. Columns that are all numbers become numbers.

    Raises
    ------
    ValueError
        If the pattern is not a regular expression, lacks a group, or does not match a file.
    """
    try:
        expression = re.compile(pattern)
    except re.error as error:
        raise ValueError(f"--label-pattern: {pattern!r} is not a regular expression: {error}") from None
    unnamed = expression.groups == 1 and not expression.groupindex and len(columns) == 1
    lacking = [] if unnamed else [name for name in columns if name not in expression.groupindex]
    if lacking:
        raise ValueError(
            f"--label-pattern: {pattern!r} has no group for {', '.join(lacking)}; write (?P<{lacking[0]}>...) there"
        )
    names = [path.as_posix() if "/" in pattern else path.name for path in paths]
    matches = [expression.search(name) for name in names]
    silent = [name for name, match in zip(names, matches, strict=True) if match is None]
    if silent:
        raise ValueError(
            f"--label-pattern: {pattern!r} does not match {len(silent)} of {len(paths)} files: "
            f"{', '.join(silent[:10])}{' ...' if len(silent) > 10 else ''}"
        )
    rows = [[match[1 if unnamed else name] for name in columns] for match in matches if match is not None]
    depth = name_depth(paths)
    table = pd.DataFrame(rows, columns=list(columns), index=[short_name(path, depth) for path in paths])
    return table.apply(_numbers_if_all)


def _numbers_if_all(column: pd.Series) -> pd.Series:
    numbers = pd.to_numeric(column, errors="coerce")
    return numbers if numbers.notna().eq(column.notna()).all() else column
