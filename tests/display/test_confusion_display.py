"""Confusion matrices."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.display import ConfusionDisplay
from tests.display.answer_tables import confusions


def test_cells_are_shares_and_say_them_in_percent():
    tables = confusions()
    display = ConfusionDisplay.from_tables(tables)
    for ax, table in zip(display.axes_, tables.values(), strict=True):
        assert_allclose(ax.images[0].get_array(), table)
        assert [text.get_text() for text in ax.texts] == [f"{100 * share:.0f}" for share in table.to_numpy().ravel()]


def test_all_kinds_have_the_same_shades_and_styles_are_named_once():
    display = ConfusionDisplay.from_tables(confusions(("one", "two", "three")))
    assert {ax.images[0].get_clim() for ax in display.axes_} == {(0.0, 1.0)}
    assert [len(ax.get_yticklabels()) for ax in display.axes_] == [2, 0, 0]


def test_right_answers_have_a_frame():
    ax = ConfusionDisplay.from_tables(confusions()).axes_[0]
    assert [(patch.get_x(), patch.get_y()) for patch in ax.patches] == [(-0.5, -0.5), (0.5, 0.5)]


def test_zeros_are_left_blank_and_styles_that_were_not_shown_have_dashes():
    tables = confusions(("original",))
    tables["original"].loc["cool"] = [1.0, 0.0, 0.0]
    tables["original"].loc["sad"] = np.nan
    ax = ConfusionDisplay.from_tables(tables).axes_[0]
    assert [text.get_text() for text in ax.texts] == ["100", "–", "–", "–"]
    assert ax.texts[0].get_color() == "white"


def test_errors():
    tables = confusions()
    with pytest.raises(ValueError, match="at least one table"):
        ConfusionDisplay.from_tables({})
    with pytest.raises(ValueError, match="those of 'synthetic' are others"):
        ConfusionDisplay.from_tables(tables | {"synthetic": tables["synthetic"][::-1]})
    with pytest.raises(ValueError, match="got others in 'original'; divide"):
        ConfusionDisplay.from_tables({"original": 10 * tables["original"]})
