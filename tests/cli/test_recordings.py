"""Recordings as laboratories have them, brought through the command line: passes, gaps, pools, static trials."""

import argparse
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from eigenwalker import load_model, make_walkers, read_walk, write_walk
from eigenwalker.cli._preparation import add_preparation_arguments, make_preparation
from eigenwalker.motion import Walk, asymmetry_index
from notebooks.synthetic_recordings import there_and_back

KINDS = ["--label-pattern", r"(?P<kind>[ab])_(?P<person>p\d)", "--trait", "kind", "--components", 3]


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(8, treadmill=False, duration=7, frame_rate=60, random_state=0).data


@pytest.fixture(scope="module")
def passes(walkers, tmp_path_factory):
    """Return recordings there and back in files of two formats: two of each of four persons."""
    folder = tmp_path_factory.mktemp("passes")
    endings = (".csv", ".c3d")
    files = [folder / f"{'ab'[number % 2]}_p{number // 2}{endings[number % 2]}" for number in range(8)]
    for walk, file in zip(walkers, files, strict=True):
        write_walk(there_and_back(walk), file)
    return files


def test_labels_follow_the_passes(run, passes, tmp_path):
    model, out = tmp_path / "m.skops", tmp_path / "walk.npz"
    status, printed, _ = run("fit", *passes, *KINDS, "--passes", "--out", model)
    assert status == 0
    assert "recordings: 8, passes: 16, refused: 0" in printed
    assert "kind, leaving out one recording at a time" in printed
    assert "over 16 walks" in printed
    assert run("walk", model, "--alpha", "kind=1.5", "--base", passes[0], "--passes", "--out", out)[0] == 0
    np.testing.assert_allclose(load_model(model).transform([read_walk(out)]), [[1.5]], atol=1e-6)


def test_passes_of_a_recording_are_left_out_together(run, walkers, tmp_path):
    """A pass whose other passes are in the training is no news: with labels at random it would be known again."""
    rng = np.random.default_rng(0)
    files = [tmp_path / f"{kind}_p{number}.npz" for number, kind in enumerate("abababab")]
    for file in files:
        walk = walkers[int(rng.integers(8))]
        write_walk(there_and_back(walk), file)
    arguments = [*files, *KINDS, "--passes", "--out", tmp_path / "m.skops"]
    with_person = run("fit", *arguments, "--group", "person")[1]
    without = run("fit", *arguments)[1]
    pick = [line.partition(": ")[2] for line in (*with_person.splitlines(), *without.splitlines()) if "leaving" in line]
    assert pick[0] == pick[1]


def test_passes_of_a_recording_make_one_walk(run, passes, tmp_path):
    pool = ["--passes", "--pool", "recording"]
    status, printed, _ = run("fit", *passes, *KINDS, *pool, "--out", tmp_path / "m.skops")
    assert status == 0
    assert "pooled: 16 walks of 8 recordings" in printed
    assert "over 8 walks" in printed


def test_walks_of_a_person_make_one_walk(run, walkers, tmp_path):
    files = [tmp_path / f"{'ab'[number % 2]}_p{number}_{trial}.npz" for number in range(8) for trial in range(2)]
    for number, file in enumerate(files):
        walk = walkers[number // 2]
        write_walk(replace(walk, positions=walk.positions[60 * (number % 2) :]), file)
    arguments = ["--group", "person", "--pool", "person", "--out", tmp_path / "m.skops"]
    status, printed, _ = run("fit", *files, *KINDS, *arguments)
    assert status == 0
    assert "pooled: 16 walks of 8 persons" in printed
    assert "kind, leaving out one person at a time" in printed
    assert "over 8 walks" in printed
    other = ["--label-pattern", r"_(?P<person>p\d)_(?P<trial>\d)", "--trait", "trial"]
    status, _, error = run("fit", *files, *other, *arguments)
    assert status == 1
    assert "--pool person makes one walk with one label, but there are several: trial of p0, p1" in error


def test_noise_within_persons_is_the_scale(run, walkers, tmp_path):
    rng = np.random.default_rng(0)
    files = [tmp_path / f"{'ab'[number % 2]}_p{number}_{trial}.npz" for number in range(8) for trial in range(2)]
    for number, file in enumerate(files):
        walk = walkers[number // 2]
        write_walk(replace(walk, positions=walk.positions + 0.01 * rng.normal(size=walk.positions.shape)), file)
    model = tmp_path / "m.skops"
    status, printed, _ = run("fit", *files, *KINDS, "--group", "person", "--scaling", "noise", "--out", model)
    assert status == 0
    assert "kind, leaving out one person at a time: accuracy" in printed
    assert load_model(model)["scaler"].unit == "noise"
    assert run("fit", *files, *KINDS, "--scaling", "none", "--out", model)[0] == 0
    assert load_model(model)["scaler"].unit is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--pool", "recording"], "--pool recording puts passes together; it needs --passes"),
        (["--pool", "person"], "--pool person needs --group, the column that says which person a file is of"),
        (["--scaling", "noise"], "--scaling noise needs --group, the column that says which person"),
        (
            ["--scaling", "noise", "--pool", "person", "--group", "person"],
            "compares a person's walks, but --pool person leaves only one",
        ),
        (["--frequency-range", 1.3, 0.6], "--frequency-range must be LOW HIGH, the lower one first, got 1.3 0.6"),
        (["--static", "none.c3d"], "none.c3d"),
    ],
)
def test_arguments_that_do_not_go_together(run, passes, tmp_path, arguments, message):
    status, _, error = run("fit", *passes, *KINDS, *arguments, "--out", tmp_path / "m.skops")
    assert status == 1
    assert message in error


@pytest.mark.parametrize("argument", ["--cutoff", "--max-gap"])
def test_what_must_be_positive(run, capsys, argument):
    with pytest.raises(SystemExit):
        run("gait", "walk.c3d", argument, "-1")
    assert f"argument {argument}: expected a number above zero, got '-1'" in capsys.readouterr().err


def _preparation(*arguments):
    parser = argparse.ArgumentParser()
    add_preparation_arguments(parser)
    return make_preparation(parser.parse_args([str(argument) for argument in arguments]), reading={})


def test_each_argument_is_one_of_prepare():
    plain = _preparation().options
    changes = {
        ("--camera", "moving"): {"camera": "moving"},
        ("--cutoff", "6"): {"cutoff": 6.0},
        ("--frequency", "events"): {"frequency": "events"},
        ("--frequency-range", "0.6", "1.3"): {"frequency_range": (0.6, 1.3)},
        ("--steady-cadence",): {"cadence": "steady"},
        ("--symmetrize",): {"symmetrize": True},
    }
    for arguments, change in changes.items():
        assert _preparation(*arguments).options == plain | change
    assert (_preparation("--max-gap", 0.2).max_gap, _preparation("--passes").passes) == (0.2, True)


def test_base_is_prepared_like_the_recordings(run, passes, tmp_path):
    model, preparation = tmp_path / "m.skops", ["--passes", "--steady-cadence", "--cutoff", 8, "--symmetrize"]
    assert run("fit", *passes, *KINDS, *preparation, "--out", model)[0] == 0
    found = []
    for arguments in (preparation[:-1], preparation):
        out = tmp_path / f"walk_{len(arguments)}.npz"
        assert run("walk", model, "--alpha", "kind=1", "--base", passes[0], *arguments, "--out", out)[0] == 0
        found.append(asymmetry_index(read_walk(out)).motion)
    assert found[1] < found[0] / 10  # not zero: passes are put together after each was made symmetric


def test_gaps_are_filled_when_asked(run, walkers, tmp_path):
    files = [tmp_path / f"{'ab'[number % 2]}_p{number}.csv" for number in range(8)]
    for walk, file in zip(walkers, files, strict=True):
        positions = walk.positions.copy()
        positions[200:206, 5] = np.nan
        write_walk(replace(walk, positions=positions), file)
    arguments = [*files, *KINDS, "--out", tmp_path / "m.skops"]
    status, _, error = run("fit", *arguments)
    assert status == 1
    assert "8 of 8 recordings were refused" in error
    assert run("fit", *arguments, "--max-gap", 0.2)[0] == 0


def test_refused_passes_are_counted_by_label(run, passes, walkers, tmp_path):
    bad = tmp_path / "a_p9.csv"
    positions = there_and_back(walkers[0]).positions.copy()
    positions[-100:-60, 0] = np.nan  # the head, in the second pass
    write_walk(replace(walkers[0], positions=positions), bad)
    arguments = [*passes, bad, *KINDS, "--passes", "--out", tmp_path / "m.skops"]
    status, printed, error = run("fit", *arguments)
    assert status == 1
    assert "recordings: 9, passes: 18, refused: 1" in printed
    assert "kind a: 1 of 10 refused" in printed
    assert "1 of 18 passes were refused; mend them, or leave them out with --skip-bad" in error
    assert "walk 'a_p9_pass2'" in error
    status, printed, _ = run("fit", *arguments, "--skip-bad")
    assert status == 0
    assert "over 17 walks" in printed
    status, _, error = run(
        "walk", tmp_path / "m.skops", "--alpha", "kind=1", "--base", bad, "--out", tmp_path / "w.npz"
    )
    assert status == 1
    assert "--base was refused:\n  walk 'a_p9'" in error


@pytest.fixture
def folders(walkers, tmp_path):
    """Return files that are called the same in a folder for each person."""
    files = [tmp_path / f"p{number // 2}" / f"{number % 2}.npz" for number in range(8)]
    for walk, file in zip(walkers, files, strict=True):
        file.parent.mkdir(exist_ok=True)
        write_walk(walk, file)
    return files


def test_files_of_the_same_name_in_folders(run, folders, tmp_path):
    fit = ["fit", *folders, "--trait", "kind", "--group", "person", "--components", 3, "--out", tmp_path / "m.skops"]
    status, printed, _ = run(*fit, "--label-pattern", r"(?P<person>p\d)/(?P<kind>\d)\.npz$")
    assert status == 0
    assert "over 8 walks" in printed
    labels = pd.DataFrame({"file": [f"{file.parent.name}/{file.name}" for file in folders], "kind": [0, 1] * 4})
    labels["person"] = [file.parent.name for file in folders]
    labels.to_csv(tmp_path / "labels.csv", index=False)
    again = run(*fit, "--labels", tmp_path / "labels.csv")
    assert again[:2] == (0, printed)
    labels["file"] = [file.name for file in folders]
    labels.to_csv(tmp_path / "labels.csv", index=False)
    status, _, error = run(*fit, "--labels", tmp_path / "labels.csv")
    assert status == 1
    assert "8 files without a row in the table: p0/0, p0/1" in error
    status, printed, _ = run("gait", *folders)
    assert status == 0
    assert [line.split()[0] for line in printed.splitlines()[1:]] == [f"p{n // 2}/{n % 2}" for n in range(8)]


def test_static_trial_must_be_of_markers(run, data_dir):
    joints = data_dir / "bandai2" / "dataset-2_walk_active_001.bvh"
    markers = data_dir / "horst_c3d" / "S01_0001_Static.c3d"
    status, _, error = run("gait", markers, "--static", joints)
    assert status == 1
    assert "--static must be a recording of markers, such as a C3D file, got the joints of" in error
    status, _, error = run("gait", joints, "--static", markers)
    assert status == 1
    assert "a static trial completes markers, and this recording has joints" in error


@pytest.mark.filterwarnings("ignore:2 harmonics explain less than 50%")
def test_people_before_a_kinect(run, data_dir, tmp_path):
    """From the folder as it is published to a model; each file is a person who walks to and fro."""
    people = pd.read_csv(data_dir / "kinect" / "person-data.csv").dropna(subset="Gender")
    people = people.groupby("Gender").head(5)
    files = [file for person in people["Individual"] for file in sorted((data_dir / "kinect" / person).glob("*.txt"))]
    table = pd.DataFrame({"file": [f"{file.parent.name}/{file.stem}" for file in files]})
    table["person"] = [file.parent.name for file in files]
    table = table.merge(people.rename(columns={"Gender": "sex"}), left_on="person", right_on="Individual")
    table.to_csv(tmp_path / "labels.csv", index=False)
    labels = ["--labels", tmp_path / "labels.csv", "--trait", "sex", "--group", "person", "--components", 5]
    preparation = ["--passes", "--camera", "moving", "--symmetrize", "--frequency-range", 0.6, 1.3]
    model = ["--pool", "recording", "--scaling", "noise", "--skip-bad", "--out", tmp_path / "m.skops"]
    status, printed, _ = run("fit", *files, *labels, *preparation, *model)
    assert status == 0
    assert f"walks of {len(files)} recordings" in printed
    assert "sex, leaving out one person at a time: accuracy" in printed
    base = ["--base", files[0], *preparation, "--out", tmp_path / "walk.c3d"]
    assert run("walk", tmp_path / "m.skops", "--alpha", "sex=2", *base)[0] == 0
    assert isinstance(read_walk(tmp_path / "walk.c3d"), Walk)
