"""C3D: round trips, another program's reading of the same files, and hand-made files."""

import ezc3d
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker._validation import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.io.c3d import read_c3d, write_c3d
from eigenwalker.motion import TROJE15, Event, MarkerSet, Walk
from tests.c3d_files import INTEL, POINTS, PROCESSORS, Maker, event_parameters


def _read(folder, data, **options):
    path = folder / "walk.c3d"
    path.write_bytes(data)
    return read_c3d(path, **options)


METERS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254}

_words = st.text("abcXYZ019 _-:*é日", min_size=1, max_size=12).filter(lambda word: word == word.strip())


@st.composite
def walks(draw):
    """Draw a walk with gaps and events."""
    names = draw(st.lists(_words.filter(lambda word: ":" not in word), min_size=1, max_size=5, unique=True))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    positions = rng.normal(size=(draw(st.integers(1, 30)), len(names), 3)) * draw(st.sampled_from([1e-3, 1.0, 1e3]))
    positions[rng.random(positions.shape[:2]) < draw(st.sampled_from([0, 0.3, 1]))] = np.nan
    kinds = st.sampled_from(["heel_strike", "toe_off"]) | _words
    events = draw(st.lists(st.tuples(st.floats(-100, 4000), kinds, st.sampled_from(["left", "right", ""])), max_size=6))
    rate = draw(st.sampled_from([50, 59.94, 100, 120, 250]))
    return Walk(positions, rate, MarkerSet(names), events=tuple(Event(*event) for event in events))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder that the examples of one law share."""
    return tmp_path_factory.mktemp("c3d")


def _assert_same(again, walk):
    """Compare to the seven digits of 32-bit reals; event times below 60 s have them for their seconds."""
    assert again.marker_set.names == walk.marker_set.names
    assert again.frame_rate == pytest.approx(walk.frame_rate, rel=1e-7)
    assert_array_equal(np.isnan(again.positions), np.isnan(walk.positions))
    assert_allclose(again.positions, walk.positions, rtol=2e-7)
    assert_allclose([e.time for e in again.events], [e.time for e in walk.events], atol=5e-6)
    assert sorted(e[1:] for e in again.events) == sorted(e[1:] for e in walk.events)


@settings(max_examples=80, deadline=None)
@given(walk=walks(), unit=st.sampled_from(list(METERS)))
def test_any_walk_comes_back(folder, walk, unit):
    write_c3d(walk, folder / "walk.c3d", unit=unit)
    _assert_same(read_c3d(folder / "walk.c3d"), walk)


@settings(max_examples=15, deadline=None)
@given(walk=walks())
def test_another_program_reads_the_same(folder, walk):
    write_c3d(walk, folder / "walk.c3d")
    peer = ezc3d.c3d(str(folder / "walk.c3d"))
    assert_allclose(peer["data"]["points"][:3].transpose(2, 1, 0) / 1000, walk.positions, rtol=2e-7)
    assert peer["parameters"]["POINT"]["LABELS"]["value"] == list(walk.marker_set.names)
    assert peer["parameters"]["POINT"]["UNITS"]["value"] == ["mm"]
    if walk.events:
        minutes, seconds = peer["parameters"]["EVENT"]["TIMES"]["value"].reshape(2, -1)
        assert_allclose(60 * minutes + seconds, [event.time for event in walk.events], atol=5e-6)


def _peer(n_points, n_frames, path, **parameters):
    """Write a file with the other program; return its positions in millimetres."""
    file = ezc3d.c3d()
    points = np.random.default_rng(0).normal(size=(3, n_points, n_frames)) * 1000
    file["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    file["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    file["parameters"]["POINT"]["LABELS"]["value"] = [f"m{number}" for number in range(n_points)]
    file["data"]["points"] = points
    for name, value in parameters.items():
        file.add_parameter("EVENT", name, value)
    file.write(str(path))
    return points.transpose(2, 1, 0)


def test_files_of_another_program_are_read(tmp_path):
    times = np.array([[0.0, 1.0], [0.5, 2.25]])
    events = {"USED": [2], "CONTEXTS": ["Left", "General"], "LABELS": ["Foot Strike", "Hop"], "TIMES": times}
    points = _peer(300, 7, tmp_path / "peer.c3d", **events)
    walk = read_c3d(tmp_path / "peer.c3d")
    assert_allclose(walk.positions, points / 1000, rtol=2e-7)
    assert walk.marker_set.names == tuple(f"m{number}" for number in range(300))  # LABELS and LABELS2
    assert walk.events == (Event(0.5, "heel_strike", "left"), Event(62.25, "Hop", ""))


@pytest.mark.parametrize(("n_markers", "n_frames", "n_events"), [(600, 3, 0), (1, 70000, 0), (2, 5, 700)])
def test_many_markers_frames_and_events_come_back(tmp_path, n_markers, n_frames, n_events):
    rng = np.random.default_rng(1)
    names = MarkerSet(tuple(f"marker {number}" for number in range(n_markers)))
    events = tuple(Event(float(t), "heel_strike", "left") for t in np.arange(n_events) / 4)
    walk = Walk(rng.normal(size=(n_frames, n_markers, 3)), 100, names, events=events)
    write_c3d(walk, tmp_path / "walk.c3d")
    _assert_same(read_c3d(tmp_path / "walk.c3d"), walk)
    assert ezc3d.c3d(str(tmp_path / "walk.c3d"))["data"]["points"].shape == (4, n_markers, n_frames)


def test_recorded_files_agree_with_another_program(data_dir):
    paths = sorted((data_dir / "horst_c3d").glob("*.c3d"))
    assert len(paths) == 11
    for path in paths:
        walk, peer = read_c3d(path), ezc3d.c3d(str(path))
        assert_allclose(walk.positions, peer["data"]["points"][:3].transpose(2, 1, 0) * 0.001, rtol=1e-12)
        assert list(walk.marker_set.names) == peer["parameters"]["POINT"]["LABELS"]["value"]
        assert (walk.frame_rate, walk.name, walk.events) == (250.0, path.stem, ())
        assert len(walk.marker_set.names) == (62 if "Static" in path.name else 54)
        heel, head = walk.marker("R HEEL")[:, 2], walk.marker("R HEAD")[:, 2]
        assert 0 < heel.min() < 0.1
        assert 1.5 < head.mean() < 1.8


@pytest.mark.parametrize("processor", PROCESSORS)
@pytest.mark.parametrize("scale", [-1.0, 0.5])
@pytest.mark.parametrize("analog", [0, 3])
def test_all_kinds_of_numbers_are_read(tmp_path, processor, scale, analog):
    walk = _read(tmp_path, Maker(processor).file(POINTS, scale=scale, analog=analog))
    expected = POINTS[..., :3] * abs(scale) / 1000
    expected[1, 0] = np.nan
    assert_allclose(walk.positions, expected)
    assert walk.marker_set.names == ("LANK", "RANK")
    assert walk.frame_rate == 50


def test_a_gap_is_a_negative_residual_or_nan(tmp_path):
    points = POINTS.astype(float)
    points[0, 0] = [np.nan, 0, 0, 0]
    points[0, 1] = 0  # the origin is a place like others
    gaps = np.isnan(_read(tmp_path, INTEL.file(points)).positions)
    assert_array_equal(gaps, np.array([[True, False], [True, False]])[..., np.newaxis].repeat(3, axis=2))


def test_events_count_from_the_first_frame(tmp_path):
    more = event_parameters(["Foot Strike", "FOOT OFF", "Event"], ["Right", "Left", "Both"], [0, 2.5, 0, 2.75, 1, 2])
    walk = _read(tmp_path, INTEL.file(POINTS, first=101, more=more))
    assert walk.events == (
        Event(0.5, "heel_strike", "right"),
        Event(0.75, "toe_off", "left"),
        Event(60.0, "Event", ""),
    )
    used = event_parameters(["Foot Strike", "Foot Off"], ["Right", "Left"], [0, 2.5, 0, 2.75], used=1)
    assert len(_read(tmp_path, INTEL.file(POINTS, more=used)).events) == 1
    short = event_parameters(["Foot Strike", "Foot Off"], ["Right", "Left"], [0, 2.5])
    with pytest.raises(WalkError, match=r"walk\.c3d: expected 2 events, as EVENT:USED says, got 2 EVENT:LABELS and 1"):
        _read(tmp_path, INTEL.file(POINTS, more=short))


def test_a_prefix_that_all_share_is_dropped(tmp_path):
    def names(*labels):
        return _read(tmp_path, INTEL.file(POINTS, labels=labels)).marker_set.names

    assert names("Anna:LANK", "Anna:RANK") == ("LANK", "RANK")
    assert names("Anna:LANK", "Ben:LANK") == ("Anna:LANK", "Ben:LANK")
    assert names("Anna:LANK", "RANK") == ("Anna:LANK", "RANK")
    assert names("LANK") == ("LANK", "point 2")


def test_unit_axes_and_markers_can_be_asked_for(tmp_path):
    data = INTEL.file(POINTS)
    assert_allclose(_read(tmp_path, data, unit="cm").positions[0, 0], [1, -2, 9])
    assert_allclose(_read(tmp_path, data, up="y").positions[0, 0], [0.9, 0.1, -0.2])
    one = _read(tmp_path, data, markers=["RANK"], name="anna")
    assert (one.name, one.marker_set.names, one.positions.shape) == ("anna", ("RANK",), (2, 1, 3))
    with pytest.raises(WalkError, match=r"expected points labelled SACR; the labels are LANK, RANK"):
        _read(tmp_path, data, markers=["SACR", "LANK"])


def test_troje_markers_come_back_as_such(tmp_path):
    walk = make_walkers(1, random_state=0).data[0]
    write_c3d(walk, tmp_path / "walk.c3d")
    assert read_c3d(tmp_path / "walk.c3d").marker_set is TROJE15
    with pytest.raises(WalkError, match=r"walk\.c3d'?: legs are .* m long with unit='m'.*unit='mm'"):
        read_c3d(tmp_path / "walk.c3d", unit="m")
