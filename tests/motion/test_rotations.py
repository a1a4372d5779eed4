"""Exponential maps."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from eigenwalker.motion import euler_from_rotvec, forward_kinematics, rotvec_from_euler, unroll_rotvec
from eigenwalker.motion.rotations import rotvec_from_channels, turn_frames

_angles = st.lists(st.floats(-7, 7), min_size=3, max_size=3)


@settings(deadline=None)
@given(angles=_angles, order=st.permutations("XYZ"))
def test_euler_agrees_with_scipy(angles, order):
    order = "".join(order)
    expected = Rotation.from_euler(order, angles).as_matrix()
    assert_allclose(Rotation.from_rotvec(rotvec_from_euler(angles, order)).as_matrix(), expected, atol=1e-12)
    assert np.linalg.norm(rotvec_from_euler(angles, order)) <= np.pi + 1e-12


@settings(deadline=None)
@given(angles=_angles)
def test_orders_with_fewer_or_repeated_axes_are_products(angles):
    first, second, third = (Rotation.from_euler(axis, angle) for axis, angle in zip("XZX", angles, strict=True))
    made = Rotation.from_rotvec(rotvec_from_euler(angles, "XZX")).as_matrix()
    assert_allclose(made, (first * second * third).as_matrix(), atol=1e-12)
    assert_allclose(rotvec_from_euler(angles[:1], "Y")[[0, 2]], 0)
    assert_allclose(rotvec_from_euler(np.zeros((5, 0)), ""), np.zeros((5, 3)))


# Quarter turns of the middle axis bring the two others together.
_any_turns = st.lists(st.floats(-7, 7) | st.integers(-8, 8).map(lambda n: n * np.pi / 4), min_size=3, max_size=3)
_orders = st.permutations("XYZ").map("".join)


@settings(deadline=None)
@given(angles=_any_turns, order=_orders, other=_orders)
def test_euler_angles_of_a_rotation_make_it_again(angles, order, other):
    rotvec = rotvec_from_euler(angles, order)
    again = rotvec_from_euler(euler_from_rotvec(rotvec, other), other)
    expected = Rotation.from_euler(order, angles).as_matrix()
    assert_allclose(Rotation.from_rotvec(again).as_matrix(), expected, atol=1e-8)  # 1e-9 is given up at gimbal lock


@settings(deadline=None)
@given(order=_orders, seed=st.integers(0, 10_000), reach=st.floats(0.1, 10))
def test_smooth_angles_come_back_through_gimbal_lock(order, seed, reach):
    """Angles that start near zero and move by small steps, as far as they like: the nearest ones are the same."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, 2000)[:, np.newaxis, np.newaxis]
    start = rng.uniform(-0.5, 0.5, (4, 3))
    smooth = start + reach * t * rng.normal(size=(4, 3)) + 0.3 * np.sin(2 * np.pi * t * rng.integers(1, 4, (4, 3)))
    assert_allclose(euler_from_rotvec(rotvec_from_euler(smooth, order), order), smooth, atol=1e-6)


@settings(deadline=None)
@given(order=_orders, seed=st.integers(0, 10_000))
def test_euler_angles_are_the_nearest_ones(order, seed):
    """No other angles of the same rotation are nearer to those of the frame before."""
    turns = Rotation.random(20, rng=np.random.default_rng(seed)).as_rotvec()
    angles = euler_from_rotvec(turns, order)
    other = angles * [1, -1, 1] + np.pi  # the other family
    full = 2 * np.pi * np.array(list(itertools.product((-1, 0, 1), repeat=3)))
    before = np.vstack([np.zeros(3), angles[:-1]])
    for now, family, last in zip(angles, other, before, strict=True):
        rivals = np.vstack([now + full, family + full - 2 * np.pi * np.round((family - last) / (2 * np.pi))])
        assert np.linalg.norm(now - last) <= np.linalg.norm(rivals - last, axis=1).min() + 1e-9


def test_a_free_angle_at_gimbal_lock_stays():
    turns = rotvec_from_euler([[0.2, np.pi / 2 - 0.1, 0.4], [0.2, np.pi / 2, 0.4], [0.2, np.pi / 2, 0.4]], "ZXY")
    assert_allclose(euler_from_rotvec(turns, "ZXY")[1:], [[0.2, np.pi / 2, 0.4]] * 2, atol=1e-9)


def test_shapes_of_euler_angles():
    assert_allclose(euler_from_rotvec([0, 0, 0.5], "ZXY"), [0.5, 0, 0], atol=1e-15)
    assert euler_from_rotvec(np.zeros((4, 2, 5, 3)), "XYZ").shape == (4, 2, 5, 3)
    assert euler_from_rotvec(np.zeros((0, 2, 3)), "XYZ").shape == (0, 2, 3)


def _quaternions(rotvec):
    """Return the quaternions of exponential maps of any length, shape (..., 4)."""
    angle = np.linalg.norm(rotvec, axis=-1, keepdims=True)
    return np.concatenate((np.cos(angle / 2), np.sinc(angle / (2 * np.pi)) / 2 * rotvec), axis=-1)


def _same_turns(one, other):
    """Return how far the rotations of two arrays of exponential maps differ, as quaternions up to their sign."""
    p, q = _quaternions(one), _quaternions(other)
    return np.minimum(np.abs(p - q).max(axis=-1), np.abs(p + q).max(axis=-1)).max()


_steps = st.lists(st.floats(-3.1, 3.1), min_size=2, max_size=60)  # below half a turn a frame


@given(steps=_steps, start=st.floats(-3.1, 3.1), seed=st.integers(0, 10_000))
def test_turns_about_one_axis_are_unrolled_however_many(steps, start, seed):
    """Each step is the true angle, through any number of full turns; the true angles start below half a turn."""
    axis = np.random.default_rng(seed).normal(size=3)
    axis /= np.linalg.norm(axis)
    angles = np.cumsum([start, *steps])
    wrapped = (np.mod(angles + np.pi, 2 * np.pi) - np.pi)[:, np.newaxis] * axis
    unrolled = unroll_rotvec(wrapped[:, np.newaxis])[:, 0]
    assert_allclose(unrolled, angles[:, np.newaxis] * axis, atol=1e-9)
    lengths = np.linalg.norm(np.diff(unrolled, axis=0), axis=1)
    assert (lengths <= np.abs(steps) + 1e-9).all()
    assert _same_turns(unrolled, wrapped) < 1e-12


@given(seed=st.integers(0, 10_000), n_frames=st.integers(1, 80), reach=st.floats(0.01, 3.0))
def test_unrolled_maps_are_the_nearest_of_the_same_rotations(seed, n_frames, reach):
    """The axis turns as well. No other map of the same rotation is nearer to that of the frame before."""
    steps = reach * np.random.default_rng(seed).uniform(-1, 1, size=(n_frames, 2, 3)) / np.sqrt(3)
    turns, frames = [Rotation.random(2, rng=np.random.default_rng(seed))], []
    for step in steps:
        turns.append(turns[-1] * Rotation.from_rotvec(step))
    frames = np.stack([turn.as_rotvec() for turn in turns])
    unrolled = unroll_rotvec(frames)
    assert _same_turns(unrolled, frames) < 1e-12
    assert_allclose(unrolled[0], frames[0])
    angles = np.linalg.norm(unrolled, axis=-1, keepdims=True)
    rivals = unrolled + 2 * np.pi * np.arange(-4, 5)[:, np.newaxis, np.newaxis, np.newaxis] * unrolled / angles
    gained = np.linalg.norm(rivals[:, 1:] - unrolled[:-1], axis=-1)
    assert (np.linalg.norm(np.diff(unrolled, axis=0), axis=-1) <= gained + 1e-9).all()


@given(seed=st.integers(0, 10_000))
def test_smooth_motion_far_from_a_full_turn_has_no_jump(seed):
    """Through half a turn about any axis. The map stretches across its axis, by at most (r / 2) / sin(r / 2)."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    wobble = 0.02 * rng.normal(size=(400, 3)).cumsum(axis=0) / 20
    smooth = np.linspace(2.0, 4.5, 400)[:, np.newaxis] * axis + wobble
    wrapped = Rotation.from_rotvec(smooth).as_rotvec()
    unrolled = unroll_rotvec(wrapped[:, np.newaxis])[:, 0]
    assert _same_turns(unrolled, smooth) < 1e-12
    steps = np.linalg.norm(np.diff(unrolled, axis=0), axis=1)
    turns = Rotation.from_rotvec(wrapped)
    true = (turns[:-1].inv() * turns[1:]).magnitude()
    largest = np.linalg.norm(unrolled, axis=1).max() / 2
    assert (steps <= true * largest / np.sin(largest) * 1.01 + 1e-9).all()


def test_past_a_full_turn_aside_no_map_is_near():
    """All directions are one rotation at a full turn, so that a way past it may have to jump: to the nearest, still."""
    turns = np.array([[[0, 0, 2 * np.pi - 0.2]], [[0, 0.1, 0]]])
    assert_allclose(unroll_rotvec(turns), turns)


def test_standing_still_at_full_turns_keeps_the_axis():
    turns = np.array([[[0, 0, 2 * np.pi - 0.1]], [[0, 0, 0]], [[0, 0, 0]], [[0, 0, 0.1]]])
    assert_allclose(unroll_rotvec(turns)[:, 0, 2], 2 * np.pi + np.array([-0.1, 0, 0, 0.1]))
    small = np.array([[[0, 0, 0.2]], [[0, 0, 0]], [[0, -0.1, 0]]])
    assert_allclose(unroll_rotvec(small), small)


@given(seed=st.integers(0, 10_000), n_frames=st.integers(1, 30))
def test_turned_frames_are_products(seed, n_frames):
    """A R B of scipy, then unrolled; and back with the transposes."""
    rng = np.random.default_rng(seed)
    rotations = rng.normal(size=(1, 4, 3)) + 0.3 * rng.normal(size=(n_frames, 4, 3)).cumsum(axis=0)
    before, after = (Rotation.random(4, rng=rng).as_matrix() for _ in range(2))
    expected = np.empty_like(rotations)
    for joint in range(4):
        left, right = Rotation.from_matrix(before[joint]), Rotation.from_matrix(after[joint])
        expected[:, joint] = (left * Rotation.from_rotvec(rotations[:, joint]) * right).as_rotvec()
    got = turn_frames(rotations, before, after)
    assert _same_turns(got, expected) < 1e-12
    assert np.linalg.norm(got[0], axis=1).max() <= np.pi + 1e-12
    assert_allclose(unroll_rotvec(got), got, atol=1e-12)  # nothing is left to unroll
    back = turn_frames(got, before.transpose(0, 2, 1), after.transpose(0, 2, 1))
    assert _same_turns(back, rotations) < 1e-12


def test_frames_turned_by_nothing_stay():
    rotations = np.array([[[0.2, -0.1, 3.0]], [[0.2, -0.1, 3.3]], [[0.2, -0.1, 6.0]]])
    same = np.eye(3)[np.newaxis]
    assert_allclose(turn_frames(rotations, same, same), rotations, atol=1e-12)
    assert turn_frames(np.zeros((0, 1, 3)), same, same).shape == (0, 1, 3)
    quarter = Rotation.from_rotvec([[0, 0, np.pi / 2]]).as_matrix()
    assert_allclose(turn_frames(np.zeros((1, 1, 3)), quarter, same), [[[0, 0, np.pi / 2]]], atol=1e-15)


def test_small_angles_keep_their_digits():
    turns = np.array([[[1e-5, -2e-5, 3e-9]], [[1e-12, 0, 0]], [[0, 0, 0]]])
    _, frames = forward_kinematics(turns, np.zeros((3, 1, 3)), np.array([-1]))
    assert_allclose(frames[:, 0], Rotation.from_rotvec(turns[:, 0]).as_matrix(), atol=1e-16, rtol=1e-12)


def test_forward_kinematics_is_the_product_down_the_tree():
    rng = np.random.default_rng(0)
    turns, local, parents = rng.normal(size=(4, 5, 3)), rng.normal(size=(4, 5, 3)), np.array([-1, 0, 1, 1, 3])
    positions, frames = forward_kinematics(turns, local, parents)
    for t in range(4):
        matrix, place = {-1: np.eye(3)}, {-1: np.zeros(3)}
        for joint, parent in enumerate(parents):
            place[joint] = place[parent] + matrix[parent] @ local[t, joint]
            matrix[joint] = matrix[parent] @ Rotation.from_rotvec(turns[t, joint]).as_matrix()
            assert_allclose(positions[t, joint], place[joint], atol=1e-12)
            assert_allclose(frames[t, joint], matrix[joint], atol=1e-12)


def test_wrong_input_is_refused():
    with pytest.raises(ValueError, match="order must consist of X, Y and Z, got 'xyz'"):
        rotvec_from_euler([1, 2, 3], "xyz")
    with pytest.raises(ValueError, match="angles must have 3 entries in the last axis"):
        rotvec_from_euler([1, 2], "XYZ")
    with pytest.raises(ValueError, match=r"rotvec must have shape \(n_frames, ..., 3\), got \(3,\)"):
        unroll_rotvec([1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="order must have X, Y and Z once each, got 'XYX'"):
        euler_from_rotvec([1.0, 2.0, 3.0], "XYX")
    with pytest.raises(ValueError, match=r"rotvec must have shape \(3,\) or \(n_frames, ..., 3\), got \(2,\)"):
        euler_from_rotvec([1.0, 2.0], "XYZ")


def test_from_channels_is_from_euler_unrolled():
    rng = np.random.default_rng(0)
    channels = 400 * rng.normal(size=(50, 9)).cumsum(axis=0) / 5  # degrees, over many turns
    columns, orders = [[0, 1, 2], [], [5], [8, 7, 6, 8], [3, 4]], ["ZXY", "", "Y", "XYZX", "ZZ"]
    got = rotvec_from_channels(channels, columns, orders)
    for joint, (places, order) in enumerate(zip(columns, orders, strict=True)):
        expected = unroll_rotvec(rotvec_from_euler(np.deg2rad(channels[:, places]), order))
        assert_allclose(got[:, joint], expected, atol=1e-10)  # over many turns


def test_from_channels_without_any():
    assert rotvec_from_channels(np.ones((3, 1)), [[], []], ["", ""]).tolist() == np.zeros((3, 2, 3)).tolist()
