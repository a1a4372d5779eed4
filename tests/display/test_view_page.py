"""The saved page: by itself, for everyone, whatever names are in it, and fast."""

import functools
import http.server
import os
import re
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from eigenwalker import FourierLinearizer, make_eigenwalkers
from eigenwalker.display import view
from eigenwalker.model import TraitRegressor
from tests.viewer_pages import VIEWER, four_axes, opened, put, settle


@pytest.fixture(scope="module")
def axe():
    """Return the accessibility checker, which is no part of the package."""
    path = os.environ.get("EIGENWALKER_TEST_AXE")
    if path is None:
        pytest.skip("no axe-core; npm install axe-core, and set EIGENWALKER_TEST_AXE to its axe.min.js")
    return Path(path).read_text(encoding="utf-8")


def _faults(page, axe):
    """Return what is wrong for people with disabilities, what is serious or worse first."""
    page.evaluate(axe)
    found = page.evaluate("axe.run().then(({ violations }) => violations)")
    return {f"{fault['impact']}: {fault['id']}": [node["html"] for node in fault["nodes"]] for fault in found}


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1200, 390])
def test_nothing_serious_keeps_anyone_out(browser, address, axe, scheme, width):
    with opened(browser, address, color_scheme=scheme, viewport={"width": width, "height": 800}) as page:
        page.evaluate(f"() => {{ {VIEWER}.setAlpha(0, 6); {VIEWER}.setAlpha(1, -6); {VIEWER}.say('Yes.'); }}")
        page.locator(".add").click()
        assert not _faults(page, axe)
        page.locator("[data-scene=black]").check()
        assert not _faults(page, axe)


def test_everything_is_reached_by_the_tab_key(browser, address):
    with opened(browser, address) as page:
        reached = []
        for _ in range(60):
            page.keyboard.press("Tab")
            reached.append(page.evaluate("document.activeElement.ariaLabel ?? document.activeElement.textContent"))
        expected = {"Front", "Side", "Play", "Add", "gender", "hold gender", "harmonic 2", "PNG", "CSV", "Copy link"}
        assert expected <= {name.strip() for name in reached}


def test_the_page_makes_one_request_and_lets_nothing_else_in(browser, tmp_path):
    model, walks = four_axes()
    put(tmp_path, view(model, walks))
    asked = []

    class Handler(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            asked.append(self.path)

    handler = functools.partial(Handler, directory=tmp_path)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        page = browser.new_page()
        page.goto(f"http://127.0.0.1:{server.server_port}/walker.html")
        page.locator(".add").click()
        page.wait_for_timeout(300)
        policy = page.locator("meta[http-equiv]").get_attribute("content")
        page.close()
        server.shutdown()
    assert asked == ["/walker.html"]
    assert re.fullmatch(
        r"default-src 'none'; script-src 'sha256-[\w+/=]+'; style-src 'sha256-[\w+/=]+'; img-src data:", policy
    )


ATTACK = "</script></title><img src=x onerror=\"document.body.id = 'caught'\">'\"`${alert(1)}"


def test_names_are_only_text(browser, tmp_path):
    _, walks = four_axes()
    labels = pd.DataFrame({ATTACK: np.random.default_rng(0).normal(size=80)})
    trait = TraitRegressor(poles={ATTACK: (ATTACK + "-", ATTACK + "+")})
    model = make_eigenwalkers(n_components=5, trait=trait).fit(walks, labels)
    shown = view(model, [replace(walks[0], name=ATTACK)], alphas={ATTACK: 1}, title=ATTACK, note=ATTACK)
    with opened(browser, put(tmp_path, shown)) as page:
        assert page.title() == ATTACK
        assert page.locator(".title").text_content() == ATTACK
        assert page.locator(".trait .name").text_content() == ATTACK
        assert page.locator(".pole").all_text_contents() == [ATTACK + "-", ATTACK + "+"]
        page.get_by_label("Load a walker").select_option(ATTACK)
        page.locator(".trait .range").focus()
        page.keyboard.press("ArrowRight")
        page.locator(".trait .number").fill("99")
        page.keyboard.press("Enter")
        settle(page)
        assert page.locator("img").count() == 0
        assert page.evaluate("document.body.id") == ""
        assert page.evaluate("document.scripts.length") == 2


def test_long_names_do_not_break_the_page(browser, tmp_path):
    _, walks = four_axes()
    long = "extraordinarily_long_name_" * 10
    labels = pd.DataFrame({long: np.random.default_rng(0).normal(size=80)})
    model = make_eigenwalkers(n_components=5).fit(walks, labels)
    with opened(browser, put(tmp_path, view(model, [replace(walks[0], name=long)], alphas=[{}, {long: 1}]))) as page:
        page.get_by_label("Load a walker").select_option(long)
        panel = page.locator(".panel")
        assert panel.evaluate("panel => panel.scrollWidth <= panel.clientWidth")


def test_the_frame_of_a_notebook_works(browser, tmp_path):
    model, walks = four_axes()
    shown = view(model, walks[:3], alphas={"happy": 2})
    (tmp_path / "notebook.html").write_text(f"<!DOCTYPE html><title>n</title>{shown._repr_html_()}", encoding="utf-8")
    said = []
    page = browser.new_page()
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto((tmp_path / "notebook.html").as_uri())
    frame = page.frame_locator("iframe")
    assert frame.locator(".trait .number").nth(2).input_value() == "2.00"
    frame.locator(".trait .range").nth(2).press("ArrowRight")
    assert frame.locator(".trait .number").nth(2).input_value() == "2.05"
    assert frame.locator(".copy").is_hidden()
    page.close()
    assert not said


def test_walks_without_a_model_have_no_sliders(browser, tmp_path):
    _, walks = four_axes()
    with opened(browser, put(tmp_path, view(walks[:3]))) as page:
        assert page.locator(".traits").is_hidden()
        titles = page.evaluate(f"() => {VIEWER}.walkers.map(({{ title }}) => title)")
        assert titles == [f"{letter}  {walk.name}" for letter, walk in zip("ABC", walks, strict=False)]
        page.get_by_label("Load a walker").select_option("Average of these walks")
        expected = FourierLinearizer(4).fit_transform(walks[:3]).mean(axis=0)
        np.testing.assert_allclose(page.evaluate(f"() => [...{VIEWER}.walker.vector]"), expected, atol=1e-12)


def _tempo_model():
    """Return a model with an axis along which the frequency soon comes to zero, and a twin of it."""
    walks = four_axes()[1]
    stretched = [replace(walk, frame_rate=walk.frame_rate * rate) for walk, rate in zip(walks, _rates(), strict=True)]
    labels = pd.DataFrame({"tempo": _rates(), "twin": 2 * _rates()})
    return make_eigenwalkers(n_components=5, scaling=None).fit(stretched, labels)


def _rates():
    return np.random.default_rng(0).uniform(0.4, 1.9, 80)


def test_no_slider_goes_to_where_there_is_no_walk(browser, tmp_path):
    with opened(browser, put(tmp_path, view(_tempo_model()))) as page:
        slider = page.locator(".trait .range").first
        slider.press("Home")
        frequency, alpha = page.evaluate(f"() => [{VIEWER}.walker.frequency, {VIEWER}.walker.alphas[0]]")
        assert frequency == pytest.approx(0.1)
        assert -6 < alpha < -1
        assert page.locator(".message").inner_text() == "No walk lies further out: its frequency would come to zero."
        assert float(slider.input_value()) == pytest.approx(alpha, abs=0.05)


def test_traits_that_depend_on_each_other_are_not_moved_apart(browser, tmp_path):
    with opened(browser, put(tmp_path, view(_tempo_model()))) as page:
        page.locator(".trait .range").first.press("ArrowRight")
        page.locator(".trait .range").nth(1).press("ArrowLeft")
        assert page.evaluate(f"() => {VIEWER}.alphas") == {"tempo": 0.05}
        assert "cannot be set independently" in page.locator(".message").inner_text()
        assert page.locator(".trait .number").nth(1).input_value() == "0.05"
