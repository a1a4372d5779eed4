"""Walks of several people on one body: rotations stay, feet stay near the floor, and other trees are refused."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import FourierLinearizer, WalkError
from eigenwalker.motion import JointWalk, Skeleton, find_rig, share_skeleton, stand_upright
from eigenwalker.motion.joint_preparation import scale_body
from tests.joint_bodies import apart, body, mixamo, over_floor, still, swinging, turned
from tests.recorded import bandai_joints, cmu_joints


def _walks(n=2):
    """Return walks of people of one tree of joints, each with other bones."""
    walks = [swinging(0.05 * np.arange(300), seed=seed, name=f"person {seed}") for seed in range(n)]
    return [_other_bones(walk, seed) for seed, walk in enumerate(walks)]


def _other_bones(walk, seed):
    rng = np.random.default_rng(seed)
    skeleton = walk.skeleton
    lengths = rng.uniform(0.9, 1.1, size=(len(skeleton.offsets), 1))
    tips = rng.uniform(0.9, 1.1, size=(len(skeleton.end_offsets), 1))
    other = replace(skeleton, offsets=skeleton.offsets * lengths, end_offsets=skeleton.end_offsets * tips)
    return replace(walk, skeleton=other)


def _lowest(walk):
    """Return the height of the lower ankle or toe joint in each frame, in metres."""
    names, rig = walk.skeleton.joint_names, find_rig(walk.skeleton.joint_names)
    ankles = [names.index(rig.joint(f"{side}_ankle")) for side in ("left", "right")]
    toes = np.flatnonzero(np.isin(walk.skeleton.parents, ankles))
    return walk.joint_positions()[:, [*ankles, *toes], 2].min(axis=1)


def test_only_bones_and_heights_change():
    walks = _walks(3)
    shared = share_skeleton(walks)
    for walk, other in zip(walks, shared, strict=True):
        assert other.skeleton is shared[0].skeleton
        assert_array_equal(other.rotations, walk.rotations)
        assert_array_equal(other.root[:, :2], walk.root[:, :2])
        assert (other.name, other.frame_rate, other.channel_names) == (walk.name, walk.frame_rate, walk.channel_names)
    assert_allclose(shared[0].skeleton.offsets, np.mean([walk.skeleton.offsets for walk in walks], axis=0))
    assert_allclose(shared[0].skeleton.end_offsets, np.mean([walk.skeleton.end_offsets for walk in walks], axis=0))
    again = share_skeleton(shared)
    assert max(apart(one, other) for one, other in zip(again, shared, strict=True)) < 1e-12


def test_features_stay():
    """Rotations are all that is in them: a shared body changes no number, and all numbers make walks on it."""
    walks = _walks()
    linearizer = FourierLinearizer().fit(walks)
    assert_array_equal(linearizer.transform(share_skeleton(walks)), linearizer.transform(walks))


@given(factor=st.floats(0.5, 2.0))
def test_a_larger_body_comes_back_to_the_size_of_the_skeleton(factor):
    """The root as high as the legs are long: only sway over the floor keeps its millimeters."""
    (walk,) = _walks(1)
    (back,) = share_skeleton([scale_body(walk, factor)], walk.skeleton)
    assert back.skeleton is walk.skeleton
    assert_allclose(back.root[:, 2], walk.root[:, 2], atol=1e-12)
    assert_allclose(back.root[:, :2], factor * walk.root[:, :2], atol=1e-12)


def test_one_walk_and_walks_of_one_body_stay():
    (walk,) = _walks(1)
    for same in share_skeleton([walk, walk]):
        assert apart(same, walk) < 1e-12


@given(degrees=st.floats(-180, 180))
def test_turning_the_walk_and_changing_its_body_commute(degrees):
    walk, other = _walks()
    walk = over_floor(walk)
    (one,) = share_skeleton([turned(walk, degrees)], other.skeleton)
    (two,) = share_skeleton([walk], other.skeleton)
    assert apart(one, turned(two, degrees)) < 1e-12


def test_legs_decide_by_hand():
    """Legs of 0.8 m under a pelvis at 0.9 m, and legs of 1.0 m: it rises to 1.125 m, by way of a top joint 0.1 m up."""
    skeleton = stand_upright(still(mixamo())).skeleton
    bones = np.array(skeleton.offsets)
    for side in ("Left", "Right"):
        bones[skeleton.index(f"{side}Leg")] = bones[skeleton.index(f"{side}Foot")] = [0, 0, -0.4]
    short = replace(skeleton, offsets=bones)
    for side in ("Left", "Right"):
        bones[skeleton.index(f"{side}Leg")] = [0, 0, -0.6]
    (risen,) = share_skeleton([still(short)], replace(skeleton, offsets=bones))
    assert_allclose(risen.root, [[0, 0, 1.125]])
    low, high = _below_a_top(short, 0.1), _below_a_top(replace(skeleton, offsets=bones), 0.3)
    walk = JointWalk(np.zeros((1, 23, 3)), [[0, 0, 0.8]], low, 30)
    (risen,) = share_skeleton([walk], high)
    assert_allclose(risen.joint_positions()[0, 1], [0, 0, 1.125])


def _below_a_top(skeleton, height):
    """Hang an upright skeleton from a joint at a height."""
    return Skeleton(
        ("Top", *skeleton.joint_names),
        [-1, *(skeleton.parents + 1)],
        [[0, 0, height], *skeleton.offsets],
        skeleton.end_parents + 1,
        skeleton.end_offsets,
        root=1,
        upright=True,
    )


def test_feet_of_two_people_stay_near_the_floor(data_dir):
    """Within 2 cm of where they were, seen 1.3: one factor for legs leaves feet of other heights."""
    walks = [walk for walk in cmu_joints(data_dir) if walk.name in ("05_01", "08_01")]
    shared = share_skeleton(walks)
    legs = [np.linalg.norm(walk.skeleton.offsets[walk.skeleton.index("LeftLeg")]) for walk in (*walks, *shared)]
    assert abs(legs[0] - legs[1]) > 0.005
    assert legs[2] == legs[3] == pytest.approx((legs[0] + legs[1]) / 2)
    for walk, other in zip(walks, shared, strict=True):
        assert np.abs(_lowest(other) - _lowest(walk)).max() < 0.02
        assert_array_equal(other.channels, walk.channels)


def test_walks_of_one_performer_hardly_change(data_dir):
    walks = bandai_joints(data_dir)
    for walk, other in zip(walks, share_skeleton(walks), strict=True):
        assert_allclose(other.to_markers().positions, walk.to_markers().positions, atol=1e-4)


def test_a_rig_of_ones_own_will_do():
    walks = _walks()
    names = {joint: f"my {joint}" for joint in walks[0].skeleton.joint_names}
    known = find_rig(walks[0].skeleton.joint_names).markers
    rig = {
        marker: names[place] if isinstance(place, str) else {names[joint]: share for joint, share in place.items()}
        for marker, place in known.items()
    }
    others = [_renamed(walk, names) for walk in walks]
    for one, other in zip(share_skeleton(walks), share_skeleton(others, rig=rig), strict=True):
        assert_array_equal(other.root, one.root)
    with pytest.raises(ValueError, match="no known rig"):
        share_skeleton(others)


def _renamed(walk, names):
    joints = tuple(names.get(joint, joint) for joint in walk.skeleton.joint_names)
    return replace(walk, skeleton=replace(walk.skeleton, joint_names=joints))


def test_other_trees_are_refused_all_at_once():
    first, second = _walks()
    renamed = replace(_renamed(first, {"Head": "Skull"}), name="anna")
    parents = np.array(first.skeleton.parents)
    parents[first.skeleton.index("LeftArm")] = first.skeleton.index("Spine2")
    moved = replace(first, skeleton=replace(first.skeleton, parents=parents), name="bert")
    loose = replace(first, translations={"Head": np.zeros((300, 3))}, name="")
    recorded = still(mixamo())
    with pytest.raises(WalkError) as caught:
        share_skeleton([first, second, renamed, moved, loose, recorded])
    assert str(caught.value).splitlines() == [
        "4 of 6 walks cannot be put on one skeleton; prepare all of them with representation='joints', and bring their "
        "files to one tree of joints, or leave them out:",
        "  anna: lacks Head; has unknown joints Skull",
        "  bert: hangs elsewhere: LeftArm from Spine2 instead of LeftShoulder",
        "  walk 4: has bones that change in length: Head",
        "  still: is in the axes of a file; use prepare(walk, representation='joints') or stand_upright(walk)",
    ]


def test_other_layouts_of_the_same_tree_are_refused():
    (walk,) = _walks(1)
    skeleton = walk.skeleton
    names = list(skeleton.joint_names)
    head, arm = names.index("Head"), names.index("LeftShoulder")
    order = np.arange(len(names))
    order[[head, arm]] = arm, head
    swapped = replace(
        skeleton,
        joint_names=tuple(np.array(names)[order].tolist()),
        parents=np.argsort(order)[skeleton.parents[order]] * (skeleton.parents[order] >= 0)
        - (skeleton.parents[order] < 0),
    )
    tipless = replace(skeleton, end_parents=[], end_offsets=np.empty((0, 3)))
    for other, message in (
        (swapped, "person 0: has another order of joints: Hips, Spine, Spine1"),
        (replace(skeleton, root=1), "person 0: has another root: Spine instead of Hips"),
        (tipless, "person 0: has other tips: none instead of Head, LeftHand"),
    ):
        with pytest.raises(WalkError, match=message):
            share_skeleton([walk, replace(walk, skeleton=other)])


def test_wrong_kinds_are_refused(tmp_path):
    (walk,) = _walks(1)
    with pytest.raises(ValueError, match=r"skeleton must be upright, such as stand_upright\(walk\)\.skeleton"):
        share_skeleton([walk], mixamo())
    with pytest.raises(TypeError, match="skeleton must be a Skeleton, got JointWalk"):
        share_skeleton([walk], walk)
    with pytest.raises(TypeError, match="expected a list of JointWalk, got Walk at position 1"):
        share_skeleton([walk, walk.to_markers()])
    with pytest.raises(TypeError, match="expected a list of walks, got a single JointWalk"):
        share_skeleton(walk)
    with pytest.raises(WalkError, match=r"1 of 1 walks .*\n  07_01: lacks Hips, Spine"):
        share_skeleton([stand_upright(body("asf", tmp_path, None))], walk.skeleton)
