"""The E step under transforms of a walker."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.hsmm import append_dynamics, expect_statistics
from eigenwalker.hsmm.duration_transform import DurationTransform, transformed_durations
from eigenwalker.hsmm.observation import log_densities
from eigenwalker.hsmm.transform_statistics import transform_objective
from eigenwalker.hsmm.transformed_inference import (
    WalkerTransforms,
    accumulate_transformed,
    accumulate_walk_transform,
    expect_transformed,
    identity_walker,
    one_class,
    transformed_log_densities,
)
from tests.hsmm.adapted import draw_transform
from tests.hsmm.planted import draw_parameters, draw_walk


def _world(seed):
    """Return a walk with dynamics through 4 states of two channels, and parameters with them."""
    random = np.random.default_rng(seed)
    walk, _ = draw_walk(random, draw_parameters(random, n_states=4, n_features=2), (0, 1, 2, 1, 3))
    parameters = draw_parameters(random, n_states=4, n_features=6)
    return random, walk._replace(observations=append_dynamics(walk.observations)), parameters


def _walker(random, n_classes=1):
    durations = DurationTransform(np.array([1.1]), np.array([0.3]))
    return WalkerTransforms(tuple(draw_transform(random, 2) for _ in range(n_classes)), durations)


def test_the_identity_is_the_plain_e_step():
    _, walk, parameters = _world(0)
    classes = one_class(parameters)
    identity = identity_walker(classes, 2)
    posterior = expect_transformed(walk, parameters, identity, classes=classes)
    mine = accumulate_transformed(walk, posterior, parameters, identity.channels, classes=classes)
    for one, other in zip(mine, expect_statistics(walk, parameters), strict=True):
        assert_allclose(one, other, rtol=1e-12)


def test_one_transform_is_a_change_of_variables():
    """Transforming the walk, and counting volumes, is the same as transforming within."""
    random, walk, parameters = _world(1)
    walker, classes = _walker(random), one_class(parameters)
    posterior = expect_transformed(walk, parameters, walker, classes=classes)
    moved = walk._replace(observations=append_dynamics(walker.channels[0].apply(walk.observations[:, :2])))
    pair = transformed_durations(walker.durations, parameters.duration_means, parameters.duration_variances)
    plain = expect_statistics(moved, parameters._replace(duration_means=pair[0], duration_variances=pair[1]))
    n_volumes = 3 * len(walk.observations) - 6
    assert posterior.log_likelihood == pytest.approx(plain.log_likelihood + n_volumes * walker.channels[0].log_volume)
    mine = accumulate_transformed(walk, posterior, parameters, walker.channels, classes=classes)
    assert_allclose(mine.sums, plain.sums, rtol=1e-9, atol=1e-9)
    assert_allclose(mine.duration_counts, plain.duration_counts, rtol=1e-9, atol=1e-12)


def test_each_class_has_its_own_transform():
    random, walk, parameters = _world(2)
    walker = _walker(random, 2)
    groups = np.array([0, 1, 1, 0])
    logs = transformed_log_densities(
        walk.observations, parameters.means, parameters.variances, walker.channels, state_classes=groups
    )
    for state, group in enumerate(groups):
        transform = walker.channels[group]
        moved = append_dynamics(transform.apply(walk.observations[:, :2]))
        alone = log_densities(moved, parameters.means[[state]], parameters.variances[[state]])[0]
        assert_allclose(logs[state], alone + np.isfinite(moved[:, ::2]).sum(axis=1) * transform.log_volume)


def test_sums_of_classes_are_those_of_their_states():
    random, walk, parameters = _world(3)
    walker, classes = _walker(random, 2), one_class(parameters, state_classes=[0, 1, 1, 0])
    posterior = expect_transformed(walk, parameters, walker, classes=classes)
    mine = accumulate_transformed(walk, posterior, parameters, walker.channels, classes=classes)
    for group, states in ((0, [0, 3]), (1, [1, 2])):
        single = one_class(parameters)
        alone = accumulate_transformed(walk, posterior, parameters, walker.channels[group:], classes=single)
        for name in ("counts", "sums", "squares"):
            assert_allclose(getattr(mine, name)[states], getattr(alone, name)[states])
    assert mine.n_frames == len(walk.observations)
    assert_allclose(mine.duration_counts.sum(), 5)


def test_expected_log_densities_agree_with_the_statistics():
    random, walk, parameters = _world(4)
    walker, classes = _walker(random, 2), one_class(parameters, state_classes=[0, 1, 1, 0])
    posterior = expect_transformed(walk, parameters, walker, classes=classes)
    statistics = accumulate_walk_transform(walk, posterior, parameters, classes=classes)
    logs = transformed_log_densities(
        walk.observations, parameters.means, parameters.variances, walker.channels, state_classes=classes.states
    )
    wanted = (posterior.state_posteriors.T * logs[walk.states]).sum()
    assert transform_objective(statistics, walker.channels) == pytest.approx(wanted)


def test_classes_by_default_and_refused():
    _, _, parameters = _world(5)
    assert one_class(parameters).n_states == 1
    assert_array_equal(one_class(parameters, duration_classes=[0, 1, 2, 1]).durations, [0, 1, 2, 1])
    with pytest.raises(
        ValueError, match=r"state_classes must be a number from 0 on for each of 4 states, got \[0, 1\]"
    ):
        one_class(parameters, state_classes=[0, 1])
