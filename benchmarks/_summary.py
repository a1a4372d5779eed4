"""The table of all benchmarks."""

from textwrap import shorten

from benchmarks._findings import Row
from benchmarks._guard import give_verdict
from benchmarks._results import Results
from benchmarks._tables import format_ratio, format_seconds, print_table

__all__ = ["print_summary"]

_HEADER = ("", "task", "eigenwalker", "peer", "its time", "ratio", "wanted", "error", "bound", "")


def print_summary(results: Results) -> None:
    """Print the machine, the versions, all rows beside peers, all checks, and how long each benchmark took."""
    print(f"Machine: {', '.join(f'{name} {found}' for name, found in results.machine.items())}")
    print(f"Versions: {', '.join(f'{name} {found}' for name, found in results.versions.items())}")
    _print_peers(results)
    checks = [(name, one.wanted, one.measured, give_verdict(one)) for name, one in results.checks()]
    if checks:
        print_table("Checks", ("", "wanted", "measured", ""), checks, n_left=2)
    print(f"\nSeconds: {', '.join(f'{name} {suite.seconds:.0f}' for name, suite in results.suites.items())}")


def _print_peers(results: Results) -> None:
    notes = list(dict.fromkeys(row.note for _, row in results.rows() if row.note))
    rows = [(name, *_cells(row, notes)) for name, row in results.rows()]
    rows += [
        (name, shorten(error, 80, placeholder=" ..."), *[""] * 7, "FAILED")
        for name, error in results.failures().items()
    ]
    if rows:
        title = f"Beside peers, {results.form}; ratio: how many times as long the peer takes"
        print_table(title, _HEADER, rows, n_left=2)
    for number, note in enumerate(notes, 1):
        print(f"[{number}] {note}")


def _cells(row: Row, notes: list[str]) -> tuple[str, ...]:
    mark = f" [{notes.index(row.note) + 1}]" if row.note else ""
    unit = f" {row.unit}" if row.unit else ""
    return (
        row.task,
        "" if row.ours_s is None else format_seconds(row.ours_s),
        row.peer + mark,
        "not run" if row.peer_s is None else format_seconds(row.peer_s),
        "" if row.ratio is None else format_ratio(row.ratio),
        "" if row.wanted is None else f"{row.wanted:g}",
        "" if row.error is None else f"{row.error:.1e}{unit}",
        "" if row.bound is None else f"{row.bound:g}{unit}",
        give_verdict(row),
    )
