"""Recordings played at another pace."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.motion import Event
from eigenwalker.motion.time_warp import warp_time, warped_frames
from tests.joint_bodies import swinging


def test_pace_one_shows_every_frame():
    assert_allclose(warped_frames(np.ones(50)), np.arange(50), rtol=0, atol=1e-9)


@pytest.mark.parametrize("pace", [0.8, 1.25])
def test_a_constant_pace_divides_the_time(pace):
    sources = warped_frames(np.full(101, pace))
    assert_allclose(sources, pace * np.arange(len(sources)), atol=1e-9)
    assert len(sources) == int(100 / pace) + 1


def test_parts_at_pace_one_last_as_long_as_they_did():
    paces = np.where(np.abs(np.arange(300) - 150) < 50, 1.2, 1.0)
    sources = warped_frames(paces)
    assert_allclose(np.diff(sources)[:90], 1, atol=1e-3)
    assert_allclose(np.diff(sources)[110:170], 1.2, atol=1e-3)
    assert_allclose(np.diff(sources)[-80:], 1, atol=1e-3)


def test_a_walk_at_another_pace_has_another_frequency():
    phase = 2 * np.pi * 0.9 * np.arange(600) / 120
    walk = replace(swinging(phase), events=(Event(1.1, "heel_strike", "left"),))
    warped = warp_time(walk, warped_frames(np.full(600, 1.1)))
    expected = swinging(1.1 * phase)
    n_frames = warped.n_frames
    assert_allclose(warped.rotations, expected.rotations[:n_frames], rtol=0, atol=1e-6)
    assert_allclose(warped.root, expected.root[:n_frames], rtol=0, atol=1e-7)
    assert warped.events[0].time == pytest.approx(1.0)


def test_what_leaps_does_not_ring():
    walk = swinging(np.linspace(0, 12, 60))
    rotations = np.array(walk.rotations)
    rotations[30:, 3] = [0.0, 1.5, 0.0]
    rotations[:30, 3] = 0.0
    warped = warp_time(replace(walk, rotations=rotations), warped_frames(np.full(60, 1.07)))
    assert warped.rotations[:, 3].min() >= 0
    assert warped.rotations[:, 3].max() <= 1.5
