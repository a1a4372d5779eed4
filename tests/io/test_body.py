"""Units and axes, and legs of a length that people have."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker._validation import WalkError
from eigenwalker.io._body import check_leg_length, meters_per_unit, to_package_axes
from eigenwalker.motion.rotations import forward_kinematics
from eigenwalker.motion.skeleton import TROJE15
from eigenwalker.motion.walk import Walk


def _walk(leg, n_frames=4):
    """Return a walk whose legs are straight and `leg` metres long."""
    positions = np.zeros((n_frames, 15, 3))
    for side in ("left", "right"):
        for joint, height in (("hip", 1.0), ("knee", 0.5), ("ankle", 0.0)):
            positions[:, TROJE15.index(f"{side}_{joint}"), 2] = height * leg
    return Walk(positions, 30, name="anna")


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


@pytest.mark.parametrize("leg", [0.3, 0.85, 1.3])
def test_legs_of_people_pass(leg):
    check_leg_length(_walk(leg), unit="m")


@pytest.mark.parametrize(
    ("leg", "unit", "advice"),
    [
        (85.0, "m", r"anna: legs are 85 m long with unit='m', expected 0\.3 to 1\.3 m; pass unit='cm'"),
        (850.0, "m", r"pass unit='mm'"),
        (0.0085, "cm", r"pass unit='m'"),
        (0.35 / 2.54, "cm", r"metres per unit of the file, about 0\.062 for legs of 0\.85 m"),
        (33.0, "m", r"pass unit='in'"),
        (5.0, "m", r"about 0\.17 for legs"),
        (0.0, "m", r"are not those of a body"),
        (1e300, "m", r"legs are inf m long"),
    ],
)
def test_other_legs_are_refused_with_advice(leg, unit, advice):
    with pytest.raises(WalkError, match=advice):
        check_leg_length(_walk(leg), unit=unit)


def test_gaps_do_not_matter():
    positions = np.array(_walk(0.8).positions)
    positions[1:] = np.nan
    check_leg_length(Walk(positions, 30), unit="m")
    with pytest.raises(WalkError, match="legs are 80 m long"):
        check_leg_length(Walk(100 * positions, 30), unit="m")


def test_legs_that_are_nowhere_known_are_not_judged():
    check_leg_length(Walk(np.full((3, 15, 3), np.nan), 30), unit="m")
