"""Drift of the cadence: found, taken out, and left alone where there is none."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from eigenwalker import WalkError, make_walkers, prepare
from eigenwalker.model import FourierLinearizer
from eigenwalker.motion import (
    Event,
    MarkerSet,
    explained_power,
    steady_cadence,
    stride_frequency,
    stride_phase,
    walk_quality,
)
from tests.joint_bodies import swinging
from tests.recorded import bandai_walks, cmu_joints, cmu_walks
from tests.recordings import FREQUENCY, drifting_walk, legendre_drift, over_the_floor
from tests.synthetic import make_walk

NOISE = 0.005  # meters; what is found stays within a few mrad of the truth with it


def _n_frames(n_strides, frame_rate=60.0):
    return round(n_strides * frame_rate / FREQUENCY)


def _line(n_frames):
    return np.linspace(-1.0, 1.0, n_frames)


def _off(found, phase):
    """Return the largest distance of two phases, up to a constant."""
    rest = found - phase
    return (rest.max() - rest.min()) / 2


def _features(*walks):
    return FourierLinearizer().fit_transform(list(walks))


@pytest.mark.parametrize("noise", [0.0, NOISE])
@pytest.mark.parametrize("largest", [0.2, 1.0, 3.0])
@pytest.mark.parametrize("n_strides", [5, 10, 21])
def test_linear_chirps_are_recovered(n_strides, largest, noise):
    """A cadence that rises or falls in proportion to time; by 3 radians it changes by 25 % within five strides."""
    for sign in (-1.0, 1.0):
        drift = sign * largest * _line(_n_frames(n_strides)) ** 2
        walk, phase = drifting_walk(drift, seed=n_strides, noise=noise)
        assert _off(stride_phase(walk).phase, phase) < 0.02


@pytest.mark.parametrize("noise", [0.0, NOISE])
@pytest.mark.parametrize(("n_strides", "largest"), [(14, 0.3), (14, 1.0), (21, 1.0), (21, 3.0), (40, 3.0)])
def test_slow_sines_are_recovered(n_strides, largest, noise):
    """One wave over the walk; the polynomials that 14 strides get follow it to 4 mrad a radian."""
    drift = largest * np.sin(np.pi * _line(_n_frames(n_strides)) + 1.0)
    walk, phase = drifting_walk(drift, seed=n_strides, noise=noise)
    assert _off(stride_phase(walk).phase, phase) < 0.02


@given(
    seed=st.integers(0, 1000),
    n_strides=st.sampled_from([4.4, 6.4, 10.4, 20.4]),
    largest=st.floats(0.0, 1.0),
    n_harmonics=st.sampled_from([2, 4]),
    noise=st.sampled_from([0.0, NOISE]),
)
@settings(max_examples=40)
def test_polynomials_of_as_many_terms_as_there_are_by_default_are_recovered(
    seed, n_strides, largest, n_harmonics, noise
):
    drift = legendre_drift(seed, _n_frames(n_strides), int(n_strides / 2), largest)
    walk, phase = drifting_walk(drift, seed=seed, n_harmonics=n_harmonics, noise=noise)
    assert _off(stride_phase(walk, n_terms=int(n_strides / 2)).phase, phase) < 0.02


def test_the_phase_starts_at_zero_and_has_the_mean_frequency():
    walk, phase = drifting_walk(0.8 * _line(_n_frames(10)) ** 2)
    found = stride_phase(walk)
    assert found.phase[0] == 0
    assert_allclose(found.phase, phase - phase[0], atol=1e-5)
    assert_allclose(found.frequency, (phase[-1] - phase[0]) / (2 * np.pi) / ((walk.n_frames - 1) / 60.0), rtol=1e-6)


def test_no_terms_leave_the_cadence_as_it_is():
    walk, _ = drifting_walk(0.8 * _line(_n_frames(10)) ** 2)
    assert_allclose(np.diff(stride_phase(walk, n_terms=0).phase, 2), 0.0, atol=1e-9)
    assert_allclose(steady_cadence(walk, n_terms=0).positions, walk.positions, atol=1e-9)


def test_drift_goes_and_the_motion_stays():
    """All that is left is the band-limited walk: at 60 frames a second the spline follows it to some 1e-6 m."""
    walk, _ = drifting_walk(legendre_drift(3, _n_frames(12), 6, 1.2))
    steady = steady_cadence(walk)
    assert explained_power(walk.channels, 60.0, stride_frequency(walk), 2) < 0.9
    assert explained_power(steady.channels, 60.0, stride_frequency(steady), 2) > 1 - 1e-9
    assert (steady.n_frames, steady.frame_rate) == (walk.n_frames, walk.frame_rate)
    assert_allclose(steady.positions[[0, -1]], walk.positions[[0, -1]], atol=1e-9)
    assert_allclose(stride_frequency(steady), stride_phase(walk).frequency, rtol=1e-6)
    assert_allclose(stride_phase(steady).phase, stride_phase(steady, n_terms=0).phase, atol=1e-4)
    _, coefficients = make_walk(np.random.default_rng(0))  # the same body
    assert_allclose(_features(steady)[0, :-1], coefficients.ravel(), atol=1e-5)


def test_the_mean_frequency_is_kept():
    """A frequency that is known is that of the result afterwards; one that is not stays unknown."""
    walk, _ = drifting_walk(0.8 * _line(_n_frames(10)) ** 2)
    assert np.isnan(steady_cadence(walk).frequency)
    known = steady_cadence(replace(walk, frequency=0.95))
    assert_allclose(known.frequency, stride_phase(walk).frequency, rtol=1e-6)
    assert_allclose(_features(known), _features(steady_cadence(walk)), atol=1e-5)
    prepared = prepare(replace(walk, frequency=0.95), cadence="steady")
    assert_allclose(prepared.frequency, known.frequency, rtol=1e-9)


def test_steady_walks_change_by_less_than_their_noise():
    """Sixteen walks with 5 mm of noise: features move by a fraction of their standard error, the frequency by a few.

    Four more coefficients of the phase cost the frequency precision: it is their slope at one end minus the other.
    """
    frequency_errors = []
    for seed in range(16):
        walk, coefficients = make_walk(np.random.default_rng(seed), frame_rate=60.0, n_cycles=10, noise=NOISE)
        before, after = _features(walk, steady_cadence(walk))
        standard_error = NOISE * np.sqrt(2 / walk.n_frames)
        assert np.abs(after - before)[:-1].max() < 2 * standard_error
        assert np.abs(after[:-1] - coefficients.ravel()).max() < 6 * standard_error
        frequency_errors.append(after[-1] - 0.93)
    assert np.abs(frequency_errors).max() < 1e-3
    assert abs(np.mean(frequency_errors)) < 2e-4


def test_walks_without_drift_or_noise_stay():
    walk, _ = make_walk(np.random.default_rng(0), n_cycles=10, frame_rate=60.0)
    assert_allclose(steady_cadence(walk).positions, walk.positions, atol=1e-6)


def test_events_move_with_the_phase():
    """Events at whole strides lie whole strides apart in time afterwards. Others before and after the walk stay."""
    drift = 1.0 * _line(_n_frames(10)) ** 2
    _, phase = drifting_walk(drift)
    strides = np.arange(np.ceil(phase[0] / (2 * np.pi)), phase[-1] / (2 * np.pi))
    times = np.interp(2 * np.pi * strides, phase, np.arange(len(phase)) / 60.0)
    events = [Event(time, "heel_strike", "left") for time in times]
    outside = [Event(-0.5, "start"), Event(50.0, "end")]
    walk, _ = drifting_walk(drift, events=tuple(events + outside))
    steady = steady_cadence(walk)
    assert np.ptp(np.diff(times)) > 0.1
    moved = np.array([event.time for event in steady.events if event.side == "left"])
    assert_allclose(np.diff(moved), 1 / stride_phase(walk).frequency, atol=1e-3)  # linear between frames, also above
    assert [event for event in steady.events if event.side == ""] == outside


def test_joint_walks_have_a_phase_too(data_dir):
    """It is that of the markers, whose harmonics are others, to a hundredth of a stride."""
    pairs = zip(cmu_joints(data_dir), cmu_walks(data_dir)[1], strict=True)
    walk, markers = next(pair for pair in pairs if pair[0].name == "07_01")
    phase, frequency = stride_phase(walk)
    assert (np.diff(phase) > 0).all()
    assert_allclose(frequency, stride_frequency(walk), rtol=0.02)
    assert _off(phase, stride_phase(markers).phase) < 2 * np.pi / 100


def _drifting_joints(drift):
    """Return a joint walk whose phase runs ahead of a steady one by `drift`, and that phase."""
    phase = 2 * np.pi * FREQUENCY * np.arange(len(drift)) / 60.0 + drift
    return swinging(phase, frame_rate=60.0, loose=("Head",)), phase


def test_drift_of_joint_walks_goes_as_well():
    """Rotations, the root, and joints that move against their parents: all go by the same phase."""
    drift = legendre_drift(3, _n_frames(12), 6, 1.2)
    walk, phase = _drifting_joints(drift)
    assert _off(stride_phase(walk).phase, phase) < 0.02
    steady = steady_cadence(walk)
    evenly, _ = _drifting_joints(np.linspace(drift[0], drift[-1], len(drift)))
    assert_allclose(steady.rotations, evenly.rotations, atol=1e-4)
    assert_allclose(steady.root, evenly.root, atol=1e-4)
    assert_allclose(steady.translations["Head"], evenly.translations["Head"], atol=1e-4)
    assert explained_power(steady.channels, 60.0, stride_frequency(steady), 2) > 1 - 1e-6


def test_a_given_phase_reference_is_used():
    """The first guess may come from any channel with the period of a stride, where there is no rig to name one."""
    walk, phase = _drifting_joints(0.5 * _line(_n_frames(10)) ** 2)
    names = tuple(f"bone {number}" for number in range(len(walk.skeleton.joint_names)))
    unknown = replace(walk, skeleton=replace(walk.skeleton, joint_names=names), translations={})
    with pytest.raises(ValueError, match=r"walk 'anna': its joints are of no known rig.*pass phase_reference="):
        steady_cadence(unknown)
    left, right = (f"{names[walk.skeleton.index(f'{side}UpLeg')]}_y" for side in ("Left", "Right"))
    reference = {left: -1.0, right: 1.0}
    assert _off(stride_phase(unknown, phase_reference=reference).phase, phase) < 0.02
    assert_allclose(
        steady_cadence(unknown, phase_reference=reference).rotations, steady_cadence(walk).rotations, atol=1e-6
    )


def test_bandai_walks_are_explained_better(data_dir):
    """Wanted are a median of 0.955 and 0.90 in 83 % of the walks; seen 0.960 and 85 %, 0.955 and 81 % as recorded.

    No walk loses more than half a point.
    """
    recorded, prepared = bandai_walks(data_dir)
    constant = np.array([walk_quality(walk).explained_power for walk in prepared])
    steady = np.array([walk_quality(prepare(walk, cadence="steady")).explained_power for walk in recorded])
    assert np.median(steady) >= 0.955
    assert np.mean(steady >= 0.90) >= 0.83
    assert np.median(constant) < np.median(steady)
    assert (steady > constant - 0.005).all()


def test_made_walkers_keep_their_frequency():
    for walk in make_walkers(4, random_state=5).data:
        before, after = _features(walk, steady_cadence(walk))
        assert_allclose(after[-1], before[-1], rtol=0.005)


def _stopping(walk):
    """Let a walk stand for a third of its time."""
    first = walk.n_frames // 3
    frames = np.minimum(np.arange(walk.n_frames), first) + np.maximum(np.arange(walk.n_frames) - 2 * first, 0)
    return replace(walk, positions=walk.positions[frames])


def test_what_has_no_phase_is_refused():
    walk, _ = make_walk(np.random.default_rng(0), n_cycles=10, frame_rate=60.0, name="anna")
    with pytest.raises(WalkError, match=r"'anna': expected a walk in place, got one that travels at 1\.3 m/s"):
        steady_cadence(over_the_floor(walk))
    with pytest.raises(WalkError, match="'anna': expected a phase that rises throughout, got one that stops"):
        steady_cadence(_stopping(walk), n_terms=20)
    positions = walk.positions.copy()
    positions[3, walk.marker_set.index("left_knee")] = np.nan
    with pytest.raises(WalkError, match="3 NaN or infinite ones in left_knee"):
        steady_cadence(replace(walk, positions=positions))
    for wrong in (-1, 2.5):
        with pytest.raises(ValueError, match=f"n_terms must be a whole number of 0 or more, or None, got {wrong}"):
            stride_phase(walk, n_terms=wrong)


def test_other_markers_will_do():
    """A pelvis tells whether a walk travels; without one nothing is asked."""
    walk, phase = drifting_walk(0.5 * _line(_n_frames(10)) ** 2)
    names = ("left_ankle", "right_ankle", "head")
    some = replace(
        walk, positions=walk.positions[:, [walk.marker_set.index(n) for n in names]], marker_set=MarkerSet(names)
    )
    assert _off(stride_phase(some).phase, phase) < 1e-4
