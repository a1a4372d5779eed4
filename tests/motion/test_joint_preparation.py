"""Walks in joint angles on a treadmill: what is in them, what each option does, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import WalkError, WalkPreparer, prepare, read_walk
from eigenwalker.motion import (
    TROJE15,
    Rig,
    explained_power,
    find_rig,
    low_pass,
    prepare_walks,
    stand_upright,
    stature,
    stride_frequency,
)
from eigenwalker.motion.joint_preparation import joints_of_all, moving_joints
from tests import contract
from tests.joint_bodies import over_floor, swinging
from tests.synthetic import make_walk


def _joints(walk, **options):
    return prepare(walk, representation="joints", **options)


def _clean():
    """Return a walk over the floor without noise."""
    return over_floor(swinging(2 * np.pi * 0.93 / 120 * np.arange(800)))


@pytest.fixture
def recorded(data_dir):
    """Return one recorded walk."""
    return read_walk(data_dir / "bandai2" / "dataset-2_walk_normal_001.bvh")


# What is in the result.


def test_it_stands_upright_in_place_and_leads_along_x(recorded):
    walk = _joints(recorded)
    assert walk.skeleton.upright
    assert np.abs(walk.root[:, :2]).max() < 0.1
    assert_allclose(walk.root[:, 2].mean(), recorded.root[:, 2].mean(), atol=0.02)
    markers = walk.to_markers()
    assert (markers.marker("left_hip") - markers.marker("right_hip"))[:, 1].min() > 0.1
    bones = np.linalg.norm(np.diff(markers.positions[:, TROJE15.index("left_hip") :][:, :3], axis=1), axis=2)
    assert np.ptp(bones, axis=0).max() < 1e-12


def test_stature_is_one_and_comes_back(recorded):
    walk = _joints(recorded, normalize_size=True)
    assert stature(walk.to_markers()) == pytest.approx(1)
    (restored,) = WalkPreparer(representation="joints").inverse_transform([walk])
    assert restored.size == 1
    assert_allclose(restored.skeleton.offsets, stand_upright(recorded).skeleton.offsets, atol=1e-12)
    way = (restored.root - walk.root * walk.size)[-1]
    assert_allclose(way, [walk.speed * (walk.n_frames - 1) / walk.frame_rate, 0, 0], atol=1e-9)


def test_options_do_what_they_say(recorded):
    assert _joints(recorded, clip="whole").n_frames == recorded.n_frames
    events = _joints(recorded, frequency="events")
    assert stride_frequency(events) == events.frequency
    assert {event.kind for event in events.events} == {"heel_strike", "toe_off"}
    smooth = _joints(recorded, cutoff=6.0, clip="whole", treadmill=False, heading=None)
    assert_allclose(smooth.rotations, low_pass(stand_upright(recorded), cutoff=6.0).rotations, atol=1e-12)
    plain, steady = _joints(recorded), _joints(recorded, cadence="steady")
    powers = [explained_power(w.channels, w.frame_rate, stride_frequency(w), 2) for w in (plain, steady)]
    assert powers[0] < powers[1]
    assert np.isnan(steady.frequency)
    known = _joints(recorded, frequency_range=(0.6, 1.4))
    assert_allclose(known.frequency, stride_frequency(plain), rtol=1e-6)


@pytest.mark.parametrize("options", [{}, {"frequency_range": (0.6, 1.4)}, {"cadence": "steady"}], ids=str)
def test_the_choice_of_joints_changes_channels_only(recorded, options):
    every, few = _joints(recorded, **options), _joints(recorded, joints=["Head", "Hips"], **options)
    assert len(every.channel_joints) == 21
    assert "joint_Root" not in every.channel_joints
    assert few.channel_names == tuple(f"{joint}_{axis}" for joint in ("Hips", "Head") for axis in "xyz")
    assert_array_equal(few.rotations, every.rotations)
    assert_array_equal(few.frequency, every.frequency)


def test_a_rig_of_ones_own_will_do(recorded):
    """Joints with other names, and a rig that says which they are: also where the phase is asked for."""
    skeleton = recorded.skeleton
    names = {joint: f"my {joint}" for joint in skeleton.joint_names}
    other = replace(recorded, skeleton=replace(skeleton, joint_names=tuple(names.values())))
    rig = {
        marker: names[place] if isinstance(place, str) else {names[joint]: weight for joint, weight in place.items()}
        for marker, place in find_rig(skeleton.joint_names).markers.items()
    }
    known = find_rig(skeleton.joint_names).posture
    posture = known._replace(axes={names[joint]: axes for joint, axes in known.axes.items()})
    rig = Rig("mine", rig, posture)
    for options in ({}, {"frequency_range": (0.6, 1.4)}, {"cadence": "steady"}):
        prepared = _joints(other, rig=rig, **options)
        assert_allclose(
            prepared.to_markers(rig).positions, _joints(recorded, **options).to_markers().positions, atol=1e-6
        )


# Joints that stand still, and joints that wander.


def _with_head(walk, still):
    rotations = np.array(walk.rotations)
    head = walk.skeleton.index("Head")
    rotations[:, head] = rotations[0, head] if still else rotations[:, head]
    return replace(walk, rotations=rotations)


def test_joints_that_turn_in_any_walk_have_channels_in_all(recorded):
    stiff, free = _with_head(recorded, still=True), recorded
    assert "Head" not in _joints(stiff).channel_joints
    assert "Head" not in moving_joints([stiff])
    assert "Head" in joints_of_all([stiff, free])
    both = prepare_walks([stiff, free], representation="joints")
    assert both[0].channel_names == both[1].channel_names
    preparer = WalkPreparer(representation="joints")
    assert len(preparer.fit([stiff, free]).joints_) == 21
    assert preparer.transform([stiff])[0].channel_joints == preparer.joints_
    assert "Head" not in preparer.fit([stiff]).joints_
    assert "Head" not in preparer.transform([free])[0].channel_joints
    assert WalkPreparer(representation="joints", joints=("Head",)).fit([free]).joints_ == ("Head",)
    assert WalkPreparer().fit([free]).joints_ is None
    assert joints_of_all([free, _clean()]) is None
    assert joints_of_all([free, prepare(free)]) is None


def _wandering(walk, lengths):
    """Let joints wander along x, from end to end by a length."""
    wave = np.sin(np.arange(walk.n_frames))
    wave = (wave - wave.min()) / np.ptp(wave) - 0.5
    skeleton = walk.skeleton
    paths = {
        joint: skeleton.offsets[skeleton.index(joint)] + np.outer(length * wave, [1, 0, 0])
        for joint, length in lengths.items()
    }
    return replace(walk, translations=paths)


def test_bones_that_change_a_little_are_averaged_with_a_warning():
    walk = _wandering(_clean(), {"Head": 0.019, "LeftHand": 0.001})
    with pytest.warns(
        UserWarning, match=r"'anna': LeftHand, Head move by up to 0\.019 m .*mean offsets are taken|Head, "
    ):
        rigid = _joints(walk)
    assert not rigid.translations
    assert_allclose(rigid.skeleton.offsets[rigid.skeleton.index("Head")], walk.translations["Head"].mean(axis=0))


def test_bones_that_change_by_centimeters_are_refused():
    walk = _wandering(_clean(), {"Head": 0.021, "LeftHand": 0.05, "LeftFoot": 0.001})
    message = r"'anna': expected bones of constant length, but .* by Head 0\.021 m, LeftHand 0\.05 m, more than 0\.02 m"
    with pytest.raises(WalkError, match=message):
        _joints(walk)
    gap = walk.translations["LeftFoot"].copy()
    gap[3] = np.nan
    with pytest.raises(WalkError, match="expected bones of constant length"):
        _joints(replace(walk, translations={"LeftFoot": gap}))


# Refusals.


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"max_gap": 0.1}, "max_gap can be asked for with representation='markers' only"),
        ({"camera": "moving"}, "camera='moving' can be asked"),
        ({"heading": "curve", "symmetrize": True}, "heading='curve', symmetrize=True can be asked"),
        ({"representation": "angles"}, "representation must be one of 'markers', 'joints', got 'angles'"),
        ({"heading": "north"}, "heading must be one of 'path', 'body', None, got 'north'"),
        ({"clip": "some"}, "clip must be one of"),
        ({"frequency": "some"}, "frequency must be one of"),
        ({"cadence": "some"}, "cadence must be one of"),
        ({"joints": ["Tail"]}, "no joint 'Tail'; this skeleton has Hips, Spine"),
        ({"reference": "rest"}, "reference must be 'zero', an array or None, got 'rest'"),
        ({"representation": "markers", "joints": ["Hips"]}, "joints can be given with representation='joints' only"),
        ({"representation": "markers", "reference": "zero", "joints": []}, "reference and joints can be given"),
        ({"treadmill": False, "cadence": "steady"}, r"'anna': expected a walk in place, got one that travels at 1\.3"),
    ],
)
def test_what_cannot_be_done_is_refused(options, message):
    with pytest.raises(ValueError, match=message):
        prepare(_clean(), **{"representation": "joints", **options})


def test_what_cannot_be_used_is_refused():
    walk = _clean()
    with pytest.raises(TypeError, match=r"representation='joints' needs a JointWalk, .* got Walk; markers do not say"):
        _joints(make_walk(np.random.default_rng(0))[0])
    with pytest.raises(TypeError, match="joints must be a sequence of names, got the single string 'Hips'"):
        _joints(walk, joints="Hips")
    rotations = np.array(walk.rotations)
    rotations[3, walk.skeleton.index("Head"), 2] = np.nan
    with pytest.raises(WalkError, match="'anna': expected finite values, got 1 NaN or infinite ones in Head_z"):
        _joints(replace(walk, rotations=rotations, channel_joints=("Hips",)))
    root = np.array(walk.root)
    root[3, 0] = np.inf
    with pytest.raises(WalkError, match="ones in root x"):
        _joints(replace(walk, root=root))


@pytest.mark.parametrize("check", contract.CHECKS, ids=lambda check: check.__name__)
def test_contract(check):
    walks = [over_floor(swinging(0.05 * np.arange(500), seed=seed)) for seed in range(3)]
    check(WalkPreparer(representation="joints"), walks)
