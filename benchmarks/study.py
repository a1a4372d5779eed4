"""The page of a study in Chromium without a graphics card: ``python -m benchmarks.study [--short]``.

Displays of 7 seconds, each answered by a click while it runs: how long they were on the screen, as the page measures
and records it in every trial. Other work on the machine costs frames.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from benchmarks._command import run
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table
from tests.experiment.running.study_pages import measure_timing

_DURATION = 7.0  # seconds
_SHARE_WANTED = 0.95  # of displays, right within a frame


def findings(*, short: bool) -> list[Check]:
    """Print how long displays were shown, and return what is asked of them."""
    print(describe_machine())
    try:
        with TemporaryDirectory() as folder:
            trials = measure_timing(3 if short else 40, duration=_DURATION, folder=Path(folder))
    except pytest.skip.Exception as reason:  # of tests; there is no browser
        print(reason)
        return [Check("displays of a study", str(reason), None, guarded=False)]
    late = trials["shown_error_s"].abs() * trials["refresh_hz"]  # in frames
    share = float((late <= 1).mean())
    dropped = trials["frames_dropped"].sum() / (trials["frames_drawn"] + trials["frames_dropped"]).sum()
    columns = ["displays", "right within a frame", "most off, ms", "frames dropped"]
    worst = 1000 * float(trials["shown_error_s"].abs().max())
    row = [str(len(trials)), f"{share:.0%}", f"{worst:.1f}", f"{dropped:.1%}"]
    print_table(f"Displays of {_DURATION:g} s, at {trials['refresh_hz'].median():.1f} Hz", columns, [row])
    return [
        Check(f"{_SHARE_WANTED:.0%} of displays right within a frame", f"{share:.0%}", share >= _SHARE_WANTED, False)
    ]


if __name__ == "__main__":
    run(findings, __doc__, short="3 displays instead of 40")
