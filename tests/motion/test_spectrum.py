"""Amplitude spectra."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import Walk, WalkError
from eigenwalker.motion import spectrum


def make(n_frames, frame_rate=60.0):
    """Return a walk whose first channel is 3 + 2 cos(2 pi 2 t) + 0.5 sin(2 pi 5 t)."""
    times = np.arange(n_frames) / frame_rate
    positions = np.zeros((n_frames, 15, 3))
    positions[:, 0, 0] = 3 + 2 * np.cos(2 * np.pi * 2 * times) + 0.5 * np.sin(2 * np.pi * 5 * times)
    return Walk(positions, frame_rate)


@pytest.mark.parametrize("n_frames", [120, 180])
def test_waves_that_fit_have_their_amplitudes(n_frames):
    table = spectrum(make(n_frames))
    expected = np.zeros(len(table))
    expected[[table.index.get_loc(f) for f in (0.0, 2.0, 5.0)]] = 3.0, 2.0, 0.5
    assert_allclose(table["head_x"], expected, atol=1e-12)
    assert (table.drop(columns="head_x") == 0).all(axis=None)


@pytest.mark.parametrize("n_frames", [8, 9])
def test_the_power_is_that_of_the_signal(n_frames):
    """Parseval: the mean, half of each wave's square; the highest frequency of an even number counts whole."""
    walk = make(n_frames)
    values = np.random.default_rng(0).normal(size=(n_frames, 45))
    amplitudes = spectrum(walk.with_channels(values)).to_numpy()
    weights = np.full(len(amplitudes), 0.5)
    weights[0] = 1.0
    if n_frames % 2 == 0:
        weights[-1] = 1.0
    assert_allclose(weights @ amplitudes**2, (values**2).mean(axis=0))


def test_limits_and_faults():
    assert spectrum(make(120), max_frequency=3.0).index.max() == 3.0
    with pytest.raises(ValueError, match="max_frequency must be positive"):
        spectrum(make(120), max_frequency=0.0)
    walk = make(120)
    gap = walk.positions.copy()
    gap[3, 2, 1] = np.nan
    with pytest.raises(WalkError):
        spectrum(Walk(gap, 60.0))
