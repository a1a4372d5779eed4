"""Styles of walking in joint angles: axes one against the rest, walks along them, and blends."""

import warnings
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker import FourierLinearizer, JointWalk, TraitRegressor, blend, make_eigenwalkers, walk_along_axis, walk_at
from eigenwalker.model import OutsideDataWarning
from eigenwalker.motion import JointLimitWarning, joint_limits_exceeded
from tests.recorded import bandai_joints, style

_STYLES = ("active", "elderly", "exhausted", "feminine", "masculine", "normal", "youthful")


@pytest.fixture(scope="module")
def walks(data_dir):
    return bandai_joints(data_dir, 8)


@pytest.fixture(scope="module")
def styles(walks):
    return np.array([style(walk) for walk in walks])


@pytest.fixture(scope="module")
def model(walks, styles):
    """Seven axes, one style against the rest each."""
    codes = pd.DataFrame({name: np.where(styles == name, 1.0, -1.0) for name in _STYLES})
    return make_eigenwalkers(n_components=15).fit(walks, codes)


def test_walks_are_joint_walks_of_all_styles(walks, styles):
    assert {type(walk) for walk in walks} == {JointWalk}
    assert sorted(set(styles)) == list(_STYLES)


def test_each_style_is_furthest_on_its_own_axis(model, walks, styles):
    means = pd.DataFrame(model.transform(walks), columns=_STYLES).groupby(styles).mean()
    assert (means.idxmax() == means.columns).all()
    assert (np.diag(means.loc[list(_STYLES)]) > 0).all()


def test_walks_along_an_axis_have_their_alpha(model, walks, styles):
    base = walks[int(np.flatnonzero(styles == "normal")[0])]
    alphas = [-1.0, -0.5, 0.0, 0.5, 1.0]
    along = walk_along_axis(model, "elderly", alphas, base=base)
    assert {type(walk) for walk in along} == {JointWalk}
    assert_allclose(model.transform(along)[:, _STYLES.index("elderly")], alphas, atol=1e-6)


def test_far_out_walks_have_their_alpha_too_and_warn(model, walks, styles):
    base = walks[int(np.flatnonzero(styles == "normal")[0])]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of both guards
        along = walk_along_axis(model, "elderly", [-2.0, 2.0], base=base)
    assert_allclose(model.transform(along)[:, _STYLES.index("elderly")], [-2, 2], atol=1e-6)


def test_the_base_comes_back_at_its_own_alpha(model, walks):
    base = walks[3]
    own = model.transform([base])[0, 0]
    same = walk_along_axis(model, _STYLES[0], [own], base=base)
    linearizer = model["linearizer"]
    assert_allclose(linearizer.transform(same), linearizer.transform([base]), atol=1e-9)


def test_alpha_zero_without_a_base_is_the_average_walk(model, walks):
    linearizer = model["linearizer"]
    average = linearizer.transform(walks).mean(axis=0)
    walk = walk_at(model, dict.fromkeys(("elderly", "active"), 0.0))
    assert_allclose(linearizer.transform([walk])[0], average, atol=1e-6)


def test_missing_labels_leave_walks_out_of_that_axis_only(walks, styles):
    codes = pd.DataFrame({name: np.where(styles == name, 1.0, -1.0) for name in ("elderly", "normal")})
    known = codes.copy()
    known.loc[styles == "active", "elderly"] = np.nan
    some, all_of_them = (make_eigenwalkers(n_components=10).fit(walks, one)["trait"] for one in (known, codes))
    assert_allclose(some.coef_[1], all_of_them.coef_[1], atol=1e-12)
    assert np.abs(some.coef_[0] - all_of_them.coef_[0]).max() > 1e-6


def test_graded_labels_give_an_axis(walks, styles):
    grades = pd.Series([{"exhausted": -2.0, "elderly": -1.0, "active": 2.0}.get(name, 0.0) for name in styles])
    model = make_eigenwalkers(n_components=10, trait=TraitRegressor(alpha_unit="label"))
    model.fit(walks, grades.rename("energy"))
    means = pd.Series(model.transform(walks)[:, 0]).groupby(styles).mean()
    assert means["exhausted"] < means["elderly"] < means["normal"] < means["active"]


def test_blends_of_two_styles_move_along_the_axes_between_them(model, walks, styles):
    """Alpha is linear in the vector: equal steps of the weight are equal steps of alpha."""
    found = {name: list(np.array(walks, dtype=object)[styles == name]) for name in ("elderly", "normal")}
    shares = np.linspace(0, 1, 5)
    blends = [blend(found, {"elderly": share, "normal": 1 - share}, model=model) for share in shares]
    alphas = model.transform(blends)
    elderly, normal = (alphas[:, _STYLES.index(name)] for name in ("elderly", "normal"))
    assert (np.diff(elderly) > 0).all()
    assert (np.diff(normal) < 0).all()
    assert_allclose(np.diff(alphas, 2, axis=0), 0, atol=1e-6)


def test_a_whole_weight_is_the_style_itself(walks, styles):
    linearizer = FourierLinearizer().fit(walks)
    one = blend(walks, {"elderly": 1.0}, labels=styles, model=linearizer)
    mean = linearizer.transform([walk for walk in walks if style(walk) == "elderly"]).mean(axis=0)
    assert_allclose(linearizer.transform([one])[0], mean, atol=1e-6)
    assert one.name == "1 elderly"
    same = blend([walks[0], walks[9]], [1.0, 0.0], model=linearizer)
    assert_allclose(linearizer.transform([same]), linearizer.transform(walks[:1]), atol=1e-6)
    assert same.speed == pytest.approx(walks[0].speed)


def test_ways_to_name_styles_agree(walks, styles):
    weights = {"active": 0.25, "normal": 0.75}
    by_label = blend(walks, weights, labels=pd.Series(styles, index=np.arange(len(styles)) + 7))
    by_style = blend({name: [walk for walk in walks if style(walk) == name] for name in _STYLES}, weights)
    assert_allclose(by_label.rotations, by_style.rotations)
    assert by_label.name == by_style.name == "0.25 active + 0.75 normal"


def test_beyond_a_style_is_beyond_it_on_its_axis_and_warns(model, walks, styles):
    weights = {"exhausted": 3.0, "youthful": -2.0}
    with pytest.warns() as caught:
        far = blend(walks, weights, labels=styles, model=model)
    outside, joints = sorted(caught, key=lambda one: one.category is JointLimitWarning)
    assert outside.category is OutsideDataWarning
    assert "'3 exhausted - 2 youthful'" in str(outside.message)
    assert joints.category is JointLimitWarning
    assert "'3 exhausted - 2 youthful', right_elbow: hyperextension" in str(joints.message)
    assert {one.filename for one in caught} == {__file__}
    exhausted = model.transform([walk for walk in walks if style(walk) == "exhausted"])[:, 2]
    assert model.transform([far])[0, 2] > exhausted.max()


def test_walks_beyond_the_joints_of_people_warn_once_for_all_of_them(model):
    with pytest.warns(
        JointLimitWarning, match="1 of 2 walks: 'active -2', right_elbow: hyperextension 2. deg"
    ) as caught:
        _, far = walk_along_axis(model, "active", [0.0, -2.0])
    assert [one.category for one in caught] == [JointLimitWarning]
    assert caught[0].filename == __file__
    assert set(joint_limits_exceeded(far)["joint"]) == {"left_elbow", "right_elbow"}


def test_weights_are_checked(walks, styles):
    with pytest.raises(ValueError, match=r"sum to one, .*got 0.5, 0.6, sum 1.1"):
        blend(walks[:2], [0.5, 0.6])
    with pytest.raises(ValueError, match="must be finite"):
        blend(walks[:2], [np.nan, 1.0])
    with pytest.raises(ValueError, match=r"shape \(2,\), one a walk, got \(3,\)"):
        blend(walks[:2], [0.5, 0.2, 0.3])
    with pytest.raises(ValueError, match="weights name 'happy', but there are walks of 'active'"):
        blend(walks, {"happy": 1.0}, labels=styles)
    with pytest.raises(ValueError, match="one style a walk"):
        blend(walks, {"active": 1.0}, labels=styles[:-1])
    with pytest.raises(TypeError, match="weights of styles need walks of styles"):
        blend(walks[:2], {"active": 1.0})
    with pytest.raises(TypeError, match=r"weights of styles must be a mapping, \{'active': 1.0\}"):
        blend(walks, [1.0], labels=styles)
    with pytest.raises(TypeError, match="labels go with a list"):
        blend({"active": walks[:2]}, {"active": 1.0}, labels=styles[:2])


def test_frequency_speed_and_kind_are_checked(walks):
    slow, fast = replace(walks[0], frame_rate=10.0, speed=0.2), replace(walks[1], frame_rate=60.0, speed=1.5)
    with pytest.raises(ValueError, match=r"2 .* - 1 .*: .* frequency would be -.* Hz; use weights nearer"):
        blend([slow, fast], [2.0, -1.0])
    with pytest.raises(TypeError, match="of one kind, got JointWalk and Walk"):
        blend([walks[0], walks[1].to_markers()], [0.5, 0.5])
    raw = replace(walks[0], skeleton=replace(walks[0].skeleton, upright=False))
    with pytest.raises(ValueError, match="only some of the walks are upright"):
        blend([raw, walks[1]], [0.5, 0.5])
    unknown = blend([replace(walks[0], speed=np.nan), walks[1]], [0.5, 0.5])
    assert np.isnan(unknown.speed)
    slow = replace(walks[1], speed=0.1)
    assert np.isnan(blend([replace(walks[1], speed=1.0), slow], [-1.0, 2.0]).speed)
    assert blend([replace(walks[1], speed=1.0), slow], [0.5, 0.5]).speed == pytest.approx(0.55)


def test_markers_are_blended_too(walks):
    markers = [walk.to_markers() for walk in (walks[0], walks[-1])]
    halfway = blend(markers, [0.5, 0.5], model=FourierLinearizer(3, n_cycles=2).fit(markers))
    linearizer = FourierLinearizer(3).fit(markers)
    assert_allclose(linearizer.transform([halfway])[0], linearizer.transform(markers).mean(axis=0), atol=1e-6)
