"""Transforms of channels: they commute with windows, and are densities' change of variables."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.stats import multivariate_normal

from eigenwalker.hsmm.features import NEIGHBOR_WINDOWS, WINDOWS, append_dynamics
from eigenwalker.hsmm.transforms import (
    ChannelTransform,
    identity_transform,
    transform_observations,
    transformed_moments,
)
from tests.hsmm.adapted import draw_transform

SUMMING = ((1.0,), (0.5, 1.0, 0.5), (-1.0, 0.0, 0.25))  # of which the dynamics, too, have part of the bias


@settings(deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    n_frames=st.integers(1, 9),
    n_channels=st.integers(1, 4),
    windows=st.sampled_from([WINDOWS, NEIGHBOR_WINDOWS, SUMMING, WINDOWS[:1]]),
)
def test_transforms_commute_with_windows(seed, n_frames, n_channels, windows):
    """At the edges, too, where windows are missing."""
    random = np.random.default_rng(seed)
    channels, transform = random.normal(size=(n_frames, n_channels)), draw_transform(random, n_channels)
    before = transform_observations(append_dynamics(channels, windows=windows), transform, windows=windows)
    after = append_dynamics(transform.apply(channels), windows=windows)
    assert_allclose(before, after, atol=1e-12)
    assert_array_equal(np.isnan(before), np.isnan(after))


def test_transforms_are_a_group():
    random = np.random.default_rng(0)
    one, other, third = (draw_transform(random, 3) for _ in range(3))
    channels = random.normal(size=(5, 3))
    assert_allclose(one.then(other).apply(channels), other.apply(one.apply(channels)))
    assert_allclose(one.then(other).then(third).matrix, one.then(other.then(third)).matrix)
    for undone in (one.then(one.inverse()), one.inverse().then(one)):
        assert_allclose(undone.matrix, np.eye(3), atol=1e-12)
        assert_allclose(undone.bias, 0, atol=1e-12)
    assert one.then(other).log_volume == pytest.approx(one.log_volume + other.log_volume)
    assert one.inverse().log_volume == pytest.approx(-one.log_volume)
    assert_array_equal(identity_transform(3).then(one).matrix, one.matrix)


def test_volume_of_a_mirror_is_that_of_what_it_mirrors():
    assert ChannelTransform(np.diag([-2.0, 3.0]), np.zeros(2)).log_volume == pytest.approx(np.log(6))


@pytest.mark.parametrize("windows", [WINDOWS, SUMMING])
def test_states_seen_from_the_channels_have_the_same_density(windows):
    """The change of variables: log N(c; adapted) = log N(z; state) + log |det A|, window by window."""
    random = np.random.default_rng(1)
    transform, n_states, n_channels = draw_transform(random, 2), 3, 2
    means, variances = random.normal(size=(n_states, 6)), random.uniform(0.5, 2, (n_states, 6))
    adapted, covariances = transformed_moments(transform, means, variances, windows=windows, full=True)
    assert covariances.shape == (n_states, 3, n_channels, n_channels)
    for window in range(3):
        part, total = slice(2 * window, 2 * window + 2), sum(windows[window])
        for state in range(n_states):
            c = random.normal(size=n_channels)
            z = transform.matrix @ c + total * transform.bias
            there = multivariate_normal(means[state, part], np.diag(variances[state, part])).logpdf(z)
            here = multivariate_normal(adapted[state, part], covariances[state, window]).logpdf(c)
            assert here == pytest.approx(there + transform.log_volume)


def test_variances_are_the_diagonals_of_covariances():
    random = np.random.default_rng(2)
    transform, moments = draw_transform(random, 3), random.uniform(1, 2, (2, 4, 9))
    means, variances = transformed_moments(transform, *moments)
    same, covariances = transformed_moments(transform, *moments, full=True)
    assert_array_equal(means, same)
    assert_allclose(variances.reshape(4, 3, 3), np.einsum("swii->swi", covariances))
    assert_allclose(covariances, covariances.swapaxes(-1, -2))  # which A Sigma A would not be


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match=r"3 windows of 2 channels each, \(n_rows, 6\), got shape \(4, 5\)"):
        transform_observations(np.ones((4, 5)), identity_transform(2))
