"""The picture of a display: view, size, speed, dots, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from eigenwalker.display import PointLightDisplay, Screen
from eigenwalker.display.dots import Dots

ROUNDING = 1e-12  # metres


def test_views(walker):
    """From the front, from above, and against `project`."""
    frontal = walker.seen_from("frontal")
    names = walker.names
    front = frontal.evaluate([0.0])[0]
    assert front[names.index("left_hip"), 0] > front[names.index("right_hip"), 0]  # its left is the picture's right
    above = walker.seen_from(90, 90).evaluate([0.0])[0]
    side = walker.evaluate([0.0])[0]
    assert_allclose(above[:, 0], side[:, 0], atol=ROUNDING)
    assert_allclose(above[:, 1], front[:, 0], atol=ROUNDING)  # what is left of the walker is up
    for elevation in (0, 40, -40):
        axes = walker.seen_from(70, elevation).axes
        assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
        assert_allclose(np.linalg.det(axes), 1)
    assert walker.seen_from(0, 20).evaluate([0.0])[0, names.index("head"), 1] > 0


def test_translation_at_the_right_speed(walker):
    moving = walker.translating(start=-1.0)
    shift = moving.frames(2, 60) - walker.frames(2, 60)
    assert_allclose(shift[..., 0].T, np.tile(-1.0 + 1.3 * np.arange(120) / 60, (15, 1)), atol=ROUNDING)
    assert_allclose(shift[..., 1], 0, atol=ROUNDING)
    # On its head it goes the same way.
    assert_allclose(moving.inverted().frames(1, 60), moving.frames(1, 60) * (1, -1), atol=ROUNDING)


def test_unknown_speed_is_refused(walk):
    display = PointLightDisplay.from_walk(replace(walk, speed=float("nan")))
    with pytest.raises(ValueError, match=r"'anna': the walk's own speed is unknown; give translating\(speed="):
        display.translating()
    assert display.translating(0.5).dots.velocities[0, 0] == 0.5


@given(height=st.floats(1, 60), distance=st.floats(0.2, 5), pitch=st.floats(5e-5, 2e-3), pixels=st.integers(100, 4000))
def test_visual_angle(walker, height, distance, pitch, pixels):
    """The walker spans the angle it should, on the screen, measured with a ruler: to 0.1 %."""
    screen = Screen(distance=distance, pixel_pitch=pitch, size=(pixels, pixels))
    times = np.arange(720) * walker.period / 720
    places = walker.sized(height=height).evaluate(times, unit="px", screen=screen)
    top, bottom = places[..., 1].max() * pitch, places[..., 1].min() * pitch
    angle = np.rad2deg(np.arctan(top / distance) - np.arctan(bottom / distance))
    assert_allclose(angle, height, rtol=1e-3)
    degrees = walker.sized(height=height).evaluate(times, unit="deg")
    assert_allclose(screen.to_degrees(places), degrees, rtol=1e-9, atol=1e-12)


def test_life_size_at_a_distance(walker):
    degrees = walker.sized(distance=8.0).evaluate([0.1], unit="deg")
    assert_allclose(np.tan(np.deg2rad(degrees)) * 8.0, walker.evaluate([0.1]), atol=ROUNDING)


def test_known_angles_of_a_screen():
    screen = Screen(distance=1.0, pixel_pitch=0.001, size=(2000, 1000))
    assert_allclose(screen.extent, (90.0, 2 * np.rad2deg(np.arctan(0.5))))
    assert_allclose(screen.to_pixels([45.0, -45.0]), [1000, -1000])
    assert_allclose(screen.pixels_across(90.0), 2000)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"distance": 0}, "distance must be a number above 0, in metres, got 0"),
        ({"pixel_pitch": 0.27}, "pixel_pitch must be in metres"),
        ({"size": 640}, r"size must be \(width, height\) in pixels, got 640"),
        ({"size": (640, 0)}, "size must be a number of at least 1, got 0"),
        ({"size": (640, 1.5)}, "size must be a whole number, got 1.5"),
    ],
)
def test_screens_that_cannot_be(arguments, message):
    with pytest.raises(ValueError, match=message):
        Screen(**arguments)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda walker: walker.frames(0.001, 60), "at least one frame, got 0.001 s at 60 frames"),
        (lambda walker: walker.frames(-1, 60), "duration must be a number above 0, in seconds, got -1"),
        (lambda walker: walker.evaluate([0.0], unit="cm"), "unit must be one of 'm', 'deg', 'px', got 'cm'"),
        (lambda walker: walker.evaluate([[0.0]]), r"shape \(n_times,\), got shape \(1, 1\)"),
        (lambda walker: walker.scramble_position(1.5), "amount must be a number of at least 0 and at most 1, got 1.5"),
        (lambda walker: walker.scramble_position(how="w"), "how must be one of 'area', .* got 'w'"),
        (lambda walker: walker.scramble_period(-1), "amount must be a number of at least 0, got -1"),
        (lambda walker: walker.seen_from("behind"), "view must be one of frontal, half-profile, side or an azimuth"),
        (lambda walker: walker.seen_from(0, 100), "elevation must be .* at most 90, in degrees, got 100"),
        (lambda walker: walker.sized(), "give either height or distance"),
        (lambda walker: walker.sized(height=200), "height must be .* at most 170"),
        (lambda walker: walker.with_dots(0.2, "red"), "polarity must be one of 'light', 'dark', got 'red'"),
        (lambda walker: walker.add_mask(1.5), "n_dots must be a whole number, got 1.5"),
        (lambda walker: walker.add_mask(5, area=3), r"area must be \(width, height\) in metres, got 3"),
    ],
)
def test_bad_values_are_refused(walker, call, message):
    with pytest.raises(ValueError, match=message):
        call(walker)


def test_wrong_kinds_are_refused(walker):
    with pytest.raises(TypeError, match="unit='px' needs screen=Screen"):
        walker.frames(1, 60, unit="px")
    with pytest.raises(TypeError, match="amount must be a number of at least 0 and at most 1, got 'all'"):
        walker.scramble_phase("all")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"coefficients": np.zeros((2, 15, 3))}, "odd number of rows"),
        ({"coefficients": np.full((3, 15, 3), np.nan)}, "coefficients must be finite, got 135"),
        ({"phases": np.zeros(3)}, r"phases must have shape \(15\), got \(3,\)"),
        ({"frequencies": np.zeros(15)}, "frequencies must be positive, in hertz, got 0"),
    ],
)
def test_dots_that_cannot_be(walker, change, message):
    with pytest.raises(ValueError, match=message):
        replace(walker.dots, **change)
    with pytest.raises(ValueError, match="at least one dot"):
        Dots(np.zeros((3, 0, 3)), np.zeros(0), np.zeros(0), np.zeros((0, 3)), ())
