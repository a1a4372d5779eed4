"""Each cell, each row and all rows together are as the columns, the tasks and the design say, or the fault is named."""

import re

import numpy as np
import pytest
from pandas.testing import assert_frame_equal

from eigenwalker._validation import WalkError
from eigenwalker.experiment.answers.cells import NAMES, parse_cell
from eigenwalker.experiment.answers.rows import AnswerRow, Faults, make_answers
from tests.experiment.answers.given_answers import answers_to, small_study


@pytest.fixture(scope="module")
def study():
    return small_study()


@pytest.fixture(scope="module")
def answers(study):
    return answers_to(study)


def _rows(answers, file="a.csv"):
    words = answers.astype(object).where(answers.notna(), "").astype(str)
    return [AnswerRow(file, f"line {number}", row) for number, row in enumerate(words.to_numpy().tolist(), start=2)]


def _first(answers, **cells):
    """Return the position of the first row that has some cells."""
    found = np.logical_and.reduce([answers[name] == value for name, value in cells.items()])
    return int(np.flatnonzero(found)[0])


def _with(rows, at, **cells):
    words = list(rows[at].words)
    for name, word in cells.items():
        words[NAMES.index(name)] = word
    return [*rows[:at], rows[at]._replace(words=words), *rows[at + 1 :]]


def _fault(rows, study=None):
    with pytest.raises(WalkError) as caught:
        make_answers(rows, Faults(), study)
    return str(caught.value)


def test_sound_rows_have_no_faults(study, answers):
    assert_frame_equal(make_answers(_rows(answers), Faults(), study), answers)
    assert_frame_equal(make_answers(_rows(answers)[::-1], Faults()), answers)


@pytest.mark.parametrize(
    ("column", "right", "wrong"),
    [
        ("study", ["ab12cd34ef56"], ["", "AB12CD34EF56", "ab12cd34ef5", "ab12cd34ef567", "1.23e+11"]),
        ("participant", ["1", "12"], ["0", "-1", "+1", "01", "1.0", "1e0", "", "one", "١", "1_0", "9" * 5000]),
        ("replays", ["0", "3"], ["-1", "", "2.5"]),
        ("task", ["rating", "pair"], ["", "Rating", "rating "]),
        ("part", ["main"], ["", "training"]),
        ("kind", ["", "original", "synthetic"], ["real"]),
        ("condition", ["", "static", "displacement"], ["moving"]),
        ("stimulus", ["anna", " "], ["", "an\nna", "an\0na", "\ud800"]),
        ("view", ["-30", "22.5", "1e1"], ["", "nan", "inf", "22,5", "frontal", "1e999", "0x10"]),
        ("response_time_s", ["0", "2.5", ""], ["-0.1", "2,5", "nan", "fast"]),
        ("shown_error_s", ["-0.1", ""], ["nan"]),
        ("refresh_hz", ["59.94", ""], ["0", "-60"]),
        (
            "answered_at",
            ["", "2026-11-23T10:00:00.000Z", "2024-02-29T23:59:59Z"],
            ["2026-11-23", "2026-13-01T10:00:00Z"],
        ),
        ("answered_at", [], ["2026-11-23T10:00:00.000", "2025-02-29T10:00:00.000Z", "23.11.2026 10:00"]),
    ],
)
def test_cells_are_of_their_kind_and_in_their_range(column, right, wrong):
    assert [word for word in right if parse_cell(column, word).value is None] == []
    assert [word for word in wrong if parse_cell(column, word).value is not None] == []
    assert all(parse_cell(column, word).wanted for word in wrong)


def test_a_cell_is_named_by_place_and_column(answers):
    rows = _with(_rows(answers), 3, view="front", visit="")
    assert _fault(rows) == (
        "2 faults:\n  a.csv, line 5: view: expected an azimuth in degrees, got 'front'\n"
        "  a.csv, line 5: visit: expected a whole number from 1, got nothing"
    )
    assert len(_fault(_with(_rows(answers), 3, view="x" * 10_000))) < 200


@pytest.mark.parametrize(
    ("task", "cells", "said"),
    [
        ("rating", {"answer": "7", "value": "7"}, "answer: expected one of 1, 2, 3, 4, 5, 6"),
        ("rating", {"answer": "2", "value": "3"}, "value: expected 2 for the answer '2', got 3"),
        ("rating", {"answer": "2", "value": ""}, "value: expected 2 for the answer '2', got nothing"),
        ("rating", {"answer": "", "value": "2"}, "value: expected nothing for the answer nothing, got 2"),
        ("rating", {"answered_at": ""}, "answered_at: expected a time such as 2026-11-23T10:00:00.000Z, got nothing"),
        ("rating", {"trait": ""}, "trait: expected a word in rating trials, got nothing"),
        ("rating", {"left": ""}, "left: expected a word in rating trials, got nothing"),
        ("rating", {"reference": "anna"}, "reference: expected nothing in rating trials, got 'anna'"),
        ("rating", {"expected": "4"}, "expected: expected nothing in main trials, got '4'"),
        ("rating", {"part": "attention"}, "expected: expected a word in attention trials, got nothing"),
        ("pair", {"answer": "5", "value": "5"}, "answer: expected one of 0, 1, 2, 3, 4"),
        ("pair", {"left": "anna"}, "left: expected '.*' or '.*', as in the pair, got 'anna'"),
        ("pair", {"reference": ""}, "reference: expected a word in pair trials, got nothing"),
        ("naturalness", {"answer": "true"}, "answer: expected one of real, synthetic, don't know"),
        ("naturalness", {"value": "1"}, "value: expected nothing for the answer .*, got 1"),
        ("recognition", {"left": "sad"}, "left: expected nothing in recognition trials, got 'sad'"),
        ("recognition", {"value": "0"}, "value: expected nothing for the answer .*, got 0"),
        ("resemblance", {"answer": "identical", "value": "3"}, "value: expected 4 for the answer 'identical', got 3"),
    ],
)
def test_cells_of_a_row_fit_together(answers, task, cells, said):
    at = _first(answers, task=task, part="main")
    assert re.search(rf"a\.csv, line {at + 2}: {said}", _fault(_with(_rows(answers), at, **cells)))


def test_a_style_that_no_button_has_needs_the_study(study, answers):
    rows = _with(_rows(answers), _first(answers, task="recognition"), answer="furious")
    assert len(make_answers(rows, Faults())) == len(answers)
    assert "answer: expected one of cool, very, sad, average walk, don't know, got 'furious'" in _fault(rows, study)


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        ({"participant": "40"}, "participant: expected one of the 2 of the study's design, got 40"),
        ({"trial": "999"}, "trial: expected one of participant 1, session 1 of the study's design, got 999"),
        ({"session": "9"}, "trial: expected one of participant 1, session 9 of the study's design, got 1"),
        ({"stimulus": "anna"}, "stimulus: expected '.*', as in the study's design, got 'anna'"),
        ({"view": "31"}, r"view: expected (0|22\.5), as in the study's design, got 31"),
        ({"left": "sad"}, "left: expected 'happy', as in the study's design, got 'sad'"),
        ({"style": ""}, "style: expected '.*', as in the study's design, got nothing"),
    ],
)
def test_rows_fit_the_design(study, answers, cells, said):
    assert re.search(f"a.csv, line 2: {said}", _fault(_with(_rows(answers), 0, **cells), study))


def test_answers_to_another_study_are_named_once_a_file(study, answers):
    other = _rows(answers.assign(study="0" * 12), "b.csv")
    assert _fault([*_rows(answers), *other]) == (
        f"b.csv, line 2: study: expected {study.id}, as in a.csv, line 2, got '000000000000'"
    )
    assert _fault(other, study) == f"b.csv, line 2: study: expected {study.id}, got '000000000000'"


def test_contradictions_name_both_places(answers):
    again = _with(_rows(answers, "b.csv"), 5, replays="99")
    said = r"replays: expected \d, as in a\.csv, line 7, of the same participant, session and trial, got 99"
    assert re.fullmatch(rf"b\.csv, line 7: {said}", _fault([*_rows(answers), *again]))


def test_numbers_may_be_written_otherwise_and_are_the_same(answers):
    again = [row._replace(words=[word.removesuffix(".0") for word in row.words]) for row in _rows(answers, "b.csv")]
    assert_frame_equal(make_answers([*_rows(answers), *again], Faults()), answers)
