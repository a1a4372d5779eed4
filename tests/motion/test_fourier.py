"""The Fourier model of one walk."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from eigenwalker import WalkError
from eigenwalker.motion import (
    amplitude_phase,
    coarse_frequency,
    estimate_frequency,
    evaluate_harmonics,
    explained_power,
    fit_harmonics,
    reference_phase,
    shift_phase,
    stride_frequency,
)
from tests.synthetic import make_walk


def _series(seed, n_harmonics, frequency, n_frames, frame_rate, n_channels=7):
    coefficients = np.random.default_rng(seed).normal(size=(2 * n_harmonics + 1, n_channels))
    return coefficients, evaluate_harmonics(coefficients, frequency, np.arange(n_frames) / frame_rate)


def _design(frequency, n_harmonics, n_frames, frame_rate):
    angles = 2 * np.pi * frequency / frame_rate * np.outer(np.arange(n_frames), np.arange(1, n_harmonics + 1))
    waves = np.stack((np.sin(angles), np.cos(angles)), axis=2).reshape(n_frames, -1)
    return np.hstack((np.ones((n_frames, 1)), waves))


@settings(deadline=None, max_examples=60)
@given(
    seed=st.integers(0, 10_000),
    n_harmonics=st.integers(1, 6),
    frequency=st.floats(0.6, 1.4),
    n_frames=st.integers(130, 900),
    frame_rate=st.sampled_from([30.0, 50.0, 120.0]),
)
def test_fit_inverts_evaluate(seed, n_harmonics, frequency, n_frames, frame_rate):
    coefficients, wave = _series(seed, n_harmonics, frequency, n_frames, frame_rate)
    # A cycle and a third: below that the columns of the design are nearly dependent.
    if n_frames * frequency / frame_rate > 4 / 3:
        assert_allclose(fit_harmonics(wave, frame_rate, frequency, n_harmonics), coefficients, atol=1e-9)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("n_frames", [40, 127, 128, 129, 600, 1024])
def test_fit_is_least_squares(dtype, n_frames):
    """Noise, a number of frames around the length of the compiled loop's chunks, and both precisions."""
    rng = np.random.default_rng(n_frames)
    channels = rng.normal(size=(n_frames, 45)).astype(dtype)
    design = _design(1.1, 2, n_frames, 30.0)
    expected = np.linalg.lstsq(design, channels.astype(np.float64))[0]
    assert_allclose(fit_harmonics(channels, 30.0, 1.1, 2), expected, atol=1e-12)


def test_fit_does_not_care_for_memory_layout():
    rng = np.random.default_rng(0)
    channels = rng.normal(size=(300, 8))
    expected = fit_harmonics(channels, 60, 0.9, 2)
    assert_allclose(fit_harmonics(np.asfortranarray(channels), 60, 0.9, 2), expected, atol=1e-13)


@given(seed=st.integers(0, 1000), first=st.floats(-7, 7), second=st.floats(-7, 7))
@settings(deadline=None, max_examples=50)
def test_shifts_add_up_and_move_time(seed, first, second):
    coefficients, _ = _series(seed, 3, 1.0, 2, 1.0)
    once = shift_phase(coefficients, first + second)
    assert_allclose(shift_phase(shift_phase(coefficients, first), second), once, atol=1e-12)
    times = np.linspace(0, 2, 11)
    later = times + (first + second) / (2 * np.pi * 1.3)
    assert_allclose(evaluate_harmonics(once, 1.3, times), evaluate_harmonics(coefficients, 1.3, later), atol=1e-10)


def test_amplitude_and_phase_give_the_wave_back():
    coefficients, _ = _series(3, 2, 1.0, 2, 1.0)
    amplitude, phase = amplitude_phase(coefficients)
    times = np.linspace(0, 1, 20)
    wave = coefficients[0] + sum(
        amplitude[k - 1] * np.cos(2 * np.pi * k * times[:, np.newaxis] + phase[k - 1]) for k in (1, 2)
    )
    assert_allclose(evaluate_harmonics(coefficients, 1.0, times), wave, atol=1e-12)


def test_reference_becomes_a_pure_cosine():
    coefficients, _ = _series(4, 2, 1.0, 2, 1.0)
    weights = np.array([0, 0, 1.0, 0, -2.0, 0, 0])
    shifted = shift_phase(coefficients, reference_phase(coefficients, weights))
    assert abs(shifted[1] @ weights) < 1e-12
    assert shifted[2] @ weights > 0


@settings(deadline=None, max_examples=40)
@given(
    seed=st.integers(0, 10_000),
    frequency=st.floats(0.7, 1.3),
    n_cycles=st.floats(1.5, 20),
    off=st.floats(-0.08, 0.08),
)
def test_frequency_without_noise_is_exact(seed, frequency, n_cycles, off):
    rng = np.random.default_rng(seed)
    walk, _ = make_walk(rng, frequency=frequency, n_cycles=n_cycles)
    start = frequency + off / walk.duration
    assert_allclose(estimate_frequency(walk.channels, 120, start=start), frequency, rtol=1e-12)


@pytest.mark.parametrize("n_cycles", [2, 5, 20])
@pytest.mark.parametrize("noise", [0.001, 0.005])
def test_frequency_reaches_the_cramer_rao_bound(n_cycles, noise):
    """60 trials: the RMSE of an efficient estimator lies above 1.3 times the bound once in some 1,000 tries."""
    rng = np.random.default_rng(n_cycles)
    errors = []
    for _ in range(60):
        walk, coefficients = make_walk(rng, n_harmonics=4, n_cycles=n_cycles, noise=noise)
        bound = _cramer_rao(coefficients, 0.93, walk.n_frames, walk.frame_rate, noise)
        errors.append((stride_frequency(walk) - 0.93) / bound)
    assert np.sqrt(np.mean(np.square(errors))) < 1.3


def _cramer_rao(coefficients, frequency, n_frames, frame_rate, noise):
    """Standard deviation of the best unbiased estimate of the frequency, coefficients and phase unknown."""
    n_harmonics = (len(coefficients) - 1) // 2
    design = _design(frequency, n_harmonics, n_frames, frame_rate)
    times = np.arange(n_frames)[:, np.newaxis] / frame_rate
    slope = sum(
        2
        * np.pi
        * k
        * times
        * (design[:, [2 * k]] * coefficients[2 * k - 1] - design[:, [2 * k - 1]] * coefficients[2 * k])
        for k in range(1, n_harmonics + 1)
    )
    rest = slope - design @ np.linalg.lstsq(design, slope)[0]
    return noise / np.sqrt((rest**2).sum())


def test_coarse_guess_is_near():
    rng = np.random.default_rng(2)
    for n_cycles in (1.3, 2.0, 3.7, 12.0):
        walk, _ = make_walk(rng, n_cycles=n_cycles, noise=0.005)
        reference = walk.marker("left_ankle")[:, 0] - walk.marker("right_ankle")[:, 0]
        assert abs(coarse_frequency(reference, 120) - 0.93) < 0.1 / walk.duration


@pytest.mark.parametrize(
    ("signal", "reason"),
    [
        (np.zeros(600), "periodic part"),
        (np.linspace(0, 3, 600), "periodic part"),
        (np.random.default_rng(0).normal(size=600), "periodic part"),
        (np.sin(np.arange(600) / 600), "periodic part"),
        (np.zeros(10), "at least one stride"),
    ],
)
def test_no_period_is_refused(signal, reason):
    with pytest.raises(WalkError, match=f"'anna'.*{reason}"):
        coarse_frequency(signal, 60, name="anna")


@settings(deadline=None)
@given(
    seed=st.integers(0, 10_000),
    n_harmonics=st.integers(1, 6),
    frequency=st.floats(0.6, 1.4),
    n_frames=st.integers(60, 900),
    offset=st.sampled_from([0.0, 1e3]),
)
def test_explained_power_is_one_less_the_share_of_squares_that_is_left(seed, n_harmonics, frequency, n_frames, offset):
    """Far from the origin, too, where squares are large that no one asks for."""
    channels = offset + np.random.default_rng(seed).normal(size=(n_frames, 5))
    coefficients = fit_harmonics(channels, 50.0, frequency, n_harmonics)
    residual = channels - evaluate_harmonics(coefficients, frequency, np.arange(n_frames) / 50.0)
    expected = 1 - (residual**2).sum() / ((channels - channels.mean(axis=0)) ** 2).sum()
    assert_allclose(explained_power(channels, 50.0, frequency, n_harmonics), expected, atol=1e-10)


def test_explained_power_between_nothing_and_all():
    _, wave = _series(1, 2, 1.0, 240, 60)
    assert_allclose(explained_power(wave, 60, 1.0, 2), 1.0)
    assert explained_power(np.random.default_rng(0).normal(size=(600, 20)), 60, 1.0, 2) < 0.05
    assert explained_power(np.ones((60, 2)), 60, 1.0, 2) == 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((60, 0.0, 2), "frequency must be positive"),
        ((60, 16.0, 2), "below half the frame rate"),
        ((60, 1.0, 0), "n_harmonics must be at least 1"),
        ((0, 1.0, 2), "frame_rate must be positive"),
        ((60, 1.0, 25), "expected at least 51 frames"),
    ],
)
def test_impossible_fits_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        fit_harmonics(np.zeros((40, 2)), *arguments)
