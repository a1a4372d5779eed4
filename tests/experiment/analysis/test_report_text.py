"""Estimates and tables in plain text."""

import re

import numpy as np
import pandas as pd
import pytest

from eigenwalker.experiment.analysis.report_text import (
    estimate_cell,
    interval_words,
    percent_cell,
    report_text,
    text_table,
)


def test_cells():
    assert estimate_cell((-0.5, -1.0, 0.25), digits=1) == "-0.5 [-1.0, 0.2]"
    assert estimate_cell((1.0, np.nan, np.nan)) == "1.00"
    assert estimate_cell((np.nan, np.nan, np.nan)) == "-"
    assert estimate_cell((-0.001, -0.0, 0.0)) == "0.00 [0.00, 0.00]"
    assert percent_cell((0.0769, 0.0, 1.0)) == "7.7 [0.0, 100.0]"


def test_rows_keep_their_order_and_columns_are_as_wide_as_they_need():
    table = text_table({"b": {"n": "1"}, "long name": {"n": "20", "rate": "x"}, "a": {"rate": "y"}})
    assert table.splitlines() == ["           n   rate", "b          1   -", "long name  20  x", "a          -   y"]


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ((), "Intervals of 90%: no answers are taken to be alike."),
        (("walk",), "answers about one walk are .*; those of single styles"),
        (("participant", "walk"), "answers of one participant and answers about one walk are"),
    ],
)
def test_what_intervals_are(columns, words):
    trials = pd.DataFrame({name: [1] for name in ("answer", *columns)})
    assert re.search(words, interval_words(trials, 0.9))


def test_empty_parts_are_left_out():
    assert report_text("title", "one", "", "two") == "title\n\none\n\ntwo"
