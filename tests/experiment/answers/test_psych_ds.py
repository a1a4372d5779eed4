"""Data sets are as Psych-DS asks for, and what is not is said."""

import json
import shutil

import pytest

from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS
from eigenwalker.experiment.answers.files import write_answers
from eigenwalker.experiment.answers.psych_ds import (
    check_dataset,
    data_file_name,
    dataset_description,
    write_description,
)
from tests.experiment.answers.given_answers import answers_to, small_study

TABLE = "participant-1_task-pair_data.csv"


@pytest.fixture(scope="module")
def study():
    return small_study(title="Moods é")


@pytest.fixture(scope="module")
def dataset(study, tmp_path_factory):
    folder = tmp_path_factory.mktemp("dataset")
    write_answers(answers_to(study), folder, study=study)
    return folder


@pytest.fixture
def copied(dataset, tmp_path):
    shutil.copytree(dataset, tmp_path / "copy")
    return tmp_path / "copy"


def _say(folder, **changes):
    path = folder / "dataset_description.json"
    path.write_text(json.dumps(json.loads(path.read_text(encoding="utf-8")) | changes))


def test_what_is_written_has_no_faults(dataset):
    assert check_dataset(dataset) == []
    assert check_dataset(str(dataset)) == []


def test_the_description_names_all_columns_with_their_units(dataset, study):
    said = json.loads((dataset / "dataset_description.json").read_text(encoding="utf-8"))
    assert (said["@context"], said["@type"], said["name"]) == ("https://schema.org/", "Dataset", "Moods é")
    assert said["identifier"] == study.id
    assert "rating of happy, pair, naturalness, recognition, resemblance" in said["description"]
    assert [one["name"] for one in said["variableMeasured"]] == list(ANSWER_COLUMNS)
    assert {one["@type"] for one in said["variableMeasured"]} == {"PropertyValue"}
    units = {one["name"]: one["unitText"] for one in said["variableMeasured"] if "unitText" in one}
    assert units == {name: column.unit for name, column in ANSWER_COLUMNS.items() if column.unit}


def test_more_can_be_said():
    assert dataset_description("a", "b", license="CC0")["license"] == "CC0"
    assert data_file_name(12, "pair") == "participant-12_task-pair_data.csv"


def test_a_study_without_title_has_a_name(tmp_path):
    write_description(tmp_path, small_study(title=" "))
    assert json.loads((tmp_path / "dataset_description.json").read_text())["name"].strip()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"@context": "https://example.org"}, "@context: expected https://schema.org/, got 'https://example.org'"),
        ({"@type": "Thing"}, "@type: expected Dataset, got 'Thing'"),
        ({"name": ""}, "name: expected words, got ''"),
        ({"description": 3}, "description: expected words, got '3'"),
        ({"variableMeasured": "study"}, "variableMeasured: expected a list of words or PropertyValues"),
        ({"variableMeasured": [{"name": "study"}]}, "variableMeasured: expected a list of words or PropertyValues"),
        ({"variableMeasured": ["study", "study"]}, "variableMeasured: expected a list of words or PropertyValues"),
    ],
)
def test_faults_of_the_description(copied, changes, said):
    _say(copied, **changes)
    (fault,) = check_dataset(copied)
    assert fault.startswith(f"dataset_description.json: {said}")


def test_descriptions_as_in_the_handbook_are_sound(copied):
    _say(copied, **{"@context": "http://schema.org", "variableMeasured": list(ANSWER_COLUMNS)})
    assert check_dataset(copied) == []


def test_columns_and_variables_are_the_same_ones(copied):
    _say(copied, variableMeasured=[*list(ANSWER_COLUMNS)[1:], "mood"])
    faults = check_dataset(copied)
    assert len(faults) == 2 * 10  # in each table
    assert f"data/{TABLE}: expected columns out of variableMeasured, got study too" in faults
    assert f"data/{TABLE}: expected all columns of variableMeasured, got none called mood" in faults


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("answers.csv", None, "expected a name of keywords and values, participant-3_task-rating_data.csv"),
        ("Participant-3_data.csv", None, "expected a name of keywords"),
        ("participant-3.csv", None, "expected a name of keywords"),
        ("participant-3_task-very_cool_data.csv", None, "expected a name of keywords"),
        (TABLE, "", "expected a header, a name over each column"),
        (TABLE, "a,,b\n", "expected a header, a name over each column"),
        (TABLE, 'a,"b\n', "unexpected end of data"),
        (TABLE, "a\0b\n", "line 1: expected the text of a table, got binary data (a zero byte)"),
    ],
)
def test_faults_of_tables(copied, name, text, said):
    path = copied / "data" / name
    path.write_text((copied / "data" / TABLE).read_text() if text is None else text)
    (fault,) = check_dataset(copied)
    assert fault.startswith(f"data/{name}: {said}")


def test_rows_have_as_many_cells_as_the_header(copied):
    path = copied / "data" / TABLE
    path.write_text(path.read_text() + "1,2\n\n")
    assert check_dataset(copied) == [
        f"data/{TABLE}: expected 28 cells in each row, as in the header, got others in 1 rows"
    ]


def test_row_id_is_different_in_each_row(tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "study-a_data.csv").write_text("row_id,a\n1,1\n1,2\n")
    said = dataset_description() | {"variableMeasured": ["row_id", "a"]}
    (tmp_path / "dataset_description.json").write_text(json.dumps(said))
    assert check_dataset(tmp_path) == ["data/study-a_data.csv: expected different values in row_id, got some twice"]


def test_what_must_be_there(copied):
    for path in (copied / "data").iterdir():
        path.unlink()
    (copied / "data" / "raw").mkdir()
    (copied / "data" / "raw" / "anything.csv").write_text("")
    assert check_dataset(copied) == ["data: expected at least one table, ..._data.csv, got none"]
    for text, said in (("[", "expected JSON in UTF-8"), ("[]", "expected a JSON object, got list")):
        (copied / "dataset_description.json").write_text(text)
        assert check_dataset(copied)[0].startswith(f"dataset_description.json: {said}")
    (copied / "dataset_description.json").unlink()
    assert check_dataset(copied)[0] == "dataset_description.json: expected in the folder, got none"
