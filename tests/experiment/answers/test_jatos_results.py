"""Results of JATOS, as it exports them: text with an object a trial, and archives of such texts."""

import io
import json
import zipfile
from random import Random

import pytest
from pandas.testing import assert_frame_equal

from eigenwalker._validation import WalkError
from eigenwalker.experiment.answers.files import read_answers
from eigenwalker.experiment.answers.jatos_results import is_result, is_upload
from tests.binary_mutations import flip_bytes
from tests.experiment.answers.given_answers import answers_to, as_lines, small_study


@pytest.fixture(scope="module")
def study():
    return small_study()


@pytest.fixture(scope="module")
def answers(study):
    return answers_to(study)


def _put(folder, data, name="jatos_results.txt"):
    path = folder / name
    path.write_bytes(data)
    return path


def _archive(parts):
    """Return an archive as JATOS exports it: data of each run, an uploaded file, and metadata at the end."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
        results = [{"id": 1, "componentResults": [{"id": 11, "path": "/study_result_1/comp-result_11"}]}]
        archive.writestr("metadata.json", json.dumps({"data": [{"studyId": 3, "studyResults": results}]}))
    return stream.getvalue()


def _runs(answers):
    halves = [answers[answers["participant"] == number] for number in (1, 2)]
    return {
        "study_result_1/comp-result_11/data.txt": as_lines(halves[0]),
        "study_result_1/comp-result_11/files/picture.txt": b"anything",
        "study_result_2/comp_result_12/data.txt": as_lines(halves[1]),  # as the handbook writes it
        "study_result_3/comp-result_13/data.txt": b"",
    }


@pytest.mark.parametrize("name", ["jatos_results_20261123.zip", "results.jrzip", "results"])
def test_an_archive_holds_the_answers_of_all_runs(study, answers, tmp_path, name):
    assert_frame_equal(read_answers(_put(tmp_path, _archive(_runs(answers)), name), study=study), answers)


def test_an_archive_and_what_it_unpacks_to_are_the_same(study, answers, tmp_path):
    path = _put(tmp_path, _archive(_runs(answers)), "results.zip")
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path / "unpacked")
    assert_frame_equal(read_answers(tmp_path / "unpacked", study=study), answers)
    assert_frame_equal(read_answers(tmp_path), answers)  # both together


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data.replace(b"}\n", b"}\n\n"),  # between the data of two runs JATOS puts an end of line
        lambda data: data.replace(b"}\n", b"}\r\n"),
        lambda data: data.replace(b"}\n", b"}"),  # appended without one
        lambda data: data.replace(b"}\n", b"} \n "),  # spaces keep a slow download alive
        lambda data: data + data[: data.index(b"\n") + 1],  # sent again after a reload
        lambda data: b"\xef\xbb\xbf" + data,
    ],
)
def test_objects_are_read_however_they_are_put_together(study, answers, tmp_path, change):
    assert_frame_equal(read_answers(_put(tmp_path, change(as_lines(answers))), study=study), answers)


def test_names_of_entries():
    assert is_result("study_result_1/comp-result_12/data.txt")
    assert is_result("comp_result_12/data.txt")
    assert not is_result("study_result_1/comp-result_12/files/data.txt")
    assert not is_result("study_result_1/data.txt")
    assert is_upload("a/study_result_1/comp-result_12/files/data.txt")
    assert not is_upload("files/participant-1_data.csv")


def _replaced(old, new):
    return lambda data: data.replace(old, new, 1)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda _: b" \n", r"line 1: expected a JSON object a line, got an empty file"),
        (lambda data: data[:-20], r"line 40: expected a JSON object, got what is none, '\{\"study\".*cut off"),
        (lambda data: data + b"[1]\n", r"line 41: expected a JSON object, got something else, '\[1\]'"),
        (lambda _: b"{}" * 20_000, r"line 1: expected an answer with the keys study, .*got one without study"),
        (lambda data: data + b"[" * 100_000, r"line 41: expected a JSON object, got what is none"),
        (_replaced(b'"visit": 1', b'"visits": 1'), r"line 1: .*one without visit and with the unknown 'visits'"),
        (_replaced(b'"visit": 1', b'"visit": "1"'), r"line 1: visit: expected a number, got the text '1'"),
        (_replaced(b'"visit": 1', b'"visit": true'), r"line 1: visit: expected a number, got true"),
        (_replaced(b'"visit": 1', b'"visit": null'), r"line 1: visit: expected a number, got null"),
        (_replaced(b'"visit": 1', b'"visit": 1.5'), r"line 1: visit: expected a whole number from 1, got '1.5'"),
        (_replaced(b'"visit": 1', b'"visit": [1]'), r"line 1: visit: expected a number, got a list"),
        (_replaced(b'"visit": 1', b'"visit": 1, "visit": 2'), r"line 1: .*got one with a key twice"),
        (_replaced(b'"shown_s": 7.0', b'"shown_s": NaN'), r"line 1: .*got one with the number NaN"),
        (_replaced(b'"shown_s": 7.0', b'"shown_s": 1e999'), r"line 1: shown_s: expected a number .*got '1e999'"),
        (_replaced(b'"shown_s": 7.0', b'"shown_s": ' + b"9" * 9000), r"line 1: shown_s: expected a number"),
        (_replaced(b'"part": "main"', b'"part": 1'), r"line 1: part: expected text, got the number 1"),
        (_replaced(b'"part": "main"', b'"part": null'), r"line 1: part: expected text, got null"),
        (_replaced(b'"style": "', b'"style": "\\ud800'), r"line 1: style: expected text in one line"),
        (_replaced(b"main", b"ma\xefin"), r"line 1: expected UTF-8 text"),
        (lambda data: data.decode().encode("utf-16"), r"line 1: .*zero byte"),
    ],
)
def test_faults_of_texts_are_named_with_file_and_line(answers, tmp_path, change, said):
    with pytest.raises(WalkError, match=r"(?s)jatos_results\.txt, " + said):
        read_answers(_put(tmp_path, change(as_lines(answers))))


def test_faults_in_an_archive_are_named_with_entry_and_line(answers, tmp_path):
    runs = _runs(answers)
    runs["study_result_2/comp_result_12/data.txt"] = runs["study_result_2/comp_result_12/data.txt"][:-20]
    with pytest.raises(
        WalkError, match=r"results\.zip, study_result_2/comp_result_12/data\.txt, line 20: expected a JSON"
    ):
        read_answers(_put(tmp_path, _archive(runs), "results.zip"))


def test_other_archives_are_refused(answers, tmp_path):
    with pytest.raises(WalkError, match=r"other\.zip: expected results of JATOS, .*got another archive"):
        read_answers(_put(tmp_path, _archive({"data.txt": as_lines(answers)}), "other.zip"))
    with pytest.raises(WalkError, match=r"half\.zip: expected a whole archive without a password, got BadZipFile"):
        read_answers(_put(tmp_path, _archive(_runs(answers))[:-200], "half.zip"))
    with pytest.raises(WalkError, match="expected at least one answer"):
        read_answers(_put(tmp_path, _archive({"study_result_1/comp-result_1/data.txt": b""}), "empty.zip"))


def test_a_bomb_is_not_unpacked(tmp_path, monkeypatch):
    monkeypatch.setattr("eigenwalker.experiment.answers.jatos_results._LARGEST", 1000)
    bomb = _archive({"study_result_1/comp-result_1/data.txt": b" " * 1001})
    with pytest.raises(WalkError, match=r"expected a whole archive.*1,001 bytes in study_result_1"):
        read_answers(_put(tmp_path, bomb, "results.zip"))


def test_damaged_archives_give_errors_or_the_answers(study, answers, tmp_path):
    sound, n_read = _archive(_runs(answers)), 0
    for number in range(200):
        random = Random(f"archive {number}")
        data = flip_bytes(random, sound) if number % 3 else sound[: random.randrange(len(sound))]
        try:
            read = read_answers(_put(tmp_path, data, "results.zip"), study=study)
        except WalkError:
            continue
        n_read += 1
        assert read.merge(answers, on=list(answers.columns)).shape == read.shape  # what is read was given
    assert n_read > 5
