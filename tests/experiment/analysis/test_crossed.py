"""Answers that participants and walks make alike: laws of the interval, and how often it holds."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment import rate_difference, rate_interval
from eigenwalker.experiment.analysis.crossed import (
    crossed_difference,
    crossed_interval,
    crossed_mean,
    crossed_rate,
    groupings,
)
from eigenwalker.experiment.analysis.means import mean_interval


def asked(random, n_participants=20, n_walks=23, n_trials=20, *, spread=0.15):
    """Return whether answers are right, each participant's about some walks, and whose they are about which."""
    people, walks = random.normal(0, spread, n_participants), random.normal(0, spread, n_walks)
    rows = [(one, walk) for one in range(n_participants) for walk in random.choice(n_walks, n_trials, replace=False)]
    groups = pd.DataFrame(rows, columns=["participant", "walk"])
    chance = np.clip(0.5 + people[groups["participant"]] + walks[groups["walk"]], 0, 1)
    return random.random(len(groups)) < chance, groups


def width(found):
    return found.high - found.low


@pytest.fixture
def example():
    return asked(np.random.default_rng(0))


def test_without_groups_it_is_the_plain_interval(example):
    right, groups = example
    assert crossed_rate(right, groups[[]]) == rate_interval(right)
    assert crossed_mean(right, groups[[]], within=(-9, 9)) == mean_interval(right)
    half = len(right) // 2
    parts = right[:half], right[half:]
    assert crossed_difference(*parts, groups[[]][:half], groups[[]][half:]) == rate_difference(*parts)


def test_with_one_grouping_it_knows_that_one(example):
    right, groups = example
    assert_allclose(crossed_mean(right, groups[["walk"]], within=(-9, 9)), mean_interval(right, groups["walk"]))
    found = crossed_interval(lambda group: rate_interval(right, group), groups[["walk"]])
    assert_allclose(found, rate_interval(right, groups["walk"]))


def test_it_is_as_wide_as_the_wider_one_at_least(example):
    right, groups = example
    both = crossed_rate(right, groups)
    assert width(both) >= max(width(crossed_rate(right, groups[[name]])) for name in groups)


def test_the_order_of_groupings_and_of_answers_changes_nothing(example):
    right, groups = example
    order = np.random.default_rng(1).permutation(len(right))
    turned = crossed_rate(right[order], groups.iloc[order, ::-1])
    assert_allclose(turned, crossed_rate(right, groups), rtol=1e-12)


def test_a_grouping_of_single_answers_adds_nothing():
    right = np.arange(40) % 3 > 0
    groups = pd.DataFrame({"participant": range(40), "walk": np.arange(40) % 8})
    assert_allclose(crossed_rate(right, groups), crossed_rate(right, groups[["walk"]]), rtol=1e-12)


def test_few_groups_ask_for_student():
    """Of ten groups that are always or never right the interval is Wilson's with 2.26, t of 9 degrees, for 1.96."""
    right, groups = np.repeat(np.arange(10) < 6, 5), pd.DataFrame({"participant": np.repeat(np.arange(10), 5)})
    low, high = crossed_rate(right, groups)[1:]
    for end in (low, high):  # the ends are where |0.6 - p| = t sqrt(p (1 - p) / 10)
        assert_allclose(abs(0.6 - end), 2.262157 * np.sqrt(end * (1 - end) / 10), rtol=1e-5)


def test_two_participants_tell_next_to_nothing():
    found = crossed_rate([True] * 9 + [False] * 11, pd.DataFrame({"participant": np.arange(20) % 2}))
    assert width(found) > 0.7
    assert 0 <= found.low <= found.high <= 1


def test_coverage_of_rates_and_means():
    """Of 20 participants and 23 walks that differ: 95 % within 2.5 standard errors of 150 trials; plain ones do not."""
    random = np.random.default_rng(2)
    covered = {"rate": [], "mean": [], "plain": []}
    for _ in range(150):
        right, groups = asked(random)
        found = {
            "rate": crossed_rate(right, groups),
            "mean": crossed_mean(right, groups, within=(0, 1)),
            "plain": rate_interval(right),
        }
        for name, (_, low, high) in found.items():
            covered[name].append(low <= 0.5 <= high)
    assert 0.905 <= np.mean(covered["rate"]) <= 0.995
    assert 0.905 <= np.mean(covered["mean"]) <= 0.995
    assert np.mean(covered["plain"]) < 0.8


def test_pairs_of_walks_and_the_same_participants_make_differences_narrower():
    random = np.random.default_rng(3)
    right, groups = asked(random, spread=0.25)
    again = right ^ (random.random(len(right)) < 0.1)
    paired = crossed_difference(right, again, groups, groups)
    strangers = crossed_difference(right, again, groups, groups + 1000)
    assert paired.value == strangers.value
    assert width(paired) < 0.6 * width(strangers)


def test_exchanging_both_series_turns_the_sign(example):
    right, groups = example
    parts, halves = (right[:200], right[200:]), (groups[:200], groups[200:])
    forth, back = crossed_difference(*parts, *halves), crossed_difference(*parts[::-1], *halves[::-1])
    assert_allclose((-back.value, -back.high, -back.low), forth, atol=1e-12)


def test_means_end_where_scores_do():
    groups = pd.DataFrame({"participant": [1, 1, 1], "walk": ["a", "b", "c"]})
    assert crossed_mean([4, 3, 4], groups, within=(0, 4))[1:] == (0, 4)  # one participant leaves all open


def test_groupings_are_those_that_trials_have():
    trials = pd.DataFrame({"answer": ["real"], "walk": ["a"], "participant": [1], "view": [0.0]})
    assert groupings(trials).columns.tolist() == ["participant", "walk"]
    assert groupings(trials[["answer"]]).shape == (1, 0)


def test_three_groupings_are_too_many(example):
    right, groups = example
    with pytest.raises(ValueError, match="two groupings at most, got participant, walk, style"):
        crossed_rate(right, groups.assign(style="sad"))
