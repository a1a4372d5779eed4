"""Exponential maps."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from eigenwalker.motion import euler_from_rotvec, forward_kinematics, rotvec_from_euler, unroll_rotvec
from eigenwalker.motion.rotations import rotvec_from_channels

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


@settings(deadline=None)
@given(seed=st.integers(0, 10_000), turns=st.floats(-3, 3))
def test_unrolled_maps_are_continuous_and_the_same_rotations(seed, turns):
    """A smooth sequence through several turns comes back after each map was brought below pi."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    angles = np.linspace(0.3, 0.3 + 2 * np.pi * turns, 200)
    smooth = angles[:, np.newaxis] * axis + 0.02 * np.cumsum(rng.normal(size=(200, 3)), axis=0) / 14
    wrapped = Rotation.from_rotvec(smooth).as_rotvec()
    unrolled = unroll_rotvec(wrapped[:, np.newaxis])[:, 0]
    again, expected = (Rotation.from_rotvec(r).as_matrix() for r in (unrolled, smooth))
    assert_allclose(again, expected, atol=1e-12)
    # The nearest of all maps of the same rotation: never more than half a turn away along its axis.
    before = np.linalg.norm(unrolled[:-1], axis=1)
    steps = np.linalg.norm(np.diff(unrolled, axis=0), axis=1)
    assert (steps <= np.linalg.norm(np.diff(wrapped, axis=0), axis=1) + 1e-9).all() or before.min() < 1


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
