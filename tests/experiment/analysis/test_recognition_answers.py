"""Recognition by people: efficiency and conditions of the paper, chance, confusions, and pairs of walks."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment import confusion_tables, recognition_table
from eigenwalker.experiment.analysis.recognition_answers import recognition_report
from tests.experiment.analysis.style_answers import STYLES, style_answers


@pytest.fixture(scope="module")
def answers():
    return style_answers("recognition", 30)


@pytest.fixture(scope="module")
def report(answers):
    return recognition_report(answers)


def test_efficiency_of_the_paper():
    """Eq. 16: 47.6 and 37.15 % of 13 answers are 6.19 and 4.83 times chance; the text's rates 5.97 and 5.06."""
    for rates, wanted in (((4760, 3715), (6.19, 4.83)), ((4590, 3893), (5.97, 5.06))):
        right = np.concatenate([np.arange(10000) < rate for rate in rates])
        table = pd.DataFrame({"kind": np.repeat(["original", "synthetic"], 10000), "style": "sad"})
        table = table.assign(task="recognition", answer=np.where(right, "sad", "cool"))
        found = recognition_report(table, n_choices=13).rates.loc[("all", "all walks")]
        assert_allclose(found["efficiency"], wanted, atol=0.005)
        assert_allclose(found["chance"], 0.0769, atol=5e-5)


def test_choices_of_the_paper_are_thirteen():
    """Eleven styles, "average walk" and "I don't know", whether or not anybody chose these."""
    styles = [f"style {number}" for number in range(11)]
    table = pd.DataFrame({"task": "recognition", "kind": "original", "style": styles, "answer": styles})
    assert recognition_report(table).n_choices == 13


def test_styles_that_nobody_answered_about_are_choices(answers):
    unanswered = answers.assign(answer=np.where(answers["style"] == "sad", "", answers["answer"]))
    kept = unanswered[unanswered["answer"] != "sad"]
    assert recognition_report(kept).n_choices == len(STYLES) + 2


def test_conditions_are_those_of_table_3(answers, report):
    rates = report.rates.loc["condition"]
    assert rates.index.tolist() == [
        (condition, kind) for condition in ("displacement", "static") for kind in ("original", "synthetic")
    ]
    right = answers["answer"] == answers["style"]
    assert_allclose(rates["rate"], right.groupby([answers["condition"], answers["kind"]]).mean())


def test_rates_are_those_of_the_table_of_trials(report):
    table = recognition_table(report.trials.table, n_choices=6)
    pd.testing.assert_frame_equal(report.rates.loc[("all", "all walks")], table)


def test_the_average_walk_is_a_style_of_one_kind(report):
    assert report.rates.loc[("style", "average walk")].index.tolist() == ["synthetic"]
    assert "average walk" not in report.differences.loc["style"].index
    assert report.confusions["synthetic"].index.tolist() == [*STYLES, "average walk"]
    assert report.confusions["synthetic"].columns.tolist() == [*STYLES, "average walk", "don't know"]
    assert report.confusions["original"].loc["average walk"].isna().all()


def test_confusions_are_those_of_trials_in_another_order(report):
    tables = confusion_tables(report.trials.table)
    for kind, table in report.confusions.items():
        pd.testing.assert_frame_equal(table, tables[kind].loc[table.index, table.columns])


def test_walks_of_a_style_are_pairs():
    """Styles that are always or never recognized, in both kinds: much is open about others, but not the difference."""
    answers = style_answers("recognition", 20)
    easy = answers["style"].isin(["sad", "cool", "average walk"])
    answers["answer"] = np.where(easy, answers["style"], "don't know")
    answers = answers[answers["style"] != "average walk"]
    found = recognition_report(answers)
    difference, low, high = found.differences.loc[("all", "all walks")]
    assert difference == 0
    assert high - low < 0.25
    rates = found.rates.loc[("all", "all walks")]
    assert (rates["high"] - rates["low"] > 0.6).all()  # four styles are not many


def test_correlation_is_over_styles_of_both_kinds(report):
    rates = report.rates.loc["style", "rate"].unstack("kind").dropna()
    assert len(rates) == len(STYLES)
    assert_allclose(report.correlation.value, np.corrcoef(rates["original"], rates["synthetic"])[0, 1])
    assert f"over {len(STYLES)} styles: {report.correlation.value:.2f} [" in str(report)


def test_one_kind_alone_has_neither_correlation_nor_differences(answers):
    report = recognition_report(answers.query("kind == 'original'"))
    assert np.isnan(report.correlation).all()
    assert len(report.differences) == 0
    assert "Correlation" not in str(report)
    assert len(report.plot_confusions().axes_) == 1


def test_the_report_in_words(report):
    text = str(report)
    assert "Chance is 16.67 %, one of 6 answers" in text
    assert "all walks, original less synthetic" in text
    assert text.count("average walk  ") == 1
    assert max(map(len, text.splitlines())) < 160


def test_what_a_style_is_seen_as_most(answers):
    """Afraid walks are called cool where they are not recognized, and manly ones nothing else."""
    table = pd.DataFrame({"style": "afraid", "answer": ["afraid", "cool", "cool", "sad"]})
    sure = pd.DataFrame({"style": "manly", "answer": ["manly"] * 4})
    both = pd.concat([table, sure]).assign(task="recognition", kind="original")
    lines = str(recognition_report(both)).splitlines()
    assert next(line for line in lines if line.startswith("afraid")).endswith("cool 50")
    assert next(line for line in lines if line.startswith("manly")).endswith("-")


def test_pictures(report):
    ax = report.plot_rates(sort=True).ax_
    names = [label.get_text() for label in ax.get_yticklabels()]
    original = report.rates["rate"].xs("original", level="kind").loc["style"].sort_values(ascending=False)
    assert names == [*original.index, "average walk"]
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend == ["chance, 1 of 6", "original", "synthetic"]
    assert [panel.get_title() for panel in report.plot_confusions().axes_] == ["original", "synthetic"]


def test_errors(answers):
    with pytest.raises(ValueError, match="n_choices must be at least the 6 different answers that were given, got 4"):
        recognition_report(answers, n_choices=4)
    with pytest.raises(ValueError, match="30 are about walks without one"):
        recognition_report(answers.assign(style=answers["style"].where(answers["stimulus"] != "average_static", "")))
