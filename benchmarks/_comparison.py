"""Two runs side by side."""

from benchmarks._findings import Check, Row
from benchmarks._guard import give_verdict
from benchmarks._results import Results
from benchmarks._tables import format_ratio, print_table

__all__ = ["print_comparison"]


def print_comparison(old: Results, new: Results) -> None:
    """Print ratios and errors of the benchmarks in two runs, side by side, and the checks that came out otherwise."""
    print(f"\nOld: {_describe(old)}\nNew: {_describe(new)}")
    alone = [name for name in old.suites | new.suites if name not in old.suites or name not in new.suites]
    if alone:
        print(f"In one run alone: {', '.join(alone)}")
    old, new = (
        run._replace(suites={name: run.suites[name] for name in run.suites if name not in alone}) for run in (old, new)
    )
    before, after = ({(name, row.task, row.peer): row for name, row in run.rows()} for run in (old, new))
    rows = [[*key, *_cells(before.get(key), after.get(key))] for key in before | after]
    header = ("", "task", "peer", "ratio, old", "new", "new / old", "error, old", "new")
    print_table("Two runs side by side; a ratio that grew is a gain", header, rows, n_left=3)
    changed = _changed_checks(old, new)
    if changed:
        print_table("Checks that came out otherwise", ("", "wanted", "old", "new"), changed, n_left=2)


def _describe(results: Results) -> str:
    machine = results.machine
    return f"commit {machine['commit']}, {results.form}, {machine['processor']}, {machine['cores']} cores"


def _cells(old: Row | None, new: Row | None) -> list[str]:
    before, after = (None if row is None else row.ratio for row in (old, new))
    errors = [None if row is None else row.error for row in (old, new)]
    return [
        *("" if one is None else format_ratio(one) for one in (before, after)),
        "" if before is None or after is None else format_ratio(after / before),
        *("" if one is None else f"{one:.1e}" for one in errors),
    ]


def _changed_checks(old: Results, new: Results) -> list[list[str]]:
    before, after = ({(name, check.wanted): check for name, check in run.checks()} for run in (old, new))
    return [
        [*key, *(_describe_check(run.get(key)) for run in (before, after))]
        for key in before | after
        if _passed(before.get(key)) != _passed(after.get(key))
    ]


def _passed(check: Check | None) -> bool | None:
    return None if check is None else check.passed


def _describe_check(check: Check | None) -> str:
    return "not there" if check is None else f"{check.measured} ({give_verdict(check)})"
