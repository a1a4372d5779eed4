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
    JointWalk,
    WalkError,
    WalkPreparer,
    make_walkers,
    prepare,
    read_walk,
    walk_quality,
    write_walk,
)
from eigenwalker.batch import linearize_files, read_coefficients, read_linearizer, refused_files
from tests.batch.walk_files import linearize_and_die, make_from_seed, write_files
from tests.joint_bodies import over_floor, swinging
from tests.synthetic import make_walk

N_FILES = 22
N_KILLS = 20

linearize_in_place = partial(linearize_files, preparer="passthrough")
pytestmark = pytest.mark.filterwarnings("ignore:[0-9]+ of [0-9]+ walks were refused:UserWarning")


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    return write_files(tmp_path_factory.mktemp("walks"), N_FILES)


@pytest.fixture(scope="module")
def undisturbed(paths, tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed") / "coefficients"
    linearize_in_place(paths, FourierLinearizer(), folder, files_per_part=3)
    return folder


def _table(folder):
    return pd.read_parquet(folder)


def _parts(folder):
    return {path.name: path.read_bytes() for path in folder.glob("part-*.parquet")}


# What is in it.


def test_rows_are_what_preparer_linearizer_and_quality_say(tmp_path):
    walks = make_walkers(3, treadmill=False, duration=8, frame_rate=60, random_state=0).data
    files = [tmp_path / f"{walk.name}.npz" for walk in walks]
    for walk, path in zip(walks, files, strict=True):
        write_walk(walk, path)
    linearizer = FourierLinearizer(3, extras=("speed",))
    done = linearize_files(files, linearizer, tmp_path / "table", preparer=WalkPreparer(cutoff=8.0))
    assert done == (tmp_path / "table", 3, 3, 0)
    assert not hasattr(linearizer, "template_")
    prepared = [prepare(walk, cutoff=8.0) for walk in walks]
    table = read_coefficients(done.folder)
    names = linearizer.fit(prepared).get_feature_names_out()
    np.testing.assert_array_equal(table[names], linearizer.transform(prepared))
    assert list(read_linearizer(done.folder).get_feature_names_out()) == list(names)
    assert list(table["file"]) == [str(path) for path in files]
    quality = pd.DataFrame([walk_quality(walk, n_harmonics=3) for walk in prepared])
    shared = [name for name in quality if name in table]
    assert shared == list(quality)
    pd.testing.assert_frame_equal(table[shared], quality, check_dtype=False, rtol=1e-12)


def test_the_way_back_to_walks(undisturbed):
    linearizer = read_linearizer(undisturbed)
    features = read_coefficients(undisturbed, columns=linearizer.get_feature_names_out())
    back = linearizer.transform(linearizer.inverse_transform(features[:2]))
    np.testing.assert_allclose(back, features[:2], atol=1e-9)


def test_refused_files_appear_once_with_their_reason(paths, tmp_path):
    damaged, absent, other = tmp_path / "damaged.npz", tmp_path / "absent.npz", tmp_path / "other.npz"
    damaged.write_bytes(b"PK nothing")
    rng = np.random.default_rng(0)
    walk, _ = make_walk(rng, name="other")
    names = (*walk.marker_set.names[:-1], "tail")
    write_walk(type(walk)(walk.positions, 120, type(walk.marker_set)(names), name="other"), other)
    given = [paths[0], damaged, absent, other, paths[3], paths[1]]
    with pytest.warns(UserWarning, match=r"4 of 6 walks were refused.*damaged\.npz: .*expected an archive"):
        done = linearize_in_place(given, FourierLinearizer(), tmp_path / "table")
    assert done[1:] == (6, 2, 4)
    refused = refused_files(done.folder).set_index("file")
    assert list(refused.index) == [str(path) for path in given[1:5]]
    assert list(refused["name"].isna()) == [True, True, False, False]
    for path, reason in (
        (damaged, "expected an archive"),
        (absent, "No such file"),
        (other, "missing: right_ankle_x, right_ankle_y, right_ankle_z; unknown: tail_x"),
        (paths[3], "does not move at all"),
    ):
        assert reason in refused.loc[str(path), "reason"]
    table = _table(done.folder).set_index("file")
    assert table.loc[refused.index, "duration":].isna().all(axis=None)
    assert table.loc[[str(paths[0]), str(paths[1])], "mean_head_x":].notna().all(axis=None)


def test_what_was_warned_of_is_in_the_table(tmp_path):
    walk = make_walkers(1, treadmill=False, duration=8, frame_rate=60, random_state=0).data[0]
    positions = walk.positions.copy()
    positions[:3] = np.nan
    write_walk(walk.with_channels(positions.reshape(len(positions), -1)), tmp_path / "gap.npz")
    write_walk(walk, tmp_path / "whole.npz")
    files = [tmp_path / "gap.npz", tmp_path / "whole.npz"]
    said = read_coefficients(linearize_files(files, FourierLinearizer(), tmp_path / "table").folder)["warnings"]
    assert "frames" in said[0]
    assert said.isna()[1]


def test_joints(tmp_path):
    walks = [over_floor(swinging(0.1 * np.arange(400), seed=seed, frame_rate=60.0)) for seed in range(3)]
    files = [tmp_path / f"{number}.npz" for number in range(3)]
    for walk, path in zip(walks, files, strict=True):
        write_walk(walk, path)
    preparer = WalkPreparer(representation="joints", reference=np.zeros((len(walks[0].skeleton.joint_names), 3)))
    fitted = linearize_files(files, FourierLinearizer(), tmp_path / "fitted", preparer=preparer.fit(walks)).folder
    expected = FourierLinearizer().fit_transform(preparer.transform(walks))
    linearizer = read_linearizer(fitted)
    assert isinstance(linearizer.template_, JointWalk)
    np.testing.assert_array_equal(read_coefficients(fitted)[linearizer.get_feature_names_out()], expected)
    assert read_coefficients(fitted, columns=["path_residual"]).isna().all(axis=None)
    learned = linearize_files(
        files, FourierLinearizer(), tmp_path / "learned", preparer=WalkPreparer(**preparer.get_params())
    ).folder
    turned = prepare(walks[0], **preparer.get_params()).channel_joints
    assert read_linearizer(learned).template_.channel_joints == turned


def test_markers_among_joints_are_refused(tmp_path):
    walk = over_floor(swinging(0.1 * np.arange(400), seed=0, frame_rate=60.0))
    write_walk(walk, tmp_path / "joints.npz")
    write_walk(make_from_seed(0), tmp_path / "markers.npz")
    preparer = WalkPreparer(representation="joints", reference=np.zeros((len(walk.skeleton.joint_names), 3)))
    files = [tmp_path / "markers.npz", tmp_path / "joints.npz"]
    done = linearize_files(files, FourierLinearizer(), tmp_path / "table", preparer=preparer)
    assert done[1:] == (2, 1, 1)
    assert "expected joints" in refused_files(done.folder)["reason"][0]


# Where walks come from.


def _several(seed):
    yield make_from_seed(seed)
    yield make_from_seed(seed + 1)
    if seed == 2:
        raise WalkError("no more of them")


def _none(seed):
    return [make_from_seed(seed)] if seed == 0 else []


def test_walks_made_on_the_fly(tmp_path):
    done = linearize_in_place((seed for seed in range(6)), FourierLinearizer(), tmp_path / "table", read=make_from_seed)
    assert done[1:] == (6, 5, 1)
    assert list(_table(done.folder)["file"]) == ["0", "1", "2", "3", "4", "5"]


def test_options_of_the_reader(tmp_path):
    done = linearize_in_place([0, 1], FourierLinearizer(), tmp_path / "table", read=make_from_seed, n_cycles=5.0)
    np.testing.assert_allclose(read_coefficients(done.folder)["n_cycles"], 5, atol=0.05)
    with pytest.raises(ValueError, match=r"reading, read: .*'n_cycles': 5.0} in the first run, .*ake_from_seed' now"):
        linearize_in_place([0, 1], FourierLinearizer(), tmp_path / "table", read=make_from_seed)


def test_several_walks_in_a_file(tmp_path):
    done = linearize_in_place([0, 2, 5], FourierLinearizer(), tmp_path / "table", read=_several)
    assert done[1:] == (3, 5, 2)
    table = _table(done.folder)
    assert list(table["file"]) == ["0", "0", "2", "2", "2", "5", "5"]
    assert list(table["reason"].notna()) == [False, False, False, True, True, False, False]
    assert table["reason"][4] == "no more of them"


def test_a_file_without_walks_is_refused(tmp_path):
    done = linearize_in_place([0, 1], FourierLinearizer(), tmp_path / "table", read=_none)
    assert refused_files(done.folder)["reason"].to_list() == ["expected at least one walk in the file, got none"]


def test_what_comes_twice_is_done_once(paths, tmp_path):
    done = linearize_in_place([paths[0], str(paths[0]), paths[1]], FourierLinearizer(), tmp_path / "table")
    assert done.n_walks == 2


def test_an_error_of_the_generator_is_not_lost(tmp_path):
    def seeds():
        yield from range(40)
        raise KeyError("end of the list")

    with pytest.raises(KeyError, match="end of the list"):
        linearize_in_place(seeds(), FourierLinearizer(), tmp_path / "table", read=make_from_seed)


# Independence.


def test_processes_and_parts_do_not_matter(paths, undisturbed, tmp_path):
    two = linearize_in_place(paths, FourierLinearizer(), tmp_path / "two", n_jobs=2, files_per_part=3).folder
    assert _parts(two) == _parts(undisturbed)
    one = linearize_in_place(iter(paths), FourierLinearizer(), tmp_path / "one").folder
    pd.testing.assert_frame_equal(_table(one), _table(undisturbed), check_exact=True)


def test_processes_that_were_started_in_another_folder_do_not_matter(paths, undisturbed, tmp_path, monkeypatch):
    folder = paths[0].parents[1]
    joblib.Parallel(n_jobs=2)(joblib.delayed(os.getpid)() for _ in range(8))  # joblib keeps them for the next call
    monkeypatch.chdir(folder)
    files = [path.relative_to(folder) for path in paths]
    table = linearize_in_place(files, FourierLinearizer(), tmp_path / "table", n_jobs=2).folder
    drop = ["file", "reason"]  # which say the paths
    pd.testing.assert_frame_equal(
        _table(table).drop(columns=drop), _table(undisturbed).drop(columns=drop), check_exact=True
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
    table = _table(tmp_path / "table").sort_values("file", ignore_index=True)
    wanted = _table(undisturbed).set_index("file").loc[[str(path) for path in paths[:8]]].reset_index()
    assert list(table["file"]) == [str(path) for path in given]
    pd.testing.assert_frame_equal(table.drop(columns="file"), wanted.drop(columns="file"), check_exact=True)


def test_killed_while_refused_files_are_read_again(run_and_kill, paths, undisturbed, tmp_path):
    shutil.copytree(undisturbed, tmp_path / "whole")
    code, n_steps = run_and_kill(paths, tmp_path / "whole", 0, retry_refused=True)
    assert code == 0
    wanted = _table(undisturbed).sort_values("file", ignore_index=True)
    shutil.copytree(undisturbed, tmp_path / "table")
    limits = np.random.default_rng(0).integers(1, n_steps, size=N_KILLS)
    for limit in limits:
        assert run_and_kill(paths, tmp_path / "table", int(limit), retry_refused=True)[0] in (-signal.SIGKILL, 0)
        assert not _table(tmp_path / "table")["file"].duplicated().any()
    linearize_in_place(paths, FourierLinearizer(), tmp_path / "table", files_per_part=3)
    for folder in (tmp_path / "whole", tmp_path / "table"):
        table = _table(folder).sort_values("file", ignore_index=True)
        pd.testing.assert_frame_equal(table, wanted, check_exact=True)


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
    for line in (
        "  linearizer, n_harmonics: 2 in the first run, 3 now",
        "  linearizer, extras: [] in the first run, ['size'] now",
        "  preparation, heading: None in the first run, 'path' now",
        "  reading, read: 'eigenwalker....ats.read_walk' in the first run, 'tests.batch....ake_from_seed' now",
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


# What is refused at once.


def test_nothing_usable(paths, tmp_path):
    with pytest.raises(WalkError, match=r"no walk is usable in 2 files:\n  .*001\.npz: .*not move at all"):
        linearize_in_place([paths[3], paths[7]], FourierLinearizer(), tmp_path / "table")
    done = linearize_in_place([paths[3]], FourierLinearizer().fit([read_walk(paths[0])]), tmp_path / "table")
    assert done[1:] == (1, 0, 1)
    assert len(read_coefficients(done.folder)) == 0


@pytest.mark.parametrize(
    ("arguments", "error", "match"),
    [
        ({"paths": "a.bvh"}, TypeError, "got the single path 'a.bvh'"),
        ({"paths": 3}, TypeError, "iterable of paths, got int"),
        ({"paths": []}, ValueError, "at least one path"),
        ({"linearizer": WalkPreparer()}, TypeError, "a FourierLinearizer, got WalkPreparer"),
        ({"preparer": "none"}, TypeError, "a WalkPreparer, 'passthrough' or None, got 'none'"),
        ({"read": lambda path: None}, TypeError, "a function with a name"),
        ({"files_per_part": 0}, ValueError, "at least 1, got 0"),
        ({"linearizer": FourierLinearizer(0)}, ValueError, "n_harmonics must be a whole number"),
    ],
)
def test_wrong_arguments(tmp_path, arguments, error, match):
    call = {"paths": [0], "linearizer": FourierLinearizer(), "read": make_from_seed, "preparer": "passthrough"}
    with pytest.raises(error, match=match):
        linearize_files(out=tmp_path / "table", **(call | arguments))


def _wrong_kind(seed):
    return [make_from_seed(seed), "walk"]


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_other_errors_name_the_file(tmp_path, n_jobs):
    linearizer = FourierLinearizer().fit([make_from_seed(0)])
    with pytest.raises(TypeError, match="an iterable of walks, got str in it") as caught:
        linearize_in_place([7], linearizer, tmp_path / "table", read=_wrong_kind, n_jobs=n_jobs)
    assert caught.value.__notes__ == ["while 7 was read, prepared and linearized"]


def test_pyarrow_is_named_where_it_is_missing(monkeypatch, tmp_path):
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(ImportError, match=r"pip install 'eigenwalker\[parquet\]'"):
        linearize_files([0], FourierLinearizer(), tmp_path / "table")


def test_progress(paths, tmp_path, capsys):
    linearize_in_place(paths[:2], FourierLinearizer(), tmp_path / "table", progress=True)
    assert capsys.readouterr().err == ""  # not before two seconds
