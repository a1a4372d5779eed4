"""Recognition as in the paper: efficiency, rates of styles and their correlation, confusions, and other trials."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment import (
    answer_shares,
    confusion_tables,
    rate_correlation,
    recognition_difference,
    recognition_table,
    style_rates,
)


def trials(original, synthetic, styles=("cool", "sad")):
    """Return trials of which so many of so many are right, of styles in turn."""
    rows = [
        {"truth": styles[at % len(styles)], "kind": kind, "right": at < right}
        for kind, (right, total) in (("original", original), ("synthetic", synthetic))
        for at in range(total)
    ]
    table = pd.DataFrame(rows)
    return table.assign(answer=np.where(table.pop("right"), table["truth"], "don't know"))


def rates(r, n_styles):
    """Return rates of styles that correlate by r."""
    columns = np.column_stack((np.ones(n_styles), np.random.default_rng(0).normal(size=(n_styles, 2))))
    one, other = np.linalg.qr(columns)[0][:, 1:].T
    return pd.DataFrame({"original": 0.4 + 0.1 * one, "synthetic": 0.4 + 0.1 * (r * one + np.sqrt(1 - r**2) * other)})


def test_efficiency_of_the_paper():
    """Eq. 16: 47.6 / 7.69 = 6.19 and 37.15 / 7.69 = 4.83, of 13 answers."""
    table = recognition_table(trials((476, 1000), (743, 2000)), n_choices=13)
    assert_allclose(table["rate"], [0.476, 0.3715])
    assert_allclose(table["efficiency"], [6.19, 4.83], atol=0.005)
    assert_allclose(table["chance"], 0.0769, atol=5e-5)


def test_efficiency_of_the_text():
    """With the rates that the text gives, 45.9 and 38.93 %, they are 5.97 and 5.06."""
    table = recognition_table(trials((459, 1000), (3893, 10000)), n_choices=13)
    assert_allclose(table["efficiency"], [5.97, 5.06], atol=0.005)


def test_recognition_table_hand_computed():
    table = recognition_table(trials((3, 4), (1, 4)))
    assert table.loc["original", ["n_trials", "n_right", "rate"]].tolist() == [4, 3, 0.75]
    assert table.loc["synthetic", "chance"] == pytest.approx(1 / 3)  # cool, sad, don't know
    assert_allclose(table["efficiency_low"], 3 * table["low"])
    assert (table["low"] < table["rate"]).all()
    assert (table["rate"] < table["high"]).all()


def test_walks_that_are_asked_about_again_make_intervals_wider():
    once = trials((20, 40), (20, 40))
    again = pd.concat([once.assign(walk=range(80))] * 3, ignore_index=True)
    grouped, alone = recognition_table(again), recognition_table(again.drop(columns="walk"))
    assert_allclose(grouped[["low", "high"]], recognition_table(once)[["low", "high"]], atol=0.01)
    assert (grouped["low"] < alone["low"]).all()
    assert (alone["high"] < grouped["high"]).all()


def test_difference_is_of_synthetic_walks():
    found = recognition_difference(trials((48, 80), (56, 70)))
    assert_allclose(found, (0.2, 0.0524, 0.3339), atol=5e-5)  # Newcombe 1998, table II (a), method 10


def test_difference_of_the_naturalness_of_the_paper():
    """Fig. 5: 161 of 246 and 128 of 254 walks called real, "15 % less"."""
    assert_allclose(recognition_difference(trials((161, 246), (128, 254))).value, -0.1505, atol=5e-5)


def test_style_rates():
    table = style_rates(trials((3, 4), (0, 2)))
    assert table.loc["cool"].tolist() == [1.0, 0.0]
    assert table.loc["sad"].tolist() == [0.5, 0.0]


def test_a_style_that_was_not_shown_has_no_rate():
    table = style_rates(trials((3, 4), (1, 1)))
    assert np.isnan(table.loc["sad", "synthetic"])


def test_correlation_of_the_paper_is_uncertain():
    """r = 0.8849 over 11 styles."""
    assert_allclose(rate_correlation(rates(0.8849, 11)), (0.8849, 0.61, 0.97), atol=0.005)


def test_correlation_ignores_scale_and_styles_of_one_kind():
    table = rates(0.6, 8)
    wider = pd.concat([table * 0.5 + 0.1, pd.DataFrame({"original": [1.0]})], ignore_index=True)
    assert_allclose(rate_correlation(wider), rate_correlation(table))


def test_correlation_of_constant_rates_is_unknown():
    assert np.isnan(rate_correlation(rates(0.5, 5).assign(original=1.0))).all()


def test_correlation_of_three_styles_is_open():
    assert rate_correlation(rates(0.5, 3))[1:] == (-1.0, 1.0)


def test_confusions_hand_computed():
    table = pd.DataFrame(
        {
            "truth": ["sad", "sad", "cool", "cool", "proud"],
            "answer": ["sad", "cool", "cool", "don't know", "cool"],
            "kind": ["original", "original", "original", "original", "synthetic"],
        }
    )
    counts = confusion_tables(table, normalize=False)
    assert counts["original"].columns.tolist() == ["cool", "proud", "sad", "don't know"]
    assert counts["original"].to_numpy().tolist() == [[1, 0, 0, 1], [0, 0, 0, 0], [1, 0, 1, 0]]
    shares = confusion_tables(table)
    assert shares["original"].loc["sad"].tolist() == [0.5, 0.0, 0.5, 0.0]
    assert shares["original"].loc["proud"].isna().all()
    assert shares["synthetic"].loc["proud", "cool"] == 1.0


def test_confusions_add_up():
    table = trials((5, 8), (2, 8))
    assert sum(part.to_numpy().sum() for part in confusion_tables(table, normalize=False).values()) == len(table)
    diagonal = np.diag(confusion_tables(table)["original"])
    assert_allclose(diagonal, style_rates(table)["original"])


def test_answer_shares_of_the_paper():
    """Fig. 5: "real" for 65.45 % of 246 original and 50.39 % of 254 synthetic walks, "I don't know" 2.44 and 6.69 %."""
    counts = {"original": (161, 79, 6), "synthetic": (128, 109, 17)}
    said = ("real", "synthetic", "I don't know")
    rows = [
        (kind, one) for kind, numbers in counts.items() for one, n in zip(said, numbers, strict=True) for _ in range(n)
    ]
    shares = answer_shares(pd.DataFrame(rows, columns=["kind", "answer"]))
    assert_allclose(shares["real"], [0.6545, 0.5039], atol=5e-5)
    assert_allclose(shares["I don't know"], [0.0244, 0.0669], atol=5e-5)
    assert_allclose(shares.sum(axis=1), 1.0)


def test_errors():
    good = trials((1, 2), (1, 2))
    with pytest.raises(TypeError, match="trials as a DataFrame, got list"):
        recognition_table([1, 2])
    with pytest.raises(ValueError, match="missing: answer, kind"):
        recognition_table(pd.DataFrame({"truth": ["sad"]}))
    with pytest.raises(ValueError, match="at least one trial"):
        recognition_table(good[:0])
    with pytest.raises(ValueError, match="missing in: answer"):
        recognition_table(good.assign(answer=None))
    with pytest.raises(ValueError, match="original and synthetic, got real"):
        style_rates(good.assign(kind="real"))
    with pytest.raises(ValueError, match="n_choices must be 1 or more, got 0"):
        recognition_table(good, n_choices=0)
    with pytest.raises(ValueError, match="none with synthetic ones"):
        recognition_difference(good[good["kind"] == "original"])
    with pytest.raises(ValueError, match="missing: synthetic"):
        rate_correlation(style_rates(good)[["original"]])
    with pytest.raises(ValueError, match="two styles or more with rates of both kinds, got 1"):
        rate_correlation(rates(0.5, 5)[:1])
