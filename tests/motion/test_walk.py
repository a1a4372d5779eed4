"""The containers, and the joints that carry markers."""

import copy
import pickle
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.motion import TROJE15, Event, JointWalk, MarkerSet, Rig, Skeleton, Walk, find_rig


def _skeleton():
    return Skeleton(("hips", "knee", "foot"), [-1, 0, 1], [[0, 0, 0], [0, 0, -0.4], [0, 0, -0.5]], [2], [[0.2, 0, 0]])


def _joint_walk(**fields):
    return JointWalk(np.zeros((4, 3, 3)), np.tile([0.0, 0, 0.9], (4, 1)), _skeleton(), 30, **fields)


def test_channels_are_positions_in_order():
    positions = np.arange(2 * 15 * 3.0).reshape(2, 15, 3)
    walk = Walk(positions, 60)
    assert walk.channel_names[:4] == ("head_x", "head_y", "head_z", "clavicle_x")
    assert_allclose(walk.channels[1, walk.channel_names.index("left_knee_z")], positions[1, 10, 2])
    assert_allclose(walk.with_channels(walk.channels).positions, positions)
    assert_allclose(walk.marker("left_knee"), positions[:, 10])


@pytest.mark.parametrize("walk", [Walk(np.zeros((3, 15, 3)), 60, name="anna"), _joint_walk(name="anna")])
def test_walks_cannot_be_changed(walk):
    with pytest.raises(FrozenInstanceError):
        walk.frame_rate = 1
    for copied in (walk, copy.deepcopy(walk), pickle.loads(pickle.dumps(walk))):
        with pytest.raises(ValueError, match="read-only"):
            copied.channels[0, 0] = 1
        assert copied.name == "anna"


@pytest.mark.parametrize("walk", [Walk(np.zeros((3, 15, 3)), 60), _joint_walk()])
def test_numpy_does_not_take_walks_apart(walk):
    assert np.array([walk, None], dtype=object)[0] is walk
    assert not hasattr(walk, "__len__")
    assert not hasattr(walk, "__array__")


def test_the_array_passed_in_is_not_shared():
    positions = np.zeros((3, 15, 3))
    walk = Walk(positions, 60)
    positions[:] = 9
    assert walk.positions.max() == 0


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (
            {"positions": np.zeros((3, 14, 3))},
            ValueError,
            r"positions must have shape \(n_frames, 15, 3\), got \(3, 14, 3\)",
        ),
        ({"positions": "walk"}, ValueError, "positions must be an array of numbers"),
        ({"positions": np.zeros((0, 15, 3))}, ValueError, "at least one frame"),
        ({"frame_rate": 0}, ValueError, "frame_rate must be positive and finite, in frames per second, got 0"),
        ({"frame_rate": "fast"}, TypeError, "frame_rate must be a number"),
        ({"marker_set": "troje"}, TypeError, "marker_set must be a MarkerSet, got str"),
        ({"name": 3}, TypeError, "name must be a string"),
        ({"size": 0.0}, ValueError, "size must be positive"),
        ({"frequency": -1.0}, ValueError, "frequency must be positive and finite, or NaN where unknown, got -1"),
        (
            {"events": ("strike",)},
            TypeError,
            r"events must be Event\(time, kind, side\) with finite times, got 'strike'",
        ),
    ],
)
def test_wrong_fields_are_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        Walk(**{"positions": np.zeros((3, 15, 3)), "frame_rate": 60} | arguments)


def test_joints_hang_below_each_other():
    walk = _joint_walk()
    assert_allclose(walk.joint_positions()[0], [[0, 0, 0.9], [0, 0, 0.5], [0, 0, 0]], atol=1e-12)
    assert_allclose(walk.end_positions()[0], [[0.2, 0, 0]], atol=1e-12)


def test_turning_the_hip_swings_the_leg():
    """A quarter turn about y, to the left, brings what hangs down to the back."""
    rotations = np.zeros((4, 3, 3))
    rotations[:, 0, 1] = np.pi / 2
    walk = replace(_joint_walk(), rotations=rotations)
    assert_allclose(walk.joint_positions()[0], [[0, 0, 0.9], [-0.4, 0, 0.9], [-0.9, 0, 0.9]], atol=1e-12)


def test_translations_replace_offsets():
    path = np.tile([0.0, 0.1, -0.3], (4, 1))
    walk = _joint_walk(translations={"knee": path})
    assert_allclose(walk.joint_positions()[0, 1], [0, 0.1, 0.6], atol=1e-12)
    with pytest.raises(ValueError, match="translations must name joints of the skeleton, got wing"):
        _joint_walk(translations={"wing": path})


def test_unknown_skeletons_ask_for_a_rig():
    with pytest.raises(
        ValueError, match=r"no known rig \(bandai, cmu, .*\) fits the names hips, knee, foot; pass rig="
    ):
        _joint_walk().to_markers()
    places = {name: {"hips": 0.5, "foot": 0.5} for name in TROJE15.names}
    for rig in (places, Rig("peg", places)):
        assert_allclose(_joint_walk().to_markers(rig).positions, np.tile([0, 0, 0.45], (4, 15, 1)), atol=1e-12)
    with pytest.raises(ValueError, match="rig 'peg' needs tail; found hips, knee, foot"):
        _joint_walk().to_markers(Rig("peg", dict.fromkeys(TROJE15.names, "tail")))


def test_mixamo_skeletons_are_known_with_and_without_prefix():
    names = ["Hips", "Neck", "Head"]
    names += [f"{side}{part}" for side in ("Left", "Right") for part in ("Shoulder", "Arm", "ForeArm", "Hand")]
    names += [f"{side}{part}" for side in ("Left", "Right") for part in ("UpLeg", "Leg", "Foot", "ToeBase")]
    prefixed = [f"mixamorig:{name}" for name in names]
    assert (find_rig(names).name, find_rig(prefixed).name) == ("mixamo", "mixamorig")
    positions = np.random.default_rng(0).normal(size=(2, len(names), 3))
    assert_allclose(find_rig(names).place(names, positions), find_rig(prefixed).place(prefixed, positions))
    assert find_rig([*names, "Neck1"]).name == "cmu"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"parents": [0, 0, 1]}, "parents must be -1 for the first joint"),
        ({"parents": [-1, 2, 1]}, "parents must be -1 for the first joint and an earlier joint"),
        ({"parents": [-1, 0]}, r"parents must have shape \(3,\)"),
        ({"end_parents": [5]}, "end_parents must be positions of joints below 3"),
        ({"root": 3}, "root must be the position of a joint below 3, got 3"),
        ({"joint_names": ("a", "a", "b")}, "joint_names must differ from each other, but these repeat: a"),
    ],
)
def test_wrong_skeletons_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        replace(_skeleton(), **changes)


def test_marker_sets_know_both_sides():
    assert TROJE15.names[8] == "pelvis"
    names = [TROJE15.names[i] for i in TROJE15.mirror]
    assert names[2:5] == ["right_shoulder", "right_elbow", "right_wrist"]
    with pytest.raises(ValueError, match="without a partner on the other side: left_hand"):
        _ = MarkerSet(("left_hand",)).mirror
    with pytest.raises(ValueError, match="no marker 'tail'; this marker set has left_hand"):
        MarkerSet(("left_hand",)).index("tail")
    with pytest.raises(ValueError, match="sticks must join known markers, got nose"):
        MarkerSet(("left_hand",), (("left_hand", "nose"),))


def test_events_are_ordered_and_travel_along():
    events = (Event(0.1, "toe_off", "left"), Event(0.05, "heel_strike", "right"))
    assert Walk(np.zeros((9, 15, 3)), 60, events=events).events == events[::-1]
    assert _joint_walk(events=events).events[0].side == "right"
