"""Walks in joint angles: their markers are those of `prepare`, and what changes no motion changes nothing."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from eigenwalker import FourierLinearizer, prepare, read_walk
from eigenwalker.io import write_bvh
from eigenwalker.motion import euler_from_rotvec, resample, rotvec_from_euler, unroll_rotvec
from tests.joint_bodies import over_floor, swinging, turned
from tests.recorded import bandai_joints, bandai_walks, cmu_joints, cmu_walks

ORDERS = ["".join(order) for order in itertools.permutations("XYZ")]
WAYS = {
    "default": {},
    "whole": {"clip": "whole"},
    "body": {"heading": "body"},
    "size": {"normalize_size": True},
    "steady": {"cadence": "steady"},
    "all": {"cadence": "steady", "normalize_size": True, "frequency_range": (0.6, 1.4)},
}
ways = pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
places = pytest.mark.parametrize("moving", [False, True], ids=["in place", "over the floor"])


def _joints(walk, **options):
    return prepare(walk, representation="joints", **options)


def _clean(moving, *, frame_rate=120.0, n_cycles=6.3):
    """Return a walk without noise whose number of strides is not whole."""
    phase = 1.0 + 2 * np.pi * 0.93 * np.arange(round(n_cycles * frame_rate / 0.93)) / frame_rate
    walk = swinging(phase, frame_rate=frame_rate)
    return over_floor(walk) if moving else walk


def _features(walk):
    return FourierLinearizer().fit_transform([walk])


def _assert_same(one, other, way, atol=1e-6):
    assert_allclose(_features(_joints(one, **way)), _features(_joints(other, **way)), atol=atol)


@pytest.fixture
def recorded(data_dir):
    """Return one recorded walk."""
    return read_walk(data_dir / "bandai2" / "dataset-2_walk_normal_001.bvh")


# The markers that the result carries.


def test_markers_of_recorded_walks_are_those_of_prepare(data_dir):
    """All 202 of them: the frames, the heading, the path and the speed."""
    pairs = [
        *zip(bandai_joints(data_dir), bandai_walks(data_dir)[1], strict=True),
        *zip(cmu_joints(data_dir), cmu_walks(data_dir)[1], strict=True),
    ]
    assert len(pairs) == 202
    for joints, markers in pairs:
        assert joints.name == markers.name
        assert_allclose(joints.to_markers().positions, markers.positions, atol=1e-9)
        assert_allclose(joints.speed, markers.speed, rtol=1e-9)


@pytest.mark.parametrize("place", [[0, 0, 0], [0.3, -1.2, 0.05]], ids=["top at zero", "top aside"])
@pytest.mark.parametrize("options", [{}, {"heading": "body"}, {"heading": None}, {"treadmill": False},
                                     {"frequency": "events"}, {"normalize_size": True}], ids=str)  # fmt: skip
def test_markers_are_those_of_prepare_in_each_way(recorded, options, place):
    """Also where the joint above the root lies aside, and again for what is in place already."""
    offsets = recorded.skeleton.offsets + np.eye(22)[:, :1] * place
    recorded = replace(recorded, skeleton=replace(recorded.skeleton, offsets=offsets))
    still = replace(_joints(recorded), speed=np.nan)
    for walk in (recorded, still):
        joints, markers = _joints(walk, **options), prepare(walk, **options)
        carried = joints.to_markers()
        assert_allclose(carried.positions, markers.positions, atol=1e-9)
        assert_allclose(
            [carried.speed, carried.size, carried.frequency], [markers.speed, markers.size, markers.frequency]
        )
        assert [event[1:] for event in joints.events] == [event[1:] for event in markers.events]
        assert_allclose([event.time for event in joints.events], [event.time for event in markers.events], atol=1e-9)
    assert np.isfinite(_joints(still).speed)


def test_smoothed_and_resampled_joints_are_near_smoothed_markers(recorded):
    """Filters of angles and of places differ by their bend: by some millimeters at wrists."""
    for options in (
        {"cutoff": 6.0},
        {"frame_rate": 60.0},
        {"cadence": "steady"},
        {"clip": "whole", "frame_rate": 25.0},
    ):
        joints, markers = _joints(recorded, **options).to_markers(), prepare(recorded, **options)
        assert joints.frame_rate == markers.frame_rate
        assert_allclose(joints.positions, markers.positions, atol=0.008)
        assert_allclose(joints.speed, markers.speed, rtol=1e-3)


# What changes no motion.


@given(degrees=st.floats(-180, 180))
@settings(max_examples=15)
def test_no_heading_is_left_in_the_channels(degrees):
    walk = _clean(moving=True)
    one, other = _joints(walk), _joints(turned(walk, degrees))
    assert_allclose(other.channels, one.channels, atol=1e-9)
    assert_allclose(other.root, one.root, atol=1e-9)


def test_no_heading_is_left_in_recorded_channels(recorded):
    for degrees in (37.0, 90.0, 180.0, -101.0):
        assert_allclose(_joints(turned(recorded, degrees)).channels, _joints(recorded).channels, atol=1e-9)


@ways
@places
def test_no_way_knows_the_heading_or_the_place(moving, way):
    walk = _clean(moving)
    for degrees in (37.0, 171.0):
        _assert_same(turned(walk, degrees), walk, way)
    if moving:
        _assert_same(replace(walk, root=walk.root + np.array([30.0, -12.0, 0.0])), walk, way)


@ways
@places
def test_time_zero_changes_nothing(moving, way):
    """To 1e-4 radians: turning hips carry the pelvis, whose path is fitted, along more than four harmonics."""
    walk = _clean(moving)
    for frames in (slice(0, -50), slice(40, None)):
        _assert_same(replace(walk, rotations=walk.rotations[frames], root=walk.root[frames]), walk, way, atol=1e-4)


@ways
@places
@pytest.mark.parametrize("factor", [2.0, 0.5])
def test_other_frame_rates_change_nothing(moving, way, factor):
    walk = _clean(moving)
    _assert_same(resample(walk, frame_rate=factor * 120.0), walk, way, atol=1e-4)


@pytest.mark.parametrize("order", ORDERS)
def test_the_order_of_euler_angles_changes_nothing(recorded, order):
    """To 1e-9 m through the angles themselves, and to the rounding of a file, 1e-6 degrees on a chain of ten joints."""
    turns = unroll_rotvec(rotvec_from_euler(euler_from_rotvec(recorded.rotations, order), order))
    assert_allclose(_made(replace(recorded, rotations=turns)), _made(recorded), atol=1e-9)


@pytest.mark.parametrize("order", ORDERS)
def test_the_order_of_angles_in_a_file_changes_nothing(recorded, order, tmp_path):
    write_bvh(recorded, tmp_path / "walk.bvh", orders=order)
    assert_allclose(_made(read_walk(tmp_path / "walk.bvh")), _made(recorded), atol=1e-7)


def _made(walk):
    """Return the markers of what a linearizer makes of a recording."""
    linearizer = FourierLinearizer(n_cycles=1)
    (made,) = linearizer.inverse_transform(linearizer.fit_transform([_joints(walk)]))
    return made.to_markers().positions
