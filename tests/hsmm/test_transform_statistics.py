"""Sums for transforms: what they say of a transform is the sum of log-densities, exactly."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.hsmm.features import WINDOWS
from eigenwalker.hsmm.transform_statistics import (
    accumulate_transform,
    add_transform_statistics,
    select_classes,
    transform_objective,
)
from eigenwalker.hsmm.transforms import ChannelTransform, identity_transform
from tests.hsmm.adapted import STATIC, brute_objective, draw_transform, noisy_world, sum_world
from tests.hsmm.test_transforms import SUMMING


@settings(deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    n_channels=st.integers(1, 4),
    windows=st.sampled_from([WINDOWS, SUMMING, STATIC]),
    size=st.sampled_from([0.1, 2.0]),
)
def test_objective_is_the_sum_of_log_densities(seed, n_channels, windows, size):
    """Of any transform, edges with their fewer volumes included."""
    world = noisy_world(seed, n_channels=n_channels, windows=windows, n_frames=12)
    transform = draw_transform(np.random.default_rng(seed), n_channels, size)
    statistics = sum_world(world, windows=windows)
    value = transform_objective(statistics, [transform])
    assert value == pytest.approx(brute_objective(world, transform, windows), rel=1e-10)
    assert statistics.n_volumes[0] == pytest.approx(np.isfinite(world[0]).sum() / n_channels)
    assert statistics.n_frames[0] == pytest.approx(12)


def test_sums_add_over_walks():
    one, other = (noisy_world(seed, n_frames=20) for seed in (0, 1))
    other = (*other[:2], *one[2:])
    both = add_transform_statistics(sum_world(one), sum_world(other))
    transform = draw_transform(np.random.default_rng(0), 3)
    wanted = brute_objective(one, transform) + brute_objective(other, transform)
    assert transform_objective(both, [transform]) == pytest.approx(wanted)


def test_classes_part_the_sums():
    world = noisy_world(3)
    classes = np.array([1, 0, 1, 3])
    statistics = sum_world(world, state_classes=classes, n_classes=4)
    transforms = [draw_transform(np.random.default_rng(seed), 3) for seed in range(4)]
    wanted = 0.0
    for group, transform in enumerate(transforms):
        own = classes == group
        wanted += brute_objective((world[0], world[1][:, own], world[2][own], world[3][own]), transform)
    assert transform_objective(statistics, transforms) == pytest.approx(wanted)
    assert statistics.n_frames[2] == 0
    for whole, part in zip(sum_world(world), statistics, strict=True):
        assert_allclose(part.sum(axis=0), whole[0])
    chosen = select_classes(statistics, [3, 0])
    assert_array_equal(chosen.linear, statistics.linear[[3, 0]])


def test_positions_of_one_state_are_one():
    observations, posteriors, means, variances = noisy_world(4)
    settings_of = {"means": means, "variances": variances}
    twice = accumulate_transform(observations, posteriors, states=[2, 0, 2, 1], **settings_of)
    joined = np.column_stack((posteriors[:, 1], posteriors[:, 3], posteriors[:, 0] + posteriors[:, 2]))
    once = accumulate_transform(observations, joined, states=[0, 1, 2], **settings_of)
    for one, other in zip(once, twice, strict=True):
        assert_allclose(one, other, rtol=1e-12)


def test_sums_by_hand():
    """Two frames of one channel and its delta, which the second frame lacks."""
    observations = np.array([[2.0, 1.0], [3.0, np.nan]])
    statistics = accumulate_transform(
        observations,
        np.array([[1.0], [0.5]]),
        states=[0],
        means=np.array([[1.0, 4.0]]),
        variances=np.array([[2.0, 0.5]]),
        windows=WINDOWS[:2],
    )
    assert_allclose(statistics.n_volumes, 2.5)
    # Static: (4 + 0.5 * 9) / 2, (2 + 0.5 * 3) / 2, 1.5 / 2. Delta: 1 / 0.5, without a share in the bias.
    assert_allclose(statistics.quadratic[0, 0], [[4.25 + 2, 1.75], [1.75, 0.75]])
    assert_allclose(statistics.linear[0, 0], [1.75 + 8, 0.75])


def test_what_does_not_fit_is_refused():
    world = noisy_world(0)
    with pytest.raises(ValueError, match=r"one class from 0 to 1 for each of 4 states, got \[0, 1, 2, 0\]"):
        sum_world(world, state_classes=[0, 1, 2, 0], n_classes=2)
    world[0][7, 4] = np.nan
    with pytest.raises(ValueError, match="some of window 1 are NaN in frame 7, and 1 windows in all"):
        sum_world(world)


def test_the_identity_has_the_density_of_the_model():
    world = noisy_world(5)
    mirror = ChannelTransform(-np.eye(3), np.zeros(3))
    statistics = sum_world(world)
    assert transform_objective(statistics, [identity_transform(3)]) == pytest.approx(
        brute_objective(world, identity_transform(3))
    )
    assert transform_objective(statistics, [mirror]) == pytest.approx(brute_objective(world, mirror))
