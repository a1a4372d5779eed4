"""Plain anatomy of the 15 markers, whatever they are made from.

Lengths of bones are those of adults; the order from head to ankle is that of a body; and left, right and forward agree
with where the walk goes or the toes point, neither of which the rigs look at.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import WalkError
from eigenwalker.io import read_amc, read_c3d, read_kinect
from eigenwalker.motion import FEET, TROJE15, JointWalk, Skeleton, detect_events, find_rig, prepare
from eigenwalker.motion.body import leg_length
from tests.acclaim import AMC, ASF
from tests.marker_sets import horst_markers, known_body, plug_in_gait_markers
from tests.recorded import bandai_walks, cmu_walks

UP = np.array([0.0, 0.0, 1.0])
SIDES = ("left", "right")


def _median(walk, marker):
    return np.nanmedian(walk.marker(marker), axis=0)


def _facing(walk):
    """Return the vector the pelvis faces in each frame, from its left and right."""
    return np.cross(walk.marker("left_hip") - walk.marker("right_hip"), UP)


def assert_anatomy(walk, forward=None, *, legs=(0.7, 1.05), bent=True):
    """Raise unless the markers are those of an upright adult who faces `forward`, of shape (n_frames, 3) or (3,).

    None is the direction of the walk.
    """
    name = walk.name
    assert legs[0] < leg_length(walk) < legs[1], name
    for side in SIDES:
        chain = ("head", "clavicle", "pelvis", f"{side}_knee", f"{side}_ankle")
        heights = [_median(walk, marker)[2] for marker in chain]
        assert heights == sorted(heights, reverse=True), (name, chain)
        assert _median(walk, f"{side}_shoulder")[2] > _median(walk, f"{side}_elbow")[2], name
    stature = _median(walk, "head")[2] - min(_median(walk, f"{side}_ankle")[2] for side in SIDES)
    assert 1.1 < stature < 1.85, name
    lowest = np.minimum(walk.marker("left_ankle"), walk.marker("right_ankle"))[:, 2]
    assert all(np.median(walk.marker(marker)[:, 2] - lowest) >= 0 for marker in TROJE15.names), name

    facing = _facing(walk)
    ahead = np.gradient(walk.marker("pelvis"), axis=0) if forward is None else np.broadcast_to(forward, facing.shape)
    assert np.median(np.sum(facing * ahead, axis=1)) > 0, name
    across = walk.marker("left_shoulder") - walk.marker("right_shoulder")
    assert np.median(np.sum(np.cross(UP, ahead) * across, axis=1)) > 0, name
    assert not bent or all(_knee_lead(walk, side) > 0 for side in SIDES), name


def _knee_lead(walk, side):
    """Return how far the knee is in front of the line from hip to ankle when it is bent most, in the swing."""
    hip, knee, ankle = (walk.marker(f"{side}_{joint}") for joint in ("hip", "knee", "ankle"))
    bend = (
        np.linalg.norm(hip - knee, axis=1) + np.linalg.norm(knee - ankle, axis=1) - np.linalg.norm(hip - ankle, axis=1)
    )
    lead = np.sum((knee - (hip + ankle) / 2) * _facing(walk), axis=1)
    return np.median(lead[bend >= np.quantile(bend, 0.8)])


def assert_feet(walk):
    """Raise unless the toes are in front of the ankles, the heels behind them, and both below."""
    facing = _facing(walk)
    for side in SIDES:
        ankle, toe, heel = (walk.marker(f"{side}_{part}") for part in ("ankle", "toe", "heel"))
        assert np.median(np.sum((toe - ankle) * facing, axis=1)) > 0, walk.name
        assert np.median(np.sum((heel - ankle) * facing, axis=1)) < 0, walk.name
        assert np.median(heel[:, 2]) < np.median(ankle[:, 2]), walk.name


def _between_hips(walk):
    return (walk.marker("left_hip") + walk.marker("right_hip")) / 2


def _without_zeros(walk):
    return walk.with_channels(walk.channels[2:])  # a file starts with two frames of zeros


def test_bandai(data_dir):
    for walk in bandai_walks(data_dir)[0]:
        assert_anatomy(walk.to_markers())


def test_cmu(data_dir):
    for walk in cmu_walks(data_dir)[0]:
        assert_anatomy(_without_zeros(walk.to_markers()))


@pytest.mark.parametrize("prefix", ["", "mixamorig:"])
def test_mixamo(data_dir, prefix):
    """A skeleton of CMU in Mixamo's names, which has one joint in the neck."""
    renamed = {"Neck": "Spine2", "Neck1": "Neck"}
    walk = cmu_walks(data_dir)[0][2]
    old = walk.skeleton
    names = tuple(prefix + renamed.get(joint, joint) for joint in old.joint_names)
    skeleton = Skeleton(names, old.parents, old.offsets, root=old.root)
    walk = JointWalk(walk.rotations, walk.root, skeleton, walk.frame_rate, walk.name)
    assert find_rig(names).name == ("mixamorig" if prefix else "mixamo")
    assert_anatomy(_without_zeros(walk.to_markers()))


def test_asf(tmp_path):
    """A standing body with its arms to the side; it faces x."""
    (tmp_path / "07.asf").write_text(ASF)
    (tmp_path / "07_01.amc").write_text(AMC)
    walk = read_amc(tmp_path / "07_01.amc")
    assert find_rig(walk.skeleton.joint_names).name == "asf"
    drop = [TROJE15.index(f"{side}_elbow") for side in SIDES]
    walk = walk.to_markers()
    positions = walk.positions.copy()
    positions[:, drop, 2] -= 1e-6  # below the shoulders, with which they are level
    assert_anatomy(replace(walk, positions=positions), (1.0, 0.0, 0.0), bent=False)


def test_kinect(data_dir):
    """Every tenth recording. The camera turns with the walker, so that only the toes say what is forward.

    They are as noisy as the depth of the knees, which a few recordings have behind the leg.
    """
    paths = sorted((data_dir / "kinect").glob("*/*.txt"))[::10]
    leads = []
    for path in paths:
        recorded = read_kinect(path)
        assert find_rig(recorded.marker_set.names).name == "kinect"
        walk = recorded.to_markers()
        toes = sum(recorded.marker(f"{side}_foot") - recorded.marker(f"{side}_ankle") for side in SIDES)
        assert_anatomy(walk, toes * [1.0, 1.0, 0.0], bent=False)
        assert_allclose(walk.marker("pelvis"), _between_hips(walk))
        leads += [_knee_lead(walk, side) for side in SIDES]
    assert len(leads) == 50
    assert np.mean(np.array(leads) > 0) > 0.9


@pytest.mark.parametrize("medial", [("KNM", "MED"), ("MKNE", "MANK"), ("KNEM", "ANKM"), None])
@pytest.mark.parametrize("sacrum", [False, True])
def test_plug_in_gait(medial, sacrum):
    """Hips exactly where the regression puts them; without medial markers knees and ankles within 15 mm, shoulders and
    elbows within 20 mm."""
    for seed in range(3):
        body = known_body(seed)
        recorded = plug_in_gait_markers(body, medial=medial, sacrum=sacrum)
        assert find_rig(recorded.marker_set.names).name == "plug-in gait"
        walk = recorded.to_markers(feet=True)
        assert_anatomy(walk, (1.0, 0.0, 0.0), legs=(0.65, 1.05))
        assert_feet(walk)
        for marker in ("head", "clavicle", "left_hip", "right_hip", "left_wrist", "right_wrist"):
            assert_allclose(walk.marker(marker), body.marker(marker), atol=1e-9)
        assert_allclose(walk.marker("pelvis"), _between_hips(body), atol=1e-9)
        exact = ("knee", "ankle") if medial else ()
        for joint, bound in (("shoulder", 0.02), ("elbow", 0.02), ("knee", 0.015), ("ankle", 0.015)):
            for side in SIDES:
                error = np.linalg.norm(walk.marker(f"{side}_{joint}") - body.marker(f"{side}_{joint}"), axis=1)
                assert error.max() < (1e-9 if joint in exact else bound), (seed, side, joint)


def test_horst_from_known_bodies():
    for seed in range(3):
        body = known_body(seed)
        recorded = horst_markers(body)
        assert find_rig(recorded.marker_set.names).name == "horst"
        walk = recorded.to_markers(feet=True)
        assert_anatomy(walk, (1.0, 0.0, 0.0), legs=(0.65, 1.05))
        assert_feet(walk)
        error = np.linalg.norm(walk.positions[:, :15] - body.positions, axis=2).max(axis=0)
        shoulders = [TROJE15.index(f"{side}_shoulder") for side in SIDES]
        assert error[shoulders].max() < 0.02
        assert np.delete(error, [*shoulders, TROJE15.index("pelvis")]).max() < 1e-9
        assert_allclose(walk.marker("pelvis"), _between_hips(body), atol=1e-9)


@pytest.fixture(scope="module")
def horst(data_dir):
    """Return the ten walks and the static trial of `horst_c3d`."""
    folder = data_dir / "horst_c3d"
    static = read_c3d(folder / "S01_0001_Static.c3d")
    return [read_c3d(path) for path in sorted(folder.glob("*Gait.c3d"))], static


def test_horst(horst):
    """He walks along x, and stands facing y in the static trial."""
    walks, static = horst
    assert_anatomy(static.to_markers(), (0.0, 1.0, 0.0))
    assert_feet(static.to_markers(feet=True))
    for recorded in walks:
        walk = recorded.to_markers(static=static, feet=True)
        assert_anatomy(walk)
        assert_anatomy(walk, (1.0, 0.0, 0.0))
        assert_feet(walk)
        assert_allclose(leg_length(walk), leg_length(static.to_markers()), atol=1e-3)


def test_horst_asks_for_its_static_trial(horst):
    walks, _ = horst
    with pytest.raises(
        WalkError, match=r"'S01_0002_Gait': no known rig .* \(the nearest, horst, lacks L ANKLE LAT, .*"
    ):
        walks[0].to_markers()


def test_known_marker_sets_go_straight_into_prepare(data_dir):
    """The same walk comes out as from the 15 markers that were asked for first."""
    body = known_body(0, n_frames=2000)
    recorded = plug_in_gait_markers(body)
    prepared = prepare(recorded)
    assert prepared.marker_set is TROJE15
    assert_allclose(prepared.positions, prepare(recorded.to_markers()).positions)


def test_events_travel_to_the_15_markers(horst):
    walks, static = horst
    walk = detect_events(walks[0].to_markers(static=static, feet=True))
    assert walk.marker_set.names == TROJE15.names + FEET
    assert len(walk.events) == 6
    assert walk.to_markers().events == walk.events
    assert walk.to_markers().marker_set is TROJE15
