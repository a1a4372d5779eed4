"""The table of gait measures on the command line."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from eigenwalker import make_walkers, prepare, walk_quality, write_walk
from eigenwalker.motion import gait_table


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(3, treadmill=False, duration=8, frame_rate=60, random_state=1).data


@pytest.fixture
def files(walkers, tmp_path):
    paths = [tmp_path / f"{walk.name}{ending}" for walk, ending in zip(walkers, (".trc", ".npz", ".csv"), strict=True)]
    for walk, path in zip(walkers, paths, strict=True):
        write_walk(walk, path)
    return paths


def test_table_is_that_of_python(run, files, walkers, tmp_path):
    status, printed, _ = run("gait", *files, "--out", tmp_path / "gait.csv")
    assert status == 0
    table = pd.read_csv(tmp_path / "gait.csv")
    prepared = [prepare(walk) for walk in walkers]
    expected = gait_table(prepared).assign(
        frequency_hz=[walk_quality(walk).frequency for walk in prepared],
        explained_power=[walk_quality(walk).explained_power for walk in prepared],
    )
    pd.testing.assert_frame_equal(table, expected, rtol=1e-5)  # TRC and CSV hold rounded numbers
    header, *rows, last = printed.splitlines()
    assert header.split() == list(expected.columns)
    assert [row.split()[0] for row in rows] == [walk.name for walk in walkers]
    assert last.startswith("wrote ")


def test_bad_recordings_are_left_out_when_asked(run, files, walkers, tmp_path):
    standing = tmp_path / "standing.npz"
    write_walk(replace(walkers[0], positions=np.repeat(walkers[0].positions[:1], 300, axis=0)), standing)
    status, _, error = run("gait", *files, standing)
    assert status == 1
    assert "1 of 4 walks were refused; mend them, or leave them out with --skip-bad:\n  walk 'standing'" in error
    status, printed, _ = run("gait", *files, standing, "--skip-bad")
    assert status == 0
    assert "refused: 1 of 4\n  walk 'standing'" in printed
    status, _, error = run("gait", standing, "--skip-bad")
    assert status == 1
    assert "1 of 1 walks were refused:\n" in error


def test_only_csv_is_written(run, files, tmp_path):
    status, _, error = run("gait", files[0], "--out", tmp_path / "gait.xlsx")
    assert status == 1
    assert "--out must end in .csv, got gait.xlsx" in error


def test_static_trial_and_feet(run, data_dir, tmp_path):
    """Heel strikes of two of the walks are published, as seen on force plates."""
    folder = data_dir / "horst_c3d"
    static = ["--static", folder / "S01_0001_Static.c3d"]
    files = sorted(folder.glob("*Gait.c3d"))
    assert run("gait", *files)[0] == 1
    assert run("gait", *files, *static, "--out", tmp_path / "gait.csv")[0] == 0
    table = pd.read_csv(tmp_path / "gait.csv").set_index("name")
    assert len(table) == 10
    bounds = pd.read_csv(folder / "Gait_cycle_bounds.csv", index_col=0)
    published = 120 / (bounds["HS2r"] - bounds["HS1r"])
    np.testing.assert_allclose(table.loc[bounds.index, "cadence_steps_per_min"], published, rtol=0.01)
    assert table["speed_m_per_s"].between(1.3, 1.6).all()
    assert table["explained_power"].gt(0.98).all()
    stance = (bounds["TOr"] - bounds["HS1r"]) / (bounds["HS2r"] - bounds["HS1r"])
    np.testing.assert_allclose(table.loc[bounds.index, "stance_ratio"], stance, atol=0.02)
