"""Displays from one flat set of parameters."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.display import make_display


def test_conditions_are_the_methods(walk, walker):
    display = make_display(
        walk,
        view="half-profile",
        elevation=5,
        height=6,
        dot_diameter=0.3,
        polarity="dark",
        inversion="local",
        start_phase=0.4,
        markers="head left_ankle",
    )
    expected = walker.only(["head", "left_ankle"]).seen_from(30, 5).sized(height=6).inverted(local=True)
    expected = expected.with_dots(0.3, "dark").starting_at(0.4)
    assert_array_equal(display.frames(1, 60, unit="deg"), expected.frames(1, 60, unit="deg"))
    assert (display.dot_diameter, display.polarity) == (0.3, "dark")


def test_steps_of_a_condition_have_streams_of_their_own(walk):
    plain = make_display(walk, scramble_position=1.0, random_state=3)
    more = make_display(walk, scramble_position=1.0, scramble_phase=0.0, n_mask_dots=20, random_state=3)
    assert_array_equal(plain.frames(1, 60), more.frames(1, 60)[:, :15])
    limited = make_display(walk, scramble_position=1.0, n_visible=5, lifetime=0.1, random_state=3).frames(1, 60)
    assert_array_equal(limited[np.isfinite(limited)], plain.frames(1, 60)[np.isfinite(limited)])
    moving = make_display(walk, translating=True, speed=1.0, start_ahead=-2.0)
    assert_allclose((moving.evaluate([2.0]) - make_display(walk).evaluate([2.0])).max(axis=(0, 1)), 0, atol=1e-12)


def test_conditions_that_cannot_be(walk):
    with pytest.raises(ValueError, match="n_visible and lifetime go together"):
        make_display(walk, n_visible=3)
    with pytest.raises(ValueError, match="mask_width and mask_height go together"):
        make_display(walk, n_mask_dots=3, mask_width=2.0)
    with pytest.raises(ValueError, match="inversion must be one of 'none', 'whole', 'local', got 'upside down'"):
        make_display(walk, inversion="upside down")
