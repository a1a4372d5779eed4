"""Durations of the states that walkers share."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.hsmm.canonical_durations import fit_canonical_durations
from eigenwalker.hsmm.duration import fit_durations, log_durations
from eigenwalker.hsmm.duration_transform import (
    DurationTransform,
    expected_log_durations,
    identity_durations,
    transformed_durations,
)
from tests.hsmm.planted import draw_parameters


def _world(seed):
    """Return states, and transforms of three walkers."""
    random = np.random.default_rng(seed)
    durations = [DurationTransform(random.uniform(0.8, 1.2, 1), random.normal(0, 0.3, 1)) for _ in range(3)]
    return draw_parameters(random, n_states=4, n_features=2), durations


def test_canonical_durations_of_equal_walkers_are_the_plain_ones():
    parameters, _ = _world(4)
    counts = [np.random.default_rng(seed).multinomial(30, np.full(12, 1 / 12), size=4).astype(float) for seed in (0, 1)]
    equal = [identity_durations()] * 2
    one = fit_canonical_durations(counts, equal, parameters, duration_classes=np.zeros(4, dtype=int))
    plain = fit_durations(sum(counts), parameters.duration_means, parameters.duration_variances)
    for mine, theirs in zip(one, plain, strict=True):
        assert_allclose(mine, theirs, rtol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_canonical_durations_never_become_less_likely(seed):
    random = np.random.default_rng(seed)
    parameters, durations = _world(seed)
    parameters = parameters._replace(duration_variances=parameters.duration_variances * random.choice([0.1, 1, 5], 4))
    counts = []
    for own in durations:
        logs = log_durations(*transformed_durations(own, parameters.duration_means, parameters.duration_variances))
        counts.append(np.array([random.multinomial(9, np.exp(row) / np.exp(row).sum()) for row in logs], dtype=float))
    counts[0][2] = 0

    def value(means, variances):
        pairs = [transformed_durations(own, means, variances) for own in durations]
        return np.sum([expected_log_durations(own, *pair) for own, pair in zip(counts, pairs, strict=True)], axis=0)

    classes = np.zeros(4, dtype=int)
    found = fit_canonical_durations(counts, durations, parameters, duration_classes=classes)
    assert (value(*found) >= value(*parameters[2:])).all()
    assert value(*found).sum() > value(*parameters[2:]).sum()
    floored = fit_canonical_durations(counts, durations, parameters, duration_classes=classes, floor=7.0)
    assert (floored[1] >= 7).all()
    unseen = [np.zeros_like(part) for part in counts]
    kept = fit_canonical_durations(unseen, durations, parameters, duration_classes=classes)
    assert_array_equal(kept[0], parameters.duration_means)
    assert_array_equal(kept[1], parameters.duration_variances)
