"""Answers as trials: what is kept, what is left out and counted, and which answers are about the same walk."""

import pandas as pd
import pytest

from eigenwalker.experiment.analysis.trials import split_trials, trials_of
from tests.experiment.analysis.style_answers import STYLES, style_answers


@pytest.fixture
def answers():
    return style_answers("recognition", 3)


def test_columns_are_those_of_trials(answers):
    table = trials_of(answers, "recognition").table
    assert table.columns.tolist() == ["truth", "answer", "kind", "walk", "stimulus", "condition", "participant"]
    assert (table["truth"] == answers["style"]).all()
    assert (table["stimulus"] == answers["stimulus"]).all()


def test_other_tasks_and_parts_are_left_out(answers):
    others = [answers.assign(task="naturalness"), answers.assign(part="practice", session=0)]
    table = trials_of(pd.concat([answers, *others], ignore_index=True), "recognition").table
    pd.testing.assert_frame_equal(table, trials_of(answers, "recognition").table)


@pytest.mark.parametrize("nothing", ["", None])
def test_trials_without_an_answer_are_left_out_and_counted(answers, nothing):
    answers.loc[[0, 7], "answer"] = nothing
    found = trials_of(answers, "recognition")
    assert found.n_unanswered == 2
    assert len(found.table) == len(answers) - 2
    assert "52 answers of 3 participants about 18 walks, 2 trials without an answer." in found.in_words()


def test_attention_trials_are_counted_by_participant_and_nobody_is_left_out(answers):
    attention = pd.DataFrame(
        {
            "participant": [1, 1, 2, 2],
            "session": 2,
            "trial": [1, 2, 1, 2],
            "part": "attention",
            "task": "recognition",
            "style": "sad",
            "kind": "original",
            "expected": "cool",
            "answer": ["cool", "sad", "cool", ""],
        }
    )
    found = trials_of(pd.concat([answers.assign(expected=""), attention], ignore_index=True), "recognition")
    assert found.attention.to_dict("index") == {1: {"n_trials": 2, "n_failed": 1}, 2: {"n_trials": 1, "n_failed": 0}}
    assert len(found.table) == len(answers)
    assert found.in_words().endswith("Attention trials failed: by participant 1 (1 of 2).")


def test_attention_trials_that_nobody_failed_are_said_to_be_so(answers):
    attention = answers[:3].assign(part="attention", session=2, expected=answers["answer"][:3])
    found = trials_of(pd.concat([answers.assign(expected=""), attention], ignore_index=True), "recognition")
    assert found.in_words().endswith("Attention trials failed: none of 3.")


def test_walks_are_styles_where_each_style_has_one(answers):
    table = trials_of(answers, "recognition").table
    assert (table["walk"] == table["truth"]).all()


def test_walks_are_stimuli_where_a_style_has_several(answers):
    answers.loc[answers["participant"] == 1, "stimulus"] += "_2"
    table = trials_of(answers, "recognition").table
    assert (table["walk"] == table["stimulus"]).all()


def test_walks_are_stimuli_where_they_have_no_style(answers):
    table = trials_of(answers.assign(style=""), "recognition").table
    assert (table["walk"] == table["stimulus"]).all()


def test_participants_of_two_studies_are_two(answers):
    both = pd.concat([answers, answers.assign(study="ba9876543210")], ignore_index=True)
    table = trials_of(both, "recognition").table
    assert table["participant"].nunique() == 6
    assert table["participant"][0] == "0123456789ab 1"


def test_answers_without_anything_else_will_do():
    found = trials_of(
        pd.DataFrame({"task": ["pair"], "style": ["sad"], "kind": ["synthetic"], "answer": ["4"]}), "pair"
    )
    assert found.table.columns.tolist() == ["truth", "answer", "kind"]
    assert found.in_words() == "1 answer."


def test_parts_are_all_conditions_and_styles(answers):
    parts = split_trials(trials_of(answers, "recognition").table)
    assert list(parts) == [
        ("all", "all walks"),
        ("condition", "displacement"),
        ("condition", "static"),
        *(("style", style) for style in STYLES),
        ("style", "average walk"),
    ]
    for by in ("condition", "style"):
        assert sum(len(part) for name, part in parts.items() if name[0] == by) == len(answers)


def test_parts_of_styles_have_no_walks(answers):
    parts = split_trials(trials_of(answers, "recognition").table)
    assert [name for name, part in parts.items() if "walk" not in part] == [
        name for name in parts if name[0] == "style"
    ]


def test_walks_without_condition_or_style_are_in_no_such_part(answers):
    assert list(split_trials(trials_of(answers.assign(condition="", style=""), "recognition").table)) == [
        ("all", "all walks")
    ]


def test_errors(answers):
    with pytest.raises(TypeError, match="answers as a DataFrame, got list"):
        trials_of([1], "pair")
    with pytest.raises(ValueError, match=r"task must be one of .*'pair'.* got 'recall'"):
        trials_of(answers, "recall")
    with pytest.raises(ValueError, match="missing: style, kind"):
        trials_of(answers.drop(columns=["style", "kind"]), "recognition")
    with pytest.raises(ValueError, match="answers to the task 'pair', got none"):
        trials_of(answers, "pair")
    with pytest.raises(ValueError, match="got 1 more, first participant 1, session 1, trial 1; drop"):
        trials_of(pd.concat([answers, answers[:1]]), "recognition")
