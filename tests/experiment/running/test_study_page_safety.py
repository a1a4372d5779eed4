"""Whatever stands in names and texts of a study is text, on the page and in the file of answers."""

import csv
import io
import json
import shutil
from pathlib import Path

import pytest

from tests.experiment.running.study_pages import (
    answer,
    begin,
    download,
    enter,
    five_tasks,
    go_on,
    listen,
    n_answered,
    open_study,
    served,
    state,
    wait_for_trial,
    write_page,
)
from tests.viewer_pages import launch, wait_until

ATTACK = (
    "<img src=x onerror=\"document.body.id='caught'\"></script></template><script>document.body.id='caught'</script>"
    "'`${alert(1)}\"&lt;,;\\ \u202eright to left\u202c {{x}} %s"
)
NAMES = {
    "sad_original_static": "=1+1",
    "sad_synthetic_static": "@SUM(A1)",
    "cool_original_static": "-2+3\r\nsecond line",
    "cool_synthetic_static": '+"quoted", and not',
    "sad_original_displacement": ATTACK,
    "sad_synthetic_displacement": "__proto__",
    "cool_original_displacement": "\t tab ",
    "cool_synthetic_displacement": "née ✓ 走る",
}


@pytest.fixture(scope="module")
def browser():
    with launch() as browser:
        yield browser


@pytest.fixture(scope="module")
def contents():
    """Return what a page is told, with hostile words wherever words can stand."""
    told = json.loads(json.dumps(five_tasks()))
    told |= {"title": ATTACK, "consent": f"{ATTACK}\n\n{ATTACK}"}
    told["stimuli"] = {NAMES[name]: stimulus for name, stimulus in told["stimuli"].items()}
    for column in ("stimulus", "reference", "left"):
        told["design"][column] = [NAMES.get(name, name) for name in told["design"][column]]
    told["design"]["style"] = [ATTACK] * len(told["design"]["style"])
    for task in told["tasks"]:
        task |= {"title": ATTACK, "instruction": ATTACK, "question": ATTACK, "break_text": ATTACK}
        for button in task["buttons"]:
            button |= {"text": f"{button['text']} {ATTACK}", "answer": f"={button['answer']},{ATTACK}"}
    return told


def _go_through(page, n_screens):
    """Go through screens until there are none left; fail if anything comes to life."""
    for _ in range(n_screens):
        wait_until(page, lambda: state(page) != "blank")
        assert page.evaluate("[document.body.id, document.querySelectorAll('img').length]") == ["", 0]
        if state(page) == "screen":
            return
        if state(page) == "words":
            page.locator(".plain .answer").click()
        else:
            wait_for_trial(page)
            answer(page)


@pytest.mark.parametrize("jatos", [False, True], ids=["file", "jatos"])
def test_words_are_only_text(browser, contents, tmp_path, jatos):
    shutil.copy(Path(__file__).parent / "jatos.js", tmp_path)
    address = write_page(tmp_path, contents, jatos=jatos)
    with served(tmp_path) as server, open_study(browser) as page:
        asked = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto(f"{server}/index.html?participant=1" if jatos else f"{address}?participant=1")
        assert page.title() == ATTACK
        assert page.locator("h1").inner_text() == ATTACK
        page.get_by_role("button", name="Continue").click()
        assert page.locator(".text p").all_text_contents() == [ATTACK, ATTACK]
        page.get_by_role("button", name="I agree and take part").click()
        page.get_by_role("button", name="Continue").click()
        enter(page)
        assert page.locator(".plain .text").text_content() == ATTACK
        wait_for_trial(page)
        assert page.locator(".question").text_content() == ATTACK
        assert page.locator(".trial .answer").last.text_content().endswith(ATTACK)
        _go_through(page, n_screens=3 if jatos else 99)
        page.wait_for_timeout(50)
        assert len(asked) == (2 if jatos else 1)


def test_the_file_of_answers_holds_what_they_are_called(browser, contents, tmp_path):
    with open_study(browser, f"{write_page(tmp_path, contents)}?participant=1") as page:
        begin(page)
        go_on(page)
        assert n_answered(page) > 0
        name, text = download(page)
    assert set(name) <= set("abcdefghijklmnopqrstuvwxyz0123456789-_.")
    header, *rows = csv.reader(io.StringIO(text, newline=""))
    design = contents["design"]
    own = [i for i, participant in enumerate(design["participant"]) if participant == 1]
    for column in ("stimulus", "reference", "left", "style"):
        assert [row[header.index(column)] for row in rows] == [design[column][i] for i in own]
    answers = [row[header.index("answer")] for row in rows]
    assert all(one.startswith("=") and one.endswith(ATTACK) for one in answers)
    for formula in ("=1+1", "@SUM(A1)"):
        assert f'"{formula}"' in text
        assert f",{formula}" not in text


def test_a_page_in_a_frame_of_another_page_runs(browser, contents, tmp_path):
    """A frame without the rights of a page of its own has no storage; nothing worse happens."""
    write_page(tmp_path, {**contents, "consent": "", "calibrate": False})
    (tmp_path / "frame.html").write_text(
        '<!DOCTYPE html><iframe sandbox="allow-scripts" src="index.html?participant=1" width="900" height="600">',
        encoding="utf-8",
    )
    context = browser.new_context()
    page = context.new_page()
    said = listen(page)
    page.goto((tmp_path / "frame.html").as_uri())
    frame = page.frame_locator("iframe")
    frame.get_by_role("button", name="Continue").click()
    frame.get_by_role("button", name="Start without full screen").click()
    frame.locator(".plain .answer").click()
    frame.locator(".trial .answer:enabled").first.click()
    frame.get_by_text("kept in this window only").wait_for()
    assert not said
    context.close()
