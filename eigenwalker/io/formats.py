"""Which reader and writer take which file, and many files at once."""

import inspect
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import WalkError, check_choice
from eigenwalker.io.amc import read_amc
from eigenwalker.io.bids import read_bids, write_bids
from eigenwalker.io.bml import read_bml, write_bml
from eigenwalker.io.bvh import read_bvh
from eigenwalker.io.bvh_writer import write_bvh
from eigenwalker.io.c3d import read_c3d, write_c3d
from eigenwalker.io.kinect import read_kinect
from eigenwalker.io.npz import read_npz, write_npz
from eigenwalker.io.table import read_csv, write_csv
from eigenwalker.io.trc import read_trc, write_trc
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["READERS", "WRITERS", "find_ending", "read_walk", "read_walks", "write_walk"]

READERS: Mapping[str, Callable[..., Walk | JointWalk]] = {
    "_motion.tsv": read_bids,
    ".amc": read_amc,
    ".bvh": read_bvh,
    ".c3d": read_c3d,
    ".csv": read_csv,
    ".mat": read_bml,
    ".npz": read_npz,
    ".trc": read_trc,
    ".tsv": read_csv,
    ".txt": read_kinect,
}
"""The reader of each kind of file, by what its name ends in, in small letters. The longest ending that fits counts."""

WRITERS: Mapping[str, Callable[..., None]] = {
    "_motion.tsv": write_bids,
    ".bvh": write_bvh,
    ".c3d": write_c3d,
    ".csv": write_csv,
    ".mat": write_bml,
    ".npz": write_npz,
    ".trc": write_trc,
    ".tsv": write_csv,
}
"""The writer of each kind of file, by what its name ends in, as in `READERS`."""


def find_ending(path: str | PathLike[str], table: Mapping[str, object]) -> str | None:
    """Return the longest key of `table` that the name of a file ends in, in capital or small letters, or None.

    Examples
    --------
    >>> find_ending("sub-01_task-walk_MOTION.TSV", WRITERS), find_ending("walk.tsv", WRITERS)
    ('_motion.tsv', '.tsv')
    """
    name = Path(path).name.lower()
    return max((ending for ending in table if name.endswith(ending)), key=len, default=None)


def read_walk(path: str | PathLike[str], **options: object) -> Walk | JointWalk:
    """Return the walk in one file, whose suffix says what kind of file it is.

    Parameters
    ----------
    path : str or path
        The file: Motion-BIDS ``_motion.tsv`` (`read_bids`), Acclaim ``.amc`` with its ``.asf`` (`read_amc`), ``.bvh``
        (`read_bvh`), ``.c3d`` (`read_c3d`), tables ``.csv`` and ``.tsv``
        (`read_csv`), BML ``.mat`` (`read_bml`), ``.npz`` (`read_npz`), ``.trc`` (`read_trc`), or Kinect ``.txt``
        (`read_kinect`).
    **options
        Passed on to the reader, such as ``unit`` and ``up``.

    Returns
    -------
    Walk or JointWalk
        Named after the file, without its suffix; walks from NPZ files keep their names.

    Raises
    ------
    WalkError
        If the suffix is unknown or the reader refuses the file.
    TypeError
        If the reader does not take one of the options.

    Examples
    --------
    >>> from eigenwalker.io import read_walk
    >>> read_walk("anna.fbx")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    eigenwalker._validation.WalkError: anna.fbx: expected a file of type ..., got suffix '.fbx'
    """
    return _find(path, READERS, options)(path, **options)


def write_walk(walk: Walk | JointWalk, path: str | PathLike[str], **options: object) -> None:
    """Write a walk into a file, whose suffix says what kind of file it is.

    Parameters
    ----------
    walk : Walk or JointWalk
        What to write. Files of markers take a Walk, which `JointWalk.to_markers` makes; BVH takes a JointWalk.
    path : str or path
        Where to: Motion-BIDS ``_motion.tsv`` (`write_bids`), ``.bvh`` (`write_bvh`), ``.c3d`` (`write_c3d`), tables
        ``.csv`` and ``.tsv`` (`write_csv`), BML ``.mat`` (`write_bml`), ``.npz`` (`write_npz`), or ``.trc``
        (`write_trc`).
    **options
        Passed on to the writer, such as ``unit`` and ``up``.

    Raises
    ------
    WalkError
        If the suffix is unknown or the format cannot hold the walk.
    TypeError
        If the format is not for this kind of walk, or the writer does not take one of the options.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> import numpy as np
    >>> from eigenwalker.io import read_walk, write_walk
    >>> from eigenwalker.motion import MarkerSet, Walk
    >>> heel = Walk(np.arange(6.0).reshape(2, 1, 3), 100, MarkerSet(("heel",)))
    >>> with TemporaryDirectory() as folder:
    ...     write_walk(heel, Path(folder, "anna.trc"))
    ...     read_walk(Path(folder, "anna.trc")).marker("heel")
    array([[0., 1., 2.],
           [3., 4., 5.]])
    """
    _find(path, WRITERS, options)(walk, path, **options)


def read_walks(
    paths: Iterable[str | PathLike[str]],
    *,
    n_jobs: int | None = None,
    progress: bool = False,
    on_error: str = "raise",
    **options: object,
) -> list[Walk | JointWalk]:
    """Return the walks in many files, in their order.

    Parameters
    ----------
    paths : iterable of str or path
        The files; see `read_walk`.
    n_jobs : int, default None
        Number of processes, as in joblib: None is one, -1 is all processors. The result is the same.
    progress : bool, default False
        Whether to show a bar on stderr when it takes more than two seconds.
    on_error : {"raise", "skip"}, default "raise"
        What to do about files that cannot be read. "raise" reads them all and raises one error about
        all that were refused; "skip" leaves those out, with one warning. Labels are to be joined by
        `Walk.name` then, not by position.
    **options
        Passed on to the reader of each file, such as ``unit`` and ``up``.

    Returns
    -------
    list of Walk or JointWalk
        Each named after its file, without the suffix.

    Raises
    ------
    WalkError
        If files are refused, with the reason for each.
    TypeError
        If `paths` is a single path, or a reader does not take one of the options.
    ValueError
        If there are no paths.

    Examples
    --------
    >>> from pathlib import Path
    >>> from eigenwalker.io import read_walks
    >>> walks = read_walks(sorted(Path("walks").glob("*.bvh")), unit="cm")  # doctest: +SKIP
    """
    check_choice(on_error, ("raise", "skip"), name="on_error")
    if "name" in options:
        raise TypeError("read_walks names each walk after its file and takes no name; use read_walk for one file")
    files = _check_paths(paths)
    results, refusals = collect(
        partial(_read, options=options),
        files,
        [str(file) for file in files],
        n_jobs=n_jobs,
        progress=progress,
        description="reading",
    )
    report_refusals(refusals, len(files), on_error=on_error)
    return [walk for walk in results if walk is not None]


def _read(path: Path, options: Mapping[str, object]) -> Walk | JointWalk:
    return read_walk(path, **options)


def _check_paths(paths: Iterable[str | PathLike[str]]) -> list[Path]:
    """Return `paths` as a list of at least one path."""
    if isinstance(paths, (str, bytes, PathLike)):
        raise TypeError(f"paths must be a list of paths, got the single path {str(paths)!r}: wrap it, [path]")
    if not isinstance(paths, Iterable):
        raise TypeError(f"paths must be a list of paths, got {type(paths).__name__}")
    files = [Path(path) for path in paths]
    if not files:
        raise ValueError("expected at least one path, got none; if they come from a pattern, it matches no file")
    return files


def _find(
    path: str | PathLike[str], table: Mapping[str, Callable[..., Any]], options: Mapping[str, object]
) -> Callable[..., Any]:
    """Return the reader or writer of a file, or raise unless there is one and it takes the options."""
    ending = find_ending(path, table)
    if ending is None:
        raise WalkError(f"{path}: expected a file of type {', '.join(sorted(table))}, got suffix {Path(path).suffix!r}")
    function = table[ending]
    parameters = inspect.signature(function).parameters.values()
    known = [entry.name for entry in parameters if entry.kind is entry.KEYWORD_ONLY]
    unknown = [option for option in options if option not in known]
    if unknown:
        title = getattr(function, "__name__", "the function")
        takes = f"takes the options {', '.join(known)}" if known else "takes no options"
        raise TypeError(f"{title} {takes}, got {', '.join(unknown)}")
    return function
