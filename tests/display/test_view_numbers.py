"""What the page draws is what numpy says, and nothing on it jumps."""

import itertools
import warnings
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import read_walk, walk_at
from eigenwalker.display import project, view
from eigenwalker.model import OutsideDataWarning, TraitRegressor, make_eigenwalkers
from eigenwalker.motion import evaluate_harmonics, fit_harmonics
from tests.viewer_pages import POLES, VIEWER, four_axes, opened, put, settle

TRAITS = list(POLES)
DRAWN = f"() => {{ const {{ walker }} = {VIEWER}; return [[...walker.shown], [...walker.alphas], walker.frequency]; }}"


def _as_shown(model, walk):
    """Return a walk as its Eigenwalkers show it, its frequency known."""
    vector = model[1:-1].inverse_transform(model[:-1].transform([walk]))
    return replace(model[0].inverse_transform(vector)[0], frequency=vector[0, -1])


def _draw_state(rng, n_walkers):
    """Draw whom to start from, what to hold as it is, what to set, which part moves, which harmonics are on."""
    order = rng.permutation(TRAITS).tolist()
    n_set, n_held = rng.integers(1, 5), rng.integers(0, 3)
    return {
        "walker": None if rng.random() < 0.3 else int(rng.integers(n_walkers)),
        "hold": order[n_set : n_set + n_held],
        "alphas": {name: float(rng.uniform(-4, 4)) for name in order[:n_set]},
        "part": [None, None, "structure", "dynamics"][rng.integers(4)],
        "harmonics": [True, True] if rng.random() < 0.5 else [bool(on) for on in rng.integers(0, 2, 2)],
    }


SET_STATE = f"""(state) => {{
    const viewer = {VIEWER};
    const numbers = viewer.contents.traits.map(({{ name }}) => name);
    viewer.restore({{ walkers: [{{ walker: state.walker, part: state.part, phase: state.phase }}] }});
    state.harmonics.forEach((on, k) => viewer.setHarmonic(k, on));
    for (const name of state.hold) viewer.setHold(numbers.indexOf(name), true);
    for (const [name, alpha] of Object.entries(state.alphas)) viewer.setAlpha(numbers.indexOf(name), alpha);
    viewer.draw();
}}"""


def _expected(model, walk, frame, frequency, harmonics):
    """Return the markers in a frame of a walk, with some of its harmonics only, and its phase."""
    phase = 2 * np.pi * frequency * frame / walk.frame_rate
    if all(harmonics):
        return walk.positions[frame], phase
    coefficients = fit_harmonics(walk.channels, walk.frame_rate, frequency, len(harmonics))
    coefficients[1:] *= np.repeat(harmonics, 2)[:, np.newaxis]
    return evaluate_harmonics(coefficients, 1.0, [phase / (2 * np.pi)]).reshape(-1, 3), phase


def test_markers_are_where_numpy_has_them(page, record_testsuite_property):
    model, walks = four_axes()
    rng = np.random.default_rng(0)
    worst = 0.0
    for _ in range(50):
        state = _draw_state(rng, len(walks))
        base = None if state["walker"] is None else _as_shown(model, walks[state["walker"]])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", OutsideDataWarning)
            walk = walk_at(model, state["alphas"], base, hold=state["hold"], part=state["part"])
        page.evaluate(SET_STATE, state | {"phase": 0})
        frequency = page.evaluate(DRAWN)[2]
        frame = int(rng.integers(walk.n_frames))
        expected, phase = _expected(model, walk, frame, frequency, state["harmonics"])
        page.evaluate(SET_STATE, state | {"phase": phase})
        points, alphas, _ = page.evaluate(DRAWN)
        worst = max(worst, np.abs(np.reshape(points, (-1, 3)) - expected).max())
        if state["part"] is None:
            whole = replace(walk, frequency=frequency)
            assert_allclose(alphas, model.transform([whole])[0], atol=1e-8)
    assert worst < 1e-9  # metres
    record_testsuite_property("largest difference to numpy, m", worst)


@pytest.mark.parametrize("direction", ["pattern", "filter"])
@pytest.mark.parametrize("scaling", ["blocks", "features"])
def test_other_models_are_drawn_as_well(browser, tmp_path, direction, scaling):
    _, walks = four_axes()
    labels = np.random.default_rng(1).normal(size=(80, 3))
    trait = TraitRegressor(direction=direction, alpha_unit="label")
    model = make_eigenwalkers(3, 8, scaling=scaling, trait=trait).fit(walks, labels)
    alphas = {name: 0.5 * alpha for name, alpha in zip(model[-1].trait_names_, (1.0, -1.0), strict=False)}
    walk = walk_at(model, alphas)
    with opened(browser, put(tmp_path, view(model, alphas=alphas))) as page:
        points, predicted, frequency = page.evaluate(DRAWN)
        assert_allclose(np.reshape(points, (-1, 3)), walk.positions[0], atol=1e-9)
        assert_allclose(predicted, model.transform([replace(walk, frequency=frequency)])[0], atol=1e-8)


def test_recorded_walks_are_drawn_as_their_harmonics(browser, tmp_path):
    walks = four_axes()[1][:3]
    with opened(browser, put(tmp_path, view(walks))) as page:
        drawn = page.evaluate(f"() => {VIEWER}.walkers.map((walker) => [[...walker.shown], walker.frequency])")
        for walk, (points, frequency) in zip(walks, drawn, strict=True):
            coefficients = fit_harmonics(walk.channels, walk.frame_rate, frequency, 4)
            ankles = coefficients[:, [3 * walk.marker_set.index(f"{side}_ankle") for side in ("left", "right")]]
            sine, cosine = (ankles @ [1.0, -1.0])[1:3]
            phase = np.arctan2(sine, cosine) / (2 * np.pi)
            assert_allclose(points, evaluate_harmonics(coefficients, 1.0, [phase])[0], atol=1e-9)


@pytest.mark.parametrize("azimuth", [0, 30, 90, -135])
def test_the_picture_is_the_projection(page, azimuth):
    page.evaluate(f"() => {VIEWER}.setScene({{ azimuth: {azimuth}, elevation: 0, perspective: false, zoom: 1 }})")
    settle(page)
    points, seen, middle, cell = page.evaluate(
        f"""() => {{
        const {{ walker, stage }} = {VIEWER};
        return [[...walker.shown], [...walker.seen], walker.middle, stage.cells[0]];
        }}"""
    )
    expected = project(np.reshape(points, (-1, 3)) - middle, azimuth)
    seen = np.reshape(seen, (-1, 4))
    assert_allclose((seen[:, 0] - cell["x"]) / cell["scale"], expected[:, 0], atol=1e-9)
    assert_allclose((cell["y"] - seen[:, 1]) / cell["scale"], expected[:, 1], atol=1e-9)
    assert_allclose(seen[:, 2], expected[:, 2], atol=1e-9)


@pytest.mark.parametrize("density", [1, 2, 3])
def test_dots_are_drawn_where_they_are_seen_on_any_screen(browser, address, density):
    with opened(browser, address, device_scale_factor=density) as page:
        page.evaluate(f"() => {VIEWER}.setScene({{ sticks: false, ground: false, labels: false, black: true }})")
        settle(page)
        width, shown, colors = page.evaluate(
            f"""() => {{
            const {{ canvas, walker }} = {VIEWER};
            const {{ width, height }} = canvas;
            const copy = Object.assign(document.createElement("canvas"), {{ width, height }});
            const pixels = copy.getContext("2d", {{ willReadFrequently: true }});
            pixels.drawImage(canvas, 0, 0);
            const at = (x, y) => [...pixels.getImageData({density} * x, {density} * y, 1, 1).data.slice(0, 3)];
            const dots = Array.from({{ length: 15 }}, (_, dot) => at(walker.seen[4 * dot], walker.seen[4 * dot + 1]));
            return [canvas.width, canvas.clientWidth, dots];
            }}"""
        )
        assert width == density * shown
        assert np.min(colors) > 50


def test_nearer_dots_are_drawn_over_farther_ones(page):
    """From the side the right wrist hides what is behind it when both are at one place of the picture."""
    order = page.evaluate(
        f"""() => {{
        const viewer = {VIEWER};
        viewer.setScene({{ azimuth: 90, sticks: true, dots: true }});
        const near = [];
        for (const name of ["drawStick", "drawDot"]) {{
            const draw = viewer.stage[name].bind(viewer.stage);
            viewer.stage[name] = (cell, seen, part, ...rest) => {{
                near.push(part.near);
                draw(cell, seen, part, ...rest);
            }};
        }}
        viewer.draw();
        return near;
        }}"""
    )
    assert len(order) == 29
    assert (np.diff(order) >= 0).all()


LOG = f"""() => {{
    const viewer = {VIEWER};
    const [draw, advance] = [viewer.draw.bind(viewer), viewer.advance.bind(viewer)];
    let passed = 0;
    window.log = [];
    viewer.advance = (seconds) => {{
        passed += seconds;
        advance(seconds);
    }};
    viewer.draw = () => {{
        draw();
        const {{ shown, alphas, vector, phase }} = viewer.walker;
        window.log.push({{ passed, alphas: [...alphas], points: [...shown], vector: [...vector], phase }});
        passed = 0;
    }};
}}"""


def test_a_moving_slider_moves_no_dot_further_than_it_explains(browser, address):
    """From frame to frame: the slider moves it by (change of features) at its phase, time by its speed at most."""
    with opened(browser, address, reduced_motion="no-preference") as page:
        slider = page.locator(".trait .range").nth(3)  # nervous, which changes the frequency most
        box = slider.bounding_box()
        page.evaluate(LOG)
        page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
        page.mouse.down()
        for share in 0.5 + 0.48 * np.sin(np.linspace(0, 4 * np.pi, 120)):
            page.mouse.move(box["x"] + share * box["width"], box["y"] + 0.5 * box["height"])
            page.wait_for_timeout(1000 / 60)
        page.mouse.up()
        log = page.evaluate("window.log")
    assert len(log) > 60
    assert np.ptp([entry["alphas"][3] for entry in log]) > 8
    for before, after in itertools.pairwise(log):
        explained = _explained(before, after)
        moved = np.linalg.norm(np.subtract(after["points"], before["points"]).reshape(-1, 3), axis=1)
        assert (moved <= explained + 1e-9).all()
        assert after["passed"] <= 0.05


def _explained(before, after):
    """Return how far slider and time may move each dot between two frames, shape (15,)."""
    old, new = np.array(before["vector"]), np.array(after["vector"])
    slider = evaluate_harmonics((new - old)[:225].reshape(5, 45), 1.0, [after["phase"] / (2 * np.pi)])
    amplitudes = old[45:225].reshape(2, 2, 15, 3)  # harmonics, sine and cosine, markers, axes
    fastest = 2 * np.pi * new[225] * np.einsum("k,kma->ma", [1.0, 2.0], np.linalg.norm(amplitudes, axis=1))
    return np.linalg.norm(slider.reshape(15, 3), axis=1) + after["passed"] * np.linalg.norm(fastest, axis=1)


def test_not_even_a_jump_of_the_slider_changes_the_phase(page):
    before, after = page.evaluate(
        f"""() => {{
        const viewer = {VIEWER};
        viewer.setPhase(100);
        const before = viewer.walker.phase;
        for (const alpha of [6, -6, 3]) viewer.setAlpha(3, alpha);
        return [before, viewer.walker.phase];
        }}"""
    )
    assert before == after


def test_the_phase_grows_with_the_frequency_and_the_speed(page):
    phases = page.evaluate(
        f"""() => {{
        const viewer = {VIEWER};
        viewer.setPhase(0);
        return Array.from({{ length: 300 }}, () => (viewer.advance(1 / 60), viewer.walker.phase));
        }}"""
    )
    frequency = page.evaluate(DRAWN)[2]
    expected = 2 * np.pi * frequency * np.arange(1, 301) / 60
    assert_allclose(np.unwrap(phases), expected, atol=1e-9)


def test_the_table_is_the_walk(page, tmp_path):
    model, _ = four_axes()
    page.evaluate(f"() => {{ {VIEWER}.setAlpha(2, 1.5); {VIEWER}.setScene({{ mask: 40, scramblePlaces: true }}); }}")
    with page.expect_download() as download:
        page.locator(".csv").click()
    download.value.save_as(tmp_path / "walker.csv")
    walk, expected = read_walk(tmp_path / "walker.csv"), walk_at(model, {"happy": 1.5})
    assert walk.frame_rate == pytest.approx(120)
    assert_allclose(walk.positions, expected.positions, atol=1e-9)
    assert model.transform([walk])[0, 2] == pytest.approx(1.5, abs=1e-6)


def test_the_belt_runs_as_fast_as_the_feet(page):
    """The foot on the belt goes back with it: the lower ankle's speed, over the middle of its stance."""
    model, _ = four_axes()
    walk = walk_at(model, {"gender": 0.0})
    belt = page.evaluate(f"() => ({VIEWER}.advance(0.01), {VIEWER}.walker.belt)")
    ankles = np.stack([walk.marker(f"{side}_ankle") for side in ("left", "right")], axis=1)
    back = -np.gradient(ankles[..., 0], 1 / walk.frame_rate, axis=0)
    assert belt == pytest.approx(back.max(axis=1).mean(), rel=0.01)
