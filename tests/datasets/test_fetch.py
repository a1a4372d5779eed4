"""The public data sets, from a server on this machine that has the files at hand under their repository paths."""

import re

import numpy as np
import pandas as pd
import pytest

from eigenwalker import JointWalk, Walk, WalkError
from eigenwalker.datasets import bandai, cmu, fetch_bandai_walks, fetch_cmu_walks, fetch_kinect_gait, kinect
from eigenwalker.datasets._manifest import RemoteFile, read_manifest
from eigenwalker.datasets.home import DATA_SETS
from tests.datasets.file_server import serve

STYLES = {
    "active": 32, "elderly": 17, "exhausted": 23, "feminine": 27, "masculine": 25, "normal": 24, "youthful": 27,
}  # fmt: skip


def at_hand(data_dir, path):
    """The file of a repository path in the folder of recorded walks, which is flatter."""
    *_, folder, name = path.split("/")
    if path.startswith("Data/Person"):
        return data_dir / "kinect" / folder / name
    if name == "person-data.csv":
        return data_dir / "kinect" / name
    return data_dir / ("bandai2" if name.startswith("dataset-2") else "cmu_bvh") / name


@pytest.fixture(scope="module")
def server(data_dir):
    contents = {}
    for module, name in ((bandai, "bandai_walks"), (cmu, "cmu_walks"), (kinect, "kinect_gait")):
        for file in read_manifest(name):
            path = at_hand(data_dir, file.path)
            if path.is_file():
                contents[f"{module._REPOSITORY.title}/{module._REPOSITORY.commit}/{file.path}"] = path
    with serve(contents) as files:
        yield files


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    return tmp_path_factory.mktemp("data_home")


@pytest.fixture(scope="module")
def styles(server, home):
    return fetch_bandai_walks(data_home=home, base_url=server.url)


@pytest.fixture(scope="module")
def subjects(server, home):
    return fetch_cmu_walks(data_home=home, base_url=server.url)


@pytest.fixture(scope="module")
def people(server, home):
    return fetch_kinect_gait(subset="checked", data_home=home, base_url=server.url)


def check_bunch(bunch, n_walks, kind):
    """What all three have in common."""
    assert len(bunch.data) == len(bunch.target) == len(bunch.filenames) == len(bunch.frame) == n_walks
    assert all(isinstance(walk, kind) for walk in bunch.data)
    names = [walk.name for walk in bunch.data]
    assert len(set(names)) == n_walks
    assert names == list(bunch.target.index) == list(bunch.frame.index)
    assert list(bunch.frame.columns) == [*bunch.target_names, "filename"]
    for part in ("Known faults", ":License:", ":Cite:", ":Source:"):
        assert part in bunch.DESCR


class TestManifests:
    @pytest.mark.parametrize("name", DATA_SETS)
    def test_every_line_is_sound(self, name):
        files = read_manifest(name)
        assert len({file.path for file in files}) == len(files)
        for file in files:
            assert re.fullmatch(r"[\w./-]+\.(bvh|txt|csv)", file.path)
            assert ".." not in file.path
            assert file.size is None or file.size > 1000
            assert file.sha256 is None or (re.fullmatch("[0-9a-f]{64}", file.sha256) and file.size is not None)

    @pytest.mark.parametrize(("name", "n_files", "n_sizes", "n_checksums"), [
        ("bandai_walks", 175, 175, 175), ("cmu_walks", 27, 27, 27), ("kinect_gait", 822, 821, 246),
    ])  # fmt: skip
    def test_counts(self, name, n_files, n_sizes, n_checksums):
        files = read_manifest(name)
        assert len(files) == n_files
        assert sum(file.size is not None for file in files) == n_sizes
        assert sum(file.sha256 is not None for file in files) == n_checksums

    def test_kinect_has_164_people_and_the_size_of_every_recording(self):
        _, *recordings = read_manifest("kinect_gait")
        assert len({file.path.split("/")[1] for file in recordings}) == 164
        assert sum(file.size for file in recordings) == 411_400_579


class TestBandai:
    def test_styles(self, styles):
        check_bunch(styles, 175, JointWalk)
        assert styles.target.value_counts().to_dict() == STYLES
        assert styles.target.name == "style"
        assert styles.target["dataset-2_walk_elderly_001"] == "elderly"
        assert styles.groups is None

    def test_units(self, styles):
        heights = [np.median(walk.to_markers().marker("head")[:, 2]) for walk in styles.data[::25]]
        assert 1.3 < min(heights) <= max(heights) < 2.0
        assert {walk.frame_rate for walk in styles.data} == {30.0}


class TestCmu:
    def test_people(self, subjects):
        check_bunch(subjects, 27, JointWalk)
        assert subjects.target.person.value_counts().to_dict() == {"07": 12, "08": 11, "02": 2, "05": 1, "06": 1}
        assert list(subjects.groups) == list(subjects.target.person)
        assert subjects.target.motion.value_counts()["walk"] == 20
        assert subjects.target.loc["07_12"].to_dict() == {"person": "07", "trial": "12", "motion": "brisk walk"}
        assert subjects.data[0].frame_rate == 120

    def test_again_without_a_request_and_as_arrays(self, subjects, server, home):
        server.requests.clear()
        options = {"data_home": home, "base_url": server.url, "download_if_missing": False}
        bunch = fetch_cmu_walks(as_frame=False, **options)
        assert server.requests == []
        assert isinstance(bunch.target, np.ndarray)
        assert bunch.target.shape == (27, 3)
        assert bunch.frame is None
        for one, other in zip(bunch.data, subjects.data, strict=True):
            np.testing.assert_array_equal(one.channels, other.channels)
        X, y = fetch_cmu_walks(return_X_y=True, **options)
        assert [walk.name for walk in X] == list(y.index)
        pd.testing.assert_frame_equal(y, subjects.target)
        X, y = fetch_cmu_walks(return_X_y=True, as_frame=False, **options)
        assert y.tolist() == bunch.target.tolist()


class TestKinect:
    def test_people(self, people):
        check_bunch(people, 246, Walk)
        persons = people.target.drop_duplicates("person")
        assert persons.sex.value_counts().to_dict() == {"M": 55, "F": 27}
        assert persons[["height_m", "weight_kg", "age"]].notna().sum().tolist() == [82, 50, 50]
        assert (persons.with_backpack.sum(), persons.high_heels.sum()) == (5, 2)
        assert persons.with_backpack.dtype == bool
        assert pd.Series(people.groups).value_counts().eq(3).all()

    def test_labels_belong_to_the_person(self, people):
        row = people.target.loc["Person029_2"]
        assert (row.person, row.sex, row.height_m, row.weight_kg, row.age) == ("Person029", "F", 1.73, 67, 39)
        assert row.high_heels
        assert not row.with_backpack
        assert people.frame.filename["Person029_2"].endswith("2.txt")

    def test_the_joints_are_those_of_the_sensor(self, people):
        assert {walk.positions.shape[1:] for walk in people.data} == {(20, 3)}
        assert people.data[0].name == "Person001_1"


HEADER = "Individual,Height,Weight (Kg),Age,Gender,Body Mass Index,BackPack,HighHeels\r\n"
PERSONS = HEADER + "Person001,1.63,,,F ,0,,S\r\nPerson002,1.75,80,31,M,0, S,  \r\n,,,,,,,\r\n"


class TestWithoutChecksum:
    """Recordings of which only the size is known, and a table of which not even that: a small data set."""

    @pytest.fixture
    def small(self, data_dir, monkeypatch):
        recording = (data_dir / "kinect" / "Person001" / "1.txt").read_bytes()
        paths = ["Data/Person001/1.txt", "Data/Person002/1.txt", "Data/Person002/2.txt"]
        table = RemoteFile("GenderBMIData/person-data.csv", None, None)
        files = [table, *(RemoteFile(path, len(recording), None) for path in paths)]
        monkeypatch.setattr(kinect, "read_manifest", lambda name: files)
        contents = dict.fromkeys(paths, recording) | {table.path: PERSONS.encode()}
        prefix = f"{kinect._REPOSITORY.title}/{kinect._REPOSITORY.commit}/"
        with serve({prefix + path: content for path, content in contents.items()}) as server:
            server.prefix = prefix
            server.size = len(recording)
            yield server

    def test_all_are_fetched(self, small, tmp_path):
        bunch = fetch_kinect_gait(data_home=tmp_path, base_url=small.url)
        assert [walk.name for walk in bunch.data] == ["Person001_1", "Person002_1", "Person002_2"]
        assert bunch.target.sex.tolist() == ["F", "M", "M"]
        assert bunch.target.high_heels.tolist() == [True, False, False]
        assert bunch.target.with_backpack.tolist() == [False, True, True]
        values = fetch_kinect_gait(data_home=tmp_path, base_url=small.url, as_frame=False).target
        assert values[1].tolist() == ["Person002", "M", 1.75, 80, 31, True, False]

    def test_a_recording_that_cannot_be_read(self, small, tmp_path):
        small.contents[small.prefix + "Data/Person002/1.txt"] = b"Head;1;2;3\r\n".ljust(small.size, b"?")
        with pytest.raises(WalkError, match=r"1 of 3 recordings were refused; .*on_error='skip'(.|\n)*Person002/1.txt"):
            fetch_kinect_gait(data_home=tmp_path, base_url=small.url)
        with pytest.warns(UserWarning, match="1 of 3 recordings were refused and left out"):
            bunch = fetch_kinect_gait(data_home=tmp_path, base_url=small.url, on_error="skip")
        assert list(bunch.target.index) == [walk.name for walk in bunch.data] == ["Person001_1", "Person002_2"]
        assert bunch.target.person.tolist() == list(bunch.groups) == ["Person001", "Person002"]

    def test_a_wrong_size_is_refused(self, small, tmp_path):
        small.contents[small.prefix + "Data/Person002/1.txt"] = b"Head;1;2;3\r\n"
        message = rf"1 of 4 files could not be fetched(.|\n)*Person002/1.txt: expected {small.size} bytes, got 12 from"
        with pytest.raises(OSError, match=message):
            fetch_kinect_gait(data_home=tmp_path, base_url=small.url)
        assert not (tmp_path / "kinect_gait/Data/Person002/1.txt").exists()

    def test_a_recording_that_was_cut_is_fetched_again(self, small, tmp_path):
        fetch_kinect_gait(data_home=tmp_path, base_url=small.url)
        path = tmp_path / "kinect_gait/Data/Person002/1.txt"
        whole = path.read_bytes()
        path.write_bytes(whole[:-1])
        with pytest.warns(UserWarning, match=rf"fetched again:\n  Data/Person002/1.txt: expected {small.size} bytes"):
            fetch_kinect_gait(data_home=tmp_path, base_url=small.url)
        assert path.read_bytes() == whole

    def test_a_size_does_not_tell_whether_pieces_fit(self, small, tmp_path):
        small.cuts[small.prefix + "Data/Person002/1.txt"] = [1000]
        fetch_kinect_gait(data_home=tmp_path, base_url=small.url, n_retries=1, delay=0.0)
        assert small.ranges("Data/Person002/1.txt") == [None, None]

    def test_a_person_without_a_row(self, small, tmp_path):
        small.contents[small.prefix + "GenderBMIData/person-data.csv"] = HEADER.encode()
        with pytest.raises(WalkError, match=r"one row for every person, got none for Person001, Person002"):
            fetch_kinect_gait(data_home=tmp_path, base_url=small.url)

    def test_arguments(self, small, tmp_path):
        with pytest.raises(ValueError, match="subset must be one of 'all', 'checked', got 'some'"):
            fetch_kinect_gait(subset="some", data_home=tmp_path)
        with pytest.raises(ValueError, match="on_error must be one of"):
            fetch_kinect_gait(on_error="ignore", data_home=tmp_path)
        assert small.requests == []


@pytest.mark.parametrize("fetch", [fetch_bandai_walks, fetch_cmu_walks, fetch_kinect_gait])
def test_without_download_nothing_is_fetched(fetch, tmp_path):
    with pytest.raises(OSError, match="are missing or not as published; fetch them with download_if_missing=True"):
        fetch(data_home=tmp_path, download_if_missing=False)
