"""Complete cases: who is left out, and what is said where nobody would be left."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from eigenwalker.experiment.ratings.gaps import MISSING, complete_cases

NAN = np.nan
RATINGS = np.array([[1.0, 2.0, NAN], [3.0, 4.0, 5.0], [6.0, 1.0, NAN], [2.0, 3.0, 4.0]])
NAMES = ["a", "b", "c", "d"], ["x", "y", "z"]


@pytest.mark.parametrize("missing", MISSING)
def test_without_gaps_nobody_is_left_out(missing):
    found = complete_cases(RATINGS[:, :2], NAMES[0], NAMES[1][:2], missing=missing)
    assert_array_equal(found.ratings, RATINGS[:, :2])
    assert (found.walkers_left_out, found.observers_left_out) == ([], [])


def test_walkers_are_left_out():
    found = complete_cases(RATINGS, *NAMES, missing="drop_walkers")
    assert_array_equal(found.ratings, RATINGS[[1, 3]])
    assert (found.walkers_left_out, found.observers_left_out) == (["a", "c"], [])


def test_observers_are_left_out():
    found = complete_cases(RATINGS, *NAMES, missing="drop_observers")
    assert_array_equal(found.ratings, RATINGS[:, :2])
    assert (found.walkers_left_out, found.observers_left_out) == ([], ["z"])


def test_a_gap_in_one_view_is_a_gap():
    ratings = np.stack([np.nan_to_num(RATINGS), RATINGS], axis=2)
    found = complete_cases(ratings, *NAMES, missing="drop_observers")
    assert_array_equal(found.ratings, ratings[:, :2])


def test_errors_say_who_lacks_what_and_what_would_be_left():
    with pytest.raises(
        ValueError, match=r"2 of 12 are missing; by observers, .*: z \(2\); of walkers, .*: a \(1\), c \(1\); miss"
    ):
        complete_cases(RATINGS, *NAMES)
    with pytest.raises(ValueError, match="would leave 2 walkers, missing='drop_observers' 2 observers"):
        complete_cases(RATINGS, *NAMES)
    diagonal = np.where(np.eye(9) > 0, NAN, 1.0)
    for missing in ("drop_walkers", "drop_observers"):
        with pytest.raises(ValueError, match=r"5 \(1\) and 3 more; missing='drop_walkers' would leave 0"):
            complete_cases(diagonal, range(9), range(9), missing=missing)
    with pytest.raises(
        ValueError, match="missing must be one of 'error', 'drop_walkers', 'drop_observers', got 'drop'"
    ):
        complete_cases(RATINGS, *NAMES, missing="drop")
