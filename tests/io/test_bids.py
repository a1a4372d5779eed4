"""Motion-BIDS: the round trip with events, the files beside the recording, and every fault with its file and line."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker._validation import WalkError
from eigenwalker.io import read_bids, write_bids
from eigenwalker.motion import TROJE15, Event, JointWalk, MarkerSet, Skeleton, Walk
from tests.marker_walks import assert_same_walk, body, faults, outcome, refusal, walks

STEM = "sub-01_task-stroll_tracksys-omc"
MOTION = "0.5\t1000\tn/a\t1\t0.0\n0.5\t1001\tnan\t1\t0.01\n0.5\t1002\t3\t1\t0.02\n"
CHANNELS = """name\tcomponent\ttype\ttracked_point\tunits\tsampling_frequency
heel_x\tx\tPOS\theel\tm\t100
heel_y\ty\tPOS\theel\tmm\tn/a
heel_z\tz\tPOS\theel\tcm\t100
heel_quat_x\tquat_x\tORNT\theel\tn/a\t100
time\tn/a\tLATENCY\tn/a\ts\t100
"""
SIDECAR = {"TaskName": "stroll", "TrackingSystemName": "omc", "SamplingFrequency": 100}
EVENTS = """onset\tduration\ttrial_type\tvalue
0.01\t0\tleft_heel_strike\t1
n/a\t0\tright_heel_strike\t1
0.02\tn/a\tstart\t1
0.03\t0\tn/a\t1
"""


@pytest.fixture
def files(tmp_path):
    """Write a recording by hand and return its `_motion.tsv`."""
    (tmp_path / f"{STEM}_channels.tsv").write_text(CHANNELS)
    (tmp_path / f"{STEM}_motion.json").write_text(json.dumps(SIDECAR))
    (tmp_path / f"{STEM}_motion.tsv").write_text(MOTION)
    return tmp_path / f"{STEM}_motion.tsv"


def _beside(path, ending):
    return path.with_name(STEM + ending)


def _message(path, **options):
    with pytest.raises(WalkError) as caught:
        read_bids(path, **options)
    return str(caught.value)


@settings(max_examples=60, deadline=None)
@given(walk=walks(events=True))
def test_round_trip_is_exact(tmp_path_factory, walk):
    folder = tmp_path_factory.mktemp("bids")
    write_bids(walk, folder / "anna_motion.tsv")
    back = read_bids(folder / "anna_motion.tsv")
    assert_same_walk(back, walk)
    assert (back.frame_rate, back.name) == (walk.frame_rate, "anna")
    ending = ["_events.tsv"] if walk.events else []
    endings = ["_channels.tsv", *ending, "_motion.json", "_motion.tsv"]
    assert sorted(path.name for path in folder.iterdir()) == [f"anna{ending}" for ending in endings]


def test_what_is_written(tmp_path):
    walk = body(np.random.default_rng(0), gaps=3)
    write_bids(walk, tmp_path / f"{STEM}_motion.tsv")
    sidecar = json.loads((tmp_path / f"{STEM}_motion.json").read_text())
    assert sidecar["TaskName"] == "stroll"
    assert sidecar["TrackingSystemName"] == "omc"
    assert (sidecar["SamplingFrequency"], sidecar["TrackedPointsCount"], sidecar["POSChannelCount"]) == (120, 15, 45)
    lines = (tmp_path / f"{STEM}_channels.tsv").read_text().splitlines()
    assert lines[:2] == ["name\tcomponent\ttype\ttracked_point\tunits", "head_x\tx\tPOS\thead\tm"]
    assert len((tmp_path / f"{STEM}_motion.tsv").read_text().splitlines()) == walk.n_frames
    assert read_bids(tmp_path / f"{STEM}_motion.tsv").marker_set is TROJE15


def test_events_of_an_older_walk_do_not_stay(tmp_path):
    walk = Walk(np.zeros((2, 1, 3)), 30, MarkerSet(("heel",)), events=(Event(0.5, "heel_strike", "left"),))
    path = tmp_path / "anna_motion.tsv"
    write_bids(walk, path)
    assert read_bids(path).events == walk.events
    write_bids(Walk(walk.positions, 30, walk.marker_set), path)
    assert read_bids(path).events == ()


def test_a_recording_by_hand(files):
    _beside(files, "_events.tsv").write_text(EVENTS)
    walk = read_bids(files)
    assert walk.name == STEM
    assert walk.frame_rate == 100
    assert walk.marker_set.names == ("heel",)
    assert_allclose(walk.positions[2, 0], [0.5, 1.002, 0.03])
    assert np.isnan(walk.positions[:2, 0, 2]).all()
    assert walk.events == (Event(0.01, "heel_strike", "left"), Event(0.02, "start"))


def test_effective_frequency_is_preferred(files):
    sidecar = {**SIDECAR, "SamplingFrequencyEffective": 100.05}
    _beside(files, "_motion.json").write_text(json.dumps(sidecar))
    assert read_bids(files).frame_rate == 100.05
    assert read_bids(files, frame_rate=50).frame_rate == 50
    _beside(files, "_motion.json").write_text(json.dumps({"SamplingFrequency": "n/a"}))
    assert read_bids(files).frame_rate == 100


@pytest.mark.parametrize("axes", ["ALS", "FLU", "ARS", "RUF", "PLI", "SAL"])
def test_spatial_axes_are_followed(files, axes):
    _beside(files, "_motion.json").write_text(json.dumps({**SIDECAR, "SpatialAxes": axes}))
    got = read_bids(files).positions[2, 0]
    directions = {**dict.fromkeys("AF", (0, 1)), "P": (0, -1), "L": (1, 1), "R": (1, -1)}
    directions |= {**dict.fromkeys("SU", (2, 1)), "I": (2, -1)}
    for letter, value in zip(axes, [0.5, 1.002, 0.03], strict=True):
        axis, sign = directions[letter]
        assert got[axis] == pytest.approx(sign * value)
    assert_allclose(read_bids(files, up="y").positions[2, 0], [0.03, 0.5, 1.002])


def test_axes_of_a_reference_frame(files):
    table = [f"{line}\tlab" for line in CHANNELS.splitlines()]
    _beside(files, "_channels.tsv").write_text("\n".join(table).replace("lab", "reference_frame", 1))
    levels = {"lab": {"SpatialAxes": "ARS"}, "other": {"SpatialAxes": "PLI"}}
    _beside(files, "_channels.json").write_text(json.dumps({"reference_frame": {"Levels": levels}}))
    assert_allclose(read_bids(files).positions[2, 0], [0.5, -1.002, 0.03])
    levels["lab"]["SpatialAxes"] = "AR_"
    _beside(files, "_channels.json").write_text(json.dumps({"reference_frame": {"Levels": levels}}))
    assert "expected SpatialAxes such as 'ALS', the same for all positions, got \"['AR_']\"; pass up=" in _message(
        files
    )


def test_missing_files_are_named(files):
    for ending in ("_channels.tsv", "_motion.json"):
        kept = _beside(files, ending).read_text()
        _beside(files, ending).unlink()
        message = _message(files)
        assert message == f"{files}: expected its companion {STEM}{ending} beside it, got no such file"
        _beside(files, ending).write_text(kept)
    files.unlink()
    with pytest.raises(FileNotFoundError):
        read_bids(files)
    with pytest.raises(WalkError, match=r"walk\.tsv: expected a Motion-BIDS recording, whose name ends in _motion"):
        read_bids("walk.tsv")


@pytest.mark.parametrize(
    ("ending", "old", "new", "match"),
    [
        (
            "_motion.tsv",
            "0.5\t1000",
            "a\tb",
            r"line 1: expected a number, as a _motion\.tsv has no header line, got 'a'",
        ),
        ("_motion.tsv", "0.5\t1001", "0.5", r"line 2: expected 5 fields, got 4$"),
        ("_motion.tsv", "3\t1\t0.02\n", "3", r"line 3: expected 5 fields, got 3; the file seems to be cut off"),
        ("_motion.tsv", "1001", "far", r"line 2: expected a finite number or a gap as value 2 of 5, got 'far'"),
        ("_motion.tsv", "\t0.01\n", "\t0.03\n", r"line 3: expected times in seconds that rise"),
        ("_motion.tsv", MOTION, "", r"line 1: expected 5 numbers a frame, got an empty file"),
        ("_channels.tsv", "component", "axis", r"line 1: expected the columns name, component.*, but not so component"),
        (
            "_channels.tsv",
            "heel_y\ty",
            "heel_y\tx",
            r"line 3: expected a tracked_point and a component.*'heel' and 'x'",
        ),
        ("_channels.tsv", "heel_y\ty", "heel_y\tn/a", r"line 3: expected a tracked_point and a component.* and 'n/a'"),
        (
            "_channels.tsv",
            "POS\theel\tmm",
            "POS\ttoe\tmm",
            r"line 1: expected POS channels for x, y and z of.*heel, toe",
        ),
        ("_channels.tsv", "POS\theel\tmm", "POS\tn/a\tmm", r"line 3: expected a tracked_point and a component"),
        ("_channels.tsv", "heel\tmm", "heel\tfeet", r"line 3: expected units among m, cm, mm, in, got 'feet'"),
        ("_channels.tsv", "ORNT", "BEEP", r"line 5: expected a type of ACCEL, .*VEL, got 'BEEP'"),
        ("_channels.tsv", "heel_y\ty\t", "heel_y\t", r"line 3: expected 6 fields, got 5"),
        (
            "_channels.tsv",
            "heel\tm\t100",
            "heel\tm\tfast",
            r"line 2: expected sampling_frequency in frames per.*'fast'",
        ),
        ("_channels.tsv", "POS", "MISC", r"line 1: expected at least one tracked point with POS channels, got none"),
        ("_motion.json", "100}", "100", r"motion\.json: expected JSON, but"),
        ("_motion.json", json.dumps(SIDECAR), "[1]", r"motion\.json: expected a JSON object, got list"),
        ("_motion.json", "100}", "0}", r"motion\.json: expected SamplingFrequency in frames per second.*got '0'"),
        ("_motion.json", "100}", "NaN}", r"motion\.json: expected SamplingFrequency in frames per second.*got 'nan'"),
        ("_motion.json", "100}", '"fast"}', r"motion\.json: expected SamplingFrequency in frames.*got \"'fast'\""),
        ("_motion.json", "100}", "120}", r"expected positions of 120 frames a second, got sampling_frequency 100"),
        ("_motion.json", "100}", '100, "SpatialAxes": 3}', r"motion\.json: expected SpatialAxes such as 'ALS'.*\[3\]"),
        ("_events.tsv", "onset", "start", r"line 1: expected the columns onset, duration once each, but not so onset"),
        ("_events.tsv", "0.01", "soon", r"line 2: expected a finite number or a gap as value 1 of 4, got 'soon'"),
    ],
)
def test_faults_are_named_with_their_file(files, ending, old, new, match):
    _beside(files, "_events.tsv").write_text(EVENTS)
    file = _beside(files, ending)
    content = file.read_text()
    assert old in content
    file.write_text(content.replace(old, new, -1 if old == "POS" else 1))
    with pytest.raises(WalkError, match=match) as caught:
        read_bids(files)
    assert str(files.parent) in str(caught.value)


def test_no_frequency_at_all(files):
    _beside(files, "_motion.json").write_text("{}")
    _beside(files, "_channels.tsv").write_text(CHANNELS.replace("\t100", "\tn/a"))
    assert "expected a SamplingFrequency, got none; pass frame_rate=" in _message(files)
    assert read_bids(files, frame_rate=25).frame_rate == 25


def test_legs_are_checked(files):
    walk = body(np.random.default_rng(0))
    write_bids(Walk(walk.positions / 1000, 120), files)
    _beside(files, "_events.tsv").unlink(missing_ok=True)
    assert "m long with unit='m', expected 0.3 to 1.3 m" in _message(files)


def test_wrong_walks_are_not_written(tmp_path):
    heel = MarkerSet(("heel",))
    joints = JointWalk(np.zeros((2, 1, 3)), np.zeros((2, 3)), Skeleton(("Hips",), [-1], np.zeros((1, 3))), 30)
    with pytest.raises(TypeError, match=r"turn joints into markers with to_markers\(\)"):
        write_bids(joints, tmp_path / "a_motion.tsv")
    with pytest.raises(WalkError, match=r"a\.tsv: expected a Motion-BIDS recording"):
        write_bids(Walk(np.zeros((1, 1, 3)), 30, heel), tmp_path / "a.tsv")
    with pytest.raises(WalkError, match=r"names of markers other than 'n/a'"):
        write_bids(Walk(np.zeros((1, 1, 3)), 30, MarkerSet(("n/a",))), tmp_path / "a_motion.tsv")
    for event in (Event(0, "left_turn"), Event(0, "turn", "up"), Event(0, "")):
        with pytest.raises(WalkError, match=r"expected events of side left, right or '' and a kind without a side"):
            write_bids(Walk(np.zeros((1, 1, 3)), 30, heel, events=(event,)), tmp_path / "a_motion.tsv")
    assert not list(tmp_path.iterdir())


@settings(max_examples=200, deadline=None)
@given(
    data=st.data(),
    ending=st.sampled_from(["_motion.tsv", "_channels.tsv", "_motion.json", "_events.tsv", "_channels.json"]),
)
def test_any_content_is_read_or_refused(tmp_path_factory, data, ending):
    folder = tmp_path_factory.mktemp("faults")
    contents = {
        "_motion.tsv": MOTION,
        "_channels.tsv": CHANNELS,
        "_motion.json": json.dumps({**SIDECAR, "SpatialAxes": "ALS"}),
        "_events.tsv": EVENTS,
        "_channels.json": '{"reference_frame": {"Levels": {"lab": {"SpatialAxes": "ALS"}}}}',
    }
    for other, text in contents.items():
        (folder / f"{STEM}{other}").write_text(text)
    broken = data.draw(faults(contents[ending].encode()))

    def read(path):
        return read_bids(folder / f"{STEM}_motion.tsv")

    outcome(read, folder / f"{STEM}{ending}", broken)


def test_binary_companions_are_refused(files):
    for ending in ("_motion.tsv", "_channels.tsv", "_motion.json"):
        file = _beside(files, ending)
        kept = file.read_bytes()
        message = refusal(lambda _: read_bids(files), file, b"\0\xff\xfe")
        assert "got binary data" in message or "expected JSON" in message
        file.write_bytes(kept)
    assert_array_equal(read_bids(files).positions[:, 0, 0], 0.5)
