"""A walk in the mirror, walks that are their own mirror image, and how far a walk is from it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import WalkError, prepare
from eigenwalker.motion import (
    TROJE15,
    Event,
    JointWalk,
    MarkerSet,
    Skeleton,
    Walk,
    asymmetry_index,
    evaluate_harmonics,
    heel_strikes,
    mirror_walk,
    shift_phase,
    stride_frequency,
    symmetrize_walk,
)
from tests.recorded import bandai_walks
from tests.synthetic import body_coefficients, make_walk

RATES = [30.0, 60.0, 120.0]


def _mirror_rows(coefficients):
    """Return the coefficients of the mirror image half a stride later, written out."""
    later = shift_phase(coefficients, np.pi).reshape(len(coefficients), 15, 3)
    return (later[:, TROJE15.mirror] * [1.0, -1.0, 1.0]).reshape(coefficients.shape)


def _symmetric_rows(seed, n_harmonics=2):
    coefficients = body_coefficients(np.random.default_rng(seed), n_harmonics)
    return (coefficients + _mirror_rows(coefficients)) / 2


def _walk(rows, *, n_cycles=4.0, frame_rate=120.0, frequency=0.93, phase=0.4, **fields):
    times = np.arange(round(n_cycles * frame_rate / frequency)) / frame_rate
    channels = evaluate_harmonics(shift_phase(rows, phase), frequency, times)
    return Walk(channels.reshape(len(times), 15, 3), frame_rate, name="anna", **fields)


def _limping(limp, **options):
    """Return a symmetric walk whose left leg and right arm swing less, by a share."""
    rows = _symmetric_rows(0).reshape(5, 15, 3)
    weak = [TROJE15.index(name) for name in ("left_knee", "left_ankle", "right_elbow", "right_wrist")]
    rows[1:, weak] *= 1 - limp
    return _walk(rows.reshape(5, -1), **options)


def test_mirror_twice_is_the_walk():
    walk, _ = make_walk(np.random.default_rng(0), speed=1.2, frequency=0.93)
    events = (Event(0.2, "heel_strike", "left"), Event(0.4, "turn"), Event(0.7, "heel_strike", "right"))
    walk = replace(walk, events=events)
    mirrored = mirror_walk(walk)
    assert_array_equal(mirror_walk(mirrored).positions, walk.positions)
    assert mirror_walk(mirrored).events == events
    assert [event.side for event in mirrored.events] == ["right", "", "left"]
    assert mirrored.speed == 1.2
    assert_array_equal(mirrored.marker("left_knee"), walk.marker("right_knee") * [1.0, -1.0, 1.0])


@given(
    seed=st.integers(0, 1000),
    n_cycles=st.floats(1.5, 5.0),
    frame_rate=st.sampled_from(RATES),
    phase=st.floats(0.0, 6.3),
)
@settings(max_examples=40)
def test_symmetric_walks_stay(seed, n_cycles, frame_rate, phase):
    walk = _walk(_symmetric_rows(seed), n_cycles=n_cycles, frame_rate=frame_rate, phase=phase)
    assert_allclose(symmetrize_walk(walk).positions, walk.positions, atol=1e-6)


@given(
    seed=st.integers(0, 1000),
    n_cycles=st.floats(1.5, 5.0),
    frame_rate=st.sampled_from(RATES),
    aside=st.floats(-3.0, 3.0),
)
@settings(max_examples=40)
def test_walks_become_symmetric(seed, n_cycles, frame_rate, aside):
    """The symmetric part of the coefficients, once and for all, wherever the walker stands."""
    coefficients = body_coefficients(np.random.default_rng(seed))
    coefficients[0, 1::3] -= coefficients[0, 3 * TROJE15.index("pelvis") + 1]  # the mirror is at y = 0
    moved, rows = coefficients.copy(), (coefficients + _mirror_rows(coefficients)) / 2
    moved[0, 1::3] += aside
    rows[0, 1::3] += aside
    walk, wanted = (_walk(c, n_cycles=n_cycles, frame_rate=frame_rate) for c in (moved, rows))
    symmetric = symmetrize_walk(walk)
    assert_allclose(symmetric.positions, wanted.positions, atol=1e-6)
    assert_allclose(symmetrize_walk(symmetric).positions, symmetric.positions, atol=1e-6)
    posture, motion, _ = asymmetry_index(symmetric)
    assert posture < 1e-6
    assert motion < 1e-9


def test_the_mirror_image_is_half_a_stride_away():
    """60 frames are half a stride: no value lies between frames."""
    walk, _ = make_walk(np.random.default_rng(1), frequency=1.0, n_cycles=4.5)
    symmetric = symmetrize_walk(walk)
    pelvis = symmetric.marker("pelvis")[:120, 1].mean()
    there = mirror_walk(symmetric).positions + np.array([0.0, 2 * pelvis, 0.0])
    assert_allclose(there[60:], symmetric.positions[:-60], atol=1e-9)


def test_strikes_of_the_two_feet_come_to_lie_half_a_stride_apart():
    walk, _ = make_walk(np.random.default_rng(2), frequency=1.0, n_cycles=6)
    apart = [
        np.diff(np.sort(np.concatenate([heel_strikes(w, side) for side in ("left", "right")])))[2:-2]
        for w in (walk, symmetrize_walk(walk))
    ]
    assert np.ptp(apart[0]) > 0.02
    assert np.ptp(apart[1]) < 2e-3


def test_nothing_jumps():
    """Strides that differ from each other are faded into each other: noise apart, the motion stays smooth."""
    walk, _ = make_walk(np.random.default_rng(3), n_cycles=4)
    growing = 1 + 0.3 * np.linspace(0.0, 1.0, walk.n_frames)[:, np.newaxis, np.newaxis]
    walk = replace(walk, positions=walk.positions * growing)
    bend = [np.abs(np.diff(w.positions, n=2, axis=0)).max() for w in (walk, symmetrize_walk(walk))]
    assert bend[1] < 1.3 * bend[0]


@pytest.mark.parametrize("n_missing", [0, 1, 2])
def test_one_stride_is_enough(n_missing):
    """From strike to strike there are n frames, and the last one of the stride is one short of it, or two or three."""
    walk = _walk(_symmetric_rows(4), frequency=1.0, n_cycles=1.0)
    walk = replace(walk, positions=walk.positions[: walk.n_frames - n_missing], frequency=1.0)
    assert_allclose(symmetrize_walk(walk).positions, walk.positions, atol=1e-6)


def test_noise_of_one_stride_is_not_blown_up():
    rng = np.random.default_rng(5)
    walk = _walk(_symmetric_rows(5), frequency=1.0, n_cycles=1.0)
    noise = 0.002 * rng.normal(size=walk.positions.shape)
    known = replace(walk, frequency=1.0)
    rest = symmetrize_walk(replace(known, positions=walk.positions + noise)).positions - walk.positions
    assert np.abs(rest).max() < 1.5 * np.abs(noise).max()


def test_the_known_frequency_is_used():
    walk, _ = make_walk(np.random.default_rng(6), frequency=1.0, n_cycles=2)
    assert_allclose(symmetrize_walk(replace(walk, frequency=1.0)).positions, symmetrize_walk(walk).positions, atol=1e-6)
    known = symmetrize_walk(replace(walk, frequency=0.8))
    assert known.frequency == 0.8
    assert np.abs(known.positions - symmetrize_walk(walk).positions).max() > 1e-2


def test_events_are_left_out_and_all_else_kept():
    fields = {"name": "anna", "speed": 1.2, "size": 1.7}
    walk = replace(make_walk(np.random.default_rng(7))[0], events=(Event(0.2, "heel_strike", "left"),), **fields)
    before = walk.positions.copy()
    symmetric = symmetrize_walk(walk)
    assert {name: getattr(symmetric, name) for name in fields} == fields
    assert symmetric.events == ()
    assert np.isnan(symmetric.frequency)
    assert symmetric.n_frames == walk.n_frames
    assert_array_equal(walk.positions, before)


def test_limping_is_counted():
    found = [asymmetry_index(_limping(limp)) for limp in (0.0, 0.1, 0.2, 0.4, 0.8)]
    motions = [index.motion for index in found]
    assert motions[0] < 1e-12
    assert (np.diff(motions) > 0).all()
    assert motions[-1] < 1
    markers = found[2].markers["motion"]
    assert_allclose(markers["left_ankle"], markers["right_ankle"])
    assert markers["left_ankle"] > 1e-3
    assert markers["left_hip"] < 1e-12


def test_index_by_hand():
    """One sine on either side: left a, right -b, half a stride apart; antisymmetric is (a - b) / 2 of each."""
    names = MarkerSet(("left_ankle", "right_ankle", "pelvis"))
    times = np.arange(360) / 120
    wave = np.cos(2 * np.pi * times)
    positions = np.zeros((360, 3, 3))
    positions[:, 0, 0], positions[:, 1, 0] = 0.3 * wave, -0.2 * wave
    positions[:, 0, 2], positions[:, 1, 1] = 0.1, -0.2
    posture, motion, markers = asymmetry_index(Walk(positions, 120.0, names), n_harmonics=1)
    assert_allclose(motion, 2 * 0.05**2 / (0.3**2 + 0.2**2))
    half = np.hypot(0.05, 0.1)  # 0.1 m between the heights of the feet, 0.2 m between their distances from the middle
    assert_allclose(posture, np.sqrt(2 / 3) * half)
    assert_allclose(markers["posture"], [half, half, 0.0], atol=1e-12)
    assert_allclose(markers["motion"][:2], motion)
    assert np.isnan(markers["motion"]["pelvis"])


@given(seed=st.integers(0, 1000), phase=st.floats(0.0, 6.3), aside=st.floats(-3.0, 3.0), n_harmonics=st.integers(1, 4))
@settings(max_examples=30)
def test_index_is_that_of_the_mirror_image_anywhere(seed, phase, aside, n_harmonics):
    rows = body_coefficients(np.random.default_rng(seed), 4)
    walk = _walk(rows, n_cycles=4, frequency=1.0)
    other = _walk(rows, n_cycles=4, frequency=1.0, phase=phase)
    other = mirror_walk(replace(other, positions=other.positions + np.array([1.0, aside, 0.2])))
    one, two = (asymmetry_index(w, n_harmonics=n_harmonics) for w in (walk, other))
    assert_allclose(two.posture, one.posture, atol=1e-8)
    assert_allclose(two.motion, one.motion, atol=1e-8)
    swapped = [TROJE15.names[i] for i in TROJE15.mirror]
    assert_allclose(two.markers.loc[swapped].to_numpy(), one.markers.to_numpy(), atol=1e-7)


FUNCTIONS = [symmetrize_walk, asymmetry_index]


@pytest.mark.parametrize("function", [mirror_walk, *FUNCTIONS])
def test_joint_walks_are_refused(function):
    skeleton = Skeleton(("Hips",), np.array([-1]), np.zeros((1, 3)))
    with pytest.raises(TypeError, match=r"expected a Walk, got JointWalk.*walk\.to_markers\(\) first"):
        function(JointWalk(np.zeros((9, 1, 3)), np.zeros((9, 3)), skeleton, 120))


@pytest.mark.parametrize("function", FUNCTIONS)
def test_walks_without_a_mirror_are_refused(function):
    walk, _ = make_walk(np.random.default_rng(8), name="anna")
    travelled = 1.3 * np.arange(walk.n_frames)[:, np.newaxis, np.newaxis] / 120 * [1.0, 0.0, 0.0]
    with pytest.raises(
        WalkError, match=r"'anna': expected a walk in place, got one that travels at 1\.\d m/s; prepare"
    ):
        function(replace(walk, positions=walk.positions + travelled))
    with pytest.raises(WalkError, match=r"'anna'.*fill the gaps"):
        function(replace(walk, positions=np.where(walk.positions > 1.6, np.nan, walk.positions)))
    with pytest.raises(WalkError, match=r"'anna'.*(at least one stride|periodic part)"):
        function(replace(walk, positions=walk.positions[:90]))
    ankles = MarkerSet(("left_ankle", "right_ankle"))
    legs = replace(walk, positions=walk.positions[:, [TROJE15.index(name) for name in ankles.names]], marker_set=ankles)
    with pytest.raises(
        WalkError, match="'anna': the mirror stands at the marker pelvis; it has left_ankle, right_ankle"
    ):
        function(legs)


def test_one_sided_markers_have_no_mirror_image():
    walk = Walk(np.zeros((9, 2, 3)), 120.0, MarkerSet(("pelvis", "left_hip")))
    with pytest.raises(ValueError, match="without a partner on the other side: left_hip"):
        mirror_walk(walk)


def test_recorded_walks_lose_their_asymmetry(data_dir):
    """What is left, a median of 3 % of its power, comes from strides that differ from each other."""
    walks = bandai_walks(data_dir)[1][::25]
    for walk in walks:
        symmetric = symmetrize_walk(walk)
        before, after = asymmetry_index(walk), asymmetry_index(symmetric)
        assert after.motion < 0.25 * before.motion, walk.name
        assert after.posture < 0.25 * before.posture, walk.name
        assert_allclose(stride_frequency(symmetric), stride_frequency(walk), rtol=2e-3)
        assert prepare(symmetric).n_frames == walk.n_frames
