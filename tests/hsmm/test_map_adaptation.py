"""MAP: between the prior and the frames."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.hsmm import StateParameters, accumulate_walk, certain_posterior, maximize_likelihood
from eigenwalker.hsmm.map_adaptation import map_states
from tests.hsmm.planted import draw_parameters, draw_walks

_SIZES = {"n_states": 4, "n_duration_states": 4}


def _world(seed, *, n_walks=3):
    """Return a prior, and sums of walks of other states; state 3 is never seen, nor is one feature at times."""
    random = np.random.default_rng(seed)
    prior, walker = (draw_parameters(random, n_states=4, n_features=3) for _ in range(2))
    walks, edges = draw_walks(random, walker, [(0, 1, 2, 1)] * n_walks)
    parts = []
    for walk, cut in zip(walks, edges, strict=True):
        walk.observations[::3, 2] = np.nan
        parts.append(accumulate_walk(walk, certain_posterior(cut), **_SIZES))
    width = max(part.duration_counts.shape[1] for part in parts)
    total = parts[0]._replace(
        **{name: sum(getattr(part, name) for part in parts) for name in ("counts", "sums", "squares")},
        duration_counts=sum(
            np.pad(p.duration_counts, ((0, 0), (0, width - p.duration_counts.shape[1]))) for p in parts
        ),
    )
    return prior, total


def test_limits():
    prior, statistics = _world(0)
    for adapted, wanted, tolerance in (
        (
            map_states(statistics, prior, weight=0.0, floors=0.3),
            maximize_likelihood(statistics, prior, floors=0.3),
            1e-9,
        ),
        (map_states(statistics, prior, weight=np.inf, floors=9.0, duration_floor=99.0), prior, 0),
        (map_states(statistics, prior, weight=1e9), prior, 1e-5),
    ):
        for mine, theirs in zip(adapted, wanted, strict=True):
            assert_allclose(mine, theirs, rtol=tolerance, atol=tolerance)


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 2**32 - 1), weight=st.floats(0.01, 1e4))
def test_means_lie_between_and_follow_the_counts(seed, weight):
    prior, statistics = _world(seed)
    likely = maximize_likelihood(statistics, prior, floors=1e-9)
    adapted = map_states(statistics, prior, weight=weight, floors=1e-9)
    share = statistics.counts / (statistics.counts + weight)
    assert_allclose(adapted.means, share * likely.means + (1 - share) * prior.means, rtol=1e-9, atol=1e-9)
    between = share * (1 - share) * (likely.means - prior.means) ** 2  # the law of total variance
    seen = statistics.counts > 0
    wanted = np.where(seen, share * likely.variances, 0) + (1 - share) * prior.variances + between
    assert_allclose(adapted.variances, wanted, rtol=1e-7)
    assert_array_equal(adapted.means[3], prior.means[3])


def test_no_other_states_have_a_larger_objective():
    """Of the frames, and `weight` frames of the prior, in expectation."""
    prior, statistics = _world(1)
    weight = 7.0

    def objective(means, variances):
        data = statistics.squares - 2 * means * statistics.sums + statistics.counts * means**2
        drawn = weight * (prior.variances + (prior.means - means) ** 2)
        return -0.5 * (((statistics.counts + weight) * np.log(variances)) + (data + drawn) / variances)

    adapted = map_states(statistics, prior, weight=weight)
    best = objective(adapted.means, adapted.variances)
    for step in (1e-3, -1e-3):
        assert (objective(adapted.means + step, adapted.variances) < best).all()
        assert (objective(adapted.means, adapted.variances * (1 + step)) < best).all()


def test_weights_may_differ_by_feature():
    prior, statistics = _world(2)
    weights = np.array([0.0, 5.0, np.inf])
    adapted = map_states(statistics, prior, weight=weights, duration_weight=2.0, floors=1e-9)
    for feature, weight in enumerate(weights):
        alone = map_states(statistics, prior, weight=weight, floors=1e-9)
        assert_allclose(adapted.means[:, feature], alone.means[:, feature])
        assert_allclose(adapted.variances[:, feature], alone.variances[:, feature])
    with pytest.raises(ValueError, match=r"duration_weight must be given.*shape \(3,\)"):
        map_states(statistics, prior, weight=weights)


def test_durations_lie_between():
    prior, statistics = _world(3, n_walks=8)
    means = [
        map_states(statistics, prior, weight=1.0, duration_weight=weight, floors=1e-9).duration_means
        for weight in (0.0, 1.0, 10.0, 1e3, np.inf)
    ]
    away = np.abs(np.array(means) - prior.duration_means)
    assert (np.diff(away, axis=0) <= 1e-6).all()
    assert_array_equal(away[-1], 0)
    assert_array_equal(away[:, 3] < 1e-9, True)  # never seen


def test_far_from_zero_nothing_cancels():
    prior, statistics = _world(4)
    far = 1e6
    moved = statistics._replace(
        sums=statistics.sums + far * statistics.counts,
        squares=statistics.squares + 2 * far * statistics.sums + far**2 * statistics.counts,
    )
    adapted = map_states(moved, prior._replace(means=prior.means + far), weight=20.0)
    assert (adapted.variances > 0).all()
    wanted = map_states(statistics, prior, weight=20.0)
    assert_allclose(adapted.means - far, wanted.means, atol=1e-6)
    assert_allclose(adapted.variances, wanted.variances, rtol=1e-2)  # squares of 1e12 leave 1e-4 each


def test_negative_weights_are_refused():
    prior, statistics = _world(5)
    with pytest.raises(ValueError, match=r"must not be negative, got -1\.0"):
        map_states(statistics, prior, weight=-1.0)


def test_one_state_by_hand():
    prior = StateParameters(np.array([[2.0]]), np.array([[4.0]]), np.array([3.0]), np.array([1.0]))
    _, statistics = _world(6)
    one = statistics._replace(
        counts=np.array([[3.0]]),
        sums=np.array([[18.0]]),
        squares=np.array([[114.0]]),  # mean 6, variance 2
        duration_counts=np.array([[0.0, 0.0, 1.0]]),
    )
    adapted = map_states(one, prior, weight=1.0)
    assert_allclose(adapted.means, [[5.0]])  # (2 + 18) / 4
    assert_allclose(adapted.variances, [[(4 + 9 + 3 * 2 + 3 * 1) / 4]])
