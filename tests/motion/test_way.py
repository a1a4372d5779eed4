"""Ways over the floor."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from eigenwalker import WalkError
from eigenwalker.motion.way import find_way

LENGTHS = np.linspace(-3, 25, 561)
PATH = np.array([[0.0, 0.0], [2.0, 0.5], [4.0, -0.5], [5.0, 2.0], [3.0, 4.0]])


def _ways():
    return [
        find_way(),
        find_way(heading=2.1),
        find_way(curvature=0.25),
        find_way(heading=-1.0, curvature=-0.4),
        find_way(path=[[1.0, 2.0], [3.0, -1.0]]),
        find_way(path=PATH),
    ]


@pytest.mark.parametrize("way", _ways())
def test_ways_go_by_length_where_they_lead(way):
    """The derivative of the place is the direction, a unit vector, to what differences and 64 samples leave."""
    places, angles = way.place(LENGTHS), way.direction(LENGTHS)
    middle = way.direction((LENGTHS[1:] + LENGTHS[:-1]) / 2)
    steps = np.diff(places, axis=0) / np.diff(LENGTHS)[:, np.newaxis]
    assert_allclose(steps, np.column_stack((np.cos(middle), np.sin(middle))), atol=4e-3)
    assert np.abs(np.diff(angles)).max() < 0.3  # no jumps


def test_straight_ways():
    assert_allclose(find_way().place(LENGTHS), np.outer(LENGTHS, [1.0, 0.0]))
    assert_allclose(find_way().direction(LENGTHS), 0.0)
    way = find_way(heading=np.pi / 2)
    assert_allclose(way.place(LENGTHS), np.outer(LENGTHS, [0.0, 1.0]), atol=1e-12)
    assert_allclose(way.direction(LENGTHS), np.pi / 2)


@given(curvature=st.floats(-2, 2), heading=st.floats(-4, 4))
def test_arcs_have_their_radius_and_their_length(curvature, heading):
    way = find_way(heading=heading, curvature=curvature)
    assert_allclose(way.place(np.zeros(1)), 0.0)
    assert_allclose(way.direction(np.array([0.0, 3.0])), [heading, heading + 3 * curvature])
    if abs(curvature) > 1e-3:
        center = np.array([-np.sin(heading), np.cos(heading)]) / curvature  # to the left
        away = np.linalg.norm(way.place(LENGTHS) - center, axis=1)
        assert_allclose(away, 1 / abs(curvature), rtol=1e-9)
        assert_allclose(way.place(np.array([2 * np.pi / curvature])), 0.0, atol=1e-9)  # round it once


def test_nearly_straight_is_straight():
    assert_allclose(find_way(curvature=1e-9).place(LENGTHS), find_way().place(LENGTHS), atol=1e-6)


def test_paths_lead_through_their_points():
    way = find_way(path=PATH)
    lengths = np.linspace(0, 20, 20_001)
    places = way.place(lengths)
    for point in PATH:
        assert np.linalg.norm(places - point, axis=1).min() < 1e-3
    assert_allclose(way.place(np.zeros(1))[0], PATH[0], atol=1e-12)
    chords = np.linalg.norm(np.diff(PATH, axis=0), axis=1).sum()
    end = lengths[np.linalg.norm(places - PATH[-1], axis=1).argmin()]
    assert chords < end < 1.2 * chords


def test_beyond_their_ends_paths_are_straight():
    way = find_way(path=PATH)
    for lengths in (np.array([-5.0, -3.0, -1.0]), np.array([15.0, 18.0, 21.0])):
        angles, places = way.direction(lengths), way.place(lengths)
        assert_allclose(angles, angles[0])
        step = (lengths[1] - lengths[0]) * np.array([np.cos(angles[0]), np.sin(angles[0])])
        assert_allclose(np.diff(places, axis=0), [step, step], atol=1e-12)


def test_a_path_of_two_points_is_the_line_through_them():
    way = find_way(path=[[1.0, 1.0], [1.0, 3.0]])
    assert_allclose(way.place(LENGTHS), 1.0 + np.outer(LENGTHS, [0.0, 1.0]), atol=1e-12)
    assert_allclose(way.direction(LENGTHS), np.pi / 2)


def test_rigid_things_stay_rigid():
    way = find_way(path=PATH)
    points = np.random.default_rng(0).normal(size=(5, 3))
    bent, angles = way.bend(points, np.full(5, 2.5))
    assert_allclose(np.linalg.norm(bent - bent[0], axis=1), np.linalg.norm(points - points[0], axis=1))
    assert_allclose(angles, way.direction(np.full(5, 2.5)))
    straight, angles = find_way().bend(points, LENGTHS[:5])
    assert_allclose(straight, points)
    assert_allclose(angles, 0.0)


def test_wrong_ways_are_refused():
    with pytest.raises(ValueError, match="heading must be finite, got nan"):
        find_way(heading=np.nan)
    with pytest.raises(ValueError, match="curvature must be finite, got inf"):
        find_way(curvature=np.inf)
    with pytest.raises(ValueError, match="give either path, or heading and curvature"):
        find_way(path=PATH, curvature=0.1)
    with pytest.raises(ValueError, match=r"path must have shape \(n_points, 2\), got \(5, 3\)"):
        find_way(path=np.zeros((5, 3)))
    for path in (PATH[:1], np.zeros((0, 2)), [[0, 0], [1, 0], [1, 0]]):
        with pytest.raises(ValueError, match="path must have two points or more, each different"):
            find_way(path=path)
    with pytest.raises(WalkError, match="expected finite values"):
        find_way(path=[[0, 0], [np.nan, 1]])
