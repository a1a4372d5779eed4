"""Directions over the floor: where a walk leads, where it faces, and turning it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from eigenwalker import WalkError
from eigenwalker.motion import TROJE15, MarkerSet, Walk
from eigenwalker.motion.heading import (
    check_in_place,
    facing,
    first_direction,
    floor_velocity,
    leftward,
    one_stride,
    swing,
    travels,
    turn,
    turn_points,
)
from tests.recordings import over_the_floor, turned
from tests.synthetic import make_walk

ANGLES = st.floats(-np.pi, np.pi)


def _direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def _still(seed=0, **options):
    return make_walk(np.random.default_rng(seed), name="anna", **options)[0]


@given(angle=ANGLES, length=st.floats(0.01, 10.0))
def test_a_direction_becomes_x(angle, length):
    direction = length * _direction(angle)
    assert_allclose(turn_points(direction, direction), [length, 0.0], atol=1e-12)


@given(angle=ANGLES)
def test_turning_back_gives_the_walk(angle):
    walk = _still()
    there = turn(walk, _direction(angle))
    assert_allclose(turn(there, _direction(-angle)).positions, walk.positions, atol=1e-12)
    assert_allclose(there.positions[..., 2], walk.positions[..., 2])
    assert_allclose(
        np.diff(there.positions, axis=1)[..., :2] ** 2 @ [1, 1],
        np.diff(walk.positions, axis=1)[..., :2] ** 2 @ [1, 1],
        atol=1e-12,
    )


def test_each_frame_can_turn_by_itself():
    walk = _still()
    angles = np.linspace(0.0, 2.0, walk.n_frames)
    turned_all = turn(walk, np.column_stack((np.cos(angles), np.sin(angles))))
    for frame in (0, 100, walk.n_frames - 1):
        alone = turn(replace(walk, positions=walk.positions[frame : frame + 1]), _direction(angles[frame]))
        assert_allclose(turned_all.positions[frame], alone.positions[0], atol=1e-12)


@pytest.mark.parametrize("degrees", [0.0, 37.0, 180.0, -100.0])
def test_directions_turn_with_the_walk(degrees):
    walk = _still()
    angle = np.deg2rad(degrees)
    for find in (lambda w: swing(w, 0.93), lambda w: facing(w, 0.93)):
        assert_allclose(turn_points(find(turned(walk, degrees)), _direction(angle)), find(walk), atol=1e-12)
    moving = over_the_floor(walk)
    assert_allclose(turn_points(first_direction(turned(moving, degrees)), _direction(angle)), first_direction(moving))
    assert_allclose(floor_velocity(turned(moving, degrees)), 1.3 * _direction(angle), atol=0.02)


def test_directions_do_not_depend_on_where_the_walk_ends():
    """Means over frames would hold a part of a stride, and be off by some 1e-4."""
    walk = _still(n_cycles=4.0)
    found = [
        np.concatenate((swing(part, 0.93), facing(part, 0.93)))
        for part in (replace(walk, positions=walk.positions[first:last]) for first, last in ((0, None), (17, 300)))
    ]
    assert_allclose(found[0], found[1], atol=1e-12)


def test_one_stride_is_without_noise_and_ends():
    times = np.arange(300) / 100
    paths = np.column_stack((3 + np.sin(2 * np.pi * 0.9 * times), np.cos(4 * np.pi * 0.9 * times)))
    stride = one_stride(paths, 100.0, 0.9)
    assert_allclose(stride.mean(axis=0), [3.0, 0.0], atol=1e-12)
    assert_allclose((stride - [3, 0]).std(axis=0), np.sqrt([0.5, 0.5]))


def test_front_and_back_are_told_by_left_and_right():
    walk = _still()
    backward = replace(walk, positions=walk.positions[:, TROJE15.mirror])  # the sides change places, nothing else
    assert swing(walk, 0.93)[0] > 0.99
    assert swing(backward, 0.93)[0] < -0.99


@pytest.mark.parametrize(("speed", "moves"), [(0.0, False), (0.1, False), (0.2, True), (1.3, True)])
def test_slow_drift_is_no_travel(speed, moves):
    walk = over_the_floor(_still(), speed=speed)
    assert travels(walk) == moves
    if moves:
        with pytest.raises(WalkError, match=r"'anna': expected a walk in place, got one that travels at .* m/s"):
            check_in_place(walk)
    else:
        check_in_place(walk)


def test_speed_is_in_meters_whatever_the_size():
    walk = over_the_floor(_still(), speed=0.2)
    small = replace(walk, positions=walk.positions / 1.6, size=1.6)
    assert_allclose(floor_velocity(small), floor_velocity(walk))
    assert travels(small)


def test_shoulders_count_in_pairs():
    names = ("left_hip", "right_hip", "left_shoulder", "right_shoulder")
    positions = np.array([[[0, 0.1, 1], [0, -0.1, 1], [0.02, 0.2, 1.4], [-0.02, -0.2, 1.4]]])
    assert_allclose(leftward(Walk(positions, 60.0, MarkerSet(names))), [[0.04, 0.6]])
    assert_allclose(leftward(Walk(positions[:, :3], 60.0, MarkerSet(names[:3]))), [[0.0, 0.2]])


def test_hips_in_one_place_face_nowhere():
    walk = _still()
    positions = walk.positions.copy()
    positions[:, TROJE15.index("left_hip")] = positions[:, TROJE15.index("right_hip")]
    with pytest.raises(WalkError, match=r"'anna': left and right hip are in one place.*heading other than 'body'"):
        facing(replace(walk, positions=positions), 0.93)
