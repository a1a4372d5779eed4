"""How a walker deviates."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from numpy.testing import assert_allclose

from eigenwalker.display import DeviationDisplay, project
from eigenwalker.model.walker_score import score_walker
from eigenwalker.motion import JointWalk, Skeleton


@pytest.fixture
def score(model, walkers):
    return score_walker(model, replace(walkers.data[0], name="anna"))


def _z(features, block, marker):
    return features.loc[[f"{part}_{marker}_{axis}" for part in block for axis in "xyz"], "z"]


def test_table_is_the_root_mean_square_of_z(score):
    table = DeviationDisplay.from_score(score).table()
    assert list(table.columns) == ["structure", "harmonic 1", "harmonic 2"]
    assert list(table.index) == list(score.average.marker_set.names)
    for column, block in {
        "structure": ["mean"],
        "harmonic 1": ["sin1", "cos1"],
        "harmonic 2": ["sin2", "cos2"],
    }.items():
        z = _z(score.features, block, "left_ankle")
        assert table.loc["left_ankle", column] == pytest.approx(np.sqrt(np.mean(z**2)))


def test_cells_show_their_numbers(score):
    ax = DeviationDisplay.from_score(score).axes_[1]
    table = DeviationDisplay.from_score(score).table()
    assert_allclose(ax.images[0].get_array(), table)
    assert [text.get_text() for text in ax.texts] == [f"{value:.1f}" for value in table.to_numpy().ravel()]
    assert ax.images[0].get_clim() == (0, 4)  # the same for all walkers


def test_features_without_z_do_not_count(score):
    left_out = ["mean_head_x", "mean_head_y", "mean_pelvis_x", "mean_pelvis_y", "mean_pelvis_z"]
    score.features.loc[left_out, "z"] = np.nan
    display = DeviationDisplay.from_score(score)
    table = display.table()
    assert table.loc["head", "structure"] == pytest.approx(abs(score.features.loc["mean_head_z", "z"]))
    assert np.isnan(table.loc["pelvis", "structure"])
    assert table.loc["pelvis", ["harmonic 1", "harmonic 2"]].notna().all()
    assert "–" in [text.get_text() for text in display.axes_[1].texts]


def test_bodies_are_the_two_mean_postures(score):
    display = DeviationDisplay.from_score(score, view="side")
    bodies = [item for item in display.axes_[0].collections if isinstance(item, LineCollection)]
    assert [len(body.get_segments()) for body in bodies] == [len(score.average.marker_set.sticks)] * 2
    for body, column in zip(bodies, ("mean", "value"), strict=True):
        posture = score.features[column].to_numpy()[:45].reshape(15, 3)
        seen = project(posture, 90)[:, :2]
        ends = np.concatenate(body.get_segments())
        assert_allclose(np.unique(ends.round(9), axis=0), np.unique(seen.round(9), axis=0))


def test_markers_grow_and_darken_with_their_largest_z(score):
    score.features["z"] = 0.0
    score.features.loc["mean_left_wrist_z", "z"] = -3.0
    score.features.loc["mean_head_x", "z"] = 1.0
    score.features.loc["sin1_pelvis_x", "z"] = 9.0  # dynamics
    dots = DeviationDisplay.from_score(score).axes_[0].collections[-1]
    names = score.average.marker_set.names
    expected = np.zeros(15)
    expected[[names.index("left_wrist"), names.index("head")]] = 3.0, 1.0
    assert_allclose(dots.get_array(), expected)
    sizes = dict(zip(names, dots.get_sizes(), strict=True))
    assert sizes["left_wrist"] > sizes["head"] > sizes["pelvis"]


@pytest.mark.parametrize(("z", "written"), [(-1.26, "z = −1.3"), (0.5, "z = +0.5"), (np.nan, "no z")])
def test_title_says_name_and_frequency(score, z, written):
    score.features.loc["frequency", ["value", "mean", "z"]] = 0.9, 1.0, z
    title = DeviationDisplay.from_score(score).axes_[0].get_title(loc="left")
    assert title == f"anna\nstride frequency 0.90 Hz, group 1.00 Hz, {written}"
    nameless = DeviationDisplay.from_score(score._replace(name="")).axes_[0].get_title(loc="left")
    assert nameless.startswith("walk\n")


def test_joint_walks_have_no_body_to_draw(score):
    skeleton = Skeleton(("hips",), [-1], np.zeros((1, 3)))
    joints = JointWalk(np.zeros((2, 1, 3)), np.zeros((2, 3)), skeleton, 30.0)
    with pytest.raises(TypeError, match=r"expected walks of markers \(Walk\)"):
        DeviationDisplay.from_score(score._replace(average=joints))


def test_unknown_views_are_refused(score):
    with pytest.raises(ValueError, match="view must be one of frontal"):
        DeviationDisplay.from_score(score, view="above")
