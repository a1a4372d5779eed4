"""Models of styles: what adaptation gains, how weights are chosen, blends, and styles told apart by likelihood."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.metrics import get_scorer

from eigenwalker.hsmm import GaitHSMM, StyleClassifier, blend, make_labels
from eigenwalker.hsmm.gait_generation import moments_in_channels
from eigenwalker.motion import quality_table
from tests.hsmm.walking import shaken_walks, step_arrays

METHODS = ("csmaplr+map", "csmaplr", "cmllr+map", "cmllr", "map")


@pytest.fixture(scope="module")
def average():
    return GaitHSMM().fit(shaken_walks(6))


@pytest.fixture(scope="module")
def bent():
    """Walks on bent knees, and slower."""
    return shaken_walks(5, first=20, bend=0.3, frequency=0.75)


@pytest.fixture(scope="module")
def style(average, bent):
    return average.adapt(bent[:2])


@pytest.mark.parametrize("method", METHODS)
def test_every_method_makes_other_walks_of_the_style_more_likely(method, average, bent):
    adapted = average.adapt(bent[:2], method=method, transform_weight=100.0, map_weight=10.0, mixing="none")
    assert adapted.score(bent[2:]) > average.score(bent[2:]) + 10
    assert adapted.adaptation_["method"] == method


def test_the_average_is_untouched(average, bent):
    before = pickle.dumps(average)
    average.adapt(bent[:1])
    assert pickle.dumps(average) == before


def test_weights_are_those_of_the_best_held_out_walks(style):
    report = style.adaptation_
    trials = np.array(report["held_out"])
    best = trials[trials[:, 2] == trials[:, 2].max()]
    assert (report["transform_weight"], report["map_weight"]) in {tuple(row[:2]) for row in best}


def test_one_walk_has_the_usual_weights(average, bent):
    report = average.adapt(bent[:1]).adaptation_
    assert report["held_out"] == ()
    assert (report["transform_weight"], report["map_weight"]) == (1000.0, 30.0)


@pytest.mark.parametrize("method", ["csmaplr+map", "map"])
def test_infinite_weights_change_nothing_but_durations(method, average, bent):
    same = average.adapt(bent[:1], method=method, transform_weight=np.inf, map_weight=np.inf)
    np.testing.assert_allclose(same.means_, average.means_, atol=1e-12)
    np.testing.assert_allclose(same.transforms_[0], average.transforms_[0], atol=1e-12)


def test_map_without_prior_is_training_on_the_style_alone(average, bent):
    alone = average.adapt(bent, method="map", map_weight=0.0, max_iter=30)
    assert alone.score(bent) > average.adapt(bent, method="map", map_weight=30.0, max_iter=30).score(bent)


def test_durations_follow_the_style(average, style):
    """The style's steps take 0.9 / 0.75 times as long."""
    ratio = style.synthesize(12).n_frames / average.synthesize(12).n_frames
    assert ratio == pytest.approx(0.9 / 0.75, rel=0.05)


def test_new_walks_have_the_bent_knees(average, style):
    knees = [
        walk.rotations[:, walk.skeleton.index("LeftLeg"), 1].mean()
        for walk in (average.synthesize(12, hold=False), style.synthesize(12, hold=False))
    ]
    assert knees[1] - knees[0] == pytest.approx(0.3, abs=0.05)


def test_too_few_frames_for_the_classes_is_said(average, bent):
    with pytest.warns(UserWarning, match=r"frames are too few for 12 classes .* took \d"):
        few = average.adapt(bent[:1], n_classes=12, transform_weight=1000.0, map_weight=30.0)
    assert few.adaptation_["n_classes"] < 12


def test_more_classes_have_transforms_of_their_own(average, bent):
    model = average.adapt(bent[:2], n_classes=2, transform_weight=100.0, map_weight=30.0)
    assert model.transforms_.shape[0] == 2 == model.adaptation_["n_classes"]
    assert np.isfinite(model.score(bent[2:]))
    assert model.synthesize(6).n_frames > 100


def test_transforms_of_joints_mix_no_other_channels(average, bent):
    matrix = average.adapt(bent[:1], method="csmaplr", transform_weight=10.0).transforms_[0][:, :-1]
    inside = np.kron(np.eye(7), np.ones((3, 3))).astype(bool)
    assert not matrix[~inside].any()
    assert np.abs(matrix[inside & ~np.eye(21, dtype=bool)]).max() > 1e-4


def test_adapted_models_are_not_adapted_again(style, bent):
    with pytest.raises(ValueError, match="adapted already"):
        style.adapt(bent)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"method": "mllr"}, "method"),
        ({"mixing": "some"}, "mixing"),
        ({"transform_weight": -1.0, "n_classes": 0}, "transform_weight must be zero or more.*\nn_classes must be 1"),
    ],
)
def test_impossible_options(options, match, average, bent):
    with pytest.raises(ValueError, match=match):
        average.adapt(bent[:1], **options)


def test_arrays_whose_channels_are_no_joints():
    arrays, _ = step_arrays(4)
    labels = [make_labels(8)] * 4
    model = GaitHSMM().fit(arrays, labels)
    with pytest.raises(ValueError, match="three channels a joint, got 2"):
        model.adapt(arrays, labels)
    moved = [1.5 * array + 0.3 for array in arrays]
    adapted = model.adapt(moved, labels, mixing="none")
    assert adapted.score(moved, labels) > model.score(moved, labels) + 1


def test_a_blend_leads_from_one_to_the_other(average, style):
    ends = [moments_in_channels(model._states()) for model in (average, style)]
    for weight, (means, variances) in zip((0.0, 1.0), ends, strict=True):
        mixed = blend(average, style, weight)
        np.testing.assert_allclose(mixed.means_, means, atol=1e-12)
        np.testing.assert_allclose(mixed.covars_, variances, rtol=1e-9)
    place = average.template_.skeleton.index("LeftLeg")
    knees = [
        blend(average, style, weight).synthesize(6, hold=False).rotations[:, place, 1].mean()
        for weight in (-0.5, 0.0, 0.5, 1.0, 1.5)
    ]
    assert (np.diff(knees) > 0.05).all()


def test_blends_of_strangers_are_refused(average):
    other = GaitHSMM(n_states=4).fit(shaken_walks(3))
    with pytest.raises(ValueError, match="expected two models adapted from one average model"):
        blend(average, other, 0.5)
    with pytest.raises(ValueError, match="weight must be finite"):
        blend(average, average, np.nan)


def test_styles_are_told_apart(bent):
    walks = [*shaken_walks(4), *bent[:3]]
    styles = ["plain"] * 4 + ["bent"] * 3
    classifier = StyleClassifier().fit(walks, styles)
    assert classifier.classes_.tolist() == ["bent", "plain"]
    assert classifier.predict([bent[4], shaken_walks(1, first=70)[0]]).tolist() == ["bent", "plain"]
    assert classifier.score(bent[3:], ["bent"] * 2) == 1.0
    likelihoods = classifier.log_likelihoods(bent[3:])
    assert likelihoods.shape == (2, 2)
    np.testing.assert_array_equal(classifier.decision_function(bent[3:]), likelihoods[:, 1] - likelihoods[:, 0])
    assert get_scorer("roc_auc")(classifier, walks, styles) == 1.0
    assert clone(classifier).get_params()["method"] == "csmaplr+map"


def test_one_style_is_none(bent):
    with pytest.raises(ValueError, match="at least two styles, got \\['bent'\\]"):
        StyleClassifier().fit(bent[:2], ["bent"] * 2)
    with pytest.raises(ValueError, match="a style for each of the 2 walks"):
        StyleClassifier().fit(bent[:2], ["bent"])


def test_new_walks_go_as_fast_as_those_of_the_style(average, bent):
    known = [replace(walk, speed=0.9) for walk in bent[:2]]
    style = average.adapt(known, transform_weight=100.0, map_weight=30.0)
    unknown = average.adapt(bent[:2], transform_weight=100.0, map_weight=30.0)
    assert style.walking_speed_ == pytest.approx(0.9)
    assert np.isnan(unknown.walking_speed_)
    speeds = [quality_table([model.synthesize(8)])["speed_m_per_s"][0] for model in (style, unknown)]
    assert abs(speeds[0] - 0.9) <= abs(speeds[1] - 0.9)


def test_joints_that_stand_still_do_no_harm():
    """As wrists of many recordings: a channel that is one number."""
    still, others = shaken_walks(3), shaken_walks(2, first=20, bend=0.3)
    rigid = [_stiffen(walk) for walk in (*still, *others)]
    model = GaitHSMM().fit(rigid[:3]).adapt(rigid[3:4])
    assert np.isfinite(model.global_variance_).all()
    assert np.isfinite(blend(model, model, 0.5).synthesize(6).rotations).all()


def _stiffen(walk):
    rotations = np.array(walk.rotations)
    rotations[:, walk.skeleton.index("LeftFoot")] = 0.2
    return replace(walk, rotations=rotations)


def test_blends_of_other_rates_are_refused(average):
    slow = GaitHSMM(tying=None).fit(shaken_walks(2, n_frames=300, frame_rate=50.0))
    with pytest.raises(ValueError, match="60 and 50 frames per second"):
        blend(GaitHSMM(tying=None).fit(shaken_walks(2)), slow, 0.5)


def test_map_alone_is_an_adaptation_too(average, bent):
    with pytest.raises(ValueError, match="adapted already"):
        average.adapt(bent[:1], method="map").adapt(bent[:1])
