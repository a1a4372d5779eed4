import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import solveh_banded

from eigenwalker.hsmm.banded import count_negative, factorize, multiply_banded, solve_banded, solve_factorized


def _dense(bands, step):
    """Return the matrices, shape (n_dims, n_rows, n_rows)."""
    n_rows, n_bands, n_dims = bands.shape
    matrices = np.zeros((n_dims, n_rows, n_rows))
    for band in range(n_bands):
        for row in range(band * step, n_rows):
            matrices[:, row, row - band * step] = matrices[:, row - band * step, row] = bands[row, band]
    return matrices


def _random_bands(seed, n_rows, n_bands, n_dims):
    """Return diagonally dominant bands, with anything left of the first column."""
    random = np.random.default_rng(seed)
    bands = random.uniform(-1, 1, (n_rows, n_bands, n_dims))
    bands[:, 0] = random.uniform(2 * n_bands, 3 * n_bands, (n_rows, n_dims))
    return bands


sizes = {
    "seed": st.integers(0, 2**32 - 1),
    "n_rows": st.integers(1, 40),
    "n_bands": st.integers(1, 6),
    "n_dims": st.integers(1, 20),
    "step": st.integers(1, 3),
}


@given(**sizes)
def test_solves_as_a_dense_solver_does(seed, n_rows, n_bands, n_dims, step):
    bands = _random_bands(seed, n_rows, n_bands, n_dims)
    right = np.random.default_rng(seed).normal(size=(n_rows, n_dims))
    expected = np.linalg.solve(_dense(bands, step), right.T[..., np.newaxis])[..., 0].T
    assert np.allclose(solve_banded(bands, right, step=step), expected, rtol=0, atol=1e-10)


@given(**sizes)
def test_multiplying_undoes_solving(seed, n_rows, n_bands, n_dims, step):
    bands = _random_bands(seed, n_rows, n_bands, n_dims)
    right = np.random.default_rng(seed).normal(size=(n_rows, n_dims))
    solution = solve_banded(bands, right, step=step)
    assert np.allclose(multiply_banded(bands, solution, step=step), right, rtol=0, atol=1e-12)


@given(**sizes)
def test_factors_are_those_of_the_shifted_matrix(seed, n_rows, n_bands, n_dims, step):
    bands = _random_bands(seed, n_rows, n_bands, n_dims)
    shift = np.random.default_rng(seed).uniform(0, 5, n_dims)
    factors = factorize(bands, step=step, shift=shift)
    unit = factors.copy()
    unit[:, 0] = 1.0
    lower = np.tril(_dense(unit, step))
    product = lower / factors[:, 0].T[:, np.newaxis] @ lower.swapaxes(1, 2)
    assert np.allclose(product, _dense(bands, step) + shift[:, None, None] * np.eye(n_rows), rtol=0, atol=1e-12)


def test_agrees_with_scipy():
    bands = _random_bands(0, 600, 5, 3)
    right = np.random.default_rng(0).normal(size=(600, 3))
    solution = solve_banded(bands, right)
    for dim in range(3):
        lower = np.array([np.roll(bands[:, band, dim], -band) for band in range(5)])  # [k, j] is A[j + k, j]
        expected = solveh_banded(lower, right[:, dim], lower=True)
        assert np.allclose(solution[:, dim], expected, rtol=0, atol=1e-12)


def test_counts_negative_eigenvalues():
    """As the eigenvalues themselves say; shifted so that some of them are on each side."""
    bands = _random_bands(1, 30, 3, 8)
    shift = -np.linspace(5, 10, 8)
    factors = factorize(bands, shift=shift)
    eigenvalues = np.linalg.eigvalsh(_dense(bands, 1)) + shift[:, np.newaxis]
    expected = (eigenvalues < 0).sum(axis=1)
    assert 0 < expected.sum() < expected.size * 30
    assert np.array_equal(count_negative(factors), expected)


def test_input_stays_as_it_is():
    bands, right = _random_bands(0, 10, 3, 4), np.ones((10, 4))
    before = bands.copy()
    solve_factorized(factorize(bands, shift=np.ones(4)), right)
    assert np.array_equal(bands, before)
    assert (right == 1).all()


def test_refuses_what_is_not_definite():
    bands = np.ones((4, 2, 3))
    bands[:, 0, :2] = 5.0
    with pytest.raises(ValueError, match=r"positive definite matrices, got others in dimensions \[2\]"):
        solve_banded(bands, np.ones((4, 3)))
