"""One job done to many things: every refusal is kept, and all of them are reported at once."""

import os
import sys
import threading
import warnings
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, chdir, nullcontext
from dataclasses import dataclass
from typing import Any, TypeVar

from joblib import Parallel, delayed
from tqdm import tqdm

from eigenwalker._validation import WalkError, check_choice

__all__ = ["Refusal", "collect", "report_refusals", "work_in"]

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
_Caught = tuple[Warning | str, type[Warning], str, int]  # a warning, its category, the file and line it came from


@dataclass(frozen=True)
class Refusal:
    """One thing that could not be used, and why."""

    name: str
    reason: str


def collect(
    function: Callable[[_Item], _Result],
    items: Sequence[_Item],
    names: Sequence[str],
    *,
    n_jobs: int | None = None,
    progress: bool = False,
    description: str = "",
) -> tuple[list[_Result | None], list[Refusal]]:
    """Call `function` on every item and return the results in order, with the items it refused.

    Parameters
    ----------
    function : callable
        Takes one item. Its WalkError, ValueError and OSError are refusals; anything else propagates.
    items, names : sequence, and sequence of str
        What to call it on, and what each item is called in a refusal.
    n_jobs : int, default None
        Number of processes, as in joblib. Neither results nor warnings depend on it.
    progress, description : bool, default False, and str, default ""
        Whether to show a bar on stderr once the job has taken two seconds; its label.

    Returns
    -------
    results, refusals : list, and list of Refusal
        One result an item, None where it was refused; both in the order of the items.

    Examples
    --------
    >>> results, refusals = collect(float, ["1.5", "two"], ["first", "second"])
    >>> results, refusals[0].name
    ([1.5, None], 'second')
    """
    folder = os.getcwd()
    jobs = (delayed(_attempt)(function, item, folder) for item in items)
    outcomes = Parallel(n_jobs=n_jobs, return_as="generator")(jobs)
    bar = tqdm(outcomes, total=len(items), desc=description, delay=2, disable=not progress, file=sys.stderr)
    results: list[_Result | None] = []
    refusals: list[Refusal] = []
    caught: list[_Caught] = []
    for name, (result, reason, warned) in zip(names, bar, strict=True):
        results.append(result)
        caught.extend(warned)
        if reason is not None:
            refusals.append(Refusal(name, reason))
    seen: dict[Any, Any] = {}  # so that a filter of "once a place" holds over all items
    for message, category, filename, line in caught:
        warnings.warn_explicit(message, category, filename, line, registry=seen)
    return results, refusals


def report_refusals(refusals: Sequence[Refusal], n_items: int, *, on_error: str, what: str = "files") -> None:
    """Raise or warn, with one line a refusal; do nothing if there are none.

    Parameters
    ----------
    refusals, n_items : sequence of Refusal, and int
        What `collect` returned, and how many items it had.
    on_error : {"raise", "skip"}
        "raise" raises a WalkError, "skip" gives a UserWarning to the caller's caller.
    what : str, default "files"
        What the items are called.
    """
    check_choice(on_error, ("raise", "skip"), name="on_error")
    if not refusals:
        return
    listed = "".join("\n  " + _one_line(refusal) for refusal in refusals)
    count = f"{len(refusals)} of {n_items} {what} were refused"
    if len(refusals) == n_items:
        raise WalkError(f"{count}, so nothing is left:{listed}")
    if on_error == "raise":
        raise WalkError(f"{count}; mend them, or leave them out with on_error='skip':{listed}")
    warnings.warn(f"{count} and left out:{listed}", UserWarning, stacklevel=3)


def work_in(folder: str) -> AbstractContextManager[None]:
    """Return a context in which relative paths start from a folder.

    A process that works on tasks may be older than the task, and may have been started in another folder. On a machine
    that does not have the folder nothing changes.
    """
    return chdir(folder) if os.getcwd() != folder and os.path.isdir(folder) else nullcontext()


def _one_line(refusal: Refusal) -> str:
    reason = " ".join(refusal.reason.split())
    return reason if reason.startswith(refusal.name) else f"{refusal.name}: {reason}"


def _attempt(
    function: Callable[[_Item], _Result], item: _Item, folder: str
) -> tuple[_Result | None, str | None, list[_Caught]]:
    """Return the result or the reason for having none, and the warnings on the way."""
    if threading.current_thread() is not threading.main_thread():
        return (*_result_or_reason(function, item), [])  # catching warnings is not safe in threads; they are shown
    with work_in(folder), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result, reason = _result_or_reason(function, item)
    return result, reason, [(entry.message, entry.category, entry.filename, entry.lineno) for entry in caught]


def _result_or_reason(function: Callable[[_Item], _Result], item: _Item) -> tuple[_Result | None, str | None]:
    try:
        return function(item), None
    except (ValueError, OSError) as error:  # a WalkError is a ValueError
        return None, str(error) or type(error).__name__
