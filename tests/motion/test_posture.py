"""The reference posture: nothing moves, and all skeletons stand alike where their rotations are zero."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

from eigenwalker import WalkError, read_walk, write_walk
from eigenwalker.motion import JointWalk, Skeleton, find_rig, reference_frames, stand_upright
from eigenwalker.motion.posture import lean_back
from tests.joint_bodies import RIGS_OF_JOINTS, apart, body, in_posture, mixamo, random_skeleton, still, turning
from tests.recorded import bandai_joints, bandai_walks, cmu_joints, cmu_walks

rigs = pytest.mark.parametrize("rig", RIGS_OF_JOINTS)
seeds = st.integers(0, 100_000)


@pytest.fixture
def walk(rig, tmp_path, request):
    return body(rig, tmp_path, lambda: request.getfixturevalue("data_dir"))


@rigs
def test_nothing_moves(rig, walk):
    """Neither joints nor tips, in what was recorded and in any other motion."""
    for motion in (walk, turning(walk.skeleton, 0), turning(walk.skeleton, 1, translations=[3, 5])):
        upright = stand_upright(motion)
        assert upright.skeleton.upright
        assert upright.skeleton.rotation_orders is None
        assert apart(upright, motion) < 1e-12
        assert_allclose(upright.to_markers().positions, motion.to_markers().positions, atol=1e-12)
        assert_allclose(np.linalg.norm(upright.rotations[0], axis=1).max(), 0, atol=np.pi + 1e-12)


def test_nothing_moves_in_recorded_walks(data_dir):
    for walk in (*bandai_walks(data_dir)[0], *cmu_walks(data_dir)[0]):
        upright = stand_upright(walk)
        assert apart(upright, walk) < 1e-12
        assert apart(lean_back(upright, walk), walk) < 1e-12


def test_recorded_rotations_run_without_jumps(data_dir):
    """In `cmu_bvh` thumbs do jump, by up to 3 radians from frame to frame, and most walks start with a T."""
    for walk in bandai_walks(data_dir)[0]:
        assert np.abs(np.diff(stand_upright(walk).rotations, axis=0)).max() < 0.7  # seen 0.64, a hand at 30 frames/s


@given(seed=seeds, zero=st.booleans())
def test_any_skeleton_can_be_counted_from_any_posture(seed, zero):
    rng = np.random.default_rng(seed)
    skeleton = random_skeleton(seed)
    motion = turning(skeleton, seed, translations=[int(rng.integers(len(skeleton.joint_names)))])
    reference = "zero" if zero else rng.uniform(-4, 4, size=(len(skeleton.joint_names), 3))
    upright = stand_upright(motion, reference=reference)
    assert apart(upright, motion) < 1e-11
    above = skeleton.above(skeleton.root)
    assert_allclose(upright.rotations[:, above], 0, atol=1e-9)
    back = lean_back(upright, motion, reference=reference)
    assert apart(back, motion) < 1e-11
    frames = reference_frames(skeleton, reference=reference)
    assert_allclose(frames @ frames.transpose(0, 2, 1), np.tile(np.eye(3), (len(frames), 1, 1)), atol=1e-12)


@given(seed=seeds)
def test_the_reference_posture_itself_has_zero_rotations(seed):
    rng = np.random.default_rng(seed)
    skeleton = random_skeleton(seed)
    posture = rng.uniform(-3, 3, size=(1, len(skeleton.joint_names), 3))
    motion = JointWalk(posture, rng.normal(size=(1, 3)), skeleton, 30)
    assert_allclose(stand_upright(motion, reference=posture[0]).rotations, 0, atol=1e-9)


@rigs
def test_leaning_back_is_the_inverse(rig, walk):
    motion = turning(walk.skeleton, 2)
    upright = stand_upright(motion)
    back = lean_back(upright, motion)
    turns = [Rotation.from_rotvec(np.array(w.rotations).reshape(-1, 3)).as_matrix() for w in (back, motion)]
    assert_allclose(*turns, atol=1e-12)
    assert_allclose(back.root, motion.root, atol=1e-12)
    assert back.skeleton is motion.skeleton
    few = replace(upright, rotations=upright.rotations[:3], root=upright.root[:3])
    assert apart(stand_upright(lean_back(few, motion)), few) < 1e-12


@rigs
def test_upright_twice_is_the_same(rig, walk):
    upright = stand_upright(walk)
    assert stand_upright(upright) is upright
    again = stand_upright(upright, reference="zero")
    assert_allclose(again.rotations, upright.rotations, atol=1e-12)
    assert_allclose(again.skeleton.offsets, upright.skeleton.offsets, atol=1e-15)
    back = lean_back(upright, upright)
    assert_array_equal(back.rotations, upright.rotations)


def _tilt(bone, direction):
    """Return the angle between a bone and a direction, in degrees."""
    return np.rad2deg(np.arccos(bone @ direction / np.linalg.norm(bone) / np.linalg.norm(direction)))


@rigs
def test_zero_rotations_are_a_body_at_ease(rig, walk):
    """Along x, trunk upright, legs straight, arms hanging, feet flat: to degrees, whatever is zero in the file."""
    skeleton = stand_upright(walk).skeleton
    standing = still(skeleton)
    markers = standing.to_markers()
    place = {name: markers.marker(name)[0] for name in markers.marker_set.names}
    for side in ("left", "right"):
        for above, below in (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist")):
            assert _tilt(place[f"{side}_{below}"] - place[f"{side}_{above}"], np.array([0, 0, -1])) < 1e-4
        ankle = skeleton.index(find_rig(skeleton.joint_names).joint(f"{side}_ankle"))
        (toe,) = np.flatnonzero(skeleton.parents == ankle)
        assert _tilt(skeleton.offsets[toe] * [1, 1, 0], np.array([1, 0, 0])) < 12
        assert 0 < _tilt(skeleton.offsets[toe], np.array([0, 0, -1])) < 90
        tips = standing.end_positions()[0, skeleton.end_parents == toe] - standing.joint_positions()[0, toe]
        for tip in tips[np.linalg.norm(tips, axis=1) > 0]:  # without length in bandai
            assert _tilt(tip, np.array([1, 0, 0])) < 15
    for joint in ("hip", "shoulder"):
        assert _tilt(place[f"left_{joint}"] - place[f"right_{joint}"], np.array([0, 1, 0])) < 5
    assert _tilt(place["clavicle"] - place["pelvis"], np.array([0, 0, 1])) < 12
    assert _tilt(place["head"] - place["clavicle"], np.array([0, 0, 1])) < 15


@rigs
def test_signs_are_those_of_the_room(rig, walk):
    """Turned about y, to the left: a thigh swings forward by a negative angle, a knee flexes by a positive one."""
    skeleton = stand_upright(walk).skeleton
    joints = find_rig(skeleton.joint_names)
    for side in ("left", "right"):
        hip, knee = joints.joint(f"{side}_hip"), joints.joint(f"{side}_knee")
        forward = in_posture(skeleton, **{hip: [0, -30, 0]})
        reach = (forward.to_markers().marker(f"{side}_knee") - forward.to_markers().marker(f"{side}_hip"))[0]
        assert_allclose(reach / np.linalg.norm(reach), [0.5, 0, -np.sqrt(0.75)], atol=1e-6)
        other = "right" if side == "left" else "left"
        flexion = sum(
            w * forward.channels[0, forward.channel_names.index(c)] for c, w in forward.phase_channels.items()
        )
        assert flexion == pytest.approx(np.deg2rad(30 if other == "right" else -30))
        flexed = in_posture(skeleton, **{knee: [0, 60, 0]}).to_markers()
        shank = (flexed.marker(f"{side}_ankle") - flexed.marker(f"{side}_knee"))[0]
        assert_allclose(shank / np.linalg.norm(shank), [-np.sqrt(0.75), 0, -0.5], atol=1e-6)


@pytest.mark.parametrize("walks", [bandai_joints, cmu_joints])
def test_signs_hold_in_recorded_walks(walks, data_dir):
    names = ("dataset-2_walk_normal_001", "07_01")
    prepared = next(walk for walk in walks(data_dir) if walk.name in names)
    joints = find_rig(prepared.skeleton.joint_names)
    markers, flexion = prepared.to_markers(), prepared.channels @ _weights(prepared)
    apart_ahead = (markers.marker("left_knee") - markers.marker("right_knee"))[:, 0]
    assert np.corrcoef(flexion, apart_ahead)[0, 1] > 0.98
    for side in ("left", "right"):
        knee = np.rad2deg(prepared.rotations[:, prepared.skeleton.index(joints.joint(f"{side}_knee")), 1])
        assert -10 < knee.min() < 25
        assert 40 < knee.max() < 80


def _weights(walk):
    return np.array([walk.phase_channels.get(name, 0.0) for name in walk.channel_names])


def _below_a_top(skeleton):
    """Hang a skeleton from a joint that only says where the axes of the file lie, at a place of its own."""
    return Skeleton(
        ("Top", *skeleton.joint_names),
        [-1, *(skeleton.parents + 1)],
        [[0.3, -1.2, 0.05], *skeleton.offsets],
        skeleton.end_parents + 1,
        skeleton.end_offsets,
        root=skeleton.root + 1,
    )


@pytest.mark.parametrize("angle", [0.0, 1.9, np.pi])
def test_a_top_joint_that_holds_still_is_no_part_of_the_walk(angle):
    """A file may turn all its axes by one constant rotation; half a turn has two exponential maps, and jumps."""
    plain = turning(mixamo(), 3)
    skeleton = _below_a_top(plain.skeleton)
    axis = np.array([0.6, 0.0, 0.8])
    top = np.outer(
        angle * np.where(np.arange(plain.n_frames) % 2, -1, 1) if angle == np.pi else np.full(40, angle), axis
    )
    back = Rotation.from_rotvec(-angle * axis)
    rotations = np.concatenate((top[:, np.newaxis], plain.rotations), axis=1)
    rotations[:, 1] = (back * Rotation.from_rotvec(rotations[:, 1])).as_rotvec()
    root = back.apply(plain.root - skeleton.offsets[0])
    turned = JointWalk(rotations, root, skeleton, 30, "turned")
    assert_allclose(turned.joint_positions()[:, 1:], plain.joint_positions(), atol=1e-12)
    upright = stand_upright(turned)
    assert apart(upright, turned) < 1e-12
    assert_allclose(upright.rotations[:, 0], 0, atol=1e-12)
    assert_allclose(upright.rotations[:, 1:], stand_upright(plain).rotations, atol=1e-9)
    assert_allclose(upright.skeleton.offsets[2:], stand_upright(plain).skeleton.offsets[1:], atol=1e-12)
    assert apart(lean_back(upright, turned), turned) < 1e-12


def test_a_top_joint_that_turns_is_refused():
    turned = turning(_below_a_top(mixamo()), 0)
    rotations = np.array(turned.rotations)
    rotations[:, 0] += np.linspace(0, 1e-4, turned.n_frames)[:, np.newaxis]
    with pytest.raises(
        WalkError, match=r"'turning': expected joints above the root 'Hips' to stand still, but Top turn"
    ):
        stand_upright(replace(turned, rotations=rotations))


def test_the_arms_of_a_t_are_turned_down():
    """By hand: a left arm along y hangs after a quarter turn about -x, which carries its y to -z and its z to y."""
    skeleton = mixamo()
    frames = reference_frames(skeleton)
    assert_allclose(frames[skeleton.index("LeftArm")], [[1, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-12)
    assert_allclose(frames[skeleton.index("LeftHand")], frames[skeleton.index("LeftForeArm")], atol=1e-12)
    assert_allclose(frames[skeleton.index("Spine")], np.eye(3))
    upside_down = replace(skeleton, offsets=skeleton.offsets * [1, 1, -1])  # half a turn, about any axis across
    legs = stand_upright(still(upside_down)).skeleton.offsets
    for joint in ("LeftLeg", "RightFoot"):
        assert_allclose(legs[skeleton.index(joint)][:2], 0, atol=1e-12)
        assert legs[skeleton.index(joint)][2] < -0.4


def test_what_cannot_stand_is_refused():
    skeleton = mixamo()
    with pytest.raises(ValueError, match="reference must be 'zero', an array or None, got 'rest'"):
        reference_frames(skeleton, reference="rest")
    with pytest.raises(ValueError, match=r"reference must have shape \(22, 3\), got \(3, 3\)"):
        reference_frames(skeleton, reference=np.zeros((3, 3)))
    with pytest.raises(WalkError, match="expected finite values, got 1 NaN or infinite ones in reference y"):
        reference_frames(skeleton, reference=np.where(np.arange(66).reshape(22, 3) == 4, np.nan, 0))
    with pytest.raises(ValueError, match=r"no known rig .* fits the names joint0"):
        stand_upright(turning(random_skeleton(0), 0))
    offsets = np.where(np.array(skeleton.joint_names)[:, np.newaxis] == "LeftLeg", 0, skeleton.offsets)
    with pytest.raises(ValueError, match="the bone from 'LeftUpLeg' to 'LeftLeg' must have a length"):
        reference_frames(replace(skeleton, offsets=offsets))
    parents = np.array(skeleton.parents)
    parents[skeleton.index("LeftLeg")] = 0
    with pytest.raises(ValueError, match="joint 'LeftLeg' must hang from 'LeftUpLeg' in the skeleton, but does not"):
        reference_frames(replace(skeleton, parents=parents))
    with pytest.raises(ValueError, match="walk 'still' must have the joints of 'turning', joint0"):
        lean_back(still(skeleton), turning(random_skeleton(0), 0), reference="zero")


def test_an_upright_walk_written_to_a_file_stands_upright_when_it_is_read(data_dir, tmp_path):
    """Its bones lie along the axes of the room, whatever the rig says of files of its kind."""
    for walk in (*bandai_joints(data_dir, 1)[:2], *cmu_joints(data_dir)[:2]):
        write_walk(walk, tmp_path / "upright.bvh")
        again = stand_upright(read_walk(tmp_path / "upright.bvh"))
        np.testing.assert_allclose(again.rotations, walk.rotations, atol=1e-7)
        np.testing.assert_allclose(again.skeleton.offsets, walk.skeleton.offsets, atol=1e-7)
