"""The command line with joint angles, and with more than two styles."""

import re

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import JointWalk, WalkError, load_model, make_walkers, prepare, read_walk, write_walk
from eigenwalker.cli._styles import one_against_rest, poles_of, style_columns

_PATTERN = r"walk_(?P<style>[a-z]+)_"


def _files(data_dir, styles, n_files):
    folder = data_dir / "bandai2"
    return [path for style in styles for path in sorted(folder.glob(f"*walk_{style}_*.bvh"))[:n_files]]


@pytest.fixture(scope="module")
def files(data_dir):
    return _files(data_dir, ("active", "elderly", "normal"), 6)


def _fit(run, files, out, *more):
    arguments = ["--label-pattern", _PATTERN, "--trait", "style", "--components", 5, "--representation", "joints"]
    return run("fit", *files, *arguments, "--out", out, *more)


def _bones(walk):
    """Return the offsets below the hips, whose own is where the first frame has them."""
    return walk.skeleton.offsets[walk.skeleton.index("Hips") + 1 :]


@pytest.fixture
def model(run, files, tmp_path):
    assert _fit(run, files, tmp_path / "styles.skops")[0] == 0
    return tmp_path / "styles.skops"


def test_three_styles_are_three_axes_with_their_baselines(run, files, tmp_path):
    status, out, _ = _fit(run, files, tmp_path / "styles.skops")
    assert status == 0
    for style in ("active", "elderly", "normal"):
        assert f"style={style}, leaving out one recording at a time: accuracy" in out
        assert re.search(rf"mean alpha: not {style} -\d.\d\d, {style} \+\d.\d\d", out)
    assert re.search(r"style, the highest of 3 axes: accuracy .* over 18 walks \(always the larger group: 33.3%\)", out)
    assert out.count("frequency and speed alone: accuracy") == 3
    assert "frequency and speed alone, discriminant analysis: accuracy" in out
    assert "--alpha style=active=2 --out walk.bvh" in out
    model = load_model(tmp_path / "styles.skops")
    assert model["trait"].trait_names_ == ["style=active", "style=elderly", "style=normal"]
    template = model["linearizer"].template_
    assert isinstance(template, JointWalk)
    assert template.skeleton.upright
    assert len(template.channel_names) == 63


def test_two_styles_stay_one_axis(run, data_dir, tmp_path):
    status, out, _ = _fit(run, _files(data_dir, ("elderly", "normal"), 5), tmp_path / "m.skops")
    assert status == 0
    assert "style, leaving out one recording at a time: accuracy" in out
    assert "the highest of" not in out
    assert load_model(tmp_path / "m.skops")["trait"].poles_ == {"style": ("elderly", "normal")}


def test_many_styles_in_markers(run, files, tmp_path):
    arguments = ["--label-pattern", _PATTERN, "--trait", "style", "--components", 5]
    assert run("fit", *files, *arguments, "--out", tmp_path / "m.skops")[0] == 0
    written = tmp_path / "walk.csv"
    assert run("walk", tmp_path / "m.skops", "--alpha", "style=elderly=1", "--out", written)[0] == 0


def test_a_label_of_one_recording_only_is_no_axis(run, data_dir, files, tmp_path):
    alone = _files(data_dir, ("youthful", "feminine"), 1)
    status, _, err = _fit(run, [*files, *alone], tmp_path / "m.skops")
    assert status == 1
    assert "trait 'style' has 5 different labels" in err
    assert "there is only one of feminine, youthful" in err


def test_a_walk_is_written_as_bvh(run, model, files, tmp_path):
    out = tmp_path / "walk.bvh"
    status, printed, _ = run("walk", model, "--alpha", "style=active=1", "--out", out)
    assert status == 0
    assert f"wrote {out}: style=active +1" in printed
    written = read_walk(out)
    assert isinstance(written, JointWalk)
    template = load_model(model)["linearizer"].template_
    assert_allclose(_bones(written), _bones(template), atol=1e-7)


@pytest.mark.parametrize("option", ["--base", "--skeleton"])
def test_a_file_gives_bvh_its_skeleton_and_it_comes_back_with_its_alpha(run, model, files, tmp_path, option):
    """The written file goes the way of every recording: read, prepared, and placed on the axis."""
    out = tmp_path / "walk.bvh"
    assert run("walk", model, "--alpha", "style=active=0.5", option, files[-1], "--out", out)[0] == 0
    written, original, fitted = read_walk(out), read_walk(files[-1]), load_model(model)
    assert_allclose(_bones(written), _bones(original), atol=1e-7)
    joints = fitted["linearizer"].template_.channel_joints
    again = prepare(written, representation="joints", clip="whole", heading=None, joints=joints)
    assert fitted.transform([again])[0, 0] == pytest.approx(0.5, abs=1e-3)  # files have six decimals


@pytest.mark.parametrize("ending", [".csv", ".npz", ".trc", ".png"])
def test_other_files_hold_the_markers_of_the_skeleton(run, model, tmp_path, ending):
    out = tmp_path / f"walk{ending}"
    assert run("walk", model, "--alpha", "style=elderly=1", "--out", out)[0] == 0
    if ending == ".png":
        assert out.read_bytes().startswith(b"\x89PNG")
    else:
        positions = read_walk(out).to_markers().positions
        assert 1.2 < np.median(positions[:, 0, 2]) < 2.0  # metres over the floor


def test_markers_are_refused(run, files, model, tmp_path):
    markers = tmp_path / "dataset-2_walk_active_999.c3d"
    write_walk(make_walkers(1, random_state=0).data[0], markers)
    status, _, err = _fit(run, [*files, markers], tmp_path / "m.skops")
    assert status == 1
    assert "1 of 19 recordings were refused" in err
    assert "dataset-2_walk_active_999" in err
    assert "expected a skeleton with joints, such as a BVH or AMC file has, for --representation joints" in err
    status, _, err = run("walk", model, "--alpha", "style=active=1", "--base", markers, "--out", tmp_path / "w.bvh")
    assert status == 1
    assert "--base was refused" in err


@pytest.mark.filterwarnings("ignore:.*the limbs leap")  # the recording starts in another posture
def test_other_skeletons_are_refused_with_their_joints(run, model, data_dir, tmp_path):
    cmu = sorted((data_dir / "cmu_bvh").glob("*.bvh"))[0]
    arguments = ["--alpha", "style=active=1", "--base", cmu, "--unit", 0.0564, "--out", tmp_path / "w.bvh"]
    status, _, err = run("walk", model, *arguments)
    assert status == 1
    assert "expected the 63 channels of the first walk in fit" in err


def test_what_goes_with_markers_only_is_refused_at_once(run, files, model, tmp_path):
    out = tmp_path / "m.skops"
    for wrong in (["--passes"], ["--symmetrize"], ["--camera", "moving"], ["--max-gap", "0.1"]):
        status, _, err = _fit(run, files[:2], out, *wrong)
        assert status == 1
        assert f"{' '.join(wrong[:2] if wrong[0] == '--camera' else wrong[:1])} can be asked for with" in err
    status, _, err = _fit(run, files[:2], out, "--pool", "person", "--group", "style")
    assert status == 1
    assert "--pool puts walks of markers together, not joints" in err
    status, _, err = run("walk", model, "--alpha", "style=active=1", "--skeleton", files[0], "--out", "w.csv")
    assert status == 1
    assert "--skeleton is for models of joint angles and --out that ends in .bvh" in err


def test_models_of_markers_write_no_bvh(run, data_dir, tmp_path):
    files = _files(data_dir, ("elderly", "normal"), 5)
    arguments = ["--label-pattern", _PATTERN, "--trait", "style", "--components", 3, "--out", tmp_path / "m.skops"]
    assert run("fit", *files, *arguments)[0] == 0
    status, _, err = run("walk", tmp_path / "m.skops", "--alpha", "style=1", "--out", tmp_path / "w.bvh")
    assert status == 1
    assert "a BVH file holds joints, and" in err
    assert "eigenwalker fit --representation joints" in err
    with pytest.raises((WalkError, OSError)):
        read_walk(tmp_path / "w.bvh")


@pytest.mark.filterwarnings("default")  # the command prints them
def test_far_out_walks_are_said_to_be_beyond_the_joints_of_people(run, model, tmp_path):
    status, _, err = run("walk", model, "--alpha", "style=active=-4", "--out", tmp_path / "w.bvh")
    assert status == 0
    assert "beyond the joints of people" in err
    assert "style=active -4" in err


def test_numbers_and_pairs_of_words_stay_as_they_are_and_missing_labels_missing():
    moods = ["sad", "sad", "calm", "calm", "odd", "odd", None]
    traits = pd.DataFrame({"age": [30, 40, 50, 60, 70, 80, 90], "sex": list("fmfmfmf"), "mood": moods})
    spread = one_against_rest(traits, groups=range(7))
    assert list(spread) == ["age", "sex", "mood=calm", "mood=odd", "mood=sad"]
    assert_array_equal(spread[["age", "sex"]], traits[["age", "sex"]])
    assert spread["mood=odd"].tolist()[:6] == ["not odd"] * 4 + ["odd"] * 2
    assert spread.loc[6, "mood=calm":].isna().all()
    assert poles_of(style_columns(traits))["mood=sad"] == ("not sad", "sad")
    with pytest.raises(ValueError, match="only one of calm, odd, sad"):
        one_against_rest(traits, groups=list("aabbccd"))
