"""Dots of limited lifetime."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.display.lifetime import Lifetime, lit_dots


@given(n_dots=st.integers(2, 20), data=st.data(), duration=st.floats(0.02, 1.0), seed=st.integers(0, 2**32 - 1))
def test_as_many_dots_as_wanted_are_lit_each_for_its_time(n_dots, data, duration, seed):
    n_visible = data.draw(st.integers(1, n_dots - 1))
    renewals = np.arange(4 * n_visible + 1)
    middles = (renewals + 0.5) * duration / n_visible
    lit = lit_dots(middles, Lifetime(0, n_dots, n_visible, duration, seed))
    assert (lit.sum(axis=1) == n_visible).all()
    assert ((lit[1:] & ~lit[:-1]).sum(axis=1) == 1).all()  # one is born at a time
    for renewal, dot in zip(*np.nonzero(lit[1:] & ~lit[:-1]), strict=True):
        life = lit[renewal + 1 : renewal + 1 + n_visible, dot]
        assert life.all()
        if renewal + 1 + n_visible < len(lit):
            assert not lit[renewal + 1 + n_visible, dot]


def test_all_dots_are_lit_equally_often():
    lit = lit_dots(np.arange(20000) * 0.05, Lifetime(0, 10, 3, 0.15, seed=0))
    assert_allclose(lit.mean(axis=0), 0.3, atol=0.02)


def test_renewals_meet_the_frames_that_they_fall_on():
    """0.04 s apart at 50 frames a second is every second frame, whatever the rounding of the times."""
    lit = lit_dots(np.arange(1000) / 50, Lifetime(0, 9, 5, 0.2, seed=0))
    changes = np.flatnonzero((lit[1:] != lit[:-1]).any(axis=1)) + 1
    assert_array_equal(changes, np.arange(2, 1000, 2))


def test_limited_lifetime_hides_dots_and_moves_none(walker):
    limited = walker.limit_lifetime(4, 0.2, random_state=0)
    places, all_places = limited.frames(2, 60), walker.frames(2, 60)
    lit = ~np.isnan(places).any(axis=2)
    assert (lit.sum(axis=1) == 4).all()
    assert_array_equal(places[lit], all_places[lit])
    masked = limited.add_mask(30, random_state=1)
    assert not np.isnan(masked.frames(1, 60)[:, 15:]).any()
    apart = masked.limit_lifetime(10, 0.2, random_state=2).frames(1, 60)
    assert (np.isfinite(apart[:, 15:, 0]).sum(axis=1) == 10).all()
    assert (np.isfinite(apart[:, :15, 0]).sum(axis=1) == 4).all()


def test_lifetimes_that_cannot_be_are_refused(walker):
    limited = walker.limit_lifetime(4, 0.2)
    with pytest.raises(ValueError, match="at least two dots that have none yet, got 0"):
        limited.limit_lifetime(2, 0.1)
    with pytest.raises(ValueError, match="n_visible must be a number of at least 1 and at most 14, got 15"):
        walker.limit_lifetime(15, 0.1)
    with pytest.raises(ValueError, match="limit their lifetime afterwards"):
        limited.only(["head"])
    with pytest.raises(ValueError, match=r"not be negative .* got -1 s"):
        limited.evaluate([-1.0])
