"""What becomes of one file: a row for each of its walks, or the reason why there is none."""

import math
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from numbers import Number
from os import PathLike, fspath, getcwd, getpid
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone

from eigenwalker._collect import work_in
from eigenwalker._validation import WalkError
from eigenwalker.batch.workers import keep_to_task
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.motion.fourier import explained_power
from eigenwalker.motion.preparation import prepare
from eigenwalker.motion.quality import walk_quality
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["QUALITY", "Job", "Row", "file_of", "find_walk", "rows_of_files"]

QUALITY = ("duration", "n_cycles", "speed", "explained_power", "path_residual")
"""What `walk_quality` says of a walk and its features do not: columns of the table."""

_KINDS = (Walk, JointWalk)
_MARKERS = {"pelvis", "left_ankle", "right_ankle"}  # without which walk_quality cannot say anything
_ONE_AT_A_TIME = threading.RLock()


class Row(NamedTuple):
    """One walk, or one refusal.

    Parameters
    ----------
    file : str
        The file it is from, as it was given.
    name : str, default None
        The walk's name; None if it was not read that far.
    reason : str, default None
        Why it was refused; None if it was not.
    warnings : str, default None
        What was warned of on the way, one line a warning.
    quality : tuple of float, default empty
        In the order of `QUALITY`.
    features : ndarray of shape (n_features,), default None
        The vector of the linearizer; None for a refusal.
    """

    file: str
    name: str | None = None
    reason: str | None = None
    warnings: str | None = None
    quality: tuple[float, ...] = ()
    features: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Job:
    """What is done to every file.

    Parameters
    ----------
    read : callable
        Takes an item, returns a walk or an iterable of walks.
    preparation : mapping
        Arguments of `prepare`; None leaves walks as they are read.
    linearizer : FourierLinearizer
        Fitted, or not yet while a first walk is looked for.
    owner : int
        The process that gives the tasks.
    folder : str
        The folder in which that process works, from which relative paths are read.
    """

    read: Callable[..., Any]
    preparation: Mapping[str, Any] | None
    linearizer: FourierLinearizer
    owner: int = field(default_factory=getpid)
    folder: str = field(default_factory=getcwd)


def file_of(item: object) -> str:
    """Return what an item is called in the table: a path as it is, numbers and tuples as text.

    Raises
    ------
    TypeError
        If it is something else, of which the text may be that of other items as well.
    """
    if isinstance(item, (str, PathLike)):
        return fspath(item)
    if not _has_text(item):
        raise TypeError(
            f"paths must hold paths, numbers or tuples of these, got {type(item).__name__}; give a name or a number "
            "to each walk, and let read make it from that"
        )
    return str(item)


def _has_text(item: object) -> bool:
    return all(map(_has_text, item)) if type(item) is tuple else isinstance(item, (str, PathLike, Number))


def rows_of_files(job: Job, items: Iterable[object]) -> list[list[Row]]:
    """Return the rows of each of some files, read, prepared and linearized walk by walk.

    A WalkError, ValueError or OSError is a refusal, and becomes a row with its reason. Anything else propagates, with
    the name of the file.
    """
    with keep_to_task(job.owner):
        return [_rows_of_file(job, item) for item in items]


def find_walk(job: Job, item: object) -> tuple[Walk | JointWalk | None, str | None]:
    """Return the first usable walk in a file, prepared, or None and the reason why there is none.

    Parameters of the linearizer that are out of range are no reason, but an error.
    """
    walks, reason = _recorded(job, item), None
    with _as_owner(job):
        while True:
            try:
                walk = next(walks, None)
                walk = None if walk is None else _prepared(job, walk)
            except (ValueError, OSError) as error:
                reason = reason or _reason(error)
                continue
            except Exception as error:
                _name_file(error, file_of(item))
                raise
            try:
                if walk is not None:
                    clone(job.linearizer).fit([walk]).transform([walk])
                return walk, reason
            except WalkError as error:
                reason = reason or _reason(error)


def _rows_of_file(job: Job, item: object) -> list[Row]:
    file, walks = file_of(item), _recorded(job, item)
    rows: list[Row] = []
    while True:
        with _as_owner(job) as caught:
            row = _next_row(job, file, walks)
        if row is None:
            return rows or [Row(file, reason="expected at least one walk in the file, got none")]
        said = dict.fromkeys(" ".join(str(entry.message).split()) for entry in caught)
        rows.append(row._replace(warnings="\n".join(said) or None))


def _next_row(job: Job, file: str, walks: Iterator[Walk | JointWalk]) -> Row | None:
    """Return the row of the next walk in a file, or None after the last one."""
    name = None
    try:
        walk = next(walks, None)
        if walk is None:
            return None
        name = walk.name
        return _linearized(job, file, _prepared(job, walk))
    except (ValueError, OSError) as error:  # a WalkError is a ValueError
        return Row(file, name, _reason(error))
    except Exception as error:
        _name_file(error, file)
        raise


def _name_file(error: Exception, file: str) -> None:
    error.add_note(f"while {file} was read, prepared and linearized")


def _reason(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _recorded(job: Job, item: object) -> Iterator[Walk | JointWalk]:
    """Yield the walks in a file. A generator, so that nothing comes after an error."""
    found = job.read(item)
    if not isinstance(found, (*_KINDS, Iterable)):
        raise TypeError(f"read must return a walk or an iterable of walks, got {type(found).__name__}")
    for walk in [found] if isinstance(found, _KINDS) else found:
        if not isinstance(walk, _KINDS):
            raise TypeError(f"read must return a walk or an iterable of walks, got {type(walk).__name__} in it")
        yield walk


def _prepared(job: Job, walk: Walk | JointWalk) -> Walk | JointWalk:
    if job.preparation is None:
        return walk
    if job.preparation.get("representation") == "joints" and not isinstance(walk, JointWalk):
        raise WalkError(f"walk {walk.name!r}: expected joints, as BVH and AMC files hold, got markers")
    return prepare(walk, **job.preparation)


def _linearized(job: Job, file: str, walk: Walk | JointWalk) -> Row:
    features = job.linearizer.transform([walk])[0]
    frequency = float(features[-1 - len(job.linearizer.extras)])
    return Row(file, walk.name, quality=_quality(walk, frequency, job.linearizer.n_harmonics), features=features)


def _quality(walk: Walk | JointWalk, frequency: float, n_harmonics: int) -> tuple[float, ...]:
    """Return what `walk_quality` says, for the frequency among the features; for joints no `path_residual`."""
    if isinstance(walk, Walk) and set(walk.marker_set.names) >= _MARKERS:
        found = walk_quality(replace(walk, frequency=frequency), n_harmonics=n_harmonics)
        return tuple(getattr(found, name) for name in QUALITY)
    power = explained_power(walk.channels, walk.frame_rate, frequency, n_harmonics)
    return walk.duration, frequency * walk.duration, walk.speed, power, math.nan


@contextmanager
def _as_owner(job: Job) -> Iterator[Sequence[warnings.WarningMessage]]:
    """Work in the folder of the process that gave the task, and catch warnings."""
    # Two threads that catch warnings at once would spoil each other's lists. Waiting costs little: what is between two
    # warnings is Python and holds its lock anyway.
    with _ONE_AT_A_TIME, work_in(job.folder), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield caught
