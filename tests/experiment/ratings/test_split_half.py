"""Split halves: all splits by hand, the correction for length, coverage, and the edges."""

from itertools import combinations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment.ratings.intraclass import intraclass_correlation
from eigenwalker.experiment.ratings.split_half import split_half_reliability


def simulated(n_walkers, n_observers, random):
    return random.normal(size=(n_walkers, 1)) + random.normal(size=(n_walkers, n_observers))


def correlations(ratings):
    """Return those of all splits, each of them taken twice if halves are of the same size."""
    everybody = set(range(ratings.shape[1]))
    for half in combinations(everybody, ratings.shape[1] // 2):
        others = list(everybody - set(half))
        yield np.corrcoef(ratings[:, list(half)].mean(axis=1), ratings[:, others].mean(axis=1))[0, 1]


def test_halves_of_the_same_size_by_hand():
    ratings = simulated(15, 6, np.random.default_rng(0))
    mean = np.mean(list(correlations(ratings)))
    assert_allclose(split_half_reliability(ratings).value, 2 * mean / (1 + mean), rtol=1e-12)


def test_halves_of_different_size_by_hand():
    """Of three observers, with r = 0.6: the reliability q of one obeys r^2 = 2 q^2 / (1 + q), and 3 q / (1 + 2 q)."""
    ratings = simulated(15, 3, np.random.default_rng(1))
    mean = np.mean(list(correlations(ratings)))
    single = (mean**2 + np.sqrt(mean**4 + 8 * mean**2)) / 4
    assert_allclose(split_half_reliability(ratings).value, 3 * single / (1 + 2 * single), rtol=1e-12)


@pytest.mark.parametrize("n_observers", [2, 3, 8, 9])
def test_with_many_walkers_it_is_the_reliability_of_the_mean(n_observers):
    """Of k observers with a single reliability of a half: k / (1 + k); and the third intraclass correlation."""
    ratings = simulated(20_000, n_observers, np.random.default_rng(2))
    found = split_half_reliability(ratings)
    assert_allclose(found.value, n_observers / (1 + n_observers), atol=0.02)
    assert_allclose(found, intraclass_correlation(ratings, kind="ICC(3,k)")[:3], atol=2e-3)


def test_harsh_observers_and_the_order_change_nothing():
    random = np.random.default_rng(3)
    ratings = simulated(20, 5, random)
    changed = (ratings + random.normal(size=5))[random.permutation(20)][:, random.permutation(5)]
    assert_allclose(split_half_reliability(changed), split_half_reliability(ratings), rtol=1e-10)


def test_random_splits_agree_with_all_and_are_repeatable():
    ratings = simulated(30, 14, np.random.default_rng(4))
    every = split_half_reliability(ratings, n_splits=1716)
    assert split_half_reliability(ratings, n_splits=1716, random_state=1) == every
    found = split_half_reliability(ratings, random_state=1)
    assert found == split_half_reliability(ratings, random_state=1)
    assert found != split_half_reliability(ratings, random_state=2)
    assert_allclose(found, every, atol=5e-3)


def test_intervals_hold_as_often_as_they_say():
    """400 studies with six buttons and observers of different precision; 95 % within 3 standard errors of 1.1 %."""
    random, noise = np.random.default_rng(5), np.array([0.4, 0.8, 1.2, 1.6])

    def study(n_walkers):
        walkers = random.normal(size=(n_walkers, 1))
        return np.clip(np.rint(3.5 + walkers + noise * random.normal(size=(n_walkers, 4))), 1, 6)

    truth = split_half_reliability(study(200_000)).value
    found = [split_half_reliability(study(20)) for _ in range(400)]
    assert 0.917 <= np.mean([one.low <= truth <= one.high for one in found]) <= 0.983


def test_two_observers_who_agree_or_are_opposites():
    up = np.arange(5.0)
    assert_allclose(split_half_reliability(np.column_stack([up, up + 3])), 1.0, atol=1e-12)
    assert split_half_reliability(np.column_stack([up, -up])).value < -1e6


def test_a_half_that_does_not_vary():
    up = np.arange(5.0)
    assert np.isnan(split_half_reliability(np.column_stack([up, np.full(5, 0.1), up[::-1] ** 2]))).all()


def test_errors():
    with pytest.raises(ValueError, match=r"got the shape \(2, 3\) and n_splits=1000"):
        split_half_reliability(np.ones((2, 3)))
    with pytest.raises(ValueError, match="n_splits=0"):
        split_half_reliability(np.ones((5, 3)), n_splits=0)
    with pytest.raises(ValueError, match=r"1 of 9 are missing; by observers, of so many walkers: 1 \(1\)"):
        split_half_reliability([[1, np.nan, 2], [1, 2, 3], [2, 2, 1]])
    with pytest.raises(ValueError, match="level must be"):
        split_half_reliability(np.ones((5, 3)), level=0)
