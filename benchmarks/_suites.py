"""Benchmarks run one by one, each in a process of its own, so that none has another's memory, caches or faults."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks._findings import from_plain
from benchmarks._results import Suite

__all__ = ["LONG", "SHORT", "run_suites"]

_TIMED = ("linearize", "read", "inference", "synthesis", "hsmm", "movie", "view", "study", "scale")
_UNTIMED = ("truth", "hsmm_styles", "kinect", "styles", "feet", "observers", "frequency", "memory")  # the longest first

SHORT = (*_TIMED, *_UNTIMED)
"""Benchmarks of the short form. Those that take times have the machine to themselves; the others share its cores."""

LONG = (*SHORT, "fuzz")
"""Benchmarks of the long form."""


def run_suites(
    names: Sequence[str], *, short: bool, report: Callable[[str, Suite, str], None] | None = None
) -> dict[str, Suite]:
    """Return what each benchmark found, in the order of their names.

    Parameters
    ----------
    names : sequence of str
        Modules of this package.
    short : bool
        Whether they run in their short form.
    report : callable, default None
        Is given name, findings and printed tables of each as soon as it has ended.
    """

    def run_one(name: str) -> Suite:
        suite, printed = _run(name, short)
        if report is not None:
            report(name, suite, printed)
        return suite

    untimed = [name for name in names if name in _UNTIMED]
    found = {name: run_one(name) for name in names if name not in untimed}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found |= dict(zip(untimed, pool.map(run_one, untimed), strict=True))
    return {name: found[name] for name in names}


def _run(name: str, short: bool) -> tuple[Suite, str]:
    """Return what a benchmark found, and what it printed."""
    start = time.perf_counter()
    with TemporaryDirectory() as folder:
        out = Path(folder, "findings.json")
        command = [sys.executable, "-m", f"benchmarks.{name}", "--out", str(out), *["--short"] * short]
        ended = subprocess.run(
            command, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, encoding="utf-8"
        )
        seconds = time.perf_counter() - start
        if ended.returncode or not out.is_file():
            return Suite(seconds, [], _last_line(ended.stdout) or f"exit status {ended.returncode}"), ended.stdout
        return Suite(seconds, from_plain(json.loads(out.read_text(encoding="utf-8")))), ended.stdout


def _last_line(text: str) -> str:
    """Return the last line that is not empty, where Python names its error."""
    return next((line.strip() for line in reversed(text.splitlines()) if line.strip()), "")
