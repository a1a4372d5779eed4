"""One walker against a group."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from sklearn.decomposition import PCA
from sklearn.pipeline import Pipeline

from eigenwalker import (
    BlockScaler,
    FourierLinearizer,
    TraitClassifier,
    TraitRegressor,
    WalkError,
    WalkPreparer,
    make_eigenwalkers,
    make_walkers,
    walk_along_axis,
)
from eigenwalker.model.walker_score import score_walker
from eigenwalker.motion import JointWalk, MarkerSet, Skeleton, mirror_walk
from tests.synthetic import make_walk

TRAITS = ["gender", "weight", "happy"]


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(46, duration=8, frame_rate=60, random_state=0)


@pytest.fixture(scope="module")
def group(walkers):
    return walkers.data[:40]


@pytest.fixture(scope="module")
def labels(walkers):
    return walkers.target[TRAITS][:40]


@pytest.fixture(scope="module")
def model(group, labels):
    return make_eigenwalkers(n_components=8).fit(group, labels)


@pytest.fixture(scope="module")
def patient(walkers):
    return walkers.data[43]


def test_alpha_distance_and_label_are_those_of_the_model(model, patient):
    score = score_walker(model, patient)
    assert_array_equal(score.axes["alpha"], model.transform([patient])[0])
    assert_array_equal(score.axes["label"], model.predict([patient])[0])
    trait, scores = model[-1], model[:-1].transform([patient])
    assert score.distance == trait.distance(scores)[0]
    assert score.distance_limit == trait.distance_limit(0.99)
    assert list(score.axes.index) == TRAITS
    assert score.axes.loc["gender", ["negative", "positive"]].tolist() == ["female", "male"]
    assert score.name == patient.name
    assert score.walk is patient
    assert_allclose(model.transform([score.average]), 0.0, atol=1e-9)


def test_limit_and_share_are_two_sides_of_one_thing(model, group):
    """A walker at the limit has 1 % of its kind beyond it."""
    (base,) = walk_along_axis(model, "happy", [1.0])
    trait = model[-1]
    own = trait.distance(model[:-1].transform([base]))[0]
    with pytest.warns(UserWarning, match="outside your data"):
        (at_limit,) = walk_along_axis(model, "happy", [trait.distance_limit() / own + 1e-9])
    score = score_walker(model, at_limit)
    assert_allclose(score.distance, score.distance_limit, rtol=1e-6)
    assert_allclose(score.share_beyond, 0.01, rtol=1e-4)


def test_percentile_is_the_rank_among_the_training_walkers(model, group):
    ranks = pd.DataFrame(model[-1].alphas_).rank().to_numpy()
    for walker in (0, 7, 31):
        percentile = score_walker(model, group[walker]).axes["percentile"]
        assert_allclose(percentile, 100 * (ranks[walker] - 0.5) / 40)  # half of oneself


def test_percentile_is_among_persons_where_there_are_groups(group, labels):
    model = make_eigenwalkers(n_components=8).fit(group, labels, trait__groups=np.repeat(np.arange(10), 4))
    score = score_walker(model, group[0])
    assert np.isin(score.axes["percentile"], np.arange(0, 101, 10)).all()
    assert score.distance_limit == model[-1].distance_limit()


def test_walker_moved_along_an_axis_is_found_there(model, patient):
    (moved,) = walk_along_axis(model, "weight", [3.0], base=patient)
    score = score_walker(model, moved)
    assert_allclose(score.axes.loc["weight", ["alpha", "low", "high"]].astype(float), 3.0, atol=1e-6)
    assert score.axes.loc["weight", "percentile"] > 98
    assert_allclose(score.residual, score_walker(model, patient).residual, rtol=1e-6)


def test_z_of_a_moved_feature_is_how_far_it_was_moved(model):
    linearizer, scaler = model["linearizer"], model["scaler"]
    vector = scaler.mean_.copy()
    names = list(linearizer.get_feature_names_out())
    places = [names.index(name) for name in ("mean_head_z", "cos1_left_wrist_x", "frequency")]
    vector[places] += [2.0, -3.0, 1.5] * scaler.spread_[places]
    (walk,) = linearizer.inverse_transform([vector])
    features = score_walker(model, walk).features
    assert list(features.index) == names
    assert_allclose(features["z"].iloc[places], [2.0, -3.0, 1.5], atol=1e-6)
    assert_allclose(features["z"].drop(features.index[places]), 0.0, atol=1e-6)
    assert_allclose(features["value"], vector, atol=1e-9)


def test_constant_and_left_out_features_have_no_z(group, labels, patient):
    still = [replace(walk, positions=_without_sway_of_the_head(walk)) for walk in [*group, patient]]
    model = make_eigenwalkers(n_components=5, weights={"right_ankle": 0}).fit(still[:-1], labels)
    score = score_walker(model, still[-1])
    unscored = score.features.index[score.features["z"].isna()]
    expected = [name for name in score.features.index if "right_ankle" in name or name.endswith("head_y")]
    assert list(unscored) == expected
    # What is left out does not count for the residual either.
    ankle = patient.marker_set.index("right_ankle")
    raised = still[-1].positions + 0.3 * np.eye(15)[ankle][:, np.newaxis] * [0.0, 0.0, 1.0]
    assert_allclose(score_walker(model, replace(still[-1], positions=raised)).residual, score.residual, rtol=1e-6)


def _without_sway_of_the_head(walk):
    positions = walk.positions.copy()
    positions[:, walk.marker_set.index("head"), 1] = 0.25
    return positions


def test_residual_is_1_on_average_over_the_training_walks(model, group):
    assert_allclose(np.mean([score_walker(model, walk).residual for walk in group]), 1.0, rtol=1e-9)


def test_residual_is_unknown_where_everything_is_kept(group, labels, patient):
    for n_components in (None, 40, 39):
        model = make_eigenwalkers(n_components=n_components).fit(group, labels)
        assert np.isnan(score_walker(model, patient).residual)


def test_markers_in_the_wrong_order_are_refused_not_scored(model, patient):
    names = patient.marker_set.names
    swapped = MarkerSet((names[1], names[0], *names[2:]))
    with pytest.raises(WalkError, match="bring all walks to one marker set, in one order"):
        score_walker(model, replace(patient, marker_set=swapped))


def test_order_of_markers_does_not_matter(group, labels, model, patient):
    order = np.random.default_rng(0).permutation(15)
    marker_set = MarkerSet(tuple(patient.marker_set.names[place] for place in order))
    moved = [replace(walk, positions=walk.positions[:, order], marker_set=marker_set) for walk in [*group, patient]]
    other = make_eigenwalkers(n_components=8).fit(moved[:-1], labels)
    _assert_same(score_walker(other, moved[-1]), score_walker(model, patient), interval=True)


def test_a_mirrored_walker_stands_in_the_mirrored_group_as_the_walker_does(group, labels, model, patient):
    mirrored = make_eigenwalkers(n_components=8).fit([mirror_walk(walk) for walk in group], labels)
    score = score_walker(mirrored, mirror_walk(patient))
    _assert_same(score, score_walker(model, patient), interval=False)  # its strides start half a stride later


def test_start_of_the_recording_does_not_matter(model):
    scores = []
    for phase in (0.0, 1.3, 4.0):
        walk, _ = make_walk(np.random.default_rng(1), n_cycles=8, phase=phase)
        scores.append(score_walker(model, walk))
    for score in scores[1:]:
        _assert_same(score, scores[0], interval=True)


def _assert_same(got, expected, *, interval):
    columns = ["alpha", "label", "percentile", *(["low", "high"] if interval else [])]
    assert_allclose(got.axes[columns], expected.axes[columns], atol=1e-6)
    for name in ("distance", "share_beyond", "residual"):
        assert_allclose(getattr(got, name), getattr(expected, name), rtol=1e-6)


def test_share_is_unknown_with_too_few_training_walkers(group, labels, patient):
    score = score_walker(make_eigenwalkers(n_components=6).fit(group[:6], labels[:6]), patient)
    assert np.isnan(score.share_beyond)
    assert score.distance_limit == np.inf
    assert "too few training walkers to say" in str(score)


def test_classifier_at_the_end(group, labels, patient):
    gender = labels["gender"]
    model = make_eigenwalkers(n_components=8, trait=TraitClassifier()).fit(group, gender)
    score = score_walker(model, patient)
    same = score_walker(make_eigenwalkers(n_components=8).fit(group, gender), patient)
    pd.testing.assert_frame_equal(score.axes, same.axes)
    assert (score.axes["label"] > 0).tolist() == (model.predict([patient]) == "male").tolist()


def test_recordings_are_prepared_first():
    walkers = make_walkers(21, duration=8, frame_rate=60, treadmill=False, random_state=1)
    steps = [
        ("preparer", WalkPreparer()),
        ("linearizer", FourierLinearizer(extras=("speed",))),
        ("scaler", BlockScaler(2)),
        ("eigenwalkers", PCA(5, svd_solver="full")),
        ("trait", TraitRegressor()),
    ]
    model = Pipeline(steps).fit(walkers.data[:20], walkers.target["weight"][:20])
    score = score_walker(model, walkers.data[20])
    assert score.axes["alpha"].iloc[0] == model.transform(walkers.data[20:])[0, 0]
    assert 0.5 < score.walk.speed == score.features.loc["speed", "value"]
    assert abs(score.walk.marker("pelvis")[:, 0]).max() < 0.5
    assert score.n_strides >= 3


def test_an_unknown_speed_is_the_error_of_the_linearizer(walkers):
    model = make_eigenwalkers(n_components=4, extras=("speed",)).fit(walkers.data[:20], walkers.target["happy"][:20])
    with pytest.raises(WalkError, match="its speed must be known to be a feature"):
        score_walker(model, replace(walkers.data[21], speed=np.nan))


def test_joint_walks_are_scored_as_well():
    rng, walks = np.random.default_rng(6), [_joint_walk(size) for size in np.linspace(0.3, 0.7, 8)]
    model = make_eigenwalkers(n_components=1)
    model.set_params(linearizer__phase_reference={"left_x": 1.0, "right_x": -1.0}).fit(walks, rng.normal(size=8))
    score = score_walker(model, _joint_walk(0.52))
    assert_array_equal(score.axes["alpha"], model.transform([_joint_walk(0.52)])[0])
    assert score.n_strides == 4
    assert_allclose(score.axes["percentile"], 50.0)
    assert isinstance(score.average, JointWalk)


def _joint_walk(size):
    angle = 2 * np.pi * np.arange(450) / 100
    rotations = np.zeros((450, 3, 3))
    rotations[:, 1, 0], rotations[:, 2, 0] = size * np.cos(angle), -(size**2) * np.cos(angle)
    skeleton = Skeleton(("hips", "left", "right"), [-1, 0, 0], np.zeros((3, 3)))
    return JointWalk(rotations, np.zeros((450, 3)), skeleton, 100.0)


@pytest.mark.filterwarnings("error")
def test_pandas_output(group, labels, model, patient):
    tables = make_eigenwalkers(n_components=8).set_output(transform="pandas").fit(group, labels)
    pd.testing.assert_frame_equal(score_walker(tables, patient).axes, score_walker(model, patient).axes)


def test_one_walk_that_is_poorly_explained_is_named_once(model, patient):
    noisy = replace(
        patient, positions=patient.positions + np.random.default_rng(0).normal(size=patient.positions.shape)
    )
    with pytest.warns(UserWarning, match="harmonics explain less than 50%") as caught:
        score_walker(model, noisy)
    assert len(caught) == 1


@pytest.mark.parametrize("missing", ["scaler", "eigenwalkers"])
def test_own_pipelines_need_the_same_kinds_of_steps(group, labels, patient, missing):
    steps = [(name, step) for name, step in make_eigenwalkers(n_components=8).steps if name != missing]
    model = Pipeline(steps).fit(group, labels)
    with pytest.raises(ValueError, match=r"model must have a (BlockScaler right after its linearizer|PCA before) "):
        score_walker(model, patient)


def test_wrong_arguments_are_refused(model, patient):
    with pytest.raises(TypeError, match=r"expected one Walk or JointWalk, got list; score walkers one at a time"):
        score_walker(model, [patient])
    with pytest.raises(ValueError, match="level must be between 0 and 1, got 95"):
        score_walker(model, patient, level=95)
    with pytest.raises(ValueError, match="model must have a FourierLinearizer among its steps"):
        score_walker(model[1:], patient)


def test_a_score_can_be_read(model, patient):
    score = score_walker(model, replace(patient, name="anna <1>"))
    assert str(score).startswith("anna <1>, 95 % intervals from ")
    assert str(score).endswith(" % of walkers like those in training are further away")
    assert f"distance {score.distance:.1f} SD" in repr(score)
    page = score._repr_html_()
    assert "anna &lt;1&gt;" in page
    assert page.count("<tr") == 5  # two lines of head
    assert "fewer than 1 % of walkers" in str(score._replace(share_beyond=0.004))
    pd.testing.assert_frame_equal(score.to_frame(), score.axes)
    assert score.to_frame() is not score.axes
