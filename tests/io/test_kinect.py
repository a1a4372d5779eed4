"""Kinect text: the layout, the joints and their sides, and all recordings at hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.io import read_kinect
from eigenwalker.motion import TROJE15
from eigenwalker.motion.body import leg_length
from tests.marker_walks import faults, outcome, refusal

HEIGHTS = {
    "Head": 0.9,
    "Shoulder-Center": 0.7,
    "Shoulder-Right": 0.65,
    "Shoulder-Left": 0.65,
    "Elbow-Right": 0.4,
    "Elbow-Left": 0.4,
    "Wrist-Right": 0.15,
    "Wrist-Left": 0.15,
    "Hand-Right": 0.1,
    "Hand-Left": 0.1,
    "Spine": 0.35,
    "Hip-centro": 0.3,
    "Hip-Right": 0.25,
    "Hip-Left": 0.25,
    "Knee-Right": -0.2,
    "Knee-Left": -0.2,
    "Ankle-Right": -0.6,
    "Ankle-Left": -0.6,
    "Foot-Right": -0.7,
    "Foot-Left": -0.7,
}
FRAME = [f"{joint};{0.1 * ('Right' in joint):g};{height};2.5" for joint, height in HEIGHTS.items()]
TEXT = "\r\n".join(FRAME * 3) + "\r\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("kinect")


@pytest.fixture(scope="module")
def recordings(data_dir):
    """Return all recordings, from the camera."""
    return [read_kinect(path) for path in sorted((data_dir / "kinect").glob("*/*.txt"))]


def _read(folder, text, **options):
    path = folder / "1.txt"
    path.write_bytes(text.encode())
    return read_kinect(path, **options)


def test_names_and_axes(folder):
    walk = _read(folder, TEXT)
    assert walk.positions.shape == (3, 20, 3)
    assert walk.frame_rate == 30
    assert walk.marker_set.names[:4] == ("head", "shoulder_center", "right_shoulder", "left_shoulder")
    assert {"hip_center", "spine", "left_hand", "right_foot"} <= set(walk.marker_set.names)
    assert_array_equal(walk.marker("right_ankle")[0], [2.5, 0.1, -0.6])  # away from the camera, to its left, up
    assert ("left_knee", "left_ankle") in walk.marker_set.sticks


def test_the_15_markers(folder):
    walk = _read(folder, TEXT, name="anna", frame_rate=29.97).to_markers()
    assert walk.marker_set is TROJE15
    assert (walk.name, walk.frame_rate) == ("anna", 29.97)
    assert_allclose(walk.marker("pelvis")[0], [2.5, 0.05, 0.25])
    assert_allclose(walk.marker("clavicle")[0], [2.5, 0, 0.7])


def test_spelling_does_not_matter(folder):
    plain = _read(folder, TEXT).positions
    for text in (
        "\ufeff" + TEXT.replace("\r\n", "\n"),
        TEXT.replace("\r\n", "\r"),
        TEXT.replace("\r\n", "\r\n\r\n"),
        TEXT.replace("Hip-centro", "Hip-Center"),
        TEXT.replace(";", " ; ").rstrip(),
    ):
        assert_array_equal(_read(folder, text).positions, plain)


def test_gaps(folder):
    walk = _read(folder, TEXT.replace("Spine;0;0.35;2.5", "Spine;;nan;", 1))
    assert np.isnan(walk.marker("spine")[0]).all()
    assert np.isnan(walk.positions).sum() == 3


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("Head", "Neck", r"line 1: expected Head;x;y;z, with which each frame starts, got 'Neck'"),
        ("Spine", "Tail", r"line 11: expected one of Spine, Hip-centro, .*Foot-Right, got 'Tail'"),
        ("Spine", "Head", r"line 11: expected one of Spine, .*, got 'Head'"),
        ("Spine;0;0.35;2.5", "Spine;0;0.35", r"line 11: expected 4 fields, got 3$"),
        (
            "Spine;0;0.35;2.5",
            "Spine;0;0,35;2.5",
            r"line 11: expected a finite number or a gap as value 3 of 4",
        ),
        ("Spine;0;0.35;2.5", "Spine;0;1e999;2.5", r"line 11: expected a finite number or a gap"),
        ("Spine;0;0.35;2.5\r\n", "", r"line 20: expected one of Spine, got 'Head'"),
        ("-0.6;2.5", "-6;2.5", r"legs are 6\.25 m long with unit='m', expected 0\.3 to 1\.3 m"),
    ],
)
def test_faults_are_named_with_their_line(folder, old, new, match):
    text = TEXT.replace(old, new, -1 if "legs" in match else 1)
    with pytest.raises(ValueError, match=match):
        raise ValueError(refusal(read_kinect, folder / "1.txt", text))


def test_what_is_not_whole_is_refused(folder):
    path = folder / "1.txt"
    assert "line 1: expected Head;x;y;z, with which a Kinect recording starts" in refusal(read_kinect, path, "")
    cut = TEXT[: TEXT.index("Head", 5)]
    assert "line 19: expected 20 joints a frame, got 19; the file seems" in refusal(read_kinect, path, cut[:-25])
    assert "line 57: expected Ankle-Left next, got the end of the file" in refusal(read_kinect, path, TEXT[:-74])
    assert "line 45: expected Elbow-Right, as in the first frame, got 'Elbow-Left'" in refusal(
        read_kinect, path, TEXT[:700] + TEXT[700:].replace("Elbow-Right", "Elbow-Left", 1)
    )
    assert "line 1: expected the text of a Kinect recording, got binary data" in refusal(read_kinect, path, b"\0")


@settings(max_examples=200, deadline=None)
@given(content=faults(TEXT.encode()))
def test_any_content_is_read_or_refused(folder, content):
    outcome(read_kinect, folder / "1.txt", content)


def test_all_recordings_are_read(recordings):
    assert len(recordings) == 246
    assert {walk.positions.shape[1:] for walk in recordings} == {(20, 3)}
    assert not any(np.isnan(walk.positions).any() for walk in recordings)
    lengths = [leg_length(walk) for walk in recordings]
    assert min(lengths) > 0.65
    assert max(lengths) < 1.05


def test_recorded_bodies_stand_upright_with_left_on_the_left(recordings):
    """The toes say what is forward: the hips must lie to their left and right, or the axes were mirrored."""
    for walk in recordings:
        assert np.median(walk.marker("head")[:, 2] - walk.marker("left_ankle")[:, 2]) > 1.1
        forward = sum(walk.marker(f"{side}_foot") - walk.marker(f"{side}_ankle") for side in ("left", "right"))
        across = walk.marker("left_hip") - walk.marker("right_hip")
        turn = forward[:, 0] * across[:, 1] - forward[:, 1] * across[:, 0]
        assert np.mean(turn > 0) > 0.6  # the noise of the toes leaves 62 % of the frames in the worst recording
