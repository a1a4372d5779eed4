"""NPZ: everything a walk holds comes back to the last bit, and no bytes break the reader."""

import io
import json
import tracemalloc
import zipfile
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from eigenwalker._validation import WalkError
from eigenwalker.io import read_npz, write_npz
from eigenwalker.motion import TROJE15, Event, JointWalk, MarkerSet, Skeleton, Walk
from tests.marker_walks import assert_same_walk, faults, outcome, refusal, walks


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("npz")


def _joint_walk(rng):
    skeleton = Skeleton(
        ("Root", "Hips", "Knie é"), [-1, 0, 1], rng.normal(size=(3, 3)), [2], rng.normal(size=(1, 3)), root=1
    )
    return JointWalk(
        rng.normal(size=(4, 3, 3)),
        rng.normal(size=(4, 3)),
        skeleton,
        59.94,
        "eva",
        speed=1.25,
        frequency=0.93,
        size=1.7,
        translations={"Knie é": rng.normal(size=(4, 3))},
        events=(Event(0.5, "toe_off", "right"), Event(0.25, "stumble")),
    )


def _contents(path):
    """Return the arrays of an archive, as numpy reads them."""
    with np.load(path, allow_pickle=False) as archive:
        return dict(archive)


def _repacked(path, **changes):
    """Return the bytes of the archive with some arrays changed, and those left out that are None."""
    arrays = {name: array for name, array in {**_contents(path), **changes}.items() if array is not None}
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


@settings(max_examples=60, deadline=None)
@given(
    walk=walks(events=True),
    name=st.text(st.characters(exclude_categories=("Cs",))),
    speed=st.floats(allow_infinity=False),
    size=st.floats(0.1, 10),
)
def test_round_trip_is_exact(folder, walk, name, speed, size):
    walk = Walk(walk.positions, walk.frame_rate, walk.marker_set, name, speed, size, walk.events)
    write_npz(walk, folder / "anna.npz")
    back = read_npz(folder / "anna.npz")
    assert_same_walk(back, walk)
    assert back.marker_set == walk.marker_set
    assert (back.frame_rate, back.name, back.size) == (walk.frame_rate, name, size)
    assert_array_equal(back.speed, speed)


def test_joint_walks_come_back(folder):
    walk = _joint_walk(np.random.default_rng(0))
    write_npz(walk, folder / "eva.npz")
    back = read_npz(folder / "eva.npz")
    assert isinstance(back, JointWalk)
    for field in fields(Skeleton):
        assert_array_equal(getattr(back.skeleton, field.name), getattr(walk.skeleton, field.name), strict=False)
    for name in ("rotations", "root", "frame_rate", "name", "speed", "size", "frequency"):
        assert_array_equal(getattr(back, name), getattr(walk, name))
    assert back.events == walk.events
    assert list(back.translations) == ["Knie é"]
    assert_array_equal(back.translations["Knie é"], walk.translations["Knie é"])
    assert_array_equal(back.joint_positions(), walk.joint_positions())


@given(upright=st.booleans(), joints=st.none() | st.sets(st.sampled_from(["Root", "Hips", "Knie é"])))
def test_what_preparation_says_of_joints_comes_back(folder, upright, joints):
    walk = _joint_walk(np.random.default_rng(0))
    walk = replace(walk, skeleton=replace(walk.skeleton, upright=upright), channel_joints=joints)
    write_npz(walk, folder / "eva.npz")
    back = read_npz(folder / "eva.npz")
    assert back.skeleton.upright is upright
    assert back.channel_joints == walk.channel_joints
    assert back.channel_names == walk.channel_names
    assert_array_equal(back.channels, walk.channels)


def test_joint_walks_without_those_fields_are_read(folder):
    """Older files have none of them."""
    path = folder / "eva.npz"
    write_npz(_joint_walk(np.random.default_rng(0)), path)
    text = json.loads(str(_contents(path)["walk"]))
    old = {key: value for key, value in text.items() if key not in ("upright", "channel_joints")}
    path.write_bytes(_repacked(path, walk=np.array(json.dumps(old))))
    back = read_npz(path)
    assert not back.skeleton.upright
    assert back.channel_joints is None
    for wrong, message in (
        ({"upright": "no"}, "expected upright to be true or false, got 'no'"),
        ({"channel_joints": ["Tail"]}, "no joint 'Tail'; this skeleton has Root, Hips"),
    ):
        assert message in refusal(read_npz, path, _repacked(path, walk=np.array(json.dumps(text | wrong))))


def test_precision_sticks_and_name_are_kept(folder):
    path = folder / "no suffix"
    marker_set = MarkerSet(("b", "a"), (("a", "b"),))
    write_npz(Walk(np.zeros((1, 2, 3), np.float32), 30, marker_set, "anna"), path)
    back = read_npz(path)
    assert back.positions.dtype == np.float32
    assert not back.positions.flags.writeable
    assert back.marker_set == marker_set
    assert np.isnan(back.speed)
    assert read_npz(path, name="eva").name == "eva"
    assert read_npz(path).name == "anna"


def test_numpy_opens_it(folder):
    write_npz(Walk(np.ones((2, 15, 3)), 30), folder / "anna.npz")
    contents = _contents(folder / "anna.npz")
    assert contents["positions"].shape == (2, 15, 3)
    assert json.loads(str(contents["walk"]))["markers"] == list(TROJE15.names)


def test_what_is_no_walk_is_refused(folder):
    path = folder / "anna.npz"
    write_npz(Walk(np.ones((2, 15, 3)), 30), path)
    text = str(_contents(path)["walk"])
    new = np.array(text.replace('"version": 1', '"version": 99'))
    cases = {
        "expected version 1 of the layout, got 99; update the package": _repacked(path, walk=new),
        "expected an archive written by write_npz, got one of positions": _repacked(path, walk=None),
        "got KeyError: 'positions'": _repacked(path, positions=None),
        "positions must have shape": _repacked(path, positions=np.ones((2, 3, 3))),
        "expected an array of shape (1,) and numeric type": _repacked(path, positions=np.array([1j])),
        "frame_rate must be positive": _repacked(path, walk=np.array(text.replace("30", "-30"))),
        "JSONDecodeError": _repacked(path, walk=np.array(text[:-3])),
        "got BadZipFile": b"",
    }
    for message, content in cases.items():
        assert message in refusal(read_npz, path, content)
    with pytest.raises(TypeError, match="expected a Walk or JointWalk, got int"):
        write_npz(3, path)


def test_compressed_and_pickled_archives_are_refused(folder):
    path = folder / "other.npz"
    file = io.BytesIO()
    np.savez_compressed(file, walk=np.zeros(10_000_000))
    assert "without compression, got walk.npy compressed; use write_npz" in refusal(read_npz, path, file.getvalue())
    file = io.BytesIO()
    np.savez(file, walk=np.array([{}], dtype=object))
    assert "numeric type" in refusal(read_npz, path, file.getvalue())


def test_a_false_shape_costs_no_memory(folder):
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (10**12, 15, 3)})
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("walk.npy", header.getvalue() + b"\0" * 64)
    tracemalloc.start()
    message = refusal(read_npz, folder / "huge.npz", file.getvalue())
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert "expected an array of shape (1000000000000, 15, 3) and numeric type, got 64 bytes" in message
    assert peak < 1_000_000


@settings(max_examples=200, deadline=None)
@given(data=st.data(), joints=st.booleans())
def test_any_content_is_read_or_refused(folder, data, joints):
    rng = np.random.default_rng(0)
    walk = _joint_walk(rng) if joints else Walk(np.ones((2, 2, 3)), 30, MarkerSet(("a", "b")), "anna")
    write_npz(walk, folder / "sound.npz")
    content = data.draw(faults((folder / "sound.npz").read_bytes()))
    outcome(read_npz, folder / "broken.npz", content)


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_any_text_within_is_read_or_refused(folder, data):
    """The archive's own checksum would refuse what is changed from outside."""
    write_npz(_joint_walk(np.random.default_rng(0)), folder / "sound.npz")
    fields_ = json.loads(str(_contents(folder / "sound.npz")["walk"]))
    key = data.draw(st.sampled_from(sorted(fields_)))
    odd = st.one_of(st.none(), st.integers(-3, 3), st.text(max_size=3), st.lists(st.integers(0, 2), max_size=3))
    fields_[key] = data.draw(odd)
    content = _repacked(folder / "sound.npz", walk=np.array(json.dumps(fields_)))
    outcome(read_npz, folder / "broken.npz", content)


def test_missing_files_are_no_faults(folder):
    with pytest.raises(FileNotFoundError):
        read_npz(folder / "none.npz")
    with pytest.raises(WalkError, match="BadZipFile"):
        read_npz(__file__)
