"""Leave-one-out with everything refitted, and permutation tests."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.decomposition import PCA
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import LeaveOneOut, cross_val_predict
from sklearn.pipeline import make_pipeline

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
    assert clear.accuracy == 1.0
    assert_allclose(clear.p_value, 1 / 501)
    assert nothing.null.shape == (500,)


def test_codes_are_checked():
    with pytest.raises(ValueError, match=r"codes must be -1 and \+1"):
        permutation_test(np.zeros((3, 3)), [0, 1, 1])
