"""Naturalness: the paper's figures, what is planted is found, and the report in words and pictures."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment.analysis.naturalness_answers import naturalness_report
from tests.experiment.analysis.style_answers import STYLES, paper_naturalness, style_answers


@pytest.fixture(scope="module")
def report():
    return naturalness_report(style_answers("naturalness", 30))


def test_figure_5_of_the_paper():
    """65.45 and 50.39 % of 246 and 254 walks are "real", 2.44 and 6.69 % "I don't know"; plain Wilson intervals."""
    shares = naturalness_report(paper_naturalness()).shares.loc[("all", "all walks")]
    assert_allclose(shares.xs("real", level="answer")["share"], [0.6545, 0.5039], atol=5e-5)
    assert_allclose(shares.xs("don't know", level="answer")["share"], [0.0244, 0.0669], atol=5e-5)
    assert shares["n_trials"].unique().tolist() == [246, 254]
    assert_allclose(shares.loc[("original", "real"), ["low", "high"]], [0.5931, 0.7111], atol=5e-5)


def test_difference_of_the_paper():
    """ "15 % less": 15.05 points, from 6.4 to 23.4 by Newcombe's method 10."""
    found = naturalness_report(paper_naturalness()).differences.loc[("all", "all walks")]
    assert_allclose(found, [0.1505, 0.0643, 0.2337], atol=5e-4)


def test_what_is_planted_is_found(report):
    difference, low, high = report.differences.loc[("all", "all walks")]
    assert low < 0.15 < high
    assert low < difference < high
    assert high - low < 0.3


def test_tables_have_all_conditions_styles_kinds_and_answers(report):
    assert report.shares.index.names == ["by", "group", "kind", "answer"]
    assert report.shares.loc["condition"].index.get_level_values(0).unique().tolist() == ["displacement", "static"]
    assert report.shares.loc["style"].index.get_level_values(0).unique().tolist() == [*STYLES, "average walk"]
    assert ("average walk", "original") not in report.shares.loc["style"].index.droplevel("answer")
    assert report.differences.loc["style"].index.tolist() == list(STYLES)


def test_shares_of_a_kind_add_up_to_one(report):
    assert_allclose(report.shares.groupby(level=["by", "group", "kind"])["share"].sum(), 1.0)


def test_participants_and_walks_make_intervals_wider():
    """Five participants who say one thing each are five answers, not ninety."""
    answers = style_answers("naturalness", 5)
    answers["answer"] = np.where(answers["participant"] > 2, "real", "synthetic")
    alone = naturalness_report(answers.drop(columns=["participant", "stimulus"]))
    known = naturalness_report(answers)
    ratio = known.shares.eval("high - low") / alone.shares.eval("high - low")
    assert ratio.loc[("all", "all walks", "original", "real")] > 2
    assert ratio.loc[("style", "sad", "original", "real")] > 1.2  # 10 answers each


def test_styles_are_about_their_own_walks():
    """A style has two videos: what is said of it depends on participants alone."""
    answers = style_answers("naturalness", 15)
    without = naturalness_report(answers.drop(columns="stimulus"))
    shares = naturalness_report(answers).shares
    assert_allclose(shares.loc["style"], without.shares.loc["style"])
    assert not np.allclose(shares.loc["all"], without.shares.loc["all"])


def test_one_kind_alone_has_no_differences():
    answers = style_answers("naturalness", 5).query("kind == 'original'")
    report = naturalness_report(answers)
    assert len(report.differences) == 0
    assert "percentage points" not in str(report)


def test_the_report_in_words(report):
    lines = str(report).splitlines()
    assert lines[0] == "Naturalness: what walks were taken for, in percent"
    assert "540 answers of 30 participants about 18 walks." in lines
    assert any(line.startswith("all walks, original ") and " [" in line for line in lines)
    assert 'Taken for "real", in percentage points' in lines
    assert max(map(len, lines)) < 160
    assert repr(report) == str(report)


def test_the_picture_has_both_kinds(report):
    ax = report.plot_shares(ylabel="of 100 answers").ax_
    assert ax.get_ylabel() == "of 100 answers"
    assert [text.get_text().split(",")[0] for text in ax.get_legend().get_texts()] == ["original", "synthetic"]


def test_errors():
    answers = style_answers("naturalness", 2)
    with pytest.raises(ValueError, match="got natural"):
        naturalness_report(answers.assign(answer="natural"))
    with pytest.raises(ValueError, match="original and synthetic, got an empty one"):
        naturalness_report(answers.assign(kind=""))
    with pytest.raises(ValueError, match="answers to the task 'naturalness', got none"):
        naturalness_report(answers.assign(task="pair"))
