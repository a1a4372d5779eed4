"""Phase, share of walking and heading of whole recordings."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.motion.gait_tracking import local_wave, track_gait
from eigenwalker.motion.support import smooth_step

STEP = 2 * np.pi / 30


@pytest.mark.parametrize("phase", [0.0, 2.5, -1.0])
def test_a_steady_sine_is_found_to_the_ends(phase):
    angles = phase + STEP * np.arange(47)
    mean, amplitude, found = local_wave(0.3 + 0.5 * np.cos(angles), STEP)
    assert_allclose(mean, 0.3, atol=1e-9)
    assert_allclose(amplitude, 0.5, atol=1e-9)
    assert_allclose(found, angles, atol=1e-9)


def test_a_sine_that_is_a_little_faster_is_followed():
    angles = 1.1 * STEP * np.arange(300)
    wave = local_wave(np.cos(angles), STEP)
    assert_allclose(wave.phase[30:-30], angles[30:-30], atol=0.01)
    assert_allclose(wave.amplitude[30:-30], 1, atol=0.04)


def test_starts_and_stops_are_no_steady_walk():
    swing = smooth_step((np.arange(400) - 100) / 30) * smooth_step((300 - np.arange(400)) / 30)
    angles = STEP * np.arange(400)
    yaw = 0.2 + 0.1 * np.sin(angles) * swing
    track = track_gait(swing * np.cos(angles), yaw, STEP, steady=slice(140, 260), heading=1.0)
    assert_allclose(track.share[135:265], 1)
    assert_allclose(track.share[[0, 50, 350, 399]], 0)
    assert (np.diff(track.share[:135]) >= 0).all()
    assert_allclose(track.phase[135:265], angles[135:265], atol=0.01)
    assert_allclose(track.heading, 1.0, atol=0.02)


def test_heading_turns_with_the_pelvis_and_not_with_its_swing():
    angles, turning = STEP * np.arange(600), np.linspace(0, 1.5, 600)
    track = track_gait(np.cos(angles), turning + 0.1 * np.cos(angles), STEP, steady=slice(200, 400), heading=0.4)
    expected = turning - turning[200:400].mean() + 0.4
    assert_allclose(track.heading[30:-30], expected[30:-30], atol=0.01)
