"""Each kind of fault that damaged files have brought to light, by its name and with the least file that shows it."""

import struct
import zipfile
from time import process_time  # of this process alone, whatever else the machine does

import numpy as np
import pytest

from eigenwalker._validation import WalkError
from eigenwalker.io import read_walk, write_npz
from eigenwalker.motion import MarkerSet, Walk
from tests.acclaim import Bone, asf_text
from tests.c3d_files import INTEL, POINTS
from tests.mutated_files import memory_limit

SECONDS = 5.0


def _message(path, content, **options):
    """Return the error about a file, which must name it in one line of bearable length."""
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with memory_limit(), pytest.raises(WalkError) as caught:
        read_walk(path, **options)
    message = str(caught.value)
    assert str(path.parent) in message
    assert "\n" not in message
    assert len(message) < 5000
    return message


def _bvh(joints="", motion="0\n"):
    head = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n" + joints + "}\nMOTION\n"
    return f"{head}Frames: {len(motion.splitlines())}\nFrame Time: 0.01\n{motion}"


def _still_joints(count):
    return "".join(f"JOINT j{number} {{\nOFFSET 0 0 0\n}}\n" for number in range(count))


def test_bvh_joints_without_channels_cost_no_gigabytes(tmp_path):
    message = _message(tmp_path / "a.bvh", _bvh(_still_joints(4000), "0\n" * 20_000))
    assert "line 12008: expected joints that turn, got 4001 joints in 20000 frames, 1.9 GB from a file of" in message


def test_bvh_of_more_joints_than_a_body_has(tmp_path):
    start = process_time()
    assert "line 15003: expected at most 5000 joints" in _message(tmp_path / "a.bvh", _bvh(_still_joints(20_000)))
    assert process_time() - start < SECONDS


def test_bvh_of_five_thousand_joints_one_in_another(tmp_path):
    deep = "".join(f"JOINT j{number} {{\nOFFSET 0 0 0\n" for number in range(4999)) + "}" * 4999
    (tmp_path / "a.bvh").write_text(_bvh(deep))
    assert read_walk(tmp_path / "a.bvh").n_frames == 1


def test_bvh_with_one_fault_behind_many_lines(tmp_path):
    start = process_time()
    message = _message(tmp_path / "a.bvh", _bvh(motion="0\n" * 300_000 + "x\n"))
    assert "line 300010: expected a finite number as value 1 of 1, got 'x'" in message
    assert process_time() - start < SECONDS


def test_amc_bones_without_values_cost_no_gigabytes(tmp_path):
    (tmp_path / "a.asf").write_text(
        asf_text({f"b{n}": Bone("root", (0, 1, 0), 1.0) for n in range(400)}, root_order=())
    )
    message = _message(tmp_path / "a.amc", "".join(f"{frame}\nroot\n" for frame in range(1, 20_001)))
    assert "line 40000: expected joints that turn, got 401 joints in 20000 frames" in message


@pytest.mark.parametrize("name", ["a.csv", "a.bvh", "a.trc", "a.txt"])
def test_a_long_word_of_digits_takes_no_quadratic_time(tmp_path, name):
    word = "1" * 100_000 + "x"
    content = {
        "a.csv": f"time,m_x,m_y,m_z\n0,1,2,{word}\n",
        "a.bvh": _bvh(motion=word + "\n"),
        "a.trc": f"PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n{word}\t1\t1\tmm\nFrame#\tTime\tm\n"
        "\t\tX1\tY1\tZ1\n1\t0\t1\t2\t3\n",
        "a.txt": f"Head;1;2;{word}\n" + "\n".join(f"{joint};1;2;3" for joint in KINECT[1:]) + "\n",
    }
    start = process_time()
    assert "got '1111" in _message(tmp_path / name, content[name])
    assert process_time() - start < 2


_PAIRS = ("Shoulder", "Elbow", "Wrist", "Hand", "Hip", "Knee", "Ankle", "Foot")
KINECT = ["Head", "Shoulder-Center", "Spine", "Hip-centro"]
KINECT += [f"{joint}-{side}" for side in ("Left", "Right") for joint in _PAIRS]


@pytest.mark.parametrize("fault", ["", "more", "same"])
def test_a_table_of_very_many_columns_takes_no_quadratic_time(tmp_path, fault):
    names = ["m"] * 20_000 if fault == "same" else [f"m{number}" for number in range(20_000)]
    titles = [f"{name}_{axis}" for name in names for axis in "xyz"] + ["more"] * (fault == "more")
    content = ",".join(["time", *titles]) + "".join(f"\n0.0{frame}" + ",1" * len(titles) for frame in range(2)) + "\n"
    start = process_time()
    if fault:
        assert "line 1: expected " in _message(tmp_path / "a.csv", content)
    else:
        (tmp_path / "a.csv").write_text(content)
        assert len(read_walk(tmp_path / "a.csv").marker_set.names) == 20_000
    assert process_time() - start < SECONDS


def test_c3d_of_very_many_points_takes_no_quadratic_time(tmp_path):
    data = bytearray(INTEL.file(POINTS[:1], labels=()))
    struct.pack_into("<H", data, 2, 65535)
    struct.pack_into("<H", data, data.find(b"USED") + 8, 65535)
    (tmp_path / "a.c3d").write_bytes(bytes(data) + bytes(16 * 65535))
    start = process_time()
    assert len(read_walk(tmp_path / "a.c3d").marker_set.names) == 65535
    assert process_time() - start < SECONDS


@pytest.mark.parametrize("times", [("0", "5e-324"), ("0", "1e-300"), ("0", "1e-9")])
def test_times_that_are_next_to_the_same_warn_of_nothing(tmp_path, times):
    content = "time,m_x,m_y,m_z\n" + "".join(f"{time},1,2,3\n" for time in times)
    assert "line 2: expected times in seconds, got" in _message(tmp_path / "a.csv", content)


def test_c3d_names_with_control_characters_stay_in_one_line(tmp_path):
    data = INTEL.file(POINTS).replace(b"LABELS", b"LA\nEL\0", 1)
    place = data.find(b"LA\nEL\0") + 8
    message = _message(tmp_path / "a.c3d", data[:place] + b"\x09" + data[place + 1 :])
    assert r"parameter 'POINT:LA\nEL', got others" in message


def test_bids_axes_of_a_wrong_type_are_named_with_their_file(tmp_path):
    _bids(tmp_path, '{"SamplingFrequency": 100, "SpatialAxes": [1]}')
    with pytest.raises(WalkError, match=r"a_motion\.json: expected SpatialAxes such as 'ALS'.*got '\[\[1\]\]'"):
        read_walk(tmp_path / "a_motion.tsv")


@pytest.mark.parametrize("depth", [*range(900, 1000, 7), 100_000])
@pytest.mark.parametrize("key", ["SamplingFrequency", "SpatialAxes"])
def test_bids_lists_in_lists_are_no_recursion(tmp_path, key, depth):
    _bids(tmp_path, f'{{"SamplingFrequency": 100, "{key}": {"[" * depth + "]" * depth}}}')
    with pytest.raises(WalkError, match=r"expected (SamplingFrequency|SpatialAxes|JSON)"):
        read_walk(tmp_path / "a_motion.tsv")


def test_bids_long_words_are_shortened(tmp_path):
    _bids(tmp_path, '{"SamplingFrequency": 100}', point="m" * 9000)
    with pytest.raises(
        WalkError, match=r"line 2: expected a tracked_point and a component.*mmm\.\.\.' and 'q'"
    ) as caught:
        read_walk(tmp_path / "a_motion.tsv")
    assert len(str(caught.value)) < 500


def _bids(folder, sidecar, point="m"):
    rows = [f"{axis}\t{axis if point == 'm' else 'q'}\tPOS\t{point}\tm\n" for axis in "xyz"]
    (folder / "a_channels.tsv").write_text("name\tcomponent\ttype\ttracked_point\tunits\n" + "".join(rows))
    (folder / "a_motion.json").write_text(sidecar)
    (folder / "a_motion.tsv").write_text("1\t2\t3\n")


def _repack(path, old, new):
    """Change the bytes of one array of an archive, with sums that fit them."""
    with zipfile.ZipFile(path) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    assert old in entries["positions.npy"]
    entries["positions.npy"] = entries["positions.npy"].replace(old, new)
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in entries.items():
            archive.writestr(name, data)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"(2, 1, 3)", b"(2,1l, 3)"),  # Python 2's long numbers: numpy warns
        (b"(2, 1, 3)", b"(2,1or 3)"),  # a piece of Python: the compiler warns
        (b"(2, 1, 3)", b"((((((((("),
        (b"'<f8'", b"'<a8'"),
        (b"'<f8'", b"'<i\n'"),
        (b"(2, 1, 3), }", b"(999999999,0"),
    ],
)
def test_npz_headers_are_no_pieces_of_python(tmp_path, old, new):
    write_npz(Walk(np.ones((2, 1, 3)), 100, MarkerSet(("heel",))), tmp_path / "a.npz")
    _repack(tmp_path / "a.npz", old, new)
    message = _message(tmp_path / "a.npz", (tmp_path / "a.npz").read_bytes())
    assert "expected arrays of numeric type, as numpy.savez writes them, got others" in message


def test_npz_without_markers_has_not_any_number_of_frames(tmp_path):
    write_npz(Walk(np.ones((2, 0, 3)), 100, MarkerSet(())), tmp_path / "a.npz")
    assert read_walk(tmp_path / "a.npz").n_frames == 2
    _repack(tmp_path / "a.npz", b"(2, 0, 3), }" + b" " * 12, b"(1000000000000, 0, 3), }")
    message = _message(tmp_path / "a.npz", (tmp_path / "a.npz").read_bytes())
    assert "expected an array of shape (1000000000000, 0, 3) and numeric type, got 0 bytes" in message


def test_mat_of_thousands_of_dimensions_takes_no_quadratic_time(tmp_path):
    sizes = struct.pack("<i", 2**31 - 1) * 100_000
    body = struct.pack("<IIII", 6, 8, 6, 0) + struct.pack("<II", 5, len(sizes)) + sizes
    body += struct.pack("<II", 0x10001, ord("x")) + struct.pack("<II", 9, 0)
    data = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + struct.pack("<II", 14, len(body)) + body
    start = process_time()
    assert "byte 128: expected a variable of at most 32 dimensions" in _message(tmp_path / "a.mat", data)
    assert process_time() - start < 2


def test_c3d_of_frames_counted_in_numbers_that_are_none(tmp_path):
    more = INTEL.entry("TRIAL", -3, b"\0")
    for name in ("ACTUAL_START_FIELD", "ACTUAL_END_FIELD"):
        more += INTEL.parameter(name, 3, 4, [2], INTEL.real(float("nan"), float("inf")))
    message = _message(tmp_path / "a.c3d", INTEL.file(POINTS, more=more))
    assert "expected numbers of the first and the last frame in TRIAL" in message


def test_c3d_events_at_times_that_are_none_warn_of_nothing(tmp_path):
    more = INTEL.parameter("USED", 2, 2, [], INTEL.word(1)) + INTEL.texts("LABELS", 2, ["Foot Off"])
    more += INTEL.parameter("TIMES", 2, 4, [2, 1], INTEL.real(float("inf"), -float("inf")))
    assert "expected 1 events" in _message(tmp_path / "a.c3d", INTEL.file(POINTS, more=more))
