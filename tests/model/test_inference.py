"""Leave-one-out with everything refitted, and permutation tests."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.decomposition import PCA
from sklearn.linear_model import LinearRegression
from sklearn.metrics import roc_auc_score
from sklearn.model_selection import LeaveOneGroupOut, LeaveOneOut, cross_val_predict
from sklearn.pipeline import Pipeline, make_pipeline

from eigenwalker.model import BlockScaler, loo_matrix, permutation_test


@pytest.mark.parametrize("shape", [(14, 40), (40, 12)])
def test_equals_cross_val_predict(shape):
    rng = np.random.default_rng(0)
    vectors, labels = rng.normal(size=shape) * np.arange(1, shape[1] + 1), rng.normal(size=(shape[0], 3))
    reduction = make_pipeline(BlockScaler(), PCA(5))
    expected = cross_val_predict(make_pipeline(reduction, LinearRegression()), vectors, labels, cv=LeaveOneOut())
    assert_allclose(loo_matrix(vectors, reduction) @ labels, expected, atol=1e-10)


def test_no_difference_gives_a_large_p_and_a_clear_one_a_small_p():
    rng = np.random.default_rng(1)
    codes = np.repeat([-1.0, 1.0], 15)
    vectors = rng.normal(size=(30, 8))
    nothing = permutation_test(loo_matrix(vectors, PCA(3)), codes, n_permutations=500, random_state=0)
    vectors[:, 0] += 6 * codes
    clear = permutation_test(loo_matrix(vectors, PCA(3)), codes, n_permutations=500, random_state=0)
    assert nothing.p_value > 0.05
    assert clear.score == 1.0
    assert_allclose(clear.p_value, 1 / 501)
    assert nothing.null.shape == (500,)


def test_persons_are_left_out_with_all_their_walks():
    rng = np.random.default_rng(2)
    persons = np.repeat(np.arange(12), 3)
    vectors = rng.normal(size=(12, 8))[persons] + 0.3 * rng.normal(size=(36, 8)) * np.arange(1, 9)
    labels = rng.normal(size=12)[persons]
    reduction = Pipeline([("scaler", BlockScaler(unit="noise")), ("eigenwalkers", PCA(4))])
    expected = cross_val_predict(
        Pipeline([*reduction.steps, ("line", LinearRegression())]),
        vectors,
        labels,
        groups=persons,
        cv=LeaveOneGroupOut(),
        params={"scaler__groups": persons},
    )
    assert_allclose(loo_matrix(vectors, reduction, persons) @ labels, expected, atol=1e-10)


def test_the_area_under_the_curve_is_that_of_scikit_learn():
    rng = np.random.default_rng(3)
    persons = np.repeat(np.arange(20), 2)
    codes = np.where(np.arange(20) < 6, 1.0, -1.0)
    matrix = rng.normal(size=(40, 40))
    result = permutation_test(matrix, codes[persons], persons, score="auc", n_permutations=200, random_state=0)
    means = (matrix @ codes[persons]).reshape(20, 2).mean(axis=1)
    assert_allclose(result.score, roc_auc_score(codes, means))
    assert result.null.shape == (200,)


def test_a_person_has_one_label():
    with pytest.raises(ValueError, match="same for all walks of a person"):
        permutation_test(np.zeros((2, 2)), [-1, 1], ["anna", "anna"])


def test_codes_are_checked():
    with pytest.raises(ValueError, match=r"codes must be -1 and \+1"):
        permutation_test(np.zeros((3, 3)), [0, 1, 1])
