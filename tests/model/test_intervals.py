"""Confidence intervals of scores: published figures, coverage, and the edges."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import norm
from sklearn.metrics import roc_auc_score

from eigenwalker.model import score_interval

SCORES = ("accuracy", "balanced_accuracy", "auc", "r")
Z = norm.ppf(0.975)


def with_accuracy(right, total):
    """Return predictions of `total` persons, half of either group, of whom `right` are right."""
    labels = np.where(np.arange(total) % 2, 1.0, -1.0)
    return np.where(np.arange(total) < right, labels, -labels), labels


def with_correlation(r, n_persons):
    """Return predictions and labels that correlate by r."""
    columns = np.column_stack((np.ones(n_persons), np.random.default_rng(0).normal(size=(n_persons, 2))))
    labels, other = np.linalg.qr(columns)[0][:, 1:].T
    return r * labels + np.sqrt(1 - r**2) * other, labels


@pytest.mark.parametrize(
    ("right", "total", "low", "high"),
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_accuracy_as_newcombe_has_it(right, total, low, high):
    """Newcombe 1998, Two-sided confidence intervals for the single proportion, table I, method 3."""
    assert_allclose(score_interval(*with_accuracy(right, total), "accuracy"), (low, high), atol=5e-5)


def test_balanced_accuracy_as_newcombe_has_it():
    """Newcombe 1998, Interval estimation for the difference, table II (a), method 10: 56/70 - 48/80.

    With shares p and 1 - q right the balanced accuracy is (1 + p - q) / 2.
    """
    labels = np.repeat([1.0, -1.0], [70, 80])
    predicted = np.repeat([1.0, -1.0, 1.0, -1.0], [56, 14, 48, 32])
    low, high = score_interval(predicted, labels, "balanced_accuracy")
    assert_allclose((2 * low - 1, 2 * high - 1), (0.0524, 0.3339), atol=1e-4)


def test_correlation_by_hand():
    """Fisher: artanh 0.6 = ln 2, and 28 persons have a standard error of 1 / 5."""
    ratios = 4 * np.exp(np.array([-2, 2]) * Z / 5)
    expected = (ratios - 1) / (ratios + 1)
    assert_allclose(score_interval(*with_correlation(0.6, 28), "r"), expected, atol=1e-12)
    assert_allclose(expected, (0.2924, 0.7951), atol=5e-5)


@pytest.mark.parametrize("n_negative", [4, 13, 30])
def test_area_is_as_many_standard_errors_from_both_ends(n_negative):
    """Hanley and McNeil 1982, with (m + n) / 2 - 1 persons in both places (Newcombe 2006, method 5)."""
    labels = np.repeat([-1.0, 1.0], [n_negative, 9])
    predicted = np.random.default_rng(n_negative).normal(size=len(labels)) + labels / 2
    area = roc_auc_score(labels, predicted)
    low, high = score_interval(predicted, labels, "auc")
    assert 0 < low < area < high < 1
    for end in (low, high):
        q1, q2, others = end / (2 - end), 2 * end**2 / (1 + end), (n_negative + 9) / 2 - 1
        error = np.sqrt((end * (1 - end) + others * (q1 - end**2) + others * (q2 - end**2)) / (n_negative * 9))
        assert_allclose(abs(area - end) / error, Z, rtol=1e-6)


@pytest.mark.parametrize("score", SCORES)
def test_the_truth_is_within_most_of_the_time(score):
    """Of 200 intervals of 95 % about 190 hold the truth; fewer than 180 would be no chance (p < 0.002)."""
    random = np.random.default_rng(1)
    labels = np.repeat([-1.0, 1.0], [25, 20])
    truth = {"accuracy": norm.cdf(1), "balanced_accuracy": norm.cdf(1), "auc": norm.cdf(2**0.5), "r": 0.6}[score]
    n_within = 0
    for _ in range(200):
        if score == "r":
            labels = random.normal(size=45)
            predicted = 0.6 * labels + 0.8 * random.normal(size=45)
        else:
            predicted = labels + random.normal(size=45)
        low, high = score_interval(predicted, labels, score)
        n_within += low <= truth <= high
    assert 180 <= n_within <= 198


@pytest.mark.parametrize("score", SCORES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_perfect_scores_end_where_scores_end(score, sign):
    """A perfect score is no certainty."""
    labels = np.repeat([-1.0, 1.0], [10, 12])
    low, high = score_interval(sign * labels, labels, score)
    if score == "r":  # Fisher's transformation of 1 is infinite: there is no interval
        assert_allclose((low, high), (sign, sign), atol=1e-10)
    elif sign > 0:
        assert 0.5 < low < 0.95
        assert high == 1.0
    else:
        assert low == 0.0
        assert 0.05 < high < 0.5


@pytest.mark.parametrize("score", SCORES)
def test_more_persons_and_lower_levels_are_narrower(score):
    predicted, labels = with_accuracy(31, 40)
    if score == "r":
        predicted, labels = with_correlation(0.5, 40)
    value = score_interval(predicted, labels, score, level=1e-6)
    assert_allclose(value[0], value[1], atol=1e-5)
    widths = [np.ptp(score_interval(np.tile(predicted, n), np.tile(labels, n), score)) for n in (1, 2, 4, 8)]
    assert (np.diff(widths) < 0).all()
    assert_allclose(widths[3], widths[2] / np.sqrt(2), rtol=0.05)
    ends = np.array([score_interval(predicted, labels, score, level=level) for level in (0.5, 0.8, 0.95, 0.999)])
    assert (np.diff(ends[:, 0]) < 0).all()
    assert (np.diff(ends[:, 1]) > 0).all()


@pytest.mark.parametrize("score", ["accuracy", "balanced_accuracy", "auc"])
def test_both_groups_are_alike(score):
    """Renaming the groups changes nothing."""
    random = np.random.default_rng(2)
    labels = np.repeat([-1.0, 1.0], [12, 9])
    predicted = random.normal(size=21) + labels / 3
    assert_allclose(score_interval(-predicted, -labels, score), score_interval(predicted, labels, score))


def test_scores_that_are_not_defined_have_no_interval():
    ones, predicted = np.ones(6), np.arange(6.0)
    assert np.isnan(score_interval(predicted, ones, "auc")).all()
    assert np.isnan(score_interval(predicted, ones, "balanced_accuracy")).all()
    assert np.isfinite(score_interval(predicted, ones, "accuracy")).all()


def test_three_persons_leave_a_correlation_open():
    assert score_interval(np.arange(3.0), np.arange(3.0), "r") == (-1.0, 1.0)
    assert_allclose(score_interval(np.ones(12), np.arange(12.0), "r"), np.tanh([-Z / 3, Z / 3]))


def test_one_person_of_each_group():
    for score in ("accuracy", "balanced_accuracy", "auc"):
        low, high = score_interval(np.array([-1.0, 1.0]), np.array([-1.0, 1.0]), score)
        assert 0 < low < 0.5
        assert high == 1.0


@pytest.mark.parametrize(
    ("predicted", "labels", "options", "message"),
    [
        ([1.0, -1.0], [1.0, -1.0], {"score": "f1"}, "score must be one of 'accuracy', .*, got 'f1'"),
        ([1.0, -1.0], [1.0, -1.0], {"level": 95}, "level must be between 0 and 1, got 95"),
        ([1.0, -1.0], [1.0, -1.0], {"level": 0.0}, "level must be between 0 and 1, got 0"),
        ([1.0, -1.0], [1.0, -1.0, 1.0], {}, r"one prediction and one label a person, got \(2,\) and \(3,\)"),
        ([[1.0], [-1.0]], [[1.0], [-1.0]], {}, r"one prediction and one label a person, got \(2, 1\)"),
        ([], [], {}, "one prediction and one label a person"),
        ([1.0, -1.0], [1.0, np.nan], {}, "missing or infinite"),
        ([np.inf, -1.0], [1.0, 1.0], {"score": "r"}, "missing or infinite"),
        ([1.0, -1.0], [1.0, 0.0], {}, "score='auc' needs labels of -1 and \\+1, got others; use score='r'"),
    ],
)
def test_wrong_arguments_are_refused(predicted, labels, options, message):
    with pytest.raises(ValueError, match=message):
        score_interval(predicted, labels, **{"score": "auc"} | options)
