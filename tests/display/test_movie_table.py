"""Many movies from a table."""

import numpy as np
import pandas as pd
import pytest
from joblib import parallel_config
from numpy.testing import assert_allclose

from eigenwalker import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.display import Screen, make_display, write_movie, write_movies

pytest.importorskip("PIL.Image")
pytest.importorskip("imageio_ffmpeg")

SMALL = Screen(pixel_pitch=0.00054, size=(160, 240))


@pytest.fixture(scope="module")
def walks():
    return make_walkers(3, random_state=0).data


@pytest.fixture
def table():
    return pd.DataFrame(
        {
            "walk": ["walker_000", "walker_001", "walker_002"],
            "file": ["one.gif", "two.mp4", "three.gif"],
            "view": ["side", "30", 0],
            "inversion": ["none", None, "local"],
            "scramble_position": [0.0, np.nan, 0.5],
            "n_mask_dots": [10, np.nan, 0],
            "translating": [None, "yes", False],
            "random_state": [1, np.nan, 2],
            "duration": [0.2, 0.3, np.nan],
            "rate": [25, np.nan, np.nan],
        }
    )


def test_movies_are_those_of_their_conditions(table, walks, tmp_path):
    written = write_movies(table, tmp_path / "new", walks, screen=SMALL)
    assert list(written["file"]) == ["one.gif", "two.mp4", "three.gif"]
    assert list(written["n_frames"])[:2] == [5, 18]
    assert_allclose(written["duration"].iloc[:2], [0.2, 0.3])
    assert_allclose(written["rate"], [25, 60, 50], rtol=0.02)
    display = make_display(walks[0], n_mask_dots=10, random_state=1)
    alone = write_movie(display, tmp_path / "alone.gif", duration=0.2, rate=25, screen=SMALL)
    assert alone.path.read_bytes() == (tmp_path / "new" / "one.gif").read_bytes()
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == ["one.gif", "three.gif", "two.mp4"]
    assert list(table["duration"].iloc[:2]) == [0.2, 0.3]  # as it was


def test_movies_do_not_depend_on_the_number_of_jobs(table, walks, tmp_path):
    for n_jobs in (1, 2):
        with parallel_config("threading"):  # processes take long to start; what they are given is pickled elsewhere
            write_movies(table[::2], tmp_path / str(n_jobs), walks, screen=SMALL, n_jobs=n_jobs)
    for name in ("one.gif", "three.gif"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()


def test_files_are_named_for_rows(walks, tmp_path):
    table = pd.DataFrame({"walk": ["walker_000"], "duration": [0.1]}, index=["first"])
    assert list(write_movies(table, tmp_path, walks, screen=SMALL)["file"]) == ["first.mp4"]


def test_all_faults_at_once_and_nothing_written(table, walks, tmp_path):
    table = table.assign(rate=[60, 60, np.nan], walk=["walker_000", "nobody", "walker_002"])
    table["scramble_position"] = [0, 0, 2.0]
    with pytest.raises(WalkError) as caught:
        write_movies(table, tmp_path / "new", walks, screen=SMALL)
    message = str(caught.value)
    assert message.startswith("3 of 3 rows were refused")
    assert "row 0: a GIF has at most 50 frames per second" in message
    assert "row 1: walk must be the name of one of the walks, walker_000, walker_001, walker_002, got 'no" in message
    assert "row 2: amount must be a number of at least 0 and at most 1, got 2.0" in message
    assert not list((tmp_path / "new").iterdir())


def test_faulty_rows_are_left_out_if_wanted(table, walks, tmp_path):
    table["translating"] = ["perhaps", "no", "no"]
    with pytest.warns(UserWarning, match="row 0: translating must be true or false, got 'perhaps'"):
        written = write_movies(table, tmp_path, walks, screen=SMALL, on_error="skip")
    assert list(written.index) == [1, 2]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"scramble_postion": 1.0}, "expected columns out of walk, file, .* unknown: scramble_postion"),
        ({"file": "same.gif"}, "each row needs a file of its own, but these repeat: same.gif"),
        ({"file": ["../a.gif", "b.gif", "c.gif"]}, r"row 0: file must be a name without folders, got '../a.gif'"),
        ({"random_state": [0, 1, 2.5]}, "row 2: random_state must be a whole number from 0"),
        ({"dot_diameter": "large"}, "row 1: diameter must be a number .*, got 'large'"),
    ],
)
def test_tables_that_cannot_be(table, walks, tmp_path, change, message):
    with pytest.raises(ValueError, match=message):
        write_movies(table.assign(**change), tmp_path, walks, screen=SMALL)


def test_tables_of_other_kinds_and_walks_of_one_name(table, walks, tmp_path):
    with pytest.raises(TypeError, match="table must be a DataFrame, got dict"):
        write_movies({"walk": ["walker_000"]}, tmp_path, walks)
    with pytest.raises(ValueError, match="'walk' is missing"):
        write_movies(table.drop(columns="walk"), tmp_path, walks)
    with pytest.raises(ValueError, match="at least one row"):
        write_movies(table[:0], tmp_path, walks)
    with pytest.raises(ValueError, match=r"names of walks must differ .* walker_000"):
        write_movies(table, tmp_path, [walks[0], walks[0]])
