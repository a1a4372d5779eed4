"""Means of scores: Student's t, groups, and the edges."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import t

from eigenwalker.experiment.analysis.means import mean_interval


def test_single_scores_have_the_interval_of_student():
    scores = np.random.default_rng(0).normal(3, 1, 25)
    wanted = t.interval(0.9, 24, scores.mean(), scores.std(ddof=1) / 5)
    assert_allclose(mean_interval(scores, level=0.9), (scores.mean(), *wanted))


def test_groups_of_one_change_nothing():
    scores = np.random.default_rng(1).normal(size=12)
    assert_allclose(mean_interval(scores, np.arange(12)), mean_interval(scores), rtol=1e-12)


def test_scores_that_are_the_same_within_groups_count_once():
    once = np.random.default_rng(2).normal(size=10)
    assert_allclose(mean_interval(np.repeat(once, 7), np.repeat(np.arange(10), 7)), mean_interval(once), rtol=1e-12)


def test_order_and_names_of_groups_change_nothing():
    random = np.random.default_rng(3)
    scores, groups = random.normal(size=40), random.integers(6, size=40)
    order, named = random.permutation(40), np.array([f"person {group}" for group in groups])
    assert_allclose(mean_interval(scores[order], named[order]), mean_interval(scores, groups), rtol=1e-12)


def test_a_shift_and_a_scale_of_scores_are_those_of_the_interval():
    random = np.random.default_rng(4)
    scores, groups = random.normal(size=30), np.arange(30) // 3
    assert_allclose(mean_interval(2 * scores + 1, groups), 2 * np.array(mean_interval(scores, groups)) + 1)


def test_groups_that_are_too_much_alike_are_no_better_than_single_scores():
    """Persons with the same mean: V is that of single scores, but t has the degrees of freedom of persons."""
    scores, groups = np.tile([1.0, 3.0], 5), np.repeat(np.arange(5), 2)
    found = mean_interval(scores, groups)
    assert_allclose(found.high - found.value, t.ppf(0.975, 4) * scores.std(ddof=1) / np.sqrt(10))


def test_coverage_where_persons_differ():
    """Of 12 persons with 10 scores: 95 % within 2.5 standard errors of 400 trials."""
    random = np.random.default_rng(5)
    groups, covered = np.repeat(np.arange(12), 10), []
    for _ in range(400):
        found = mean_interval(random.normal(size=120) + np.repeat(random.normal(size=12), 10), groups)
        covered.append(found.low <= 0 <= found.high)
    assert 0.92 <= np.mean(covered) <= 0.98


def test_one_group_leaves_the_interval_open():
    assert mean_interval([2.0, 3.0], ["a", "a"]) == (2.5, -np.inf, np.inf)
    assert mean_interval([2.0]) == (2.0, -np.inf, np.inf)


def test_no_scores():
    assert np.isnan(mean_interval([])).all()


def test_errors():
    with pytest.raises(ValueError, match="one group a score"):
        mean_interval([1.0, 2.0], [1])
    with pytest.raises(ValueError, match="2 missing or infinite"):
        mean_interval([1.0, np.nan, np.inf])
    with pytest.raises(ValueError, match="level must be between 0 and 1, got 95"):
        mean_interval([1.0], level=95)
