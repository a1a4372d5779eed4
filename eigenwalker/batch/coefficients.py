"""A data set of coefficients, read back: as one table, in batches, what was refused, and the way back to walks."""

from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import pandas as pd

from eigenwalker.batch.parts import make_schema, pyarrow, read_part, readable_paths
from eigenwalker.batch.settings import Settings, read_settings
from eigenwalker.model.linearization import FourierLinearizer

__all__ = ["iterate_coefficients", "read_coefficients", "read_linearizer", "refused_files"]


def iterate_coefficients(
    folder: str | PathLike[str], *, columns: Sequence[str] | None = None, batch_rows: int = 10_000
) -> Iterator[pd.DataFrame]:
    """Return an iterator over the walks of a data set, many at a time, for statistics that do not need all at once.

    Parameters
    ----------
    folder : str or path
        What `linearize_files` has written.
    columns : sequence of str, default None
        Which columns, in this order; None is all but "reason". See `linearize_files` for what there is.
    batch_rows : int, default 10_000
        Rows in each table but the last one, whatever the parts on disk are.

    Returns
    -------
    iterator of DataFrame
        Walks that were not refused, always in the same order.

    Raises
    ------
    ImportError
        If pyarrow is not installed.
    ValueError
        If the folder is not a data set, lacks a column, or a part is damaged.

    Examples
    --------
    >>> from eigenwalker.batch import iterate_coefficients
    >>> tables = iterate_coefficients("coefficients", columns=["file", "frequency"])  # doctest: +SKIP
    >>> n_walks = sum(len(table) for table in tables)  # doctest: +SKIP
    """
    if int(batch_rows) != batch_rows or batch_rows < 1:
        raise ValueError(f"batch_rows must be a whole number of at least 1, got {batch_rows!r}")
    settings = _settings(folder)
    chosen = _check_columns(settings, columns)
    return (table.to_pandas(use_threads=False) for table in _batches(_used(Path(folder), settings, chosen), batch_rows))


def read_coefficients(folder: str | PathLike[str], *, columns: Sequence[str] | None = None) -> pd.DataFrame:
    """Return the walks of a data set as one table.

    Parameters
    ----------
    folder : str or path
        What `linearize_files` has written.
    columns : sequence of str, default None
        Which columns, in this order; None is all but "reason". See `linearize_files` for what there is.

    Returns
    -------
    DataFrame
        One row for each walk that was not refused, always in the same order. The features, in the order of the
        linearizer, are ``table[read_linearizer(folder).get_feature_names_out()]``.

    Raises
    ------
    ImportError
        If pyarrow is not installed.
    ValueError
        If the folder is not a data set, lacks a column, or a part is damaged.

    Examples
    --------
    >>> from eigenwalker.batch import read_coefficients
    >>> table = read_coefficients("coefficients", columns=["name", "frequency"])  # doctest: +SKIP
    """
    settings = _settings(folder)
    chosen = _check_columns(settings, columns)
    pa = pyarrow()
    schema = make_schema(_features(settings), settings.mark)
    empty = pa.schema([schema.field(name) for name in chosen]).empty_table()
    table = pa.concat_tables([empty, *_used(Path(folder), settings, chosen)])
    return table.to_pandas(use_threads=False)


def refused_files(folder: str | PathLike[str]) -> pd.DataFrame:
    """Return what was refused, and why. ``linearize_files(..., retry_refused=True)`` reads these files again.

    Parameters
    ----------
    folder : str or path
        What `linearize_files` has written.

    Returns
    -------
    DataFrame
        One row a refusal, with the columns file, name (missing if the file could not be read) and reason.
    """
    settings = _settings(folder)
    pa, names = pyarrow(), ["file", "name", "reason"]
    empty = pa.schema([(name, pa.string()) for name in names]).empty_table()
    parts = (read_part(path, mark=settings.mark, columns=names) for path in readable_paths(Path(folder)))
    found = [part.filter(pa.compute.is_valid(part["reason"])) for part in parts]
    return pa.concat_tables([empty, *(part.replace_schema_metadata(None) for part in found)]).to_pandas(
        use_threads=False
    )


def read_linearizer(folder: str | PathLike[str]) -> FourierLinearizer:
    """Return the fitted linearizer of a data set: the names of its features, and the way back from them to walks.

    Parameters
    ----------
    folder : str or path
        What `linearize_files` has written.

    Returns
    -------
    FourierLinearizer

    Examples
    --------
    >>> from eigenwalker.batch import read_coefficients, read_linearizer
    >>> linearizer = read_linearizer("coefficients")  # doctest: +SKIP
    >>> features = read_coefficients("coefficients", columns=linearizer.get_feature_names_out())  # doctest: +SKIP
    >>> walk = linearizer.inverse_transform(features[:1])[0]  # doctest: +SKIP
    """
    return _settings(folder).linearizer


def _settings(folder: str | PathLike[str]) -> Settings:
    settings = read_settings(Path(folder))
    if settings is None:
        raise ValueError(f"{folder}: expected a folder that linearize_files has written, got none")
    return settings


def _features(settings: Settings) -> list[str]:
    return list(settings.linearizer.get_feature_names_out())


def _check_columns(settings: Settings, columns: Sequence[str] | None) -> list[str]:
    names = make_schema(_features(settings), settings.mark).names
    if columns is None:
        return [name for name in names if name != "reason"]
    if isinstance(columns, str):
        raise TypeError(f"columns must be a sequence of names, got the single string {columns!r}")
    unknown = [name for name in columns if name not in names]
    if unknown:
        raise ValueError(f"columns must be out of {', '.join(names[:12])} ..., got {', '.join(map(str, unknown[:6]))}")
    return list(columns)


def _used(folder: Path, settings: Settings, columns: list[str]) -> Iterator[Any]:
    """Yield the walks of each part that were not refused."""
    pa = pyarrow()
    for path in readable_paths(folder):
        part = read_part(path, mark=settings.mark, columns=[*columns, *({"reason"} - set(columns))])
        yield part.filter(pa.compute.is_null(part["reason"])).select(columns).replace_schema_metadata(None)


def _batches(parts: Iterator[Any], n_rows: int) -> Iterator[Any]:
    """Yield the rows of tables again, in tables of another length."""
    pa, held = pyarrow(), None
    for part in parts:
        held = part if held is None else pa.concat_tables([held, part])
        while len(held) >= n_rows:
            yield held.slice(0, n_rows)
            held = held.slice(n_rows)
    if held is not None and len(held):
        yield held
