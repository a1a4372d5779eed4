"""The page of walkers in Chromium without a graphics card: ``python -m benchmarks.view [--short]``.

Twelve walkers side by side: frames a second, and the time that the page's script takes of a frame on the processor.
Other work on the machine costs frames, but no time of the script's own.
"""

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from playwright.sync_api import CDPSession, Page

from benchmarks._measure import describe_machine, print_table, print_targets
from eigenwalker.datasets import make_walkers
from eigenwalker.display import view
from eigenwalker.model import make_eigenwalkers
from tests.viewer_pages import launch

_N_WALKERS = 12
_FRAMES = """() => new Promise((done) => {
    const times = [];
    const count = (now) => (times.push(now) < 90 ? requestAnimationFrame(count) : done(times));
    requestAnimationFrame(count);
})"""


def main() -> None:
    """Print frames and times of some windows, and the targets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="3 windows instead of 20")
    n_windows = 3 if parser.parse_args().short else 20
    print(describe_machine())
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
        windows = [_measure(page, session) for _ in range(n_windows)]
    rows = [[f"{value:.1f}" for value in window] for window in windows]
    print_table(f"{_N_WALKERS} walkers", ["frames a second", "script, ms a frame", "main thread, ms a frame"], rows)
    frames, script, _ = np.median(windows, axis=0)
    print_targets(
        [
            ("frames a second 50, median", f"{frames:.1f}", bool(frames >= 50)),
            ("script below 20 % of a frame of 60", f"{script * 60 / 10:.0f} %", bool(script < 0.2 * 1000 / 60)),
        ]
    )


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
    main()
