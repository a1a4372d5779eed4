"""Bodies frame by frame: where they are seen, how large, and what is drawn."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker._validation import WalkError
from eigenwalker.display import Screen, project
from eigenwalker.display.figures import FigureDisplay
from eigenwalker.motion.skeleton import TROJE15, MarkerSet
from eigenwalker.motion.walk import Walk


@pytest.fixture(scope="module")
def travelling(walk):
    """Return a walk that goes 1.3 m/s forward, a little to the left."""
    way = np.zeros((walk.n_frames, 1, 3))
    way[:, 0, :2] = np.arange(walk.n_frames)[:, np.newaxis] / walk.frame_rate * (1.3, 0.2)
    return replace(walk, positions=walk.positions + way)


@pytest.fixture(scope="module")
def display(travelling):
    return FigureDisplay.from_walk(travelling)


@pytest.mark.parametrize("azimuth", [0, 30, 90, -45, 200])
def test_markers_are_seen_by_orthographic_projection(display, travelling, azimuth):
    times = np.arange(travelling.n_frames) / travelling.frame_rate
    seen = display.seen_from(azimuth).evaluate(times)
    expected = project(travelling.positions, azimuth)[..., :2]
    shift = seen - expected
    assert_allclose(shift, np.broadcast_to(shift[0, 0], shift.shape), atol=1e-12)  # the camera holds still
    assert_allclose(seen.max(axis=(0, 1)), -seen.min(axis=(0, 1)), atol=1e-12)  # and has all of it in the middle


def test_between_frames_markers_go_straight_and_stand_still_beyond(display, travelling):
    rate = travelling.frame_rate
    before, after = display.evaluate([3 / rate, 4 / rate])
    assert_allclose(display.evaluate([3.25 / rate])[0], 0.75 * before + 0.25 * after, atol=1e-12)
    last = display.evaluate([display.duration, 1e9, (travelling.n_frames - 1) / rate])
    assert_array_equal(last[0], last[1])
    assert_allclose(last[0], last[2], atol=1e-12)
    assert_array_equal(display.evaluate([-5.0]), display.evaluate([0.0]))


def test_a_fixed_middle_is_in_the_middle(display):
    held = replace(display, middle=(1.0, 2.0, 0.9))
    head = display.marker_set.index("head")
    for azimuth in (0, 90):
        expected = project(display.positions[0, head] - (1.0, 2.0, 0.9), azimuth)[:2]
        assert_allclose(held.seen_from(azimuth).evaluate([0.0])[0, head], expected, atol=1e-12)


def test_size_in_degrees_is_that_of_the_body(display):
    screen = Screen(distance=0.8)
    scale = display.sized(6.0).pixels_per_meter(screen)
    assert_allclose(scale * display.body_height, screen.pixels_across(6.0))
    heights = display.positions[..., 2]
    assert display.body_height == heights.max() - heights.min()
    assert replace(display, body_height=1.5).body_height == 1.5


@pytest.mark.parametrize("figure", ["sticks", "dots"])
@pytest.mark.parametrize("azimuth", [0, 90])
def test_without_a_size_all_of_it_fills_nine_tenths(display, figure, azimuth):
    screen = Screen(size=(600, 400))
    shown = display.drawn_as(figure).seen_from(azimuth)
    filled = shown.pixels_per_meter(screen) * shown.extent / screen.size
    assert_allclose(filled.max(), 0.9)


def test_the_extent_has_room_for_what_is_drawn(walk):
    """A head at the top reaches half its diameter higher than its marker."""
    display = FigureDisplay.from_walk(walk)
    heights = display.positions[..., 2]
    middle = (heights.max() + heights.min()) / 2
    top = display.positions[:, display.marker_set.index("head"), 2].max() - middle
    assert_allclose(display.extent[1], 2 * (top + 0.0625 * display.body_height), rtol=1e-6)


def test_parts_are_sticks_and_a_head_or_dots(display):
    screen = Screen()
    assert_array_equal(display.parts[-1], [0, 0])  # the head
    assert len(display.parts) == len(TROJE15.sticks) + 1
    scale = 100.0 / display.body_height
    assert_allclose(display.widths(screen, scale), [2.4] * len(TROJE15.sticks) + [12.5])
    dots = display.drawn_as("dots")
    assert_array_equal(dots.parts, np.repeat(np.arange(15), 2).reshape(-1, 2))
    assert_allclose(dots.widths(screen, scale), [2.5] * 15)
    assert_allclose(display.drawn_as("dots", dot_diameter=0.5).widths(screen, scale), [screen.pixels_across(0.5)] * 15)


def test_size_that_was_taken_out_is_put_back(walk):
    small = replace(walk, positions=walk.positions / 1.7, size=1.7)
    assert_allclose(FigureDisplay.from_walk(small).evaluate([0.1]), FigureDisplay.from_walk(walk).evaluate([0.1]))


def test_displays_are_values(display):
    again = pickle.loads(pickle.dumps(display))
    assert_array_equal(again.evaluate([0.5]), display.evaluate([0.5]))
    assert not again.positions.flags.writeable
    assert repr(display) == f"<FigureDisplay 'anna': sticks, {display.duration:.3g} s>"
    assert display.seen_from("frontal").azimuth == 0


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"figure": "cartoon"}, "figure must be one of 'sticks', 'dots', got 'cartoon'"),
        ({"azimuth": np.nan}, "azimuth must be a number, in degrees"),
        ({"height": 0}, "height must be a number above 0 and at most 90, in degrees of visual angle, got 0"),
        ({"dot_diameter": 99}, "dot_diameter must be a number"),
        ({"body_height": -1}, "body_height must be a number above 0, in metres, got -1"),
        ({"middle": (1, 2)}, r"middle must have shape \(3\), got"),
        ({"frame_rate": 0}, "frame_rate must be positive"),
        (
            {"positions": np.zeros((0, 15, 3))},
            r"positions must be finite, of one frame or more, got shape \(0, 15, 3\)",
        ),
        ({"positions": np.full((2, 15, 3), np.nan)}, "positions must be finite"),
        ({"positions": np.zeros((2, 15, 3)), "body_height": np.nan}, "'anna': expected a body of some height"),
        ({"marker_set": MarkerSet(tuple("abcdefghijklmno"))}, "'anna': expected a head or sticks to draw, got neither"),
    ],
)
def test_wrong_values_are_refused(display, changes, said):
    with pytest.raises(ValueError, match=said):
        replace(display, **changes)


def test_wrong_walks_and_times_are_refused(display, walk):
    with pytest.raises(WalkError, match="expected finite values"):
        FigureDisplay.from_walk(Walk(np.full((3, 15, 3), np.nan), 60))
    with pytest.raises(TypeError, match="expected a Walk"):
        FigureDisplay.from_walk(walk.positions)
    with pytest.raises(ValueError, match="times must be finite and have shape"):
        display.evaluate([np.nan])
    with pytest.raises(ValueError, match="view must be one of frontal"):
        display.seen_from("above")


def test_markers_without_sticks_are_shown_as_dots(display):
    plain = replace(display, figure="dots", marker_set=MarkerSet(tuple("abcdefghijklmno")))
    assert len(plain.parts) == 15
