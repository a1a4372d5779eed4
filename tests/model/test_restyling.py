"""Recordings moved along trait axes: at alpha 0 they are themselves, and else all but the axis stays."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import (
    JointWalk,
    Skeleton,
    WalkError,
    WalkPreparer,
    make_eigenwalkers,
    make_walkers,
    prepare,
    read_walk,
    read_walks,
    restyle_walk,
    walk_at,
)
from eigenwalker.model import OutsideDataWarning, axis_features
from eigenwalker.motion import quality_table, sole_points, stand_upright, stride_frequency
from eigenwalker.motion.limits import JointLimitWarning
from eigenwalker.motion.recorded_gait import find_gait
from tests.bvh_fingers import add_fingers
from tests.joint_bodies import turned
from tests.recorded import cmu_joints

pytestmark = [
    pytest.mark.filterwarnings("ignore::eigenwalker.model.OutsideDataWarning"),
    pytest.mark.filterwarnings("ignore::eigenwalker.motion.limits.JointLimitWarning"),
    pytest.mark.filterwarnings("ignore:walk .* the limbs leap"),
]

_BLOCKS = ("mean", *(f"{wave}{k}" for k in (1, 2, 3) for wave in ("sin", "cos")))
LEGS = ("UpperLeg", "LowerLeg", "Foot", "Toes")


@pytest.fixture(scope="module")
def files(data_dir):
    folder = data_dir / "bandai2"
    return [path for style in ("elderly", "normal") for path in sorted(folder.glob(f"*walk_{style}_*.bvh"))[:15]]


@pytest.fixture(scope="module")
def recorded(files):
    return read_walks(files)


def _labels(walks):
    frequencies = [stride_frequency(prepare(walk, representation="joints")) for walk in walks]
    return pd.DataFrame({"elderly": [1.0 * ("elderly" in walk.name) for walk in walks], "hasty": frequencies})


@pytest.fixture(scope="module")
def model(recorded):
    prepared = [prepare(walk, representation="joints") for walk in recorded]
    return make_eigenwalkers(3, 8).fit(prepared, _labels(recorded))


@pytest.fixture(scope="module")
def walk(recorded):
    return recorded[15]


def _alphas(model, walk):
    joints = model["linearizer"].template_.channel_joints
    return model.transform([prepare(walk, representation="joints", joints=joints)])[0]


def _walked(walk):
    """Return the steady stretch of a recording, over the floor."""
    return prepare(walk, representation="joints", treadmill=False)


@pytest.mark.parametrize("keep_cadence", [False, True])
def test_no_step_gives_the_recording_back(model, recorded, keep_cadence):
    for walk in recorded[::7]:
        same = restyle_walk(model, walk, {"elderly": 0.0}, keep_cadence=keep_cadence)
        assert same.n_frames == walk.n_frames
        assert_allclose(same.rotations, walk.rotations, rtol=0, atol=1e-9)
        assert_allclose(same.root, walk.root, rtol=0, atol=1e-9)


def test_no_step_gives_noisy_recordings_with_a_t_pose_back(data_dir):
    files = sorted((data_dir / "cmu_bvh").glob("07_*.bvh"))
    walks = [walk for walk in cmu_joints(data_dir) if walk.name.startswith("07")]
    model = make_eigenwalkers(2, 4).fit(walks, pd.Series([walk.speed for walk in walks], name="fast"))
    for file in files[::5]:
        walk = read_walk(file, unit=0.0564)
        same = restyle_walk(model, walk, {"fast": 0.0})
        assert_allclose(same.rotations, walk.rotations, rtol=0, atol=1e-9)
        assert_allclose(same.root, walk.root, rtol=0, atol=1e-9)
        fast = restyle_walk(model, walk, {"fast": 1.0})
        assert_allclose(fast.rotations[0], walk.rotations[0], rtol=0, atol=1e-9)  # the T-pose
        assert fast.n_frames < walk.n_frames
        assert _alphas(model, fast)[0] - _alphas(model, walk)[0] == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("step", [-1.0, 1.0, 2.0])
def test_the_walk_moves_by_the_step(model, recorded, step):
    """Not to the last digit: legs that reach for their feet, and strides that differ, take some of it."""
    for walk in (recorded[0], recorded[15], recorded[20]):
        moved = restyle_walk(model, walk, {"elderly": step})
        assert moved.frame_rate == walk.frame_rate
        assert _alphas(model, moved)[0] - _alphas(model, walk)[0] == pytest.approx(step, abs=0.1)


def test_steps_are_counted_from_the_walk_and_positions_are_not(model, walk):
    prepared = prepare(walk, representation="joints")
    own = _alphas(model, walk)[0]
    there = walk_at(model, {"elderly": own + 1.0}, base=prepared)
    moved = prepare(restyle_walk(model, walk, {"elderly": 1.0}), representation="joints")
    columns = [name.startswith("mean_") for name in model["linearizer"].get_feature_names_out()]
    vectors = model["linearizer"].transform([there, moved])[:, columns]
    assert_allclose(*vectors, rtol=0, atol=np.deg2rad(3.0))  # a foot that is held


def test_held_traits_stay(model, walk):
    before = _alphas(model, walk)
    held = _alphas(model, restyle_walk(model, walk, {"elderly": 1.5}, hold=["hasty"]))
    assert held[1] - before[1] == pytest.approx(0.0, abs=0.15)
    assert held[0] - before[0] == pytest.approx(1.5, abs=0.1)


def test_what_is_added_are_harmonics_of_the_step_and_nothing_else(model, walk):
    """Of joints above the legs: how one stride differs from the next stays to the last digit."""
    moved = restyle_walk(model, walk, {"elderly": 2.0}, keep_cadence=True)
    before, after = stand_upright(walk), stand_upright(moved)
    track = find_gait(before, model["linearizer"].template_.channel_joints).track
    waves = [wave(k * track.phase) for k in (1, 2, 3) for wave in (np.sin, np.cos)]
    basis = np.column_stack((np.ones(walk.n_frames), *(track.share * wave for wave in waves)))
    above = [joint for joint in walk.skeleton.joint_names if not joint.startswith(("joint", "Hips", *LEGS))]
    added = replace(after, channel_joints=tuple(above)).channels - replace(before, channel_joints=tuple(above)).channels
    terms = np.linalg.lstsq(basis, added)[0]
    assert_allclose(basis @ terms, added, rtol=0, atol=1e-9)
    features = axis_features(model).loc["elderly"]
    names = [f"{block}_{joint}_{axis}" for block in _BLOCKS for joint in above for axis in "xyz"]
    assert_allclose(terms.ravel(), 2 * features[names], rtol=0, atol=1e-9)


@pytest.mark.parametrize("step", [-1.0, 1.0, 2.0])
def test_feet_stand_as_they_stood(model, recorded, step):
    for walk in (recorded[3], recorded[15]):
        moved = restyle_walk(model, walk, {"elderly": step})
        table = quality_table([_walked(walk), _walked(moved)])
        slips = table[["foot_slip_m_per_step", "worst_foot_slip_m_per_step"]]
        assert (slips.loc[1] < slips.loc[0] + 0.005).all()
        deepest = [sole_points(one)[..., 2].min() for one in (walk, moved)]
        assert deepest[1] > deepest[0] - 0.005


@pytest.mark.parametrize("name", ["feminine_019", "feminine_018", "youthful_020"])
def test_steps_that_the_file_cuts_off_stay_above_the_floor(model, data_dir, name):
    walk = read_walk(data_dir / "bandai2" / f"dataset-2_walk_{name}.bvh")
    for step in (-2.0, 2.0):
        moved = restyle_walk(model, walk, {"elderly": step})
        assert sole_points(moved)[..., 2].min() > sole_points(walk)[..., 2].min() - 0.005


def test_who_stands_before_and_after_stays_where_he_stands(model, walk):
    def wait(path):
        return np.concatenate((np.repeat(path[:1], 90, axis=0), path, np.repeat(path[-1:], 90, axis=0)))

    waits = replace(walk, rotations=wait(walk.rotations), root=wait(walk.root))
    moved = restyle_walk(model, waits, {"elderly": 2.0})
    soles = sole_points(moved)
    for frames in (slice(0, 50), slice(-50, None)):
        assert np.ptp(soles[frames], axis=0).max() < 1e-3
    posture = stand_upright(moved).rotations[0] - stand_upright(waits).rotations[0]
    assert np.abs(posture).max() > np.deg2rad(5)  # he stands as an older man does


def test_where_the_walk_leads_does_not_matter(model, walk):
    upright = stand_upright(walk)
    one, other = (
        restyle_walk(model, turned(upright, 70), {"elderly": 1.0}),
        restyle_walk(model, upright, {"elderly": 1}),
    )
    # The direction of the path is an estimate with some rounding of its own.
    assert_allclose(one.joint_positions(), turned(other, 70).joint_positions(), rtol=0, atol=1e-4)


def test_a_walk_in_place_stays_in_place(model, walk):
    treadmill = prepare(walk, representation="joints")
    moved = restyle_walk(model, treadmill, {"elderly": 1.0})
    assert np.abs(moved.root[:, :2]).max() < 0.2
    assert moved.speed < treadmill.speed - 0.1
    assert _alphas(model, moved)[0] - _alphas(model, treadmill)[0] == pytest.approx(1.0, abs=0.05)


def test_joints_that_the_model_does_not_know_stay(model, files, tmp_path):
    add_fingers(files[15], tmp_path / "fingers.bvh")
    walk, plain = read_walk(tmp_path / "fingers.bvh"), read_walk(files[15])
    moved = restyle_walk(model, walk, {"elderly": 2.0}, keep_cadence=True)
    fingers = [walk.skeleton.index(f"Finger_{side}") for side in "LR"]
    assert_allclose(moved.rotations[:, fingers], walk.rotations[:, fingers], rtol=0, atol=1e-9)
    quick = restyle_walk(model, walk, {"elderly": 2.0})
    assert_allclose(quick.rotations[[0, -2], fingers[0]], walk.rotations[[0, -2], fingers[0]], atol=0.1)
    rest = [place for place in range(len(walk.skeleton.joint_names)) if place not in fingers]
    without = restyle_walk(model, plain, {"elderly": 2.0}, keep_cadence=True)
    assert_allclose(moved.rotations[:, rest], without.rotations, rtol=0, atol=1e-9)


def test_the_order_of_the_joints_does_not_matter(model, walk):
    """Right before left in the file."""
    skeleton = walk.skeleton
    right = [name.endswith("_R") for name in skeleton.joint_names]
    order = sorted(range(len(right)), key=lambda joint: (len(skeleton.above(joint)), not right[joint]))
    places = {-1: -1} | {joint: place for place, joint in enumerate(order)}
    other = Skeleton(
        tuple(skeleton.joint_names[joint] for joint in order),
        [places[int(skeleton.parents[joint])] for joint in order],
        skeleton.offsets[order],
        root=places[skeleton.root],
    )
    one = restyle_walk(model, walk, {"elderly": 1.0})
    two = restyle_walk(model, replace(walk, skeleton=other, rotations=walk.rotations[:, order]), {"elderly": 1.0})
    # Numbers are added up in another order, and the search for the frequency ends elsewhere by some 1e-9 of it.
    assert_allclose(two.rotations, one.rotations[:, order], rtol=0, atol=1e-4)


def test_joints_that_stand_still_need_not_be_there(model, walk):
    """The hips may be the first joint; the model has one above, which never turns."""
    skeleton = walk.skeleton
    top = skeleton.index("Hips")
    assert top == 1
    other = Skeleton(
        skeleton.joint_names[1:],
        np.maximum(skeleton.parents[1:] - 1, -1),
        skeleton.offsets[1:],
        skeleton.end_parents - 1,
        skeleton.end_offsets,
        root=0,
    )
    one = restyle_walk(model, walk, {"elderly": 1.0})
    two = restyle_walk(model, replace(walk, skeleton=other, rotations=walk.rotations[:, 1:]), {"elderly": 1.0})
    assert_allclose(two.rotations, one.rotations[:, 1:], rtol=0, atol=1e-9)
    assert_allclose(two.root, one.root, rtol=0, atol=1e-9)


def test_a_preparer_in_the_model_is_asked(recorded, model, walk):
    with_preparer = make_eigenwalkers(3, 8)
    with_preparer.steps.insert(0, ("preparer", WalkPreparer(representation="joints")))
    with_preparer.fit(recorded, _labels(recorded))
    one, other = (restyle_walk(one, walk, {"elderly": 1.0}) for one in (model, with_preparer))
    assert_allclose(one.rotations, other.rotations, rtol=0, atol=1e-9)


def test_far_out_walks_are_said_to_be(model, walk):
    with pytest.warns(JointLimitWarning), pytest.warns(OutsideDataWarning, match="normal_001, elderly \\+9"):
        restyle_walk(model, walk, {"elderly": 9.0}, keep_cadence=True)


def test_what_cannot_be_restyled_is_refused(model, walk):
    with pytest.raises(ValueError, match=r"trait must be one of .*elderly.*'happy'"):
        restyle_walk(model, walk, {"happy": 1.0})
    with pytest.raises(ValueError, match="alphas must have one trait or more"):
        restyle_walk(model, walk, {})
    with pytest.raises(ValueError, match="alphas must be finite, got nan"):
        restyle_walk(model, walk, {"elderly": np.nan})
    with pytest.raises(ValueError, match="either set or held, got both for elderly"):
        restyle_walk(model, walk, {"elderly": 1.0}, hold=["elderly"])
    with pytest.raises(ValueError, match="max_knee must be finite and not negative"):
        restyle_walk(model, walk, {"elderly": 1.0}, max_knee=-1.0)
    with pytest.raises(ValueError, match="no walk lies that far out"):
        restyle_walk(model, walk, {"hasty": -500.0})
    markers = make_walkers(12, random_state=0)
    with pytest.raises(TypeError, match="expected a JointWalk"):
        restyle_walk(model, markers.data[0], {"elderly": 1.0})
    of_markers = make_eigenwalkers(n_components=3).fit(markers.data, markers.target["weight"])
    with pytest.raises(ValueError, match=r"got one of markers; learn one with .* --representation joints"):
        restyle_walk(of_markers, walk, {"weight": 1.0})


def test_other_skeletons_are_refused_with_what_is_wrong(model, walk):
    skeleton = walk.skeleton
    names = tuple("Foot_X" if name == "Foot_L" else name for name in skeleton.joint_names)
    with pytest.raises(WalkError, match=r"expected the skeleton of the model, .*; it lacks Foot_L; further joints do"):
        restyle_walk(model, replace(walk, skeleton=replace(skeleton, joint_names=names)), {"elderly": 1.0})
    parents = np.array(skeleton.parents)
    parents[skeleton.index("Neck")] = skeleton.index("Spine")
    with pytest.raises(WalkError, match="Neck hangs from Spine in place of Chest"):
        restyle_walk(model, replace(walk, skeleton=replace(skeleton, parents=parents)), {"elderly": 1.0})


def test_models_along_the_axes_of_files_are_refused(model, walk):
    template = model["linearizer"].template_
    fields = replace(template, skeleton=replace(template.skeleton, upright=False))
    assert isinstance(fields, JointWalk)
    linearizer = model["linearizer"]
    linearizer.template_ = fields
    try:
        with pytest.raises(ValueError, match="joints along the axes of the room"):
            restyle_walk(model, walk, {"elderly": 1.0})
    finally:
        linearizer.template_ = template


def test_the_recording_is_left_alone(model, walk):
    rotations = np.array(walk.rotations)
    restyle_walk(model, walk, {"elderly": 1.0})
    assert_array_equal(walk.rotations, rotations)
