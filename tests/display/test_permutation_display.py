"""Permutation tests."""

import numpy as np
import pytest
from matplotlib.colors import to_hex
from numpy.testing import assert_allclose

from eigenwalker.display import PermutationDisplay
from eigenwalker.model import PermutationResult, permutation_test


def _counts(ax):
    """Return the numbers of shuffles in light bars and in dark bars."""
    light, dark = to_hex("0.75"), to_hex("0.25")
    bars = [(to_hex(bar.get_facecolor()), bar.get_height()) for bar in ax.patches]
    return [sum(height for color, height in bars if color == shade) for shade in (light, dark)]


def test_every_shuffle_is_counted_and_those_as_good_are_dark():
    null = np.random.default_rng(0).normal(size=500)
    result = PermutationResult(1.0, (1 + np.sum(null >= 1.0)) / 501, null)
    ax = PermutationDisplay.from_result(result, score_name="r").ax_
    assert _counts(ax) == [np.sum(null < 1.0), np.sum(null >= 1.0)]
    chance, given = (line.get_xdata()[0] for line in ax.lines)
    assert_allclose([chance, given], [null.mean(), 1.0])
    assert ax.get_xlabel() == "r"


def test_accuracies_have_a_bin_each():
    null = np.random.default_rng(0).integers(5, 16, size=300) / 20
    ax = PermutationDisplay.from_result(PermutationResult(0.7, 0.5, null)).ax_
    bars = [bar for bar in ax.patches if to_hex(bar.get_facecolor()) == to_hex("0.75")]
    centers = [bar.get_x() + bar.get_width() / 2 for bar in bars]
    assert_allclose(centers, np.arange(5, 16) / 20)
    counts = [np.sum(np.isclose(null, value)) if value < 0.69 else 0 for value in centers]
    assert_allclose([bar.get_height() for bar in bars], counts)


def test_ties_but_for_rounding_count_as_good():
    null = np.array([0.5, 0.6, 0.7 - 1e-15, 0.7])
    assert _counts(PermutationDisplay.from_result(PermutationResult(0.7, 0.6, null)).ax_) == [2, 2]


def test_equal_scores_are_one_bar():
    assert _counts(PermutationDisplay.from_result(PermutationResult(0.7, 0.1, np.full(9, 0.5))).ax_) == [9, 0]


@pytest.mark.parametrize(
    ("p_value", "n_permutations", "written"),
    [
        (0.0001, 9999, "p ≤ 1/10000"),
        (0.0002, 9999, "p = 0.0002"),
        (0.01, 99, "p ≤ 1/100"),
        (0.0312, 9999, "p = 0.031"),
        (1.0, 9, "p = 1"),
    ],
)
def test_p_is_written_as_in_papers(p_value, n_permutations, written):
    null = np.linspace(0, 1, n_permutations)
    title = PermutationDisplay.from_result(PermutationResult(0.5, p_value, null)).ax_.get_title(loc="left")
    assert title == f"accuracy 0.50, {written}, {n_permutations} shuffles"


def test_trait_picks_a_column():
    rng = np.random.default_rng(0)
    vectors, labels = rng.normal(size=(12, 6)), np.where(rng.normal(size=(12, 2)) > 0, 1, -1)
    result = permutation_test(vectors, labels, n_components=3, n_permutations=49, random_state=0)
    display = PermutationDisplay.from_result(result, trait=1)
    assert (display.score, display.p_value) == (result.score[1], result.p_value[1])
    assert_allclose(display.null, result.null[:, 1])


@pytest.mark.parametrize(
    ("n_traits", "trait", "message"),
    [
        (2, None, "the result has 2 traits; choose one, trait=0 to 1"),
        (2, 2, "trait must be a position from 0 to 1, got 2"),
        (1, -1, "trait must be a position from 0 to 0, got -1"),
    ],
)
def test_wrong_traits_are_refused(n_traits, trait, message):
    result = PermutationResult(np.full(n_traits, 0.5), np.full(n_traits, 0.5), np.full((9, n_traits), 0.5))
    with pytest.raises(ValueError, match=message):
        PermutationDisplay.from_result(result, trait=trait)


def test_a_result_without_a_score_is_refused():
    with pytest.raises(ValueError, match="expected a score to draw, got nan"):
        PermutationDisplay.from_result(PermutationResult(float("nan"), 0.1, np.full(9, np.nan)))
