"""Units and axes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.io._units import meters_per_unit, to_package_axes
from eigenwalker.motion.rotations import forward_kinematics


def test_axes_are_turned_properly():
    axes = to_package_axes(np.eye(3), "y")
    assert_allclose(np.linalg.det(axes), 1)
    assert_allclose(axes[1], [0, 0, 1])  # the file's y points up
    assert_allclose(axes[2], [1, 0, 0])  # and its z forward


def test_positions_and_rotations_turn_together():
    rng = np.random.default_rng(5)
    turns, bones, parents = rng.normal(size=(6, 4, 3)), rng.normal(size=(6, 4, 3)), np.array([-1, 0, 1, 2])
    joints, _ = forward_kinematics(turns, bones, parents)
    turned, _ = forward_kinematics(to_package_axes(turns, "y"), to_package_axes(bones, "y"), parents)
    assert_allclose(turned, to_package_axes(joints, "y"), atol=1e-14)


def test_units_agree():
    assert 100 * meters_per_unit("cm") == meters_per_unit("m") == meters_per_unit(1)
    assert meters_per_unit("in") == pytest.approx(25.4 * meters_per_unit("mm"))
