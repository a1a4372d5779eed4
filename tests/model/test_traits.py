"""Trait axes on scores."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from sklearn.metrics import r2_score
from sklearn.utils.estimator_checks import parametrize_with_checks

from eigenwalker.model import BlockScaler, TraitClassifier, TraitRegressor


@parametrize_with_checks([BlockScaler(), TraitRegressor(), TraitClassifier()])
def test_scikit_learn_contract(estimator, check):
    check(estimator)


@pytest.fixture
def data():
    """Correlated scores of different variance, and two traits in them."""
    rng = np.random.default_rng(0)
    scores = rng.normal(size=(60, 5)) @ rng.normal(size=(5, 5)) + rng.normal(size=5)
    labels = scores @ rng.normal(size=(5, 2)) + 0.5 * rng.normal(size=(60, 2)) + [3.0, -70.0]
    return scores, pd.DataFrame(labels, columns=["mood", "weight"])


def test_is_least_squares_with_intercept(data):
    """Troje 2002, Eq. 5."""
    scores, labels = data
    axes = TraitRegressor().fit(scores, labels)
    design = np.column_stack((np.ones(60), scores))
    expected = np.linalg.lstsq(design, labels.to_numpy())[0]
    assert_allclose(axes.coef_, expected[1:].T, atol=1e-10)
    assert_allclose(axes.predict(scores), design @ expected, atol=1e-9)
    assert_allclose(axes.intercept_, labels.mean(), atol=1e-9)


@pytest.mark.parametrize("unit", ["sd", "label", "coefficient"])
@pytest.mark.parametrize("direction", ["pattern", "filter"])
@pytest.mark.filterwarnings("ignore::eigenwalker.model.OutsideDataWarning")
def test_alpha_round_trip(data, unit, direction):
    scores, labels = data
    axes = TraitRegressor(alpha_unit=unit, direction=direction).fit(scores, labels)
    alphas = np.random.default_rng(1).normal(size=(7, 2))
    assert_allclose(axes.transform(axes.inverse_transform(alphas)), alphas, atol=1e-12)
    assert_allclose(axes.transform([scores.mean(axis=0)]), [[0, 0]], atol=1e-12)


def test_one_unit_is_one_standard_deviation(data):
    scores, labels = data
    assert_allclose(TraitRegressor().fit(scores, labels).transform(scores).std(axis=0, ddof=1), 1)


def test_one_unit_is_a_standard_deviation_over_persons(data):
    scores, labels = data
    persons = np.repeat(np.arange(20), 3)
    alphas = TraitRegressor().fit(scores, labels, groups=persons).transform(scores)
    assert_allclose(alphas.reshape(20, 3, 2).mean(axis=1).std(axis=0, ddof=1), 1)


@pytest.mark.filterwarnings("ignore::eigenwalker.model.OutsideDataWarning")
def test_filter_with_coefficient_is_equation_six(data):
    """Troje 2002, Eq. 6: the step for alpha is alpha c'."""
    scores, labels = data
    axis = TraitRegressor(alpha_unit="coefficient", direction="filter").fit(scores, labels["mood"])
    c = np.linalg.lstsq(np.column_stack((np.ones(60), scores)), labels["mood"].to_numpy())[0][1:]
    assert_allclose(axis.inverse_transform([[1.7]]), [scores.mean(axis=0) + 1.7 * c], atol=1e-10)


def test_pattern_is_the_covariance_with_the_trait(data):
    """One trait: the step is proportional to cov(score, displacement)."""
    scores, labels = data
    axis = TraitRegressor(alpha_unit="label").fit(scores, labels["mood"])
    a = axis.transform(scores)[:, 0]
    covariance = np.cov(np.column_stack((scores, a)).T)[:-1, -1]
    assert_allclose(axis.step([[1.0]], ["mood"])[0], covariance / a.var(ddof=1), atol=1e-10)


def test_free_traits_follow_the_pattern(data):
    scores, labels = data
    axes = TraitRegressor(alpha_unit="label").fit(scores, labels)
    step = axes.step([[1.0]], ["mood"])
    a = axes.transform(scores)
    slope = np.cov(a.T)[0, 1] / a[:, 0].var(ddof=1)
    moved = axes.transform(scores.mean(axis=0) + step)[0]
    assert_allclose(moved, [1.0, slope], atol=1e-10)


def test_missing_labels_count_for_the_average_only(data):
    scores, labels = data
    partial = labels.copy()
    partial.loc[::3, "mood"] = np.nan
    axes = TraitRegressor().fit(scores, partial)
    known = partial["mood"].notna().to_numpy()
    alone = TraitRegressor().fit(scores[known], partial.loc[known, "mood"])
    assert_allclose(axes.coef_[0], alone.coef_[0], atol=1e-10)
    assert_allclose(axes.mean_, scores.mean(axis=0))
    expected = np.mean(
        [
            r2_score(partial[n][k], axes.predict(scores)[k, i])
            for i, (n, k) in enumerate((name, partial[name].notna().to_numpy()) for name in partial)
        ]
    )
    assert_allclose(axes.score(scores, partial), expected)


def test_words_are_coded_by_poles(data):
    scores, labels = data
    words = pd.Series(np.where(labels["mood"] > 3, "happy", "sad"), name="mood")
    plain = TraitRegressor().fit(scores, words)
    assert plain.poles_ == {"mood": ("happy", "sad")}
    turned = TraitRegressor(poles={"mood": ("sad", "happy")}).fit(scores, words)
    assert_allclose(turned.transform(scores), -plain.transform(scores))
    means = turned.alpha_means_["mood"]
    assert means["sad"] < turned.alpha_boundary_["mood"] < means["happy"]
    assert_allclose(means["sad"], turned.transform(scores[words == "sad"]).mean())
    side = turned.predict(scores) > 0
    assert (side == (turned.transform(scores)[:, 0] > turned.alpha_boundary_["mood"])).all()


def test_words_may_be_missing(data):
    scores, labels = data
    words = pd.Series(np.where(labels["mood"] > 3, "happy", "sad"), name="mood", dtype=object)
    words[:5] = None
    assert_allclose(TraitRegressor().fit(scores, words).coef_, TraitRegressor().fit(scores[5:], words[5:]).coef_)


@pytest.mark.parametrize(
    ("labels", "options", "message"),
    [
        (["a"] * 60, {}, "trait 'trait': expected two classes, got one class only, 'a'"),
        (["a", "b", "c"] * 20, {}, "expected numbers or two classes, got 3 classes, 'a', 'b', 'c'"),
        ([None] * 60, {}, "expected labels, got none but missing ones"),
        (["a", "b"] * 30, {"poles": {"trait": ("a", "c")}}, r"labels are \['a', 'b'\], but its poles are"),
        (np.zeros((60, 2)), {"poles": {"mood": ("a", "c")}}, "poles name the trait 'mood', which is not among"),
        (np.arange(60.0), {"poles": {"trait": "ab"}}, "must be two different words"),
        (np.arange(60.0), {"alpha_unit": "metres"}, "alpha_unit must be one of 'sd', 'label', 'coefficient', got"),
        (np.arange(60.0), {"direction": "north"}, "direction must be one of"),
        (np.arange(59.0), {}, "inconsistent numbers of samples"),
        (
            pd.DataFrame(np.eye(60, 2), columns=["mood", "mood"]),
            {},
            "y must have columns with different names, got 'mood' more than once",
        ),
    ],
)
def test_wrong_labels_and_parameters_are_refused(data, labels, options, message):
    with pytest.raises(ValueError, match=message):
        TraitRegressor(**options).fit(data[0], labels)


def test_unknown_labels_in_score_are_refused(data):
    scores, _ = data
    axis = TraitRegressor().fit(scores, ["a", "b"] * 30)
    with pytest.raises(ValueError, match=r"expected \['a', 'b'\], got 'z'"):
        axis.score(scores, ["a", "z"] * 30)


def test_dependent_traits_cannot_be_set_apart(data):
    scores, labels = data
    twice = labels.assign(gloom=-2 * labels["mood"])
    axes = TraitRegressor().fit(scores, twice)
    with pytest.raises(ValueError, match="traits mood, weight, gloom cannot be set independently"):
        axes.inverse_transform([[1.0, 0.0, 0.0]])
    assert_allclose(axes.step([[1.0]], ["mood"]), -axes.step([[1.0]], ["gloom"]), atol=1e-9)
    with pytest.raises(ValueError, match="trait must be one of 'mood', 'weight', 'gloom', got 'age'"):
        axes.step([[1.0]], ["age"])


def test_classifier_is_the_sign_of_the_regressor(data):
    scores, labels = data
    groups = pd.Series(np.where(labels["mood"] > 3, "male", "female"), name="gender")
    classifier = TraitClassifier().fit(scores, groups)
    codes = np.where(groups == "male", 1.0, -1.0)
    regressor = TraitRegressor().fit(scores, codes)
    assert_allclose(classifier.decision_function(scores), regressor.predict(scores))
    assert_allclose(classifier.transform(scores), regressor.transform(scores))
    assert (classifier.predict(scores) == np.where(regressor.predict(scores) > 0, "male", "female")).all()
    assert_allclose(classifier.inverse_transform([[2.0]]), regressor.inverse_transform([[2.0]]))
    means = classifier.alpha_means_
    assert means["female"] < classifier.alpha_boundary_ < means["male"]
    assert list(classifier.get_feature_names_out()) == ["gender"]


def test_poles_turn_the_axis_and_not_the_decision(data):
    scores, labels = data
    groups = pd.Series(np.where(labels["mood"] > 3, "male", "female"), name="gender")
    plain = TraitClassifier().fit(scores, groups)
    turned = TraitClassifier(poles={"gender": ("male", "female")}).fit(scores, groups)
    assert_allclose(turned.transform(scores), -plain.transform(scores))
    assert_allclose(turned.decision_function(scores), plain.decision_function(scores))
    assert (turned.predict(scores) == plain.predict(scores)).all()


@pytest.mark.parametrize(
    ("labels", "options", "message"),
    [
        (["a"] * 60, {}, "expected two classes, got one class only: 'a'"),
        (["a", "b", "c"] * 20, {}, "expected two classes, got 3 classes"),
        (["a", None, "b"] * 20, {}, "contains NaN: 20 of 60 labels are missing; leave these walkers out"),
        (pd.DataFrame({"a": [1, 2] * 30, "b": [1, 2] * 30}), {}, "one column, got 2; use TraitRegressor"),
        (["a", "b"] * 30, {"poles": {"trait": ("a", "c")}}, "poles must be .* with the groups"),
    ],
)
def test_wrong_groups_are_refused(data, labels, options, message):
    with pytest.raises(ValueError, match=message):
        TraitClassifier(**options).fit(data[0], labels)


def test_the_boundary_midway_favors_neither_group():
    rng = np.random.default_rng(0)
    sex = np.array(["F"] * 20 + ["M"] * 80)
    scores = rng.normal(size=(100, 2)) + np.where(sex == "F", -1.0, 1.0)[:, np.newaxis] * [1.0, 0.0]
    shares = {}
    for boundary in ("zero", "midpoint"):
        classifier = TraitClassifier(boundary=boundary).fit(scores, sex)
        guess = classifier.predict(scores)
        shares[boundary] = [(guess[sex == group] == group).mean() for group in ("F", "M")]
        decided = classifier.decision_function(scores) > 0
        np.testing.assert_array_equal(decided, classifier.transform(scores)[:, 0] > classifier.alpha_boundary_)
    midway = np.mean(list(TraitClassifier(boundary="midpoint").fit(scores, sex).alpha_means_.values()))
    assert_allclose(TraitClassifier(boundary="midpoint").fit(scores, sex).alpha_boundary_, midway)
    assert shares["midpoint"][0] > shares["zero"][0]
    with pytest.raises(ValueError, match="boundary must be one of 'zero', 'midpoint'"):
        TraitClassifier(boundary="middle").fit(scores, sex)
