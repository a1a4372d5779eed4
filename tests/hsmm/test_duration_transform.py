"""Transforms of durations, whose probabilities are on whole frames."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.duration_transform import (
    DurationTransform,
    duration_penalty,
    duration_units,
    estimate_duration_transform,
    expected_log_durations,
    identity_durations,
    transformed_durations,
)


def _draw(random, n_durations, *, means, variances, factor, shift):
    """Return counts of durations of states of a walker."""
    logs = log_durations(
        *transformed_durations(DurationTransform(np.array([factor]), np.array([shift])), means, variances)
    )
    return np.array([random.multinomial(n_durations, np.exp(row) / np.exp(row).sum()) for row in logs], dtype=float)


def _value(counts, means, variances, factor, shift, weight=0.0, units=None):
    pair = DurationTransform(np.array([factor]), np.array([shift]))
    value = expected_log_durations(counts, *transformed_durations(pair, means, variances)).sum()
    return value - (duration_penalty(pair, weight, units) if weight else 0.0)


_MEANS, _VARIANCES = np.array([6.0, 9.0, 13.0, 20.0]), np.array([1.0, 2.0, 4.0, 6.0])


@pytest.mark.parametrize("weight", [0.0, 1.0, 100.0])
@pytest.mark.parametrize("variances", [_VARIANCES, 0.1 * _VARIANCES])
def test_gradient_vanishes_on_whole_frames(weight, variances):
    """Narrow durations, for which the continuous density will not do, included."""
    counts = _draw(np.random.default_rng(0), 30, means=_MEANS, variances=variances, factor=1.3, shift=-1.0)
    units = duration_units(_MEANS, variances)
    found = estimate_duration_transform(counts, _MEANS, variances, weight=weight)
    best = factor, shift = found.factors[0], found.shifts[0]
    arguments = counts, _MEANS, variances
    for step in (np.array([1e-4, 0.0]), np.array([0.0, 1e-4])):
        above, below = (_value(*arguments, *(best + sign * step), weight, units) for sign in (1, -1))
        here = _value(*arguments, factor, shift, weight, units)
        curve = (above + below - 2 * here) / 1e-8
        assert abs((above - below) / 2e-4) < 1e-5 * abs(curve)  # 1e-5 from the top
        assert max(above, below) < here


def test_wide_durations_are_those_of_the_continuous_density():
    """1 / a solves a quadratic equation: N / a = P a - R, with e eliminated."""
    means, variances = 10 * _MEANS, 30 * _VARIANCES
    counts = _draw(np.random.default_rng(1), 200, means=means, variances=variances, factor=1.2, shift=5.0)
    d = np.arange(1, counts.shape[1] + 1)
    weights = counts / variances[:, np.newaxis]
    d_mean, m_mean = (weights @ d).sum() / weights.sum(), (weights.sum(axis=1) @ means) / weights.sum()
    square = (weights * (d - d_mean) ** 2).sum()
    product = (weights * (d - d_mean) * (means - m_mean)[:, np.newaxis]).sum()
    factor = (product + np.sqrt(product**2 + 4 * square * counts.sum())) / (2 * square)
    found = estimate_duration_transform(counts, means, variances)
    assert_allclose(found.factors, factor, rtol=1e-4)
    assert_allclose(found.shifts, m_mean - factor * d_mean, rtol=1e-2)


def test_planted_transforms_are_found_with_errors_as_one_over_root_n():
    sizes, errors = (20, 80, 320, 1280), []
    for n_durations in sizes:
        squares = []
        for seed in range(20):
            counts = _draw(
                np.random.default_rng(seed), n_durations, means=_MEANS, variances=_VARIANCES, factor=0.7, shift=2.0
            )
            factors, shifts = estimate_duration_transform(counts, _MEANS, _VARIANCES)
            squares.append([(factors[0] - 0.7) ** 2, (shifts[0] - 2.0) ** 2])
        errors.append(np.sqrt(np.mean(squares, axis=0)))
    slopes = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert (np.abs(slopes + 0.5) < 0.12).all(), (slopes, errors)
    assert (errors[-1] < [0.01, 0.1]).all()


@settings(deadline=None, max_examples=60)
@given(
    seed=st.integers(0, 2**32 - 1),
    factor=st.floats(0.4, 2.5),
    shift=st.floats(-2, 2),
    weight=st.sampled_from([0.0, 3.0]),
    scale=st.sampled_from([0.05, 1.0]),
)
def test_the_start_is_never_lost(seed, factor, shift, weight, scale):
    """Nor are durations that it has and that the model hardly has, one of which is counted here."""
    random = np.random.default_rng(seed)
    start = DurationTransform(np.array([factor]), np.array([shift]))
    variances = scale * _VARIANCES
    counts = _draw(random, 10, means=_MEANS, variances=variances, factor=factor, shift=shift)
    rare = np.flatnonzero(log_durations(*transformed_durations(start, _MEANS[:1], variances[:1]))[0] > -np.inf)[-1]
    counts[0, rare] += 1
    units = duration_units(_MEANS, variances)
    found = estimate_duration_transform(counts, _MEANS, variances, weight=weight, start=start, units=units)
    arguments = counts, _MEANS, variances
    before = _value(*arguments, factor, shift, weight, units)
    after = _value(*arguments, found.factors[0], found.shifts[0], weight, units)
    assert after >= before > -np.inf


def test_limits_of_the_prior():
    counts = _draw(np.random.default_rng(2), 50, means=_MEANS, variances=_VARIANCES, factor=1.5, shift=0.0)
    fixed = estimate_duration_transform(counts, _MEANS, _VARIANCES, weight=np.inf)
    assert_array_equal(fixed.factors, 1)
    assert_array_equal(fixed.shifts, 0)
    strong = estimate_duration_transform(counts, _MEANS, _VARIANCES, weight=1e8)
    assert_allclose(strong.factors, 1, atol=1e-4)
    free, weak = (estimate_duration_transform(counts, _MEANS, _VARIANCES, weight=weight) for weight in (0, 1e-7))
    assert_allclose(np.ravel(weak), np.ravel(free), atol=1e-4)


def test_classes_are_apart():
    random = np.random.default_rng(3)
    one = _draw(random, 40, means=_MEANS, variances=_VARIANCES, factor=1.4, shift=1.0)
    other = _draw(random, 40, means=_MEANS, variances=_VARIANCES, factor=0.8, shift=0.0)
    width = max(one.shape[1], other.shape[1])
    counts = np.concatenate([np.pad(part, ((0, 0), (0, width - part.shape[1]))) for part in (one, other)])
    found = estimate_duration_transform(
        counts, np.tile(_MEANS, 2), np.tile(_VARIANCES, 2), duration_classes=np.repeat([0, 2], 4), n_classes=3
    )
    for group, part in ((0, one), (2, other)):
        alone = estimate_duration_transform(part, _MEANS, _VARIANCES)
        assert found.factors[group] == pytest.approx(alone.factors[0], rel=1e-4)
    assert (found.factors[1], found.shifts[1]) == (1.0, 0.0)  # never seen
    assert_array_equal(identity_durations(2).factors, [1, 1])


def test_speed_alone_scales_durations():
    """Of a walker twice as fast, counted without noise: a is 2 and e is 0 even where states last few frames."""
    counts = 100 * np.exp(log_durations(_MEANS / 2, _VARIANCES / 4))
    found = estimate_duration_transform(counts, _MEANS, _VARIANCES)
    assert_allclose(found.factors, 2, rtol=1e-5)
    assert_allclose(found.shifts, 0, atol=1e-4)


def test_what_cannot_be_is_refused():
    with pytest.raises(ValueError, match=r"durations of 1 states do not determine.*give it a weight"):
        estimate_duration_transform(np.array([[0.0, 0.0, 4.0]]), [5.0], [1.0])
    with pytest.raises(ValueError, match=r"must not be negative, got -2"):
        estimate_duration_transform(np.ones((1, 3)), [5.0], [1.0], weight=-2)
    assert estimate_duration_transform(np.array([[0.0, 0.0, 4.0]]), [5.0], [1.0], weight=1.0).factors[0] > 0


def test_durations_out_of_the_support_count_unless_rare():
    counts = np.zeros((1, 40))
    counts[0, [4, 39]] = 1.0, 1e-9
    assert np.isfinite(expected_log_durations(counts, [5.0], [1.0])).all()
    counts[0, 39] = 0.1
    assert_array_equal(expected_log_durations(counts, [5.0], [1.0]), -np.inf)
