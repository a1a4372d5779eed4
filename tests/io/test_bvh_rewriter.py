"""Files that are written into themselves: what has not changed is the same to the last byte."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from eigenwalker import WalkError, make_walkers
from eigenwalker.io import read_bvh, rewrite_bvh
from tests.bvh_fingers import add_fingers

FILE = """HIERARCHY\r
ROOT Hips\r
{\r
  OFFSET 1.0 2.0 3.0\r
  CHANNELS 6 Zposition Yrotation Xposition Xrotation Yposition Zrotation\r
  JOINT Knee\r
  {\r
    OFFSET 0 -40 0\r
    CHANNELS 1 Xrotation\r
    JOINT Toe\r
    {\r
      OFFSET 0 -40 0\r
      CHANNELS 4 Xposition Zrotation Xrotation Yrotation\r
      End Site { OFFSET 0 0 10 }\r
    }\r
  }\r
}\r
MOTION\r
Frames: 4\r
Frame Time: .0333333\r
3 350.5  1 0 2 -10.25  5e0 0.000001 179 -1 2 \r
4 370.5  1 0 2 -10.25  6 0.000001 181 -1 2\r
5 10.5  1 0 2 -10.25  7 0.000001 -179 -1 2\r
6 10.5  1 0 2 -10.25  8 0.000001 -178 -1 2\r
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "odd.bvh"
    path.write_bytes(FILE.encode())
    return path


def _rows(path):
    return [line.split() for line in path.read_text().split("MOTION")[1].splitlines()[3:]]


def _turned(walk, joint, turn, frames=slice(None)):
    rotations = np.array(walk.rotations)
    rotations[frames, walk.skeleton.index(joint)] += turn
    return replace(walk, rotations=rotations)


def _apart(one, other):
    """Return the largest angle between the rotations of two walks."""
    turns = (Rotation.from_rotvec(np.array(walk.rotations).reshape(-1, 3)) for walk in (one, other))
    return (next(turns).inv() * next(turns)).magnitude().max()


def test_a_walk_as_it_was_read_makes_the_same_file(file, tmp_path):
    rewrite_bvh(read_bvh(file), file, tmp_path / "same.bvh")
    assert (tmp_path / "same.bvh").read_bytes() == file.read_bytes()
    rewrite_bvh(read_bvh(file), file, file)
    assert file.read_bytes() == FILE.encode()


@pytest.mark.parametrize(
    ("folder", "pattern", "unit"), [("bandai2", "*00[13].bvh", "cm"), ("cmu_bvh", "0*1.bvh", 0.0564)]
)
def test_recordings_make_the_same_files(data_dir, tmp_path, folder, pattern, unit):
    files = sorted((data_dir / folder).glob(pattern))
    assert files
    for path in files:
        rewrite_bvh(read_bvh(path, unit=unit), path, tmp_path / path.name, unit=unit)
        assert (tmp_path / path.name).read_bytes() == path.read_bytes()


@pytest.mark.parametrize("up", ["y", "z"])
def test_changes_come_back_in_the_channels_of_the_file(file, tmp_path, up):
    walk = read_bvh(file, unit="mm", up=up)
    changed = _turned(walk, "Toe", [0.1, -0.2, 0.3])
    changed = replace(changed, root=walk.root + np.array([0.0005, 0.001, -0.002]))
    out = tmp_path / "new.bvh"
    rewrite_bvh(changed, file, out, unit="mm", up=up)
    again = read_bvh(out, unit="mm", up=up)
    assert _apart(again, changed) < 3e-8
    assert_allclose(again.root, changed.root, rtol=0, atol=1e-9)
    assert out.read_bytes().split(b"MOTION")[0] == file.read_bytes().split(b"MOTION")[0]
    for old, new in zip(_rows(file), _rows(out), strict=True):
        assert [new[place] for place in (1, 3, 5, 6, 7)] == [old[place] for place in (1, 3, 5, 6, 7)]


def test_angles_are_those_nearest_to_the_file(file, tmp_path):
    """The file leaps from 181 to -179 degrees, and so does what is written."""
    out = tmp_path / "new.bvh"
    rewrite_bvh(_turned(read_bvh(file), "Toe", 1e-3), file, out)
    old, new = (np.array(_rows(path), dtype=float)[:, 8:] for path in (file, out))
    assert 0 < np.abs(new - old).max() < 0.2


def test_only_changed_frames_are_written_anew(file, tmp_path):
    out = tmp_path / "new.bvh"
    rewrite_bvh(_turned(read_bvh(file), "Toe", 0.1, 2), file, out)
    old, new = (path.read_bytes().splitlines() for path in (file, out))
    assert [place for place, pair in enumerate(zip(old, new, strict=True)) if pair[0] != pair[1]] == [len(old) - 2]


def test_with_other_frames_still_channels_stay_and_angles_run_on(file, tmp_path):
    walk = read_bvh(file)
    longer = replace(
        walk,
        rotations=np.repeat(walk.rotations, 2, axis=0),
        root=np.repeat(walk.root, 2, axis=0),
        translations={joint: np.repeat(path, 2, axis=0) for joint, path in walk.translations.items()},
    )
    longer = _turned(_turned(longer, "Toe", 1e-4), "Hips", 1e-4)
    out = tmp_path / "new.bvh"
    rewrite_bvh(longer, file, out)
    rows = _rows(out)
    assert len(rows) == 8
    assert "Frames: 8\r\nFrame Time: .0333333\r\n" in out.read_bytes().decode()
    assert {row[7] for row in rows} == {"0.000001"}
    turns = np.array(rows, dtype=float)[:, [1, 8]]
    assert_allclose(turns[0], [350.5, 179], atol=0.1)
    assert np.abs(np.diff(turns, axis=0)).max() < 21
    assert _apart(read_bvh(out), longer) < 3e-8


def test_what_has_no_channel_is_said(file, tmp_path):
    walk = read_bvh(file)
    changed = _turned(walk, "Knee", [0.0, 0.1, 0.2])  # bends about the file's x, the package's y
    with pytest.warns(UserWarning, match=r"lacks channels .*left out: Knee 1\d degrees about Z, Y"):
        rewrite_bvh(changed, file, tmp_path / "new.bvh")
    moved = replace(walk, translations={"Knee": np.tile([0.0, 0.0, -0.41], (4, 1))})
    with pytest.warns(UserWarning, match="left out: Knee 10 mm along X, Y, Z"):
        rewrite_bvh(moved, file, tmp_path / "new.bvh")


def test_fingers_keep_their_words(data_dir, tmp_path):
    words = add_fingers(data_dir / "bandai2" / "dataset-2_walk_normal_001.bvh", tmp_path / "fingers.bvh")
    walk = read_bvh(tmp_path / "fingers.bvh")
    out = tmp_path / "new.bvh"
    rewrite_bvh(_turned(walk, "Spine", 0.1), tmp_path / "fingers.bvh", out)
    spine = 6 * walk.skeleton.index("Spine") + 3
    rest = np.delete(np.arange(words.shape[1]), [spine, spine + 1, spine + 2])
    rows = np.array(_rows(out))
    assert (rows[:, rest] == words[:, rest]).all()
    assert (rows[:, spine] != words[:, spine]).all()


def test_other_walks_are_refused(file, tmp_path):
    walk = read_bvh(file)
    with pytest.raises(TypeError, match="expected a JointWalk"):
        rewrite_bvh(make_walkers(1, random_state=0).data[0], file, tmp_path / "new.bvh")
    other = replace(walk, skeleton=replace(walk.skeleton, joint_names=("Hips", "Knie", "Toe")), translations={})
    with pytest.raises(ValueError, match=r"must have the joints of .*odd.bvh, Hips, Knee, Toe; got Hips, Knie, Toe"):
        rewrite_bvh(other, file, tmp_path / "new.bvh")
    with pytest.raises(WalkError, match="Toe"):
        rewrite_bvh(_turned(walk, "Toe", np.nan), file, tmp_path / "new.bvh")
    twice = tmp_path / "twice.bvh"
    twice.write_bytes(FILE.replace("Zrotation Xrotation Yrotation\r", "Zrotation Xrotation Zrotation\r").encode())
    with pytest.raises(WalkError, match="'Toe' has the rotation channels ZXZ: expected each axis once"):
        rewrite_bvh(_turned(read_bvh(twice), "Toe", 0.1), twice, tmp_path / "new.bvh")
