"""Paths of the root without jolts: what is smooth stays, what is not is bounded, ends stay where they are."""

import numpy as np
import pytest

from eigenwalker.motion.softening import soften_path

RATE, STRIDE, LIMIT = 60.0, 66.0, 23.0


def _acceleration(path):
    return np.linalg.norm(np.diff(path, 2, axis=0), axis=1) * RATE**2


def _stepping(n_frames=300, jolt=0.0, at=(90, 150, 210)):
    """Return a path ahead at 1.2 m/s that bobs, whose velocity changes by `jolt` m/s at once in some frames."""
    time = np.arange(n_frames) / RATE
    path = np.column_stack((1.2 * time, 0.03 * np.sin(5.7 * time), 0.9 + 0.02 * np.cos(11.4 * time)))
    for frame in at:
        path[:, 0] += jolt * np.maximum(0, time - frame / RATE) * (-1) ** (frame // 60)
    return path


def test_a_smooth_path_is_itself():
    path = _stepping()
    assert soften_path(path, RATE, STRIDE) is path


@pytest.mark.parametrize("jolt", [0.45, 0.6, 0.9])
def test_no_jolt_is_left(jolt):
    path = _stepping(jolt=jolt)
    assert _acceleration(path).max() > LIMIT
    assert _acceleration(soften_path(path, RATE, STRIDE)).max() <= LIMIT


def test_it_stays_near_the_path_and_far_from_jolts_on_it():
    path = _stepping(jolt=0.6)
    soft = soften_path(path, RATE, STRIDE)
    assert np.abs(soft - path).max() < 0.02
    far = np.abs(np.arange(300)[:, None] - [90, 150, 210]).min(axis=1) > 0.04 * STRIDE * 6 + 1
    np.testing.assert_array_equal(soft[far], path[far])


def test_more_frames_a_second_give_the_same_path():
    soft = soften_path(_stepping(jolt=0.6), RATE, STRIDE)
    time = np.arange(600) / 120
    fine = np.column_stack((1.2 * time, 0.03 * np.sin(5.7 * time), 0.9 + 0.02 * np.cos(11.4 * time)))
    for frame in (90, 150, 210):
        fine[:, 0] += 0.6 * np.maximum(0, time - frame / RATE) * (-1) ** (frame // 60)
    np.testing.assert_allclose(soften_path(fine, 2 * RATE, 2 * STRIDE)[::2], soft, atol=3e-3)


@pytest.mark.parametrize("n_frames", [1, 2, 3])
def test_few_frames(n_frames):
    path = np.zeros((n_frames, 3))
    assert soften_path(path, RATE, STRIDE) is path
