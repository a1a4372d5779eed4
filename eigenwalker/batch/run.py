"""Many files, read, prepared and linearized in parallel into one data set on disk."""

import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Sized
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
    drop_files,
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
        The files; a generator is read as the work goes on. With `read`, also numbers to make walks from, or tuples of
        paths and numbers. What comes twice is done once; two spellings of one path are two files.
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
        Takes one of `paths`, and returns a walk or an iterable of walks, which then are in memory one at a time. It is
        known by its module and name: that a later call has the same code under them is for the caller to see to. Not a
        lambda, by whose name settings could not be told apart.
    n_jobs : int, default None
        Number of processes, as in joblib: None is one, -1 is all processors. The data set is the same. Inside
        ``joblib.parallel_config("dask")`` the workers of a cluster do the work; they have to see the files, and this
        process has to see `out`.
    client : distributed.Client, default None
        The cluster whose workers do the work; None leaves it to joblib.
    files_per_part : int, default 1000
        Files whose rows go into one part; so many are done again at most after a crash. After Ctrl-C and after errors
        what has been done is kept.
    retry_refused : bool, default False
        Whether those of `paths` that a run before has refused, or in which it has refused a walk, are read again: they
        have been mended, or a disk was away. Their new rows replace the old ones.
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
        If `linearizer`, `preparer`, `read` or `client` are of another kind, or `paths` is a single path or holds other
        things.
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
    folder = Path(out).absolute()  # whatever folder a generator of paths changes to
    items = _check_paths(paths)
    call = _Call(linearizer, preparer, partial(read, **options) if options else read)
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"out must be a folder, got the file {folder}")
    folder.mkdir(parents=True, exist_ok=True)
    read_settings(folder)  # refuses a folder with other things in it, before anything is written
    with sole_writer(folder), workers_of(client), threadpool_limits(limits=1):
        settings = read_settings(folder)
        if settings is None:
            settings, items = _begin(folder, call, items)
        check_same(settings, describe_call(*call), folder)
        finished = check_parts(folder, settings.mark)
        again = finished.refused if retry_refused else {}
        job = Job(call.read, _options_of(preparer, settings.joints), settings.linearizer)
        todo = _Todo(items, finished.files, set(again))
        total = len(paths) if isinstance(paths, Sized) else None
        with tqdm(total=total, desc="linearize", delay=2, disable=not progress, file=sys.stderr) as bar:
            task = _TASK if total is None else min(_TASK, 1 + total // _TASKS)
            rows = _rows_of_all(job, todo, task, n_jobs)
            done = _write(folder, _counted(rows, bar, todo), finished, again, settings, files_per_part)
    return _report(Path(out), finished, done)


class _Call(NamedTuple):
    """What settles the rows of `linearize_files`."""

    linearizer: FourierLinearizer
    preparer: WalkPreparer | None
    read: Callable[..., Any]


class _Counts(NamedTuple):
    """What a run has added: rows with features and without, less those that they replace."""

    n_walks: int
    n_refused: int
    n_walks_replaced: int
    n_refused_replaced: int
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


class _Todo:
    """The items that have no rows yet, or are to be read again; what comes twice is passed over."""

    def __init__(self, items: Iterator[Any], files: set[str], again: set[str]) -> None:
        self._items = items
        self._files = files
        self._again = again
        self.n_passed = 0
        """Items that were passed over so far."""

    def __iter__(self) -> Iterator[Any]:
        for item in self._items:
            file = file_of(item)
            if file in self._files and file not in self._again:
                self.n_passed += 1
                continue
            self._files.add(file)
            self._again.discard(file)
            yield item


def _rows_of_all(job: Job, todo: Iterable[Any], n_a_task: int, n_jobs: int | None) -> Iterator[list[Row]]:
    """Yield the rows of each file, in order."""
    items = iter(todo)
    tasks = iter(lambda: list(islice(items, n_a_task)), [])
    workers = Parallel(n_jobs=n_jobs, return_as="generator", batch_size=1, pre_dispatch="3*n_jobs")
    return chain.from_iterable(workers(delayed(rows_of_files)(job, task) for task in tasks))


def _counted(rows: Iterator[list[Row]], bar: tqdm, todo: _Todo) -> Iterator[list[Row]]:
    n_passed = 0
    for one in rows:
        yield one
        bar.update(1 + todo.n_passed - n_passed)
        n_passed = todo.n_passed
    bar.update(todo.n_passed - n_passed)


def _write(
    folder: Path,
    files: Iterator[list[Row]],
    finished: Finished,
    again: Mapping[str, int],
    settings: Settings,
    files_per_part: int,
) -> _Counts:
    """Write the rows part by part, into the numbers that are free, and count them; rows made again replace the old."""
    schema = make_schema(list(settings.linearizer.get_feature_names_out()), settings.mark)
    numbers = (number for number in count() if number not in finished.numbers)
    n_walks = n_refused = n_walks_replaced = n_refused_replaced = 0
    reason, error = "", None
    while error is None:
        part, error = _take(files, files_per_part)
        if not part:
            break
        rows = [row for rows in part for row in rows]
        old = {row.file: again[row.file] for row in rows if row.file in again}
        replaced = drop_files(folder, settings.mark, old) if old else (0, 0)
        write_part(folder, next(numbers), rows, schema)
        refused = [row for row in rows if row.reason is not None]
        n_walks, n_refused = n_walks + len(rows) - len(refused), n_refused + len(refused)
        n_walks_replaced, n_refused_replaced = n_walks_replaced + replaced[0], n_refused_replaced + replaced[1]
        reason = reason or next((f"{row.file}: {row.reason}" for row in refused), "")
    if error is not None:
        raise error
    return _Counts(n_walks, n_refused, n_walks_replaced, n_refused_replaced, reason)


def _take(files: Iterator[list[Row]], n_files: int) -> tuple[list[list[Row]], BaseException | None]:
    """Return the rows of the next files, and what ended them too early, such as Ctrl-C: what has been done is kept."""
    part: list[list[Row]] = []
    try:
        part.extend(islice(files, n_files))
    except BaseException as error:
        return part, error
    return part, None


def _report(folder: Path, finished: Finished, done: _Counts) -> LinearizedFiles:
    if done.n_refused:
        warnings.warn(
            f"{done.n_refused} of {done.n_refused + done.n_walks} walks were refused and have no features; "
            f"refused_files({str(folder)!r}) says why, of the first: {done.reason}",
            stacklevel=3,
        )
    n_walks = finished.n_walks + done.n_walks - done.n_walks_replaced
    n_refused = finished.n_refused + done.n_refused - done.n_refused_replaced
    return LinearizedFiles(folder, len(finished.files), n_walks, n_refused)
