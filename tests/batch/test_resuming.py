"""A data set does not depend on what happened while it was written."""

import json
import multiprocessing
import os
import shutil
import signal
import warnings
from functools import partial
from pathlib import Path

import joblib
import numpy as np
import pandas as pd
import pytest

from eigenwalker import (
    FourierLinearizer,
    WalkPreparer,
    write_walk,
)
from eigenwalker.batch import linearize_files, read_coefficients
from tests.batch.walk_files import linearize_and_die, make_from_seed
from tests.synthetic import make_walk

N_KILLS = 20
INTERRUPTED = 6

linearize_in_place = partial(linearize_files, preparer="passthrough")
pytestmark = pytest.mark.filterwarnings("ignore:[0-9]+ of [0-9]+ walks were refused:UserWarning")


def _parts(folder):
    return {path.name: path.read_bytes() for path in folder.glob("part-*.parquet")}


def test_processes_and_parts_do_not_matter(paths, undisturbed, tmp_path):
    two = linearize_in_place(paths, FourierLinearizer(), tmp_path / "two", n_jobs=2, files_per_part=3).folder
    assert _parts(two) == _parts(undisturbed)
    one = linearize_in_place(iter(paths), FourierLinearizer(), tmp_path / "one").folder
    pd.testing.assert_frame_equal(pd.read_parquet(one), pd.read_parquet(undisturbed), check_exact=True)


def test_processes_that_were_started_in_another_folder_do_not_matter(paths, undisturbed, tmp_path, monkeypatch):
    folder = paths[0].parents[1]
    joblib.Parallel(n_jobs=2)(joblib.delayed(os.getpid)() for _ in range(8))  # joblib keeps them for the next call
    monkeypatch.chdir(folder)
    files = [path.relative_to(folder) for path in paths]
    table = linearize_in_place(files, FourierLinearizer(), tmp_path / "table", n_jobs=2).folder
    drop = ["file", "reason"]  # which say the paths
    pd.testing.assert_frame_equal(
        pd.read_parquet(table).drop(columns=drop), pd.read_parquet(undisturbed).drop(columns=drop), check_exact=True
    )


def test_threads_do_not_matter(paths, undisturbed, tmp_path):
    with joblib.parallel_config("threading", n_jobs=2):
        linearize_in_place(paths, FourierLinearizer(), tmp_path / "table", files_per_part=3)
    assert _parts(tmp_path / "table") == _parts(undisturbed)


@pytest.fixture(scope="module")
def run_and_kill():
    """A function that linearizes files in a process, which is killed after so many steps; it returns exit and steps."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["tests.batch.walk_files"])

    def run(paths, out, limit, **options):
        n_steps = context.Value("q", 0)
        process = context.Process(target=linearize_and_die, args=(paths, out, limit, n_steps), kwargs=options)
        process.start()
        process.join()
        return process.exitcode, n_steps.value

    return run


def test_killed_at_random_moments_and_begun_again(run_and_kill, paths, undisturbed, tmp_path):
    """The moments are steps of the program, so that files half written are met as often as rows half done."""
    code, n_steps = run_and_kill(paths, tmp_path / "whole", 0)
    assert code == 0
    limits = np.random.default_rng(0).integers(1, 2 * n_steps // N_KILLS, size=N_KILLS)
    exits = [run_and_kill(paths, tmp_path / "table", int(limit))[0] for limit in limits]
    assert exits.count(-signal.SIGKILL) > N_KILLS // 2
    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=".*damaged")
        linearize_in_place(paths, FourierLinearizer(), tmp_path / "table", files_per_part=3)
    assert _parts(tmp_path / "table") == _parts(undisturbed) == _parts(tmp_path / "whole")
    assert not list((tmp_path / "table").glob(".part*"))


def test_refused_files_are_read_again_on_request(paths, undisturbed, tmp_path):
    given = [tmp_path / f"{number:02d}.npz" for number in range(8)]
    for old, new in zip(paths, given, strict=False):
        shutil.copy(old, new)
    given[1].write_bytes(b"PK nothing")
    done = linearize_in_place(given, FourierLinearizer(), tmp_path / "table", files_per_part=3)
    assert done[1:] == (8, 5, 3)
    shutil.copy(paths[1], given[1])
    assert linearize_in_place(given, FourierLinearizer(), tmp_path / "table", files_per_part=3) == done
    again = linearize_in_place(given, FourierLinearizer(), tmp_path / "table", files_per_part=3, retry_refused=True)
    assert again[1:] == (8, 6, 2)
    table = pd.read_parquet(tmp_path / "table").sort_values("file", ignore_index=True)
    wanted = pd.read_parquet(undisturbed).set_index("file").loc[[str(path) for path in paths[:8]]].reset_index()
    assert list(table["file"]) == [str(path) for path in given]
    pd.testing.assert_frame_equal(table.drop(columns="file"), wanted.drop(columns="file"), check_exact=True)


def test_only_the_files_that_are_given_are_read_again(paths, undisturbed, tmp_path):
    folder = tmp_path / "table"
    shutil.copytree(undisturbed, folder)
    done = linearize_in_place([paths[3]], FourierLinearizer(), folder, retry_refused=True)
    assert done[1:] == linearize_in_place(paths, FourierLinearizer(), folder)[1:]
    table, wanted = (pd.read_parquet(each).sort_values("file", ignore_index=True) for each in (folder, undisturbed))
    pd.testing.assert_frame_equal(table, wanted, check_exact=True)


def _interrupted(seed):
    if seed == INTERRUPTED:
        raise KeyboardInterrupt
    return make_from_seed(seed)


def test_what_was_done_before_an_interruption_is_kept(tmp_path):
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            linearize_in_place(range(10), FourierLinearizer(), tmp_path / "table", read=_interrupted)
        assert pd.read_parquet(tmp_path / "table")["file"].to_list() == [str(seed) for seed in range(INTERRUPTED)]
    with pytest.raises(KeyboardInterrupt):
        linearize_in_place(range(10), FourierLinearizer(), tmp_path / "table", read=_interrupted, retry_refused=True)
    assert sorted(pd.read_parquet(tmp_path / "table")["file"]) == [str(seed) for seed in range(INTERRUPTED)]


def test_a_generator_may_change_the_folder(paths, undisturbed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def walk_through():
        for path in paths:
            os.chdir(path.parent)
            yield path

    done = linearize_in_place(walk_through(), FourierLinearizer(), "table", files_per_part=3)
    assert done.folder == Path("table")
    assert _parts(tmp_path / "table") == _parts(undisturbed)


def test_killed_while_refused_files_are_read_again(run_and_kill, paths, undisturbed, tmp_path):
    shutil.copytree(undisturbed, tmp_path / "whole")
    code, n_steps = run_and_kill(paths, tmp_path / "whole", 0, retry_refused=True)
    assert code == 0
    wanted = pd.read_parquet(undisturbed).sort_values("file", ignore_index=True)
    good = set(wanted["file"][wanted["reason"].isna()])
    shutil.copytree(undisturbed, tmp_path / "table")
    limits = np.random.default_rng(0).integers(1, n_steps, size=N_KILLS)
    for limit in limits:
        assert run_and_kill(paths, tmp_path / "table", int(limit), retry_refused=True)[0] in (-signal.SIGKILL, 0)
        assert good <= set(pd.read_parquet(tmp_path / "table")["file"])  # whatever happens, these are not lost
    linearize_in_place(paths, FourierLinearizer(), tmp_path / "table", files_per_part=3)
    for folder in (tmp_path / "whole", tmp_path / "table"):
        table = pd.read_parquet(folder).sort_values("file", ignore_index=True)
        pd.testing.assert_frame_equal(table, wanted, check_exact=True)


def test_a_part_that_was_being_replaced_is_finished_with(paths, undisturbed, tmp_path):
    retry = partial(linearize_in_place, [paths[3]], FourierLinearizer(), tmp_path / "table", retry_refused=True)
    shutil.copytree(undisturbed, tmp_path / "table")
    retry()
    after = _parts(tmp_path / "table")
    for name in set(_parts(undisturbed)) - set(after):
        shutil.copy(undisturbed / name, tmp_path / "table")
    with pytest.raises(ValueError, match=r"a run was ended while it replaced part-000001-.*call linearize_files again"):
        read_coefficients(tmp_path / "table")
    linearize_in_place(paths, FourierLinearizer(), tmp_path / "table")
    assert _parts(tmp_path / "table") == after


@pytest.mark.parametrize("n_bytes", [0, 100, -1])
def test_damaged_parts_are_made_anew(paths, undisturbed, tmp_path, n_bytes):
    folder = tmp_path / "table"
    shutil.copytree(undisturbed, folder)
    part = sorted(folder.glob("part-*"))[2]
    part.write_bytes(part.read_bytes()[:n_bytes])
    (folder / ".part.tmp").write_bytes(b"half")
    with pytest.raises(ValueError, match=rf"{part.name}: the file is damaged"):
        read_coefficients(folder)
    with pytest.warns(UserWarning, match=rf"{part.name}: the file was damaged and is deleted"):
        linearize_in_place(paths, FourierLinearizer(), folder, files_per_part=3)
    assert _parts(folder) == _parts(undisturbed)


def test_one_wrong_bit_is_found(paths, undisturbed, tmp_path):
    folder = tmp_path / "table"
    shutil.copytree(undisturbed, folder)
    part = sorted(folder.glob("part-*"))[0]
    data = bytearray(part.read_bytes())
    data[len(data) // 2] ^= 1
    part.write_bytes(data)
    with pytest.warns(UserWarning, match="was damaged"):
        linearize_in_place(paths, FourierLinearizer(), folder, files_per_part=3)
    assert _parts(folder) == _parts(undisturbed)


def test_files_can_be_added_and_finished_ones_are_not_read_again(paths, undisturbed, tmp_path):
    moved = [Path(shutil.copy(path, tmp_path / f"{number}.npz")) for number, path in enumerate(paths[:6])]
    linearize_in_place(moved[:4], FourierLinearizer(), tmp_path / "table")
    for path in moved[:4]:
        path.unlink()
    done = linearize_in_place(moved, FourierLinearizer(), tmp_path / "table")
    assert done[1:] == (6, 5, 1)
    table = read_coefficients(done.folder).drop(columns="file")
    pd.testing.assert_frame_equal(table, read_coefficients(undisturbed).drop(columns="file")[:5], check_exact=True)


# Settings.


def test_the_template_is_that_of_the_first_run(paths, tmp_path):
    rng = np.random.default_rng(0)
    walk, _ = make_walk(rng, name="other")
    other = type(walk)(walk.positions[:, ::-1], 120, type(walk.marker_set)(walk.marker_set.names[::-1]))
    write_walk(other, tmp_path / "other.npz")
    linearize_in_place(paths[:1], FourierLinearizer(), tmp_path / "table")
    done = linearize_in_place([tmp_path / "other.npz", paths[1]], FourierLinearizer(), tmp_path / "table")
    assert done[1:] == (3, 2, 1)
    with pytest.raises(ValueError, match=r"walks, channels: \['head_x'.* in the first run, \['right_ankle_x'.* now"):
        linearize_in_place(paths, FourierLinearizer().fit([other]), tmp_path / "table")


def test_other_settings_are_refused_all_at_once(paths, undisturbed):
    linearizer = FourierLinearizer(3, extras=("size",))
    with pytest.raises(ValueError, match="expected the settings with which its first rows were made") as caught:
        linearize_files(paths, linearizer, undisturbed, preparer=WalkPreparer(), read=make_from_seed)
    lines = str(caught.value).splitlines()[1:]
    ours = "tests.batch.walk_files.make_from_seed"
    for line in (
        "  linearizer, n_harmonics: 2 in the first run, 3 now",
        "  linearizer, extras: [] in the first run, ['size'] now",
        "  preparation, heading: None in the first run, 'path' now",
        f"  reading, read: 'eigenwalker.io.formats.read_walk' in the first run, {ours!r} now",
    ):
        assert line in lines


def test_another_version_is_refused(paths, undisturbed, tmp_path):
    shutil.copytree(undisturbed, tmp_path / "table")
    path = tmp_path / "table" / "_settings.json"
    stored = json.loads(path.read_text())
    stored["program"]["eigenwalker"] = "0.0.1"
    path.write_text(json.dumps(stored))
    with pytest.raises(ValueError, match=r"program, eigenwalker: '0\.0\.1' in the first run"):
        linearize_in_place(paths, FourierLinearizer(), tmp_path / "table")


def test_foreign_folders_are_left_alone(paths, tmp_path):
    (tmp_path / "thesis.tex").write_text("x")
    with pytest.raises(ValueError, match=r"without _settings\.json that holds thesis\.tex; choose another one"):
        linearize_in_place(paths, FourierLinearizer(), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_a_part_of_another_data_set_is_refused(paths, undisturbed, tmp_path):
    linearize_in_place(paths[:2], FourierLinearizer(3), tmp_path / "table")
    part = next((tmp_path / "table").glob("part-*"))
    shutil.copytree(undisturbed, tmp_path / "mixed")
    shutil.copy(part, tmp_path / "mixed" / part.name.replace("000000", "000099"))
    with pytest.raises(ValueError, match=r"000099.*got one of another; take it out"):
        linearize_in_place(paths, FourierLinearizer(), tmp_path / "mixed")


def _write_and_wait(out, ready):
    def seeds():
        yield 0
        ready.set()
        signal.pause()

    linearize_in_place(seeds(), FourierLinearizer(), out, read=make_from_seed)


@pytest.mark.skipif(not hasattr(signal, "pause"), reason="needs a Unix system")
def test_one_process_at_a_time(tmp_path):
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["tests.batch.walk_files"])
    ready = context.Event()
    process = context.Process(target=_write_and_wait, args=(tmp_path / "table", ready))
    process.start()
    try:
        assert ready.wait(60)
        with pytest.raises(ValueError, match="another process is writing to it"):
            linearize_in_place([0], FourierLinearizer(), tmp_path / "table", read=make_from_seed)
    finally:
        process.kill()
        process.join()
    assert linearize_in_place([0], FourierLinearizer(), tmp_path / "table", read=make_from_seed).n_walks == 1
