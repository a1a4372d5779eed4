"""Leave-one-out without refits equals leave-one-out with them."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from sklearn.decomposition import PCA
from sklearn.model_selection import LeaveOneGroupOut, LeaveOneOut, cross_val_predict
from sklearn.pipeline import Pipeline, make_pipeline

from eigenwalker.datasets import make_walkers
from eigenwalker.model import (
    BlockScaler,
    FourierLinearizer,
    TraitRegressor,
    loo_matrix,
    loo_predict,
    make_eigenwalkers,
    nested_loo,
    settings_of,
)


def cross_validate(vectors, labels, n_components, scaling, groups=None, n_scalars=1):
    """Return what scikit-learn predicts with the Pipeline, fitted anew in every fold."""
    steps = [] if scaling is None else [("scaler", BlockScaler(n_scalars, unit=scaling))]
    steps += [("eigenwalkers", PCA(n_components, svd_solver="full")), ("trait", TraitRegressor())]
    folds = LeaveOneOut() if groups is None else LeaveOneGroupOut()
    options = {"scaler__groups": groups} if scaling == "noise" else {}
    return cross_val_predict(Pipeline(steps), vectors, labels, groups=groups, cv=folds, params=options)


def brute_force(vectors, labels, numbers, scaling, groups=None, n_scalars=1):
    """Return the same for several numbers of components, in a tenth of the time: one SVD a fold, and no Pipeline."""
    groups = np.arange(len(vectors)) if groups is None else groups
    columns = labels if labels.ndim == 2 else labels[:, np.newaxis]
    predicted = np.empty((len(numbers), *columns.shape))
    for group in np.unique(groups):
        others, left_out = groups != group, groups == group
        scale = np.ones(vectors.shape[1])
        if scaling is not None:
            scale = BlockScaler(n_scalars, unit=scaling).fit(vectors[others], groups=groups[others]).scale_
        center = vectors[others].mean(axis=0)
        directions = np.linalg.svd((vectors[others] - center) / scale, full_matrices=False)[2]
        design = np.column_stack((np.ones(len(vectors)), (vectors - center) / scale @ directions.T))
        for position, number in enumerate(numbers):
            part = design[:, : 1 + number]
            for trait, column in enumerate(columns.T):
                known = others & ~np.isnan(column)
                solution = np.linalg.lstsq(part[known], column[known])[0]
                predicted[position, left_out, trait] = part[left_out] @ solution
    return predicted.reshape(len(numbers), *labels.shape)


@pytest.mark.parametrize("scaling", [None, "blocks", "features", "noise"])
def test_equals_cross_val_predict(scaling):
    random = np.random.default_rng(0)
    vectors, persons = random.normal(size=(16, 6)), np.repeat(np.arange(8), 2)
    labels = random.normal(size=(16, 3))
    labels[random.random(labels.shape) < [0.0, 0.2, 0.4]] = np.nan
    for groups in (None, persons) if scaling != "noise" else (persons,):
        expected = cross_validate(vectors, labels, 3, scaling, groups)
        predicted = loo_predict(vectors, labels, n_components=3, scaling=scaling, groups=groups)
        assert_allclose(predicted, expected, rtol=0, atol=1e-10)
        assert_allclose(brute_force(vectors, labels, [3], scaling, groups)[0], expected, rtol=0, atol=1e-10)


def make_vectors(kind, random):
    """Return vectors whose folds are difficult in one way each."""
    if kind == "fewer walks than features":
        return random.normal(size=(14, 40)) * np.geomspace(1, 0.05, 40)
    if kind == "more walks than features":
        return random.normal(size=(30, 10)) * np.geomspace(1, 0.05, 10)
    if kind == "as many walks as features":
        return random.normal(size=(15, 15))
    vectors = random.normal(size=(20, 8))
    if kind == "constant features":
        vectors[:, [2, 7]] = 3.0
    elif kind == "a walker alone in a feature":
        vectors[:, 3] = 0.0
        vectors[4, 3] = 7.0
    elif kind == "a walker alone in a single feature":
        vectors[:, 7] = 0.0
        vectors[4, 7] = 7.0
    elif kind == "walks that repeat":
        vectors[14:] = vectors[:6]
    elif kind == "steep":
        vectors *= np.geomspace(1, 1e-5, 8)
    return vectors


KINDS = [
    "fewer walks than features",
    "more walks than features",
    "as many walks as features",
    "constant features",
    "a walker alone in a feature",
    "a walker alone in a single feature",
    "walks that repeat",
    "steep",
]


@pytest.mark.parametrize("scaling", [None, "blocks", "features", "noise"])
@pytest.mark.parametrize("kind", KINDS)
def test_equals_refits_with_every_number_of_components(kind, scaling):
    random = np.random.default_rng(0)
    vectors = make_vectors(kind, random)
    n_walks, n_features = vectors.shape
    labels = random.normal(size=(n_walks, 2))
    persons = random.permutation(np.arange(n_walks) * 2 // 3)  # one walk of some, two of others
    for groups in (None, persons) if scaling != "noise" else (persons,):
        numbers = range(1, min(n_walks - (1 if groups is None else 2), n_features) + 1)
        expected = brute_force(vectors, labels, numbers, scaling, groups)
        together = loo_predict(vectors, labels, n_components=numbers, scaling=scaling, groups=groups)
        alone = [loo_predict(vectors, labels, n_components=n, scaling=scaling, groups=groups) for n in numbers]
        matrices = loo_matrix(vectors, n_components=numbers, scaling=scaling, groups=groups)
        for ours in (together, alone, matrices @ labels):
            assert_allclose(ours, expected, rtol=0, atol=1e-10)


@pytest.mark.parametrize("scaling", [None, "blocks", "features"])
@pytest.mark.parametrize("kind", ["fewer walks than features", "more walks than features", "constant features"])
def test_a_missing_label_leaves_its_walk_out_of_that_trait_alone(kind, scaling):
    random = np.random.default_rng(1)
    vectors = make_vectors(kind, random)
    labels = random.normal(size=(len(vectors), 3))
    labels[random.random(labels.shape) < [0.0, 0.2, 0.4]] = np.nan
    expected = brute_force(vectors, labels, [1, 3, 5], scaling)
    predicted = loo_predict(vectors, labels, n_components=[1, 3, 5], scaling=scaling)
    assert_allclose(predicted, expected, rtol=0, atol=1e-10)


@pytest.mark.parametrize("scaling", [None, "blocks"])
def test_repeated_eigenvalues(scaling):
    """Walkers on the axes of a cross: one variance is there twice, one four times."""
    corners = np.vstack((np.eye(6), -np.eye(6), np.eye(6)[:2], -np.eye(6)[:2]))
    labels = np.random.default_rng(2).normal(size=len(corners))
    predicted = loo_predict(corners, labels, n_components=range(1, 7), scaling=scaling)
    assert_allclose(predicted, brute_force(corners, labels, range(1, 7), scaling), rtol=0, atol=1e-10)


def test_every_number_up_to_the_rank_is_the_default_of_none():
    random = np.random.default_rng(3)
    labels = random.normal(size=12)
    few, many = random.normal(size=(12, 30)), random.normal(size=(12, 4))
    assert loo_predict(few, labels, n_components=None).shape == (10, 12)  # eleven others have rank ten
    assert loo_predict(many, labels, n_components=None).shape == (4, 12)
    predicted = loo_predict(few, labels, n_components=None, scaling="blocks")
    assert_allclose(predicted, brute_force(few, labels, range(1, 11), "blocks"), rtol=0, atol=1e-10)


def test_several_single_features_are_scaled_one_by_one():
    random = np.random.default_rng(4)
    vectors = random.normal(size=(16, 9)) * np.geomspace(1, 100, 9)
    labels = random.normal(size=16)
    for n_scalars in (0, 2, 3):
        predicted = loo_predict(vectors, labels, n_components=3, scaling="blocks", n_scalars=n_scalars)
        expected = brute_force(vectors, labels, [3], "blocks", n_scalars=n_scalars)[0]
        assert_allclose(predicted, expected, rtol=0, atol=1e-10)


def test_persons_with_many_walks_are_left_out_too():
    random = np.random.default_rng(5)
    persons = np.repeat(np.arange(5), [1, 4, 7, 8, 12])  # below, at and beyond the number of changes that are followed
    vectors, labels = random.normal(size=(32, 6)), random.normal(size=32)
    for scaling in (None, "blocks"):
        predicted = loo_predict(vectors, labels, n_components=4, scaling=scaling, groups=persons)
        assert_allclose(predicted, brute_force(vectors, labels, [4], scaling, persons)[0], rtol=0, atol=1e-10)


def test_words_are_coded_as_the_regressor_does():
    random = np.random.default_rng(6)
    vectors = random.normal(size=(20, 5))
    words = pd.DataFrame({"mood": np.where(vectors[:, 0] > 0, "sad", "happy"), "age": vectors[:, 1] + 30})
    predicted = loo_predict(vectors, words, n_components=3)
    assert_allclose(predicted, cross_validate(vectors, words, 3, None), rtol=0, atol=1e-10)


def test_walks_are_linearized_once():
    walkers = make_walkers(8, duration=4, frame_rate=60, random_state=0)
    weight = walkers.target["weight"]
    model = make_eigenwalkers(n_components=2, extras=("speed",))
    expected = cross_val_predict(model, walkers.data, weight, cv=LeaveOneOut())
    linearizer = FourierLinearizer(extras=("speed",))
    predicted = loo_predict(walkers.data, weight, n_components=2, scaling="blocks", linearizer=linearizer)
    assert_allclose(predicted, expected, rtol=1e-10)
    assert not hasattr(linearizer, "template_")
    with pytest.raises(TypeError, match="pass linearizer"):
        loo_predict(walkers.data, weight)


def test_the_matrix_takes_the_steps_of_a_model():
    random = np.random.default_rng(7)
    vectors = random.normal(size=(12, 6))
    persons = np.arange(12) // 2
    model = make_eigenwalkers(n_components=3, scaling="noise")
    expected = loo_matrix(vectors, groups=persons, n_components=3, scaling="noise")
    assert_allclose(loo_matrix(vectors, groups=persons, **settings_of(model)), expected)
    assert (expected[persons[:, np.newaxis] == persons] == 0).all()
    assert_allclose(expected.sum(axis=1), 1)  # equal labels are predicted as they are
    with pytest.raises(ValueError, match=r"a BlockScaler .* and a PCA before the trait, got PCA.*PCA"):
        settings_of(make_pipeline(FourierLinearizer(), PCA(3), PCA(2), TraitRegressor()))
    with pytest.raises(ValueError, match="PCA's n_components must be a whole number"):
        settings_of(make_eigenwalkers(n_components=0.9))


def test_arguments_are_checked():
    vectors = np.random.default_rng(8).normal(size=(6, 4))
    labels = np.arange(6.0)
    with pytest.raises(ValueError, match="between 1 and 4, which is what 0 controls, 5 walks"):
        loo_predict(vectors, labels, n_components=5)
    with pytest.raises(ValueError, match="whole number"):
        loo_predict(vectors, labels, n_components=1.5)
    with pytest.raises(ValueError, match="at least 3 persons, got 2"):
        loo_predict(vectors, labels, n_components=1, groups=[0, 0, 0, 1, 1, 1])
    with pytest.raises(ValueError, match="one label a walk, 6, got 5"):
        loo_predict(vectors, labels[:5], n_components=1)
    with pytest.raises(ValueError, match="scaling must be one of"):
        loo_predict(vectors, labels, n_components=1, scaling="units")
    with pytest.raises(ValueError, match="n_scalars=4"):
        loo_predict(vectors, labels, n_components=1, scaling="blocks", n_scalars=4)
    with pytest.raises(ValueError, match="label for at least one walk"):
        loo_predict(vectors, [1.0, *[np.nan] * 5], n_components=1)
    with pytest.raises(ValueError, match="contains NaN"):
        loo_predict(np.full((6, 4), np.nan), labels, n_components=1)


@pytest.mark.parametrize("two_valued", [True, False])
def test_nested_chooses_as_loops_do(two_valued):
    random = np.random.default_rng(9)
    persons = np.repeat(np.arange(12), 1 + np.arange(12) % 2)
    labels = random.normal(size=12)[persons]
    vectors = random.normal(size=(18, 7)) + labels[:, np.newaxis] * [0, 1, 0, 0, 1, 0, 0]
    if two_valued:
        labels = np.sign(labels)
    numbers = [1, 2, 4, 6]
    result = nested_loo(vectors, labels, n_components=numbers, scaling="blocks", groups=persons)

    def goodness(predicted, truth, groups):
        each = (predicted * truth > 0) if two_valued else -((predicted - truth) ** 2)
        return pd.Series(each * 1.0).groupby(groups).mean().mean()

    outer = brute_force(vectors, labels, numbers, "blocks", persons)
    for person in range(12):
        others = persons != person
        part = labels[others], persons[others]
        predicted = brute_force(vectors[others], part[0], numbers, "blocks", part[1])
        inner = np.array([goodness(one, *part) for one in predicted])
        chosen = int(np.flatnonzero(inner >= inner.max() - 1e-9)[0])
        assert (result.n_components[~others] == numbers[chosen]).all()
        assert_allclose(result.predictions[~others], outer[chosen, ~others], atol=1e-10)
    sign = 1 if two_valued else -1
    assert_allclose(result.score, sign * goodness(result.predictions, labels, persons))
    assert_allclose(result.curve, [sign * goodness(one, labels, persons) for one in outer], atol=1e-10)


def test_nested_chooses_for_each_trait_from_its_labels():
    random = np.random.default_rng(10)
    vectors, labels = random.normal(size=(14, 5)), random.normal(size=(14, 2))
    labels[:3, 1] = np.nan
    both = nested_loo(vectors, labels)
    assert both.predictions.shape == both.n_components.shape == (14, 2)
    assert both.candidates.tolist() == [1, 2, 3, 4, 5]
    for trait in range(2):
        alone = nested_loo(vectors, labels[:, trait])
        assert_allclose(alone.predictions, both.predictions[:, trait], atol=1e-10)
        assert_allclose(alone.curve, both.curve[:, trait])
    with pytest.raises(ValueError, match="needs two groups, but 'trait_0', 'trait_1' has other numbers"):
        nested_loo(vectors, labels, criterion="accuracy")
    with pytest.raises(ValueError, match="at least 4 persons"):
        nested_loo(vectors[:3], labels[:3])
