"""Feet that stand as they stood before a walk was changed."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.motion.gait_tracking import GaitTrack
from eigenwalker.motion.legs import find_legs, pose_legs
from eigenwalker.motion.relative_planting import plant_as_before
from tests.joint_bodies import swinging

MAX_KNEE = np.deg2rad(25)


@pytest.fixture
def phase():
    return 2 * np.pi * 0.9 * np.arange(400) / 120


@pytest.fixture
def walk(phase):
    return swinging(phase)


def _plant(rotations, walk, phase, *, heading=0.0, share=1.0):
    track = GaitTrack(phase, np.full(len(phase), share), np.full(len(phase), heading))
    return plant_as_before(rotations, walk.rotations, find_legs(walk.skeleton), track, max_knee=MAX_KNEE)


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_without_a_change_nothing_moves(walk, phase, share):
    rotations, root = _plant(walk.rotations, walk, phase, share=share)
    assert_array_equal(rotations, walk.rotations)
    assert_array_equal(root, 0)


def test_arms_have_no_part_in_it(walk, phase):
    changed = np.array(walk.rotations)
    changed[:, walk.skeleton.index("LeftArm")] += 0.3
    rotations, root = _plant(changed, walk, phase)
    assert_array_equal(rotations, changed)
    assert_array_equal(root, 0)


def test_who_bends_his_knees_sinks(walk, phase):
    changed = np.array(walk.rotations)
    for side in ("Left", "Right"):
        for joint, angle in (("UpLeg", -0.2), ("Leg", 0.4), ("Foot", -0.2)):
            changed[:, walk.skeleton.index(side + joint), 1] += angle
    _, root = _plant(changed, walk, phase)
    assert (root[:, 2] < 0).all()
    assert_allclose(root[0, :2], 0, atol=1e-12)


def test_longer_steps_carry_the_root_along_the_heading(walk, phase):
    changed = np.array(walk.rotations)
    for side in ("Left", "Right"):
        changed[:, walk.skeleton.index(f"{side}UpLeg"), 1] *= 1.2
    _, root = _plant(changed, walk, phase)
    assert root[-1, 0] > 0.1
    legs = find_legs(walk.skeleton)
    poses = [pose_legs(one, np.zeros((400, 3)), legs).ankles[..., 0] for one in (walk.rotations, changed)]
    strides = phase[-1] / np.pi  # two steps each, as long as the feet are apart
    expected = strides * (np.ptp(poses[1][:, 0] - poses[1][:, 1]) - np.ptp(poses[0][:, 0] - poses[0][:, 1])) / 2
    assert root[-1, 0] == pytest.approx(expected, rel=0.5)  # feet roll, too
