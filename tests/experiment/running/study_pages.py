"""Studies in a browser: small ones of all kinds, and what participants do with them."""

import functools
import http.server
import io
import threading
from contextlib import contextmanager
from dataclasses import replace

import pandas as pd

from eigenwalker.datasets import make_walkers
from eigenwalker.experiment import (
    ANSWER_COLUMNS,
    NaturalnessTask,
    PairTask,
    RatingTask,
    RecognitionTask,
    ResemblanceTask,
    Showing,
    cross_stimuli,
    make_study,
)
from eigenwalker.experiment.running.page_contents import page_contents
from eigenwalker.experiment.running.study_page import study_page
from tests.viewer_pages import launch, wait_until

__all__ = [
    "STUDY",
    "answer",
    "begin",
    "click",
    "come_in",
    "download",
    "enter",
    "five_tasks",
    "go_on",
    "listen",
    "measure_timing",
    "n_answered",
    "only",
    "open_study",
    "rating",
    "read_csv",
    "served",
    "state",
    "wait_for_trial",
    "witness",
    "work",
    "write_page",
]

STUDY = "document.querySelector('.study').study"
_STATE = f"""() => {{
    const study = {STUDY};
    if (study.isStopped || document.querySelector('.screen h1')) return 'screen';
    if (document.querySelector('.plain .answer')) return 'words';
    return document.querySelector('.trial .answer') ? 'trial' : 'blank';
}}"""


# Studies.


def rating(n_walkers=3, *, duration=0.25, blank=0.05, height=5.0, answer="any", views=(0, 90), **words):
    """Return what the page of a rating study is told, and the walkers."""
    walkers = make_walkers(n_walkers, random_state=0).data
    names = {name: words.pop(name) for name in ("title", "consent") if name in words}
    showing = Showing(figure="dots", height=height, duration=duration, blank=blank, self_paced=False, answer=answer)
    task = RatingTask(("sad", "happy"), views=views, showing=showing, **words)
    study = make_study(task, walks=walkers, n_participants=3, random_state=0, **names)
    return page_contents(study), walkers


def five_tasks(*, answer="any", duration=0.25):
    """Return what the page of a study with all five tasks is told; with attention and practice trials."""
    walkers = [_short(walk, duration) for walk in make_walkers(4, random_state=0).data]
    walks = cross_stimuli({"sad": walkers[0], "cool": walkers[1]}, {"sad": walkers[2], "cool": walkers[3]})
    showing = Showing(blank=0.05, answer=answer)
    running = Showing(figure="dots", height=5.0, duration=duration, self_paced=False, blank=0.05)
    tasks = [
        RatingTask(("sad", "happy"), views=(0,), n_attention=1, left="first", showing=running),
        PairTask(n_series=2, n_trials=1, n_practice=1, reference="random", showing=showing),
        NaturalnessTask(n_trials=2, showing=showing),
        RecognitionTask(n_trials=2, n_attention=1, showing=showing),
        ResemblanceTask(n_trials=2, showing=showing),
    ]
    contents = page_contents(make_study(tasks, walks=walks, n_participants=2, random_state=0))
    design = pd.DataFrame(contents["design"])
    few = (design["task"] != "rating") | (design["trial"] <= 2) | (design["part"] == "attention")
    return {**contents, "design": design[few].to_dict("list")}


def only(contents, *names):
    """Return a study with some of its tasks."""
    design = pd.DataFrame(contents["design"])
    design = design[design["task"].isin(names)]
    tasks = [task for task in contents["tasks"] if task["task"] in names]
    return {**contents, "tasks": tasks, "design": design.to_dict("list")}


def _short(walk, duration):
    """Return the first part of a walk, which is shown frame by frame."""
    n_frames = round(duration * walk.frame_rate)
    return replace(walk, positions=walk.positions[:n_frames], speed=1.3)


# Pages.


def write_page(folder, contents, *, name="index.html", jatos=False):
    """Save a page, and return its address."""
    path = folder / name
    path.write_text(study_page(contents, jatos=jatos), encoding="utf-8", newline="\n")
    return path.as_uri()


@contextmanager
def served(folder):
    """Yield the address under which the files of a folder are served."""

    class Handler(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

    handler = functools.partial(Handler, directory=folder)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@contextmanager
def open_study(browser, address=None, **context):
    """Yield a page in a window of its own; on leaving it fail if its console said anything."""
    settings = {"viewport": {"width": 1000, "height": 700}, "accept_downloads": True, **context}
    page = browser.new_context(**settings).new_page()
    said = listen(page)
    if address is not None:
        page.goto(address)
    yield page
    page.context.close()
    assert not said


def listen(page):
    """Return the list that all which a page says on its console goes to."""
    said = []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    return said


# Participants.


def click(page, name):
    page.get_by_role("button", name=name, exact=True).click()


def come_in(page, participant=None):
    """Go through the screens before the study, whichever there are, up to the last one."""
    if participant is not None:
        page.locator("#participant").select_option(str(participant))
    page.wait_for_selector(".screen .go:enabled")
    while not page.locator(".window").count():
        page.evaluate("document.querySelector('.screen h1').classList.add('left')")
        page.locator(".screen .go").click()
        page.wait_for_selector(".screen h1:not(.left)")


def begin(page, participant=None):
    """Go through all screens before the study."""
    come_in(page, participant)
    enter(page)


def enter(page):
    """Go from the last screen before the study into it."""
    click(page, "Start without full screen")
    page.wait_for_selector(".jspsych-content .answer")


def state(page):
    """Return what is on the screen: a "screen" of the study, "words" between trials, a "trial", or nothing."""
    return page.evaluate(_STATE)


def n_answered(page):
    return page.evaluate(f"{STUDY}.journal.answers.size")


def wait_for_trial(page):
    """Go on to the next trial, through words if there are some."""
    wait_until(page, lambda: state(page) in ("words", "trial"))
    while state(page) != "trial":
        if state(page) == "words":
            page.locator(".plain .answer").click()
        page.wait_for_timeout(10)


def answer(page, button=0):
    """Play what has to be played, answer the trial that is on the screen, and wait until it is over."""
    before = n_answered(page)
    for walk in page.locator("button.walk").all():
        walk.click()
    page.locator(".trial .answer:enabled").nth(button).click()
    wait_until(page, lambda: n_answered(page) > before or state(page) == "screen")


def work(page, n_trials=None, button=0):
    """Answer trials, all or some, until they are done."""
    while n_trials != 0:
        wait_until(page, lambda: state(page) != "blank")
        if state(page) == "screen":
            return
        if state(page) == "words":
            page.locator(".plain .answer").click()
            continue
        answer(page, button)
        n_trials = None if n_trials is None else n_trials - 1


_SEEN = f"""() => {{
    const texts = (selector) => [...document.querySelectorAll(selector)].map((element) => element.textContent);
    const {{ row, walks }} = {STUDY}.trial;
    return {{
        row, names: walks.map(({{ name }}) => name), captions: texts('figcaption'), note: texts('.note')[0],
        progress: texts('.trial .progress')[0], buttons: texts('.trial .answer'), question: texts('.question')[0],
    }};
}}"""


def witness(page, button=0):
    """Answer all trials; return what was on the screen in each, and all that was said between them."""
    trials, words = [], []
    while True:
        wait_until(page, lambda: state(page) != "blank")
        if state(page) == "screen":
            return trials, words
        if state(page) == "words":
            texts = page.locator(".plain").locator("h1, .progress, .practice").all_inner_texts()
            words.append(" | ".join(filter(None, texts)))
            page.locator(".plain .answer").click()
            continue
        trials.append(page.evaluate(_SEEN))
        answer(page, button)


def go_on(page):
    """Answer all trials that are left, one after the other."""
    work(page)
    wait_until(page, lambda: page.locator(".screen h1").inner_text() == "Thank you!")


# Answers.


def download(page, within=".screen"):
    """Return the file of answers, its name and its text, by the button that is there for it."""
    with page.expect_download() as downloading:
        page.locator(f"{within} .download").click()
    saved = downloading.value
    return saved.suggested_filename, saved.path().read_bytes().decode("utf-8")


def read_csv(text):
    """Return a table of answers as it was downloaded."""
    numbers = {"int": "int64", "float": "float64"}
    types = {name: numbers.get(column.kind, "object") for name, column in ANSWER_COLUMNS.items()}
    empty = {name: [""] for name, column in ANSWER_COLUMNS.items() if column.kind == "float"}
    return pd.read_csv(io.StringIO(text), dtype=types, keep_default_na=False, na_values=empty)


def measure_timing(n_trials=20, *, duration=7.0, folder, browser=None, **context):
    """Return what a browser without a graphics card measures in trials: one row each, with the timing columns.

    Parameters
    ----------
    n_trials : int, default 20
        One after the other, each of another walker, answered by a click as soon as it is on the screen.
    duration : float, default 7.0
        Of each, in seconds.
    folder : Path
        Where the page is written.
    browser : default None
        Of playwright; None starts one.
    **context
        Settings of the window, such as ``viewport`` and ``device_scale_factor``.
    """
    if browser is None:
        with launch() as one:
            return measure_timing(n_trials, duration=duration, folder=folder, browser=one, **context)
    contents, _ = rating(n_trials, duration=duration, views=(30,))
    with open_study(browser, f"{write_page(folder, contents)}?participant=1", **context) as page:
        begin(page)
        work(page)
        return read_csv(download(page)[1]).loc[:, "response_time_s":"pixel_ratio"]
