"""Shares of answers."""

import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment import rate_interval
from eigenwalker.experiment.analysis.shares import share_table


def test_shares_add_up_and_have_the_intervals_of_rates():
    trials = pd.DataFrame({"answer": ["a"] * 5 + ["b"] * 3})
    table = share_table(trials, ("b", "a", "c"), level=0.9)
    assert table.index.tolist() == ["b", "a", "c"]
    assert table["n_answers"].tolist() == [3, 5, 0]
    assert_allclose(table["share"].sum(), 1.0)
    assert_allclose(table.loc["a", ["share", "low", "high"]], rate_interval(trials["answer"] == "a", level=0.9))


def test_an_answer_that_nobody_gave_is_not_impossible():
    row = share_table(pd.DataFrame({"answer": ["a"] * 20}), ("a", "b")).loc["b"]
    assert (row["share"], row["low"]) == (0.0, 0.0)
    assert_allclose(row["high"], 0.1611, atol=5e-5)  # Newcombe 1998, 0 of 20


def test_one_person_who_says_it_all_is_one_person():
    alone = pd.DataFrame({"answer": ["a"] * 10 + ["b"] * 10})
    wide = share_table(alone.assign(participant=[1] * 10 + [2] * 10), ("a", "b"))
    assert (wide["high"] - wide["low"] > 1.5 * (share_table(alone, ("a", "b")).eval("high - low"))).all()


def test_errors():
    with pytest.raises(ValueError, match="answers out of a, b, got c"):
        share_table(pd.DataFrame({"answer": ["a", "c"]}), ("a", "b"))
    with pytest.raises(ValueError, match="got none at all"):
        share_table(pd.DataFrame({"answer": []}), ("a", "b"))
