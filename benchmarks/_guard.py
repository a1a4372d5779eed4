"""What is asked of a run: ratios and correctness, never seconds."""

from benchmarks._findings import Check, Finding, Row
from benchmarks._results import Results, Suite

__all__ = ["SHARE", "find_faults", "find_slow", "find_unasked", "give_verdict", "keep_fast_rows"]

SHARE = 0.8
"""Of what a ratio is asked to reach: below it is a fault, as times differ from machine to machine and run to run."""


def give_verdict(finding: Finding) -> str:
    """Return a word or two on a row or a check, "" where nothing is asked of it."""
    return _judge_check(finding) if isinstance(finding, Check) else _judge_row(finding)


def _judge_check(check: Check) -> str:
    if check.passed is None:
        return "not told"
    return "met" if check.passed else "MISSED" if check.guarded else "MISSED: seconds"


def _judge_row(row: Row) -> str:
    if row.is_close() is False:
        return "MISSED: error"
    if row.ratio is None:
        return "not run"
    if row.is_fast() is None:
        return ""
    return "met" if row.is_fast() else "near" if row.is_fast(SHARE) else "MISSED"


def find_faults(results: Results) -> list[str]:
    """Return what is not as it should be: ratios below their share, errors above bounds, checks, and failures."""
    faults = [f"{name} failed: {error}" for name, error in results.failures().items()]
    for name, row in results.rows():
        what = f"{name}: {row.task}, beside {row.peer}"
        if row.is_fast(SHARE) is False:
            faults.append(f"{what}: ratio {row.ratio:.3g} is below {SHARE:g} of {row.wanted:g}")
        if row.is_close() is False:
            faults.append(f"{what}: error {row.error:.1e} is above {row.bound:g} {row.unit}".rstrip())
    return faults + [
        f"{name}: {check.wanted}: {check.measured}"
        for name, check in results.checks()
        if check.passed is False and check.guarded
    ]


def find_slow(results: Results) -> list[str]:
    """Return the benchmarks with ratios below their share, in which nothing else is wrong."""
    slow = {name for name, row in results.rows() if row.is_fast(SHARE) is False}
    wrong = {name for name, row in results.rows() if row.is_close() is False}
    missed = {name for name, check in results.checks() if check.passed is False and check.guarded}
    return sorted(slow - wrong - missed)


def keep_fast_rows(again: Suite, before: Suite) -> Suite:
    """Return what a benchmark found again; of the ratios that are low in it, those from before that were higher."""
    earlier = {(row.task, row.peer): row for row in before.findings if isinstance(row, Row)}

    def choose(finding: Finding) -> Finding:
        if not isinstance(finding, Row) or finding.is_fast(SHARE) is not False:
            return finding
        other = earlier.get((finding.task, finding.peer), finding)
        return other if other.ratio is not None and other.ratio > finding.ratio else finding

    return again._replace(findings=[choose(finding) for finding in again.findings])


def find_unasked(results: Results) -> list[str]:
    """Return what could not be told: peers that did not run, checks that were not made or are in seconds."""
    unasked = [f"{name}: {row.task}, beside {row.peer}: {row.note}" for name, row in results.rows() if not row.ratio]
    return unasked + [
        f"{name}: {check.wanted}: {check.measured}" + (", but that is seconds" if check.passed is False else "")
        for name, check in results.checks()
        if check.passed is None or (check.passed is False and not check.guarded)
    ]
