"""M step, floors and embedded EM."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import WalkError
from eigenwalker.hsmm import (
    ObservedWalk,
    StateParameters,
    accumulate_walk,
    add_statistics,
    append_dynamics,
    certain_posterior,
    expect_statistics,
    fit_durations,
    fit_states,
    log_densities,
    log_durations,
    maximize_likelihood,
    start_parameters,
    variance_floors,
)
from tests.hsmm.planted import draw_parameters, draw_walk, draw_walks
from tests.hsmm.reference import enumerate_states

_CHAINS = ((0, 1, 2, 1, 3), (0, 1, 2, 3), (0, 2, 1, 3))


def _world(seed, *, n_walks=6, **settings_of_states):
    """Return planted parameters, and walks through shared states."""
    random = np.random.default_rng(seed)
    planted = draw_parameters(random, n_states=4, **({"n_features": 3} | settings_of_states))
    return planted, *draw_walks(random, planted, [_CHAINS[at % 3] for at in range(n_walks)])


def _disturb(random, parameters):
    """Return parameters to start from that are off, and have a path for every walk."""
    means, variances, duration_means, duration_variances = parameters
    return StateParameters(
        means + random.normal(0, 1, means.shape),
        variances * random.uniform(0.5, 3, variances.shape),
        duration_means * random.uniform(0.8, 1.2, len(duration_means)),
        duration_variances + 4,
    )


def _same(one, other, **tolerances):
    for mine, theirs in zip(one, other, strict=True):
        assert_allclose(mine, theirs, **tolerances)


@settings(deadline=None, max_examples=25)
@given(
    seed=st.integers(0, 2**32 - 1), duration=st.sampled_from([2.0, 4.0, 8.0]), spread=st.sampled_from([0.0, 0.5, 3.0])
)
def test_em_never_lowers_the_likelihood(seed, duration, spread):
    planted, walks, _ = _world(seed, duration=duration, spread=spread)
    start = _disturb(np.random.default_rng(seed), planted)
    history = fit_states(walks, start, max_iter=12, tol=-np.inf).log_likelihoods
    assert len(history) == 13
    assert (np.diff(history) >= -1e-9 * np.abs(history[1:])).all()  # what rounding may lower


@settings(deadline=None, max_examples=60)
@given(
    counts=st.lists(st.floats(0, 10), min_size=1, max_size=12).filter(lambda counts: sum(counts) > 0.1),
    mean=st.floats(1, 12),
    variance=st.floats(0.05, 20),
)
def test_durations_never_become_less_likely(counts, mean, variance):
    counts = np.round(counts, 3)
    fitted = fit_durations(counts[np.newaxis], [mean], [variance])

    def expected_log(means, variances):
        logs = np.full(max(len(counts), 200), -np.inf)
        row = log_durations(means, variances)[0]
        logs[: len(row)] = row
        return np.sum(counts[counts > 0] * logs[: len(counts)][counts > 0])

    assert expected_log(*fitted) >= expected_log([mean], [variance])


def test_durations_match_the_moments_of_counts():
    """The largest likelihood in this family, as long as 6 standard deviations cut nothing off."""
    counts = np.array([[0.0, 1, 4, 9, 7, 2, 0.5], [0, 0, 0.2, 3, 1, 0, 0]])
    days = np.arange(1, 8)
    shares = np.exp(log_durations(*fit_durations(counts, [3.0, 3.0], [4.0, 4.0])))
    for power in (1, 2):
        wanted = counts @ days**power / counts.sum(axis=1)
        assert_allclose(shares @ np.arange(1, shares.shape[1] + 1) ** power, wanted, rtol=1e-3)


def test_planted_parameters_are_found_with_errors_as_one_over_root_n():
    sizes, errors = (24, 96, 384), []
    for n_walks in sizes:
        squares = []
        for seed in range(6):
            planted, walks, edges = _world(seed, n_walks=n_walks)
            start = start_parameters(walks, edges, n_states=4, n_duration_states=4)
            fitted = fit_states(walks, start, max_iter=15).parameters
            scaled = (
                (fitted.means - planted.means) / np.sqrt(planted.variances),
                fitted.variances / planted.variances - 1,
                (fitted.duration_means - planted.duration_means) / np.sqrt(planted.duration_variances),
                fitted.duration_variances / planted.duration_variances - 1,
            )
            squares.append([np.mean(part**2) for part in scaled])
        errors.append(np.sqrt(np.mean(squares, axis=0)))
    slopes = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert (np.abs(slopes + 0.5) < 0.2).all(), slopes  # six worlds: slopes scatter by 0.1 or so
    assert (errors[-1] < [0.05, 0.06, 0.08, 0.15]).all(), errors[-1]


def test_units_and_origin_do_not_matter():
    planted, walks, _ = _world(1)
    start = _disturb(np.random.default_rng(1), planted)
    units, origin = np.array([1e-3, 1.0, 50.0]), np.array([0.0, 100.0, -3.0])
    moved_walks = [walk._replace(observations=walk.observations * units + origin) for walk in walks]
    moved_start = start._replace(means=start.means * units + origin, variances=start.variances * units**2)
    one, other = fit_states(walks, start), fit_states(moved_walks, moved_start)
    n_frames = sum(len(walk.observations) for walk in walks)
    assert_allclose(other.log_likelihoods, one.log_likelihoods - n_frames * np.log(units).sum(), rtol=1e-9)
    assert_allclose(other.parameters.means, one.parameters.means * units + origin, rtol=1e-9, atol=1e-9)
    assert_allclose(other.parameters.variances, one.parameters.variances * units**2, rtol=1e-8)
    _same(other.parameters[2:], one.parameters[2:], rtol=1e-8)


def test_numbering_of_states_does_not_matter():
    planted, walks, _ = _world(2)
    order = np.array([2, 0, 3, 1])  # new number of each state
    start = _disturb(np.random.default_rng(2), planted)
    renumbered = [walk._replace(states=order[walk.states], duration_states=order[walk.states]) for walk in walks]
    inverse = np.argsort(order)
    other = fit_states(renumbered, StateParameters(*(part[inverse] for part in start)))
    _same(StateParameters(*(part[order] for part in other.parameters)), fit_states(walks, start).parameters, rtol=1e-9)


def test_order_of_walks_and_threads_do_not_matter():
    planted, walks, _ = _world(3, n_walks=9)
    start = _disturb(np.random.default_rng(3), planted)
    once, again, threads = (fit_states(walks, start, n_jobs=n_jobs) for n_jobs in (None, 1, 2))
    for other in (again, threads):
        assert_array_equal(other.log_likelihoods, once.log_likelihoods)
        for mine, theirs in zip(other.parameters, once.parameters, strict=True):
            assert_array_equal(mine, theirs)
    _same(fit_states(walks[::-1], start).parameters, once.parameters, rtol=1e-7)  # sums round in another order


def test_durations_may_be_shared_otherwise_than_observations():
    planted, walks, edges = _world(4)
    tied = [walk._replace(duration_states=np.zeros_like(walk.states)) for walk in walks]
    parameters = start_parameters(tied, edges, n_states=4, n_duration_states=1)
    lengths = np.concatenate([np.diff(part) for part in edges])
    assert_allclose(parameters.duration_means, lengths.mean(), rtol=0.01)
    assert fit_states(tied, parameters).parameters.means.shape == planted.means.shape


def test_sums_of_known_cuts_by_hand():
    walk = ObservedWalk("a", np.array([[1.0], [2.0], [6.0], [np.nan]]), np.array([0, 1]), np.array([0, 0]))
    statistics = accumulate_walk(walk, certain_posterior([0, 2, 4]), n_states=3, n_duration_states=1)
    assert_array_equal(statistics.counts[:, 0], [2, 1, 0])
    assert_array_equal(statistics.sums[:, 0], [3, 6, 0])
    assert_array_equal(statistics.squares[:, 0], [5, 36, 0])
    assert_array_equal(statistics.duration_counts, [[0, 2]])
    before = StateParameters(np.full((3, 1), 7.0), np.full((3, 1), 2.0), np.array([4.0]), np.array([1.0]))
    after = maximize_likelihood(statistics, before, floors=0.1)
    assert_allclose(after.means[:, 0], [1.5, 6, 7])
    assert_allclose(after.variances[:, 0], [0.25, 0.1, 2])
    assert_allclose(after.duration_means, 2)


def test_sums_of_different_widths_add():
    walk, _ = draw_walk(np.random.default_rng(0), _world(0)[0], (0, 1))
    parts = [
        accumulate_walk(walk, certain_posterior(cut), n_states=4, n_duration_states=4)
        for cut in ([0, 1, len(walk.observations)], [0, 4, len(walk.observations)])
    ]
    both = add_statistics(*parts)
    assert both.n_frames == 2 * len(walk.observations)
    assert both.duration_counts.sum() == 4
    assert_array_equal(both.duration_counts, add_statistics(*parts[::-1]).duration_counts)


def test_expected_sums_hold_every_frame_and_every_position():
    planted, walks, _ = _world(5)
    statistics = expect_statistics(walks[0], planted)
    assert_allclose(statistics.counts.sum(axis=0), len(walks[0].observations), rtol=1e-12)
    assert_allclose(statistics.sums.sum(axis=0), walks[0].observations.sum(axis=0), rtol=1e-9)
    assert_allclose(statistics.duration_counts.sum(), len(walks[0].states), rtol=1e-12)


def test_expected_sums_are_those_over_every_path():
    """Of a short walk that passes two of its states twice."""
    planted, _, _ = _world(12, duration=2.0)
    chain = (0, 1, 0, 1)
    walk, _ = draw_walk(np.random.default_rng(12), planted, chain)
    statistics = expect_statistics(walk, planted)
    terms = log_densities(walk.observations, planted.means, planted.variances)
    durations = log_durations(planted.duration_means, planted.duration_variances)
    likelihood, states, counts, *_ = enumerate_states(terms[list(chain)], durations[list(chain)])
    shares = np.stack([states[:, ::2].sum(axis=1), states[:, 1::2].sum(axis=1)])  # of states 0 and 1
    assert statistics.log_likelihood == pytest.approx(likelihood, rel=1e-10)
    assert_allclose(statistics.counts[:2, 0], shares.sum(axis=1), atol=1e-10)
    assert_allclose(statistics.sums[:2], shares @ walk.observations, atol=1e-10)
    assert_allclose(statistics.squares[:2], shares @ walk.observations**2, atol=1e-10)
    assert_allclose(statistics.duration_counts[:2], [counts[::2].sum(axis=0), counts[1::2].sum(axis=0)], atol=1e-10)
    assert not statistics.counts[2:].any()


def test_walks_with_dynamics_learn_from_whole_windows():
    _, walks, edges = _world(6, n_features=2)
    dynamic = [walk._replace(observations=append_dynamics(walk.observations)) for walk in walks]
    floors = variance_floors(dynamic)
    start = start_parameters(dynamic, edges, n_states=4, n_duration_states=4, floors=floors)
    fitted = fit_states(dynamic, start, floors=floors)
    assert all(np.isfinite(part).all() for part in fitted.parameters)
    static = start_parameters(walks, edges, n_states=4, n_duration_states=4)
    assert_allclose(start.means[:, :2], static.means)


def test_floors_hold_for_channels_that_do_not_move():
    _, walks, edges = _world(7)
    still = [
        walk._replace(observations=np.column_stack((walk.observations, np.full(len(walk.observations), 3.0))))
        for walk in walks
    ]
    floors = variance_floors(still, relative=0.02, absolute=1e-4)
    spread = np.concatenate([walk.observations for walk in walks]).var(axis=0)
    assert_allclose(floors, [*(0.02 * spread), 1e-4])
    start = start_parameters(still, edges, n_states=4, n_duration_states=4, floors=floors)
    fitted = fit_states(still, start, floors=floors).parameters
    assert (fitted.variances >= floors).all()
    assert_allclose(fitted.variances[:, 3], 1e-4)
    with pytest.raises(ValueError, match=r"4 are zero, of feature 3 of state 0.*give floors"):
        fit_states(still, start)


def test_duration_floor_holds():
    _, walks, edges = _world(8)
    start = start_parameters(walks, edges, n_states=4, n_duration_states=4)
    assert (fit_states(walks, start, duration_floor=9.0).parameters.duration_variances >= 9.0).all()


def test_convergence_and_report():
    planted, walks, _ = _world(9)
    seen = []
    fitted = fit_states(walks, planted, max_iter=50, report=lambda *entry: seen.append(entry))
    assert fitted.converged
    n_frames = sum(len(walk.observations) for walk in walks)
    assert seen == list(enumerate(fitted.log_likelihoods / n_frames))
    assert_allclose(sum(expect_statistics(walk, fitted.parameters)[0] for walk in walks), fitted.log_likelihoods[-1])
    short = fit_states(walks, planted, max_iter=0)
    assert not short.converged
    _same(short.parameters, planted, rtol=1e-12)


def test_every_walk_without_a_path_is_named():
    planted, walks, _ = _world(10)
    broken = [walks[0]._replace(name="cut", observations=walks[0].observations[:2]), walks[1]]
    broken.append(broken[0]._replace(name="also cut"))
    with pytest.raises(WalkError, match=r"(?s)walk 'cut'.*got 2.*walk 'also cut'.*got 2"):
        fit_states(broken, planted)


def test_what_does_not_fit_is_told_at_once():
    planted, walks, _ = _world(11)
    wrong = [
        walks[0]._replace(name="narrow", observations=walks[0].observations[:, :2]),
        walks[1]._replace(name="far", states=walks[1].states + 2),
        walks[2]._replace(name="short", duration_states=walks[2].states[:-1]),
    ]
    with pytest.raises(ValueError, match=r"(?s)'narrow': expected 3 features.*'far'.*\[4, 5\].*'short': .*4 and 3"):
        fit_states(wrong, planted)
    with pytest.raises(ValueError, match="at least one walk"):
        fit_states([], planted)
