"""Walks on the floor: laws of planting."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from eigenwalker import WalkError
from eigenwalker.motion import JointWalk, Skeleton, plant_feet, quality_table, sole_points, stand_upright
from eigenwalker.motion.footing import find_footing
from tests.joint_bodies import mixamo, still
from tests.planted import ANKLE, LEG, skeleton_with_feet, standing_walk
from tests.scissors import SWING, mirrored, scissor_walk, walker


def _turned(points, angle):
    return Rotation.from_rotvec([0.0, 0.0, angle]).apply(points.reshape(-1, 3)).reshape(points.shape)


def test_feet_stand_and_the_body_goes_on():
    row = quality_table([plant_feet(walker())]).iloc[0]
    assert row.n_steps >= 6
    assert row.worst_foot_slip_m_per_step < 1e-3
    assert row.foot_above_ground_m < 1e-3
    assert row.foot_below_ground_m < 0.0031
    assert row.root_jump_m_per_s < 0.5
    assert row.bone_length_variation_m < 1e-12
    assert 0.7 < row.speed_m_per_s < 1.3
    free = quality_table([plant_feet(walker(), hold=False)]).iloc[0]
    assert row.trailing_foot_slide_m < 0.6 * free.trailing_foot_slide_m


def _pace(walk):
    """Return the mean speed of a walk over its whole strides, in m/s."""
    return float(quality_table([walk]).speed_m_per_s.iloc[0])


@pytest.mark.parametrize(("share", "reached"), [(0.9, 0.97), (0.985, 0.985), (1.02, 1.02), (1.5, 1.03)])
def test_a_walk_goes_at_its_speed_as_far_as_legs_reach(share, reached):
    """The speed is an argument, or that of the walk; feet stand as well as without."""
    walk = replace(walker(), size=1.1)
    usual = plant_feet(walk, travel=False)
    speed = share * usual.speed
    planted = plant_feet(walk, speed=speed)
    assert_allclose(_pace(planted) / _pace(plant_feet(walk)), reached, rtol=2e-3)
    assert_allclose(plant_feet(walk, speed=speed, travel=False).speed, reached * usual.speed, rtol=1e-9)
    known = plant_feet(replace(walk, speed=speed))
    assert_allclose(known.joint_positions(), planted.joint_positions(), atol=0)
    row = quality_table([planted]).iloc[0]
    assert row.worst_foot_slip_m_per_step < 1e-3
    assert row.foot_above_ground_m < 1e-3
    assert row.foot_below_ground_m < 0.0035
    assert row.root_jump_m_per_s < 0.5


@pytest.mark.parametrize("options", [{}, {"curvature": 0.3}, {"path": [[0, 0], [2, 1], [4, -1]]}])
def test_the_speed_that_legs_say_changes_nothing(options):
    walk = walker()
    own = plant_feet(walk, travel=False).speed
    expected = plant_feet(walk, **options)
    for known in (replace(walk, speed=own), walk):
        planted = plant_feet(known, speed=own, **options)
        assert_allclose(planted.joint_positions(), expected.joint_positions(), atol=1e-9)
    legs_say = plant_feet(replace(walk, speed=1.1 * own), speed=np.nan, **options)
    assert_allclose(legs_say.joint_positions(), expected.joint_positions(), atol=0)


def test_without_reaching_a_walk_goes_as_its_legs_say():
    walk = walker()
    free = plant_feet(walk, hold=False)
    assert_allclose(plant_feet(replace(walk, speed=2.0), hold=False).root, free.root, atol=0)


@pytest.mark.parametrize("heading", [0.7, -2.0, np.pi])
def test_another_heading_is_the_same_walk_turned(heading):
    straight, turned = plant_feet(walker()), plant_feet(walker(), heading=heading)
    assert_allclose(turned.joint_positions(), _turned(straight.joint_positions(), heading), atol=1e-9)
    assert_allclose(sole_points(turned), _turned(sole_points(straight), heading), atol=1e-9)


def test_straight_paths_are_straight_ahead():
    walk = walker()
    straight = plant_feet(walk)
    for other in (plant_feet(walk, path=[[0, 0], [2, 0], [9, 0]]), plant_feet(walk, curvature=1e-12)):
        assert_allclose(other.joint_positions(), straight.joint_positions(), atol=1e-9)
    aside = plant_feet(walk, path=[[1, 2], [1, 7]])
    expected = _turned(straight.joint_positions(), np.pi / 2) + np.array([1, 2, 0])
    assert_allclose(aside.joint_positions(), expected, atol=1e-9)


@pytest.mark.parametrize("options", [{}, {"curvature": 0.3}, {"heading": 0.4}, {"hold": False}])
def test_the_mirror_image_is_planted_as_the_mirrored_walk(options):
    """A walk in the mirror turns to the other side."""
    walk = walker()
    other = {name: -value if name in {"curvature", "heading"} else value for name, value in options.items()}
    expected = mirrored(plant_feet(walk, **options)).joint_positions()
    assert_allclose(plant_feet(mirrored(walk), **other).joint_positions(), expected, atol=1e-9)


def test_without_reaching_only_the_root_moves():
    walk = walker()
    planted = plant_feet(walk, hold=False)
    assert_allclose(planted.rotations, walk.rotations, atol=0)
    assert np.ptp(planted.root[:, 0]) > 3
    held = plant_feet(walk)
    names = walk.skeleton.joint_names
    joints = ("UpLeg", "Leg", "Foot", "ToeBase")
    legs = [names.index(f"{side}{joint}") for side in ("Left", "Right") for joint in joints]
    others = [joint for joint in range(len(names)) if joint not in legs]
    assert_allclose(held.rotations[:, others], walk.rotations[:, others], atol=0)
    assert_allclose(held.root, planted.root, atol=0.02)


def test_in_place_with_its_speed_is_over_the_floor():
    walk = walker()
    travelling, still_there = plant_feet(walk, heading=0.3), plant_feet(walk, travel=False, heading=0.3)
    assert np.isnan(travelling.speed)
    steps = still_there.speed / walk.frame_rate * np.arange(walk.n_frames)
    expected = still_there.root + np.outer(steps, [np.cos(0.3), np.sin(0.3), 0.0])
    assert_allclose(expected, travelling.root, atol=1e-12)
    assert_allclose(still_there.rotations, travelling.rotations)
    frames = round(2 / 0.9 * 60)  # two strides, to a third of a frame
    assert np.abs(still_there.root[frames:-frames] - still_there.root[: -2 * frames]).max() < 0.02


def test_scissors_step_as_wide_as_they_open():
    """On stiff legs and level feet each step is twice the sine; hand-overs round it off by less than 2 %."""
    walk = scissor_walk(frequency=1.0)
    planted = plant_feet(walk, hold=False)
    stride = planted.root[150:-60, 0] - planted.root[90:-120, 0]  # one stride apart
    assert_allclose(stride, 4 * LEG * np.sin(SWING), rtol=0.02)
    assert np.ptp(stride) < 1e-9
    assert_allclose(sole_points(planted)[..., 2], 0.0, atol=1e-12)


@pytest.mark.parametrize("speed", [None, 9.0])
def test_the_root_follows_the_arc(speed):
    """A circle of 2 m in radius, but for the sway of the pelvis."""
    planted = plant_feet(walker(600), curvature=0.5, speed=speed)
    away = np.linalg.norm(planted.root[:, :2] - [0.0, 2.0], axis=1)
    assert_allclose(away, 2.0, atol=0.1)
    footing = find_footing(planted)
    for foot, frames in footing.supports:
        points = footing.points[frames, foot]
        lowest = points[:, :, 2].argmin(axis=1)
        for point in set(lowest):
            still_there = points[lowest == point, point, :2]
            assert np.ptp(still_there, axis=0).max() < 5e-3


def test_the_floor_and_the_start_are_where_they_are_said_to_be():
    walk = walker()
    moved = replace(walk, root=np.random.default_rng(0).normal(size=(walk.n_frames, 3)))
    assert_allclose(plant_feet(moved).root, plant_feet(walk).root)  # the path given is not used
    planted = plant_feet(walk)
    assert_allclose(planted.root[0, :2], 0.0)
    assert abs(sole_points(planted)[..., 2].min()) < 0.0031
    assert plant_feet(walk, path=[[3, 4], [5, 4]]).root[0, 0] == 3


def _with_top(skeleton, offset):
    """Return a skeleton with a joint over its root, which hangs at an offset from it, and that is high as well."""
    parents = np.concatenate(([-1], skeleton.parents + 1))
    offsets = np.vstack((offset, skeleton.offsets))
    return Skeleton(("reference", *skeleton.joint_names), parents, offsets, root=1, upright=True)


def test_joints_above_the_root_change_nothing():
    walk, top = walker(), np.array([0.3, -0.2, 0.5])
    skeleton = _with_top(walk.skeleton, top)
    rotations = np.insert(walk.rotations, 0, 0.0, axis=1)
    longer = JointWalk(rotations, walk.root, skeleton, walk.frame_rate)
    for options in ({}, {"curvature": 0.2}, {"travel": False}):
        expected = plant_feet(walk, **options)
        assert_allclose(plant_feet(longer, **options).joint_positions()[:, 1:], expected.joint_positions(), atol=1e-12)


def test_skeletons_without_toes_walk_as_well():
    walk = walker(skeleton=skeleton_with_feet(toes=False))
    planted = plant_feet(walk)
    row = quality_table([planted]).iloc[0]
    assert row.worst_foot_slip_m_per_step < 1e-3
    assert row.foot_below_ground_m < 0.0031
    assert planted.rotations.shape == walk.rotations.shape


def test_other_rigs_may_be_named():
    walk = walker()
    names = tuple(name.upper() for name in walk.skeleton.joint_names)
    shouting = replace(walk, skeleton=replace(walk.skeleton, joint_names=names))
    with pytest.raises(ValueError, match="no known rig"):
        plant_feet(shouting)


@pytest.mark.parametrize("n_frames", [3, 5, 11])
def test_parts_of_a_step_are_planted(n_frames):
    planted = plant_feet(walker(n_frames, start=0.2))
    assert np.isfinite(planted.joint_positions()).all()
    assert abs(sole_points(planted)[..., 2].min()) < 0.02


def test_who_stands_stays():
    planted = plant_feet(standing_walk(5))
    assert_allclose(planted.root, np.tile([0, 0, LEG + ANKLE], (5, 1)), atol=1e-12)
    assert_allclose(planted.rotations, 0.0, atol=1e-9)
    assert plant_feet(standing_walk(5), travel=False).speed == 0


def test_no_knee_turns_further_than_it_may():
    walk = walker()
    for bound in (0.0, 3.0, 15.0):
        held, free = (plant_feet(walk, hold=hold, max_knee=bound) for hold in (True, False))
        assert np.abs(_flexion(held) - _flexion(free)).max() <= bound + 1e-5


def _flexion(walk):
    places, index = walk.joint_positions(), walk.skeleton.index
    angles = []
    for side in ("Left", "Right"):
        hip, knee, ankle = (places[:, index(side + joint)] for joint in ("UpLeg", "Leg", "Foot"))
        across = np.linalg.norm(np.cross(knee - hip, ankle - knee), axis=1)
        angles.append(np.arctan2(across, ((knee - hip) * (ankle - knee)).sum(axis=1)))
    return np.rad2deg(angles)


def test_everything_else_stays():
    walk = replace(walker(), size=1.2, frequency=0.9, name="anna", channel_joints=("LeftUpLeg", "RightUpLeg"))
    planted = plant_feet(walk)
    assert (planted.name, planted.size, planted.frequency) == ("anna", 1.2, 0.9)
    assert planted.channel_joints == walk.channel_joints
    assert planted.skeleton is walk.skeleton
    assert planted.n_frames == walk.n_frames


def test_what_cannot_be_planted_is_refused():
    walk = walker(30)
    with pytest.raises(TypeError, match="expected a JointWalk, whose feet have soles, got Walk"):
        plant_feet(walk.to_markers())
    with pytest.raises(WalkError, match="expected at least 3 frames, got 2"):
        plant_feet(walker(2))
    gap = np.array(walk.rotations)
    gap[3, 2] = np.nan
    with pytest.raises(WalkError, match="expected finite values"):
        plant_feet(replace(walk, rotations=gap))
    with pytest.raises(ValueError, match="skeleton must be upright"):
        plant_feet(still(mixamo(), 5))
    assert plant_feet(stand_upright(still(mixamo(), 5))).n_frames == 5
    with pytest.raises(ValueError, match="travel=False keeps the walk in place"):
        plant_feet(walk, travel=False, curvature=0.1)
    with pytest.raises(ValueError, match="give either path, or heading and curvature"):
        plant_feet(walk, path=[[0, 0], [1, 0]], heading=1.0)
    for wrong in (-1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="max_knee must be finite and not negative"):
            plant_feet(walk, max_knee=wrong)
    for wrong in (-1.0, 0.0, np.inf):
        with pytest.raises(ValueError, match="speed must be positive and finite, in m/s, or NaN"):
            plant_feet(walk, speed=wrong)
    skeleton = walk.skeleton
    parents = np.array(skeleton.parents)
    parents[skeleton.index("LeftToeBase")] = skeleton.index("LeftLeg")
    names = [{"LeftToeBase": "LeftFoot", "LeftFoot": "LeftToeBase"}.get(name, name) for name in skeleton.joint_names]
    forked = replace(skeleton, parents=parents, joint_names=tuple(names))
    assert plant_feet(replace(walk, skeleton=forked)).n_frames == 30  # toes from the shank are no toes
    knee = skeleton.index("LeftLeg")
    names = (*skeleton.joint_names[:knee], "twist", *skeleton.joint_names[knee:])
    parents = np.insert(np.where(skeleton.parents >= knee, skeleton.parents + 1, skeleton.parents), knee, knee - 1)
    parents[knee + 1] = knee
    longer = Skeleton(names, parents, np.insert(skeleton.offsets, knee, [0, 0, -0.1], axis=0), upright=True)
    rotations = np.insert(walk.rotations, knee, 0.0, axis=1)
    with pytest.raises(ValueError, match="LeftLeg must hang from LeftUpLeg and LeftFoot from LeftLeg, without a joint"):
        plant_feet(replace(walk, skeleton=longer, rotations=rotations))
