"""Damaged C3D files, and walks that no C3D file can hold."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eigenwalker._validation import WalkError
from eigenwalker.io.c3d import read_c3d, write_c3d
from eigenwalker.motion import Event, JointWalk, MarkerSet, Skeleton, Walk
from tests.c3d_files import INTEL, POINTS, PROCESSORS, Maker, event_parameters


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder that the examples of one law share."""
    return tmp_path_factory.mktemp("c3d")


def _read(folder, data, **options):
    path = folder / "walk.c3d"
    path.write_bytes(data)
    return read_c3d(path, **options)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"units": ()}, r"expected POINT:UNITS m, cm, mm, in, got ''; pass unit=..., most often unit='mm'"),
        ({"units": ("feet",)}, r"expected POINT:UNITS m, cm, mm, in, got 'feet'"),
        (
            {"labels": ("LANK", "LANK")},
            r"expected a label of its own for each point, got LANK more than once; pass markers=",
        ),
    ],
)
def test_files_that_leave_things_open_are_refused(tmp_path, options, match):
    with pytest.raises(WalkError, match=r"walk\.c3d: " + match):
        _read(tmp_path, INTEL.file(POINTS, **options))


def _changed(place, *values):
    data = bytearray(INTEL.file(POINTS))
    data[place : place + len(values)] = bytes(values)
    return bytes(data)


BROKEN = {
    "empty": (b"", "byte 1: expected the header of a C3D file"),
    "text": (b"HIERARCHY\n" * 100, "byte 1: expected the header of a C3D file"),
    "no parameters": (_changed(0, 0), "byte 0: expected the block where the parameters start, got 0"),
    "parameters beyond the end": (_changed(0, 200), "byte 0: expected the block where the parameters start, got 200"),
    "processor": (_changed(515, 99), "byte 515: expected processor type 84, 85 or 86, got 99"),
    "no points": (_changed(2, 0, 0), "byte 2: expected points, got none; a file with nothing but analog"),
    "many points": (_changed(2, 255, 255), "byte 1536: expected 2 frames of 1048560 bytes, got a file of 1600 bytes"),
    "many frames": (_changed(8, 255, 255), "byte 1536: expected 65535 frames of 32 bytes"),
    "frames backwards": (_changed(6, 9, 0), "expected at least one frame, got frames 9 to 2"),
    "other number of points": (_changed(2, 1, 0), "expected as many points as the header says, 1, got POINT:USED 2"),
    "data in the header": (_changed(16, 1, 0), "byte 0: expected 2 frames of 32 bytes"),
    "cut off": (INTEL.file(POINTS)[:-1], "got a file of 1599 bytes; the file seems to be cut off"),
    "zero rate": (INTEL.file(POINTS).replace(INTEL.real(50), INTEL.real(0)), "expected a positive POINT:RATE"),
    "kind of parameter": (
        INTEL.file(POINTS).replace(b"USED\x07\0\x02", b"USED\x07\0\x03"),
        "of the parameter POINT:USED",
    ),
    "huge parameter": (
        INTEL.file(POINTS).replace(b"UNITS\x09\0\xff\x02\x02\x01", b"UNITS\x09\0\xff\x02\xff\xff"),
        "expected 65025 bytes of the parameter POINT:UNITS, got 3 before the next",
    ),
}


@pytest.mark.parametrize("fault", BROKEN)
def test_broken_files_are_refused(tmp_path, fault):
    data, message = BROKEN[fault]
    with pytest.raises(WalkError, match=r"walk\.c3d: .*" + message):
        _read(tmp_path, data)


def test_no_count_of_a_file_is_believed(tmp_path):
    """65535 points in 65535 frames would be 69 GB; a recording can even claim 4 billion frames."""
    ends = INTEL.parameter("ACTUAL_START_FIELD", 3, 2, [2], INTEL.word(1, 0))
    ends += INTEL.parameter("ACTUAL_END_FIELD", 3, 2, [2], INTEL.word(0, 65535))
    long = INTEL.file(POINTS, more=INTEL.entry("TRIAL", -3, b"\0") + ends)
    tracemalloc.start()
    for data in (_changed(2, *[255] * 8), long):
        with pytest.raises(WalkError, match=r"expected [0-9]+ frames of [0-9]+ bytes, got a file of 1600 bytes"):
            _read(tmp_path, data)
    assert tracemalloc.get_traced_memory()[1] < 1e6
    tracemalloc.stop()


@settings(max_examples=400, deadline=None)
@given(
    changes=st.lists(st.tuples(st.integers(0, 1599), st.sampled_from([0, 1, 2, 127, 128, 254, 255])), max_size=8),
    cut=st.none() | st.integers(0, 1599),
    processor=st.sampled_from(sorted(PROCESSORS)),
)
def test_any_bytes_are_read_or_refused(folder, changes, cut, processor):
    more = (
        event_parameters(["Foot Strike", "Foot Off"], ["Right", "Left"], [0, 2.5, 0, 2.75])
        if processor == "Intel"
        else b""
    )
    data = bytearray(Maker(processor).file(POINTS, more=more))
    for place, value in changes:
        data[place] = value
    try:
        walk = _read(folder, bytes(data[:cut]))
    except WalkError as error:
        assert "walk.c3d" in str(error)  # noqa: PT017
    else:
        assert isinstance(walk, Walk)


def _walk(**changes):
    return Walk(**{"positions": np.ones((2, 2, 3)), "frame_rate": 100, "marker_set": MarkerSet(("a", "b")), **changes})


@pytest.mark.parametrize(
    ("walk", "match"),
    [
        (_walk(positions=np.full((2, 2, 3), np.inf)), "expected markers with finite positions or gaps"),
        (_walk(positions=np.full((2, 2, 3), 1e37)), "expected positions that fit into 32 bits"),
        (_walk(marker_set=MarkerSet(("a", "b" * 121))), "names of markers of 1 to 120 bytes, got 'bbb"),
        (_walk(marker_set=MarkerSet(("a", "b "))), "names of markers of printable characters"),
        (_walk(events=(Event(0, "", "left"),)), "kinds of events of 1 to 120 bytes, got ''"),
        (_walk(events=(Event(0, "hop", "both"),)), "on the left, the right or no side, got the side 'both'"),
    ],
)
def test_walks_that_do_not_fit_are_refused(tmp_path, walk, match):
    with pytest.raises(WalkError, match=match):
        write_c3d(walk, tmp_path / "walk.c3d")
    assert not (tmp_path / "walk.c3d").exists()


def test_wrong_arguments_are_refused(tmp_path):
    joints = JointWalk(np.zeros((2, 1, 3)), np.zeros((2, 3)), Skeleton(("hips",), [-1], np.zeros((1, 3))), 100)
    with pytest.raises(TypeError, match="expected a Walk, got JointWalk; turn joints into markers"):
        write_c3d(joints, tmp_path / "walk.c3d")
    with pytest.raises(ValueError, match=r"unit must be one of 'mm', 'm', 'cm', 'in', got 0\.001"):
        write_c3d(_walk(), tmp_path / "walk.c3d", unit=0.001)
    for options, match in [
        ({"unit": "feet"}, "unit must be"),
        ({"up": "x"}, "up must be"),
        ({"markers": ["a", "a"]}, "repeat: a"),
    ]:
        with pytest.raises(ValueError, match=match):
            read_c3d(tmp_path / "missing.c3d", **options)
    with pytest.raises(FileNotFoundError, match=r"missing\.c3d"):
        read_c3d(tmp_path / "missing.c3d")
