"""Movies beside the page, in place of walks."""

import numpy as np
import pytest

from tests.experiment.running.study_pages import (
    STUDY,
    answer,
    begin,
    go_on,
    n_answered,
    open_study,
    rating,
    wait_for_trial,
    write_page,
)
from tests.viewer_pages import launch, wait_until

imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg", reason='no ffmpeg; pip install "eigenwalker[movie]"')


@pytest.fixture(scope="module")
def browser():
    with launch() as browser:
        yield browser


def _write_movie(path, *, seconds):
    writer = imageio_ffmpeg.write_frames(str(path), (64, 48), fps=25, macro_block_size=None)
    writer.send(None)
    for shade in np.linspace(100, 250, round(25 * seconds)):
        writer.send(np.full((48, 64, 3), shade, dtype=np.uint8).tobytes())
    writer.close()


def _movies(folder, *, self_paced, duration=None, missing=()):
    """Write a study of two movies and return its address."""
    contents, _ = rating(2, views=(0,), height=None, blank=0.05)
    contents["tasks"][0] |= {"self_paced": self_paced, "duration": duration, "dot_degrees": None}
    (folder / "stimuli").mkdir()
    for number, name in enumerate(contents["stimuli"]):
        file = f"stimuli/walk {number} #100%.mp4"  # no name that an address can have as it is
        contents["stimuli"][name] = {"source": "movie", "file": file}
        if number not in missing:
            _write_movie(folder / file, seconds=1.2)
    return f"{write_page(folder, contents)}?participant=1"


def test_a_movie_is_started_and_replayed_at_will(browser, tmp_path):
    with open_study(browser, _movies(tmp_path, self_paced=True)) as page:
        begin(page)
        wait_for_trial(page)
        walk = f"{STUDY}.trial.walks[0]"
        for plays in (1, 2):
            page.locator("button.walk").click()
            wait_until(page, lambda: page.evaluate(f"{walk}.count") == plays)  # noqa: B023
            assert page.locator("video").evaluate("video => video.style.visibility") == "visible"
            wait_until(page, lambda: page.evaluate(f"!{walk}.isPlaying"))
            assert page.locator("video").evaluate("video => video.style.visibility") == "hidden"
        page.locator(".trial .answer:enabled").first.click()
        wait_until(page, lambda: n_answered(page) == 1)
        first = page.evaluate(f"{STUDY}.table()")[0]
        assert first["replays"] == 1
        assert first["shown_s"] == pytest.approx(1.2, abs=0.4)  # of a machine that does other things as well
        assert 0 < first["frames_drawn"] <= 64
        go_on(page)


def test_a_movie_that_runs_by_itself_ends_when_it_is_to(browser, tmp_path):
    with open_study(browser, _movies(tmp_path, self_paced=False, duration=0.3)) as page:
        begin(page)
        wait_for_trial(page)
        answer(page)
        first = page.evaluate(f"{STUDY}.table()")[0]
        assert first["shown_s"] - first["shown_error_s"] == pytest.approx(0.3)
        assert first["frames_drawn"] < 15


def test_a_missing_movie_is_said_and_stops_nobody(browser, tmp_path):
    context = browser.new_context()  # the browser itself says on the console that there is no such file
    page = context.new_page()
    page.goto(_movies(tmp_path, self_paced=True, missing=[0, 1]))
    begin(page)
    wait_for_trial(page)
    page.get_by_role("button", name="Go on without an answer").click()
    assert n_answered(page) == 1
    first = page.evaluate(f"{STUDY}.table()")[0]
    assert (first["answer"], first["value"], first["response_time_s"]) == ("", None, None)
    assert first["frames_drawn"] == 0
    wait_for_trial(page)
    page.wait_for_selector("text=#100%.mp4 cannot be played. Please tell the experimenter.")
    context.close()
