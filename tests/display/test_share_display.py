"""Shares of answers."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.display import ShareDisplay
from tests.display.answer_tables import shares


def test_bars_are_the_shares_and_numbers_the_answers():
    table = shares()
    ax = ShareDisplay.from_frame(table, xlabel="taken for").ax_
    for bars, kind in zip(ax.containers, ("original", "synthetic"), strict=True):
        assert_allclose([bar.get_height() for bar in bars], 100 * table.loc[kind, "share"])
        assert bars.get_label() == f"{kind}, {table.loc[kind, 'n_trials'].iloc[0]} answers"
    assert [text.get_text() for text in ax.texts] == [str(count) for count in table["n_answers"]]
    assert ax.get_xlabel() == "taken for"


def test_intervals_are_on_the_bars():
    table = shares(series=())
    ax = ShareDisplay.from_frame(table).ax_
    segments = np.array(ax.collections[-1].get_segments())  # (n_answers, 2 ends, 2)
    assert_allclose(segments[:, :, 1], 100 * table[["low", "high"]])
    assert_allclose(segments[:, 0, 0], [bar.get_x() + bar.get_width() / 2 for bar in ax.containers[0]])


def test_series_are_told_apart_without_color():
    table = shares(series=("one", "two", "three", "four"))
    ax = ShareDisplay.from_frame(table).ax_
    assert len({(bars[0].get_facecolor(), bars[0].get_hatch()) for bars in ax.containers}) == 4


def test_one_series_needs_no_legend():
    assert ShareDisplay.from_frame(shares(series=())).ax_.get_legend() is None


def test_long_answers_are_broken():
    ax = ShareDisplay.from_frame(shares(series=(), answers=("nothing in common", "identical"))).ax_
    assert ax.get_xticklabels()[0].get_text() == "nothing in\ncommon"


def test_an_answer_that_a_series_lacks_has_no_bar():
    table = shares().drop(index=("original", "don't know"))
    assert [len(bars) for bars in ShareDisplay.from_frame(table).ax_.containers] == [2, 3]


def test_errors():
    with pytest.raises(ValueError, match="missing: n_trials"):
        ShareDisplay.from_frame(shares().drop(columns="n_trials"))
    with pytest.raises(ValueError, match="got more levels or some that repeat"):
        ShareDisplay.from_frame(shares(answers=("real", "real")))
