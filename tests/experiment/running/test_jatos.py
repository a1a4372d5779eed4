"""Archives that JATOS imports: one folder of assets, and one file that says what they are."""

import json
import uuid
import zipfile

import pytest

from eigenwalker.experiment.running.jatos import write_jzip

ID = "ab12cd34ef56"
PAGE = "<!doctype html><title>é</title>"


def _write(folder, name="study.jzip", **options):
    return write_jzip(folder / name, PAGE, **{"title": "Moods", "study_id": ID} | options)


def _said(path):
    with zipfile.ZipFile(path) as archive:
        return json.loads(archive.read(f"study_{ID}.jas"))


def test_the_structure_is_that_of_an_export(tmp_path):
    movie = tmp_path / "sad.mp4"
    movie.write_bytes(b"movie")
    path = _write(tmp_path, assets={"stimuli/sad.mp4": movie, "jspsych.js": b"code", "stimuli/more/b.css": str(movie)})
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        assert archive.namelist() == [
            f"study_{ID}.jas",
            *(f"study_{ID}/{folder}" for folder in ("", "stimuli/", "stimuli/more/")),
            *(f"study_{ID}/{name}" for name in ("index.html", "jspsych.js", "stimuli/more/b.css", "stimuli/sad.mp4")),
        ]
        assert archive.read(f"study_{ID}/index.html").decode() == PAGE
        assert archive.read(f"study_{ID}/stimuli/sad.mp4") == b"movie"


def test_the_study_is_said_as_in_the_handbook(tmp_path):
    """The keys, and the kinds of their values, of the JSON schema in "JATOS Study Archive (JZIP)", JATOS 3.10."""
    said = _said(_write(tmp_path, description="Two groups"))
    assert said["version"] == "3"
    assert set(said) == {"version", "data"}
    study = said["data"]
    assert list(study) == [
        *("uuid", "title", "description", "groupStudy", "linearStudy", "allowPreview", "dirName", "comments"),
        *("jsonData", "endRedirectUrl", "studyEntryMsg", "componentList", "batchList"),
    ]
    assert study["dirName"] == f"study_{ID}"
    assert (study["title"], study["description"]) == ("Moods", "Two groups")
    (component,), (batch,) = study["componentList"], study["batchList"]
    assert list(component) == ["uuid", "title", "htmlFilePath", "reloadable", "active", "comments", "jsonData"]
    assert (component["htmlFilePath"], component["reloadable"], component["active"]) == ("index.html", True, True)
    assert list(batch) == [
        *("uuid", "title", "active", "maxActiveMembers", "maxTotalMembers", "maxTotalWorkers"),
        *("allowedWorkerTypes", "comments", "jsonData"),
    ]
    assert batch["active"]
    assert set(batch["allowedWorkerTypes"]) <= {"Jatos", "PersonalSingle", "PersonalMultiple"}
    identifiers = [uuid.UUID(one["uuid"]) for one in (study, component, batch)]
    assert len(set(identifiers)) == 3


def test_the_same_study_makes_the_same_bytes(tmp_path):
    assets = {"b.css": b"b", "a.js": b"a"}
    first = _write(tmp_path, assets=assets).read_bytes()
    again = _write(tmp_path, "again.jzip", assets=dict(reversed(assets.items()))).read_bytes()
    assert first == again
    other = _said(_write(tmp_path, title="Other"))
    assert other["data"]["uuid"] == _said(tmp_path / "again.jzip")["data"]["uuid"]  # it replaces it in JATOS
    assert first.count(ID.encode()) > 2


def test_entries_say_nothing_of_this_machine(tmp_path):
    with zipfile.ZipFile(_write(tmp_path, assets={"a/b.js": b""})) as archive:
        for entry in archive.infolist():
            assert entry.date_time == (1980, 1, 1, 0, 0, 0)
            assert entry.create_system == 3
            assert entry.external_attr >> 16 == (0o40755 if entry.is_dir() else 0o100644)


def test_words_have_no_markup_for_jatos(tmp_path):
    data = _said(_write(tmp_path, title="<b>Sad &\n happy</b>" + 300 * "x", description="a < b &amp; c\0"))["data"]
    assert data["title"].startswith("‹b›Sad + happy‹/b›xxx")
    assert len(data["title"]) == 255
    assert data["description"] == "a ‹ b +amp; c"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"study_id": "AB"}, "study_id must be 12 hexadecimal digits, got 'AB'"),
        ({"title": " "}, "title must be a word or more"),
        ({"assets": {"../a.js": b""}}, r"assets must be named by plain paths in the folder, .*got '\.\./a\.js'"),
        ({"assets": {"/a.js": b""}}, "assets must be named by plain paths"),
        ({"assets": {"a\\b.js": b""}}, "assets must be named by plain paths"),
        ({"assets": {"a//b.js": b""}}, "assets must be named by plain paths"),
        ({"assets": {"a\n.js": b""}}, "assets must be named by plain paths"),
        ({"assets": {"": b""}}, "assets must be named by plain paths"),
        ({"assets": {"Index.html": b""}}, "assets must differ in their names"),
        ({"assets": {"a.js": b"", "A.js": b""}}, "assets must differ in their names"),
    ],
)
def test_what_is_refused_leaves_nothing(tmp_path, options, said):
    with pytest.raises(ValueError, match=said):
        _write(tmp_path, **options)
    assert not list(tmp_path.iterdir())


def test_a_file_that_is_not_there_leaves_what_was(tmp_path):
    before = _write(tmp_path).read_bytes()
    with pytest.raises(FileNotFoundError):
        _write(tmp_path, assets={"a.mp4": tmp_path / "gone.mp4"})
    assert [path.name for path in tmp_path.iterdir()] == ["study.jzip"]
    assert (tmp_path / "study.jzip").read_bytes() == before
