"""Many files, read, prepared and linearized in parallel into one data set on disk."""

import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence, Sized
from functools import partial
from itertools import chain, count, islice
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from joblib import Parallel, delayed
from threadpoolctl import threadpool_limits
from tqdm import tqdm

from eigenwalker._validation import WalkError
from eigenwalker.batch.cluster import workers_of
from eigenwalker.batch.parts import (
    Finished,
    check_parts,
    drop_refused,
    make_schema,
    pyarrow,
    sole_writer,
    write_part,
)
from eigenwalker.batch.rows import Job, Row, file_of, find_walk, rows_of_files
from eigenwalker.batch.settings import Settings, check_same, describe_call, read_settings, write_settings
from eigenwalker.io.formats import read_walk
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.motion.preparer import WalkPreparer
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["LinearizedFiles", "linearize_files"]

_TASK, _TASKS = 32, 64  # at most so many files a task, some tenths of a second; of fewer files so many tasks
_SHOWN = 10  # refusals in an error


class LinearizedFiles(NamedTuple):
    """What `linearize_files` returns: what is in the data set now.

    Parameters
    ----------
    folder : Path
        The data set.
    n_files : int
        Files that have been read.
    n_walks : int
        Walks with features.
    n_refused : int
        Walks and files without.
    """

    folder: Path
    n_files: int
    n_walks: int
    n_refused: int


def linearize_files(
    paths: Iterable[Any],
    linearizer: FourierLinearizer,
    out: str | PathLike[str] = "coefficients",
    *,
    preparer: WalkPreparer | str | None = None,
    read: Callable[..., Any] = read_walk,
    n_jobs: int | None = None,
    client: Any = None,
    files_per_part: int = 1000,
    retry_refused: bool = False,
    progress: bool = False,
    **options: object,
) -> LinearizedFiles:
    """Read, prepare and linearize files one by one, and write the coefficients into a Parquet data set.

    However many files there are, only a few walks are in memory. A run that was stopped, by whatever, goes on where
    it was when the same call is made again: a part of the data set is there as a whole or not at all, and files that
    have rows are not read again. A call with other settings than the first one is refused. More files can be added.

    Parameters
    ----------
    paths : iterable of str or path
        The files; a generator is read as the work goes on. With `read`, anything that it takes and that has a text of
        its own, such as numbers to make walks from. What comes twice is done once.
    linearizer : FourierLinearizer
        If it is fitted, all walks must have the channels of its template; if not, those of the first usable walk. It
        is not changed; `read_linearizer` returns the one that was used.
    out : str or path, default "coefficients"
        Folder of the data set: new, empty, or of a run before.
    preparer : WalkPreparer, "passthrough" or None, default None
        What brings recordings to the treadmill frame. None is ``WalkPreparer()``; "passthrough" is for walks that are
        prepared. Which joints have channels, it knows from its `fit`, from its `joints`, or else from the first usable
        walk.
    read : callable, default read_walk
        Takes one of `paths`, and returns a walk or an iterable of walks, which then are in memory one at a time. Not a
        lambda, by whose name settings could not be told apart.
    n_jobs : int, default None
        Number of processes, as in joblib: None is one, -1 is all processors. The data set is the same. Inside
        ``joblib.parallel_config("dask")`` the workers of a cluster do the work; they have to see the files, and this
        process has to see `out`.
    client : distributed.Client, default None
        The cluster whose workers do the work; None leaves it to joblib.
    files_per_part : int, default 1000
        Files whose rows go into one part; so many are done again at most after a crash.
    retry_refused : bool, default False
        Whether files of a run before that were refused, or in which a walk was, are read again: they have been mended,
        or a disk was away.
    progress : bool, default False
        Whether to show a bar on stderr once the job has taken two seconds.
    **options
        Passed on to `read`, such as ``unit`` and ``up``.

    Returns
    -------
    LinearizedFiles
        Where the data set is, and how many files, walks and refusals are in it.

    Raises
    ------
    ImportError
        If pyarrow is not installed.
    TypeError
        If `linearizer`, `preparer`, `read` or `client` are of another kind, or `paths` is a single path.
    ValueError
        If there are no paths, if the folder holds something else, was written with other settings or is being written
        to by another process, or if no walk is usable and `linearizer` is not fitted.

    Warns
    -----
    UserWarning
        If files or walks were refused in this call: see `refused_files`.

    Notes
    -----
    The data set has one row a walk, in the order of `paths`, with the columns

    - file : as it was given; two files of one name differ in it. name : the walk's.
    - reason : why a file or walk was refused; its numbers are null then. Null for all others.
    - warnings : what was warned of while it was read, prepared and linearized, one line each, or null.
    - duration, n_cycles, speed, explained_power, path_residual : see `walk_quality`. Joints have no path_residual.
    - the features of the linearizer, ``frequency`` among them.

    `read_coefficients` and `iterate_coefficients` read it, and so does whatever reads Parquet:
    ``pandas.read_parquet(folder)``. The hash in the name of a part is that of its bytes.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from eigenwalker import FourierLinearizer, make_walkers, write_walk
    >>> from eigenwalker.batch import linearize_files, read_coefficients
    >>> with TemporaryDirectory() as folder:
    ...     for walk in make_walkers(3, treadmill=False, random_state=0).data:
    ...         write_walk(walk, Path(folder, f"{walk.name}.npz"))
    ...     files = sorted(Path(folder).glob("*.npz"))
    ...     done = linearize_files(files, FourierLinearizer(), Path(folder, "coefficients"))
    ...     table = read_coefficients(done.folder)
    >>> done.n_walks, list(table["name"]), table.shape
    (3, ['walker_000', 'walker_001', 'walker_002'], (3, 234))
    """
    pyarrow()
    preparer = _check_kinds(linearizer, preparer, read, files_per_part)
    items, folder = _check_paths(paths), Path(out)
    call = _Call(linearizer, preparer, partial(read, **options) if options else read)
    folder.mkdir(parents=True, exist_ok=True)
    read_settings(folder)  # refuses a folder with other things in it, before anything is written
    with sole_writer(folder), workers_of(client), threadpool_limits(limits=1):
        settings = read_settings(folder)
        if settings is None:
            settings, items = _begin(folder, call, items)
        check_same(settings, describe_call(*call), folder)
        finished = check_parts(folder, settings.mark)
        if retry_refused and finished.n_refused:
            drop_refused(folder, settings.mark)
            finished = check_parts(folder, settings.mark)
        job = Job(call.read, _options_of(preparer, settings.joints), settings.linearizer)
        total = len(paths) if isinstance(paths, Sized) else None
        bar = tqdm(
            total=total, initial=len(finished.files), desc="linearize", delay=2, disable=not progress, file=sys.stderr
        )
        with bar:
            task = _TASK if total is None else min(_TASK, 1 + total // _TASKS)
            rows = _rows_of_all(job, _unfinished(items, finished.files), task, n_jobs)
            done = _write(folder, _counted(rows, bar), finished, settings, files_per_part)
    return _report(folder, finished, done)


class _Call(NamedTuple):
    """What settles the rows of `linearize_files`."""

    linearizer: FourierLinearizer
    preparer: WalkPreparer | None
    read: Callable[..., Any]


class _Counts(NamedTuple):
    n_files: int
    n_walks: int
    n_refused: int
    reason: str  # of the first refusal


def _check_kinds(linearizer: object, preparer: object, read: object, files_per_part: int) -> WalkPreparer | None:
    """Return the preparer, None for walks that are prepared; raise if something is of the wrong kind."""
    if not isinstance(linearizer, FourierLinearizer):
        raise TypeError(f"linearizer must be a FourierLinearizer, got {type(linearizer).__name__}")
    if not (preparer is None or preparer == "passthrough" or isinstance(preparer, WalkPreparer)):
        raise TypeError(f"preparer must be a WalkPreparer, 'passthrough' or None, got {preparer!r}")
    if not callable(read) or getattr(read, "__name__", "") == "<lambda>":
        raise TypeError(f"read must be a function with a name, got {read!r}")
    if int(files_per_part) != files_per_part or files_per_part < 1:
        raise ValueError(f"files_per_part must be a whole number of at least 1, got {files_per_part!r}")
    if isinstance(preparer, str):
        return None
    return WalkPreparer() if preparer is None else preparer


def _check_paths(paths: Iterable[Any]) -> Iterator[Any]:
    """Return an iterator over at least one path."""
    if isinstance(paths, (str, bytes, PathLike)):
        raise TypeError(f"paths must be an iterable of paths, got the single path {str(paths)!r}: wrap it, [path]")
    if not isinstance(paths, Iterable):
        raise TypeError(f"paths must be an iterable of paths, got {type(paths).__name__}")
    items = iter(paths)
    first = list(islice(items, 1))
    if not first:
        raise ValueError("expected at least one path, got none; if they come from a pattern, it matches no file")
    return chain(first, items)


def _begin(folder: Path, call: _Call, items: Iterator[Any]) -> tuple[Settings, Iterator[Any]]:
    """Write down what the data set is made with, and return it, with all items again."""
    preparer = call.preparer
    joints = None if preparer is None else getattr(preparer, "joints_", preparer.joints)
    if not hasattr(call.linearizer, "template_"):
        walk, seen = _first_walk(Job(call.read, _options_of(preparer, joints), call.linearizer), items)
        items = chain(seen, items)
    else:
        walk = call.linearizer.template_
    if joints is None and isinstance(walk, JointWalk) and preparer is not None:
        joints = walk.channel_joints
    return write_settings(folder, describe_call(*call), walk, joints), items


def _first_walk(job: Job, items: Iterator[Any]) -> tuple[Walk | JointWalk, list[Any]]:
    """Return the first usable walk, and the items up to it."""
    seen, reasons = [], ""
    for item in items:
        seen.append(item)
        walk, reason = find_walk(job, item)
        if walk is not None:
            return walk, seen
        if len(seen) <= _SHOWN:
            reasons += f"\n  {file_of(item)}: {reason or 'no walk in it'}"
    more = f"\n  and {len(seen) - _SHOWN} more" if len(seen) > _SHOWN else ""
    raise WalkError(f"no walk is usable in {len(seen)} files:{reasons}{more}")


def _options_of(preparer: WalkPreparer | None, joints: Sequence[str] | None) -> dict[str, Any] | None:
    """Return the arguments of `prepare`; None is no preparation."""
    if preparer is None:
        return None
    options = preparer.get_params(deep=False)
    return options | {"joints": joints} if options["representation"] == "joints" else options


def _unfinished(items: Iterator[Any], files: set[str]) -> Iterator[Any]:
    """Yield the items that are not among `files`, and add them."""
    for item in items:
        if (file := file_of(item)) not in files:
            files.add(file)
            yield item


def _rows_of_all(job: Job, items: Iterator[Any], n_a_task: int, n_jobs: int | None) -> Iterator[list[Row]]:
    """Yield the rows of each file, in order."""
    tasks = iter(lambda: list(islice(items, n_a_task)), [])
    workers = Parallel(n_jobs=n_jobs, return_as="generator", batch_size=1, pre_dispatch="3*n_jobs")
    return chain.from_iterable(workers(delayed(rows_of_files)(job, task) for task in tasks))


def _counted(rows: Iterator[list[Row]], bar: tqdm) -> Iterator[list[Row]]:
    for one in rows:
        yield one
        bar.update()


def _write(
    folder: Path, files: Iterable[list[Row]], finished: Finished, settings: Settings, files_per_part: int
) -> _Counts:
    """Write the rows part by part, into the numbers that are free, and count them."""
    schema = make_schema(list(settings.linearizer.get_feature_names_out()), settings.mark)
    numbers = (number for number in count() if number not in finished.numbers)
    n_files = n_walks = n_refused = 0
    reason = ""
    files = iter(files)
    while part := list(islice(files, files_per_part)):
        rows = [row for rows in part for row in rows]
        write_part(folder, next(numbers), rows, schema)
        refused = [row for row in rows if row.reason is not None]
        n_files, n_refused = n_files + len(part), n_refused + len(refused)
        n_walks += len(rows) - len(refused)
        reason = reason or next((f"{row.file}: {row.reason}" for row in refused), "")
    return _Counts(n_files, n_walks, n_refused, reason)


def _report(folder: Path, finished: Finished, done: _Counts) -> LinearizedFiles:
    if done.n_refused:
        warnings.warn(
            f"{done.n_refused} of {done.n_refused + done.n_walks} walks were refused and have no features; "
            f"refused_files({str(folder)!r}) says why, of the first: {done.reason}",
            stacklevel=3,
        )
    n_walks, n_refused = finished.n_walks + done.n_walks, finished.n_refused + done.n_refused
    return LinearizedFiles(folder, len(finished.files), n_walks, n_refused)
