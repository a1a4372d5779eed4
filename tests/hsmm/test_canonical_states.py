"""The states that walkers share, and which of the equally likely ones is taken."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.hsmm import append_dynamics
from eigenwalker.hsmm.canonical_states import nearest_to_identity
from eigenwalker.hsmm.duration_transform import (
    DurationTransform,
    duration_penalty,
)
from eigenwalker.hsmm.transform_estimation import StandardUnits, transform_penalty
from eigenwalker.hsmm.transformed_inference import WalkerTransforms, expect_transformed, one_class
from eigenwalker.hsmm.transforms import ChannelTransform
from tests.hsmm.adapted import draw_transform, rows_of
from tests.hsmm.planted import draw_parameters, draw_walk
from tests.hsmm.test_transforms import SUMMING


def _world(seed, n_walkers=3, n_features=6):
    random = np.random.default_rng(seed)
    parameters = draw_parameters(random, n_states=4, n_features=n_features)
    walkers = [
        WalkerTransforms(
            tuple(draw_transform(random, 2) for _ in range(2)),
            DurationTransform(random.uniform(0.8, 1.2, 1), random.normal(0, 0.3, 1)),
        )
        for _ in range(n_walkers)
    ]
    units = StandardUnits(random.normal(size=2), random.uniform(0.5, 2, 2)), StandardUnits(np.array([6.0]), np.ones(1))
    settings = {
        "classes": one_class(parameters, state_classes=[0, 1, 1, 0]),
        "units": units[0],
        "duration_units": units[1],
        "windows": SUMMING,
    }
    return random, parameters, walkers, settings


def test_the_nearest_states_are_as_likely():
    """With windows that have part of the bias, too."""
    random, parameters, walkers, settings = _world(0)
    walk, _ = draw_walk(random, draw_parameters(random, n_states=4, n_features=2), (0, 1, 2, 3))
    walk = walk._replace(observations=append_dynamics(walk.observations, windows=SUMMING))
    nearest, moved = nearest_to_identity(parameters, walkers, **settings)
    fixed = {"classes": settings["classes"], "windows": SUMMING}
    for before, after in zip(walkers, moved, strict=True):
        one = expect_transformed(walk, parameters, before, **fixed).log_likelihood
        assert expect_transformed(walk, nearest, after, **fixed).log_likelihood == pytest.approx(one, rel=1e-10)


def _distance(walkers, settings):
    return sum(
        transform_penalty(own.channels, weight=1.0, units=settings["units"])
        + duration_penalty(own.durations, 1.0, settings["duration_units"])
        for own in walkers
    )


def test_no_other_scales_and_shifts_are_nearer():
    random, parameters, walkers, settings = _world(1)
    _, moved = nearest_to_identity(parameters, walkers, **settings)
    best = _distance(moved, settings)
    assert best < _distance(walkers, settings)
    for _ in range(30):
        change = ChannelTransform(np.diag(1 + 0.05 * random.normal(size=2)), 0.05 * random.normal(size=2))
        factor, shift = 1 + 0.05 * random.normal(), 0.05 * random.normal()
        other = [
            WalkerTransforms(
                tuple(part.then(change) for part in own.channels),
                DurationTransform(factor * own.durations.factors, factor * own.durations.shifts + shift),
            )
            for own in moved
        ]
        assert _distance(other, settings) > best


def test_all_equally_likely_states_become_the_same():
    random, parameters, walkers, settings = _world(2)
    wanted, _ = nearest_to_identity(parameters, walkers, **settings)
    again, _ = nearest_to_identity(*nearest_to_identity(parameters, walkers, **settings), **settings)
    factors, shifts = random.uniform(0.5, 2, 2), random.normal(size=2)
    change = ChannelTransform(np.diag(factors), shifts)
    changed = parameters._replace(
        means=parameters.means * np.tile(factors, 3) + np.multiply.outer([1, 2, -0.75], shifts).ravel(),
        variances=parameters.variances * np.tile(factors, 3) ** 2,
        duration_means=2 * parameters.duration_means + 1,
        duration_variances=4 * parameters.duration_variances,
    )
    others = [
        WalkerTransforms(
            tuple(part.then(change) for part in own.channels),
            DurationTransform(2 * own.durations.factors, 2 * own.durations.shifts + 1),
        )
        for own in walkers
    ]
    found, _ = nearest_to_identity(changed, others, **settings)
    for one, other, third in zip(wanted, found, again, strict=True):
        assert_allclose(other, one, rtol=1e-9)
        assert_allclose(third, one, rtol=1e-9)


def test_floors_hold():
    """Where a variance is at its floor channels may grow but not shrink; what is nearest given that is taken."""
    _, parameters, walkers, settings = _world(4)
    free, _ = nearest_to_identity(parameters, walkers, **settings)
    for floors in (0.9 * parameters.variances.min(axis=0), parameters.variances.min(axis=0)):
        held, moved = nearest_to_identity(
            parameters, walkers, floors=floors, duration_floor=parameters.duration_variances.min(), **settings
        )
        assert (held.variances >= floors * (1 - 1e-12)).all()
        assert held.duration_variances.min() >= parameters.duration_variances.min() * (1 - 1e-12)
        assert (held.variances >= free.variances * (1 - 1e-12)).all()
        assert _distance(moved, settings) <= _distance(walkers, settings)


def test_one_walker_without_coupling_becomes_the_identity():
    _, parameters, _, settings = _world(3)
    scaled = ChannelTransform(np.diag([3.0, 0.2]), np.array([1.0, -4.0]))
    walker = WalkerTransforms((scaled, scaled), DurationTransform(np.array([0.7]), np.array([2.0])))
    _, (moved,) = nearest_to_identity(parameters, [walker], **settings)
    for transform in moved.channels:
        assert_allclose(rows_of(transform), np.eye(2, 3), atol=1e-12)
    assert_allclose([moved.durations.factors[0], moved.durations.shifts[0]], [1, 0], atol=1e-12)
