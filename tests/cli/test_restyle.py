"""``eigenwalker restyle``."""

import re

import numpy as np
import pytest

from eigenwalker import load_model, make_walkers, prepare, read_walk, write_walk
from tests.bvh_fingers import add_fingers


@pytest.fixture(scope="module")
def files(data_dir):
    folder = data_dir / "bandai2"
    return [path for style in ("normal", "elderly") for path in sorted(folder.glob(f"*walk_{style}_*.bvh"))[:8]]


@pytest.fixture
def model(run, files, tmp_path):
    out = tmp_path / "m.skops"
    arguments = ["--label-pattern", r"walk_(?P<style>[a-z]+)_", "--trait", "style", "--components", 4]
    assert run("fit", *files, *arguments, "--representation", "joints", "--out", out)[0] == 0
    assert load_model(out)["trait"].poles_ == {"style": ("elderly", "normal")}
    return out


def _alpha(model, path):
    fitted = load_model(model)
    joints = fitted["linearizer"].template_.channel_joints
    return fitted.transform([prepare(read_walk(path), representation="joints", joints=joints)])[0, 0]


def _motion(path):
    """Return the words before the frames, and the frames."""
    head, motion = path.read_text().split("MOTION")
    _, _, seconds, *rows = motion.splitlines()
    return head, seconds, np.array([row.split() for row in rows])


def test_alpha_zero_copies_the_file(run, model, files, tmp_path):
    out = tmp_path / "same.bvh"
    status, printed, _ = run("restyle", files[3], "--model", model, "--alpha", "style=0", "--out", out)
    assert status == 0
    assert out.read_bytes() == files[3].read_bytes()
    assert re.search(r"wrote .*same.bvh: dataset-2_walk_normal_004, style by \+0, (\d+) frames in place of \1", printed)


def test_the_file_moves_along_the_axis_and_keeps_all_else(run, model, files, tmp_path):
    mine, out = tmp_path / "mine.bvh", tmp_path / "mine_old.bvh"
    words = add_fingers(files[0], mine)
    arguments = ["--model", model, "--alpha", "style=-1.5", "--out", out]
    assert run("restyle", mine, *arguments)[0] == 0
    assert _alpha(model, out) - _alpha(model, mine) == pytest.approx(-1.5, abs=0.1)
    assert _motion(out)[:2] == _motion(mine)[:2]
    assert read_walk(out).frame_rate == read_walk(mine).frame_rate
    assert len(_motion(out)[2]) != len(words)  # another cadence
    assert run("restyle", mine, *arguments, "--keep-cadence")[0] == 0
    rows = _motion(out)[2]
    hand = 6 * read_walk(files[0]).skeleton.index("Hand_L") + 6
    assert (rows[:, hand : hand + 3] == words[:, hand : hand + 3]).all()
    assert (rows[:, :6] == words[:, :6]).all()  # joint_Root


def test_what_cannot_be_restyled_is_refused(run, model, files, data_dir, tmp_path):
    out, alpha = tmp_path / "out.bvh", ["--alpha", "style=1"]

    def refused(*arguments):
        status, _, err = run("restyle", *arguments)
        assert status == 1
        assert not out.exists()
        return err

    start = [files[0], "--model", model]
    assert "trait must be one of" in refused(*start, "--alpha", "happy=1", "--out", out)
    assert "--alpha must be TRAIT=NUMBER" in refused(*start, "--alpha", "style", "--out", out)
    assert "--out must end in .bvh, got out.csv" in refused(*start, *alpha, "--out", tmp_path / "out.csv")
    markers = tmp_path / "walk.csv"
    write_walk(make_walkers(1, random_state=0).data[0], markers)
    assert "FILE must end in .bvh, got walk.csv" in refused(markers, "--model", model, *alpha, "--out", out)
    copy = tmp_path / "copy.bvh"
    copy.write_bytes(files[0].read_bytes())
    assert "must be another file than the recording" in refused(copy, "--model", model, *alpha, "--out", copy)
    assert copy.read_bytes() == files[0].read_bytes()
    copy.write_text("no skeleton")
    assert "line 1: expected HIERARCHY" in refused(copy, "--model", model, *alpha, "--out", out)
    cmu = sorted((data_dir / "cmu_bvh").glob("*.bvh"))[0]
    err = refused(cmu, "--unit", 0.0564, "--model", model, *alpha, "--out", out)
    assert "expected the skeleton of the model, with the joints Hips, Spine, Chest" in err
    assert "it lacks Chest, Shoulder_L" in err


def test_models_of_markers_are_refused(run, files, tmp_path):
    model, out = tmp_path / "m.skops", tmp_path / "out.bvh"
    arguments = ["--label-pattern", r"walk_(?P<style>[a-z]+)_", "--trait", "style", "--components", 4]
    assert run("fit", *files, *arguments, "--out", model)[0] == 0
    status, _, err = run("restyle", files[0], "--model", model, "--alpha", "style=1", "--out", out)
    assert status == 1
    assert "got one of markers; learn one with" in err
    assert "eigenwalker fit --representation joints" in err


@pytest.mark.filterwarnings("default")  # the command prints them
def test_far_out_is_said(run, model, files, tmp_path):
    out = tmp_path / "out.bvh"
    status, _, err = run("restyle", files[0], "--model", model, "--alpha", "style=9", "--keep-cadence", "--out", out)
    assert status == 0
    assert "outside your data" in err
