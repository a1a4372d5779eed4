"""The page of walkers in Chromium without a graphics card: ``python -m benchmarks.view [--short]``.

Twelve walkers side by side: frames a second, and the time that the page's script takes of a frame on the processor.
Other work on the machine costs frames, but no time of the script's own.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from playwright.sync_api import CDPSession, Page

from benchmarks._command import run
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table
from eigenwalker.datasets import make_walkers
from eigenwalker.display import view
from eigenwalker.model import make_eigenwalkers
from tests.viewer_pages import launch

_N_WALKERS = 12
_FRAMES_WANTED, _SHARE_WANTED = 50, 0.2  # frames a second; of a frame at 60 a second
_FRAMES = """() => new Promise((done) => {
    const times = [];
    const count = (now) => (times.push(now) < 90 ? requestAnimationFrame(count) : done(times));
    requestAnimationFrame(count);
})"""


def findings(*, short: bool) -> list[Check]:
    """Print frames and times of some windows, and return what is asked of them."""
    print(describe_machine())
    try:
        windows = _windows(3 if short else 20)
    except pytest.skip.Exception as reason:  # of tests; there is no browser
        print(reason)
        return [Check("the page of walkers", str(reason), None, guarded=False)]
    rows = [[f"{value:.1f}" for value in window] for window in windows]
    print_table(f"{_N_WALKERS} walkers", ["frames a second", "script, ms a frame", "main thread, ms a frame"], rows)
    frames, script, _ = np.median(windows, axis=0)
    share = script * 60 / 1000
    return [
        Check(f"frames a second {_FRAMES_WANTED}, median", f"{frames:.1f}", bool(frames >= _FRAMES_WANTED), False),
        Check(f"script below {_SHARE_WANTED:.0%} of a frame of 60", f"{share:.0%}", bool(share < _SHARE_WANTED), False),
    ]


def _windows(n_windows: int) -> list[tuple[float, float, float]]:
    """Return what `_measure` does, several times."""
    walkers = make_walkers(80, random_state=0)
    model = make_eigenwalkers().fit(walkers.data, walkers.target[["gender", "weight", "happy", "nervous"]])
    shown = view(model, walkers.data, alphas=[{"happy": alpha} for alpha in np.linspace(-3, 3, _N_WALKERS)])
    with TemporaryDirectory() as folder, launch() as browser:
        shown.save(Path(folder, "walker.html"))
        page = browser.new_page(viewport={"width": 1200, "height": 800})
        page.goto(Path(folder, "walker.html").as_uri())
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable", {"timeDomain": "threadTicks"})  # other processes do not count
        page.wait_for_timeout(500)
        return [_measure(page, session) for _ in range(n_windows)]


def _measure(page: Page, session: CDPSession) -> tuple[float, float, float]:
    """Return frames a second, and milliseconds a frame of the script and of all on its thread."""

    def spent():
        metrics = session.send("Performance.getMetrics")["metrics"]
        return {metric["name"]: 1000 * metric["value"] for metric in metrics}

    before = spent()
    times = page.evaluate(_FRAMES)
    after = spent()
    used = [(after[name] - before[name]) / len(times) for name in ("ScriptDuration", "TaskDuration")]
    return 1000 * (len(times) - 1) / (times[-1] - times[0]), *used


if __name__ == "__main__":
    run(findings, __doc__, short="3 windows instead of 20")
