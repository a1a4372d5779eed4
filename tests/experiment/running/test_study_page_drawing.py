"""What the page draws is where numpy has it, in the size that it should have, on any screen."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.datasets import make_walkers
from eigenwalker.display import PointLightDisplay, Screen, project
from eigenwalker.experiment import ResemblanceTask, Showing, cross_stimuli, make_study
from eigenwalker.experiment.running.page_contents import page_contents
from eigenwalker.experiment.running.shown_motion import shown_motion
from tests.experiment.running.study_pages import (
    STUDY,
    answer,
    begin,
    click,
    open_study,
    rating,
    wait_for_trial,
    write_page,
)
from tests.viewer_pages import launch, wait_until

TIMES = np.random.default_rng(0).uniform(0, 7, 12).tolist()
DRAWN = f"""(times) => {{
    const {{ row, walks }} = {STUDY}.trial;
    return [row, walks.map((walk) => times.map((time) => (walk.draw(time), [...walk.seen])))];
}}"""
# The shade at a place to the right of and above the middle of a walk's canvas, in CSS pixels.
SHADE = """const shade = ({ canvas, density, size: [width, height] }) => {
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const pixels = copy.getContext("2d", { willReadFrequently: true });
    pixels.drawImage(canvas, 0, 0);
    return ([x, y]) => pixels.getImageData(density * (width / 2 + x), density * (height / 2 - y), 1, 1).data[0];
};"""


@pytest.fixture(scope="module")
def browser():
    with launch() as browser:
        yield browser


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("drawing")


def _screen(page):
    """Return the screen as the participant measured it."""
    pitch, distance = page.evaluate(f"[1e-3 / {STUDY}.calibration.pixelsPerMillimeter, {STUDY}.calibration.distance]")
    return Screen(distance, pitch)


def test_dots_are_where_the_display_has_them(browser, folder, record_testsuite_property):
    contents, walks = rating(3, views=(0, 30, 90), duration=0.1, height=5.0)
    named = {walk.name: walk for walk in walks}
    address = write_page(folder, contents)
    worst, views = 0.0, set()
    with open_study(browser, f"{address}?participant=2") as page:
        click(page, "Continue")
        page.locator(".distance").fill("81.5")
        click(page, "Continue")
        click(page, "Start without full screen")
        for _ in range(9):
            wait_for_trial(page)
            row, (drawn,) = page.evaluate(DRAWN, TIMES)
            display = PointLightDisplay.from_walk(named[row["stimulus"]]).seen_from(row["view"]).sized(height=5)
            expected = display.evaluate(TIMES, unit="px", screen=_screen(page))
            worst = max(worst, np.abs(np.reshape(drawn, expected.shape) - expected).max())
            views.add(row["view"])
            answer(page)
    assert views == {0.0, 30.0, 90.0}
    assert worst < 1e-9  # pixels
    record_testsuite_property("largest difference to numpy, px", worst)


def test_a_walker_of_another_size_is_as_high_as_all_others(browser, folder):
    contents, (walk,) = rating(1, views=(90,), duration=5.0)
    small = replace(walk, positions=walk.positions / 1.25, size=1.25)
    other = page_contents(make_study(_task_of(contents), walks=[small], n_participants=3, random_state=0))
    with open_study(browser) as page:
        drawn = []
        for name, told in (("large.html", contents), ("small.html", other)):
            page.goto(f"{write_page(folder, told, name=name)}?participant=1")
            begin(page)
            wait_for_trial(page)
            drawn.append(page.evaluate(DRAWN, TIMES)[1])
    assert_allclose(drawn[0], drawn[1], atol=1e-6)


def _task_of(contents):
    from eigenwalker.experiment import RatingTask

    task = contents["tasks"][0]
    showing = Showing(figure="dots", height=task["height_degrees"], duration=task["duration"], self_paced=False)
    return RatingTask(("sad", "happy"), views=(90,), showing=showing)


def test_frames_are_drawn_for_the_time_that_they_are_shown_at(browser, folder):
    contents, walks = rating(1, views=(30,), duration=0.4)
    with open_study(browser, f"{write_page(folder, contents)}?participant=1") as page:
        begin(page)
        page.evaluate(
            f"""() => {{
            const run = {STUDY}.runTrial.bind({STUDY});
            window.log = [];
            {STUDY}.runTrial = (...rest) => {{
                run(...rest);
                const [walk] = {STUDY}.trial.walks;
                const draw = walk.draw.bind(walk);
                walk.draw = (time) => {{
                    draw(time);
                    window.log.push([time, document.timeline.currentTime, [...walk.seen]]);
                }};
            }};
            }}"""
        )
        wait_for_trial(page)
        wait_until(page, lambda: page.evaluate(f"{STUDY}.trial.plays[0]?.isWhole"))
        log = page.evaluate("window.log")
        screen = _screen(page)
    times, clock = (np.array([entry[i] for entry in log]) for i in (0, 1))
    assert_allclose(times, (clock - clock[0]) / 1000, atol=1e-9)  # of the frame, and from the first one on
    display = PointLightDisplay.from_walk(walks[0]).seen_from(30).sized(height=5)
    expected = display.evaluate(times, unit="px", screen=screen)
    assert_allclose(np.reshape([entry[2] for entry in log], expected.shape), expected, atol=1e-9)


@pytest.mark.parametrize("density", [1, 2.5])
def test_dots_are_drawn_on_screens_of_any_density(browser, folder, density):
    contents, _ = rating(1, views=(0,), duration=30.0, height=8.0)
    address = f"{write_page(folder, contents, name='dense.html')}?participant=1"
    with open_study(browser, address, device_scale_factor=density) as page:
        begin(page)
        wait_for_trial(page)
        width, shown, lit, dark, diameter = page.evaluate(
            f"""() => {{
            {SHADE}
            const [walk] = {STUDY}.trial.walks;
            walk.draw(1.0);
            const at = shade(walk);
            const dots = Array.from({{ length: 15 }}, (_, i) => [walk.seen[2 * i], walk.seen[2 * i + 1]]);
            const corner = [1 - walk.size[0] / 2, walk.size[1] / 2 - 1];
            return [walk.canvas.width, walk.canvas.clientWidth, dots.map(at), at(corner), 2 * walk.dot];
            }}"""
        )
        assert page.evaluate("devicePixelRatio") == density
        assert diameter == pytest.approx(_screen(page).pixels_across(0.25))
    assert width == pytest.approx(density * shown, abs=1)
    assert min(lit) == 255
    assert dark == 0


# Walks frame by frame.


@pytest.fixture(scope="module")
def pairs():
    """Return walks of two people, in place and on their way, what a page is told of them, and the walks by name."""
    walks = [replace(walk, speed=1.3) for walk in make_walkers(2, random_state=1).data]
    walks[1] = replace(walks[1], positions=1.1 * walks[1].positions)  # one is taller
    stimuli = cross_stimuli({"sad": walks[0]}, {"sad": walks[1]})
    task = ResemblanceTask(n_trials=2, showing=Showing(view=35.0, blank=0.0))
    study = make_study(task, walks=stimuli, n_participants=1, random_state=0)
    return page_contents(study), {stimulus.name: stimulus for stimulus in stimuli}


def _expected(stimulus, times):
    """Return a walk between its frames, right and up in metres from the middle of all that it covers."""
    motion = shown_motion(stimulus.walk)
    points = np.array(motion.positions)
    if stimulus.condition == "displacement":
        points[..., :2] += motion.path[:, np.newaxis]
    place = np.clip(np.multiply(times, motion.frame_rate), 0, len(points) - 1)
    before = np.minimum(place.astype(int), len(points) - 2)
    share = (place - before)[:, np.newaxis, np.newaxis]
    seen = project(points, 35.0)[..., :2]
    middle = (seen.min(axis=(0, 1)) + seen.max(axis=(0, 1))) / 2
    return project((1 - share) * points[before] + share * points[before + 1], 35.0)[..., :2] - middle


def test_walks_go_straight_from_frame_to_frame_and_stay_in_the_picture(browser, folder, pairs):
    contents, stimuli = pairs
    conditions = set()
    with open_study(browser, f"{write_page(folder, contents)}?participant=1") as page:
        begin(page)
        for _ in range(2):
            wait_for_trial(page)
            row, drawn = page.evaluate(DRAWN, TIMES)
            conditions.add(row["condition"])
            names, scales, rooms = page.evaluate(
                f"[{STUDY}.trial.walks.map((walk) => walk.name), {STUDY}.trial.walks.map((walk) => walk.pixels), "
                f"{STUDY}.trial.walks.map((walk) => walk.room)]"
            )
            assert scales[0] == scales[1]
            for name, seen, room in zip(names, drawn, rooms, strict=True):
                expected = _expected(stimuli[name], TIMES)
                # Frames come as 32-bit numbers: 3 m to 1.2e-7 of it.
                assert_allclose(np.reshape(seen, expected.shape) / scales[0], expected, atol=1e-6)
                motion = shown_motion(stimuli[name].walk)
                whole = _expected(stimuli[name], np.arange(len(motion.positions)) / motion.frame_rate)
                assert (2 * np.abs(whole).max(axis=(0, 1)) * scales[0] <= room).all()
            answer(page)
    assert conditions == {"static", "displacement"}


def test_a_stick_figure_has_sticks_and_a_head(browser, folder, pairs):
    contents, stimuli = pairs
    with open_study(browser, f"{write_page(folder, contents)}?participant=1") as page:
        begin(page)
        wait_for_trial(page)
        names, shades = page.evaluate(
            f"""() => {{
            {SHADE}
            const [walk] = {STUDY}.trial.walks;
            walk.draw(0.5);
            const {{ markers, sticks }} = walk.figure.motion;
            const place = (i) => [walk.seen[2 * i], walk.seen[2 * i + 1]];
            const middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
            const middles = sticks.map(([from, to]) => middle(place(from), place(to)));
            return [markers, [place(markers.indexOf("head")), ...middles].map(shade(walk))];
            }}"""
        )
    assert names == list(next(iter(stimuli.values())).walk.marker_set.names)
    assert len(shades) == 15
    assert min(shades) > 190  # light gray


def test_a_window_that_is_too_small_is_said_to_be(browser, folder):
    contents, _ = rating(1, views=(0,), duration=30.0, height=30.0)
    with open_study(browser, f"{write_page(folder, contents)}?participant=1") as page:
        begin(page)
        wait_for_trial(page)
        assert page.locator(".cramped").is_visible()
        page.set_viewport_size({"width": 1200, "height": 1500})
        wait_until(page, lambda: page.locator(".cramped").is_hidden())
        assert page.evaluate(f"{STUDY}.trial.walks[0].isWhole")
