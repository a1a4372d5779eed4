"""Part files of a data set: so many rows each, written as a whole or not at all."""

import hashlib
import os
import re
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from eigenwalker.batch.rows import QUALITY, Row

__all__ = [
    "Finished",
    "check_parts",
    "drop_files",
    "make_schema",
    "pyarrow",
    "read_part",
    "readable_paths",
    "sole_writer",
    "write_part",
]

_NAME = re.compile(r"part-([0-9]{6,})-([0-9a-f]{16})\.parquet")
_HALF = ".part.tmp"  # one writer, so one name; readers of data sets pass over names with a dot in front
_MARK = b"eigenwalker"
_TEXTS = ("file", "name", "reason", "warnings")


class Finished(NamedTuple):
    """What the parts of a data set hold.

    Parameters
    ----------
    files : set of str
        The files with rows.
    refused : dict of str to int
        The files with a refusal, and the number of the part with their rows.
    n_walks, n_refused : int
        Number of rows with features, and without.
    numbers : set of int
        Numbers of the parts.
    """

    files: set[str]
    refused: dict[str, int]
    n_walks: int
    n_refused: int
    numbers: set[int]


def pyarrow() -> Any:
    """Return the package that reads and writes Parquet."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise ImportError("tables of many files need pyarrow: pip install 'eigenwalker[parquet]'") from None
    return pyarrow


def make_schema(features: Sequence[str], mark: str) -> Any:
    """Return the columns of the table: texts, quality, features."""
    pa = pyarrow()
    numbers = [*(name for name in QUALITY if name not in features), *features]
    columns = [(name, pa.string()) for name in _TEXTS] + [(name, pa.float64()) for name in numbers]
    return pa.schema(columns, metadata={_MARK: mark})


def write_part(folder: Path, number: int, rows: Sequence[Row], schema: Any) -> Path:
    """Write rows into a file of their own. The hash of its bytes is in its name."""
    path = _write_half(folder, number, _make_table(rows, schema))
    os.replace(folder / _HALF, path)
    return path


def _write_half(folder: Path, number: int, table: Any) -> Path:
    """Write a table under a name that is passed over, and return the one that it is to get."""
    pa = pyarrow()
    sink = pa.BufferOutputStream()
    pa.parquet.write_table(table, sink, use_dictionary=False)
    data = sink.getvalue()
    with (folder / _HALF).open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    return folder / f"part-{number:06d}-{_digest(data)}.parquet"


def _make_table(rows: Sequence[Row], schema: Any) -> Any:
    pa = pyarrow()
    n_features = next((len(row.features) for row in rows if row.features is not None), 0)
    empty = (np.full(len(QUALITY), np.nan), np.full(n_features, np.nan))
    quality = np.array([row.quality or empty[0] for row in rows])
    features = np.array([empty[1] if row.features is None else row.features for row in rows])
    is_refused = np.array([row.features is None for row in rows])
    names = [name for name in schema.names if name not in _TEXTS]
    places = {name: quality[:, place] for place, name in enumerate(QUALITY)}
    places |= {name: features[:, place] for place, name in enumerate(names[len(names) - n_features :])}
    columns = [pa.array([getattr(row, name) for row in rows], pa.string()) for name in _TEXTS]
    missing = np.full(len(rows), np.nan)
    columns += [pa.array(places.get(name, missing), pa.float64(), mask=is_refused) for name in names]
    return pa.table(columns, schema=schema)


def _part_paths(folder: Path) -> list[Path]:
    """Return the part files in a folder, in their order."""
    return [
        path for _, path in sorted((_number(path), path) for path in folder.iterdir() if _NAME.fullmatch(path.name))
    ]


def _number(path: Path) -> int:
    found = _NAME.fullmatch(path.name)
    assert found is not None
    return int(found[1])


def read_part(path: Path, *, mark: str, columns: Sequence[str] | None = None) -> Any:
    """Return the table in a part file.

    Raises
    ------
    ValueError
        If the file is not as it was written, or is part of a data set with other settings.
    """
    pa, data = pyarrow(), path.read_bytes()
    if not _is_sound(path, data):
        raise ValueError(
            f"{path}: the file is damaged, it is not as it was written; call linearize_files again with the same "
            "files, which makes its rows anew"
        )
    table = pa.parquet.read_table(pa.BufferReader(data), columns=columns, use_threads=False)
    if (table.schema.metadata or {}).get(_MARK) != mark.encode():
        raise ValueError(f"{path}: expected a part with the settings of this data set, got one of another; take it out")
    return table


def check_parts(folder: Path, mark: str) -> Finished:
    """Return what the parts hold; those that were not written to the end, were replaced, or are damaged, are deleted.

    Warns
    -----
    UserWarning
        For each part that was damaged.
    """
    pa = pyarrow()
    (folder / _HALF).unlink(missing_ok=True)
    _delete_damaged(folder)
    _delete_replaced(folder, mark)
    files, refused, numbers, n_refused, n_rows = set(), {}, set(), 0, 0
    for path in _part_paths(folder):
        table = read_part(path, mark=mark, columns=["file", "reason"])
        files.update(table["file"].to_pylist())
        numbers.add(_number(path))
        without = table["file"].filter(pa.compute.is_valid(table["reason"]))
        refused.update(dict.fromkeys(without.to_pylist(), _number(path)))
        n_refused += len(without)
        n_rows += len(table)
    return Finished(files, refused, n_rows - n_refused, n_refused, numbers)


def _delete_damaged(folder: Path) -> None:
    for path in _part_paths(folder):
        if not _is_sound(path, path.read_bytes()):
            warnings.warn(f"{path}: the file was damaged and is deleted; its rows are made anew", stacklevel=4)
            path.unlink()


def _delete_replaced(folder: Path, mark: str) -> None:
    """Delete a part that `drop_files` had made a shorter one of when it was ended."""
    for paths in _by_number(_part_paths(folder)).values():
        if len(paths) > 1:
            n_rows = {path: len(read_part(path, mark=mark, columns=["file"])) for path in paths}
            max(paths, key=n_rows.__getitem__).unlink()


def _by_number(paths: Iterable[Path]) -> dict[int, list[Path]]:
    found: dict[int, list[Path]] = {}
    for path in paths:
        found.setdefault(_number(path), []).append(path)
    return found


def readable_paths(folder: Path) -> list[Path]:
    """Return the part files in a folder, in their order, for those who read them.

    Raises
    ------
    ValueError
        If a part is there twice, as it was being replaced when the run was ended.
    """
    paths = _part_paths(folder)
    twice = [found[0].name for found in _by_number(paths).values() if len(found) > 1]
    if twice:
        raise ValueError(
            f"{folder}: a run was ended while it replaced {twice[0]}; call linearize_files again with the same files, "
            "which goes on from there"
        )
    return paths


def drop_files(folder: Path, mark: str, files: Mapping[str, int]) -> tuple[int, int]:
    """Take the rows of files out of the parts with these numbers; return how many had features, and how many not."""
    pa = pyarrow()
    paths = {_number(path): path for path in _part_paths(folder)}
    n_walks = n_refused = 0
    for number in sorted(set(files.values())):
        table = read_part(paths[number], mark=mark)
        is_dropped = pa.compute.is_in(table["file"], value_set=pa.array(list(files), pa.string()))
        dropped, rest = table.filter(is_dropped), table.filter(pa.compute.invert(is_dropped))
        n_walks += dropped["reason"].null_count
        n_refused += len(dropped) - dropped["reason"].null_count
        if len(rest):
            os.replace(folder / _HALF, _write_half(folder, number, rest))
        paths[number].unlink()  # last: of two parts with a number `check_parts` keeps the shorter one
    return n_walks, n_refused


def _is_sound(path: Path, data: bytes) -> bool:
    found = _NAME.fullmatch(path.name)
    return found is not None and found[2] == _digest(data)


def _digest(data: Any) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


@contextmanager
def sole_writer(folder: Path) -> Iterator[None]:
    """Keep other processes from writing to a folder at the same time, where the system can.

    Raises
    ------
    ValueError
        If another process is writing to it.
    """
    try:
        import fcntl
    except ImportError:  # not a Unix
        yield
        return
    with (folder / "_lock").open("w") as file:
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError):
            raise ValueError(
                f"{folder}: another process is writing to it; wait for it, or choose another folder"
            ) from None
        except OSError:
            pass  # a file system without locks
        yield
