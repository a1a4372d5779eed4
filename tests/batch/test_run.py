"""What is in a data set, where walks come from, and what is refused at once."""

from functools import partial

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
from tests.batch.walk_files import make_from_seed
from tests.joint_bodies import over_floor, swinging
from tests.synthetic import make_walk

linearize_in_place = partial(linearize_files, preparer="passthrough")
pytestmark = pytest.mark.filterwarnings("ignore:[0-9]+ of [0-9]+ walks were refused:UserWarning")


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
    table = pd.read_parquet(done.folder).set_index("file")
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
    assert list(pd.read_parquet(done.folder)["file"]) == ["0", "1", "2", "3", "4", "5"]


def test_options_of_the_reader(tmp_path):
    done = linearize_in_place([0, 1], FourierLinearizer(), tmp_path / "table", read=make_from_seed, n_cycles=5.0)
    np.testing.assert_allclose(read_coefficients(done.folder)["n_cycles"], 5, atol=0.05)
    with pytest.raises(ValueError, match=r"reading, read: .*'n_cycles': 5.0} in the first run, .*ake_from_seed' now"):
        linearize_in_place([0, 1], FourierLinearizer(), tmp_path / "table", read=make_from_seed)


def test_several_walks_in_a_file(tmp_path):
    done = linearize_in_place([0, 2, 5], FourierLinearizer(), tmp_path / "table", read=_several)
    assert done[1:] == (3, 5, 2)
    table = pd.read_parquet(done.folder)
    assert list(table["file"]) == ["0", "0", "2", "2", "2", "5", "5"]
    assert list(table["reason"].notna()) == [False, False, False, True, True, False, False]
    assert table["reason"][4] == "no more of them"


def test_a_file_without_walks_is_refused(tmp_path):
    done = linearize_in_place([0, 1], FourierLinearizer(), tmp_path / "table", read=_none)
    assert refused_files(done.folder)["reason"].to_list() == ["expected at least one walk in the file, got none"]


def _one_of_two(item):
    return make_from_seed(item[1])


def test_tuples_have_a_text_of_their_own(paths, tmp_path):
    items = [(paths[0], 0), (paths[0], 1), ("b", np.int64(1))]
    done = linearize_in_place(items, FourierLinearizer(), tmp_path / "table", read=_one_of_two)
    assert done[1:] == (3, 3, 0)


def test_what_comes_twice_is_done_once(paths, tmp_path):
    done = linearize_in_place([paths[0], str(paths[0]), paths[1]], FourierLinearizer(), tmp_path / "table")
    assert done.n_walks == 2


def test_an_error_of_the_generator_is_not_lost(tmp_path):
    def seeds():
        yield from range(40)
        raise KeyError("end of the list")

    with pytest.raises(KeyError, match="end of the list"):
        linearize_in_place(seeds(), FourierLinearizer(), tmp_path / "table", read=make_from_seed)


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


def _nothing(seed):
    return None


def _broken(seed):
    raise KeyError("trial")


@pytest.mark.parametrize(
    ("read", "error", "message"),
    [(_nothing, TypeError, "must return a walk or an iterable of walks, got NoneType"), (_broken, KeyError, "trial")],
)
def test_errors_of_the_first_file_name_it(tmp_path, read, error, message):
    with pytest.raises(error, match=message) as caught:
        linearize_in_place([7], FourierLinearizer(), tmp_path / "table", read=read)
    assert caught.value.__notes__ == ["while 7 was read, prepared and linearized"]


@pytest.mark.parametrize("item", [np.arange(2000.0), make_from_seed(0), ["a.npz"], ("a.npz", [1]), None])
def test_items_whose_text_may_be_that_of_others_are_refused(tmp_path, item):
    with pytest.raises(TypeError, match="paths must hold paths, numbers or tuples of these, got"):
        linearize_in_place(
            [item], FourierLinearizer().fit([make_from_seed(0)]), tmp_path / "table", read=make_from_seed
        )


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "table").write_text("")
    with pytest.raises(ValueError, match="out must be a folder, got the file"):
        linearize_in_place([0], FourierLinearizer(), tmp_path / "table", read=make_from_seed)


def test_pyarrow_is_named_where_it_is_missing(monkeypatch, tmp_path):
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(ImportError, match=r"pip install 'eigenwalker\[parquet\]'"):
        linearize_files([0], FourierLinearizer(), tmp_path / "table")


def test_progress(paths, tmp_path, capsys):
    linearize_in_place(paths[:2], FourierLinearizer(), tmp_path / "table", progress=True)
    assert capsys.readouterr().err == ""  # not before two seconds
