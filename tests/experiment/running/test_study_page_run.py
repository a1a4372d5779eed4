"""Participants go through studies by clicks and keys, from a file, and their answers come out as they gave them."""

import os
from pathlib import Path

import pandas as pd
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
    five_tasks,
    go_on,
    n_answered,
    only,
    open_study,
    rating,
    read_csv,
    state,
    wait_for_trial,
    witness,
    work,
    write_page,
)
from tests.viewer_pages import launch, wait_until

CONSENT = "You will see <b>walkers</b>.\n\nYou may stop at any time.\n  \n"


@pytest.fixture(scope="module")
def browser():
    with launch() as browser:
        yield browser


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("studies")


@pytest.fixture(scope="module")
def tasks():
    return five_tasks()


@pytest.fixture(scope="module")
def tasks_page(folder, tasks):
    return write_page(folder, tasks, name="tasks.html")


@pytest.fixture(scope="module")
def ratings():
    return rating(3, consent=CONSENT, title="How they walk")[0]


@pytest.fixture(scope="module")
def ratings_page(folder, ratings):
    return write_page(folder, ratings, name="ratings.html")


@pytest.fixture(scope="module")
def run(browser, tasks_page):
    """Go through all tasks as participant 2: return what was seen, what was said between, and the file of answers."""
    with open_study(browser, f"{tasks_page}?participant=2") as page:
        begin(page)
        trials, words = witness(page)
        saved = download(page)
    return trials, words, saved


@pytest.fixture(scope="module")
def answers(run):
    return run[2]


def _design(contents, participant):
    design = pd.DataFrame(contents["design"])
    return design[design["participant"] == participant].reset_index(drop=True)


def test_the_file_is_named_for_study_and_participant(answers, tasks):
    assert answers[0] == f"study-{tasks['study']}_participant-2_data.csv"


def test_all_rows_of_the_design_come_out_in_order(answers, tasks):
    table = read_csv(answers[1])
    assert list(table) == list(ANSWER_COLUMNS)
    design = _design(tasks, 2)
    pd.testing.assert_frame_equal(table[list(design)], design, check_dtype=False)
    assert set(table["study"]) == {tasks["study"]}
    assert set(table["task"]) == {"rating", "pair", "naturalness", "recognition", "resemblance"}


def test_answers_are_the_first_button_of_each_task(answers, tasks):
    table = read_csv(answers[1])
    words = {"pair": "0", "naturalness": "real", "recognition": "cool", "resemblance": "identical"}
    values = {"pair": 0.0, "resemblance": 4.0}
    for task, part in table.groupby("task"):
        if task == "rating":  # with the first pole at the left
            assert set(part["answer"]) == {"1"}
            assert set(part["value"]) == {1.0}
        else:
            assert set(part["answer"]) == {words[task]}
            assert part["value"].isna().all() if task not in values else set(part["value"]) == {values[task]}


def test_what_is_measured_is_there_for_every_answer(answers):
    table = read_csv(answers[1])
    assert (table["response_time_s"] > 0).all()
    assert (table["frames_drawn"] > 0).all()
    assert table["refresh_hz"].between(20, 400).all()
    assert table["pixels_per_degree"].between(37, 38).all()  # 96 pixels an inch, seen from 57 cm
    assert set(table["pixel_ratio"]) == {1.0}
    assert set(table["visit"]) == {1}
    times = pd.to_datetime(table["answered_at"], format="%Y-%m-%dT%H:%M:%S.%fZ", utc=True)
    assert times.is_monotonic_increasing
    assert abs(times.iloc[-1] - pd.Timestamp.now("UTC")) < pd.Timedelta("5 min")


def test_every_shown_walk_that_ran_to_its_end_has_its_error(answers):
    table = read_csv(answers[1]).query("task == 'rating'")
    assert (table["shown_s"] - table["shown_error_s"]).to_numpy() == pytest.approx(0.25, abs=1e-5)


def test_the_file_keeps_to_rfc_4180(answers):
    lines = answers[1].split("\r\n")
    assert lines[0] == ",".join(ANSWER_COLUMNS)
    assert lines[-1] == ""
    assert len({line.count(",") for line in lines[:-1]}) == 1


# Screens.


def test_the_first_screens(browser, ratings_page):
    with open_study(browser, ratings_page) as page:
        assert page.title() == "How they walk"
        assert page.get_by_role("button", name="Continue").is_disabled()
        assert page.locator("#participant option").all_inner_texts() == [
            "Choose your number",
            *(f"{number} – 6 to answer" for number in (1, 2, 3)),
        ]
        page.locator("#participant").select_option("3")
        click(page, "Continue")
        assert page.locator(".text p").all_inner_texts() == [
            "You will see <b>walkers</b>.",
            "You may stop at any time.",
        ]
        click(page, "I agree and take part")
        assert page.locator(".known").is_hidden()
        page.locator(".width").press("ArrowRight")
        page.locator(".distance").fill("5")
        assert page.get_by_role("button", name="Continue").is_disabled()
        page.locator(".distance").fill("80")
        click(page, "Continue")
        width = page.evaluate(f"{STUDY}.calibration.pixelsPerMillimeter") * 85.6
        assert width == pytest.approx(324, abs=0.3)  # 96 pixels an inch make 323.5, and one step more
        assert page.evaluate(f"{STUDY}.eye") == pytest.approx(800 * width / 85.6)
        click(page, "Start in full screen")
        page.wait_for_selector(".jspsych-content .answer")


def test_a_participant_out_of_range_is_asked_for(browser, ratings_page):
    with open_study(browser, f"{ratings_page}?participant=9") as page:
        assert page.locator(".who").inner_text() == "There is no participant 9 in this study."
        assert page.locator("#participant").is_visible()


def test_what_was_measured_and_agreed_is_known_on_return(browser, ratings_page):
    with open_study(browser, f"{ratings_page}?participant=1") as page:
        come_in(page)
        page.goto(f"{ratings_page}?participant=1")
        click(page, "Continue")  # no consent again
        assert page.locator(".known").is_visible()
        page.locator(".distance").fill("100")
        click(page, "Continue")
        page.goto(f"{ratings_page}?participant=2")
        click(page, "Continue")
        click(page, "I agree and take part")
        assert page.locator(".distance").input_value() == "100"
        assert "T" in page.evaluate(f"{STUDY}.journal.consent")


def test_a_phone_gets_the_card_upright(browser, ratings_page):
    with open_study(browser, f"{ratings_page}?participant=1", viewport={"width": 390, "height": 780}) as page:
        click(page, "Continue")
        click(page, "I agree and take part")
        card = page.locator(".card").bounding_box()
        assert card["height"] / card["width"] == pytest.approx(85.6 / 53.98, abs=0.01)
        assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_progress_breaks_and_the_end(browser, ratings_page):
    with open_study(browser, f"{ratings_page}?participant=3") as page:
        begin(page)
        assert page.locator(".progress").inner_text() == "Part 1 of 2"
        wait_for_trial(page)
        assert page.locator(".progress").inner_text() == "Part 1 of 2 · 1 of 3"
        work(page, 3)
        wait_until(page, lambda: state(page) == "words")
        assert page.locator("h1").inner_text() == "A short break"
        assert page.locator(".progress").inner_text() == "3 of 6 answered"
        assert len(read_csv(download(page, ".plain")[1])) == 3
        go_on(page)
        assert page.locator(".words").last.inner_text().startswith("You have answered all 6.")
        page.goto(ratings_page)
        assert page.locator("#participant option").last.inner_text() == "3 – all 6 answered"
        page.locator("#participant").select_option("3")
        assert len(read_csv(download(page)[1])) == 6
        click(page, "Continue")
        assert page.locator("h1").inner_text() == "Thank you!"


# Trials.


def test_practice_is_announced(run):
    trials, words, _ = run
    assert "Part 2 of 6 | Pairs of walks | The first one is for practice." in words
    assert words.count("That was the practice") == 1
    for trial in trials:
        assert trial["progress"].startswith("Practice · ") == (trial["row"]["part"] == "practice")


def test_every_session_begins_with_its_instruction_and_all_but_the_first_with_a_break(run):
    words = run[1]
    assert [line.split(" | ")[0] for line in words if line.startswith("Part")] == [
        f"Part {n} of 6" for n in range(1, 7)
    ]
    assert sum(line.startswith("A short break") for line in words) == 5


def test_only_attention_trials_have_a_note(run):
    for trial in run[0]:
        is_attention = trial["row"]["part"] == "attention"
        assert trial["note"].startswith("Attention: please choose ") if is_attention else trial["note"] == ""
    asked = [trial for trial in run[0] if trial["row"]["part"] == "attention"]
    assert {trial["row"]["task"] for trial in asked} == {"rating", "recognition"}
    for trial in asked:
        if trial["row"]["task"] == "recognition":
            assert trial["row"]["expected"] in trial["note"]


def test_walks_of_a_pair_stand_where_the_design_has_them_and_originals_are_marked(run):
    for trial in run[0]:
        row, names = trial["row"], trial["names"]
        if row["task"] in ("pair", "resemblance"):
            assert names[0] == row["left"]
            assert sorted(names) == sorted([row["stimulus"], row["reference"]])
        else:
            assert names == [row["stimulus"]]
        marked = [row["task"] == "pair" and name == row["reference"] for name in names]
        assert trial["captions"] == ["original" if mark else "" for mark in marked]


def test_buttons_and_questions_are_those_of_the_task(run, tasks):
    for trial in run[0]:
        task = next(task for task in tasks["tasks"] if task["task"] == trial["row"]["task"])
        assert trial["question"] == task["question"]
        assert trial["buttons"] == [button["text"] for button in task["buttons"]]


def test_an_attention_trial_names_its_button(browser, folder):
    contents, _ = rating(1, views=(0,), left="first", n_attention=3)
    design = contents["design"]
    places = iter(["1", "2", "3"] * 3)
    design["expected"] = [next(places) if part == "attention" else "" for part in design["part"]]
    address = write_page(folder, contents, name="attention.html")
    with open_study(browser, f"{address}?participant=1") as page:
        begin(page)
        notes = [trial["note"] for trial in witness(page)[0] if trial["note"]]
    named = ["“sad”", "the 2nd button from the left", "the 3rd button from the left"]
    assert notes == [f"Attention: please choose {name}" for name in named]


def test_ratings_count_towards_the_second_pole_on_whatever_side(browser, folder):
    contents, _ = rating(2, views=(0,), left="alternate")
    address = write_page(folder, contents, name="sides.html")
    ends = []
    with open_study(browser) as page:
        for participant in (1, 2):
            page.goto(f"{address}?participant={participant}")
            begin(page)
            wait_for_trial(page)
            left = page.evaluate(f"{STUDY}.trial.row.left")
            buttons = page.locator(".trial .answer")
            assert buttons.first.inner_text() == left
            assert buttons.nth(1).get_attribute("aria-label") == "2 of 6"
            answer(page, 1)
            ends.append((left, page.evaluate(f"{STUDY}.table()")[0]["answer"]))
    assert sorted(ends) == [("happy", "5"), ("sad", "2")]


def test_a_rating_shows_the_whole_walk_whenever_the_answer_comes(browser, folder):
    address = write_page(folder, rating(2, views=(0,), duration=1.5)[0], name="whole.html")
    with open_study(browser, f"{address}?participant=1") as page:
        begin(page)
        wait_for_trial(page)
        buttons = page.locator(".trial .answer")
        buttons.nth(2).click()
        assert buttons.nth(2).get_attribute("aria-pressed") == "true"
        assert buttons.nth(3).is_disabled()
        wait_until(page, lambda: n_answered(page) == 1)
        first = page.evaluate(f"{STUDY}.table()")[0]
        assert first["answer"] == "4"  # happy is left
        assert first["response_time_s"] < 1.5 <= first["shown_s"] + 0.017
        wait_for_trial(page)
        trial = f"{STUDY}.trial"
        wait_until(page, lambda: page.evaluate(f"{trial}.plays[0]?.isWhole"))
        assert page.evaluate(f"{trial}.walks[0].seen") is None  # the dots are gone, and the page waits
        page.wait_for_timeout(100)
        assert n_answered(page) == 1
        buttons.nth(0).click()
        wait_until(page, lambda: n_answered(page) == 2)
        assert page.evaluate(f"{STUDY}.table()")[1]["response_time_s"] > 1.5


def test_after_a_walk_means_after_it(browser, folder):
    address = write_page(folder, rating(2, answer="after", views=(0,), duration=1.5)[0], name="after.html")
    with open_study(browser, f"{address}?participant=1") as page:
        begin(page)
        wait_for_trial(page)
        wait_until(page, lambda: page.evaluate(f"{STUDY}.trial.plays.length"))
        assert page.locator(".trial .answer:enabled").count() == 0
        answer(page)
        assert page.evaluate(f"{STUDY}.table()")[0]["response_time_s"] >= 1.49


def test_walks_are_started_and_replayed_at_will(browser, folder):
    address = write_page(folder, only(five_tasks(answer="after", duration=1.0), "resemblance"), name="pairs.html")
    with open_study(browser, f"{address}?participant=1") as page:
        begin(page)
        wait_for_trial(page)
        left, right = page.locator("button.walk").all()
        assert page.evaluate(f"{STUDY}.trial.plays.length") == 0
        left.dblclick()  # while it plays a click does nothing
        wait_until(page, lambda: page.evaluate(f"{STUDY}.trial.walks[0].hasEnded"))
        assert page.locator(".trial .answer:enabled").count() == 0  # the other one has not been played
        left.click()
        right.click()
        page.locator(".trial .answer:enabled").first.click()
        wait_until(page, lambda: n_answered(page) == 1)
        first = page.evaluate(f"{STUDY}.table()")[0]
        assert first["replays"] == 1
        assert first["response_time_s"] > 2


def test_an_answer_cuts_what_the_participant_has_started(browser, folder):
    address = write_page(folder, only(five_tasks(duration=4.0), "naturalness"), name="cut.html")
    with open_study(browser, f"{address}?participant=1") as page:
        begin(page)
        wait_for_trial(page)
        answer(page)
        first = page.evaluate(f"{STUDY}.table()")[0]
        assert 0 < first["shown_s"] < 4
        assert first["shown_error_s"] is None
        assert first["frames_drawn"] > 0


def test_everything_goes_by_keyboard(browser, folder):
    told = {**only(five_tasks(), "rating", "resemblance"), "consent": "Yes?"}
    with open_study(browser, write_page(folder, told, name="keys.html")) as page:
        _press_until(page, lambda: page.evaluate("document.activeElement.id") == "participant")
        page.keyboard.press("2")
        for _ in range(4):  # welcome, consent, calibration, ready
            _press_until(page, lambda: page.evaluate("document.activeElement.matches('.go')"))
            page.keyboard.press("Enter")
            page.wait_for_timeout(50)
        page.wait_for_selector(".jspsych-content .answer")
        played = 0
        while True:
            wait_until(page, lambda: state(page) != "blank")
            if state(page) == "screen":
                break
            before = n_answered(page)
            if page.locator("button.walk").count():
                played += 1
                for key in ("Enter", " "):
                    _press_until(page, lambda: page.evaluate("document.activeElement.matches('button.walk')"))
                    page.keyboard.press(key)
            is_trial = state(page) == "trial"
            _press_until(page, lambda: page.evaluate("document.activeElement.matches('.answer:enabled')"))
            page.keyboard.press("Enter")
            wait_until(page, lambda: not is_trial or n_answered(page) > before or state(page) == "screen")  # noqa: B023
        assert played == 2
        _press_until(page, lambda: page.evaluate("document.activeElement.matches('.download')"))
        with page.expect_download():
            page.keyboard.press("Enter")


def _press_until(page, happened):
    for _ in range(60):
        page.keyboard.press("Tab")
        if happened():
            return
        page.wait_for_timeout(10)
    pytest.fail("the tab key does not come there")


def test_nothing_keeps_anyone_out(browser, folder):
    path = os.environ.get("EIGENWALKER_TEST_AXE")
    if path is None:
        pytest.skip("no axe-core; npm install axe-core, and set EIGENWALKER_TEST_AXE to its axe.min.js")
    axe = Path(path).read_text(encoding="utf-8")
    told = {**only(five_tasks(), "rating", "pair", "recognition"), "consent": CONSENT}
    faults = {}
    with open_study(browser, write_page(folder, told, name="axe.html"), viewport={"width": 390, "height": 780}) as page:
        page.evaluate(axe)

        def check(where):
            found = page.evaluate("axe.run().then(({ violations }) => violations)")
            faults.update({f"{where}: {fault['id']}": [node["html"] for node in fault["nodes"]] for fault in found})

        check("welcome")
        page.locator("#participant").select_option("1")
        for where in ("consent", "calibration", "ready"):
            page.locator(".screen .go").click()
            page.wait_for_timeout(50)
            check(where)
        enter(page)
        seen = set()
        while True:
            wait_until(page, lambda: state(page) != "blank")
            if state(page) == "screen":
                break
            where = page.evaluate(f"document.querySelector('.plain h1')?.textContent ?? {STUDY}.trial.row.task")
            if where not in seen:
                check(where)
            seen.add(where)
            if state(page) == "trial":
                answer(page)
            else:
                page.locator(".plain .answer").click()
        check("end")
    assert not faults
