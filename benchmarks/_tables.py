"""Tables and targets in plain text. Nothing large is imported here."""

from collections.abc import Iterable, Iterator, Sequence

from benchmarks._findings import Check, Finding, Row

__all__ = ["format_ratio", "format_seconds", "print_table", "print_targets"]

_UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"))


def print_table(title: str, header: Sequence[str], rows: Iterable[Sequence[str]], *, n_left: int = 1) -> None:
    """Print a table with columns as wide as their longest cell, the first ones to the left, the others to the right."""
    lines = [list(header), *[list(row) for row in rows]]
    widths = [max(len(line[column]) for line in lines) for column in range(len(header))]
    print(f"\n{title}")
    for line in lines:
        cells = [
            cell.ljust(width) if column < n_left else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ]
        print("  ".join(cells).rstrip())


def print_targets(findings: Iterable[Finding]) -> None:
    """Print which targets are met: what is wanted, what was measured, and whether that is enough."""
    print("\nTargets")
    for finding in findings:
        for wanted, measured, met in [finding[:3]] if isinstance(finding, Check) else _targets_of(finding):
            print(f"  {'met   ' if met else 'not run' if met is None else 'MISSED'} {wanted}: {measured}")


def _targets_of(row: Row) -> Iterator[tuple[str, str, bool | None]]:
    if row.wanted is not None:
        measured = row.note if row.ratio is None else format_ratio(row.ratio)
        yield f"{row.task}: at least {row.wanted:g} times as fast as {row.peer}", measured, row.is_fast()
    if row.bound is not None:
        measured = row.note if row.error is None else f"{row.error:.1e}"
        yield (
            f"{row.task}, beside {row.peer}: error at most {row.bound:g} {row.unit}".rstrip(),
            measured,
            row.is_close(),
        )


def format_ratio(ratio: float) -> str:
    """Return a ratio with three digits, and no exponent."""
    return f"{ratio:,.0f}" if abs(ratio) >= 999.5 else f"{ratio:.3g}"


def format_seconds(seconds: float) -> str:
    """Return a time with three digits and its unit."""
    size, unit = next((pair for pair in _UNITS if seconds >= pair[0]), _UNITS[-1])
    return f"{format_ratio(seconds / size)} {unit}"
