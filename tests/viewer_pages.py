"""Pages of walkers in a browser: Chromium without a screen, where nothing is drawn by a graphics card."""

import os
import shutil
from contextlib import contextmanager
from functools import cache

import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.model import TraitRegressor, make_eigenwalkers

__all__ = ["POLES", "VIEWER", "four_axes", "launch", "opened", "put", "settle", "start_again", "wait_until"]

POLES = {
    "gender": ("female", "male"),
    "weight": ("light", "heavy"),
    "happy": ("sad", "happy"),
    "nervous": ("relaxed", "nervous"),
}
VIEWER = "document.querySelector('.eigenwalker').viewer"
_ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"]


@cache
def four_axes():
    """Return a model of 80 walkers with four axes, and the walkers."""
    walkers = make_walkers(80, random_state=0)
    model = make_eigenwalkers(trait=TraitRegressor(poles=POLES))
    return model.fit(walkers.data, walkers.target[list(POLES)]), walkers.data


@contextmanager
def launch():
    """Yield a browser; skip where there is none."""
    from playwright.sync_api import sync_playwright

    path = os.environ.get("EIGENWALKER_TEST_CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
    if path is None:
        pytest.skip("no Chromium; apt-get install chromium, or set EIGENWALKER_TEST_CHROMIUM to where it is")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=_ARGUMENTS)
        yield browser
        browser.close()


@contextmanager
def opened(browser, address, **context):
    """Yield a page; on leaving it fail if there was anything on its console, a request, or an error."""
    settings = {"viewport": {"width": 1200, "height": 800}, "reduced_motion": "reduce", **context}
    page = browser.new_context(**settings).new_page()
    said, requests = [], []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(address)
    settle(page)
    yield page
    page.context.close()
    assert not said
    assert len(requests) == 1


def start_again(page):
    """Return a page in the state in which it was opened."""
    page.evaluate(
        f"""() => {{
        const viewer = {VIEWER};
        window.first ??= structuredClone(viewer.state);
        viewer.restore(structuredClone(window.first));
        viewer.say("");
        document.activeElement.blur();
        }}"""
    )
    settle(page)
    return page


def put(folder, shown, name="walker.html"):
    """Save a view, and return the address of its page."""
    shown.save(folder / name)
    return (folder / name).as_uri()


def settle(page):
    """Wait until everything is drawn."""
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def wait_until(page, happened, *, seconds=10):
    """Wait until a function says that something has happened, on the page or here because of it."""
    for _ in range(50 * seconds):
        if happened():
            return
        page.wait_for_timeout(20)
    pytest.fail(f"nothing happened for {seconds} s")
