"""Walks of any length and frame rate from harmonics."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import WalkError, read_walk, write_walk
from eigenwalker.motion import StrideVariation, plant_feet, quality_table, sole_points, synthesize
from tests.joint_bodies import apart
from tests.planted import standing_walk
from tests.scissors import walker

ANGLE = 0.3


def _apart_over_time(one, other, every, others):
    """Return how far joints are apart at most in every so manyth frame of one walk and of another."""
    return np.abs(one.joint_positions()[::every] - other.joint_positions()[::others]).max()


def test_three_harmonics_of_three_harmonics_are_all_of_them():
    """A walk that is its own series is planted as it is, but for the ends, where synthesis knows what comes."""
    first = synthesize(walker(), duration=8)
    again = synthesize(replace(first, frequency=np.nan), duration=4, hold=False)
    free = synthesize(walker(), duration=4, hold=False)
    assert apart(again, free) < 0.1  # the reach of the legs is left out of the series
    bare = synthesize(walker(), duration=8, hold=False, travel=False)
    plain, ours = plant_feet(bare, hold=False), synthesize(bare, duration=8, hold=False)
    assert_allclose(ours.rotations, bare.rotations, atol=1e-6)
    inside = slice(70, -70)
    assert_allclose(np.diff(ours.root, axis=0)[inside], np.diff(plain.root, axis=0)[inside], atol=1e-4)


def test_feet_stand():
    row = quality_table([synthesize(walker())]).iloc[0]
    assert row.duration_s == 10
    assert row.n_steps >= 16
    assert row.worst_foot_slip_m_per_step < 1e-3
    assert row.foot_above_ground_m < 1e-3
    assert row.root_jump_m_per_s < 0.4
    assert row.bone_length_variation_m < 1e-12


@pytest.mark.parametrize("duration", [None, 3.0, 0.2])
def test_a_loop_ends_as_it_starts(duration):
    walk = synthesize(walker(), loop=True, duration=duration)
    n_strides = 1 if duration is None else max(1, round(duration * 0.9))
    assert walk.n_frames == n_strides * 67 + 1  # 66.7 frames a stride, rounded
    assert_allclose(walk.frequency, 60 / 67)
    assert (walk.rotations[-1] == walk.rotations[0]).all()
    assert walk.root[-1, 2] == walk.root[0, 2]
    # The frame before the last one is one frame before the first: what comes next is as smooth as what was.
    round_again = np.concatenate((walk.rotations[:-1], walk.rotations[1:]))
    seam = np.abs(np.diff(round_again, 2, axis=0))[walk.n_frames - 4 : walk.n_frames]
    within = np.abs(np.diff(walk.rotations, 2, axis=0))
    assert seam.max() <= within.max()


def test_a_loop_goes_on_by_the_same_displacement():
    """Two strides in a row are the stride twice, the second one further on."""
    one, two = (synthesize(walker(), loop=True, heading=ANGLE, duration=duration) for duration in (1.0, 2.2))
    step = one.root[-1] - one.root[0]
    assert_allclose(step[2], 0.0)
    assert_allclose(two.root[67:], one.root + step, atol=1e-9)
    assert_allclose(two.rotations[:68], one.rotations, atol=1e-9)
    assert_allclose(step[:2] / np.hypot(*step[:2]), [np.cos(ANGLE), np.sin(ANGLE)], atol=0.02)


def test_a_loop_in_place_closes():
    walk = synthesize(walker(), loop=True, travel=False)
    assert_allclose(walk.root[-1], walk.root[0], atol=1e-12)
    travelling = synthesize(walker(), loop=True)
    step = travelling.root[-1] - travelling.root[0]
    assert_allclose(walk.speed, np.hypot(*step[:2]) * 60 / 67)
    assert_allclose(walk.rotations, travelling.rotations)


@pytest.mark.parametrize("loop", [False, True])
def test_a_walk_keeps_its_speed_where_it_is_known(loop):
    plain = synthesize(walker(), travel=False, loop=loop, duration=4)
    wanted = 1.02 * plain.speed
    known = replace(walker(), speed=wanted)
    still_there, going = (synthesize(known, travel=travel, loop=loop, duration=4) for travel in (False, True))
    assert_allclose(still_there.speed, wanted, rtol=1e-4)
    assert_allclose(still_there.rotations, going.rotations)
    assert np.isnan(going.speed)
    there = synthesize(known, speed=0.99 * plain.speed, travel=False, loop=loop, duration=4)
    assert_allclose(there.speed, 0.99 * plain.speed, rtol=1e-4)
    if loop:
        assert (going.rotations[-1] == going.rotations[0]).all()
        assert_allclose(still_there.root[-1], still_there.root[0], atol=1e-12)
    row = quality_table([synthesize(known)]).iloc[0]
    assert row.worst_foot_slip_m_per_step < 1e-3
    assert_allclose(row.speed_m_per_s, wanted, rtol=2e-3)


def test_bodies_of_another_size_have_their_speed_in_metres():
    plain, other = (synthesize(replace(walker(), size=size), travel=False) for size in (1.0, 1.25))
    assert_allclose(other.speed, 1.25 * plain.speed)
    assert_allclose(other.root, plain.root)


@pytest.mark.parametrize("frame_rate", [24, 30, 120, 240])
def test_frame_rates_agree_at_common_times(frame_rate):
    """Poses within what a frame of 24 a second may differ in time; paths, over 4 s, by less than 2 %."""
    walk, other = (synthesize(walker(), duration=4, frame_rate=rate) for rate in (60, frame_rate))
    common = np.gcd(60, frame_rate)
    one, two = 60 // common, frame_rate // common
    assert other.n_frames == 4 * frame_rate
    limit = 0.06 if frame_rate < 60 else 0.03
    assert np.abs(walk.rotations[::one] - other.rotations[::two]).max() < 2 * limit
    assert np.abs(walk.root[::one] - other.root[::two]).max() < limit
    frames = np.arange(other.n_frames)
    assert np.abs(np.diff(other.root[:, 2])).max() * frame_rate < 1.0
    assert len(frames) == other.n_frames


def test_lists_come_back_as_lists_whatever_the_threads():
    walks = [walker(200, frequency=0.8 + 0.1 * number, name=f"walk {number}") for number in range(4)]
    made = synthesize(walks, duration=1)
    assert [walk.name for walk in made] == [walk.name for walk in walks]
    parallel = synthesize(walks, duration=1, n_jobs=2)
    alone = [synthesize(walk, duration=1) for walk in walks]
    for one, other, third in zip(made, parallel, alone, strict=True):
        assert apart(one, other) == apart(one, third) == 0
    assert isinstance(synthesize(walks[:1], duration=1), list)
    with pytest.raises(ValueError, match="at least one"):
        synthesize([])


def _variation(seed=0):
    """Return strides that differ by a degree, and by 2 % in time."""
    rng = np.random.default_rng(seed)
    names = walker(3).channel_names
    deviations = 0.01 * rng.normal(size=(6, 7 * len(names) + 1))
    deviations[:, :-1] *= np.abs(rng.normal(size=7 * len(names))) < 1
    return StrideVariation(deviations, 0.2, names)


def test_variation_is_that_of_its_seed():
    options = {"duration": 5, "variation": _variation()}
    one, same, other = (synthesize(walker(), **options, random_state=seed) for seed in (1, 1, 2))
    plain = synthesize(walker(), duration=5)
    assert apart(one, same) == 0
    assert apart(one, other) > 1e-3
    assert 1e-3 < np.abs(one.rotations - plain.rotations).max() < 1.0
    row = quality_table([one]).iloc[0]
    assert row.worst_foot_slip_m_per_step < 1e-3
    assert row.root_jump_m_per_s < 0.6
    pair = synthesize([walker(), walker()], **options, random_state=1)
    assert apart(*pair) > 1e-3  # each walk has its own numbers


def test_no_variation_in_the_variation_is_none():
    still = replace(_variation(), deviations=np.zeros((2, _variation().deviations.shape[1])))
    varied = synthesize(walker(start=0.3), duration=3, variation=still)
    assert_allclose(varied.rotations, synthesize(walker(start=0.3), duration=3).rotations, atol=1e-6)


def test_duration_and_frame_rate_make_the_number_of_frames():
    for duration, rate, n_frames in ((None, 60, 600), (0.5, 30, 15), (1e-9, 60, 1), (1.0, 29.97, 30)):
        walk = synthesize(walker(), duration=duration, frame_rate=rate)
        assert (walk.n_frames, walk.frame_rate) == (n_frames, rate)


def test_the_file_has_the_same_places(tmp_path):
    walk = synthesize(walker(), duration=2, curvature=0.2)
    write_walk(walk, tmp_path / "walk.bvh")
    read = read_walk(tmp_path / "walk.bvh")
    order = [read.skeleton.index(name) for name in walk.skeleton.joint_names]  # files have them limb by limb
    assert_allclose(read.joint_positions()[:, order], walk.joint_positions(), atol=1e-6)
    assert_allclose(sole_points(read), sole_points(walk), atol=1e-5)


def test_where_in_its_stride_a_walk_starts_does_not_matter():
    """A walk of three harmonics from its 10th frame on is the same walk 10 frames later."""
    long = synthesize(walker(), duration=7, travel=False, hold=False)
    long = replace(long, frequency=np.nan)
    cut = replace(long, rotations=long.rotations[10:], root=long.root[10:])
    first, later = (synthesize(walk, duration=4) for walk in (long, cut))
    assert_allclose(later.rotations[:-10], first.rotations[10:], atol=1e-3)
    start = first.root[10] * [1, 1, 0]
    assert_allclose(later.root[:-10], first.root[10:] - start, atol=1e-3)


def test_longer_walks_start_alike():
    short, long = (synthesize(walker(), duration=duration) for duration in (2, 6))
    assert apart(short, replace(long, rotations=long.rotations[:120], root=long.root[:120])) < 1e-4


def test_options_of_planting_are_those_of_plant_feet():
    straight = synthesize(walker(), duration=3)
    turned = synthesize(walker(), duration=3, heading=np.pi / 2)
    assert_allclose(turned.root[:, 1], straight.root[:, 0], atol=1e-9)
    through = synthesize(walker(), duration=3, path=[[5, 5], [5, 9]])
    assert_allclose(through.root[:, 1], straight.root[:, 0] + 5, atol=1e-9)
    circle = synthesize(walker(), duration=6, curvature=0.5)
    assert_allclose(np.linalg.norm(circle.root[:, :2] - [0, 2], axis=1), 2.0, atol=0.1)
    there = synthesize(walker(), duration=3, travel=False, heading=ANGLE)
    assert_allclose(there.speed, np.ptp(straight.root[:, 0]) / 3, rtol=0.1)
    assert np.abs(there.root[:, :2]).max() < 0.1


def test_frequencies_that_are_known_are_kept():
    known = synthesize(replace(walker(), frequency=0.91), duration=1)
    assert known.frequency == pytest.approx(0.91)
    assert synthesize(walker(), duration=1).frequency == pytest.approx(0.9, abs=1e-3)
    weights = {"LeftUpLeg_y": -1.0, "RightUpLeg_y": 1.0}
    assert apart(synthesize(walker(), phase_reference=weights), synthesize(walker())) == 0


def test_what_cannot_be_made_is_refused():
    walk = walker()
    for duration in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(ValueError, match="duration must be positive and finite, in seconds"):
            synthesize(walk, duration=duration)
    with pytest.raises(ValueError, match="frame_rate must be positive"):
        synthesize(walk, frame_rate=0)
    for wrong in ({"curvature": 0.1}, {"path": [[0, 0], [1, 1]]}, {"variation": _variation()}):
        with pytest.raises(ValueError, match="a loop must be straight and its strides the same"):
            synthesize(walk, loop=True, **wrong)
    with pytest.raises(ValueError, match="travel=False keeps the walk in place"):
        synthesize(walk, travel=False, curvature=0.1)
    with pytest.raises(ValueError, match="n_harmonics must be at least 1"):
        synthesize(walk, n_harmonics=0)
    with pytest.raises(ValueError, match="max_knee must be finite"):
        synthesize(walk, max_knee=-1)
    with pytest.raises(WalkError, match="too weak to carry a phase"):
        synthesize(standing_walk(200))
    with pytest.raises(WalkError, match="expected at least one stride"):
        synthesize(replace(walker(30), frequency=0.9))
    with pytest.raises(TypeError, match="JointWalk"):
        synthesize([walk.to_markers()])
    with pytest.raises(ValueError, match="skeleton must be upright"):
        synthesize(replace(walk, skeleton=replace(walk.skeleton, upright=False)))
