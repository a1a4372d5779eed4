"""Ratings become labels: the paper's average, its invariances, gaps, and a fit in one line."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import make_eigenwalkers
from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.ratings.traits import rating_counts, ratings_to_traits
from tests.experiment.ratings.rated import random_ratings, rating_answers, special_answers


@pytest.fixture(scope="module")
def ratings():
    return random_ratings((20, 3, 3))


def test_the_average_of_the_paper(ratings):
    """Troje 2002, section 4: across the three observers in each group and across the three viewpoints."""
    nervous = random_ratings((20, 3, 3), random_state=1)
    answers = pd.concat([rating_answers(ratings), rating_answers(nervous, "nervous", first_participant=4)])
    table = ratings_to_traits(answers)
    assert table.index.name == "walker"
    assert table.index.tolist() == [f"walker {number:02d}" for number in range(20)]
    assert_allclose(table[["happy", "nervous"]], np.column_stack([ratings.mean((1, 2)), nervous.mean((1, 2))]))
    assert list(table) == ["happy", "nervous"]


@pytest.mark.parametrize(
    "options", [{}, {"standardize": True}, {"adjust": True}, {"adjust": True, "standardize": True}]
)
def test_rows_and_other_trials_change_nothing(ratings, options):
    answers = rating_answers(ratings)
    more = [
        special_answers(answers, "practice", value=[6.0] * 9),
        special_answers(answers, "attention", value=[1.0] * 9),
    ]
    changed = pd.concat([answers, *more]).sample(frac=1, random_state=3)
    pd.testing.assert_frame_equal(ratings_to_traits(changed, **options), ratings_to_traits(answers, **options))


def test_rows_come_in_the_order_of_the_walks(ratings):
    answers = rating_answers(ratings[:2])
    table = ratings_to_traits(answers, walks=["walker 01", "unrated", "walker 00"])
    assert table.index.tolist() == ["walker 01", "unrated", "walker 00"]
    assert_allclose(table["happy"], [ratings[1].mean(), np.nan, ratings[0].mean()])


def test_labels_fit_in_one_line():
    """Observers who press the button of the true trait: the axis is that of the true trait."""
    walkers = make_walkers(24, duration=4.0, random_state=0)
    walks, happy = walkers.data, walkers.target["happy"].to_numpy()
    names = [walk.name for walk in walks]
    answers = rating_answers(np.repeat(np.clip(3.5 + happy, 1, 6)[:, np.newaxis, np.newaxis], 2, axis=1), views=[0.0])
    answers["stimulus"] = answers["trial"].map(lambda trial: names[trial - 1])
    answers = answers[answers["stimulus"] != names[3]]
    labels = ratings_to_traits(answers, walks=walks)
    assert np.isnan(labels["happy"]).tolist() == [name == names[3] for name in names]
    model = make_eigenwalkers(n_components=6).fit(walks, labels)
    assert np.corrcoef(model.transform(walks)[:, 0], happy)[0, 1] > 0.7


def test_counts(ratings):
    gaps = ratings.copy()
    gaps[4, 0, :] = gaps[7] = np.nan
    answers = rating_answers(gaps)
    repeated = answers[answers["stimulus"] == "walker 00"]
    repeated = repeated.assign(session=repeated["session"] + 3)
    counts = rating_counts(pd.concat([answers, repeated]), walks=[f"walker {number:02d}" for number in range(20)])
    expected = np.full(20, 9)
    expected[[4, 7]] = 6, 0
    assert_array_equal(counts["happy"], expected)
    assert counts.index.name == "walker"


def test_walkers_with_few_ratings_have_no_label(ratings):
    gaps = ratings.copy()
    gaps[4, 0, :] = np.nan
    table = ratings_to_traits(rating_answers(gaps), min_ratings=7)
    assert np.flatnonzero(table["happy"].isna()).tolist() == [4]


def test_standardized_ratings_do_not_depend_on_which_buttons_an_observer_uses(ratings):
    changed = ratings * [[[1.0], [0.2], [0.7]]] + [[[0.0], [1.0], [2.0]]]
    one, other = (ratings_to_traits(rating_answers(part), standardize=True) for part in (ratings, changed))
    assert_allclose(one, other, atol=1e-12)


def test_standardized_ratings_by_hand():
    """Means 2 and 5, standard deviations 1 and 1 / sqrt(2) times 2."""
    table = ratings_to_traits(
        rating_answers([[[1.0], [4.0]], [[2.0], [6.0]], [[3.0], [5.0]]], views=[0.0]), standardize=True
    )
    assert_allclose(table["happy"], [-1.0, 0.5, 0.5])


def test_an_observer_who_always_presses_one_button_has_no_z_scores(ratings):
    lazy = np.concatenate([ratings, np.full((20, 1, 3), 4.0)], axis=1)
    with pytest.warns(UserWarning, match=r"left out.*no z-scores: 4 \(happy\)"):
        table = ratings_to_traits(rating_answers(lazy), standardize=True)
    pd.testing.assert_frame_equal(table, ratings_to_traits(rating_answers(ratings), standardize=True))
    with pytest.raises(ValueError, match="there is none for: happy; use standardize=False"):
        ratings_to_traits(rating_answers(lazy[:, 3:]), standardize=True)


def test_a_walker_that_only_such_an_observer_rated_has_no_label(ratings):
    lazy = np.concatenate([ratings, np.full((20, 1, 3), 4.0)], axis=1)
    lazy[2, :3] = np.nan
    for adjust in (False, True):
        with pytest.warns(UserWarning, match="left out"):
            table = ratings_to_traits(rating_answers(lazy), standardize=True, adjust=adjust)
        assert np.flatnonzero(table["happy"].isna()).tolist() == [2]


def test_a_harsh_observer_who_skips_a_walker_shifts_it_unless_adjusted():
    walkers, harshness = np.array([2.0, 3.0, 4.0, 5.0]), np.array([-1.0, 0.0, 1.0])
    full = np.repeat((walkers[:, np.newaxis] + harshness)[:, :, np.newaxis], 3, axis=2)
    gaps = full.copy()
    gaps[1, 0] = np.nan
    answers = rating_answers(gaps)
    assert_allclose(ratings_to_traits(answers)["happy"], [2.0, 3.5, 4.0, 5.0])
    assert_allclose(ratings_to_traits(answers, adjust=True)["happy"], walkers)


def test_without_gaps_there_is_nothing_to_adjust(ratings):
    answers = rating_answers(ratings)
    assert_allclose(ratings_to_traits(answers, adjust=True), ratings_to_traits(answers), atol=1e-12)


def test_one_rating_is_a_label():
    table = ratings_to_traits(rating_answers([[[5.0]]], views=[90.0]))
    assert table["happy"].tolist() == [5.0]


def test_errors(ratings):
    answers = rating_answers(ratings[:12])
    with pytest.raises(
        ValueError, match=r"10 rated walkers are not among them: walker 02, .*walker 09 and 2 more; add"
    ):
        ratings_to_traits(answers, walks=["walker 00", "walker 01"])
    with pytest.raises(ValueError, match="these repeat: walker 00"):
        ratings_to_traits(answers, walks=["walker 00", "walker 00"])
    with pytest.raises(TypeError, match="got a single str"):
        rating_counts(answers, walks="walker 00")
    with pytest.raises(TypeError, match="got int among them"):
        ratings_to_traits(answers, walks=["walker 00", 1])
    with pytest.raises(ValueError, match="min_ratings must be 1 or more, got 0"):
        ratings_to_traits(answers, min_ratings=0)
    apart = ratings[:12].copy()
    apart[:6, 0], apart[6:, 1:] = np.nan, np.nan
    with pytest.raises(
        ValueError, match="these share none with the others: walker 00, walker 01, walker 02; walker 06"
    ):
        ratings_to_traits(rating_answers(apart), adjust=True)
