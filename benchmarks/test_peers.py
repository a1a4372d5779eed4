"""Forward kinematics of recorded files by this package and by others: ``python -m pytest benchmarks``.

Not among the tests, because it needs ``pip install ".[bench]"``; where the peers are missing these tests fail.
"""

import numpy as np
import pytest

from benchmarks._bvh_peers import LOADERS, POSITIONS, to_package
from benchmarks._recordings import find_recordings
from eigenwalker.io import read_bvh, write_bvh
from eigenwalker.io._bvh_text import parse_bvh
from eigenwalker.motion import prepare, synthesize

_FOLDER = find_recordings()
_FILES = [*sorted(_FOLDER.glob("bandai2/*.bvh"))[::35], *sorted(_FOLDER.glob("cmu_bvh/*.bvh"))[::6]]
_METERS = {"bandai2": 0.01, "cmu_bvh": 0.0564}

pytestmark = [
    pytest.mark.skipif(not _FILES, reason=f"no recorded walks in {_FOLDER}; set EIGENWALKER_TEST_DATA"),
    pytest.mark.filterwarnings("ignore:Importing PyGLM:PendingDeprecationWarning"),  # by bvhio, of its own parts
]


def test_there_are_ten_files():
    """Five of each source."""
    assert [path.parent.name for path in _FILES] == ["bandai2"] * 5 + ["cmu_bvh"] * 5


@pytest.mark.parametrize("path", _FILES, ids=lambda path: path.stem)
@pytest.mark.parametrize("peer", POSITIONS)
def test_forward_kinematics_agrees(peer, path):
    """Positions of all joints in all frames, within 1e-5 m."""
    meters = _METERS[path.parent.name]
    walk = read_bvh(path, unit=meters)
    names, positions = POSITIONS[peer](path)
    expected = to_package(positions, meters=meters)[:, [names.index(name) for name in walk.skeleton.joint_names]]
    most = float(np.abs(walk.joint_positions() - expected).max())
    print(f"{path.stem}: {most:.1e} m off {peer}")
    assert most < 1e-5


@pytest.mark.parametrize("path", _FILES, ids=lambda path: path.stem)
@pytest.mark.parametrize("peer", LOADERS)
def test_numbers_are_the_same(peer, path):
    """To the last bit."""
    load, numbers = LOADERS[peer]
    assert np.array_equal(numbers(load(path)), parse_bvh(path.read_bytes()).motion)


@pytest.mark.parametrize("style", ["elderly", "masculine", "youthful"])
@pytest.mark.parametrize("peer", POSITIONS)
def test_synthesized_walks_are_read_the_same(peer, style, tmp_path):
    """Positions of all joints in all frames of a file that this package wrote, within 1e-5 m."""
    source = _FOLDER / "bandai2" / f"dataset-2_walk_{style}_001.bvh"
    walk = synthesize(prepare(read_bvh(source), representation="joints"), duration=2.0)
    path = tmp_path / "walk.bvh"
    write_bvh(walk, path)
    names, positions = POSITIONS[peer](path)
    expected = to_package(positions, meters=0.01)[:, [names.index(name) for name in walk.skeleton.joint_names]]
    assert float(np.abs(walk.joint_positions() - expected).max()) < 1e-5
