"""The main job on recorded walks: nothing is refused without reason, and no stride is taken for two."""

import pickle
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from sklearn.base import clone
from sklearn.model_selection import LeaveOneOut, StratifiedKFold, cross_val_score
from sklearn.pipeline import Pipeline

from eigenwalker import (
    FourierLinearizer,
    JointWalk,
    TraitClassifier,
    WalkError,
    WalkPreparer,
    load_model,
    make_eigenwalkers,
    save_model,
    walk_along_axis,
)
from eigenwalker.motion import stride_frequency, walk_quality
from tests.events import heel_strikes, stride_frequency_from_strikes
from tests.recorded import bandai_joints, bandai_walks, cmu_joints, cmu_walks, style


def test_all_bandai_walks_are_prepared(data_dir):
    recorded, prepared = bandai_walks(data_dir)
    assert [walk.name for walk in prepared] == [walk.name for walk in recorded]
    assert len(prepared) == 175


def test_no_octave_error_on_bandai(data_dir):
    """Strides counted by heel strikes of the same feet, in the same stretch."""
    _, prepared = bandai_walks(data_dir)
    counted = np.array([stride_frequency_from_strikes(walk) for walk in prepared])
    fitted = np.array([stride_frequency(walk) for walk in prepared])
    np.testing.assert_allclose(fitted, counted, rtol=0.015)


def test_steps_alternate_on_bandai(data_dir):
    """The counting itself is sound: left and right strikes take turns."""
    for walk in bandai_walks(data_dir)[1]:
        times = {side: heel_strikes(walk, side) for side in ("left", "right")}
        order = np.argsort(np.concatenate((times["left"], times["right"])))
        sides = np.repeat([0, 1], [len(times["left"]), len(times["right"])])[order]
        assert (np.diff(sides) != 0).all(), walk.name


def test_no_octave_error_on_cmu(data_dir):
    """The steady part may hold a single pair of strikes; they are counted in the frames that were fitted."""
    _, prepared, _ = cmu_walks(data_dir)
    assert len(prepared) == 27
    for walk in prepared:
        np.testing.assert_allclose(
            stride_frequency(walk), stride_frequency_from_strikes(walk), rtol=0.03, err_msg=walk.name
        )


def test_frames_of_zeros_are_reported_and_left_out(data_dir):
    recorded, prepared, messages = cmu_walks(data_dir)
    (message,) = [message for message in messages if "the pelvis leaps" in message]
    assert "'07_12'" in message
    assert "kept frames 2 to 263 of 264" in message
    position = [walk.name for walk in recorded].index("07_12")
    assert prepared[position].marker("head")[:, 2].min() > 1.2


def _explained_by_lstsq(walk, frequency, n_harmonics):
    """DESIGN's explained power, written out with numpy's least squares."""
    angles = 2 * np.pi * frequency * np.outer(np.arange(walk.n_frames) / walk.frame_rate, np.arange(1, n_harmonics + 1))
    basis = np.hstack((np.ones((walk.n_frames, 1)), np.sin(angles), np.cos(angles)))
    rest = walk.channels - basis @ np.linalg.lstsq(basis, walk.channels)[0]
    return 1 - (rest**2).sum() / ((walk.channels - walk.channels.mean(axis=0)) ** 2).sum()


def test_two_harmonics_explain_bandai(data_dir):
    _, prepared = bandai_walks(data_dir)
    powers = np.array([_explained_by_lstsq(walk, stride_frequency(walk), 2) for walk in prepared])
    assert np.median(powers) >= 0.950
    assert np.mean(powers >= 0.90) >= 0.76
    reported = [walk_quality(walk).explained_power for walk in prepared]
    np.testing.assert_allclose(reported, powers, atol=1e-9)


def test_quality_makes_sense(data_dir):
    _, prepared = bandai_walks(data_dir)
    table = pd.DataFrame([walk_quality(walk) for walk in prepared])
    medians = table.groupby([style(walk) for walk in prepared])["speed"].median()
    assert medians.idxmin() == "elderly"
    assert medians.idxmax() == "active"
    assert table["path_residual"].lt(0.08).all()
    assert table["n_cycles"].ge(2).all()


@pytest.fixture(scope="module")
def two_styles(data_dir):
    _, prepared = bandai_walks(data_dir)
    chosen = [walk for walk in prepared if style(walk) in ("masculine", "feminine")]
    return chosen, pd.Series([style(walk) for walk in chosen], name="style")


def test_whole_job_on_two_acted_styles(two_styles):
    """A smoke test: the styles were acted and recorded in different sessions, so that accuracy is at its ceiling."""
    walks, styles = two_styles
    model = make_eigenwalkers(trait=TraitClassifier())
    assert cross_val_score(model, walks, styles, cv=LeaveOneOut()).mean() > 0.9


@pytest.mark.parametrize("scaling", ["blocks", "features", None])
def test_alpha_survives_the_walk(two_styles, scaling):
    walks, styles = two_styles
    model = make_eigenwalkers(scaling=scaling).fit(walks, styles)
    alphas = np.array([-3.0, -1.0, 0.0, 2.5])
    made = walk_along_axis(model, "style", alphas)
    np.testing.assert_allclose(model.transform(made)[:, 0], alphas, atol=1e-6)


def test_base_with_its_own_alpha_is_the_base(two_styles):
    walks, styles = two_styles
    model = make_eigenwalkers().fit(walks, styles)
    base = walks[3]
    (same,) = walk_along_axis(model, "style", model.transform([base])[0], base=base)
    linearizer = model["linearizer"]
    band_limited = linearizer.inverse_transform(linearizer.transform([base]))[0]
    assert np.abs(same.positions - band_limited.positions).max() < 1e-9
    assert same.speed == base.speed


def test_joint_walks_are_linearised_as_well(data_dir):
    """The same steps on joint rotations: one stride frequency, and a band-limited walk comes back."""
    names = ("05_01", "06_01", "07_07")
    prepared = cmu_walks(data_dir)[1]
    joints = [walk for walk in cmu_joints(data_dir) if walk.name in names]
    linearizer = FourierLinearizer(n_cycles=3).fit(joints)
    vectors = linearizer.transform(joints)
    assert vectors.shape == (3, 5 * 3 * 27 + 1)  # of 31 joints 4 stand still
    by_markers = [stride_frequency(walk) for walk in prepared if walk.name in names]
    np.testing.assert_allclose(vectors[:, -1], by_markers, rtol=0.02)
    made = linearizer.inverse_transform(vectors)
    np.testing.assert_allclose(linearizer.transform(made), vectors, atol=1e-9)
    legs = np.linalg.norm(np.diff(made[0].to_markers().positions[:, [9, 10, 11]], axis=1), axis=2)
    assert np.ptp(legs, axis=0).max() < 1e-9


@pytest.fixture(scope="module")
def joint_recordings(data_dir):
    """Return 30 recordings of two styles, as files have them."""
    recorded, _ = bandai_walks(data_dir)
    chosen = [walk for name in ("masculine", "feminine") for walk in recorded if style(walk) == name]
    by_style = [walk for name in ("masculine", "feminine") for walk in [w for w in chosen if style(w) == name][:15]]
    return by_style, pd.Series([style(walk) for walk in by_style], name="style")


@pytest.fixture(scope="module")
def joint_model(joint_recordings):
    """Return everything from recordings to a trait in one Pipeline, fitted."""
    preparer = WalkPreparer(representation="joints")
    steps = make_eigenwalkers(n_components=8, extras=("speed",), trait=TraitClassifier()).steps
    return Pipeline([("preparer", preparer), *steps]).fit(*joint_recordings)


def test_whole_job_in_joint_angles(joint_recordings, joint_model):
    """A smoke test, see above: fits, is cloned and cross-validated; each fold learns its joints anew."""
    recordings, styles = joint_recordings
    assert len(joint_model["preparer"].joints_) == 21
    assert joint_model["linearizer"].get_feature_names_out().size == 316 + 1
    assert cross_val_score(clone(joint_model), recordings, styles, cv=StratifiedKFold(3)).mean() > 0.9
    assert not hasattr(clone(joint_model)["preparer"], "joints_")
    restored = pickle.loads(pickle.dumps(joint_model))
    np.testing.assert_array_equal(restored.transform(recordings), joint_model.transform(recordings))


def test_joint_models_come_back_from_a_file(joint_recordings, joint_model, tmp_path):
    recordings, _ = joint_recordings
    save_model(joint_model, tmp_path / "styles.skops")
    loaded = load_model(tmp_path / "styles.skops")
    np.testing.assert_array_equal(loaded.transform(recordings), joint_model.transform(recordings))
    assert loaded["linearizer"].template_.phase_channels == {"UpperLeg_L_y": -1.0, "UpperLeg_R_y": 1.0}


@pytest.mark.parametrize("base", [None, 3])
def test_joint_walks_that_nobody_has_walked(joint_recordings, joint_model, base):
    """They have their alpha, rigid limbs, speed, and go over the floor again."""
    recordings, _ = joint_recordings
    model = Pipeline(joint_model.steps[1:])
    prepared = joint_model["preparer"].transform(recordings)
    alphas = np.array([-1.0, 0.0, 1.5])
    made = walk_along_axis(model, "style", alphas, base=None if base is None else prepared[base])
    np.testing.assert_allclose(model.transform(made)[:, 0], alphas, atol=1e-6)
    for walk, over_floor in zip(made, joint_model["preparer"].inverse_transform(made), strict=True):
        assert isinstance(walk, JointWalk)
        legs = np.linalg.norm(np.diff(walk.to_markers().positions[:, [9, 10, 11]], axis=1), axis=2)
        assert np.ptp(legs, axis=0).max() < 1e-12
        way = (over_floor.root - walk.root)[-1, 0]
        np.testing.assert_allclose(way, walk.speed * (walk.n_frames - 1) / walk.frame_rate)


def test_joints_are_a_matter_of_choice(data_dir):
    """Of 22 joints of `bandai2` 21 turn: 316 features. Without toes and neck there are 18 and 271."""
    walk = bandai_joints(data_dir)[0]
    assert FourierLinearizer().fit([walk]).get_feature_names_out().size == 316
    few = tuple(joint for joint in walk.channel_joints if joint not in ("Toes_L", "Toes_R", "Neck"))
    linearizer = FourierLinearizer().fit([replace(walk, channel_joints=few)])
    assert linearizer.get_feature_names_out().size == 271


def test_other_skeletons_are_refused_with_their_joints(data_dir):
    walks = [bandai_joints(data_dir)[0], cmu_joints(data_dir)[0]]
    message = r"'02_01': expected the 63 channels .* missing: Chest_x, .*unknown: LeftUpLeg_x, .* to one skeleton"
    with pytest.raises(WalkError, match=message):
        FourierLinearizer().fit(walks)


def test_walks_in_the_axes_of_a_file_ask_for_preparation(data_dir):
    walk = bandai_walks(data_dir)[0][0]
    with pytest.raises(ValueError, match=r"no channel is hip flexion; .* prepare\(walk, representation='joints'\)"):
        FourierLinearizer().fit([walk])
    flexion = {"UpperLeg_L_z": 1.0, "UpperLeg_R_z": 1.0}  # or a reference of one's own
    assert FourierLinearizer(phase_reference=flexion).fit([walk]).get_feature_names_out().size == 5 * 3 * 22 + 1
