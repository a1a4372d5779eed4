"""Distributions of scores with their means."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.display import ScoreDisplay
from tests.display.answer_tables import scores


def test_bars_are_in_proportion_to_the_shares_and_say_them():
    shares, means = scores()
    ax = ScoreDisplay.from_frames(shares, means).ax_
    heights = np.array([[abs(bar.get_height()) for bar in bars] for bars in ax.containers])
    assert_allclose(heights / heights.max(), shares / shares.max(axis=None))
    assert heights.max() < 0.6  # of a row: it stays below the mean of the row above
    assert [text.get_text() for text in ax.texts] == [f"{100 * share:.0f}" for share in shares.to_numpy().ravel()]


def test_means_are_at_their_score():
    shares, means = scores()
    ax = ScoreDisplay.from_frames(shares, means[::-1], xlabel="score").ax_
    assert_allclose(ax.lines[0].get_xdata(), means["value"])
    assert [label.get_text() for label in ax.get_xticklabels()] == ["0", "1", "2", "3", "4"]
    assert [label.get_text() for label in ax.get_yticklabels()] == list(shares.index)


def test_errors():
    shares, means = scores()
    with pytest.raises(ValueError, match="a mean of each row of shares, missing: cool"):
        ScoreDisplay.from_frames(shares, means.drop(index="cool"))
    with pytest.raises(ValueError, match="missing: value"):
        ScoreDisplay.from_frames(shares, means.rename(columns={"value": "mean"}))
