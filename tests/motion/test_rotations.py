"""Exponential maps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from eigenwalker.motion import forward_kinematics, rotvec_from_euler, unroll_rotvec

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
