"""Joint limits: recorded walks keep them, bent ones are named."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import JointWalk, Skeleton, make_walkers
from eigenwalker.motion import JointLimitWarning, joint_limits_exceeded
from eigenwalker.motion.limits import warn_joint_limits
from tests.recorded import bandai_joints, cmu_joints

_NAMES = ("Hips", "Spine", "Neck", "Head", "LeftShoulder", "RightShoulder")
_LIMBS = ("UpLeg", "Leg", "Foot", "Arm", "ForeArm", "Hand")


def _standing(**turns):
    """Return an upright walk of four frames with mixamo's joints; turns in degrees about x, y, z, in one frame."""
    names = (*_NAMES, *(f"{side}{limb}" for side in ("Left", "Right") for limb in _LIMBS))
    parents = [-1, *[0] * (len(names) - 1)]
    skeleton = Skeleton(names, np.array(parents), np.zeros((len(names), 3)), upright=True)
    rotations = np.zeros((4, len(names), 3))
    for joint, turn in turns.items():
        rotations[2, names.index(joint)] = np.deg2rad(turn)
    return JointWalk(rotations, np.zeros((4, 3)), skeleton, 30.0, "standing")


def test_recorded_walks_keep_within_the_limits(data_dir):
    for walk in (*bandai_joints(data_dir), *cmu_joints(data_dir)):
        assert joint_limits_exceeded(walk).empty, walk.name


# A turn about y, to the left, swings what hangs down back and what points ahead down.
@pytest.mark.parametrize(
    ("joint", "turn", "marker", "movement", "limit"),
    [
        ("LeftUpLeg", (0, -145, 0), "left_hip", "flexion", 140),
        ("LeftUpLeg", (0, 55, 0), "left_hip", "extension", 50),
        ("RightUpLeg", (-70, 0, 0), "right_hip", "abduction", 65),
        ("RightUpLeg", (55, 0, 0), "right_hip", "adduction", 50),
        ("LeftUpLeg", (70, 0, 0), "left_hip", "abduction", 65),
        ("LeftLeg", (0, 140, 0), "left_knee", "flexion", 135),
        ("LeftLeg", (0, -12, 0), "left_knee", "hyperextension", 10),
        ("RightFoot", (0, -52, 0), "right_ankle", "dorsiflexion", 50),
        ("RightFoot", (0, 85, 0), "right_ankle", "plantar flexion", 80),
        ("LeftArm", (0, 85, 0), "left_shoulder", "extension", 80),
        ("LeftForeArm", (0, -155, 0), "left_elbow", "flexion", 150),
        ("LeftForeArm", (0, 15, 0), "left_elbow", "hyperextension", 10),
    ],
)
def test_each_limit_is_that_of_the_movement(joint, turn, marker, movement, limit):
    table = joint_limits_exceeded(_standing(**{joint: turn}))
    assert table[["joint", "movement"]].to_numpy().tolist() == [[marker, movement]]
    assert_allclose(table[["degrees", "limit", "share_of_frames"]], [[np.abs(turn).max(), limit, 0.25]])


@pytest.mark.parametrize("turn", [(90, 0, 0), (0, -170, 0), (0, 0, 120), (170, 0, 0)])
def test_arms_may_point_anywhere_but_far_back(turn):
    assert joint_limits_exceeded(_standing(LeftArm=turn)).empty


def test_a_turn_about_the_bone_itself_does_not_count():
    assert joint_limits_exceeded(_standing(LeftUpLeg=(0, 0, 100), LeftLeg=(0, 0, 50))).empty


def test_warns_of_joint_walks_and_is_silent_about_others():
    bad, marker_walk = _standing(RightLeg=(0, -40, 0)), make_walkers(1, random_state=0).data[0]
    with pytest.warns(JointLimitWarning, match="1 of 2 walks: 'standing', right_knee: hyperextension 40 deg.*limit 10"):
        warn_joint_limits([bad, marker_walk])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_joint_limits([marker_walk, _standing()])


def test_refuses_markers_and_the_axes_of_files():
    with pytest.raises(TypeError, match="of a JointWalk, got Walk"):
        joint_limits_exceeded(make_walkers(1, random_state=0).data[0])
    skeleton = Skeleton(("hips",), np.array([-1]), np.zeros((1, 3)))
    with pytest.raises(ValueError, match=r"in the axes of a file.*stand_upright\(walk\)"):
        joint_limits_exceeded(JointWalk(np.zeros((1, 1, 3)), np.zeros((1, 3)), skeleton, 30.0))
