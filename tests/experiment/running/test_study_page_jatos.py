"""In JATOS every answer reaches the server once, whatever reloads and failures there are."""

import json
import shutil
from pathlib import Path

import pytest

from eigenwalker.experiment import ANSWER_COLUMNS
from tests.experiment.running.study_pages import (
    STUDY,
    answer,
    begin,
    click,
    come_in,
    download,
    enter,
    open_study,
    rating,
    read_csv,
    served,
    wait_for_trial,
    work,
    write_page,
)
from tests.viewer_pages import launch, wait_until


@pytest.fixture(scope="module")
def browser():
    with launch() as browser:
        yield browser


@pytest.fixture(scope="module")
def contents():
    return rating(4, duration=0.1, blank=0.02, views=(0,), height=None, consent="Yes?")[0]


@pytest.fixture(scope="module")
def address(tmp_path_factory, contents):
    folder = tmp_path_factory.mktemp("jatos")
    write_page(folder, contents, jatos=True)
    shutil.copy(Path(__file__).parent / "jatos.js", folder)
    with served(folder) as address:
        yield f"{address}/index.html"


def _server(page, name):
    text = page.evaluate("(name) => localStorage.getItem(`server ${name}`)", name)
    return None if text is None else json.loads(text)


def _set(page, **values):
    for name, value in values.items():
        page.evaluate("([name, text]) => localStorage.setItem(`server ${name}`, text)", [name, json.dumps(value)])


def _lines(page, run=101):
    """Return what has reached the server, one dictionary a line."""
    text = _server(page, f"results {run}") or ""
    assert text == "" or text.endswith("\n")
    return [json.loads(line) for line in text.splitlines()]


def _known(page, run=101):
    """Return how many lines the page knows to have come in; what it does not know of it sends again after a reload."""
    return (_server(page, f"session {run}") or {}).get("eigenwalker", {}).get("sent", 0)


def _finish(page, run=101):
    work(page)
    wait_until(page, lambda: _server(page, f"ended {run}") is True)


def _taken(page, contents):
    return {key.removeprefix(f"{contents['study']}_"): run for key, run in (_server(page, "batch") or {}).items()}


def test_every_answer_is_a_line_with_all_columns(browser, address, contents):
    with open_study(browser, address) as page:
        begin(page)
        _finish(page)
        lines = _lines(page)
        assert page.locator(".screen .words").inner_text().startswith("All of your answers have been sent.")
        left = page.evaluate("Object.keys(localStorage).filter((key) => key.startsWith('eigenwalker'))")
    assert [list(line) for line in lines] == [list(ANSWER_COLUMNS)] * 4
    assert [line["trial"] for line in lines] == [1, 2, 3, 4]
    assert {line["study"] for line in lines} == {contents["study"]}
    assert {line["participant"] for line in lines} == {1}
    assert left == []  # nothing of theirs stays in the participants' browsers


def test_runs_take_the_next_free_number_and_keep_it(browser, address, contents):
    with open_study(browser) as page:
        for run in (101, 102):
            page.goto(address)
            _set(page, run=run)
            page.goto(address)
            words = page.locator(".who")
            assert words.inner_text() == f"You are participant {run - 100}: 4 to answer."
            page.reload()
            assert words.inner_text() == f"You are participant {run - 100}: 4 to answer."
        assert _taken(page, contents) == {"1": "101", "2": "102"}


def test_a_run_that_is_reloaded_as_soon_as_it_took_a_number_keeps_it(browser, address, contents):
    with open_study(browser) as page:
        page.goto(f"{address}?participant=3")
        page.wait_for_selector(".who")
        _set(page, run=102, batch={f"{contents['study']}_{number}": run for number, run in ((1, "101"), (2, "102"))})
        page.goto(address)
        assert page.locator(".who").inner_text() == "You are participant 2: 4 to answer."
        assert _taken(page, contents) == {"1": "101", "2": "102"}


def test_a_number_that_another_run_took_at_the_same_moment_is_left_to_it(browser, address, contents):
    with open_study(browser) as page:
        page.goto(f"{address}?participant=3")
        page.wait_for_selector(".who")
        _set(page, run=102, rival=f"{contents['study']}_1")
        page.goto(address)
        assert page.locator(".who").inner_text() == "You are participant 2: 4 to answer."
        assert _taken(page, contents) == {"3": "101", "1": "999", "2": "102"}


def test_without_a_free_number_the_participant_is_asked(browser, address, contents):
    with open_study(browser) as page:
        page.goto(f"{address}?participant=3")
        page.wait_for_selector(".who")
        _set(page, run=102, batch={f"{contents['study']}_{number}": "999" for number in (1, 2, 3)})
        page.goto(address)
        assert page.locator(".who").inner_text() == "No number is free any more. Please ask the experimenter for yours."
        begin(page, participant=2)
        page.reload()
        assert page.locator(".who").inner_text() == "You are participant 2: 4 to answer."


def test_a_reload_loses_no_answer_and_asks_for_none_twice(browser, address):
    with open_study(browser, address) as page:
        begin(page)
        work(page, 1)
        wait_until(page, lambda: _known(page) == 1)
        page.reload()  # after an answer has come in
        begin(page)
        wait_for_trial(page)
        assert page.evaluate(f"{STUDY}.trial.row.trial") == 2
        page.reload()  # in the middle of a trial
        begin(page)
        wait_for_trial(page)
        assert page.evaluate(f"{STUDY}.trial.row.trial") == 2
        _set(page, delay=60_000)
        answer(page)
        page.reload()  # while an answer is on its way
        _set(page, delay=10)
        page.reload()
        begin(page)
        wait_for_trial(page)
        assert page.evaluate(f"{STUDY}.trial.row.trial") == 3
        _finish(page)
        lines = _lines(page)
    assert [line["trial"] for line in lines] == [1, 2, 3, 4]
    assert [line["visit"] for line in lines] == [1, 3, 4, 4]


def test_without_storage_the_session_of_the_server_knows_what_is_done(browser, address):
    with open_study(browser, address) as page:
        begin(page)
        work(page, 2)
        wait_until(page, lambda: _server(page, "session 101")["eigenwalker"]["sent"] == 2)
        page.evaluate(
            """() => {
            const gone = Object.keys(localStorage).filter((key) => key.startsWith("eigenwalker"));
            for (const key of gone) localStorage.removeItem(key);
            }"""
        )
        page.reload()
        click(page, "Continue")  # and consent is not asked for again
        enter(page)
        _finish(page)
        assert [line["trial"] for line in _lines(page)] == [1, 2, 3, 4]


def test_answers_wait_for_a_server_that_cannot_be_reached(browser, address):
    with open_study(browser, address) as page:
        begin(page)
        work(page, 1)
        wait_until(page, lambda: len(_lines(page)) == 1)
        _set(page, down=True)
        work(page, 2)
        wait_until(page, lambda: page.locator(".alert").is_visible())
        assert "The server cannot be reached." in page.locator(".alert").inner_text()
        work(page)
        page.wait_for_selector("text=Not all of your answers could be sent.")
        assert len(read_csv(download(page)[1])) == 4
        click(page, "Try again")
        page.wait_for_selector("text=Not all of your answers could be sent.")
        assert len(_lines(page)) == 1
        _set(page, down=False)
        click(page, "Try again")
        wait_until(page, lambda: _server(page, "ended 101") is True)
        assert [line["trial"] for line in _lines(page)] == [1, 2, 3, 4]
        assert page.locator(".alert").is_hidden()


def test_two_windows_of_a_run_do_not_answer_beside_each_other(browser, address):
    with open_study(browser, address) as old:
        begin(old)
        wait_for_trial(old)
        new = old.context.new_page()
        new.goto(address)
        come_in(new)
        old.wait_for_selector("text=This study goes on in another window")
        enter(new)
        _finish(new)
        assert [line["trial"] for line in _lines(new)] == [1, 2, 3, 4]
