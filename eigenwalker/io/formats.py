"""Which reader takes which file, and many files at once."""

import inspect
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from os import PathLike
from pathlib import Path

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import WalkError, check_choice
from eigenwalker.io.bvh import read_bvh
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["READERS", "read_walk", "read_walks"]

READERS: Mapping[str, Callable[..., Walk | JointWalk]] = {".bvh": read_bvh}
"""The reader of each kind of file, by suffix in small letters."""


def read_walk(path: str | PathLike[str], **options: object) -> Walk | JointWalk:
    """Return the walk in one file, whose suffix says what kind of file it is.

    Parameters
    ----------
    path : str or path
        The file: ``.bvh``, see `read_bvh`.
    **options
        Passed on to the reader, such as ``unit`` and ``up``.

    Returns
    -------
    Walk or JointWalk
        Named after the file, without its suffix.

    Raises
    ------
    WalkError
        If the suffix is unknown or the reader refuses the file.
    TypeError
        If the reader does not take one of the options.

    Examples
    --------
    >>> from eigenwalker.io import read_walk
    >>> read_walk("anna.fbx")
    Traceback (most recent call last):
    eigenwalker._validation.WalkError: anna.fbx: expected a file of type .bvh, got suffix '.fbx'
    """
    suffix = Path(path).suffix.lower()
    if suffix not in READERS:
        raise WalkError(f"{path}: expected a file of type {', '.join(sorted(READERS))}, got suffix {suffix!r}")
    reader = READERS[suffix]
    _check_options(reader, options)
    return reader(path, **options)


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


def _check_options(reader: Callable[..., object], options: Mapping[str, object]) -> None:
    """Raise a TypeError unless the reader takes the options."""
    parameters = inspect.signature(reader).parameters.values()
    known = [entry.name for entry in parameters if entry.kind is entry.KEYWORD_ONLY]
    unknown = [option for option in options if option not in known]
    if unknown:
        title = getattr(reader, "__name__", "the reader")
        raise TypeError(f"{title} takes the options {', '.join(known)}, got {', '.join(unknown)}")
