"""The table of coefficients on the command line."""

import io
from dataclasses import replace

import numpy as np
import pytest

from eigenwalker import FourierLinearizer, make_walkers, prepare, write_walk
from eigenwalker.batch import read_coefficients, read_linearizer, refused_files
from eigenwalker.motion import split_passes


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(3, treadmill=False, duration=8, frame_rate=60, random_state=1).data


@pytest.fixture
def files(walkers, tmp_path):
    paths = [tmp_path / f"{walk.name}.npz" for walk in walkers]
    for walk, path in zip(walkers, paths, strict=True):
        write_walk(walk, path)
    return paths


def test_table_is_that_of_python(run, files, walkers, tmp_path):
    out = tmp_path / "table"
    options = ("--harmonics", 3, "--extra", "speed", "--cutoff", 8)
    status, printed, _ = run("linearize", *files, "--out", out, *options)
    assert status == 0
    assert printed.startswith("files: 3, walks: 3, refused: 0\nwrote ")
    linearizer = FourierLinearizer(3, extras=("speed",))
    expected = linearizer.fit_transform([prepare(walk, cutoff=8.0) for walk in walkers])
    np.testing.assert_array_equal(read_coefficients(out, columns=linearizer.get_feature_names_out()), expected)
    assert run("linearize", *files, "--out", out, *options)[0] == 0
    status, _, error = run("linearize", *files, "--out", out, "--harmonics", 3)
    assert status == 1
    assert "linearizer, extras: ['speed'] in the first run, [] now" in error
    assert "preparation, cutoff: 8.0 in the first run, None now" in error


def test_files_from_a_list(run, files, tmp_path, monkeypatch):
    listed = "".join(f"{path}\n" for path in files) + "\n"
    (tmp_path / "files.txt").write_text(listed)
    assert run("linearize", "--files-from", tmp_path / "files.txt", "--out", tmp_path / "a")[0] == 0
    monkeypatch.setattr("sys.stdin", io.StringIO(listed))
    assert run("linearize", "--files-from", "-", "--out", tmp_path / "b")[0] == 0
    for name in "ab":
        assert list(read_coefficients(tmp_path / name)["file"]) == [str(path) for path in files]


@pytest.mark.parametrize("arguments", [(), ("walk.npz", "--files-from", "list.txt")])
def test_files_come_from_one_place(run, tmp_path, arguments):
    status, _, error = run("linearize", *arguments, "--out", tmp_path / "table")
    assert status == 1
    assert "either as FILE ... or in --files-from LIST" in error


@pytest.mark.filterwarnings("default:.*walks were refused:UserWarning")
def test_refusals_are_counted_and_kept(run, files, walkers, tmp_path):
    standing = tmp_path / "standing.npz"
    write_walk(replace(walkers[0], positions=np.repeat(walkers[0].positions[:1], 300, axis=0)), standing)
    status, printed, error = run("linearize", *files, standing, "--out", tmp_path / "table")
    assert status == 0
    assert printed.startswith("files: 4, walks: 3, refused: 1\n")
    assert "note: 1 of 4 walks were refused" in error
    assert list(refused_files(tmp_path / "table")["file"]) == [str(standing)]


@pytest.mark.filterwarnings("ignore:.*walks were refused:UserWarning")
def test_refused_files_are_read_again_when_they_are_mended(run, files, tmp_path):
    good = files[1].read_bytes()
    files[1].write_bytes(b"PK nothing")
    command = ("linearize", *files, "--out", tmp_path / "table")
    assert "--retry-refused reads them again" in run(*command)[1]
    files[1].write_bytes(good)
    assert run(*command)[1].startswith("files: 3, walks: 2, refused: 1\n")
    assert run(*command, "--retry-refused")[1].startswith("files: 3, walks: 3, refused: 0\nwrote ")


def test_names_that_no_file_has_are_an_error(run, files, tmp_path):
    status, _, error = run("linearize", *files, "walks/*.npz", "b.npz", "--out", tmp_path / "table")
    assert status == 1
    assert "expected recordings, found no file walks/*.npz, b.npz" in error
    assert not (tmp_path / "table").exists()


def test_lists_of_windows_editors(run, files, tmp_path):
    (tmp_path / "files.txt").write_text("".join(f"{path}\r\n" for path in files), encoding="utf-8-sig", newline="")
    assert run("linearize", "--files-from", tmp_path / "files.txt", "--out", tmp_path / "table")[0] == 0
    assert list(read_coefficients(tmp_path / "table")["file"]) == [str(path) for path in files]


def test_ctrl_c_says_how_to_go_on(run, files, tmp_path, monkeypatch):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("eigenwalker.cli.linearize.linearize_files", stop)
    status, _, error = run("linearize", *files, "--out", tmp_path / "table")
    assert status == 130
    assert error.endswith("keeps what was done; the same command goes on from there\neigenwalker linearize: stopped\n")


def test_passes(run, walkers, tmp_path):
    path = tmp_path / "anna.npz"
    write_walk(replace(walkers[0], name="anna"), path)
    expected = [walk.name for walk in split_passes(replace(walkers[0], name="anna"))]
    assert run("linearize", path, "--passes", "--out", tmp_path / "table")[0] == 0
    assert list(read_coefficients(tmp_path / "table")["name"]) == expected


def test_joints(run, tmp_path, data_dir):
    files = sorted((data_dir / "bandai2").glob("*normal_00[12].bvh"))
    out = tmp_path / "table"
    assert run("linearize", *files, "--representation", "joints", "--out", out)[0] == 0
    assert read_linearizer(out).template_.skeleton.upright
    assert len(read_coefficients(out)) == 2
