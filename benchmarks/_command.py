"""The command line of a single benchmark: ``--short``, and its findings as JSON for the command of all of them."""

import argparse
import json
from collections.abc import Callable, Sequence
from pathlib import Path

from benchmarks._findings import Finding, to_plain
from benchmarks._tables import print_targets

__all__ = ["finish", "run", "suite_parser"]


def suite_parser(description: str | None, *, short: str) -> argparse.ArgumentParser:
    """Return a parser with the options that every benchmark has; `short` says what the short form leaves out."""
    parser = argparse.ArgumentParser(description=(description or "").splitlines()[0])
    parser.add_argument("--short", action="store_true", help=short)
    parser.add_argument("--out", metavar="FILE", help="write the findings as JSON")
    return parser


def finish(findings: Sequence[Finding], out: str | None) -> None:
    """Print the targets, and write the findings where they are asked for."""
    print_targets(findings)
    if out is not None:
        Path(out).write_text(json.dumps(to_plain(findings)), encoding="utf-8")


def run(findings: Callable[..., Sequence[Finding]], description: str | None, *, short: str) -> None:
    """Do what a benchmark's command does: ``findings(short=...)``, which prints its tables, and then the targets."""
    arguments = suite_parser(description, short=short).parse_args()
    finish(findings(short=arguments.short), arguments.out)
