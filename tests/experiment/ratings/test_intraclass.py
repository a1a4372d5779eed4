"""Intraclass correlations: two published examples, analysis of variance by hand, coverage, and the edges."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment.ratings.intraclass import ICC_INTERVALS, ICC_KINDS, intraclass_correlation

SHROUT_FLEISS = np.array([[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]])
"""Shrout & Fleiss 1979, Table 2: six targets, four judges."""

MCGRAW_WONG = np.reshape(
    [103, 119, 82, 65, 116, 106, 102, 102, 99, 105, 98, 100, 104, 107, 62, 85, 97, 101, 107, 110], (10, 2)
)
"""McGraw & Wong 1996, Table 6: ten pairs of scores."""


def simulated(n_walkers, n_observers, harshness, random):
    return (
        random.normal(size=(n_walkers, 1))
        + harshness * random.normal(size=n_observers)
        + random.normal(size=(n_walkers, n_observers))
    )


@pytest.mark.parametrize(("kind", "printed"), list(zip(ICC_KINDS, (0.17, 0.29, 0.71, 0.44, 0.62, 0.91), strict=True)))
def test_coefficients_that_shrout_and_fleiss_print(kind, printed):
    """Psychological Bulletin 86, 420-428, Table 4."""
    assert_allclose(intraclass_correlation(SHROUT_FLEISS, kind=kind).value, printed, atol=0.005)


@pytest.mark.parametrize(
    ("kind", "value", "low", "high"),
    [
        ("ICC(1,1)", 0.1657418, -0.13293232, 0.7225601),
        ("ICC(2,1)", 0.2897638, 0.01878651, 0.7610844),
        ("ICC(3,1)", 0.7148407, 0.34246477, 0.9458583),
        ("ICC(1,k)", 0.4427971, -0.88444216, 0.9124154),
        ("ICC(2,k)", 0.6200505, 0.07113682, 0.9272320),
        ("ICC(3,k)", 0.9093155, 0.67567471, 0.9858917),
    ],
)
def test_intervals_of_their_example(kind, value, low, high):
    """As other programs print them."""
    assert_allclose(intraclass_correlation(SHROUT_FLEISS, kind=kind)[:3], (value, low, high), atol=1e-6)


@pytest.mark.parametrize(
    ("kind", "value", "low", "high"),
    [
        ("ICC(1,1)", 0.722, 0.241, 0.922),
        ("ICC(2,1)", 0.720, 0.228, 0.922),
        ("ICC(3,1)", 0.714, 0.197, 0.920),
        ("ICC(1,k)", 0.838, 0.389, 0.959),
        ("ICC(2,k)", 0.837, 0.371, 0.959),
        ("ICC(3,k)", 0.833, 0.329, 0.959),
    ],
)
def test_intervals_of_the_example_of_mcgraw_and_wong(kind, value, low, high):
    """As other programs print them."""
    assert_allclose(intraclass_correlation(MCGRAW_WONG, kind=kind)[:3], (value, low, high), atol=6e-4)


def test_variance_components_by_hand():
    """Mean squares of walkers 11.24, judges 32.49, error 1.02 and within 6.26: Shrout & Fleiss 1979, Table 3."""
    for kind, expected in (
        ("ICC(1,1)", (11.24 - 6.26) / (11.24 + 3 * 6.26)),
        ("ICC(2,1)", (11.24 - 1.02) / (11.24 + 3 * 1.02 + 4 * (32.49 - 1.02) / 6)),
        ("ICC(3,1)", (11.24 - 1.02) / (11.24 + 3 * 1.02)),
        ("ICC(3,k)", (11.24 - 1.02) / 11.24),
    ):
        assert_allclose(intraclass_correlation(SHROUT_FLEISS, kind=kind).value, expected, atol=1e-3)


def test_the_third_kind_of_means_is_cronbachs_alpha():
    alpha = 4 / 3 * (1 - SHROUT_FLEISS.var(axis=0, ddof=1).sum() / SHROUT_FLEISS.sum(axis=1).var(ddof=1))
    assert_allclose(intraclass_correlation(SHROUT_FLEISS, kind="ICC(3,k)").value, alpha, rtol=1e-12)


@pytest.mark.parametrize("interval", ICC_INTERVALS)
@pytest.mark.parametrize("kind", ICC_KINDS[:3])
def test_means_follow_spearman_and_brown(kind, interval):
    single = np.array(intraclass_correlation(SHROUT_FLEISS, kind=kind, interval=interval)[:3])
    mean = intraclass_correlation(SHROUT_FLEISS, kind=kind.replace(",1", ",k"), interval=interval)[:3]
    assert_allclose(mean, 4 * single / (1 + 3 * single), rtol=1e-9)


@pytest.mark.parametrize("interval", ICC_INTERVALS)
@pytest.mark.parametrize("kind", ICC_KINDS)
def test_order_units_and_origin_do_not_matter(kind, interval):
    random = np.random.default_rng(0)
    changed = 7 - 3 * SHROUT_FLEISS[random.permutation(6)][:, random.permutation(4)]
    found, expected = (
        intraclass_correlation(ratings, kind=kind, interval=interval) for ratings in (changed, SHROUT_FLEISS)
    )
    assert_allclose(found[:3], expected[:3], rtol=1e-7)


def test_harsh_observers_matter_to_agreement_only():
    same = SHROUT_FLEISS - SHROUT_FLEISS.mean(axis=0)
    tables = [same + factor * np.array([0, 1, 0, -1]) for factor in (0, 1, 5)]
    third = [intraclass_correlation(ratings, kind="ICC(3,1)")[:3] for ratings in tables]
    assert_allclose(third, third[:1] * 3, rtol=1e-9)
    second = [intraclass_correlation(ratings).value for ratings in tables]
    assert second[0] > second[1] > second[2]


@pytest.mark.parametrize("interval", ICC_INTERVALS)
def test_intervals_hold_as_often_as_they_say(interval):
    """300 studies of 20 walkers and 5 observers, who vary half as much: 95 % within 3 standard errors of 1.3 %."""
    random, covered = np.random.default_rng(1), {"ICC(1,1)": 0, "ICC(2,1)": 0, "ICC(3,1)": 0}
    truths = {"ICC(1,1)": 0.5, "ICC(2,1)": 1 / 2.25, "ICC(3,1)": 0.5}
    kinds = truths if interval == "satterthwaite" else ("ICC(2,1)",)
    for _ in range(300):
        ratings = simulated(20, 5, 0.5, random)
        for kind in kinds:
            table = simulated(20, 5, 0.0, random) if kind == "ICC(1,1)" else ratings
            found = intraclass_correlation(table, kind=kind, interval=interval)
            covered[kind] += found.low <= truths[kind] <= found.high
    for kind in kinds:
        assert 0.912 <= covered[kind] / 300 <= 0.988


def test_with_few_observers_the_generalized_interval_holds_and_the_published_one_does_not():
    """In 200 studies of 80 walkers and 3 observers who vary twice as much as walkers."""
    random, covered = np.random.default_rng(2), dict.fromkeys(ICC_INTERVALS, 0)
    for _ in range(200):
        ratings = simulated(80, 3, 2.0, random)
        for interval in ICC_INTERVALS:
            found = intraclass_correlation(ratings, interval=interval)
            covered[interval] += found.low <= 1 / 6 <= found.high
    assert covered["satterthwaite"] / 200 < 0.9
    assert covered["generalized"] / 200 > 0.92


@pytest.mark.parametrize("interval", ICC_INTERVALS)
@pytest.mark.parametrize("kind", ICC_KINDS)
def test_observers_who_agree(kind, interval):
    found = intraclass_correlation(np.repeat([[1.0], [4.0], [6.0]], 3, axis=1), kind=kind, interval=interval)
    assert found == (1.0, 1.0, 1.0, 3, 3, ())


@pytest.mark.parametrize("interval", ICC_INTERVALS)
@pytest.mark.parametrize("kind", ICC_KINDS)
@pytest.mark.parametrize("ratings", [np.full((5, 3), 4.0), np.tile([2.0, 5.1, 0.3], (5, 1))])
def test_observers_who_press_one_button_tell_nothing(ratings, kind, interval):
    found = intraclass_correlation(ratings, kind=kind, interval=interval)
    assert np.isnan(found[:3]).all()
    assert found[3:] == (5, 3, ())


@pytest.mark.parametrize("interval", ICC_INTERVALS)
@pytest.mark.parametrize("kind", ICC_KINDS)
def test_walkers_with_equal_means_are_no_ratio(kind, interval):
    ratings = np.array([[1.0, 2.0, 3.0], [3.0, 1.0, 2.0], [2.0, 3.0, 1.0]])
    found = intraclass_correlation(ratings, kind=kind, interval=interval)
    assert found.value == -np.inf if kind.endswith("k)") else -np.inf < found.value < 0
    assert found.low <= found.value <= found.high <= 1


def test_walkers_with_gaps():
    table = pd.DataFrame(SHROUT_FLEISS.astype(float), index=list("abcdef"), columns=["x", "y", "z", "u"])
    table.loc["b", "y"] = table.loc["d", "y"] = np.nan
    with pytest.raises(ValueError, match=r": y \(2\); of walkers, by so many observers: b \(1\), d"):
        intraclass_correlation(table)
    found = intraclass_correlation(table, missing="drop_walkers")
    assert found == (*intraclass_correlation(SHROUT_FLEISS[[0, 2, 4, 5]])[:3], 4, 4, ("b", "d"))
    found = intraclass_correlation(table, missing="drop_observers")
    assert found == (*intraclass_correlation(SHROUT_FLEISS[:, [0, 2, 3]])[:3], 6, 3, ("y",))


def test_errors():
    with pytest.raises(ValueError, match=r"kind must be one of 'ICC\(1,1\)'.*got 'ICC2'"):
        intraclass_correlation(SHROUT_FLEISS, kind="ICC2")
    with pytest.raises(ValueError, match="interval must be one of"):
        intraclass_correlation(SHROUT_FLEISS, interval="exact")
    with pytest.raises(ValueError, match="level must be between 0 and 1, got 95"):
        intraclass_correlation(SHROUT_FLEISS, level=95)
    with pytest.raises(ValueError, match="or more, got 6 and 1"):
        intraclass_correlation(SHROUT_FLEISS[:, :1])
    with pytest.raises(ValueError, match="or more without gaps, got 1 and 2"):
        intraclass_correlation([[1, np.nan], [2, 3]], missing="drop_walkers")
    with pytest.raises(ValueError, match="got 1 infinite ones"):
        intraclass_correlation([[1, np.inf], [2, 3]])
    with pytest.raises(ValueError, match="expected ratings as numbers"):
        intraclass_correlation([["sad", "sad"], ["happy", "sad"]])
