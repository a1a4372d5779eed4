"""Recorded walks: every file is read, and what comes out is a body that walks forward."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker._validation import WalkError
from eigenwalker.io import read_bvh, read_walks

CMU_UNIT = 0.0564


@pytest.fixture(scope="module")
def bandai(data_dir):
    """Return the 175 walks of Bandai-Namco-Research-Motiondataset-2."""
    return read_walks(sorted((data_dir / "bandai2").glob("*.bvh")), unit="cm")


@pytest.fixture(scope="module")
def cmu(data_dir):
    """Return 27 walks of the CMU motion capture database."""
    return read_walks(sorted((data_dir / "cmu_bvh").glob("*.bvh")), unit=CMU_UNIT)


@pytest.fixture(scope="module", params=["bandai", "cmu"])
def markers(request):
    """Return all walks of one source as markers, without frames of zeros."""
    walks = [walk.to_markers() for walk in request.getfixturevalue(request.param)]
    return [walk.with_channels(walk.channels[2:]) for walk in walks]


def _median(walk, marker):
    return np.median(walk.marker(marker), axis=0)


def test_all_files_are_read(bandai, cmu):
    assert (len(bandai), len(cmu)) == (175, 27)
    assert {walk.frame_rate for walk in bandai} == {30.0}
    assert {walk.frame_rate for walk in cmu} == {120.0}
    assert {walk.skeleton.joint_names[walk.skeleton.root] for walk in bandai + cmu} == {"Hips"}
    assert not any(walk.translations for walk in bandai + cmu)


def test_frames_are_those_of_the_files(bandai, cmu):
    frames = {walk.name: walk.n_frames for walk in bandai + cmu}
    assert frames["dataset-2_walk_active_001"] == 207
    assert frames["07_12"] == 264


def test_joints_other_than_the_root_stay_at_their_offsets(bandai):
    offsets = np.array([walk.skeleton.offsets for walk in bandai])
    assert offsets.shape == (175, 22, 3)
    assert_allclose(offsets[:, 2:], np.broadcast_to(offsets[0, 2:], (175, 20, 3)), atol=1e-5)
    assert_allclose(offsets[:, 0], 0, atol=1e-9)


def test_the_frames_of_zeros_are_kept(cmu):
    (walk,) = [walk for walk in cmu if walk.name == "07_12"]
    assert_allclose(walk.root[:2], 0)
    assert_allclose(walk.root[2], CMU_UNIT * np.array([-38.9720, 8.0585, 15.9634]))


def test_bodies_have_plain_anatomy(markers):
    for walk in markers:
        upper = np.linalg.norm(walk.marker("left_hip") - walk.marker("left_knee"), axis=-1)
        lower = np.linalg.norm(walk.marker("left_knee") - walk.marker("left_ankle"), axis=-1)
        assert 0.6 < np.median(upper + lower) < 1.0, walk.name
        heights = [_median(walk, name)[2] for name in ("head", "clavicle", "pelvis", "left_knee", "left_ankle")]
        assert heights == sorted(heights, reverse=True), walk.name
        assert 1.3 < heights[0] < 2.0, walk.name


def test_bodies_face_where_they_walk(markers):
    for walk in markers:
        hips = walk.marker("left_hip") - walk.marker("right_hip")
        shoulders = walk.marker("left_shoulder") - walk.marker("right_shoulder")
        velocity = np.gradient(walk.marker("pelvis"), axis=0)
        left = np.cross([0.0, 0.0, 1.0], velocity)  # up x forward
        facing = np.cross(hips + shoulders, [0.0, 0.0, 1.0])
        assert np.median(np.sum(shoulders * left, axis=-1)) > 0, walk.name
        assert np.median(np.sum(facing * velocity, axis=-1)) > 0, walk.name
        ankles = walk.marker("left_ankle") + walk.marker("right_ankle")
        assert np.ptp(ankles[:, 2]) < 2 * np.ptp(walk.marker("pelvis")[:, 0:2]), walk.name


def test_rotations_run_without_jumps(bandai, cmu):
    for walk in bandai + cmu:
        body = [joint for joint, name in enumerate(walk.skeleton.joint_names) if "Thumb" not in name]  # thumbs flip
        rotations = walk.rotations[2:, body]  # without frames of zeros
        steps = np.linalg.norm(np.diff(rotations, axis=0), axis=-1)
        assert steps.max() < 1.5, walk.name  # a jump to another branch is 2 pi


def test_a_wrong_unit_is_refused_with_advice(data_dir):
    path = data_dir / "cmu_bvh" / "07_01.bvh"
    with pytest.raises(WalkError, match=r"07_01\.bvh': legs are 0\.14. m long with unit='cm'.*about 0\.05[0-9] for"):
        read_bvh(path)
    (bandai, *_) = sorted((data_dir / "bandai2").glob("*.bvh"))
    with pytest.raises(
        WalkError, match=r"active_001\.bvh': legs are .* m long with unit='m'.*; read it with unit='cm'"
    ):
        read_bvh(bandai, unit="m")
