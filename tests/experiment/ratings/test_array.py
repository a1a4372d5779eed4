"""Ratings as arrays: what is in them, in which order, and what is refused."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_array_equal

from eigenwalker.experiment.ratings.array import rated_traits
from tests.experiment.ratings.rated import random_ratings, rating_answers, special_answers


def test_the_array_comes_back():
    ratings = random_ratings((5, 3, 3))
    (name, rated), *others = rated_traits(rating_answers(ratings)).items()
    assert (name, others) == ("happy", [])
    assert_array_equal(rated.ratings, ratings)
    assert rated.walkers.tolist() == [f"walker {number:02d}" for number in range(5)]
    assert rated.observers.tolist() == [1, 2, 3]
    assert rated.views.tolist() == [0.0, 30.0, 90.0]


def test_gaps_are_nan():
    ratings = random_ratings((5, 3, 3))
    ratings[2, 1, 0] = ratings[4, :, 2] = np.nan
    assert_array_equal(rated_traits(rating_answers(ratings))["happy"].ratings, ratings)


def test_each_trait_has_its_own_observers():
    answers = pd.concat(
        [
            rating_answers(random_ratings((4, 3, 3)), "nervous"),
            rating_answers(random_ratings((5, 2, 1)), "happy", first_participant=4),
        ]
    )
    traits = rated_traits(answers)
    assert list(traits) == ["happy", "nervous"]
    assert traits["happy"].observers.tolist() == [4, 5]
    assert traits["happy"].ratings.shape == (5, 2, 1)
    assert traits["nervous"].ratings.shape == (4, 3, 3)


def test_practice_attention_other_tasks_and_unanswered_trials_are_left_out():
    ratings = random_ratings((5, 3, 3))
    answers = rating_answers(ratings)
    more = [
        special_answers(answers, "practice", value=[6.0, 6.0]),
        special_answers(answers, "attention", value=[1.0, 1.0]),
        answers[:3].assign(task="pair", value=4.0),
        special_answers(answers, "main", value=[np.nan] * 2, answer=[""] * 2, stimulus=["nobody"] * 2),
    ]
    assert_array_equal(rated_traits(pd.concat([answers, *more]))["happy"].ratings, ratings)


def test_repeated_ratings_are_averaged():
    answers = rating_answers(np.full((2, 2, 1), 2.0))
    again = answers[(answers["participant"] == 1) & (answers["trial"] == 1)].assign(session=9, value=5.0)
    ratings = rated_traits(pd.concat([answers, again, again.assign(session=10)]))["happy"].ratings
    assert_array_equal(ratings[:, :, 0], [[4.0, 2.0], [2.0, 2.0]])


def test_participants_of_two_studies_are_different_observers():
    one = rating_answers(np.full((2, 2, 1), 2.0))
    rated = rated_traits(pd.concat([one, rating_answers(np.full((2, 1, 1), 5.0)).assign(study="b")]))["happy"]
    assert rated.observers.tolist() == ["0123456789ab 1", "0123456789ab 2", "b 1"]
    assert_array_equal(rated.ratings[:, :, 0], [[2.0, 2.0, 5.0]] * 2)


def test_errors():
    answers = rating_answers(random_ratings((3, 2, 1)))
    with pytest.raises(TypeError, match="as a DataFrame, got list"):
        rated_traits([])
    with pytest.raises(ValueError, match="missing: trait, value"):
        rated_traits(answers.drop(columns=["trait", "value"]))
    with pytest.raises(ValueError, match="there is none, of the task 'rating' and the part 'main'"):
        rated_traits(answers.assign(task="pair"))
    with pytest.raises(ValueError, match="answered before: 1, the first is observer 1, session 1, trial 1; drop"):
        rated_traits(pd.concat([answers, answers[(answers["participant"] == 1) & (answers["trial"] == 1)]]))


def test_all_faults_are_named_at_once():
    answers = rating_answers(random_ratings((3, 2, 1)))
    worse = special_answers(
        answers, "main", value=[np.nan, 0.0, 3.0], answer=["very", "0", "3"], trait=["happy"] * 2 + [""]
    )
    with pytest.raises(ValueError, match="'very'; values less than 1 or infinite: 1, the first is 0; some have no tra"):
        rated_traits(pd.concat([answers, worse]))
