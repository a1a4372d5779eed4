"""Answers come back as they were given, whatever file they come in; what is wrong is said, with its place."""

import csv
import io
import warnings
from random import Random

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pandas.testing import assert_frame_equal

from eigenwalker._validation import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS
from eigenwalker.experiment.answers.files import read_answers, write_answers
from eigenwalker.experiment.answers.psych_ds import check_dataset
from eigenwalker.experiment.study import make_study
from eigenwalker.experiment.tasks import RatingTask
from tests.experiment.answers.given_answers import answers_to, as_lines, as_table, small_study
from tests.mutations import mutate_json, mutate_text

COLUMNS = list(ANSWER_COLUMNS)
WORDS = ["participant", "session", "trial", "stimulus", "style", "answer", "visit", "answered_at"]


@pytest.fixture(scope="module")
def study():
    return small_study()


@pytest.fixture(scope="module")
def answers(study):
    return answers_to(study)


def _put(folder, data, name="answers.csv"):
    path = folder / name
    path.write_bytes(data)
    return path


def _changed(answers, row, **cells):
    """Return answers with other cells in one row, as text."""
    table = answers.astype(object).copy()
    for name, value in cells.items():
        table.loc[row, name] = value
    return as_table(table)


# ---- laws


@pytest.mark.parametrize("how", [as_table, as_lines])
def test_what_is_read_is_what_was_given(study, answers, tmp_path, how):
    path = _put(tmp_path, how(answers), "answers.csv" if how is as_table else "jatos_results.txt")
    assert_frame_equal(read_answers(path), answers)
    assert_frame_equal(read_answers(str(path), study=study), answers)


def test_writing_and_reading_gives_the_same(study, answers, tmp_path):
    paths = write_answers(answers, tmp_path)
    assert [path.name for path in paths[:2]] == [
        "participant-1_task-rating_data.csv",
        "participant-1_task-pair_data.csv",
    ]
    assert_frame_equal(read_answers(tmp_path, study=study), answers)
    assert check_dataset(tmp_path) == []


@settings(max_examples=30, deadline=None)
@given(st.data())
def test_any_number_and_any_name_survive_writing(tmp_path_factory, answers, data):
    folder = tmp_path_factory.mktemp("written")
    rated = answers[answers["task"] == "recognition"].head(3).copy()
    names = st.text(st.characters(blacklist_categories=["Cs"], blacklist_characters="\0\r\n"), min_size=1, max_size=9)
    numbers = st.floats(0, 1e9, exclude_min=True) | st.just(np.nan)
    for column in ("stimulus", "style", "answer"):
        rated[column] = pd.Series([data.draw(names) for _ in rated.index], index=rated.index, dtype="str")
    for column in ("response_time_s", "shown_s", "refresh_hz", "pixel_ratio"):
        rated[column] = [data.draw(numbers) for _ in rated.index]
    write_answers(rated, folder)
    assert_frame_equal(read_answers(folder), rated.reset_index(drop=True))


def test_rows_are_in_order_and_repetitions_are_gone(study, answers, tmp_path):
    shuffled = answers.sample(frac=1, random_state=3)
    paths = [
        _put(tmp_path, as_table(shuffled), "a.csv"),
        _put(tmp_path, as_table(answers.head(7)), "b.csv"),
        _put(tmp_path, as_lines(pd.concat([answers, answers.tail(3)])), "c.txt"),
    ]
    assert_frame_equal(read_answers(paths, study=study), answers)
    assert_frame_equal(read_answers(tmp_path), answers)


def test_types_do_not_depend_on_what_is_empty(answers, tmp_path):
    recognized = answers[answers["task"] == "recognition"].head(1)
    read = read_answers(_put(tmp_path, as_table(recognized)))
    assert read.dtypes.to_dict() == answers.dtypes.to_dict()
    assert np.isnan(read["value"][0])
    assert read["trait"][0] == ""


@pytest.mark.parametrize(
    "change",
    [
        lambda data: b"\xef\xbb\xbf" + data,
        lambda data: data.replace(b"\n", b"\r\n"),
        lambda data: data.rstrip(b"\n"),
        lambda data: data.replace(b"\n", b"\n\n") + b"\n\n",
        lambda data: data.replace(b",main,", b',"main",'),
    ],
)
def test_harmless_changes_change_nothing(answers, tmp_path, change):
    assert_frame_equal(read_answers(_put(tmp_path, change(as_table(answers)))), answers)


def test_columns_may_stand_in_another_order(answers, tmp_path):
    turned = as_table(answers[COLUMNS[::-1]])
    assert_frame_equal(read_answers(_put(tmp_path, turned)), answers)


def test_an_unanswered_trial_is_a_row_without_an_answer(answers, study, tmp_path):
    empty = answers.copy()
    empty.loc[4, ["answer", "answered_at"]] = ""
    empty.loc[4, ["value", "response_time_s", "shown_s"]] = np.nan
    assert_frame_equal(read_answers(_put(tmp_path, as_table(empty)), study=study), empty)


# ---- folders


def test_a_folder_is_read_with_all_kinds_of_files(study, answers, tmp_path):
    data = tmp_path / "data"
    (data / "first").mkdir(parents=True)
    (data / "raw").mkdir()
    (data / "study_result_1" / "comp-result_2" / "files").mkdir(parents=True)
    _put(data / "first", as_table(answers.head(10)), "study-1_participant-1_data.csv")
    _put(data / "study_result_1" / "comp-result_2", as_lines(answers.tail(-10)), "data.txt")
    _put(data / "study_result_1" / "comp-result_2" / "files", b"anything", "log.txt")
    _put(data / "raw", b"anything", "notes.csv")
    _put(data, b"anything", ".hidden.csv")
    _put(data, b"{}", "first_data.json")
    _put(tmp_path, b"a,b\n", "design.csv")  # beside the data
    assert_frame_equal(read_answers(tmp_path, study=study), answers)


def test_an_empty_result_of_a_closed_page_is_no_fault(answers, tmp_path):
    (tmp_path / "comp-result_1").mkdir()
    _put(tmp_path / "comp-result_1", b"", "data.txt")
    _put(tmp_path, as_table(answers))
    assert_frame_equal(read_answers(tmp_path), answers)


def test_a_spreadsheet_among_the_answers_is_not_passed_over(answers, tmp_path):
    _put(tmp_path, as_table(answers))
    _put(tmp_path, b"PK\3\4", "participant 3.xlsx")
    with pytest.raises(WalkError, match=r"participant 3\.xlsx: expected answers as CSV, got a spreadsheet"):
        read_answers(tmp_path)


@pytest.mark.parametrize("source", ["empty", []])
def test_no_answers_are_an_error(tmp_path, source):
    (tmp_path / "empty" / "data").mkdir(parents=True)
    with pytest.raises(WalkError, match="expected at least one answer, got none"):
        read_answers(tmp_path / source if source else source)


def test_a_header_alone_has_no_answers(answers, tmp_path):
    with pytest.raises(WalkError, match="expected at least one answer"):
        read_answers(_put(tmp_path, as_table(answers.head(0))))


def test_a_missing_file_is_that(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_answers(tmp_path / "gone.csv")


# ---- faults of files


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda _: b"", r"line 1: expected a header, study, participant, .*got an empty file"),
        (lambda _: b"\n \n", r"line 1: expected a header, .*got an empty file"),
        (lambda data: data[:-30], r"line 41: expected 28 cells, got \d+; the file seems to be cut off"),
        (lambda data: data[:-3], r"line 41: answered_at: expected a time such as .*, got '2026-11-23T10:00:39.12'"),
        (lambda data: data.replace(b"main", b"ma\0in", 1), r"line 2: .*binary data \(a zero byte\)"),
        (lambda data: data.replace(b"main", b"ma\xefin", 1), r"line 2: expected UTF-8 text, got byte 0xef"),
        (lambda data: data.decode().encode("utf-16"), r"line 1: expected UTF-8, got UTF-16 of a spreadsheet"),
        (lambda data: data.replace(b",", b";"), r"line 1: expected columns with commas between them, got ';': take"),
        (lambda data: data.replace(b",", b"\t"), r"line 1: expected columns with commas between them, got '\\t'"),
        (lambda data: b"sep=,\n" + data, r"line 1: expected columns with commas"),
        (lambda data: data.replace(b",59.94,", b',"59,94",'), r"line 2: refresh_hz: .*put a decimal comma"),
        (lambda data: data.replace(b",main,", b',"main,', 1), r"line 2: expected cells with commas between them, but"),
        (lambda data: data.replace(b"visit", b"Visit", 1), r"line 1: .*without visit and with the unknown 'Visit'"),
        (lambda data: data.replace(b"visit", b"view", 1), r"line 1: .*without visit and with twice 'view'"),
        (lambda data: data.partition(b"\n")[2], r"line 1: expected the columns of answers, .*without study"),
        (lambda _: b"a," * 200_000, r"line 1: .*with the unknown 'a', nothing and with twice 'a'"),
        (lambda _: b"PK\3\4 something", r"expected a whole archive without a password, got BadZipFile"),
    ],
)
def test_faults_of_tables_are_named_with_file_and_line(answers, tmp_path, change, said):
    with pytest.raises(WalkError, match=r"answers\.csv(, )?.*" + said):
        read_answers(_put(tmp_path, change(as_table(answers))))


def test_faults_of_several_files_come_together(answers, tmp_path):
    _put(tmp_path, b"", "a.csv")
    _put(tmp_path, as_table(answers).replace(b",", b";"), "b.csv")
    _put(tmp_path, as_table(answers)[:-20], "c.csv")
    with pytest.raises(WalkError, match=r"(?s)3 faults:.*a\.csv, line 1: .*b\.csv, line 1: .*c\.csv, line 41: "):
        read_answers(tmp_path)


def test_ten_faults_are_shown_and_the_others_counted(answers, tmp_path):
    wrong = answers.assign(visit=0)
    with pytest.raises(WalkError, match=r"(?s)^40 faults:(\n  [^\n]*line \d+: visit: [^\n]*){10}\n  and 30 more$"):
        read_answers(_put(tmp_path, as_table(wrong)))


# ---- writing


def test_what_is_written_is_checked(answers, tmp_path):
    with pytest.raises(TypeError, match="expected answers as a DataFrame, got list"):
        write_answers([answers], tmp_path)
    with pytest.raises(WalkError, match=r"the answers: expected the columns of answers, .*without visit"):
        write_answers(answers.drop(columns="visit"), tmp_path)
    with pytest.raises(WalkError, match=r"the answers: expected the columns of answers, .*without study"):
        write_answers(pd.DataFrame(), tmp_path)
    with pytest.raises(WalkError, match=r"the answers, row 3: value: expected 2 for the answer '2', got 9"):
        write_answers(
            answers.assign(value=answers["value"].where(answers.index != 3, 9)).assign(
                answer=answers["answer"].where(answers.index != 3, "2")
            ),
            tmp_path,
        )
    assert not list(tmp_path.iterdir())


def test_a_table_is_only_replaced_by_one_with_all_its_answers(answers, tmp_path):
    write_answers(answers, tmp_path)
    write_answers(answers, tmp_path)
    lost = answers.drop(index=3)
    with pytest.raises(WalkError, match=r"participant-1_task-rating_data\.csv: expected all of its answers among"):
        write_answers(lost, tmp_path)
    assert len(read_answers(tmp_path)) == len(answers)


def test_a_description_that_is_there_stays(answers, study, tmp_path):
    write_answers(answers, tmp_path)
    assert '"Answers of a perception study of walks"' in (tmp_path / "dataset_description.json").read_text()
    (tmp_path / "dataset_description.json").write_text("{}")
    write_answers(answers, tmp_path)
    assert (tmp_path / "dataset_description.json").read_text() == "{}"
    assert not list(tmp_path.rglob("*.part"))


def test_other_numbers_of_buttons_need_the_study(tmp_path):
    walks = make_walkers(3, random_state=0).data
    study = make_study(RatingTask(n_buttons=9, views=(0,)), walks=walks, n_participants=2, random_state=0)
    answers = answers_to(study)
    answers.loc[0, ["answer", "value"]] = "8", 8.0
    path = _put(tmp_path, as_table(answers))
    assert_frame_equal(read_answers(path, study=study), answers)
    with pytest.raises(WalkError, match=r"line 2: answer: expected one of 1, 2, 3, 4, 5, 6 \(if .*pass study"):
        read_answers(path)
    assert write_answers(answers, tmp_path / "out", study=study)


# ---- whatever comes


def _plain_reading(data):
    """Return the rows of a table as another reader has them."""
    rows = list(csv.reader(io.StringIO(data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n"))))
    rows = [row for row in rows if "".join(row).strip()]
    return [dict(zip(rows[0], row, strict=True)) for row in rows[1:]]


def _read_quietly(path, study):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return read_answers(path, study=study)
        except WalkError:
            return None


@pytest.mark.parametrize("ending", [".csv", ".txt"])
def test_damaged_files_give_errors_or_what_stands_in_them(study, answers, tmp_path, ending):
    sound = as_table(answers) if ending == ".csv" else as_lines(answers)
    mutate = mutate_text if ending == ".csv" else mutate_json
    n_read = 0
    for number in range(250):
        random = Random(f"answers {ending} {number}")
        data = mutate(random, sound)[: 2**21]
        path = _put(tmp_path, data, f"answers{ending}")
        read = _read_quietly(path, study if number % 2 else None)
        if read is None:
            continue
        n_read += 1
        assert not read.duplicated(["participant", "session", "trial"]).any()
        if number % 2:  # only what the design has, and answers that its buttons give
            merged = read.merge(study.design, on=list(study.design.columns))
            assert len(merged) == len(read)
        if ending == ".csv":
            stands = _plain_reading(data)
            words = {tuple(row[name] for name in WORDS) for row in stands}
            assert len(read) <= len(stands)
            assert set(map(tuple, read[WORDS].astype(str).to_numpy())) <= words
    assert 12 < n_read < 238  # mutations neither all too mild nor all too harsh
