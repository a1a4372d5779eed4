"""Original walks less synthetic ones, in parts."""

import numpy as np
import pandas as pd
from numpy.testing import assert_allclose

from eigenwalker.experiment import recognition_difference
from eigenwalker.experiment.analysis.kind_differences import kind_differences


def trials(right, kinds):
    return pd.DataFrame({"truth": "sad", "answer": np.where(right, "sad", "cool"), "kind": kinds})


def test_it_is_the_other_difference_with_its_sign_turned():
    table = trials(np.arange(40) % 3 > 0, ["original"] * 15 + ["synthetic"] * 25)
    found = kind_differences({("all", "all walks"): table}).loc[("all", "all walks")]
    value, low, high = recognition_difference(table)
    assert_allclose(found, (-value, -high, -low))


def test_parts_with_one_kind_have_no_row():
    both = trials([True, False] * 4, ["original"] * 4 + ["synthetic"] * 4)
    found = kind_differences({("style", "sad"): both, ("style", "average walk"): both[4:]})
    assert found.index.tolist() == [("style", "sad")]


def test_without_both_kinds_there_is_an_empty_table():
    found = kind_differences({("all", "all walks"): trials([True], ["synthetic"])})
    assert found.shape == (0, 3)
    assert found.index.names == ["by", "group"]
