"""Reliability of ratings: that of the arrays behind it, what each number generalizes to, and the edges."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment.ratings.intraclass import intraclass_correlation
from eigenwalker.experiment.ratings.reliability import reliability_table, view_correlations
from eigenwalker.experiment.ratings.split_half import split_half_reliability
from eigenwalker.experiment.ratings.traits import ratings_to_traits
from tests.experiment.ratings.rated import random_ratings, rating_answers, special_answers


def limits(table, name, trait="happy"):
    return table.loc[trait, [name, f"{name}_low", f"{name}_high"]].tolist()


@pytest.fixture(scope="module")
def ratings():
    """As in the paper: 80 walkers, three observers, three views."""
    return random_ratings((80, 3, 3))


def test_numbers_are_those_of_the_arrays(ratings):
    table = reliability_table(rating_answers(ratings))
    means, views = ratings.mean(axis=2), ratings.mean(axis=1)
    assert table.index.name == "trait"
    assert table.loc["happy", ["n_observers", "n_views", "n_walkers"]].tolist() == [3, 3, 80]
    for name, kind in (("icc_single", "ICC(2,1)"), ("icc_mean", "ICC(2,k)")):
        assert_allclose(limits(table, name), intraclass_correlation(means, kind=kind, interval="generalized")[:3])
    assert_allclose(limits(table, "split_half"), split_half_reliability(means))
    assert_allclose(limits(table, "view_icc"), intraclass_correlation(views, kind="ICC(3,1)")[:3])


def test_published_intervals_can_be_had(ratings):
    table = reliability_table(rating_answers(ratings), interval="satterthwaite", level=0.8)
    assert_allclose(limits(table, "icc_single"), intraclass_correlation(ratings.mean(axis=2), level=0.8)[:3])


def test_every_trait_by_itself(ratings):
    nervous = random_ratings((10, 5, 2), random_state=1)
    answers = [rating_answers(ratings), rating_answers(nervous, "nervous", first_participant=4)]
    both = reliability_table(pd.concat(answers))
    alone = pd.concat([reliability_table(part) for part in answers])
    pd.testing.assert_frame_equal(both, alone)


def test_the_reliability_of_the_mean_is_how_well_it_repeats():
    """Other observers of the same walkers: the means correlate by the split-half reliability, in expectation."""
    walkers = np.random.default_rng(0).normal(size=(400, 1, 1))
    first, second = (
        3.5 + 0.5 * walkers + np.random.default_rng(seed).normal(scale=0.5, size=(400, 6, 2)) for seed in (1, 2)
    )
    answers = [rating_answers(np.clip(part, 1, 6), views=[0.0, 90.0]) for part in (first, second)]
    again = np.corrcoef(*[ratings_to_traits(part)["happy"] for part in answers])[0, 1]
    table = reliability_table(answers[0])
    assert_allclose(table.loc["happy", "split_half"], again, atol=0.04)
    assert_allclose(table.loc["happy", "icc_mean"], again, atol=0.04)


def test_views_that_share_nothing_but_observers_are_not_alike():
    ratings = random_ratings((80, 3, 3), walkers=0.0)
    table = reliability_table(rating_answers(ratings))
    assert table.loc["happy", "view_icc_low"] < 0 < table.loc["happy", "view_icc_high"]


def test_correlations_of_views_by_hand(ratings):
    """Fisher: tanh(arctanh(r) -+ 1.96 / sqrt(80 - 3))."""
    table = view_correlations(rating_answers(ratings))
    assert table[["view", "other_view"]].to_numpy().tolist() == [[0.0, 30.0], [0.0, 90.0], [30.0, 90.0]]
    r = np.corrcoef(ratings.mean(axis=1).T)[[0, 0, 1], [1, 2, 2]]
    half = 1.959964 / np.sqrt(77)
    assert_allclose(table["r"], r)
    assert_allclose(table[["low", "high"]], np.tanh(np.arctanh(r)[:, np.newaxis] + [-half, half]), rtol=1e-6)
    assert table["n_walkers"].tolist() == [80] * 3
    assert table["trait"].unique().tolist() == ["happy"]


def test_gaps(ratings):
    gaps = ratings[:20].copy()
    gaps[3, 1, 2] = gaps[5, 1, 0] = np.nan
    answers = rating_answers(gaps)
    with pytest.raises(ValueError, match=r"trait 'happy': expected ratings of all 20 walkers.*walkers: 2 \(2\)"):
        reliability_table(answers)
    with pytest.raises(ValueError, match="2 of 180 are missing"):
        view_correlations(answers)
    without = {"drop_walkers": np.delete(gaps, [3, 5], axis=0), "drop_observers": gaps[:, [0, 2]]}
    for missing, whole in without.items():
        found, expected = reliability_table(answers, missing=missing), reliability_table(rating_answers(whole))
        left_out = ["n_observers_left_out", "n_walkers_left_out"]
        pd.testing.assert_frame_equal(found.drop(columns=left_out), expected.drop(columns=left_out))
        assert found.loc["happy", left_out].tolist() == ([0, 2] if missing == "drop_walkers" else [1, 0])
        assert_allclose(view_correlations(answers, missing=missing)["r"], view_correlations(rating_answers(whole))["r"])


def test_attention_trials_are_counted_for_the_observers_of_the_trait(ratings):
    answers = pd.concat([rating_answers(ratings), rating_answers(ratings, "nervous", first_participant=4)])
    asked = special_answers(
        answers,
        "attention",
        participant=[1, 1, 2, 3, 3, 4],
        expected=list("666666"),
        answer=["6", "5", "6", "1", "2", ""],
    )
    asked["trial"] = 1000 + np.arange(6)
    table = reliability_table(pd.concat([answers, asked]))
    columns = ["n_attention", "n_attention_failed", "n_observers_failing"]
    assert table.loc["happy", columns].tolist() == [5, 3, 2]
    assert table.loc["nervous", columns].tolist() == [0, 0, 0]


def test_one_observer_has_no_reliability_over_observers(ratings):
    table = reliability_table(rating_answers(ratings[:, :1]))
    for name in ("icc_single", "icc_mean", "split_half"):
        assert np.isnan(limits(table, name)).all()
    assert np.isfinite(limits(table, "view_icc")).all()


def test_one_view_has_none_over_views(ratings):
    answers = rating_answers(ratings[:, :, :1])
    table = reliability_table(answers)
    assert np.isnan(limits(table, "view_icc")).all()
    assert np.isfinite(limits(table, "split_half")).all()
    assert len(view_correlations(answers)) == 0


def test_constant_ratings_have_none():
    answers = rating_answers(np.full((10, 3, 3), 4.0))
    table = reliability_table(answers)
    for name in ("icc_single", "icc_mean", "split_half", "view_icc"):
        assert np.isnan(limits(table, name)).all()
    assert view_correlations(answers)[["r", "low", "high"]].isna().all(axis=None)


def test_two_walkers():
    table = reliability_table(rating_answers(random_ratings((2, 3, 3))))
    assert np.isnan(limits(table, "split_half")).all()
    assert np.isfinite(limits(table, "icc_single")).all()


def test_errors(ratings):
    answers = rating_answers(ratings[:1])
    with pytest.raises(
        ValueError, match="trait 'happy': expected two walkers or more that everybody has rated, got one"
    ):
        reliability_table(answers)
    with pytest.raises(ValueError, match="missing must be one of"):
        reliability_table(answers, missing="drop")
    with pytest.raises(ValueError, match="interval must be one of 'satterthwaite', 'generalized', got 'exact'"):
        reliability_table(answers, interval="exact")
    with pytest.raises(ValueError, match="level must be between 0 and 1"):
        view_correlations(answers, level=2)
