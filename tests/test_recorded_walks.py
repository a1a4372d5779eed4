"""The main job on recorded walks: nothing is refused without reason, and no stride is taken for two."""

import numpy as np
import pandas as pd
import pytest
from sklearn.model_selection import LeaveOneOut, cross_val_score

from eigenwalker import FourierLinearizer, TraitClassifier, make_eigenwalkers, walk_along_axis
from eigenwalker.motion import stride_frequency, walk_quality
from tests.events import heel_strikes, stride_frequency_from_strikes
from tests.recorded import bandai_walks, cmu_walks, style


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
    (message,) = messages
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
    recorded, prepared, _ = cmu_walks(data_dir)
    still = [walk for walk in recorded if walk.name in ("05_01", "06_01", "07_07")]
    linearizer = FourierLinearizer(n_cycles=3).fit(still)
    vectors = linearizer.transform(still)
    assert vectors.shape == (3, 5 * 3 * len(still[0].skeleton.joint_names) + 1)
    by_markers = [stride_frequency(walk) for walk in prepared if walk.name in ("05_01", "06_01", "07_07")]
    np.testing.assert_allclose(vectors[:, -1], by_markers, rtol=0.05)
    made = linearizer.inverse_transform(vectors)
    np.testing.assert_allclose(linearizer.transform(made), vectors, atol=1e-9)
    legs = np.linalg.norm(np.diff(made[0].to_markers().positions[:, [9, 10, 11]], axis=1), axis=2)
    assert np.ptp(legs, axis=0).max() < 1e-9


def test_rigs_without_hip_flexion_ask_for_a_reference(data_dir):
    with pytest.raises(ValueError, match="rig 'bandai' names no channels of hip flexion; pass phase_reference="):
        FourierLinearizer().fit(bandai_walks(data_dir)[0][:1])
