"""Point-light displays: what each step keeps, exactly, and what it changes."""

import json
import math
import os
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.display import PointLightDisplay, project
from eigenwalker.display.point_lights import path_reach
from eigenwalker.model import FourierLinearizer, hybrid_walk, make_eigenwalkers, walk_along_axis
from eigenwalker.motion import TROJE15
from tests.synthetic import make_walk

SCRAMBLINGS = ("area", "horizontal", "vertical", "volume", "x", "y", "z")
ROUNDING = 1e-12  # metres; places are sums of a dozen sines of about one


def _about_mean(display, n_frames=50):
    """Return each dot's places about its mean, evenly over its own period, shape (n_frames, n_dots, 2)."""
    still = replace(display.dots, frequencies=np.ones_like(display.dots.frequencies))
    places = replace(display, dots=still, lifetimes=()).frames(1.0, n_frames)
    return places - places.mean(axis=0)


# ---- from a walk


def test_dots_are_the_markers_from_the_side(walk, walker):
    """The display is the walk, shifted in time to its common phase, and in space to its middle."""
    places = walker.evaluate(np.arange(walk.n_frames) / walk.frame_rate)
    expected = project(walk.positions, 90)[..., :2]
    assert_allclose(np.ptp(places - expected, axis=(0, 1)), 0, atol=1e-9)  # one shift for all dots and frames
    assert walker.names == TROJE15.names


def test_middle_is_zero_and_height_what_the_markers_cover(walker):
    places = walker.frames(walker.period, 720 / walker.period)
    assert_allclose(places.min(axis=(0, 1)) + places.max(axis=(0, 1)), 0, atol=1e-3)
    assert_allclose(np.ptp(places[..., 1]), walker.height, rtol=1e-3)


def test_time_zero_has_the_left_ankle_in_front(walk):
    late = make_walk(np.random.default_rng(0), n_harmonics=3, phase=2.0)[0]
    first, second = (PointLightDisplay.from_walk(one).frames(1.0, 60) for one in (walk, late))
    assert_allclose(first, second, atol=1e-6)
    left, right = (first[:, TROJE15.index(f"{side}_ankle"), 0] for side in ("left", "right"))
    assert left[0] - right[0] > 0.5


def test_walks_of_a_model_are_exact():
    """Coefficients of the model come back out of its walk, but for the middle."""
    walkers = make_walkers(12, random_state=0)
    model = make_eigenwalkers(n_components=4).fit(walkers.data, walkers.target["gender"])
    made = walk_along_axis(model, "gender", [1.0])[0]
    display = PointLightDisplay.from_walk(made)
    vector = FourierLinearizer().fit([made]).transform([made])[0]
    blocks = vector[:225].reshape(5, 15, 3)
    assert_allclose(display.dots.coefficients[1:5], blocks[1:], atol=1e-9)
    assert_allclose(display.dots.coefficients[5:], 0, atol=1e-9)
    assert_allclose(np.ptp(display.dots.coefficients[0] - blocks[0], axis=0), 0, atol=1e-9)


def test_structure_of_one_and_dynamics_of_another():
    one, other = make_walkers(2, random_state=0).data
    hybrid = hybrid_walk(FourierLinearizer().fit([one, other]), structure=one, dynamics=other)
    mixed, first, second = (PointLightDisplay.from_walk(walk, n_harmonics=2) for walk in (hybrid, one, other))
    assert_allclose(mixed.dots.coefficients[1:], second.dots.coefficients[1:], atol=1e-9)
    assert_allclose(np.ptp(mixed.dots.coefficients[0] - first.dots.coefficients[0], axis=0), 0, atol=1e-9)
    assert_allclose(mixed.period, second.period)


def test_size_is_put_back(walk):
    small = replace(walk, positions=walk.positions / 1.6, size=1.6)
    assert_allclose(
        PointLightDisplay.from_walk(small).frames(1, 60), PointLightDisplay.from_walk(walk).frames(1, 60), atol=1e-9
    )


def test_joint_walks_travelling_walks_and_gaps_are_refused(walk):
    with pytest.raises(TypeError, match="to_markers"):
        PointLightDisplay.from_walk(np.zeros((10, 15, 3)))
    shift = np.zeros_like(walk.positions)
    shift[..., 0] = np.arange(walk.n_frames)[:, np.newaxis] * 0.01
    with pytest.raises(WalkError, match="in place"):
        PointLightDisplay.from_walk(replace(walk, positions=walk.positions + shift))
    shift[3, 4, 0] = np.nan
    with pytest.raises(WalkError, match="finite"):
        PointLightDisplay.from_walk(replace(walk, positions=walk.positions + shift))
    with pytest.raises(ValueError, match="n_harmonics must be a number of at least 1, got 0"):
        PointLightDisplay.from_walk(walk, n_harmonics=0)


def test_parts_of_a_walker_stay_where_they_are(walk, walker):
    feet = PointLightDisplay.from_walk(walk, markers=["right_ankle", "left_ankle"])
    assert_array_equal(feet.frames(1, 60), walker.frames(1, 60)[:, [14, 11]])
    assert (feet.height, feet.scale) == (walker.height, walker.scale)
    with pytest.raises(ValueError, match=r"out of head, .* got left_toe"):
        walker.only(["left_toe"])


# ---- time


@pytest.fixture(scope="module")
def everything(walker):
    """Return a display with every step in it."""
    display = walker.seen_from(30, 10).inverted().scramble_position(0.5, random_state=0).scramble_phase(random_state=1)
    display = display.scramble_period(0.3, random_state=2).translating().limit_lifetime(6, 0.13, random_state=3)
    return display.add_mask(20, random_state=4).limit_lifetime(9, 0.1, random_state=5)


def test_rates_agree_at_common_times(everything):
    slow, fast = everything.frames(3.0, 60), everything.frames(3.0, 120)
    assert_array_equal(np.isnan(slow), np.isnan(fast[::2]))
    assert_allclose(slow, fast[::2], rtol=0, atol=ROUNDING)


def test_frames_do_not_depend_on_each_other(everything):
    times = np.arange(100) / 60
    order = np.random.default_rng(0).permutation(100)
    assert_allclose(everything.evaluate(times)[order], everything.evaluate(times[order]), rtol=0, atol=ROUNDING)
    assert_allclose(everything.evaluate(times)[70:71], everything.evaluate(times[70:71]), rtol=0, atol=ROUNDING)


def test_same_seed_same_frames_in_a_pickle_too(everything):
    assert_array_equal(pickle.loads(pickle.dumps(everything)).frames(1, 60), everything.frames(1, 60))
    with pytest.raises(ValueError, match="read-only"):
        pickle.loads(pickle.dumps(everything)).dots.coefficients[0] = 1


CODE = """
import numpy as np
from eigenwalker.display import PointLightDisplay
from eigenwalker.display.dots import Dots
harmonics = np.array([[[0, 0.1, 1], [0.2, -0.1, 0.5]], [[0.3, 0, 0.1], [-0.2, 0.1, 0]], [[0, 0.1, 0], [0, 0, 0.2]]])
dots = Dots(harmonics, np.full(2, 0.9), np.zeros(2), np.zeros((2, 3)), ("a", "b"))
walker = PointLightDisplay(dots, height=1.0, scale=0.1, speed=1.1)
display = walker.scramble_position(random_state=0).scramble_phase(random_state=1).scramble_period(0.5, random_state=2)
display = display.add_mask(3, random_state=3).limit_lifetime(4, 0.3, random_state=4)
places = display.evaluate([0.0, 0.5, 61.7], unit="deg")
"""
# Written down once: neither numpy's stream nor the order of the draws may ever change.
KNOWN = [
    [
        [np.nan, np.nan],
        [-0.66290801278720, 4.31780461843714],
        [0.65251630850117, 4.26345390364050],
        [-0.20714822232618, 4.76695318635169],
        [0.87729630878706, 3.97260737457843],
    ],
    [
        [1.40151364055934, 5.09941245495234],
        [1.24060564786397, 4.94289420758524],
        [-0.29350647291528, 3.94972072694562],
        [1.79449984772036, 4.66205294755517],
        [np.nan, np.nan],
    ],
    [
        [1.27732468810711, 5.05831809260664],
        [np.nan, np.nan],
        [-0.14630469900986, 3.99855304113727],
        [1.89373766410863, 3.97238952307916],
        [-0.36602743449140, 3.55993171952351],
    ],
]


def test_same_seed_same_frames_for_ever():
    run: dict = {}
    exec(CODE, run)
    assert_allclose(run["places"], KNOWN, rtol=0, atol=ROUNDING)


def test_same_seed_same_frames_on_a_plain_processor():
    """Without the vector instructions that numpy's sines use where there are any."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    extras = " ".join(name for name in __cpu_dispatch__ if __cpu_features__.get(name))
    command = [sys.executable, "-c", CODE + "print(places.tolist())"]
    environment = {**os.environ, "NPY_DISABLE_CPU_FEATURES": extras}
    root = Path(__file__).parents[2]
    printed = subprocess.run(command, check=True, capture_output=True, text=True, env=environment, cwd=root).stdout
    assert_allclose(np.array(json.loads(printed.replace("nan", "NaN"))), KNOWN, rtol=0, atol=ROUNDING)


def test_period(walker):
    assert_allclose(walker.period, 1 / 0.93)
    assert_allclose(walker.evaluate([0.2]), walker.evaluate([0.2 + walker.period]), atol=ROUNDING)
    assert walker.scramble_phase(random_state=0).period == walker.period
    for endless in (walker.translating(), walker.scramble_period(random_state=0), walker.limit_lifetime(3, 0.1)):
        assert math.isinf(endless.period)


def test_start_phase(walker):
    later = walker.starting_at(0.25)
    assert_allclose(later.evaluate([0.0]), walker.evaluate([walker.period / 4]), atol=ROUNDING)
    drawn = walker.starting_at(None, random_state=3)
    assert drawn.start == walker.starting_at(None, random_state=3).start
    assert 0 < drawn.start < 1


# ---- scrambling


@given(seed=st.integers(0, 2**32 - 1), amount=st.floats(0, 1), how=st.sampled_from(SCRAMBLINGS))
def test_scrambling_position_keeps_motion_and_stays_inside(walker, seed, amount, how):
    scrambled = walker.scramble_position(amount, how=how, random_state=seed)
    assert_array_equal(scrambled.dots.coefficients[1:], walker.dots.coefficients[1:])
    assert_allclose(_about_mean(scrambled), _about_mean(walker), atol=ROUNDING)
    before, after = (path_reach(one.dots.coefficients).box for one in (walker, scrambled))
    slack = 1e-9 if how != "volume" else ROUNDING
    assert (after[0] >= before[0] - slack).all()
    assert (after[1] <= before[1] + slack).all()


def test_scrambling_position_moves_by_the_amount(walker):
    none, half, whole = (walker.scramble_position(amount, random_state=5) for amount in (0.0, 0.5, 1.0))
    assert_array_equal(none.dots.coefficients, walker.dots.coefficients)
    start, end = walker.dots.coefficients[0], whole.dots.coefficients[0]
    assert_allclose(half.dots.coefficients[0], (start + end) / 2, atol=ROUNDING)
    assert not np.allclose(start, end)


@pytest.mark.parametrize(
    ("how", "moved"), [("area", "xz"), ("horizontal", "x"), ("vertical", "z"), ("volume", "xyz"), ("y", "y")]
)
def test_scrambling_position_moves_along_its_axes(walker, how, moved):
    shifts = walker.scramble_position(how=how, random_state=0).dots.coefficients[0] - walker.dots.coefficients[0]
    for axis, name in enumerate("xyz"):
        assert (np.abs(shifts[:, axis]) > 1e-9).all() == (name in moved)


def test_scrambled_positions_are_even(walker):
    """Each dot is anywhere it fits with equal chance: 400 clones of each fill their room, thirds of it equally."""
    means = walker.add_mask(6000, random_state=0).dots.coefficients[0, 15:].reshape(400, 15, 3)  # clones, dots, axes
    reach = path_reach(walker.dots.coefficients)
    room = np.ptp(reach.box, axis=0) - (reach.highest - reach.lowest)
    for axis in (0, 2):
        assert_allclose(np.ptp(means[..., axis], axis=0), room[:, axis], rtol=0.05)
        thirds = (means[..., axis] - means[..., axis].min(axis=0)) / room[:, axis] * 3
        assert_allclose(np.bincount(thirds.astype(int).ravel(), minlength=3) / 6000, 1 / 3, atol=0.02)


@given(seed=st.integers(0, 2**32 - 1), amount=st.floats(0, 1))
def test_scrambling_phase_keeps_paths(walker, seed, amount):
    scrambled = walker.scramble_phase(amount, random_state=seed)
    assert_array_equal(scrambled.dots.coefficients, walker.dots.coefficients)
    assert_array_equal(scrambled.dots.frequencies, walker.dots.frequencies)
    assert (np.abs(scrambled.dots.phases) <= amount / 2).all()
    for dot in (0, 11):  # at its own time each dot is where it would have been
        shifted = scrambled.evaluate([0.3 - scrambled.dots.phases[dot] * walker.period])
        assert_allclose(shifted[0, dot], walker.evaluate([0.3])[0, dot], atol=ROUNDING)


def test_scrambling_period_keeps_paths(walker):
    scrambled = walker.scramble_period(1.0, random_state=0)
    assert_array_equal(scrambled.dots.coefficients, walker.dots.coefficients)
    factors = walker.dots.frequencies / scrambled.dots.frequencies
    assert ((factors >= 0.5) & (factors <= 2)).all()
    assert len(set(factors)) == 15
    assert_array_equal(walker.scramble_period(0.0).dots.frequencies, walker.dots.frequencies)


# ---- inversion


def test_whole_inversion_is_the_picture_upside_down(walker):
    for view in (walker, walker.seen_from(30, 25)):
        assert_allclose(view.inverted().frames(1, 60), view.frames(1, 60) * (1, -1), atol=ROUNDING)
        assert_allclose(view.inverted().inverted().frames(1, 60), view.frames(1, 60), atol=ROUNDING)


def test_local_inversion_keeps_positions_and_turns_motion(walker):
    local = walker.inverted(local=True)
    assert_array_equal(local.dots.coefficients[0], walker.dots.coefficients[0])
    assert_allclose(_about_mean(local), _about_mean(walker) * (1, -1), atol=ROUNDING)


# ---- masks


def test_mask_has_the_motion_of_the_walker(walker):
    masked = walker.add_mask(60, random_state=0)
    assert masked.is_mask.sum() == 60
    assert_array_equal(masked.frames(1, 60)[:, :15], walker.frames(1, 60))
    for clone in range(60):
        assert_array_equal(masked.dots.coefficients[1:, 15 + clone], walker.dots.coefficients[1:, clone % 15])
        assert masked.names[15 + clone] == f"mask{clone + 1}_{walker.names[clone % 15]}"
    speeds = np.linalg.norm(np.diff(masked.frames(walker.period, 600 / walker.period), axis=0), axis=2)
    own, others = (np.quantile(speeds[:, part], [0.1, 0.5, 0.9]) for part in (slice(15), slice(15, None)))
    assert_allclose(own, others, rtol=0.02)  # of 600 frames, at other phases


def test_mask_of_an_incomplete_round_clones_each_dot_once(walker):
    masked = walker.add_mask(20, random_state=0)
    counts = [sum(name.endswith(f"_{dot}") for name in masked.names[15:]) for dot in walker.names]
    assert sorted(counts) == [1] * 10 + [2] * 5


def test_mask_stays_in_its_area(walker):
    places = walker.add_mask(45, area=(2.0, 2.5), random_state=0).frames(walker.period, 200)[:, 15:]
    assert (np.abs(places).max(axis=(0, 1)) <= np.array([1.0, 1.25]) + 1e-4).all()
    assert (np.abs(places).max(axis=(0, 1)) > [0.8, 1.0]).all()
    within = walker.add_mask(45, random_state=0).frames(walker.period, 200)
    assert_allclose(within[:, 15:].min(axis=(0, 1)), within[:, :15].min(axis=(0, 1)), atol=0.15)
    assert (within[:, 15:].min(axis=(0, 1)) >= within[:, :15].min(axis=(0, 1)) - 1e-4).all()
    with pytest.raises(ValueError, match=r"area must have room .* at least .* got 0.1 x 0.1 m"):
        walker.add_mask(10, area=(0.1, 0.1))


def test_mask_in_step_and_of_another_display(walker):
    inverted = walker.inverted().starting_at(0.3)
    masked = walker.add_mask(15, source=inverted, phase=0.0, random_state=0)
    mask = masked.only([name for name in masked.names if name.startswith("mask")])
    assert_allclose(_about_mean(mask), _about_mean(inverted), atol=ROUNDING)
    twice = masked.add_mask(5, random_state=1)
    assert not any("mask" in name.split("_", 1)[1] for name in twice.names[30:])  # masks are not cloned
    assert twice.names[30].startswith("mask16_")


def test_masks_may_have_other_harmonics(walk, walker):
    few = PointLightDisplay.from_walk(walk, n_harmonics=1)
    joined = few.add_mask(15, source=walker, random_state=0)
    assert_array_equal(joined.dots.coefficients[:3, :15], few.dots.coefficients)
    assert_array_equal(joined.dots.coefficients[3:, :15], 0)
