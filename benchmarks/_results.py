"""The results of a run of all benchmarks, and the JSON file of them."""

import json
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks._findings import Check, Finding, Row, from_plain, to_plain

__all__ = ["Results", "Suite", "read_results", "write_results"]


class Suite(NamedTuple):
    """What one benchmark took and found, or the error that ended it."""

    seconds: float
    findings: list[Finding]
    failure: str = ""


class Results(NamedTuple):
    """Where and on what a run was made, whether in its short form, and what each benchmark found."""

    machine: dict[str, str]
    versions: dict[str, str]
    short: bool
    suites: dict[str, Suite]

    @property
    def form(self) -> str:
        """Short form or long form."""
        return "short form" if self.short else "long form"

    def rows(self) -> list[tuple[str, Row]]:
        """Return all rows beside a peer with the names of their benchmarks."""
        return [(name, one) for name, suite in self.suites.items() for one in suite.findings if isinstance(one, Row)]

    def checks(self) -> list[tuple[str, Check]]:
        """Return all checks with the names of their benchmarks."""
        return [(name, one) for name, suite in self.suites.items() for one in suite.findings if isinstance(one, Check)]

    def failures(self) -> dict[str, str]:
        """Return the errors of the benchmarks that did not come to an end."""
        return {name: suite.failure for name, suite in self.suites.items() if suite.failure}


def write_results(results: Results, path: str | Path) -> None:
    """Write results as JSON."""
    suites: dict[str, Any] = {
        name: suite._asdict() | {"findings": to_plain(suite.findings)} for name, suite in results.suites.items()
    }
    text = json.dumps(results._asdict() | {"suites": suites}, indent=1, ensure_ascii=False)
    Path(path).write_text(text + "\n", encoding="utf-8")


def read_results(path: str | Path) -> Results:
    """Return results that `write_results` has written.

    Raises
    ------
    ValueError
        If the file is no such JSON.
    """
    try:
        plain = json.loads(Path(path).read_text(encoding="utf-8"))
        suites = {
            name: Suite(suite["seconds"], from_plain(suite["findings"]), suite["failure"])
            for name, suite in plain.pop("suites").items()
        }
        return Results(**plain, suites=suites)
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        message = f"{path}: expected what `python -m benchmarks --out {path}` writes, got other contents ({error!r})"
        raise ValueError(message) from error
