"""Shares and their differences: published figures, laws of groups, and the edges."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment import rate_difference, rate_interval


def answers(right, total):
    """Return so many answers, of which so many are right."""
    return np.arange(total) < right


@pytest.mark.parametrize(
    ("right", "total", "low", "high"),
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_shares_as_newcombe_has_them(right, total, low, high):
    """Newcombe 1998, Two-sided confidence intervals for the single proportion, table I, method 3."""
    assert_allclose(rate_interval(answers(right, total)), (right / total, low, high), atol=5e-5)


@pytest.mark.parametrize(
    ("one", "two", "low", "high"),
    [((56, 70), (48, 80), 0.0524, 0.3339), ((9, 10), (3, 10), 0.1705, 0.8090), ((10, 10), (0, 10), 0.6075, 1.0)],
)
def test_differences_as_newcombe_has_them(one, two, low, high):
    """Newcombe 1998, Interval estimation for the difference, table II, method 10."""
    found = rate_difference(answers(*two), answers(*one))
    assert_allclose(found, (one[0] / one[1] - two[0] / two[1], low, high), atol=5e-5)


def test_groups_of_one_change_nothing():
    right = answers(13, 30)
    assert rate_interval(right, np.arange(30)) == rate_interval(right)


def test_the_order_of_trials_and_the_names_of_groups_change_nothing():
    random = np.random.default_rng(0)
    right, groups = random.random(60) < 0.6, random.integers(8, size=60)
    order = random.permutation(60)
    named = np.array([f"walk {group}" for group in groups])
    assert_allclose(rate_interval(right[order], named[order]), rate_interval(right, groups), rtol=1e-12)


def test_answers_that_are_the_same_within_groups_count_once():
    """Asked ten times, ten walks that are always or never recognized say what ten answers say; G / (G - 1) apart."""
    once = answers(6, 10)
    repeated, groups = np.repeat(once, 10), np.repeat(np.arange(10), 10)
    assert_allclose(rate_interval(repeated, groups), rate_interval(once), rtol=1e-12)


def test_answers_that_are_independent_within_groups_count_each():
    random = np.random.default_rng(1)
    groups = np.repeat(np.arange(200), 10)
    right = random.random(2000) < 0.5
    alone, grouped = rate_interval(right), rate_interval(right, groups)
    assert_allclose(grouped.high - grouped.low, alone.high - alone.low, rtol=0.15)


def test_coverage_where_answers_are_alike():
    """Of 30 groups with 8 answers, of shares between 0.2 and 0.8: 95 % within 2.5 standard errors of 400 trials."""
    random = np.random.default_rng(2)
    groups, covered, naive = np.repeat(np.arange(30), 8), [], []
    for _ in range(400):
        right = random.random(240) < np.repeat(random.uniform(0.2, 0.8, 30), 8)
        for kept, found in ((covered, rate_interval(right, groups)), (naive, rate_interval(right))):
            kept.append(found.low <= 0.5 <= found.high)
    assert 0.92 <= np.mean(covered) <= 0.98
    assert np.mean(naive) < 0.92


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_certainty_is_no_certainty(share):
    right, groups = np.full(40, share == 1), np.repeat(np.arange(4), 10)
    found = rate_interval(right, groups)
    assert found == rate_interval(right[:4])
    assert found.high - found.low > 0.4


def test_pairs_that_agree_have_the_narrower_difference():
    groups = np.repeat(np.arange(20), 5)
    hard = np.repeat(answers(10, 20), 5)
    alike = rate_difference(hard, hard, groups, groups)
    apart = rate_difference(hard, hard, groups, groups + 20)
    assert alike.value == apart.value == 0.0
    assert alike.high - alike.low < 0.1 * (apart.high - apart.low)


def test_exchanging_both_series_turns_the_sign():
    random = np.random.default_rng(3)
    one, two, groups = random.random(50) < 0.7, random.random(50) < 0.4, np.repeat(np.arange(10), 5)
    forth, back = rate_difference(one, two, groups, groups), rate_difference(two, one, groups, groups)
    assert_allclose((-back.value, -back.high, -back.low), forth, atol=1e-12)


def test_no_trials():
    assert np.isnan(rate_interval([])).all()
    assert np.isnan(rate_difference([], [True])).all()


def test_errors():
    with pytest.raises(ValueError, match="one group a trial"):
        rate_interval([True, False], [1])
    with pytest.raises(ValueError, match="level must be between 0 and 1, got 95"):
        rate_interval([True], level=95)
    with pytest.raises(ValueError, match="both series or of none"):
        rate_difference([True], [True], [0])
