"""``eigenwalker style``: new walks from synthetic recordings of plain walks and of some on bent knees."""

import json
import re

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import GaitHSMM, load_model, make_walkers, prepare, read_walk, write_walk
from eigenwalker.hsmm import blend, label_steps
from eigenwalker.motion import prepare_walks, quality_table
from tests.hsmm.walking import shaken_walk, shaken_walks


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with recordings of four plain walks, and of two on bent knees, which are slower."""
    folder = tmp_path_factory.mktemp("recordings")
    for number, walk in enumerate(shaken_walks(4, jitter=0.02)):
        write_walk(walk, folder / f"plain_{number}.bvh")
    for number, walk in enumerate(shaken_walks(2, first=20, bend=0.3, frequency=0.75)):
        write_walk(walk, folder / f"bent_{number}.bvh")
    return folder


@pytest.fixture(scope="module")
def plain(folder):
    return sorted(folder.glob("plain_*"))


@pytest.fixture(scope="module")
def bent(folder):
    return sorted(folder.glob("bent_*"))


@pytest.fixture(scope="module")
def models(plain, bent):
    """Return the models that the command should train: of the average walk, and of the first bent one."""
    walks = prepare_walks(
        [read_walk(path) for path in (*plain, *bent)], representation="joints", clip="whole", frame_rate=60
    )
    average = GaitHSMM(frame_rate=60.0).fit(walks[:4])
    return average, average.adapt(walks[4:5])


def _knee(walk):
    return walk.rotations[:, walk.skeleton.index("LeftLeg"), 1].mean()


def test_a_walk_in_a_style(run, plain, bent, tmp_path):
    out = tmp_path / "new.bvh"
    status, printed, err = run("style", *plain, "--adapt", *bent, "--steps", 7, "--first", "left", "--out", out)
    assert status == 0
    assert "average: 4 walks, 34 steps, 60 frames a second\n  log-likelihood per frame " in printed
    assert "style: 2 walks, 14 steps\n  csmaplr+map, weight of transforms 1" in printed
    scores = re.search(r"walks held out (\S+), the best of 8 trials of weights, by the average model (\S+)\n", printed)
    assert float(scores[1]) > float(scores[2]) + 10
    walk = read_walk(out)
    assert f"wrote {out}: 7 steps, {walk.n_frames} frames at 60 a second, " in printed
    assert printed.endswith(" m/s, feet slip 0.0 mm a step\n")
    assert [line for line in err.splitlines() if line.startswith("iteration 1: log-likelihood ")]
    assert "iteration 1:" not in printed
    assert walk.frame_rate == 60
    walks = [prepare(read_walk(path), representation="joints", clip="whole") for path in (plain[0], out, bent[0])]
    assert _knee(walks[1]) == pytest.approx(_knee(walks[2]), abs=0.05)
    assert _knee(walks[1]) > _knee(walks[0]) + 0.2
    steps = label_steps(prepare(walk, representation="joints", clip="whole")).labels
    assert len(steps) in (6, 7)  # the last foot comes down where the walk ends
    row = quality_table([prepare(walk, representation="joints", clip="whole", treadmill=False)]).iloc[0]
    assert row["foot_slip_m_per_step"] < 1e-3


def test_it_is_what_the_estimator_makes(run, plain, bent, models, tmp_path):
    out, saved = tmp_path / "new.npz", tmp_path / "bent.skops"
    status, printed, _ = run("style", *plain, "--adapt", bent[0], "--steps", 5, "--out", out, "--save", saved)
    assert status == 0
    assert printed.endswith(f"saved {saved}\n")
    assert "held out" not in printed  # a single walk is not
    expected = models[1].synthesize(5)
    assert_allclose(read_walk(out).rotations, expected.rotations, atol=1e-9)
    loaded = load_model(saved)
    assert not loaded.verbose
    assert_allclose(loaded.synthesize(5).rotations, expected.rotations, atol=1e-9)
    assert loaded.adaptation_["method"] == "csmaplr+map"


def test_without_a_style_it_is_the_average_walk(run, plain, models, tmp_path):
    out, saved = tmp_path / "plain.npz", tmp_path / "plain.skops"
    arguments = ["--steps", 4, "--in-place", "--global-variance", "none", "--speed", 1.25, "--out", out]
    status, printed, _ = run("style", *plain, *arguments, "--save", saved)
    assert status == 0
    assert "style:" not in printed
    walk = read_walk(out)
    expected = models[0].synthesize(4, travel=False, global_variance=None, speed=1.25)
    assert_allclose(walk.rotations, expected.rotations, atol=1e-9)
    assert np.ptp(walk.root[:, 0]) < 0.2
    assert not hasattr(load_model(saved), "adaptation_")


def test_durations_are_drawn_by_a_seed(run, plain, tmp_path):
    walks = []
    for seed in (1, 1, 2):
        out = tmp_path / "drawn.npz"
        arguments = ["--steps", 4, "--durations", "sample", "--seed", seed, "--out", out]
        assert run("style", *plain[:2], *arguments)[0] == 0
        walks.append(read_walk(out))
    assert_array_equal(walks[0].rotations, walks[1].rotations)
    assert walks[0].n_frames != walks[2].n_frames or not np.allclose(walks[0].rotations, walks[2].rotations)


def test_options_of_adaptation(run, plain, bent, tmp_path):
    saved = tmp_path / "bent.skops"
    arguments = ["--method", "csmaplr", "--classes", 2, "--transform-weight", 300, "--steps", 4]
    status, printed, _ = run(
        "style", *plain, "--adapt", *bent, *arguments, "--out", tmp_path / "new.bvh", "--save", saved
    )
    assert status == 0
    assert "  csmaplr, weight of transforms 300, classes of states 2\n" in printed
    report = load_model(saved).adaptation_
    assert (report["method"], report["transform_weight"], report["n_classes_wanted"]) == ("csmaplr", 300.0, 2)


@pytest.mark.filterwarnings("default")  # the command prints them
def test_a_blend_lies_between_the_two_or_beyond(run, plain, bent, models, tmp_path):
    knees = {}
    for weight in (0.5, 1.5, 9.0):
        out = tmp_path / "new.npz"
        arguments = ["--steps", 5, "--weight", weight, "--out", out]
        status, _, err = run("style", *plain, "--adapt", bent[0], *arguments)
        assert status == 0
        assert ("beyond the joints of people" in err) == (weight > 5)
        expected = blend(*models, weight)
        assert_allclose(read_walk(out).rotations, expected.synthesize(5).rotations, atol=1e-9)
        knees[weight] = _knee(read_walk(out))
    assert knees[0.5] + 0.2 < knees[1.5]


def test_people_of_the_average_walk(run, plain, bent, tmp_path):
    table, saved = tmp_path / "who.csv", tmp_path / "bent.skops"
    arguments = ["--adapt", bent[0], "--walkers", table, "--steps", 4, "--out", tmp_path / "new.bvh", "--save", saved]
    people = pd.DataFrame({"file": [path.name for path in plain], "walker": [1, 1, 2, 2]})
    people.to_csv(table, index=False)
    status, printed, _ = run("style", *plain, *arguments)
    assert status == 0
    assert "average: 4 walks of 2 people, 34 steps" in printed
    walks = prepare_walks(
        [read_walk(path) for path in (*plain, bent[0])], representation="joints", clip="whole", frame_rate=60
    )
    expected = GaitHSMM(frame_rate=60.0).fit(walks[:4], walkers=list("1122")).adapt(walks[4:])
    assert load_model(saved).score(walks) == pytest.approx(expected.score(walks), rel=1e-9)
    for column, message in (
        ([1, 1, 1, 1], "needs walks of several people"),
        ([1, 1, 2, None], "who.csv: expected a walker in each row, got none for plain_3"),
    ):
        people.assign(walker=column).to_csv(table, index=False)
        status, _, err = run("style", *plain, *arguments)
        assert status == 1
        assert message in err
    people[:3].to_csv(table, index=False)
    assert "1 files without a row in the table: plain_3" in run("style", *plain, *arguments)[2]


def test_recordings_of_another_frame_rate_are_resampled(run, plain, tmp_path):
    slow = tmp_path / "slow.bvh"
    write_walk(shaken_walk(9, n_frames=150, frame_rate=30.0), slow)
    out = tmp_path / "new.bvh"
    status, printed, _ = run("style", *plain[:2], slow, "--frame-rate", 50, "--steps", 4, "--out", out)
    assert status == 0
    assert "average: 3 walks" in printed
    assert "50 frames a second" in printed
    assert read_walk(out).frame_rate == 50


def test_a_file_may_be_of_both(run, plain, bent, tmp_path):
    """An average walk of all that there is, the style among it."""
    status, printed, _ = run("style", *plain, bent[0], "--adapt", bent[0], "--steps", 4, "--out", tmp_path / "new.bvh")
    assert status == 0
    assert "average: 5 walks" in printed
    assert "style: 1 walks" in printed


def test_the_skeleton_of_a_file_is_kept(run, data_dir, tmp_path):
    """The written file goes the way of every recording, with that character's bones and axes."""
    files = sorted((data_dir / "bandai2").glob("*walk_normal_00[1-5].bvh"))
    out, plain = tmp_path / "new.bvh", tmp_path / "upright.bvh"
    assert run("style", *files, "--steps", 6, "--skeleton", files[0], "--out", out)[0] == 0
    assert run("style", *files, "--steps", 6, "--out", plain)[0] == 0
    written, original = read_walk(out), read_walk(files[0])
    inner = written.skeleton.index("Hips") + 1
    assert_allclose(written.skeleton.offsets[inner:], original.skeleton.offsets[inner:], atol=1e-7)
    one, other = (read_walk(path).to_markers().positions for path in (out, plain))
    assert_allclose(one, other, atol=1e-5)


def _refused(run, out, *arguments):
    status, _, err = run("style", *arguments, "--out", out)
    assert status == 1
    assert err.startswith("eigenwalker style: error: ") or "\neigenwalker style: error: " in err
    return err


def test_arguments_that_do_not_go_together_are_refused_at_once(run, plain, bent, tmp_path):
    out = tmp_path / "new.bvh"
    assert "--out must end in .bvh or .npz, files that hold joints, got new.csv" in _refused(
        run, out.with_suffix(".csv"), *plain
    )
    err = _refused(run, out, *plain, "--weight", 0.5, "--map-weight", 3)
    assert "--map-weight, --weight: what is adapted, and to what? give recordings of a style, --adapt FILE ..." in err
    style = [*plain, "--adapt", *bent]
    err = _refused(run, out, *style, "--method", "map", "--transform-weight", 3)
    assert "--transform-weight is for csmaplr, whose transforms have a prior, not for --method map" in err
    err = _refused(run, out, *style, "--method", "csmaplr", "--map-weight", 3)
    assert "--map-weight is for a method with map, got --method csmaplr" in err
    assert "--skeleton is for --out that ends in .bvh" in _refused(
        run, tmp_path / "new.npz", *plain, "--skeleton", plain[0]
    )
    err = _refused(run, tmp_path / "nowhere" / "new.bvh", *plain, "--save", tmp_path / "elsewhere" / "m.skops")
    assert f"--out: expected a folder that is there, got {tmp_path / 'nowhere'}" in err
    assert f"--save: expected a folder that is there, got {tmp_path / 'elsewhere'}" in err
    assert not list(tmp_path.iterdir())


def test_recordings_are_not_replaced(run, plain, bent, tmp_path):
    copy = tmp_path / "copy.bvh"
    copy.write_bytes(bent[0].read_bytes())
    for arguments in ([*plain, copy], [*plain, "--adapt", copy], [*plain, "--skeleton", copy]):
        err = _refused(run, copy, *arguments)
        assert f"--out must be another file than those that are read, got {copy}, which would be replaced" in err
    assert copy.read_bytes() == bent[0].read_bytes()
    err = _refused(run, tmp_path / "new.bvh", *plain, copy, "--save", copy)
    assert "--save must be another file than those that are read" in err


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--steps", "0", "expected a whole number, 1 or more, got '0'"),
        ("--classes", "1.5", "expected a whole number, 1 or more, got '1.5'"),
        ("--seed", "-1", "expected a whole number, 0 or more, got '-1'"),
        ("--speed", "0", "expected a number above zero, got '0'"),
        ("--frame-rate", "fast", "expected a number above zero, got 'fast'"),
        ("--map-weight", "-1", "expected zero or more, got '-1'"),
        ("--transform-weight", "nan", "expected zero or more, got 'nan'"),
        ("--weight", "inf", "expected a number, got 'inf'"),
        ("--method", "mllr", "invalid choice: 'mllr'"),
        ("--first", "both", "invalid choice: 'both'"),
    ],
)
def test_impossible_values(run, capsys, option, value, message):
    with pytest.raises(SystemExit):
        run("style", "plain.bvh", f"{option}={value}", "--out", "new.bvh")
    assert message in capsys.readouterr().err


def test_bad_recordings_are_named_or_left_out(run, plain, bent, tmp_path):
    """Files that are not there, damaged, without a skeleton, or without steps: all of them at once."""
    out, broken, markers, short = (tmp_path / name for name in ("new.bvh", "broken.bvh", "markers.csv", "short.bvh"))
    broken.write_bytes(plain[0].read_bytes()[:9000])
    write_walk(make_walkers(1, random_state=0).data[0], markers)
    write_walk(shaken_walk(7, n_frames=45), short)
    bad = [broken, markers, short, tmp_path / "none.bvh"]
    err = _refused(run, out, *plain, *bad[:2], "--adapt", *bent, *bad[2:])
    assert "4 of 10 recordings were refused; mend them, or leave them out with --skip-bad:" in err
    assert "broken.bvh, line " in err
    assert "'markers': expected a skeleton with joints, such as a BVH or AMC file has" in err
    assert "walk 'short': " in err
    assert "none.bvh" in err
    arguments = [*plain, *bad[:2], "--adapt", bent[0], *bad[2:], "--steps", 4, "--out", out, "--skip-bad"]
    status, printed, _ = run("style", *arguments)
    assert status == 0
    assert printed.startswith("refused: 4 of 9\n")
    assert "average: 4 walks" in printed
    assert "style: 1 walks" in printed
    out.unlink()
    err = _refused(run, out, *plain, "--adapt", short, "--skip-bad")
    assert "all 1 recordings of the style were refused:\n" in err
    assert "walk 'short': " in err
    assert "all 2 recordings of the average walk were refused:\n" in _refused(run, out, *bad[:2], "--skip-bad")
    assert not out.exists()


def test_too_few_frames_a_step_name_the_walk(run, plain, tmp_path):
    err = _refused(run, tmp_path / "new.bvh", *plain, "--frame-rate", 8)
    assert "walk 'plain_0': expected at least 5 frames a step, one a state, got 4" in err


def test_other_skeletons_are_refused_before_the_training(run, plain, data_dir, tmp_path):
    other = sorted((data_dir / "bandai2").glob("*walk_normal_*.bvh"))[0]
    err = _refused(run, tmp_path / "new.bvh", *plain, "--adapt", other)
    assert f"walk {other.stem!r}: expected the " in err
    assert "channels of the first walk in fit" in err
    assert "iteration" not in err


def test_a_skeleton_of_other_joints_is_refused(run, plain, tmp_path):
    markers = tmp_path / "markers.csv"
    write_walk(make_walkers(1, random_state=0).data[0], markers)
    err = _refused(run, tmp_path / "new.bvh", *plain[:2], "--steps", 4, "--skeleton", markers)
    assert f"--skeleton: expected a file with joints, such as BVH, got the markers of {markers}" in err


def test_help_names_defaults_and_choices(run, capsys):
    with pytest.raises(SystemExit) as caught:
        run("style", "--help")
    assert caught.value.code == 0
    printed = " ".join(capsys.readouterr().out.split())
    for words in ("number of steps (12)", "resampled (60)", "{csmaplr+map,csmaplr,cmllr+map,cmllr,map}", "(exact)"):
        assert words in printed


def test_gait_models_are_no_models_of_axes(run, plain, tmp_path):
    """What --save writes is not for the commands that take models of eigenwalker fit, and they say so."""
    saved = tmp_path / "plain.skops"
    assert run("style", *plain[:2], "--steps", 2, "--out", tmp_path / "new.bvh", "--save", saved)[0] == 0
    axis = ["--alpha", "style=1", "--out", tmp_path / "other.bvh"]
    for arguments in (
        ["walk", saved, *axis],
        ["restyle", plain[0], "--model", saved, *axis],
        ["view", saved, "--out", tmp_path / "page.html"],
    ):
        status, _, err = run(*arguments)
        assert status == 1
        assert "plain.skops: expected a model of trait axes, from eigenwalker fit, got a GaitHSMM" in err
        assert "load_model(path).synthesize(12)" in err
    assert json.dumps(load_model(saved).get_params())  # words and numbers
