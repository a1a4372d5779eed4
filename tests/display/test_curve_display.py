"""Curves of scores."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker.display import CurveDisplay


def _curve(n_traits):
    scores = np.random.default_rng(0).uniform(size=(5, n_traits))
    return pd.DataFrame(scores, index=range(1, 6), columns=[f"trait {number}" for number in range(n_traits)])


def test_lines_are_the_columns():
    curve = _curve(3)
    ax = CurveDisplay.from_frame(curve, xlabel="number of harmonics", ylabel="accuracy").ax_
    for line, (name, scores) in zip(ax.lines, curve.items(), strict=True):
        assert line.get_label() == name
        assert_allclose(line.get_xydata(), np.column_stack((curve.index, scores)))
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("number of harmonics", "accuracy")


def test_lines_are_told_apart_without_color():
    lines = CurveDisplay.from_frame(_curve(8)).ax_.lines
    assert len({(line.get_linestyle(), line.get_marker()) for line in lines}) == 8


def test_the_chosen_number_is_marked():
    display = CurveDisplay.from_frame(_curve(1), chosen=4)
    assert list(display.ax_.lines[-1].get_xdata()) == [4, 4]
    assert display.ax_.get_legend().get_texts()[-1].get_text() == "chosen, 4"


def test_a_number_that_is_not_there_is_refused():
    with pytest.raises(ValueError, match="chosen must be one of 1, 2, 3, 4, 5, got 7"):
        CurveDisplay.from_frame(_curve(1), chosen=7)


def test_missing_scores_leave_a_gap():
    curve = _curve(1)
    curve.iloc[2] = np.nan
    assert np.isnan(CurveDisplay.from_frame(curve).ax_.lines[0].get_ydata()[2])
