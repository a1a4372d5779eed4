"""Smoothing without delay, and other frame rates without a difference."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

from eigenwalker import WalkError, prepare, read_walks
from eigenwalker.model import FourierLinearizer
from eigenwalker.motion import Event, JointWalk, MarkerSet, Skeleton, Walk, low_pass, resample, stride_frequency
from tests.synthetic import make_walk

RATES = [30.0, 60.0, 120.0]


def _wave(frequency, *, frame_rate=120.0, duration=20.0):
    times = np.arange(round(duration * frame_rate)) / frame_rate
    wave = np.cos(2 * np.pi * frequency * times[:, np.newaxis, np.newaxis] + np.arange(3))
    return Walk(wave, frame_rate, MarkerSet(("heel",)), "anna")


def _joint_walk(rng, n_frames=240, frame_rate=60.0):
    """Return smooth joint rotations; those of the first joint pass half a turn and so leap as exponential maps."""
    times = np.arange(n_frames) / frame_rate
    swing = 0.3 * np.sin(2 * np.pi * times[:, np.newaxis, np.newaxis] + rng.normal(size=(3, 3)))
    swing[:, 0, 2] += np.pi
    rotations = Rotation.from_rotvec(swing.reshape(-1, 3)).as_rotvec().reshape(swing.shape)
    skeleton = Skeleton(("Hips", "LeftUpLeg", "RightUpLeg"), np.array([-1, 0, 0]), np.zeros((3, 3)))
    moving = {"LeftUpLeg": 0.1 * np.cos(2 * np.pi * times)[:, np.newaxis] * [1.0, 2.0, 3.0]}
    root = np.column_stack((1.3 * times, 0.02 * np.sin(6 * times), 0.9 + 0 * times))
    events = (Event(0.5, "heel_strike", "left"),)
    fields = {"translations": moving, "events": events, "frequency": 1.0, "speed": 1.3}
    return JointWalk(rotations, root, skeleton, frame_rate, "anna", **fields)


def _travelling(seed, frame_rate, n_cycles=6.0):
    walk, _ = make_walk(np.random.default_rng(seed), n_cycles=n_cycles, frame_rate=frame_rate, name="anna")
    times = np.arange(walk.n_frames) / frame_rate
    return replace(walk, positions=walk.positions + np.outer(times, [1.3, 0.1, 0.0])[:, np.newaxis])


def _features(walk):
    return FourierLinearizer().fit_transform([walk])


@given(cutoff=st.floats(2.0, 14.0), order=st.sampled_from([2, 4, 6, 8]), ratio=st.floats(0.3, 1.8))
@settings(max_examples=40)
def test_gain_is_that_of_the_formula(cutoff, order, ratio):
    """1 / sqrt(2) at the cutoff after both passes, whatever the order and the frame rate."""
    for frequency in (cutoff, ratio * cutoff):
        frame_rate = 3.7 * max(cutoff, frequency)
        walk = _wave(frequency, frame_rate=frame_rate, duration=40 / cutoff)
        inside = slice(walk.n_frames // 3, -walk.n_frames // 3)
        filtered = low_pass(walk, cutoff=cutoff, order=order)
        tangents = np.tan(np.pi * np.array([frequency, cutoff]) / frame_rate)
        gain = 1 / (1 + (np.sqrt(2) - 1) * (tangents[0] / tangents[1]) ** order)
        # In phase as well: forward and backward have no delay.
        assert_allclose(filtered.positions[inside], gain * walk.positions[inside], atol=1e-3)
        if frequency == cutoff:
            assert_allclose(gain, 1 / np.sqrt(2))


@pytest.mark.parametrize("frame_rate", RATES)
def test_walking_passes(frame_rate):
    """Harmonics of 0.93 and 1.86 Hz lose less than a percent; at the ends the body bends off by some 2 mm."""
    walk, _ = make_walk(np.random.default_rng(0), frame_rate=frame_rate)
    change = np.abs(low_pass(walk).positions - walk.positions).max(axis=(1, 2))
    edge = round(0.2 * frame_rate)
    assert change[edge:-edge].max() < 5e-4
    assert change.max() < 3e-3
    assert change[[0, -1]].max() < 1e-3


def test_straight_lines_pass_untouched():
    """Walking over the floor at a steady speed is no motion to be smoothed."""
    line = np.linspace(0.0, 4.0, 300)[:, np.newaxis, np.newaxis] * [1.0, -0.5, 0.0] + [3.0, 2.0, 1.0]
    walk = Walk(line, 100.0, MarkerSet(("heel",)))
    assert_allclose(low_pass(walk).positions, line, atol=1e-8)


def test_noise_is_reduced_to_the_share_of_the_band():
    rng = np.random.default_rng(0)
    walk, _ = make_walk(rng)
    noise = 0.01 * rng.normal(size=walk.positions.shape)
    rest = low_pass(replace(walk, positions=walk.positions + noise)).positions - low_pass(walk).positions
    assert_allclose(rest.std() / noise.std(), np.sqrt(6 / 60), rtol=0.1)


def test_nothing_comes_later():
    rng = np.random.default_rng(1)
    walk, _ = make_walk(rng)
    noisy = replace(walk, positions=walk.positions + 0.01 * rng.normal(size=walk.positions.shape))
    before, after = (
        w.marker("left_ankle")[:, 0] - w.marker("left_ankle")[:, 0].mean() for w in (walk, low_pass(noisy))
    )
    lags = np.correlate(after, before, mode="full")
    assert np.argmax(lags) == walk.n_frames - 1


def test_turning_and_smoothing_commute():
    walk, _ = make_walk(np.random.default_rng(2), noise=0.005)
    turn = Rotation.from_rotvec([0.2, -0.4, 1.1]).as_matrix()
    turned = replace(walk, positions=walk.positions @ turn.T + [4.0, 2.0, 0.0])
    assert_allclose(low_pass(turned).positions, low_pass(walk).positions @ turn.T + [4.0, 2.0, 0.0], atol=1e-10)


def test_time_runs_either_way():
    """Forward first or backward first makes no difference inside, and the ends are treated alike."""
    walk, _ = make_walk(np.random.default_rng(3), noise=0.005)
    reverse = replace(walk, positions=walk.positions[::-1])
    assert_allclose(low_pass(reverse).positions[::-1], low_pass(walk).positions, atol=1e-4)


@pytest.mark.parametrize("old", RATES)
@pytest.mark.parametrize("new", [*RATES, 240.0, 100.0, 29.97])
def test_frames_lie_on_the_same_walk(old, new):
    """Two harmonics of 20 mm and more: to a hundredth of a millimetre, even at the ends and with 30 frames a second."""
    walk, truth = (make_walk(np.random.default_rng(4), n_cycles=4, frame_rate=rate)[0] for rate in (old, new))
    moved = resample(walk, frame_rate=new)
    n_frames = min(moved.n_frames, truth.n_frames)
    assert_allclose(moved.positions[:n_frames], truth.positions[:n_frames], atol=1e-5)
    assert moved.frame_rate == new
    last = (moved.n_frames - 1) / new
    assert last <= (walk.n_frames - 1) / old + 1e-9
    assert last + 1 / new > (walk.n_frames - 1) / old - 1e-9


@pytest.mark.parametrize("old", RATES)
@pytest.mark.parametrize("new", RATES)
def test_features_do_not_see_the_frame_rate(old, new):
    walk = _travelling(5, old)
    assert_allclose(_features(prepare(resample(walk, frame_rate=new))), _features(prepare(walk)), atol=1e-6)
    still, _ = make_walk(np.random.default_rng(5), n_cycles=6, frame_rate=old)
    assert_allclose(_features(resample(still, frame_rate=new)), _features(still), atol=1e-6)


@given(seed=st.integers(0, 1000), ratio=st.integers(2, 5), n_frames=st.integers(6, 70))
@settings(max_examples=40)
def test_up_and_down_gives_the_walk_back(seed, ratio, n_frames):
    """Of any walk, noise too: the spline upward is among those of which the nearest is taken downward."""
    rng = np.random.default_rng(seed)
    walk = Walk(rng.normal(size=(n_frames, 2, 3)), 24.0, MarkerSet(("heel", "toe")))
    back = resample(resample(walk, frame_rate=24.0 * ratio), frame_rate=24.0)
    assert_allclose(back.positions, walk.positions, atol=1e-9)


@pytest.mark.parametrize(("old", "new"), [(120, 119), (120, 100), (120, 60), (120, 59.94), (120, 30), (30, 29)])
def test_noise_stays_in_the_new_band(old, new):
    """A projection makes nothing larger: the share of the noise that is left is that of the frame rates."""
    noise = np.random.default_rng(6).normal(size=(20 * old, 10, 3))
    walk = Walk(noise, old, MarkerSet(tuple("abcdefghij")))
    assert_allclose(resample(walk, frame_rate=new).positions.std(), np.sqrt(new / old), rtol=0.08)


@pytest.mark.parametrize("frequency", [22.0, 29.0, 40.0, 59.0])
def test_fast_motion_does_not_come_back_as_slow(frequency):
    """Every fourth frame would hold the whole amplitude of a wave that is not there."""
    inside = slice(50, -50)
    assert np.abs(resample(_wave(frequency), frame_rate=30.0).positions[inside]).max() < 0.02


def test_noise_reduction_keeps_the_stride():
    rng = np.random.default_rng(7)
    walk, _ = make_walk(rng, noise=0.01)
    slow = resample(walk, frame_rate=30.0)
    assert_allclose(stride_frequency(slow), stride_frequency(walk), rtol=1e-3)


def test_the_same_frame_rate_changes_nothing():
    walk, _ = make_walk(np.random.default_rng(8), noise=0.01)
    assert_array_equal(resample(walk, frame_rate=120).positions, walk.positions)


BOTH = [low_pass, lambda walk: resample(walk, frame_rate=45.0), lambda walk: resample(walk, frame_rate=150.0)]
BOTH_NAMES = ["low_pass", "down", "up"]


@pytest.mark.parametrize("change", BOTH, ids=BOTH_NAMES)
def test_all_but_the_motion_stays(change):
    events = (Event(0.41, "heel_strike", "left"), Event(0.9, "toe_off", "right"))
    fields = {"name": "anna", "speed": 1.2, "size": 1.7, "events": events}
    walk = replace(make_walk(np.random.default_rng(9), n_cycles=2)[0], frequency=0.93, **fields)
    before = walk.positions.copy()
    changed = change(walk)
    assert {name: getattr(changed, name) for name in fields} == fields
    assert changed.frequency == 0.93
    assert changed.marker_set == walk.marker_set
    assert_array_equal(walk.positions, before)


@pytest.mark.parametrize("change", BOTH, ids=BOTH_NAMES)
def test_joint_walks_do_not_leap(change):
    """The rotations are those of the smooth walk, root and moving joints too; only low_pass takes a little off."""
    walk = _joint_walk(np.random.default_rng(10))
    assert np.abs(np.diff(walk.rotations, axis=0)).max() > 3  # exponential maps leap at half a turn
    changed = change(walk)
    times = np.arange(changed.n_frames) / changed.frame_rate
    smooth = _joint_walk(np.random.default_rng(10), changed.n_frames, changed.frame_rate)
    got, wanted = (Rotation.from_rotvec(w.rotations.reshape(-1, 3).copy()) for w in (changed, smooth))
    angles = (got.inv() * wanted).magnitude().reshape(changed.n_frames, -1)
    atol = 0.02 if change is low_pass else 1e-4
    assert angles.max() < atol
    assert_allclose(changed.root, smooth.root, atol=atol)
    assert_allclose(changed.translations["LeftUpLeg"], smooth.translations["LeftUpLeg"], atol=atol)
    assert (changed.events, changed.frequency, changed.speed) == (walk.events, 1.0, 1.3)
    assert times[-1] <= 239 / 60 + 1e-9


@pytest.mark.parametrize("change", BOTH, ids=BOTH_NAMES)
def test_gaps_are_refused(change):
    walk, _ = make_walk(np.random.default_rng(11), name="anna")
    positions = walk.positions.copy()
    positions[7, 3] = np.nan
    with pytest.raises(WalkError, match=r"'anna'.*3 NaN.*left_elbow_x.*fill the gaps"):
        change(replace(walk, positions=positions))
    joints = _joint_walk(np.random.default_rng(11))
    root = joints.root.copy()
    root[3, 2] = np.nan
    with pytest.raises(WalkError, match=r"'anna'.*1 NaN.*root position z"):
        change(replace(joints, root=root))
    with pytest.raises(TypeError, match="expected a Walk or a JointWalk, got ndarray"):
        change(positions)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cutoff": 15.0}, r"cutoff must lie between 0 and half the frame rate, 15 Hz, got 15.0"),
        ({"cutoff": 0.0}, "cutoff must lie between 0"),
        ({"cutoff": np.nan}, "cutoff must lie between 0"),
        ({"order": 3}, "order must be an even whole number.*got 3"),
        ({"order": 0}, "order must be an even whole number.*got 0"),
        ({"order": 2.5}, "order must be an even whole number.*got 2.5"),
    ],
)
def test_filters_that_do_not_exist_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        low_pass(_wave(1.0, frame_rate=30.0), **options)


def test_short_walks_are_refused_or_handled():
    walk = _wave(1.0)
    with pytest.raises(WalkError, match=r"'anna': expected at least one cycle of the cutoff, 0.167 s, got 0.158 s"):
        low_pass(replace(walk, positions=walk.positions[:19]))
    assert np.isfinite(low_pass(replace(walk, positions=walk.positions[:20])).positions).all()
    with pytest.raises(WalkError, match=r"at least 6 frames before and after, got 5 at 120 and 9 at 240"):
        resample(replace(walk, positions=walk.positions[:5]), frame_rate=240.0)
    with pytest.raises(WalkError, match=r"at least 6 frames before and after, got 20 at 120 and 5 at 30"):
        resample(replace(walk, positions=walk.positions[:20]), frame_rate=30.0)
    assert resample(replace(walk, positions=walk.positions[:21]), frame_rate=30.0).n_frames == 6


@pytest.mark.parametrize(("frame_rate", "error"), [(0.0, ValueError), (np.nan, ValueError), ("fast", TypeError)])
def test_frame_rates_must_be_positive(frame_rate, error):
    with pytest.raises(error, match="frame_rate must be"):
        resample(_wave(1.0), frame_rate=frame_rate)


def test_recorded_strides_keep_their_length(data_dir):
    """Bandai's walks, smoothed and at twice and five sixths of their frame rate."""
    for walk in read_walks(sorted((data_dir / "bandai2").glob("*.bvh"))[::60]):
        smooth = low_pass(walk)
        wanted = stride_frequency(prepare(walk, clip="whole"))
        for frame_rate in (60.0, 25.0):
            changed = prepare(resample(smooth, frame_rate=frame_rate), clip="whole")
            assert_allclose(stride_frequency(changed), wanted, rtol=1e-3, err_msg=walk.name)
