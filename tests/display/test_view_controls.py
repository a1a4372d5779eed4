"""Each control of the page does what it says, by real clicks and keys."""

import base64
import io
import json
import urllib.parse

import numpy as np
import pytest
from matplotlib.image import imread
from numpy.testing import assert_allclose

from eigenwalker.model import axis_features
from tests.viewer_pages import POLES, VIEWER, four_axes, opened, settle, wait_until

TRAITS = list(POLES)


def _get(page, what):
    """Return something of the viewer: `walker.frequency`, `scene.zoom`."""
    return page.evaluate(f"() => {VIEWER}.{what}")


def _alphas(page):
    return np.array(_get(page, "walker.alphas"))


def _points(page):
    settle(page)
    return np.array(page.evaluate(f"() => [...{VIEWER}.walker.shown]")).reshape(-1, 3)


def _picture(page):
    """Return the pixels of the stage, shape (height, width, 3)."""
    settle(page)
    png = base64.b64decode(page.evaluate(f"() => {VIEWER}.canvas.toDataURL()").partition(",")[2])
    return np.round(255 * imread(io.BytesIO(png), format="png")[..., :3]).astype(int)


def _scene(page, name):
    return page.locator(f"[data-scene={name}]")


def _row(page, trait):
    return page.locator(".trait").nth(TRAITS.index(trait))


# Traits.


def test_arrow_keys_on_a_slider_move_its_trait_and_others_go_along(page):
    model, _ = four_axes()
    slider = _row(page, "gender").locator(".range")
    slider.focus()
    for _ in range(20):
        page.keyboard.press("ArrowRight")
    assert slider.get_attribute("aria-valuetext") == "+1.00, male"
    step = model[-1].step([[1.0]], ["gender"])
    assert_allclose(_alphas(page), model[-1].transform(model[-1].mean_ + step)[0], atol=1e-9)
    assert _row(page, "weight").locator(".number").input_value() == f"{_alphas(page)[1]:.2f}"
    assert float(_row(page, "weight").locator(".range").input_value()) == pytest.approx(_alphas(page)[1], abs=0.05)
    page.keyboard.press("End")
    assert _alphas(page)[0] == 6


def test_a_slider_is_dragged(page):
    box = _row(page, "happy").locator(".range").bounding_box()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.75 * box["width"], box["y"] + 0.5 * box["height"], steps=5)
    page.mouse.up()
    assert _alphas(page)[2] == pytest.approx(3.2, abs=0.2)  # the thumb's middle goes less far than the track
    assert _get(page, "alphas") == {"happy": _alphas(page)[2]}


def test_a_number_is_typed(page):
    field = _row(page, "weight").locator(".number")
    field.fill("-1.234")
    field.press("Enter")
    assert _get(page, "alphas") == {"weight": -1.234}
    assert field.input_value() == "-1.23"
    for wrong in ("17", "", "1e9"):
        field.fill(wrong)
        field.press("Enter")
        assert page.locator(".message").inner_text() == "weight must be a number from −6.0 to +6.0."
        assert (field.input_value(), _get(page, "alphas")) == ("-1.23", {"weight": -1.234})


def test_a_held_trait_stays_and_a_released_one_goes_along(page):
    model, _ = four_axes()
    _row(page, "weight").get_by_label("hold weight").check()
    _row(page, "gender").locator(".number").fill("2")
    page.keyboard.press("Tab")
    assert _get(page, "alphas") == {"weight": 0, "gender": 2}
    assert_allclose(_alphas(page)[:2], [2, 0])
    _row(page, "weight").get_by_label("hold weight").uncheck()
    step = model[-1].step([[2.0]], ["gender"])
    assert_allclose(_alphas(page), model[-1].transform(model[-1].mean_ + step)[0], atol=1e-9)
    assert _alphas(page)[0] == 2
    assert _row(page, "gender").get_by_label("hold gender").is_checked()
    page.locator(".reset").click()
    assert_allclose(_alphas(page), 0, atol=1e-12)
    assert not _row(page, "gender").get_by_label("hold gender").is_checked()


@pytest.mark.parametrize("part", ["structure", "dynamics"])
def test_sliders_move_one_part(page, part):
    model, _ = four_axes()
    before = np.array(page.evaluate(f"() => [...{VIEWER}.walker.vector]"))
    page.locator(".segments label", has_text=part).click()
    page.evaluate(f"() => {VIEWER}.setAlpha(0, 1)")
    after = np.array(page.evaluate(f"() => [...{VIEWER}.walker.vector]"))
    expected = axis_features(model).loc["gender"].to_numpy()
    moves = (np.arange(226) < 45) == (part == "structure")
    assert_allclose(after - before, np.where(moves, expected, 0), atol=1e-12)


def test_the_slider_shows_poles_and_where_the_data_end(page):
    model, _ = four_axes()
    row, alphas = _row(page, "happy"), model[-1].alphas_[:, 2]
    assert row.locator(".pole").all_inner_texts() == ["sad", "happy"]
    ends = [float(row.evaluate(f"row => row.style.getPropertyValue('{end}')")) for end in ("--low", "--high")]
    assert_allclose(ends, [0.5 + alphas.min() / 12, 0.5 + alphas.max() / 12])
    slider = row.locator(".range")
    for alpha, words in ((alphas.max() - 0.1, "happy"), (alphas.max() + 0.1, "happy, beyond your walkers")):
        page.evaluate(f"() => {VIEWER}.setAlpha(2, {alpha})")
        assert slider.get_attribute("aria-valuetext") == f"+{alpha:.2f}, {words}"


def test_a_walker_outside_the_data_is_called_so(page):
    model, _ = four_axes()
    assert page.locator(".warning").inner_text() == ""
    field = _row(page, "nervous").locator(".number")
    field.fill("6")
    field.press("Enter")
    page.evaluate(f"() => {{ {VIEWER}.setAlpha(0, 6); {VIEWER}.setAlpha(1, -6); }}")
    far, limit = _get(page, "walker.distance"), model[-1].distance_limit()
    assert far > limit
    assert page.locator(".warning").inner_text() == (
        f"Outside your data: {far:.1f} standard deviations from the average walker; 99 % of walkers like yours are "
        f"within {limit:.1f}."
    )
    assert "outside your data" in page.locator("canvas").get_attribute("aria-label")


# Walkers.


def test_walkers_stand_side_by_side_with_alphas_of_their_own(page):
    page.evaluate(f"() => {VIEWER}.setAlpha(2, -3)")
    for alpha in (0, 3):
        page.locator(".add").click()
        page.evaluate(f"() => {VIEWER}.setAlpha(2, {alpha})")
    assert page.locator(".chips button").all_inner_texts() == ["A", "B", "C"]
    assert page.evaluate(f"() => {VIEWER}.walkers.map((walker) => walker.alphas[2])") == [-3, 0, 3]
    page.get_by_role("button", name="Walker A").click()
    assert _row(page, "happy").locator(".number").input_value() == "-3.00"
    settle(page)
    cells = page.evaluate(f"() => {VIEWER}.stage.cells")
    assert cells[0]["x"] < cells[1]["x"] < cells[2]["x"]
    page.mouse.click(cells[2]["x"], cells[2]["y"])
    assert page.get_by_role("button", name="Walker C").get_attribute("aria-pressed") == "true"
    assert _row(page, "happy").locator(".number").input_value() == "3.00"
    page.locator(".remove").click()
    page.locator(".remove").click()
    assert page.evaluate(f"() => {VIEWER}.walkers.map((walker) => walker.alphas[2])") == [-3]
    assert page.locator(".remove").is_disabled()


def test_no_more_than_twelve_walkers(page):
    for _ in range(11):
        page.locator(".add").click()
    assert page.locator(".add").is_disabled()
    assert len(_get(page, "walkers")) == 12


def test_a_walker_is_loaded_as_its_eigenwalkers_show_it(page):
    model, walks = four_axes()
    page.evaluate(f"() => {VIEWER}.setAlpha(0, 3)")
    page.get_by_label("Load a walker").select_option(walks[7].name)
    assert_allclose(_alphas(page), model.transform([walks[7]])[0], atol=1e-9)
    assert _get(page, "alphas") == {}
    expected = model[1:-1].inverse_transform(model[:-1].transform([walks[7]]))[0]
    assert_allclose(page.evaluate(f"() => [...{VIEWER}.walker.vector]"), expected, atol=1e-12)
    assert page.locator(".loaded").inner_text().startswith("Shown as its 15 Eigenwalkers show it")
    page.get_by_label("Load a walker").select_option("Average walker")
    assert_allclose(_alphas(page), 0, atol=1e-12)
    assert page.locator(".loaded").inner_text() == ""


# Time.


def test_play_and_pause(browser, address):
    with opened(browser, address, reduced_motion="no-preference") as page:
        button = page.locator(".play")
        assert button.get_attribute("aria-label") == "Pause"
        before = _get(page, "walker.phase")
        wait_until(page, lambda: _get(page, "walker.phase") != before)
        button.click()
        assert button.get_attribute("aria-label") == "Play"
        before = _get(page, "walker.phase")
        page.wait_for_timeout(200)
        assert _get(page, "walker.phase") == before


def test_little_motion_is_respected(page):
    assert not _get(page, "playing")
    before = _points(page)
    page.wait_for_timeout(100)
    assert_allclose(_points(page), before)


def test_steps_forward_and_back(page):
    frequency = _get(page, "walker.frequency")
    page.locator(".forward").click()
    page.locator(".forward").click()
    assert _get(page, "walker.phase") == pytest.approx(2 * np.pi * frequency * 2 / 30)
    page.locator(".back").click()
    page.locator("canvas").focus()
    page.keyboard.press(",")
    assert np.cos(_get(page, "walker.phase")) == pytest.approx(1)


def test_the_phase_is_set(page):
    page.locator(".phase").focus()
    for _ in range(90):
        page.keyboard.press("ArrowRight")
    assert _get(page, "walker.phase") == pytest.approx(np.pi / 2)
    assert page.locator(".phase-value").inner_text() == "90°"


def test_speed(page):
    _scene(page, "speed").focus()
    page.keyboard.press("Home")
    assert _get(page, "scene.speed") == 0.1
    assert page.locator(".speed-value").inner_text() == "0.10×"
    before = _get(page, "walker.phase")
    page.evaluate(
        f"() => new Promise((done) => {{ const v = {VIEWER}; v.play(true); v.last = undefined;"
        "v.tick(1000); v.tick(1050); v.play(false); done() })"
    )
    passed = (_get(page, "walker.phase") - before) / (2 * np.pi * _get(page, "walker.frequency"))
    assert passed == pytest.approx(0.005)


@pytest.mark.parametrize("harmonic", [1, 2])
def test_harmonics_are_switched_off_and_on(page, harmonic):
    box = page.get_by_label(f"harmonic {harmonic}", exact=True)
    vector = np.array(page.evaluate(f"() => [...{VIEWER}.walker.vector]"))
    whole = _points(page)
    box.uncheck()
    cosine = vector[45 * 2 * harmonic : 45 * (2 * harmonic + 1)].reshape(15, 3)  # all that there is of it at phase 0
    assert_allclose(_points(page), whole - cosine, atol=1e-12)
    box.check()
    assert_allclose(_points(page), whole, atol=1e-12)


# View and figure.


@pytest.mark.parametrize(("name", "azimuth"), [("Front", 0), ("30°", 30), ("Side", 90)])
def test_buttons_of_views(page, name, azimuth):
    page.evaluate(f"() => {VIEWER}.turn(-77, 33)")
    button = page.get_by_role("button", name=name, exact=True)
    assert button.get_attribute("aria-pressed") == "false"
    button.click()
    assert (_get(page, "scene.azimuth"), _get(page, "scene.elevation")) == (azimuth, 0)
    assert button.get_attribute("aria-pressed") == "true"


def test_the_view_is_turned_by_drag(page):
    page.mouse.move(300, 300)
    page.mouse.down()
    page.mouse.move(400, 350, steps=4)
    page.mouse.up()
    assert (_get(page, "scene.azimuth"), _get(page, "scene.elevation")) == (80, 15)


def test_the_view_is_turned_by_keys(page):
    page.locator("canvas").focus()
    for key in ("ArrowRight", "ArrowRight", "ArrowUp", "Shift+ArrowLeft", "+"):
        page.keyboard.press(key)
    assert (_get(page, "scene.azimuth"), _get(page, "scene.elevation")) == (39, 5)
    assert _get(page, "scene.zoom") == pytest.approx(1.1)
    page.keyboard.press(" ")
    assert _get(page, "playing")
    page.keyboard.press(" ")
    for _ in range(60):
        page.keyboard.press("ArrowDown")
    assert _get(page, "scene.elevation") == -20
    assert "seen from 39 degrees, -20 degrees up" in page.locator("canvas").get_attribute("aria-label")


def test_larger_and_smaller(page):
    before = page.evaluate(f"() => {VIEWER}.stage.cells[0].scale")
    page.get_by_role("button", name="Larger").click()
    settle(page)
    assert page.evaluate(f"() => {VIEWER}.stage.cells[0].scale") == pytest.approx(1.1 * before)
    page.get_by_role("button", name="Smaller").click()
    assert _get(page, "scene.zoom") == pytest.approx(1, abs=1e-3)


def test_perspective_makes_what_is_near_large(page):
    def sizes():
        settle(page)
        return np.array(page.evaluate(f"() => [...{VIEWER}.walker.seen]")).reshape(-1, 4)[:, 2:].T

    near, size = sizes()
    assert_allclose(size, 4.5 / (4.5 - near))
    _scene(page, "perspective").uncheck()
    assert_allclose(sizes()[1], 1)


def test_what_is_switched_off_is_not_drawn(page):
    for name in ("ground", "labels", "sticks", "dots"):
        before = _picture(page)
        _scene(page, name).uncheck()
        assert (_picture(page) != before).any(), name
    picture = _picture(page)
    assert (picture == picture[0, 0]).all()
    _scene(page, "dots").check()
    blobs = (_picture(page) != picture[0, 0]).any(axis=2)
    dots = np.array(page.evaluate(f"() => [...{VIEWER}.walker.seen]")).reshape(-1, 4)
    assert blobs[dots[:, 1].astype(int), dots[:, 0].astype(int)].all()
    rows, columns = np.nonzero(blobs)
    away = np.hypot(rows[:, None] - dots[:, 1], columns[:, None] - dots[:, 0]).min(axis=1)
    assert away.max() < 15


def test_dots_become_larger(page):
    for name in ("ground", "labels", "sticks"):
        _scene(page, name).uncheck()
    areas = []
    for key in ("Home", "End"):
        _scene(page, "dotSize").focus()
        page.keyboard.press(key)
        picture = _picture(page)
        areas.append((picture != picture[0, 0]).any(axis=2).sum())
    assert areas[1] > 15 * areas[0]


def test_colors(page):
    for name in ("ground", "labels", "sticks"):
        _scene(page, name).uncheck()

    def saturation():
        picture = _picture(page)
        return (picture.max(axis=2) - picture.min(axis=2)).max()

    assert saturation() > 100
    _scene(page, "sides").uncheck()
    assert saturation() < 40
    _scene(page, "black").check()
    assert (_picture(page)[0, 0] == 0).all()
    shades = {tuple(color) for color in _colors_of_dots(page)}
    _scene(page, "shading").uncheck()
    assert len(shades) > 3
    assert {tuple(color) for color in _colors_of_dots(page)} == {(255, 255, 255)}


def _colors_of_dots(page):
    picture = _picture(page)
    seen = np.array(page.evaluate(f"() => [...{VIEWER}.walker.seen]")).reshape(-1, 4)
    return picture[seen[:, 1].astype(int), seen[:, 0].astype(int)]


# Disguise.


def test_upside_down(page):
    before, height = _points(page), _get(page, "space.height")
    _scene(page, "invert").check()
    assert_allclose(_points(page), before * [1, 1, -1] + [0, 0, height])


def _means_and_motions(page):
    """Return mean positions and motions of the shown dots, over 24 phases of the stride."""
    frames = []
    for degrees in range(0, 360, 15):
        page.evaluate(f"() => {{ {VIEWER}.setPhase({degrees}); {VIEWER}.draw(); }}")
        frames.append(page.evaluate(f"() => [...{VIEWER}.walker.shown]"))
    frames = np.reshape(frames, (24, -1, 3))
    return frames.mean(axis=0), frames - frames.mean(axis=0)


def test_scrambled_places_keep_the_motions(page):
    means, motions = _means_and_motions(page)
    _scene(page, "scramblePlaces").check()
    places, same = _means_and_motions(page)
    assert_allclose(same, motions, atol=1e-12)
    assert np.linalg.norm(places - means, axis=1).min() > 0.01
    assert (places >= means.min(axis=0) - 1e-12).all()
    assert (places <= means.max(axis=0) + 1e-12).all()
    page.locator(".shuffle").click()
    assert np.linalg.norm(_means_and_motions(page)[0] - places, axis=1).min() > 0.01


def test_scrambled_phases_keep_places_and_paths(page):
    means, motions = _means_and_motions(page)
    _scene(page, "scramblePhases").check()
    places, shifted = _means_and_motions(page)
    assert_allclose(places, means, atol=1e-12)
    powers, after = (np.abs(np.fft.rfft(motion, axis=0)) for motion in (motions, shifted))
    assert_allclose(after, powers, atol=1e-9)
    assert np.linalg.norm(shifted - motions, axis=(0, 2)).min() > 0.01


def test_mask_dots_move_like_the_walker_in_other_places(page):
    _, motions = _means_and_motions(page)
    _scene(page, "mask").focus()
    for _ in range(6):
        page.keyboard.press("ArrowRight")
    assert _get(page, "scene.mask") == 30
    _, all_motions = _means_and_motions(page)
    assert len(_points(page)) == 45
    powers = np.abs(np.fft.rfft(all_motions, axis=0))
    assert_allclose(powers[:, 15:30], powers[:, :15], atol=1e-9)
    assert_allclose(powers[:, 30:], powers[:, :15], atol=1e-9)
    assert_allclose(all_motions[:, :15], motions, atol=1e-12)


# Taking along.


def test_a_picture_is_saved(page, tmp_path):
    with page.expect_download() as download:
        page.get_by_role("button", name="PNG").click()
    download.value.save_as(tmp_path / "walker.png")
    assert download.value.suggested_filename == "walker.png"
    assert (tmp_path / "walker.png").read_bytes().startswith(b"\x89PNG")


def test_a_link_holds_the_state(browser, page):
    page.get_by_label("Load a walker").select_option(index=5)
    page.evaluate(
        f"() => {{ {VIEWER}.setAlpha(1, 1.2345678901234567); {VIEWER}.turn(12, 34); {VIEWER}.setPhase(50); }}"
    )
    page.locator(".add").click()
    page.locator(".segments label", has_text="dynamics").click()
    _scene(page, "mask").focus()
    page.keyboard.press("ArrowRight")
    page.get_by_label("harmonic 2", exact=True).uncheck()
    state, points = _get(page, "state"), _points(page)
    page.locator(".copy").click()
    link = page.get_by_label("Link").input_value()
    with opened(browser, link) as other:
        assert _get(other, "state") == state
        assert_allclose(_points(other), points, atol=1e-15)


@pytest.mark.parametrize(
    ("state", "reason"),
    [
        ({"walkers": [{"alphas": {"mood": 1}}]}, "there is no trait mood here"),
        ({"walkers": [{"alphas": {"happy": 99}}]}, "happy must be a number from -6 to 6, not 99"),
        ({"walkers": [{"alphas": {"happy": "<img>"}}]}, "happy must be a number from -6 to 6, not <img>"),
        ({"walkers": [{"walker": 80}]}, "there is no walker 80 here"),
        ({"walkers": [{"walker": "__proto__"}]}, "there is no walker __proto__ here"),
        ({"walkers": [{"part": "soul"}]}, "there is no part soul"),
        ({"walkers": 3}, "walkers must be a list, not 3"),
        ("{", "Expected property name"),
    ],
)
def test_wrong_links_are_refused_as_a_whole(browser, address, state, reason):
    text = state if isinstance(state, str) else json.dumps(state | {"scene": {"azimuth": 77}})
    with opened(browser, f"{address}#{urllib.parse.quote(text)}") as page:
        message = page.locator(".message").inner_text()
        assert message.startswith("The link does not fit this page: ")
        assert reason in message
        assert (_get(page, "scene.azimuth"), _get(page, "alphas")) == (30, {})


def test_what_a_link_says_of_the_scene_is_kept_within_bounds(browser, address):
    scene = {"zoom": 1e9, "mask": 1e9, "dotSize": -1, "azimuth": "x", "speed": None, "ground": False, "strange": 1}
    with opened(browser, f"{address}#{urllib.parse.quote(json.dumps({'scene': scene}))}") as page:
        found = _get(page, "scene")
    assert (found["zoom"], found["mask"], found["dotSize"]) == (3, 200, 0.4)
    assert (found["azimuth"], found["speed"], found["ground"]) == (30, 1, False)
    assert "strange" not in found
