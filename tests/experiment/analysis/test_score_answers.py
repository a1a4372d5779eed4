"""Scores beside the original: means of the papers, hand-computed ones, who gave them, words and pictures."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment import RESEMBLANCE, mean_resemblance, rate_interval
from eigenwalker.experiment.analysis.score_answers import pair_report, resemblance_report
from tests.experiment.analysis.style_answers import STYLES, style_answers


def scored(counts, task="pair", **columns):
    """Return answers of which so many are worth 0, 1, ..."""
    words = RESEMBLANCE if task == "resemblance" else [str(score) for score in range(len(counts))]
    said = np.repeat(words, counts)
    return pd.DataFrame({"task": task, "style": "sad", "kind": "synthetic", "answer": said, **columns})


@pytest.fixture(scope="module")
def report():
    return pair_report(style_answers("pair", 30))


def test_mean_of_tilmanne_and_dutoit():
    """2.91 of 390 evaluations; how they were spread is in a figure alone, here one way with that mean, 1135 / 390."""
    row = pair_report(scored((10, 25, 85, 140, 130))).means.loc[("all", "all walks")]
    assert row["n_answers"] == 390
    assert_allclose(row["mean"], 2.91, atol=0.005)
    assert_allclose(row["high"] - row["mean"], 1.966 * row["sd"] / np.sqrt(390), rtol=1e-3)


def test_mean_of_tilmanne_moinet_and_dutoit():
    """3.15 of 865 comparisons, here 2725 / 865; "identical" is the most chosen, and the interval is the plain one."""
    answers = scored((10, 40, 130, 315, 370), "resemblance")
    report = resemblance_report(answers)
    row = report.means.loc[("all", "all walks")]
    assert_allclose(row["mean"], 3.15, atol=0.005)
    assert_allclose(row[["mean", "low", "high"]], mean_resemblance(answers["answer"]))
    shares = report.shares.loc[("all", "all walks")]
    assert shares.index.tolist() == list(RESEMBLANCE)
    assert shares["n_answers"].tolist() == [10, 40, 130, 315, 370]
    assert_allclose(shares.loc["identical", ["share", "low", "high"]], rate_interval(answers["answer"] == "identical"))


def test_hand_computed_means_of_participants():
    """Two participants of means 3 and 1: mean 2, standard error 1, and t with one degree of freedom is 1 at 50 %."""
    answers = scored((0, 2, 0, 2, 0), participant=[1, 1, 2, 2])
    row = pair_report(answers, level=0.5).means.loc[("style", "sad")]
    assert_allclose(row[["mean", "low", "high"]], [2.0, 1.0, 3.0])


def test_one_participant_leaves_means_open():
    row = pair_report(scored((0, 1, 2, 1, 0), participant=1)).means.loc[("all", "all walks")]
    assert row[["mean", "low", "high"]].tolist() == [2.0, 0.0, 4.0]


def test_one_answer_has_no_standard_deviation():
    assert np.isnan(pair_report(scored((0, 0, 1))).means["sd"]).all()


def test_what_is_planted_is_found(report):
    """Scores are binomial with shares 0.5, 0.6, 0.7 and 0.8: means 2.0, 2.4, 2.8 and 3.2, two steps of 0.4 away."""
    means = report.means.loc["style"]
    assert means.index.tolist() == list(STYLES)
    assert (means["mean"] - [2.0, 2.4, 2.8, 3.2]).abs().max() < 0.4  # 60 answers: standard errors of 0.13
    assert (means["low"] < means["mean"]).all()
    assert (means["mean"] < means["high"]).all()
    assert_allclose(report.means.loc[("all", "all walks"), "mean"], means["mean"].mean())


def test_means_are_those_of_shares(report):
    shares = report.shares
    means = (shares["score"] * shares["share"]).groupby(level=["by", "group"], sort=False).sum()
    assert_allclose(means, report.means["mean"])


def test_styles_that_differ_leave_all_walks_open(report):
    """Four styles are few to say what others would get; each of them is known better."""
    widths = report.means["high"] - report.means["low"]
    assert widths[("all", "all walks")] > widths.loc["style"].max()


def test_a_scale_may_have_other_scores():
    report = pair_report(scored((1, 2, 3)), scale=("worse", "", "as good"))
    assert report.shares.loc[("all", "all walks"), "score"].tolist() == [0, 1, 2]
    assert report.means["high"].max() <= 2
    assert str(report).startswith("Naturalness beside the original: scores, 0 (worse) to 2 (as good)")


def test_the_report_in_words(report):
    lines = str(report).splitlines()
    assert "240 answers of 30 participants about 8 walks." in lines
    assert any(line.startswith("all walks") for line in lines)
    assert max(map(len, lines)) < 160
    resemblance = str(resemblance_report(style_answers("resemblance", 5)))
    assert "nothing in common" in resemblance
    assert "0 (nothing in common) to 4 (identical)" in resemblance


def test_mean_resemblance_of_the_paper():
    """865 answers of a mean of 3.15; how they were spread is in a figure alone, here over two answers."""
    answers = [RESEMBLANCE[4]] * 130 + [RESEMBLANCE[3]] * 735
    found = mean_resemblance(answers)
    assert_allclose(found.value, 3.15, atol=0.005)
    assert found.low < found.value < found.high


def test_mean_resemblance_hand_computed():
    """Of 4 and 2: mean 3, standard error 1, and t with one degree of freedom is 12.7; of 1 and 3 at 50 % it is 1."""
    assert_allclose(mean_resemblance(["identical", "different"]), (3.0, 0.0, 4.0))
    assert_allclose(mean_resemblance(["very different", "slightly different"], level=0.5), (2.0, 1.0, 3.0), atol=1e-9)


def test_one_answer_leaves_all_open():
    assert mean_resemblance(["identical"]) == (4.0, 0.0, 4.0)


def test_pictures(report):
    names = [label.get_text() for label in report.plot_scores().ax_.get_yticklabels()]
    assert names == list(STYLES)
    ax = report.plot_means(sort=True).ax_
    assert [label.get_text() for label in ax.get_yticklabels()] == list(STYLES[::-1])
    assert ax.get_legend().get_texts()[0].get_text().startswith("overall mean, ")
    labels = [label.get_text() for label in report.plot_shares(xlabel="score").ax_.get_xticklabels()]
    assert labels == ["0", "1", "2", "3", "4"]


def test_walks_without_styles_have_no_pictures_of_styles():
    report = pair_report(style_answers("pair", 3).assign(style=""))
    assert report.means.index.get_level_values("by").unique().tolist() == ["all", "condition"]
    for draw in (report.plot_means, report.plot_scores):
        with pytest.raises(ValueError, match="none of the walks has one"):
            draw()


def test_errors():
    with pytest.raises(ValueError, match="got the same"):
        mean_resemblance(["the same", "identical"])
    with pytest.raises(ValueError, match="none at all"):
        mean_resemblance([])
    with pytest.raises(ValueError, match="answers out of 0, 1, 2, 3, 4, got 5"):
        pair_report(scored((0, 0, 0, 0, 0, 2)))
    with pytest.raises(ValueError, match="got alike"):
        resemblance_report(scored((1, 0, 0, 0, 0), "resemblance").assign(answer="alike"))
    with pytest.raises(ValueError, match="answers to the task 'resemblance', got none"):
        resemblance_report(scored((1, 1)))
