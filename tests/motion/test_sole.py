"""Where the soles of the feet are."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.motion import Skeleton, find_rig, sole_points, stand_upright
from eigenwalker.motion.sole import sole_offsets
from tests.planted import ANKLE, LEG, skeleton_with_feet, standing_walk
from tests.recorded import bandai_walks


def _turned(joint, rotvec, **fields):
    """Return somebody who stands but for one joint, and its sole points."""
    walk = standing_walk(1, **fields)
    rotations = np.array(walk.rotations)
    rotations[:, walk.skeleton.index(joint)] = rotvec
    return sole_points(replace(walk, rotations=rotations))[0]


def test_who_stands_has_both_soles_on_the_floor():
    points = sole_points(standing_walk(3))
    assert points.shape == (3, 2, 3, 3)
    assert_allclose(points[..., 2], 0.0, atol=1e-15)
    assert_allclose(points[..., 0], np.broadcast_to([-0.06 * LEG, 0.12, 0.12 + 0.07 * LEG], (3, 2, 3)))
    assert_allclose(points[..., 1], np.broadcast_to([[0.1], [-0.1]], (3, 2, 3)))


def test_toes_that_bend_leave_the_heel_where_it_was():
    flat, bent = sole_points(standing_walk(1))[0], _turned("LeftToeBase", [0.0, -np.pi / 2, 0.0])
    assert_allclose(bent[0, 0], flat[0, 0])
    assert_allclose(bent[1], flat[1])
    toe = np.array([0.12, 0.1, 0.05 * LEG])  # the toes point up: the ball lies ahead of the joint, the tip above
    assert_allclose(bent[0, 1] - toe, [0.05 * LEG, 0, 0], atol=1e-15)
    assert_allclose(bent[0, 2] - toe, [0.05 * LEG, 0, 0.07 * LEG], atol=1e-15)


def test_a_foot_that_points_down_takes_all_its_points_along():
    down = _turned("RightFoot", [0.0, np.pi / 2, 0.0])[1]
    flat = sole_points(standing_walk(1))[0, 1]
    ankle = np.array([0.0, -0.1, ANKLE])
    assert_allclose(down - ankle, ((flat - ankle) @ [[0, 0, -1], [0, 1, 0], [1, 0, 0]]), atol=1e-15)


def test_points_are_those_of_joints_put_there():
    """Two routes agree: the offsets, and a skeleton that ends in these six points."""
    walk = standing_walk(20)
    rng = np.random.default_rng(0)
    walk = replace(
        walk, rotations=rng.normal(size=walk.rotations.shape), translations={"LeftFoot": rng.normal(size=(20, 3))}
    )
    joints, offsets = sole_offsets(walk.skeleton)
    longer = replace(walk.skeleton, end_parents=joints.ravel(), end_offsets=offsets.reshape(-1, 3))
    assert_allclose(sole_points(walk).reshape(20, 6, 3), replace(walk, skeleton=longer).end_positions(), atol=1e-12)


def test_skeletons_without_toes_have_feet_all_the_same():
    walk = standing_walk(2, skeleton=skeleton_with_feet(toes=False))
    foot = [walk.skeleton.index(f"{side}Foot") for side in ("Left", "Right")]
    joints, offsets = sole_offsets(walk.skeleton)
    assert_allclose(joints, np.repeat(np.array(foot)[:, np.newaxis], 3, axis=1))
    assert_allclose(offsets[:, :, 2], -0.1 * LEG)
    tips = replace(walk.skeleton, end_parents=foot, end_offsets=[[0.12, 0, -0.05], [0.12, 0, -0.05]])
    assert_allclose(sole_points(replace(walk, skeleton=tips)), sole_points(standing_walk(2)))
    nowhere = replace(tips, end_offsets=np.zeros((2, 3)))  # as files write ends that they do not know
    assert_allclose(sole_offsets(nowhere).offsets, offsets)


def test_the_leg_may_have_joints_between_hip_and_knee():
    skeleton = skeleton_with_feet()
    knee = skeleton.index("LeftLeg")
    names = (*skeleton.joint_names[:knee], "LeftTwist", *skeleton.joint_names[knee:])
    parents = np.where(skeleton.parents >= knee, skeleton.parents + 1, skeleton.parents)
    parents = np.insert(parents, knee, parents[knee])
    parents[knee + 1] = knee
    offsets = np.insert(skeleton.offsets, knee, [0, 0, -0.1], axis=0)
    offsets[knee + 1] = [0, 0, -0.3]
    twisted = Skeleton(names, parents, offsets, upright=True)
    assert_allclose(sole_offsets(twisted).offsets, sole_offsets(skeleton).offsets)


def test_walks_of_files_are_brought_upright_first():
    walk = standing_walk(2, skeleton=skeleton_with_feet(upright=False))
    assert_allclose(sole_points(walk), sole_points(standing_walk(2)), atol=1e-15)
    with pytest.raises(ValueError, match="skeleton must be upright"):
        sole_offsets(walk.skeleton)
    with pytest.raises(ValueError, match="no known rig"):
        sole_points(replace(walk, skeleton=Skeleton(("a",), [-1], np.zeros((1, 3))), rotations=walk.rotations[:, :1]))
    markers = dict(find_rig(walk.skeleton.joint_names).markers)
    assert_allclose(sole_points(walk, markers), sole_points(walk))


def test_recorded_soles_dip_into_the_floor_by_millimetres(data_dir):
    recorded, _ = bandai_walks(data_dir)
    for walk in recorded[::25]:
        lowest = sole_points(walk)[..., 2].min(axis=2).min(axis=1)
        assert -0.008 < lowest.min() < 0.0
        assert np.median(lowest) < 0.012  # a foot is on the floor most of the time
        assert_allclose(sole_points(stand_upright(walk)), sole_points(walk), atol=1e-12)
