"""Axes that do not go along with control variables, and features that are weighted or left out."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize
from sklearn.decomposition import PCA
from sklearn.model_selection import LeaveOneGroupOut, LeaveOneOut, cross_val_predict
from sklearn.pipeline import Pipeline

from eigenwalker.datasets import make_walkers
from eigenwalker.model import (
    BlockScaler,
    TraitClassifier,
    TraitRegressor,
    bootstrap_axes,
    learning_curve_walkers,
    loo_matrix,
    loo_predict,
    make_eigenwalkers,
    nested_loo,
    permutation_test,
    settings_of,
    walk_along_axis,
)


@pytest.fixture
def people():
    """Return vectors, labels that go along with sex and height, and these."""
    random = np.random.default_rng(0)
    sex = random.permutation(np.repeat(["f", "m"], 20))
    height = 170 + 7 * random.normal(size=40) + 6 * (sex == "m")
    weight = 70 + 0.8 * (height - 170) + 5 * (sex == "m") + 6 * random.normal(size=40)
    causes = np.column_stack((sex == "m", (height - 170) / 8, (weight - 70) / 10))
    vectors = random.normal(size=(40, 12)) * np.geomspace(1, 0.1, 12) + causes @ random.normal(size=(3, 12))
    return vectors, weight, pd.DataFrame({"sex": sex, "height": height})


def covariance(values, controls):
    numbers = controls.replace({"f": -1.0, "m": 1.0}).astype(float) if isinstance(controls, pd.DataFrame) else controls
    return np.cov(np.column_stack((values, numbers)).T)[0, 1:]


def test_a_controlled_axis_has_no_covariance_with_its_controls(people):
    vectors, weight, controls = people
    axis = TraitRegressor().fit(vectors, weight, control=controls)
    assert abs(covariance(axis.transform(vectors)[:, 0], controls)).max() < 1e-12
    assert abs(covariance(TraitRegressor().fit(vectors, weight).transform(vectors)[:, 0], controls)).min() > 0.1
    assert axis.control_names_ == ["sex", "height"]


def test_it_is_the_best_of_those_without(people):
    """A general optimizer with the covariances as equality constraints finds no better."""
    vectors, weight, controls = people
    centered, y = vectors - vectors.mean(axis=0), weight - weight.mean()
    z = np.column_stack((np.where(controls["sex"] == "m", 1.0, -1.0), controls["height"]))
    z = (z - z.mean(axis=0)) / z.std(axis=0)
    found = minimize(
        lambda c: np.sum((y - centered @ c) ** 2),
        np.zeros(12),
        jac=lambda c: -2 * centered.T @ (y - centered @ c),
        constraints={"type": "eq", "fun": lambda c: z.T @ centered @ c, "jac": lambda c: z.T @ centered},
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 500},
    )
    assert_allclose(TraitRegressor().fit(vectors, weight, control=controls).coef_[0], found.x, atol=1e-5)


def test_a_step_along_it_leaves_the_predicted_controls(people):
    vectors, weight, controls = people
    axis = TraitRegressor().fit(vectors, weight, control=controls)
    height = TraitRegressor().fit(vectors, controls["height"])
    steps = axis.step([[1.0], [-3.0]], axis.trait_names_)
    assert_allclose(height.predict(vectors[:2] + steps), height.predict(vectors[:2]), atol=1e-10)


def test_units_of_controls_and_copies_of_them_change_nothing(people):
    vectors, weight, controls = people
    one = TraitRegressor().fit(vectors, weight, control=controls).coef_
    twice = controls.assign(metres=controls["height"] / 100, hours=3.0)
    assert_allclose(TraitRegressor().fit(vectors, weight, control=twice).coef_, one, atol=1e-10)


def test_missing_labels_and_classifiers(people):
    vectors, weight, controls = people
    labels = pd.DataFrame({"weight": weight, "heavy": np.where(weight > 73, "yes", "no")})
    partial = labels.astype({"weight": float}).copy()
    partial.loc[::4, "weight"] = np.nan
    axes = TraitRegressor().fit(vectors, partial, control=controls)
    for alphas in axes.transform(vectors).T:
        assert abs(covariance(alphas, controls)).max() < 1e-10
    classifier = TraitClassifier().fit(vectors, labels["heavy"], control=controls)
    assert_allclose(classifier.transform(vectors)[:, 0], axes.transform(vectors)[:, 1])


@pytest.mark.parametrize(
    ("control", "message"),
    [
        (np.arange(39), "one row a walk, 40, got 39"),
        (np.zeros((40, 1, 1)), "control must have shape"),
        (pd.Series([None] + [1.0] * 39, name="age"), "no missing values, got 1 of 40 walks with one among age"),
        (pd.DataFrame({"weight": np.arange(40.0)}), "cannot be controlled for itself, got weight"),
        (np.random.default_rng(0).normal(size=(40, 12)), "more components than the 12 control"),
    ],
)
def test_wrong_controls_are_refused(people, control, message):
    vectors, weight, _ = people
    with pytest.raises(ValueError, match=message):
        TraitRegressor().fit(vectors, pd.Series(weight, name="weight"), control=control)


def refit(vectors, labels, controls, n_components, scaling, groups, weights=None):
    """Return what scikit-learn predicts with the Pipeline, fitted anew in every fold."""
    model = Pipeline(
        [
            ("scaler", BlockScaler(unit=scaling, weights=weights)),
            ("eigenwalkers", PCA(n_components, svd_solver="full")),
            ("trait", TraitRegressor()),
        ]
    )
    options = {"trait__control": controls} if controls is not None else {}
    options |= {"scaler__groups": groups} if scaling == "noise" else {}
    folds = LeaveOneOut() if groups is None else LeaveOneGroupOut()
    return cross_val_predict(model, vectors, labels, groups=groups, cv=folds, params=options)


@pytest.mark.parametrize("scaling", [None, "blocks", "features", "noise"])
@pytest.mark.parametrize("n_components", [3, 7, 12])
@pytest.mark.parametrize("wide", [False, True])
def test_leaving_out_equals_refits(people, scaling, n_components, wide):
    vectors, weight, controls = people
    random = np.random.default_rng(1)
    if wide:
        vectors, weight, controls = vectors[:20] @ random.normal(size=(12, 30)), weight[:20], controls[:20]
        vectors += random.normal(size=vectors.shape)
    labels = np.column_stack((weight, random.normal(size=len(weight)), np.sign(random.normal(size=len(weight)))))
    labels[random.random(labels.shape) < [0.0, 0.2, 0.0]] = np.nan
    persons = np.arange(len(weight)) * 2 // 3
    for groups in (None, persons) if scaling != "noise" else (persons,):
        expected = refit(vectors, labels, controls, n_components, scaling, groups)
        options = {"n_components": n_components, "scaling": scaling, "groups": groups, "control": controls}
        assert_allclose(loo_predict(vectors, labels, **options), expected, rtol=0, atol=1e-10)
        matrix = loo_matrix(vectors, **options)
        assert_allclose(matrix @ labels[:, [0, 2]], expected[:, [0, 2]], rtol=0, atol=1e-10)
        many = loo_predict(vectors, labels, **options | {"n_components": [3, n_components]})
        assert_allclose(many[1], expected, rtol=0, atol=1e-10)


def test_every_number_of_components_begins_above_the_controls(people):
    vectors, weight, controls = people
    predicted = loo_predict(vectors, weight, n_components=None, control=controls)
    assert predicted.shape == (10, 40)
    expected = [refit(vectors, weight, controls, number, None, None) for number in range(3, 13)]
    assert_allclose(predicted, expected, rtol=0, atol=1e-10)
    with pytest.raises(ValueError, match="between 3 and 12, which is what 2 controls"):
        loo_predict(vectors, weight, n_components=2, control=controls)


def test_repeated_variances_with_controls():
    corners = np.vstack((np.eye(6), -np.eye(6), np.eye(6)[:2], -np.eye(6)[:2]))
    random = np.random.default_rng(2)
    labels, control = random.normal(size=(2, len(corners)))
    expected = refit(corners, labels, control, 6, None, None)
    assert_allclose(loo_predict(corners, labels, n_components=6, control=control), expected, rtol=0, atol=1e-10)


def test_permutations_and_nested_numbers_keep_the_control(people):
    vectors, weight, controls = people
    options = {"n_components": 6, "control": controls}
    test = permutation_test(vectors, weight, score="r", n_permutations=20, random_state=0, **options)
    assert_allclose(test.score, np.corrcoef(weight, loo_predict(vectors, weight, **options))[0, 1])
    matrix = loo_matrix(vectors, **options)
    same = permutation_test(matrix, weight, score="r", n_permutations=20, random_state=0)
    assert_allclose(test.null, same.null)
    with pytest.raises(ValueError, match="a matrix has it from"):
        permutation_test(matrix, weight, control=controls)
    nested = nested_loo(vectors, weight, n_components=[3, 6], control=controls)
    curve = loo_predict(vectors, weight, n_components=[3, 6], control=controls)
    assert_allclose(nested.curve, ((curve - weight) ** 2).mean(axis=1))


@pytest.mark.parametrize("missing", [False, True])
def test_resampled_axes_are_controlled(people, missing):
    vectors, weight, controls = people
    weight = np.where(np.arange(40) % 5 == 0, np.nan, weight) if missing else weight
    result = bootstrap_axes(vectors, weight, n_components=6, control=controls, n_resamples=50, random_state=0)
    pca = PCA(6, svd_solver="full").fit(vectors)
    axis = TraitRegressor().fit(pca.transform(vectors), weight, control=controls)
    assert_allclose(result.axes, (axis.step([[1.0]], axis.trait_names_) @ pca.components_)[0], atol=1e-10)
    height = TraitRegressor().fit(pca.transform(vectors), controls["height"])
    assert abs(height.coef_ @ pca.components_ @ result.axes) < 1e-10
    curve = learning_curve_walkers(vectors, weight, n_components=4, control=controls, n_repeats=5, random_state=0)
    assert np.isfinite(curve.scores).all()


@pytest.mark.parametrize("scaling", [None, "blocks", "features", "noise"])
def test_weighted_features_equal_refits(people, scaling):
    vectors, weight, _ = people
    weights = np.linspace(0, 2, 12).round(1)
    weights[[3, 11]] = [0.0, 0.5]
    persons = np.arange(40) // 2
    for groups in (None, persons) if scaling != "noise" else (persons,):
        expected = refit(vectors, weight, None, 5, scaling, groups, weights)
        options = {"n_components": 5, "scaling": scaling, "groups": groups, "weights": weights}
        assert_allclose(loo_predict(vectors, weight, **options), expected, rtol=0, atol=1e-10)
        assert_allclose(loo_matrix(vectors, **options) @ weight, expected, rtol=0, atol=1e-10)
        axes = bootstrap_axes(vectors, weight, n_resamples=20, random_state=0, **options).axes
        assert (axes[[0, 3]] == 0).all()
        assert (axes[[1, 2, 11]] != 0).all()


def test_only_single_features_are_features_each_by_its_own_spread(people):
    vectors, weight, _ = people
    weights = np.r_[np.zeros(9), np.ones(3)]
    options = {"n_components": 2, "scaling": "blocks", "n_scalars": 3, "weights": weights}
    expected = loo_predict(vectors[:, 9:], weight, n_components=2, scaling="features", n_scalars=0)
    assert_allclose(loo_predict(vectors, weight, **options), expected, rtol=0, atol=1e-10)


def test_a_part_left_out_is_the_model_of_the_other(tmp_path):
    walkers = make_walkers(24, random_state=0)
    weight = walkers.target["weight"]
    model = make_eigenwalkers(n_components=5, weights={"structure": 0, "frequency": 2}).fit(walkers.data, weight)
    assert np.isinf(model["scaler"].scale_[:45]).all()
    assert_allclose(model["scaler"].block_shares_.sum(), 1)
    light, heavy = walk_along_axis(model, "weight", [-2, 2], base=walkers.data[0])
    assert_allclose(model.transform([light, heavy]).ravel(), [-2, 2], atol=1e-8)
    vectors = model["linearizer"].transform([walkers.data[0], light, heavy]).to_numpy()
    assert_allclose(vectors[1:, :45], vectors[[0, 0], :45], atol=1e-9)
    average = model["linearizer"].transform(model.inverse_transform([[0.0]])).to_numpy()[0]
    assert_allclose(average, model["linearizer"].transform(walkers.data).mean(), atol=1e-9)
    options = settings_of(model) | {"linearizer": model["linearizer"]}
    expected = cross_val_predict(model, walkers.data, weight, cv=LeaveOneOut())
    assert_allclose(loo_predict(walkers.data, weight, **options), expected, rtol=0, atol=1e-10)


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ({"structure": 0, "dynamics": 0}, "leave no feature in"),
        ({"hat": 1, "head": -1}, "'hat' fits no feature; 'head' has the weight -1; expected .* any of structure, mean"),
        ([1.0, 2.0], "must be 226 numbers of 0 or more"),
    ],
)
def test_wrong_weights_are_refused(weights, message):
    walkers = make_walkers(12, random_state=0)
    with pytest.raises(ValueError, match=message):
        make_eigenwalkers(n_components=3, weights=weights).fit(walkers.data, walkers.target["weight"])


def test_weights_by_name_need_names(people):
    with pytest.raises(ValueError, match=r"set_output\(transform='pandas'\)"):
        BlockScaler(weights={"structure": 0}).fit(people[0])
