"""Where the body goes and when feet are held, on walks whose answer is known."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.motion.legs import find_legs, pose_legs
from eigenwalker.motion.planting import hold_feet, plan_feet
from eigenwalker.motion.support import Stance, find_stances, find_support
from tests.planted import LEG, standing_walk
from tests.scissors import HIGHEST, SWING, scissor_walk, walker

STRIDE = 60.0
STEPS = [Stance(1, -np.inf, 20.0), Stance(0, 20.0, 50.0), Stance(1, 50.0, 80.0), Stance(0, 80.0, np.inf)]


def _planned(walk, speed=np.nan):
    pose = pose_legs(walk.rotations, np.zeros((walk.n_frames, 3)), find_legs(walk.skeleton))
    stances, stride = find_stances(pose.ankles[:, 0, 0] - pose.ankles[:, 1, 0])
    holds = hold_feet(stances, stride, walk.n_frames)
    return pose, holds, plan_feet(stances, stride, holds, find_support(pose.soles), speed=speed)


def test_feet_are_held_in_their_stance_and_a_little_longer():
    left, right = hold_feet(STEPS, STRIDE, 100)
    frames = np.arange(100)
    inside = ((frames >= 20) & (frames <= 55)) | (frames >= 80)
    assert_allclose(left.amount[inside], 1.0)
    assert_allclose(left.still[inside], 1.0)
    assert_allclose(left.down[frames == 35], 1.0)
    assert_allclose(left.down[56:70], 0.0)  # the toes may leave before
    swinging = (frames > 64.2) & (frames < 71.5)
    assert_allclose(left.amount[swinging], 0.0)
    assert_allclose(left.still[61:77], 0.0)
    assert_allclose(right.amount[:25], 1.0)
    for hold in (left, right):
        assert (hold.still <= hold.amount + 1e-12).all()
        assert (hold.down <= hold.still + 1e-12).all()
        assert_allclose(hold.late, 0.095 * STRIDE)
    assert left.middles.tolist() == [35, 97]
    assert right.middles.tolist() == [2, 65]
    assert sorted(set(left.middle)) == [35, 97]
    assert sorted(set(left.behind)) == [46, 99]  # 0.06 strides before the right foot takes over


def test_a_foot_without_a_stance_is_not_held():
    left, right = hold_feet([Stance(0, -np.inf, np.inf)], 5.0, 5)
    for part in left[:3]:
        assert_allclose(part, 1.0)
    for part in right[:3]:
        assert_allclose(part, 0.0)


def test_scissors_go_by_the_sine_of_their_hips():
    walk = scissor_walk()
    pose, holds, plan = _planned(walk)
    swing = -walk.rotations[:, walk.skeleton.index("LeftUpLeg"), 1]
    for foot, sign in ((0, 1.0), (1, -1.0)):
        alone = holds[foot].down.astype(bool) & (holds[1 - foot].amount == 0)
        steps = alone[1:] & alone[:-1]
        assert steps.sum() > 20
        ahead = -np.diff(LEG * np.sin(sign * swing))
        assert_allclose(np.diff(plan.root[:, 0])[steps], ahead[steps], atol=1e-12)
        assert_allclose(plan.shifts[alone, foot, :2], 0.0, atol=1e-12)
    assert_allclose(plan.root[:, 1], 0.0, atol=1e-12)
    assert_allclose(plan.root[:, 2], HIGHEST - LEG + LEG * np.cos(swing), atol=1e-12)  # both soles are level
    assert_allclose(plan.shifts[..., 2], 0.0, atol=1e-12)
    assert_allclose(pose.soles[..., 2].min(axis=2) + plan.root[:, [2]], 0.0, atol=1e-12)


def test_speed_is_two_steps_a_stride():
    """Around a hand-over, where the body follows both feet, a step loses less than 2 %."""
    _, _, plan = _planned(scissor_walk(frequency=0.9))
    assert_allclose(plan.speed * 60, 4 * LEG * np.sin(SWING) * 0.9, rtol=0.02)
    assert plan.speed * 60 < 4 * LEG * np.sin(SWING) * 0.9
    assert_allclose(plan.root[0, :2], 0.0)


@pytest.mark.parametrize("share", [0.98, 1.0, 1.02])
def test_feet_that_are_held_stay_where_they_are(share):
    """What the plan lets a held foot do: nothing, over the floor; and it is as far from the floor as it must be."""
    walk = walker()
    pose, holds, plan = _planned(walk, share * _planned(walk)[2].speed)
    for foot, hold in enumerate(holds):
        ankles = pose.ankles[:, foot] + plan.root + plan.shifts[:, foot]
        soles = pose.soles[:, foot] + (plan.root + plan.shifts[:, foot])[:, np.newaxis]
        held = hold.still == 1
        together = held[1:] & held[:-1]
        moved = -find_support(pose.soles).advance[:, foot]  # of the standing point against the root
        over = np.diff(plan.root[:, :2] + plan.shifts[:, foot, :2], axis=0) + moved
        assert_allclose(over[together], 0.0, atol=1e-12)
        assert_allclose(soles[hold.down == 1][..., 2].min(axis=1), 0.0, atol=1e-12)
        assert soles[..., 2].min() > -0.0031  # the floor is soft for feet that come and go
        assert np.abs(np.diff(ankles, 2, axis=0)).max() < 0.035  # no jumps: half of what it swings in a frame


@pytest.mark.parametrize(("share", "reached"), [(0.5, 0.97), (0.98, 0.98), (1.025, 1.025), (9.0, 1.03)])
def test_a_speed_is_reached_but_for_more_than_three_percent(share, reached):
    walk = walker()
    usual = _planned(walk)[2]
    plan = _planned(walk, share * usual.speed)[2]
    assert_allclose(plan.speed, reached * usual.speed, rtol=1e-12)
    assert_allclose(plan.root[:, 1:], usual.root[:, 1:], atol=1e-12)
    strides = plan.root[-67, 0] - plan.root[66, 0], usual.root[-67, 0] - usual.root[66, 0]
    assert_allclose(strides[0] / strides[1], reached, rtol=2e-3)  # not a whole number of strides


def test_behind_the_body_a_foot_stands_as_without_a_wanted_speed():
    """What the body gains on a foot is made up for where the foot comes down: none while both feet stand."""
    walk = walker()
    _, holds, usual = _planned(walk)
    plan = _planned(walk, 1.03 * usual.speed)[2]
    both = holds[0].still * holds[1].still == 1
    together = both[1:] & both[:-1]
    assert together.sum() > 20
    assert_allclose(np.diff(plan.root[:, 0])[together], np.diff(usual.root[:, 0])[together], atol=1e-12)
    more = (plan.shifts - usual.shifts)[..., 0]
    for foot, hold in enumerate(holds):
        ahead, frames = hold.still == 1, np.arange(len(more))
        step = 0.03 * usual.speed * 67  # of which about half is gained on each foot
        assert_allclose(more[ahead & (frames > hold.behind + 1), foot], 0.0, atol=0.1 * step)
        assert (more[ahead & (frames < hold.middle), foot] > 0.1 * step).all()
        assert more[:, foot].max() < 0.7 * step


@pytest.mark.parametrize("speed", [0.0, -1.0, np.nan])
def test_no_speed_is_as_the_legs_say(speed):
    walk = walker()
    assert_allclose(_planned(walk, speed)[2].root, _planned(walk)[2].root, atol=0)
    usual = _planned(walk)[2]
    same = _planned(walk, usual.speed)[2]
    assert_allclose(same.root, usual.root, atol=1e-12)
    assert_allclose(same.shifts, usual.shifts, atol=1e-12)


def test_who_stands_gains_nothing():
    assert_allclose(_planned(standing_walk(20), 0.02)[2].root[:, :2], 0.0, atol=1e-12)


def test_anchors_stand_while_the_foot_stands_and_go_on_while_it_swings():
    _, holds, plan = _planned(walker())
    for foot, hold in enumerate(holds):
        places = plan.root[hold.middles, 0]
        standing = hold.down == 1
        assert_allclose(plan.anchors[standing, foot], plan.root[hold.middle, 0][standing], atol=1e-12)
        assert (np.diff(plan.anchors[:, foot]) >= -1e-12).all()
        assert_allclose([plan.anchors[0, foot], plan.anchors[-1, foot]], [places[0], places[-1]], atol=1e-2)


@pytest.mark.parametrize("n_frames", [3, 4, 20])
def test_walks_of_a_part_of_a_step_have_a_plan(n_frames):
    _, holds, plan = _planned(walker(n_frames, start=0.2))
    assert len(holds) == 2
    assert np.isfinite(plan.root).all()
    assert np.isfinite(plan.shifts).all()
    assert np.isfinite(plan.anchors).all()
    assert_allclose(plan.speed, (plan.root[-1, 0] - plan.root[0, 0]) / (n_frames - 1))
