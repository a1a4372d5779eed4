"""Eigenvalues after a change of rank one equal those of a dense solver."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from eigenwalker.model._principal import principal_axes
from eigenwalker.model._secular import add_rank_one, subtract_rank_one

POLES = {
    "even": np.linspace(2.0, 0.1, 30),
    "steep": np.geomspace(1.0, 1e-8, 30),
    "repeated": np.repeat([3.0, 2.0, 1.0], [4, 5, 6]),
    "nearly repeated": np.array([1.0, 1 - 3e-16, 1 - 1e-12, 1 - 1e-9, 0.5, 0.5 - 1e-15, 0.1]),
    "with zeros": np.array([1.0, 0.5, 0.0, 0.0]),
    "one": np.array([2.0]),
}


def check(poles, vector, n_roots):
    changed = np.diag(poles) - np.outer(vector, vector)
    values, vectors = subtract_rank_one(poles, vector, n_roots)
    scale = max(np.abs(poles).max(), vector @ vector)
    assert_allclose(values, np.linalg.eigvalsh(changed)[::-1][:n_roots], rtol=0, atol=1e-13 * scale)
    assert_allclose(vectors @ vectors.T, np.eye(n_roots), rtol=0, atol=1e-12)
    assert_allclose(vectors @ changed, values[:, np.newaxis] * vectors, rtol=0, atol=1e-13 * scale)
    if n_roots == len(poles):
        values, vectors = add_rank_one(poles, vector)
        changed = np.diag(poles) + np.outer(vector, vector)
        assert_allclose(vectors @ vectors.T, np.eye(n_roots), rtol=0, atol=1e-12)
        assert_allclose(vectors @ changed, values[:, np.newaxis] * vectors, rtol=0, atol=1e-13 * scale)


@pytest.mark.parametrize("poles", POLES.values(), ids=POLES)
@pytest.mark.parametrize("size", ["usual", "tiny", "of all sizes", "with zeros", "all zero"])
def test_equals_a_dense_solver(poles, size):
    random = np.random.default_rng(0)
    vector = random.normal(size=len(poles)) * np.sqrt(poles / len(poles))
    if size == "tiny":
        vector *= 1e-9
    elif size == "of all sizes":
        vector *= 10.0 ** random.uniform(-20, 0, len(poles))
    elif size == "with zeros":
        vector[random.random(len(poles)) < 0.6] = 0.0
    elif size == "all zero":
        vector[:] = 0.0
    for n_roots in {1, (len(poles) + 1) // 2, len(poles)}:
        check(poles, vector, n_roots)


@given(st.lists(st.tuples(st.integers(0, 12), st.integers(-6, 6), st.integers(-14, 0)), min_size=1, max_size=9))
def test_ties_and_tiny_entries_in_any_order(entries):
    """Whole numbers tie often, and powers of ten are as small as rounding."""
    entries = sorted(entries, reverse=True)
    poles = np.array([float(pole) for pole, _, _ in entries])
    vector = np.array([factor * 10.0**exponent for _, factor, exponent in entries])
    for n_roots in range(1, len(poles) + 1):
        check(poles, vector, n_roots)


@pytest.mark.parametrize("shape", [(9, 30), (30, 9)])
@pytest.mark.parametrize("steepness", [0.1, 1e-9])
def test_principal_axes_equal_those_of_an_svd(shape, steepness):
    random = np.random.default_rng(1)
    vectors = random.normal(size=shape) * np.geomspace(1, steepness, shape[1])
    centered = vectors - vectors.mean(axis=0)
    _, lengths, directions = np.linalg.svd(centered, full_matrices=False)
    squares, axes = principal_axes(centered, 4)
    assert_allclose(np.sqrt(squares), lengths[:4], rtol=1e-10)
    assert_allclose(np.abs((axes * directions[:4]).sum(axis=1)), 1, rtol=1e-10)
