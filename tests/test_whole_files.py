"""A file is there as a whole or not at all."""

import pytest

from eigenwalker._whole_files import whole_file, write_whole


def test_a_file_is_written(tmp_path):
    write_whole(tmp_path / "a.csv", b"new")
    write_whole(tmp_path / "a.csv", b"newer")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("a.csv", b"newer")]


def test_an_error_leaves_what_was(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"old")

    def fail():
        with whole_file(tmp_path / "a.csv") as part:
            part.write_bytes(b"half")
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("a.csv", b"old")]


def test_a_file_that_is_replaced_hands_on_who_may_read_it(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"old")
    (tmp_path / "a.csv").chmod(0o600)
    write_whole(tmp_path / "a.csv", b"new")
    assert (tmp_path / "a.csv").stat().st_mode & 0o777 == 0o600
