"""Scaling before PCA."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.model import BlockScaler


@pytest.fixture
def vectors():
    rng = np.random.default_rng(0)
    return np.column_stack((rng.normal(size=(40, 6)) * [1, 2, 3, 4, 5, 6], 0.1 * rng.normal(size=(40, 2)) + 9))


def test_single_features_weigh_as_much_as_an_average_posture_feature(vectors):
    scaled = BlockScaler(2).fit_transform(vectors)
    assert_allclose(scaled[:, :6], vectors[:, :6])
    assert_allclose(scaled[:, 6:].std(axis=0), np.sqrt(np.mean(vectors[:, :6].std(axis=0) ** 2)))


def test_units_of_posture_change_nothing(vectors):
    """Metres or millimetres: the scaled data differ by one factor in all columns."""
    millimetres = vectors * ([1000.0] * 6 + [1.0] * 2)
    assert_allclose(BlockScaler(2).fit_transform(millimetres), 1000 * BlockScaler(2).fit_transform(vectors))


def test_features_have_unit_variance(vectors):
    assert_allclose(BlockScaler(2, unit="features").fit_transform(vectors).std(axis=0), 1)


def test_noise_is_the_spread_within_persons(vectors):
    persons = np.repeat(np.arange(10), 4)
    means = vectors.reshape(10, 4, 8).mean(axis=1)
    within = np.sqrt(((vectors - means[persons]) ** 2).sum(axis=0) / 30)
    scaler = BlockScaler(2, unit="noise").fit(vectors, groups=persons)
    assert_allclose(scaler.scale_, within)
    assert_allclose(scaler.inverse_transform(scaler.transform(vectors)), vectors)
    moved = vectors + 100 * np.arange(10)[persons, np.newaxis]
    assert_allclose(BlockScaler(2, unit="noise").fit(moved, groups=persons).scale_, within, rtol=1e-9)


@pytest.mark.parametrize("unit", ["blocks", "features"])
def test_constants_and_rounding_stay(vectors, unit):
    vectors[:, 2] = 1e-17 * np.arange(40)
    vectors[:, 7] = 1.0
    scaler = BlockScaler(2, unit=unit).fit(vectors)
    assert_allclose(scaler.scale_[[2, 7]], 1)
    assert_allclose(scaler.inverse_transform(scaler.transform(vectors)), vectors, rtol=1e-15)


def test_shares_add_up(vectors):
    scaler = BlockScaler(2).fit(vectors)
    assert_allclose(scaler.block_shares_, [6 / 8, 1 / 8, 1 / 8])


def test_wrong_use_is_refused(vectors):
    with pytest.raises(ValueError, match="at least the n_scalars=9 single features, got 8"):
        BlockScaler(9).fit(vectors)
    with pytest.raises(ValueError, match="unit must be one of 'blocks', 'features', 'noise', None"):
        BlockScaler(unit="metres").fit(vectors)
    with pytest.raises(ValueError, match="needs to know which person each walk is of; pass groups"):
        BlockScaler(unit="noise").fit(vectors)
    with pytest.raises(ValueError, match="persons with two walks or more, got 40 persons"):
        BlockScaler(unit="noise").fit(vectors, groups=np.arange(40))
    with pytest.raises(ValueError, match="expected 8 features, got 3"):
        BlockScaler().fit(vectors).inverse_transform(np.zeros((2, 3)))
