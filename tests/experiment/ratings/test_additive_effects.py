"""Additive means: those of complete ratings, and the same ones with gaps where effects are additive."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.experiment.ratings.additive_effects import additive_means, linked_parts


@pytest.fixture
def additive():
    """Ratings that are exactly a walker's effect and a column's."""
    random = np.random.default_rng(0)
    return random.normal(size=(12, 1)) + random.normal(size=7)


def gappy(ratings, share, random_state=1):
    return np.where(np.random.default_rng(random_state).random(ratings.shape) < share, np.nan, ratings)


def test_without_gaps_they_are_the_means():
    ratings = np.random.default_rng(0).normal(size=(9, 4))
    assert_allclose(additive_means(ratings), ratings.mean(axis=1), atol=1e-12)


def test_gaps_change_nothing_where_effects_are_additive(additive):
    with_gaps = gappy(additive, 0.4)
    assert not linked_parts(with_gaps).any()
    assert_allclose(additive_means(with_gaps), additive.mean(axis=1), atol=1e-12)


def test_it_is_the_least_squares_fit():
    """The same as indicators of walkers and columns in a plain regression."""
    ratings = gappy(np.random.default_rng(2).normal(size=(10, 5)), 0.3)
    rows, columns = np.nonzero(~np.isnan(ratings))
    design = np.hstack([np.eye(10)[rows], np.eye(5)[columns]])
    effects = np.linalg.lstsq(design, ratings[rows, columns])[0]
    assert_allclose(additive_means(ratings), effects[:10] + effects[10:].mean(), atol=1e-12)


def test_the_order_of_walkers_and_columns_changes_nothing(additive):
    ratings = gappy(additive, 0.3) + np.random.default_rng(3).normal(size=additive.shape)
    rows, columns = np.random.default_rng(4).permutation(12), np.random.default_rng(5).permutation(7)
    assert_allclose(additive_means(ratings[rows][:, columns]), additive_means(ratings)[rows], atol=1e-12)


def test_parts_without_a_link():
    nan = np.nan
    assert_array_equal(linked_parts(np.array([[1, nan, nan], [1, nan, 2], [nan, 3, nan]])), [0, 0, 1])
    assert_array_equal(linked_parts(np.array([[1, nan], [1, 2], [nan, 3]])), [0, 0, 0])
