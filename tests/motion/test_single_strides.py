"""Walks cut into their single strides."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import WalkError, make_walkers
from eigenwalker.motion import (
    Event,
    JointWalk,
    Skeleton,
    Walk,
    evaluate_harmonics,
    phase_weights,
    pool_walks,
    shift_phase,
)
from eigenwalker.motion.single_strides import count_strides, split_strides
from tests.synthetic import body_coefficients, make_walk
from tests.varying_strides import make_varying_walk


def _durations(walk):
    """Return the durations of the strides in frames."""
    return np.array([walk.frame_rate / stride.frequency for stride in split_strides(walk)])


def test_strides_of_a_steady_walk_are_equal():
    walk, _ = make_walk(np.random.default_rng(0), n_cycles=5.4, phase=-0.5)
    strides = split_strides(walk)
    assert [stride.name for stride in strides] == [f"_stride{number}" for number in range(1, 6)]
    assert_allclose([stride.frequency for stride in strides], 0.93, rtol=1e-6)
    assert {stride.n_frames for stride in strides} <= {129, 130}  # of 129.03 frames


def test_frames_are_those_from_phase_zero_to_phase_zero():
    walk, zeros = make_varying_walk(np.random.default_rng(1), body_coefficients(np.random.default_rng(2)), time_sd=0.05)
    counts = count_strides(walk.channels, 0.93 / walk.frame_rate, phase_weights(walk))
    whole = np.ceil(counts[0]) + np.arange(len(zeros))
    assert_allclose(np.interp(whole, counts, np.arange(walk.n_frames)), zeros, atol=0.6)  # frames
    joined = np.concatenate([stride.positions for stride in split_strides(walk)])
    start = np.ceil(np.interp(whole[0], counts, np.arange(walk.n_frames))).astype(int)
    assert_array_equal(joined, walk.positions[start : start + len(joined)])


@pytest.mark.parametrize("frame_rate", [30.0, 120.0])
def test_stride_times_are_found_with_their_spread(frame_rate):
    """Neither evened out between neighbors nor blown up by the variation of one ankle."""
    rng, found, true = np.random.default_rng(3), [], []
    for _ in range(20):
        walk, zeros = make_varying_walk(rng, body_coefficients(rng), frame_rate=frame_rate)
        found.append(_durations(walk))
        true.append(np.diff(zeros))
    assert_allclose(np.std(found), np.std(true), rtol=0.05)
    assert np.corrcoef(np.ravel(found), np.ravel(true))[0, 1] > 0.97


def test_cadence_may_drift():
    """By 10 % to both sides: the phase of a steady cadence would be off by more than half a stride."""
    rng = np.random.default_rng(4)
    walk, zeros = make_varying_walk(rng, body_coefficients(rng), n_strides=20, time_sd=0.0, drift=0.1)
    assert_allclose(_durations(walk), np.diff(zeros), rtol=0.015)


def test_noise_makes_steady_strides_hardly_differ():
    rng = np.random.default_rng(5)
    walk, _ = make_varying_walk(rng, body_coefficients(rng), time_sd=0.0, shape_sd=0.0, noise=0.01)
    durations = _durations(walk)
    assert durations.std() < 0.002 * durations.mean()


def test_posture_may_drift():
    rng = np.random.default_rng(6)
    walk, zeros = make_varying_walk(rng, body_coefficients(rng), shape_sd=0.0)
    drift = np.linspace(-0.15, 0.15, walk.n_frames)[:, np.newaxis, np.newaxis] * [1.0, 0.5, 0.0]
    moved = _durations(replace(walk, positions=walk.positions + drift))
    assert_allclose(moved, np.diff(zeros), rtol=0.005)


def test_pooled_walks_come_apart_again():
    walks = make_walkers(6, duration=6, frame_rate=60, random_state=0).data
    pooled = pool_walks(walks, ["anna"] * 3 + ["bert"] * 3)
    for walk in pooled:
        strides = split_strides(walk)
        assert len(strides) == round(walk.duration * walk.frequency)
        assert_allclose([stride.frequency for stride in strides], walk.frequency, rtol=0.05)


@pytest.mark.parametrize(("n_cycles", "phase", "expected"), [(1.5, 0.5, 0), (2.0, 1.0, 1), (3.0, 0.0, 3)])
def test_short_walks(n_cycles, phase, expected):
    """A walk of three strides that starts at phase zero has three, although it lacks the frame that ends them."""
    walk, _ = make_walk(np.random.default_rng(7), n_cycles=n_cycles, phase=phase)
    assert len(split_strides(walk)) == expected


def test_events_stay_with_their_stride():
    rng = np.random.default_rng(8)
    walk, zeros = make_varying_walk(rng, body_coefficients(rng))
    times = (zeros[:-1] + 20) / walk.frame_rate
    marked = replace(walk, events=tuple(Event(time, "heel_strike", "left") for time in times))
    for stride in split_strides(marked):
        (event,) = stride.events
        assert abs(event.time * walk.frame_rate - 20) < 1.5


def test_joint_walks_are_split_with_all_that_they_hold():
    coefficients = np.zeros((5, 9))
    coefficients[2, 3], coefficients[2, 6], coefficients[4, 7] = 0.4, -0.4, 0.1
    times = np.arange(500) / 100
    rotations = evaluate_harmonics(shift_phase(coefficients, 2.0), 1.0, times).reshape(500, 3, 3)
    skeleton = Skeleton(("hips", "left", "right"), [-1, 0, 0], np.zeros((3, 3)))
    root = times[:, np.newaxis] * np.ones(3)
    walk = JointWalk(rotations, root, skeleton, 100.0, "anna", translations={"left": root})
    strides = split_strides(walk, phase_reference={"left_x": 1.0, "right_x": -1.0})
    assert [stride.name for stride in strides] == [f"anna_stride{number}" for number in range(1, 5)]
    for stride in strides:
        assert_allclose(stride.frequency, 1.0, rtol=1e-6)
        assert_array_equal(stride.translations["left"], stride.root)
    assert_allclose(np.diff([stride.root[0, 0] for stride in strides]), 1.0, atol=1e-9)


def test_walks_with_gaps_or_without_strides_are_refused():
    rng = np.random.default_rng(9)
    walk, _ = make_walk(rng, n_cycles=6)
    with_gap = walk.positions.copy()
    with_gap[3, 2] = np.nan
    with pytest.raises(WalkError, match="expected finite values"):
        split_strides(replace(walk, positions=with_gap))
    there = make_walk(rng, n_cycles=3.0)[0].positions
    with pytest.raises(WalkError, match=r"'back': expected strides one after the other, .*; is 2 Hz its stride freq"):
        split_strides(Walk(np.concatenate((there, there[::-1][:60], there)), 120.0, name="back", frequency=2.0))
