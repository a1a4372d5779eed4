"""Constrained regression of channels, by maximum likelihood and with a prior."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.hsmm._transform_ascent import ascend_rows, make_problem, objective, polish
from eigenwalker.hsmm.features import WINDOWS
from eigenwalker.hsmm.transform_estimation import (
    StandardUnits,
    estimate_transform,
    standard_units,
    transform_penalty,
)
from eigenwalker.hsmm.transform_statistics import transform_objective
from eigenwalker.hsmm.transforms import ChannelTransform, identity_transform, transform_observations
from tests.hsmm.adapted import (
    STATIC,
    brute_objective,
    draw_frames,
    draw_transform,
    noisy_world,
    rows_of,
    sum_world,
)
from tests.hsmm.test_transforms import SUMMING


def _units(seed, n_channels=3):
    random = np.random.default_rng(seed)
    return StandardUnits(random.normal(size=n_channels), random.uniform(0.2, 3, n_channels))


def _transform_of(rows):
    return ChannelTransform(rows[:, :-1], rows[:, -1])


@pytest.mark.parametrize("weight", [0.0, 0.3, 10.0, 1000.0])
@pytest.mark.parametrize("windows", [WINDOWS, SUMMING])
def test_gradient_vanishes(weight, windows):
    """Of the sum of log-densities less the prior, by finite differences in all numbers of A and b."""
    world, units = noisy_world(0, windows=windows), _units(0)
    center = draw_transform(np.random.default_rng(1), 3, 0.1)
    prior = {"weight": weight, "center": center, "units": units}
    rows = rows_of(estimate_transform(sum_world(world, windows=windows), **prior))

    def value(rows):
        transform = _transform_of(rows)
        return brute_objective(world, transform, windows) - transform_penalty([transform], **prior)

    steps = 1e-5 * np.eye(rows.size).reshape(-1, *rows.shape)
    gradient = [(value(rows + step) - value(rows - step)) / 2e-5 for step in steps]
    # Slopes of one term alone are hundreds; differences of values of 1e3 leave 1e-7 or so.
    assert np.abs(gradient).max() < 1e-5
    curvature = [value(rows + 1e3 * step) for step in steps]
    assert max(curvature) < value(rows)


problems = {
    "seed": st.integers(0, 2**32 - 1),
    "n_channels": st.integers(1, 5),
    "n_frames": st.integers(12, 60),
    "size": st.sampled_from([0.1, 0.5, 1.5]),
}


@settings(deadline=None)
@given(**problems, weight=st.sampled_from([1e-3, 1.0, 100.0]))
def test_rows_never_lower_the_objective_and_keep_the_orientation(seed, n_channels, n_frames, size, weight):
    statistics = sum_world(noisy_world(seed, n_channels=n_channels, n_frames=n_frames))
    start = rows_of(draw_transform(np.random.default_rng(seed), n_channels, size))
    quadratic = statistics.quadratic[0] + weight * np.eye(n_channels + 1)
    linear = statistics.linear[0] + weight * np.eye(n_channels, n_channels + 1)
    problem, _ = make_problem(statistics.n_volumes[0], quadratic, linear)
    rows, history = ascend_rows(problem, start, tolerance=-np.inf, max_sweeps=12)
    assert len(history) == 13
    scale = 1e-12 * (np.abs(history[0]) + np.abs(history[-1]))
    assert (np.diff(history) >= -scale).all()
    assert np.linalg.det(rows[:, :-1]) > 0
    polished, left = polish(problem, rows)
    assert objective(problem, polished) >= history[-1] - scale
    assert np.linalg.det(polished[:, :-1]) > 0
    assert left < 1e-8


@settings(deadline=None, max_examples=30)
@given(**problems)
def test_no_transform_near_by_is_better(seed, n_channels, n_frames, size):
    statistics = sum_world(noisy_world(seed, n_channels=n_channels, n_frames=n_frames))
    best = estimate_transform(statistics, weight=1.0)
    value = transform_objective(statistics, [best]) - transform_penalty([best], weight=1.0)
    random = np.random.default_rng(seed)
    for _ in range(20):
        other = _transform_of(rows_of(best) + 0.01 * size * random.normal(size=(n_channels, n_channels + 1)))
        assert transform_objective(statistics, [other]) - transform_penalty([other], weight=1.0) <= value + 1e-9


def test_planted_transforms_are_found_with_errors_as_one_over_root_n():
    sizes, errors = (200, 800, 3200), []
    for n_frames in sizes:
        squares = []
        for seed in range(10):
            random = np.random.default_rng(seed)
            planted = draw_transform(random, 4, 0.3)
            found = estimate_transform(
                sum_world(draw_frames(random, planted, n_frames), windows=STATIC), max_condition=np.inf
            )
            squares.append(np.mean((rows_of(found) - rows_of(planted)) ** 2))
        errors.append(np.sqrt(np.mean(squares)))
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert abs(slope + 0.5) < 0.1, (slope, errors)
    assert errors[-1] < 0.02


def test_one_channel_by_hand():
    """n / a = a sum x^2 / s^2 for mean 0 and no bias to speak of: a maps the variance of x to that of the state."""
    world = np.array([[-3.0], [3.0], [-1.0], [1.0]]), np.ones((4, 1)), np.zeros((1, 1)), np.array([[20.0]])
    found = estimate_transform(sum_world(world, windows=STATIC))
    assert_allclose(found.matrix, [[2.0]])  # 5 -> 20
    assert_allclose(found.bias, [0.0], atol=1e-12)
    # With weight 1: 4 / a - a + ... : 4 / a - (20 / 20) a - (a - 1) = 0, so 2 a^2 - a - 4 = 0.
    held = estimate_transform(sum_world(world, windows=STATIC), weight=1.0)
    assert_allclose(held.matrix, [[(1 + np.sqrt(33)) / 4]])


def test_limits_of_the_prior():
    statistics, center = sum_world(noisy_world(1)), draw_transform(np.random.default_rng(0), 3)
    assert estimate_transform(statistics, weight=np.inf, center=center) is center
    assert_array_equal(estimate_transform(statistics, weight=np.inf).matrix, np.eye(3))
    free = estimate_transform(statistics)
    away = [
        np.abs(rows_of(estimate_transform(statistics, weight=weight, center=center)) - rows_of(center)).max()
        for weight in (1e6, 1e7, 1e8)
    ]
    assert_allclose(np.divide(away[:-1], away[1:]), 10, rtol=1e-2)  # as 1 / weight
    near = rows_of(estimate_transform(statistics, weight=1e-8, center=center))
    assert_allclose(near, rows_of(free), atol=1e-6)
    nothing = sum_world((np.ones((0, 9)), np.ones((0, 2)), np.zeros((2, 9)), np.ones((2, 9))))
    assert estimate_transform(nothing, weight=1.0, center=center) is center


@pytest.mark.parametrize("weight", [0.0, 5.0])
def test_units_and_origin_of_channels_do_not_matter(weight):
    """With scales and origin in the same units."""
    observations, posteriors, means, variances = noisy_world(2)
    move = ChannelTransform(np.diag([1e-3, 1.0, 200.0]), np.array([5.0, -1.0, 30.0]))
    factors = np.tile(np.diag(move.matrix), 3)
    shifts = np.concatenate((move.bias, np.zeros(6)))
    moved = (transform_observations(observations, move), posteriors, means * factors + shifts, variances * factors**2)
    units = _units(2)
    moved_units = StandardUnits(move.apply(units.origin), units.scales * np.diag(move.matrix))
    one = estimate_transform(sum_world((observations, posteriors, means, variances)), weight=weight, units=units)
    other = estimate_transform(sum_world(moved), weight=weight, units=moved_units)
    assert_allclose(rows_of(move.then(other).then(move.inverse())), rows_of(one), atol=1e-7)


def test_without_a_prior_any_linear_change_of_channels_is_taken_back():
    observations, *rest = noisy_world(3)
    change = draw_transform(np.random.default_rng(3), 3)
    one = estimate_transform(sum_world((observations, *rest)), start=change)
    other = estimate_transform(sum_world((transform_observations(observations, change), *rest)))
    assert_allclose(rows_of(change.then(other)), rows_of(one), atol=1e-6)


def test_order_of_channels_does_not_matter():
    observations, posteriors, means, variances = noisy_world(4)
    order = np.array([2, 0, 1])
    features = (np.arange(3)[:, np.newaxis] * 3 + order).ravel()
    shuffled = observations[:, features], posteriors, means[:, features], variances[:, features]
    one = estimate_transform(sum_world((observations, posteriors, means, variances)), weight=2.0)
    other = estimate_transform(sum_world(shuffled), weight=2.0)
    assert_allclose(other.matrix, one.matrix[np.ix_(order, order)], atol=1e-7)
    assert_allclose(other.bias, one.bias[order], atol=1e-7)


def test_classes_of_statistics_are_taken_together():
    world = noisy_world(5)
    parted = sum_world(world, state_classes=[0, 1, 1, 2], n_classes=3)
    assert_allclose(
        rows_of(estimate_transform(parted, weight=1.0)), rows_of(estimate_transform(sum_world(world), weight=1.0))
    )


def test_a_better_start_is_never_lost():
    statistics = sum_world(noisy_world(6, n_frames=15))
    random = np.random.default_rng(6)
    for _ in range(10):
        start = draw_transform(random, 3, 1.0)
        found = estimate_transform(statistics, weight=0.1, start=start, max_condition=np.inf)
        before, after = (
            transform_objective(statistics, [part]) - transform_penalty([part], weight=0.1) for part in (start, found)
        )
        assert after >= before


def test_many_channels_of_few_frames_still_and_moving():
    """66 channels, from 1e-3 to 0.5 rad, which 12 oscillations make, in 300 frames: the gradient still vanishes."""
    random = np.random.default_rng(0)
    phases = np.arange(300)[:, np.newaxis] * 2 * np.pi / 60 * np.arange(1, 7)
    scales = np.geomspace(1e-3, 0.5, 66)
    waves = np.column_stack((np.cos(phases), np.sin(phases))) @ random.normal(size=(12, 66))
    c = (waves + 0.05 * random.normal(size=waves.shape)) * scales + random.normal(size=66) * scales
    posteriors = np.eye(30)[np.arange(300) // 10]
    target = ChannelTransform(np.eye(66) + 0.1 * random.normal(size=(66, 66)) * scales[:, np.newaxis] / scales, scales)
    z = target.apply(c)
    means = posteriors.T @ z / 10
    variances = scales**2 * random.uniform(0.02, 0.1, means.shape)
    units = standard_units(66, origin=c.mean(axis=0), scales=c.std(axis=0))
    world = (c, posteriors, means, variances)
    found = estimate_transform(sum_world(world, windows=STATIC), weight=10.0, units=units)

    def value(step):  # a step in standard units
        rows = rows_of(found) + step * units.scales[:, np.newaxis] / np.append(units.scales, np.inf)
        rows[:, -1] += step[:, -1] * units.scales - (rows - rows_of(found))[:, :-1] @ units.origin
        moved = _transform_of(rows)
        return brute_objective(world, moved, STATIC) - transform_penalty([moved], weight=10.0, units=units)

    for _ in range(10):
        direction = random.normal(size=(66, 67)) / 66
        slope = (value(1e-4 * direction) - value(-1e-4 * direction)) / 2e-4
        curve = (value(1e-4 * direction) + value(-1e-4 * direction) - 2 * value(0 * direction)) / 1e-8
        assert curve < 0
        assert abs(slope) < 1e-5 * abs(curve)  # 1e-5 standard units from the top
    assert np.linalg.det(found.matrix) > 0


def test_too_few_frames_are_told():
    statistics = sum_world(noisy_world(7, n_channels=8, n_frames=8, windows=STATIC), windows=STATIC)
    with pytest.raises(ValueError, match=r"8\.0 frames for 8 channels.*raise the weight of the prior above 0"):
        estimate_transform(statistics)
    assert np.linalg.det(estimate_transform(statistics, weight=1.0).matrix) > 0


def test_a_channel_that_stands_still_is_told():
    observations, *rest = noisy_world(8, windows=STATIC)
    observations[:, 1] = 0.0
    with pytest.raises(ValueError, match="do not determine the transform"):
        estimate_transform(sum_world((observations, *rest), windows=STATIC))


def test_channels_that_blow_up_are_told():
    """A channel that hardly moves, in states where it does."""
    observations, posteriors, means, variances = noisy_world(8, windows=STATIC)
    observations[:, 0] *= 1e-5
    with pytest.warns(UserWarning, match=r"nearly singular.*raise the weight above 0"):
        estimate_transform(sum_world((observations, posteriors, means, variances), windows=STATIC))


def test_wrong_arguments_are_told():
    statistics = sum_world(noisy_world(9))
    with pytest.raises(ValueError, match=r"weight must not be negative, got -1\.0"):
        estimate_transform(statistics, weight=-1.0)
    mirror = ChannelTransform(np.diag([-1.0, 1, 1]), np.zeros(3))
    with pytest.raises(ValueError, match="center must be a transform with a positive determinant, got one of sign -1"):
        estimate_transform(statistics, weight=1.0, center=mirror)
    with pytest.raises(ValueError, match="start must be"):
        estimate_transform(statistics, start=mirror)
    with pytest.raises(ValueError, match=r"got \[0\.0\] for channels \[1\]; leave channels"):
        standard_units(2, scales=[1.0, 0.0])
    with pytest.raises(ValueError, match=r"each of 3 channels, got shapes \(3,\) and \(2,\)"):
        estimate_transform(statistics, units=StandardUnits(np.zeros(3), np.ones(2)))


def test_the_penalty_is_that_of_channels_in_standard_units():
    units = StandardUnits(np.array([10.0]), np.array([2.0]))
    # 3 c - 20 maps the origin to itself; 3 c - 16 moves it by two units.
    assert transform_penalty([ChannelTransform(np.array([[3.0]]), np.array([-20.0]))], weight=1.0, units=units) == 2
    assert transform_penalty([ChannelTransform(np.array([[3.0]]), np.array([-16.0]))], weight=1.0, units=units) == 4
    assert transform_penalty([identity_transform(1)], weight=np.inf, units=units) == 0
