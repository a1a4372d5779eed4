"""No answer is lost and none is asked for twice: leaving, coming back, two windows, a full browser."""

import pytest

from tests.experiment.running.study_pages import (
    STUDY,
    answer,
    begin,
    click,
    come_in,
    download,
    enter,
    go_on,
    listen,
    n_answered,
    open_study,
    rating,
    read_csv,
    wait_for_trial,
    work,
    write_page,
)
from tests.viewer_pages import launch, wait_until

FILL = """() => {
    for (let size = 2 ** 20, i = 0; size >= 1; i += 1) {
        try { localStorage.setItem(`junk${i}`, "x".repeat(size)); } catch { size = Math.floor(size / 2); }
    }
}"""
EMPTY = """() => {
    for (const key of Object.keys(localStorage)) if (key.startsWith("junk")) localStorage.removeItem(key);
}"""
STORED = """() => Object.keys(localStorage).filter((key) => /\\/\\d+\\/\\d+$/.test(key)).length"""
FORBID = """Object.defineProperty(window, "localStorage", {
    get() { throw new DOMException("The operation is insecure.", "SecurityError"); }
});"""


@pytest.fixture(scope="module")
def browser():
    with launch() as browser:
        yield browser


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    folder = tmp_path_factory.mktemp("storage")
    contents, _ = rating(5, duration=0.15, blank=0.02, views=(0,), height=None)
    return f"{write_page(folder, contents)}?participant=1"


def _row(page):
    return page.evaluate(f"{STUDY}.trial.row.trial")


def _answers(page):
    """Return trial and answer of all that the page knows, in order."""
    return [(row["trial"], row["answer"], row["visit"]) for row in page.evaluate(f"{STUDY}.table()")]


def test_who_comes_back_goes_on_with_the_first_trial_that_is_not_answered(browser, address):
    with open_study(browser, address) as page:
        assert page.locator(".who").inner_text() == "You are participant 1: 5 to answer."
        begin(page)
        work(page, 2, button=1)
        page.close()
        page = page.context.new_page()
        said = listen(page)
        page.goto(address)
        assert page.locator(".who").inner_text() == "You are participant 1: 2 of 5 answered."
        assert len(read_csv(download(page)[1])) == 2
        begin(page)
        wait_for_trial(page)
        assert _row(page) == 3
        page.reload()  # in the middle of a trial, whose walk is on the screen
        begin(page)
        wait_for_trial(page)
        assert _row(page) == 3
        go_on(page)
        assert _answers(page) == [(1, "5", 1), (2, "5", 1), (3, "6", 3), (4, "6", 3), (5, "6", 3)]
        assert not said


def test_every_answer_has_a_key_of_its_own_and_is_written_once(browser, address):
    with open_study(browser, address) as page:
        begin(page)
        page.evaluate(
            """() => {
            const put = Storage.prototype.setItem;
            window.written = [];
            Storage.prototype.setItem = function (key, text) { window.written.push(key); put.call(this, key, text); };
            }"""
        )
        go_on(page)
        written = [key.split("/", 3)[3] for key in page.evaluate("window.written")]
    assert [key for key in written if "/" in key] == ["1/1", "1/2", "1/3", "1/4", "1/5"]


def test_the_newer_window_takes_over_and_the_older_one_stops(browser, address):
    with open_study(browser, address) as old:
        begin(old)
        work(old, 2, button=0)
        wait_for_trial(old)
        new = old.context.new_page()
        said = listen(new)
        new.goto(address)
        click(new, "Continue")
        old.wait_for_selector("text=This study goes on in another window")
        assert old.locator(".trial").count() == 0
        enter(new)
        work(new, 1, button=2)
        assert _answers(new) == [(1, "6", 1), (2, "6", 1), (3, "4", 2)]
        old.bring_to_front()
        click(old, "Go on in this window instead")
        begin(old)
        new.wait_for_selector("text=This study goes on in another window")
        go_on(old)
        assert _answers(old) == [(1, "6", 1), (2, "6", 1), (3, "4", 2), (4, "6", 3), (5, "6", 3)]
        assert not said


def test_a_window_that_was_taken_over_between_trials_shows_no_other(browser, tmp_path):
    contents, _ = rating(3, duration=0.1, blank=0.8, views=(0,), height=None)
    address = f"{write_page(tmp_path, contents)}?participant=1"
    with open_study(browser, address) as old:
        begin(old)
        wait_for_trial(old)
        new = old.context.new_page()
        new.goto(address)
        answer(old)
        click(new, "Continue")
        old.wait_for_selector("text=This study goes on in another window")
        old.wait_for_timeout(1000)
        assert old.locator(".jspsych-content").count() == 0
        assert old.evaluate(f"{STUDY}.trial.row.trial") == 1


def test_a_stored_answer_is_never_overwritten(browser, address):
    with open_study(browser, address) as page:
        begin(page)
        wait_for_trial(page)
        key = page.evaluate(f"{STUDY}.journal.shelf.key('1/1')")
        page.evaluate("(key) => localStorage.setItem(key, '[\"3\", 3]')", key)  # by a window that did not say so
        page.locator(".trial .answer:enabled").first.click()
        page.wait_for_selector("text=This study goes on in another window")
        assert page.evaluate("(key) => localStorage.getItem(key)", key) == '["3", 3]'


# No room.


def _leave(page):
    """Try to leave a page; return whether it asks to stay."""
    asked = []
    page.once("dialog", lambda dialog: (asked.append(dialog.type), dialog.accept()))
    page.goto("about:blank")
    return asked == ["beforeunload"]


def test_room_is_held_for_answers_to_come(browser, address):
    with open_study(browser, address) as page:
        begin(page)
        other = page.context.new_page()
        other.goto(address)
        other.evaluate(FILL)
        other.close()
        page.bring_to_front()
        go_on(page)
        assert page.locator(".alert").is_hidden()
        assert page.evaluate(STORED) == 5
        assert not _leave(page)
        page.goto(address)
        assert page.locator(".who").inner_text() == "You are participant 1: all 5 answered."
        assert len(read_csv(download(page)[1])) == 5


def test_without_room_answers_stay_in_memory_and_can_be_downloaded_at_once(browser, address):
    with open_study(browser, address) as page:
        page.evaluate(FILL)
        come_in(page)
        assert "has little room" in page.locator(".alert").inner_text()
        assert page.locator(".alert .download").is_hidden()
        enter(page)
        work(page, 2)
        assert "kept in this window only" in page.locator(".alert").inner_text()
        assert len(read_csv(download(page, ".alert")[1])) == 2
        assert page.evaluate(STORED) == 0
        go_on(page)
        assert "kept in this window only" in page.locator(".screen .words").inner_text()
        table = read_csv(download(page)[1])
        assert table["trial"].tolist() == [1, 2, 3, 4, 5]
        assert _leave(page)


def test_what_is_in_memory_is_stored_when_there_is_room_again(browser, address):
    with open_study(browser, address) as page:
        page.evaluate(FILL)
        begin(page)
        work(page, 2)
        assert page.evaluate(STORED) == 0
        page.evaluate(EMPTY)
        work(page, 1)
        assert page.evaluate(STORED) == 3
        wait_until(page, lambda: page.locator(".alert").is_hidden())
        assert not _leave(page)


def test_a_browser_that_keeps_nothing_is_as_one_that_is_full(browser, address):
    with open_study(browser) as page:
        page.add_init_script(FORBID)
        page.goto(address)
        come_in(page)
        assert "has little room" in page.locator(".alert").inner_text()
        enter(page)
        work(page, 1)
        assert "kept in this window only" in page.locator(".alert").inner_text()
        go_on(page)
        assert len(read_csv(download(page)[1])) == 5
        assert _leave(page)


def test_answers_of_several_participants_are_kept_apart(browser, address):
    with open_study(browser) as page:
        for participant in (1, 2):
            page.goto(address.replace("=1", f"={participant}"))
            begin(page)
            work(page, participant)
            page.wait_for_timeout(500)  # another page is another process, which hears of what is stored a moment later
        page.goto(address.partition("?")[0])
        options = page.locator("#participant option").all_inner_texts()
        assert options[1:] == ["1 – 1 of 5 answered", "2 – 2 of 5 answered", "3 – 5 to answer"]


def test_an_error_is_said_and_nothing_is_lost(browser, address):
    context = browser.new_context()
    page = context.new_page()
    page.goto(address)
    begin(page)
    work(page, 1)
    page.evaluate("() => setTimeout(() => { throw new Error('<b>the sky has fallen</b>'); })")
    page.wait_for_selector("text=Something went wrong: <b>the sky has fallen</b>.")
    assert n_answered(page) == 1
    context.close()
