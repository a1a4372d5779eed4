"""Sticks with round ends, by the part of each pixel that they cover."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.display.capsules import draw_capsules
from eigenwalker.display.discs import draw_discs

SIZE = (48, 40)


def _draw(*sticks, radius=2.0, size=SIZE, **options):
    ends = np.array([list(sticks)], dtype=float)
    return next(draw_capsules(ends, np.full(len(sticks), radius), size, **options)).copy()


@given(
    start=st.tuples(st.floats(10, 38), st.floats(10, 30)),
    end=st.tuples(st.floats(10, 38), st.floats(10, 30)),
    radius=st.floats(0.6, 6),
)
def test_sticks_have_their_area_and_place(start, end, radius):
    picture = _draw((start, end), radius=radius) / 255
    length = np.hypot(*np.subtract(end, start))
    area = np.pi * radius**2 + 2 * radius * length
    # Edges that are round or slanted are less than 0.1 off in each pixel that they cross.
    assert_allclose(picture.sum(), area, rtol=0.05, atol=0.4)
    rows, columns = np.mgrid[: SIZE[1], : SIZE[0]]
    middle = (picture * columns).sum() / picture.sum(), (picture * rows).sum() / picture.sum()
    assert_allclose(middle, np.add(start, end) / 2, atol=0.15)


def test_pixels_have_the_part_that_is_covered():
    """Against counting 10,000 points in each pixel."""
    start, end, radius = np.array([8.3, 9.1]), np.array([33.7, 27.4]), 2.6
    points = (np.arange(100) + 0.5) / 100 - 0.5
    x, y = ((np.arange(n)[:, np.newaxis] + points).ravel() for n in SIZE)
    along = np.clip(
        ((x - start[0]) * (end - start)[0] + (y[:, np.newaxis] - start[1]) * (end - start)[1])
        / ((end - start) ** 2).sum(),
        0,
        1,
    )
    inside = np.hypot(x - start[0] - along * (end - start)[0], y[:, np.newaxis] - start[1] - along * (end - start)[1])
    covered = (inside < radius).reshape(SIZE[1], 100, SIZE[0], 100).mean(axis=(1, 3))
    assert_allclose(_draw((start, end), radius=radius) / 255, covered, atol=0.085)


def test_a_stick_without_length_is_a_disc():
    place = (20.3, 17.8)
    disc = next(draw_discs(np.array([[place]]), 9.0, SIZE))
    assert_allclose(_draw((place, place), radius=4.5).astype(float), disc, atol=0.09 * 255)


def test_ends_have_no_order_and_parts_look_like_one_piece():
    a, b, c = (8.0, 8.0), (30.0, 12.0), (24.0, 33.0)
    assert_array_equal(_draw((a, b)), _draw((b, a)))
    assert_array_equal(_draw((a, b), (b, c)), np.maximum(_draw((a, b)), _draw((b, c))))
    assert_array_equal(_draw((a, b), (a, b)), _draw((a, b)))


def test_a_picture_is_a_window_on_a_larger_one():
    sticks = [((-9.0, 3.0), (60.0, 50.0)), ((20.0, -3.0), (22.0, -1.0)), ((1e9, 0.0), (1e9, 9.0))]
    small = _draw(*sticks, radius=3.0)
    moved = [tuple((x + 20, y + 20) for x, y in stick) for stick in sticks]
    assert_array_equal(small, _draw(*moved, radius=3.0, size=(88, 80))[20:60, 20:68])
    assert small.any()


def test_each_frame_is_drawn_anew_and_what_is_nowhere_is_not():
    ends = np.array([[[[9.0, 9.0], [20.0, 20.0]]], [[[np.nan, 9.0], [20.0, 20.0]]], [[[9.0, 30.0], [9.0, 30.0]]]])
    first, nowhere, last = (picture.copy() for picture in draw_capsules(ends, np.array([2.0]), SIZE))
    assert first.any()
    assert not nowhere.any()
    assert last[30, 9] == 255
    assert not last[:20].any()


@pytest.mark.parametrize(("ground", "ink"), [(16, 235), (255, 0)])
def test_grays_are_those_that_are_asked_for(ground, ink):
    picture = _draw(((9.0, 9.0), (20.0, 9.0)), ground=ground, ink=ink)
    assert picture[0, 0] == ground
    assert picture[9, 12] == ink
