"""TRC files: the round trip, OpenSim's axes, and every fault with its line."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.io import read_trc, write_trc
from eigenwalker.io._units import from_opensim_axes, to_opensim_axes
from eigenwalker.motion import TROJE15, JointWalk, MarkerSet, Skeleton, Walk
from tests.marker_walks import body, faults, outcome, refusal, walks

TEXT = """PathFileType\t4\t(X/Y/Z)\tanna.trc
DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames
100.00\t100.00\t3\t2\tmm\t100.00\t1\t3
Frame#\tTime\tR.ASIS\t\t\tL.ASIS\t\t
\t\tX1\tY1\tZ1\tX2\tY2\tZ2

1\t0.000\t1\t2\t3\t4\t5\t6
2\t0.010\t\t\t\t4\t5\t6
3\t0.020\t1\t2\t3\tnan\t5\t
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("trc")


def _read(folder, text, **options):
    path = folder / "anna.trc"
    path.write_bytes(text.encode())
    return read_trc(path, **options)


@settings(max_examples=60, deadline=None)
@given(walk=walks(), unit=st.sampled_from(["m", "cm", "mm", "in"]), up=st.sampled_from(["y", "z"]))
def test_round_trip(folder, walk, unit, up):
    path = folder / "anna.trc"
    write_trc(walk, path, unit=unit, up=up)
    back = read_trc(path, up=up)
    assert back.marker_set.names == walk.marker_set.names
    # Metres to the file's unit and back are two roundings of 1e-16.
    assert_allclose(back.positions, walk.positions, rtol=1e-15)
    assert (back.frame_rate, back.name) == (walk.frame_rate, "anna")


def test_the_15_markers(folder):
    walk = body(np.random.default_rng(0), gaps=6)
    write_trc(walk, folder / "anna.trc")
    back = read_trc(folder / "anna.trc")
    assert back.marker_set is TROJE15
    assert_allclose(back.positions, walk.positions, rtol=1e-15)
    assert "m long with unit='in', expected 0.3 to 1.3 m; read it with unit='mm'" in refusal(
        read_trc, folder / "anna.trc", (folder / "anna.trc").read_bytes(), unit="in"
    )


def test_axes_of_opensim():
    axes = from_opensim_axes(np.eye(3), "y")
    assert_array_equal(axes, [[1, 0, 0], [0, 0, 1], [0, -1, 0]])  # forward, up, right
    assert_allclose(np.linalg.det(axes), 1)
    vectors = np.random.default_rng(0).normal(size=(5, 2, 3))
    for up in ("y", "z"):
        assert_array_equal(to_opensim_axes(from_opensim_axes(vectors, up), up), vectors)
        assert_array_equal(from_opensim_axes(to_opensim_axes(vectors, up), up), vectors)


def test_a_file_by_hand(folder):
    walk = _read(folder, TEXT)
    assert walk.marker_set.names == ("R.ASIS", "L.ASIS")
    assert walk.frame_rate == 100
    assert_allclose(walk.positions[0], [[0.001, -0.003, 0.002], [0.004, -0.006, 0.005]])
    assert np.isnan(walk.marker("R.ASIS")[1]).all()
    assert_array_equal(np.isnan(walk.marker("L.ASIS")[2]), [True, True, False])
    assert_allclose(_read(folder, TEXT, unit="m", up="z").positions[0], [[1, 2, 3], [4, 5, 6]])
    assert _read(folder, TEXT, frame_rate=50, name="eva").frame_rate == 50


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + TEXT,
        TEXT.replace("\n", "\r\n"),
        TEXT.replace("\n\n", "\n"),
        TEXT.replace("\n", "\t\n").replace("\n\t\n", "\n\n"),
        TEXT.replace("Units", "units").replace("DataRate", "datarate", 1).replace("Frame#", "frame#"),
        TEXT.replace("Z2\n\n", "Z2\t\n\n"),
        TEXT.replace("0.010", "0.01004"),
    ],
)
def test_spelling_does_not_matter(folder, text):
    assert_array_equal(_read(folder, text).positions, _read(folder, TEXT).positions)


def test_one_frame_without_time_to_compare(folder):
    walk = Walk(np.full((1, 1, 3), np.nan), 30, MarkerSet(("heel",)))
    write_trc(walk, folder / "anna.trc")
    assert read_trc(folder / "anna.trc").frame_rate == 30


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("PathFileType", "HIERARCHY", r"line 1: expected PathFileType.*got 'HIERARCHY'"),
        ("DataRate\t", "Rate\t", r"line 3: expected a value under each of DataRate, got none"),
        ("100.00\t100.00\t3", "fast\t100.00\t3", r"line 3: expected DataRate in frames per second.*got 'fast'"),
        ("100.00\t100.00\t3", "0\t100.00\t3", r"line 3: expected DataRate in frames per second.*got '0'"),
        ("\t3\t2\tmm", "\t4\t2\tmm", r"line 3: expected NumFrames 3, as many as there are lines of frames, got '4'"),
        ("\t3\t2\tmm", "\t1000000000000\t2\tmm", r"line 3: expected NumFrames 3, .*got '1000000000000'"),
        ("\t3\t2\tmm", "\t3\t-2\tmm", r"line 3: expected NumMarkers 2, as many as there are names of m.*got '-2'"),
        ("\tmm\t", "\tfeet\t", r"line 3: expected Units among m, cm, mm, in, got 'feet'; pass unit="),
        ("Frame#\tTime", "Time\tFrame#", r"line 4: expected Frame#, Time and names of markers, got 'Time Frame# R.AS"),
        ("L.ASIS", "R.ASIS", r"line 4: expected a new name for each marker, got R\.ASIS more than once"),
        ("L.ASIS", "", r"line 5: expected X1, Y1 \.\.\. Z1 below 1 names, got 'X1 Y1 Z1 X2"),
        ("Y2\t", "", r"line 5: expected X1, Y1 \.\.\. Z2 below 2 names, got 'X1 Y1 Z1 X2 Z2'"),
        ("1\t0.000\t1\t2", "1\t0.000\t1", r"line 7: expected 8 fields, got 7$"),
        ("1\t0.000\t1\t2", "1\t0.000\t1\t2\t2", r"line 7: expected 8 fields, got 9$"),
        ("3\t0.020\t1\t2\t3\tnan\t5\t\n", "3\t0.020\t1\t", r"line 9: expected 8 fields, got 4; the file seems to be"),
        ("1\t0.000\t1\t2", "1\t0.000\t1\t2,5", r"line 7: expected a finite number or a gap as value 4 of 8, got '2,5'"),
        ("0.010", "0.013", r"line 8: expected evenly spaced times, .* got a step of 0.013 s"),
        ("0.010", "soon", r"line 8: expected a finite number or a gap as value 2 of 8, got 'soon'"),
        ("0.010", "", r"line 8: expected a time in seconds, got ''"),
        (
            "100.00\t100.00",
            "200.00\t100.00",
            r"line 9: expected time 0\.01 at 200 frames a second, got '0\.020'",
        ),
    ],
)
def test_faults_are_named_with_their_line(folder, old, new, match):
    assert old in TEXT
    with pytest.raises(ValueError, match=match):
        raise ValueError(refusal(read_trc, folder / "anna.trc", TEXT.replace(old, new, 1)))


def test_what_is_not_whole_is_refused(folder):
    path = folder / "anna.trc"
    assert "line 1: expected PathFileType, with which TRC files start, got an empty file" in refusal(read_trc, path, "")
    lines = TEXT.splitlines(keepends=True)
    assert "line 3: expected five lines before the first frame, got 3" in refusal(read_trc, path, "".join(lines[:3]))
    assert "line 3: expected at least one frame, got none" in refusal(read_trc, path, "".join(lines[:6]))
    assert "line 3: expected NumFrames 2" in refusal(read_trc, path, "".join(lines[:8]))
    assert "line 1: expected the text of a TRC file, got binary data" in refusal(read_trc, path, b"\0\1\2")


def test_wrong_walks_are_not_written(folder):
    joints = JointWalk(np.zeros((2, 1, 3)), np.zeros((2, 3)), Skeleton(("Hips",), [-1], np.zeros((1, 3))), 30)
    with pytest.raises(TypeError, match=r"turn joints into markers with to_markers\(\)"):
        write_trc(joints, folder / "no.trc")
    heel = Walk(np.zeros((1, 1, 3)), 30, MarkerSet(("he\tel",)))
    with pytest.raises(ValueError, match=r"names of file and markers of printable characters.*got 'he\\tel'"):
        write_trc(heel, folder / "no.trc")
    with pytest.raises(TypeError, match=r"unit must be one of 'm', 'cm', 'mm', 'in' for a TRC file, got 0\.0564"):
        write_trc(heel, folder / "no.trc", unit=0.0564)
    with pytest.raises(ValueError, match="up must be one of"):
        write_trc(heel, folder / "no.trc", up="x")
    assert not (folder / "no.trc").exists()


@settings(max_examples=200, deadline=None)
@given(content=faults(TEXT.encode()))
def test_any_content_is_read_or_refused(folder, content):
    walk, message = outcome(read_trc, folder / "anna.trc", content)
    assert (walk is None) == (", line " in message or "infinite" in message)
