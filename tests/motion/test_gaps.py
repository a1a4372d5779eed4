"""Gaps are found, short ones filled from what is known, and nothing else is touched."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

from eigenwalker import make_walkers, read_walks
from eigenwalker.motion import (
    TROJE15,
    Event,
    Gap,
    JointWalk,
    MarkerSet,
    Skeleton,
    Walk,
    fill_gaps,
    find_gaps,
)
from tests.synthetic import make_walk

BODY = MarkerSet(("front", "back", "top", "left_side", "far"))


def _tumbling(rng, *, n_frames=200, frame_rate=100.0, marker_set=BODY, wobble=0.0):
    """Return a walk of markers on one tumbling, travelling body, but for the last one, which goes its own way."""
    n_markers = len(marker_set.names)
    times = np.arange(n_frames)[:, np.newaxis] / frame_rate
    turn = Rotation.from_rotvec(rng.normal(size=3) * np.sin(3 * times) + rng.normal(size=3) * times)
    body = 0.15 * np.vstack((np.eye(3), [[-0.6, -0.4, 0.3], [0.8, -0.7, -0.5], [0.4, 0.2, 1.1]]))[:n_markers]
    positions = np.einsum("tij,pj->tpi", turn.as_matrix(), body) + (rng.normal(size=3) * times)[:, np.newaxis]
    positions[:, -1] += np.cos(2 * times + [0.0, 1.0, 2.0])
    positions += wobble * rng.normal(size=positions.shape)
    return Walk(positions, frame_rate, marker_set, "anna", events=(Event(0.5, "heel_strike", "left"),))


def _punched(walk, *holes):
    """Return the walk with NaN in (marker, first frame, number of frames)."""
    positions = walk.positions.copy()
    for marker, first, length in holes:
        positions[first : first + length, marker] = np.nan
    return replace(walk, positions=positions)


def _error(walk, filled):
    return np.linalg.norm(filled.positions - walk.positions, axis=2).max()


def test_gaps_are_listed_by_marker_and_time():
    walk = _punched(_tumbling(np.random.default_rng(0)), (3, 0, 1), (1, 190, 10), (1, 20, 5))
    positions = walk.positions.copy()
    positions[70, 2, 1] = np.nan
    positions[71, 2, 0] = np.inf
    assert find_gaps(replace(walk, positions=positions)) == [
        Gap("back", 20, 24, 0.2, 0.05),
        Gap("back", 190, 199, 1.9, 0.1),
        Gap("top", 70, 71, 0.7, 0.02),
        Gap("left_side", 0, 0, 0.0, 0.01),
    ]
    assert pd.DataFrame(find_gaps(walk)).columns.tolist() == list(Gap._fields)


def test_a_walk_without_gaps_stays():
    walk = _tumbling(np.random.default_rng(0))
    assert find_gaps(walk) == []
    assert_array_equal(fill_gaps(walk).positions, walk.positions)


@given(seed=st.integers(0, 10_000), first=st.integers(0, 180), length=st.integers(1, 20))
@settings(max_examples=40)
def test_a_rigid_body_carries_its_marker_exactly(seed, first, length):
    """At both ends of the walk too, where a spline would have to extrapolate."""
    walk = _tumbling(np.random.default_rng(seed))
    assert _error(walk, fill_gaps(_punched(walk, (0, first, length)))) < 1e-9


def test_known_places_are_met_at_both_ends_of_a_soft_body():
    """The marker slides on the body: at the ends of the gap the path goes on without a jump."""
    walk = _tumbling(np.random.default_rng(1))
    positions = walk.positions.copy()
    positions[:, 0, 0] += 0.004 * np.sin(2 * np.arange(200) / 100)
    walk = replace(walk, positions=positions)
    error = np.linalg.norm(fill_gaps(_punched(walk, (0, 100, 20))).positions - walk.positions, axis=2)[:, 0]
    # It slides by some 2 mm meanwhile; what is left is the bend of that.
    assert error.max() < 4e-4
    assert error[[100, 119]].max() < 1e-4


def test_bodies_are_those_that_keep_their_shape():
    """The marker that goes its own way is in no body: filling its gap equals the spline, which is not exact."""
    walk = _tumbling(np.random.default_rng(2))
    alone = replace(walk, positions=walk.positions[:, 4:], marker_set=MarkerSet(("far",)))
    filled = fill_gaps(_punched(walk, (4, 90, 20)))
    assert_allclose(filled.positions[:, 4:], fill_gaps(_punched(alone, (0, 90, 20))).positions, atol=1e-12)


def test_a_body_on_one_line_carries_nothing():
    """Three neighbors on a line leave the turn about it open, so that the spline is taken."""
    walk = _tumbling(np.random.default_rng(3))
    positions = walk.positions.copy()
    positions[:, 2] = 2 * positions[:, 1] - positions[:, 3]
    walk = replace(walk, positions=positions)
    alone = replace(walk, positions=walk.positions[:, :1], marker_set=MarkerSet(("front",)))
    filled = fill_gaps(_punched(walk, (0, 90, 10)))
    assert_allclose(filled.positions[:, :1], fill_gaps(_punched(alone, (0, 90, 10))).positions, atol=1e-12)


def test_a_body_must_be_known_throughout_the_gap():
    """With two markers of the only body gone the spline is taken, and another body where there is one."""
    walk = _tumbling(np.random.default_rng(4))
    both = _punched(walk, (0, 90, 10), (1, 95, 10))
    assert 1e-9 < _error(walk, fill_gaps(both)) < 1e-3
    names = MarkerSet((*BODY.names[:4], "low", "far"))
    walk = _tumbling(np.random.default_rng(4), marker_set=names)
    assert _error(walk, fill_gaps(_punched(walk, (0, 90, 10), (1, 95, 10)))) < 1e-9


def test_frames_of_zeros_carry_nothing():
    """A file that writes zeros where nothing was seen: no error, and the gap beside them is left to the spline."""
    walk = _tumbling(np.random.default_rng(6))
    positions = walk.positions.copy()
    positions[88:90] = 0.0
    filled = fill_gaps(_punched(replace(walk, positions=positions), (0, 90, 2)))
    assert np.isfinite(filled.positions).all()
    filled = fill_gaps(_punched(replace(walk, positions=positions), (0, 120, 20)))
    assert _error(replace(walk, positions=positions), filled) < 0.05


@given(seed=st.integers(0, 10_000), marker=st.integers(0, 14), frame_rate=st.sampled_from([30.0, 60.0, 120.0]))
@settings(max_examples=40)
def test_a_tenth_of_a_second_of_a_walk_is_bridged_to_a_millimetre(seed, marker, frame_rate):
    rng = np.random.default_rng(seed)
    walk, _ = make_walk(rng, frame_rate=frame_rate)
    length = int(0.1 * frame_rate) - 1  # so that the frames on both sides are a tenth of a second apart
    first = rng.integers(3, walk.n_frames - length - 3)
    assert _error(walk, fill_gaps(_punched(walk, (marker, first, length)))) < 1e-3


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_splines_are_exact_on_cubics(order):
    times = np.arange(50.0)[:, np.newaxis, np.newaxis] / 50
    walk = Walk(times**order * [1.0, -2.0, 0.5], 50, MarkerSet(("heel",)))
    assert _error(walk, fill_gaps(_punched(walk, (0, 3, 10), (0, 40, 7)))) < 1e-10


def test_long_gaps_and_ends_stay():
    walk, _ = make_walk(np.random.default_rng(0))
    holes = [(7, 100, 25), (7, 0, 4), (7, walk.n_frames - 5, 5), (7, 200, 24)]
    left = find_gaps(fill_gaps(_punched(walk, *holes)))
    assert [(gap.first_frame, gap.last_frame) for gap in left] == [
        (0, 3),
        (100, 124),
        (walk.n_frames - 5, walk.n_frames - 1),
    ]
    assert len(find_gaps(fill_gaps(_punched(walk, *holes), max_gap=25 / 120))) == 2
    assert len(find_gaps(fill_gaps(_punched(walk, *holes), max_gap=0.0))) == 4


def test_few_frames_support_no_spline():
    """Frames seen in between count as part of the gap: they are met, but they do not make two short gaps of it."""
    walk, _ = make_walk(np.random.default_rng(0))
    flicker = [(7, 100, 10), (7, 112, 10)]
    assert _error(walk, fill_gaps(_punched(walk, *flicker))) < 1e-3
    assert len(find_gaps(fill_gaps(_punched(walk, *flicker), max_gap=0.1))) == 2
    assert len(find_gaps(fill_gaps(_punched(walk, (7, 2, 5))))) == 1
    assert len(find_gaps(fill_gaps(_punched(walk, (7, 3, 5))))) == 0


def test_measured_coordinates_and_all_else_stay():
    walk = replace(make_walk(np.random.default_rng(0), speed=1.2, frequency=0.93)[0], size=1.7)
    positions = walk.positions.astype(np.float32)
    positions[100:105, 3, 2] = np.nan
    positions[150:250, 4, 0] = np.inf
    before = replace(walk, positions=positions, events=(Event(0.2, "toe_off", "right"),))
    after = fill_gaps(before)
    known = np.isfinite(before.positions)
    assert_array_equal(after.positions[known], before.positions[known])
    assert after.positions.dtype == np.float32
    assert not np.isfinite(after.positions[150:250, 4, 0]).any()
    assert (after.events, after.speed, after.size, after.name) == (before.events, 1.2, 1.7, before.name)
    assert np.isnan(before.positions[100:105, 3, 2]).all()


@pytest.mark.parametrize("seed", range(3))
def test_the_order_of_markers_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    walk = _tumbling(rng, marker_set=MarkerSet((*BODY.names[:4], "low", "far")), wobble=5e-4)
    walk = _punched(walk, (0, 50, 15), (2, 55, 12), (5, 100, 9))
    order = rng.permutation(6)
    mixed = Walk(walk.positions[:, order], 100.0, MarkerSet(tuple(walk.marker_set.names[i] for i in order)))
    assert_allclose(fill_gaps(mixed).positions, fill_gaps(walk).positions[:, order], atol=1e-9)


def test_place_and_heading_change_nothing():
    walk = _punched(_tumbling(np.random.default_rng(5), wobble=5e-4), (0, 50, 15), (4, 100, 9))
    turn = Rotation.from_rotvec([0.3, -0.2, 1.0]).as_matrix()
    moved = replace(walk, positions=walk.positions @ turn.T + [5.0, -3.0, 1.0])
    assert_allclose(fill_gaps(moved).positions, fill_gaps(walk).positions @ turn.T + [5.0, -3.0, 1.0], atol=1e-9)


@pytest.mark.parametrize("function", [find_gaps, fill_gaps])
def test_joint_walks_are_refused(function):
    skeleton = Skeleton(("Hips",), np.array([-1]), np.zeros((1, 3)))
    with pytest.raises(TypeError, match=r"expected a Walk, got JointWalk.*walk\.to_markers\(\) first"):
        function(JointWalk(np.zeros((9, 1, 3)), np.zeros((9, 3)), skeleton, 120))


@pytest.mark.parametrize("max_gap", [-0.1, np.nan, np.inf])
def test_lengths_must_be_finite(max_gap):
    with pytest.raises(ValueError, match="max_gap must be a finite number of seconds"):
        fill_gaps(make_walkers(1, random_state=0).data[0], max_gap=max_gap)


@pytest.mark.parametrize("n_frames", [1, 5])
def test_short_walks_stay(n_frames):
    walk = _punched(Walk(np.zeros((n_frames, 15, 3)), 120.0, TROJE15), (2, 0, n_frames))
    assert len(find_gaps(fill_gaps(walk))) == 1


def _recorded_errors(walks, seconds, seed):
    """Return the largest error, in mm, in each of two holes a marker, and the share of holes that were filled."""
    rng = np.random.default_rng(seed)
    errors = []
    for walk in walks:
        length = round(seconds * walk.frame_rate)
        for marker in range(len(walk.marker_set.names)):
            for first in rng.integers(3, walk.n_frames - length - 3, size=2):
                filled = fill_gaps(_punched(walk, (marker, first, length)))
                errors.append(1e3 * _error(walk, filled))
    return np.array(errors)


def test_holes_in_recorded_joints(data_dir):
    """Joint centers, of which few are on rigid bodies: largest error in 0.1 s, median 1.5 and 3.8 mm."""
    bandai = read_walks(sorted((data_dir / "bandai2").glob("*.bvh"))[::40])
    cmu = read_walks(sorted((data_dir / "cmu_bvh").glob("*.bvh"))[4:8], unit=0.0564)
    for walks, median in ((bandai, 3.0), (cmu, 5.0)):  # mm
        errors = _recorded_errors([walk.to_markers() for walk in walks], 0.1, seed=0)
        assert np.median(errors) < median
        assert np.quantile(errors, 0.9) < 15


@pytest.mark.parametrize(("seconds", "median"), [(0.1, 2.0), (0.2, 3.0)])
def test_holes_in_recorded_clusters(data_dir, seconds, median):
    """Markers on the skin, most of them in rigid clusters: largest error in a hole, median 1.6 and 2.7 mm."""
    walks = read_walks(sorted((data_dir / "horst_c3d").glob("*Gait.c3d"))[:1])
    errors = _recorded_errors(walks, seconds, seed=0)
    assert np.median(errors) < median
