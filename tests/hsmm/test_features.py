"""Static channels and their dynamics."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.hsmm import WINDOWS, append_dynamics, whole_frames


def test_dynamics_are_linear():
    random = np.random.default_rng(0)
    one, other = random.normal(size=(2, 9, 3))
    assert_allclose(append_dynamics(2 * one - other), 2 * append_dynamics(one) - append_dynamics(other), atol=1e-12)


def test_a_shift_moves_the_static_part_alone():
    channels = np.random.default_rng(0).normal(size=(9, 3))
    moved = append_dynamics(channels + 5) - append_dynamics(channels)
    assert_allclose(moved[2:-2], np.tile(np.repeat([5.0, 0, 0], 3), (5, 1)), atol=1e-12)


def test_dynamics_of_a_parabola():
    """Speed 2 t and, as delta2 steps over every other frame, the second difference 2 of stride 1: (8 - 0) / 4."""
    times = np.arange(10.0)
    observations = append_dynamics(times[:, np.newaxis] ** 2)
    assert_allclose(observations[2:-2], np.column_stack((times**2, 2 * times, np.full(10, 2.0)))[2:-2])


def test_equations_by_hand():
    channels = np.random.default_rng(1).normal(size=(7, 2))
    observations = append_dynamics(channels)
    assert_allclose(observations[3, 2:4], (channels[4] - channels[2]) / 2)
    assert_allclose(observations[3, 4:6], (channels[5] - 2 * channels[3] + channels[1]) / 4)


@pytest.mark.parametrize("n_frames", [1, 2, 3, 4, 5, 12])
def test_missing_dynamics_are_those_that_are_not_whole(n_frames):
    observations = append_dynamics(np.ones((n_frames, 2)))
    assert_array_equal(np.isfinite(observations), np.repeat(whole_frames(n_frames), 2, axis=1))
    assert whole_frames(n_frames).sum(axis=0).tolist() == [n_frames, max(n_frames - 2, 0), max(n_frames - 4, 0)]


def test_other_windows_are_data():
    observations = append_dynamics(np.arange(4.0)[:, np.newaxis], windows=(WINDOWS[0], (-1.0, 1.0, 0.0)))
    assert_array_equal(observations[1:-1, 1], [1, 1])


def test_even_windows_are_refused():
    with pytest.raises(ValueError, match=r"odd number of coefficients.*\(1.0, -1.0\)"):
        append_dynamics(np.ones((4, 1)), windows=((1.0, -1.0),))
