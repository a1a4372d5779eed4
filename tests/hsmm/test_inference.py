"""Likelihood, posteriors and alignment of chains of segments."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.stats import norm

from eigenwalker import WalkError
from eigenwalker.hsmm import (
    accumulate_over_time,
    align_states,
    certain_posterior,
    duration_support,
    infer_states,
    log_densities,
    log_durations,
    reachable_starts,
    sum_paths,
)
from tests.hsmm.reference import enumerate_states, numpy_messages


def _chain(seed, *, n_positions, n_frames, scale=1.0):
    """Return log-densities, and log-probabilities of durations that are around so many frames together."""
    random = np.random.default_rng(seed)
    means = random.uniform(0.3, 2.0, n_positions) * n_frames / n_positions
    durations = log_durations(means, random.uniform(0.2, 3.0, n_positions))
    return random.normal(0, scale, (n_positions, n_frames)), durations


def _same_states(got, wanted):
    for mine, theirs in zip(got, wanted, strict=True):
        assert_allclose(mine, theirs, rtol=1e-10, atol=1e-10)


@settings(deadline=None, max_examples=60)
@given(
    seed=st.integers(0, 2**32 - 1),
    n_positions=st.integers(1, 4),
    extra=st.integers(0, 6),
    scale=st.sampled_from([0.0, 1.0, 30.0]),
)
def test_all_equals_the_enumeration_of_every_path(seed, n_positions, extra, scale):
    n_frames = n_positions + extra
    densities, durations = _chain(seed, n_positions=n_positions, n_frames=n_frames, scale=scale)
    possible = durations > -np.inf
    lengths = np.arange(1, durations.shape[1] + 1)
    shortest, longest = np.where(possible, lengths, 99).min(axis=1), np.where(possible, lengths, 0).max(axis=1)
    assume(shortest.sum() <= n_frames <= longest.sum())
    likelihood, states, counts, edges, best = enumerate_states(densities, durations)
    cumulated = accumulate_over_time(densities)
    _same_states(infer_states(cumulated, durations), (likelihood, states, counts))
    assert sum_paths(cumulated, durations) == pytest.approx(likelihood, rel=1e-10, abs=1e-10)
    boundaries, log_probability = align_states(cumulated, durations)
    assert log_probability == pytest.approx(best, rel=1e-10, abs=1e-10)
    if scale > 0:  # else paths may be equally likely
        assert_array_equal(boundaries, edges)


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
def test_long_chains_agree_with_messages_in_numpy(scale):
    densities, durations = _chain(3, n_positions=30, n_frames=240, scale=scale)
    cumulated = accumulate_over_time(densities)
    wanted = numpy_messages(cumulated, durations)
    for mine, theirs in zip(infer_states(cumulated, durations), wanted, strict=True):
        assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)  # of 240 frames, whose sums reach 1e4


def test_probabilities_sum_to_one():
    densities, durations = _chain(4, n_positions=20, n_frames=150)
    posterior = infer_states(accumulate_over_time(densities), durations)
    assert_allclose(posterior.state_posteriors.sum(axis=1), 1, atol=1e-12)
    assert_allclose(posterior.duration_counts.sum(axis=1), 1, atol=1e-12)
    lengths = posterior.duration_counts @ np.arange(1, durations.shape[1] + 1)
    assert_allclose(posterior.state_posteriors.sum(axis=0), lengths, atol=1e-10)


def test_a_walk_backwards_has_backward_states():
    densities, durations = _chain(5, n_positions=6, n_frames=40)
    forth = infer_states(accumulate_over_time(densities), durations)
    back = infer_states(accumulate_over_time(densities[::-1, ::-1]), durations[::-1])
    _same_states(back, (forth.log_likelihood, forth.state_posteriors[::-1, ::-1], forth.duration_counts[::-1]))


def test_a_density_common_to_all_states_moves_the_likelihood_alone():
    densities, durations = _chain(6, n_positions=6, n_frames=40)
    common = np.linspace(-3, 2, 40)
    one = infer_states(accumulate_over_time(densities), durations)
    other = infer_states(accumulate_over_time(densities + common), durations)
    _same_states(other, (one.log_likelihood + common.sum(), one.state_posteriors, one.duration_counts))


def test_the_best_path_is_one_of_all():
    densities, durations = _chain(7, n_positions=6, n_frames=40, scale=3.0)
    cumulated = accumulate_over_time(densities)
    boundaries, log_probability = align_states(cumulated, durations)
    lengths = np.diff(boundaries)
    assert boundaries[0] == 0
    assert boundaries[-1] == 40
    path = sum(
        durations[k, length - 1] + densities[k, boundaries[k] : boundaries[k + 1]].sum()
        for k, length in enumerate(lengths)
    )
    assert log_probability == pytest.approx(path, abs=1e-10)
    assert log_probability <= sum_paths(cumulated, durations)


def test_one_state_takes_the_whole_walk():
    densities, durations = np.array([[-1.0, -2.0, -3.0]]), log_durations([3.0], [1.0])
    posterior = infer_states(accumulate_over_time(densities), durations)
    assert posterior.log_likelihood == pytest.approx(-6 + durations[0, 2], abs=1e-12)
    assert_array_equal(posterior.state_posteriors, np.ones((3, 1)))


def test_one_frame():
    posterior = infer_states(np.array([[0.0, -2.0]]), log_durations([1.0], [1e-4]))
    assert posterior.log_likelihood == pytest.approx(-2.0, abs=1e-12)
    assert align_states(np.array([[0.0, -2.0]]), np.zeros((1, 1)))[0].tolist() == [0, 1]


@pytest.mark.parametrize("function", [infer_states, sum_paths, align_states])
@pytest.mark.parametrize("n_frames", [3, 40])
def test_no_path_names_the_walk(function, n_frames):
    durations = log_durations([5.0, 5.0], [0.1, 0.1])
    with pytest.raises(WalkError, match=rf"walk 'short': expected 8 to 12 frames.*got {n_frames}; check"):
        function(np.zeros((2, n_frames + 1)), durations, walk="short")


def test_gaps_in_durations_leave_no_path():
    """Between the shortest and the longest there may be durations that cannot be."""
    odd = np.log(np.array([[0.5, 1e-300, 0.5]]))
    odd[0, 1] = -np.inf
    with pytest.raises(WalkError, match="walk 'even': expected a finite log-likelihood"):
        infer_states(np.zeros((1, 3)), odd, walk="even")
    densities = np.random.default_rng(9).normal(size=(3, 7))  # cut into 1 + 3 + 3 in any order
    odds = np.repeat(odd, 3, axis=0)
    likelihood, states, counts, edges, _ = enumerate_states(densities, odds)
    cumulated = accumulate_over_time(densities)
    _same_states(infer_states(cumulated, odds), (likelihood, states, counts))
    assert_array_equal(align_states(cumulated, odds)[0], edges)


def test_infinite_densities_name_the_walk():
    with pytest.raises(WalkError, match="walk 'wild': expected finite log-densities"):
        infer_states(np.array([[0.0, -np.inf]]), np.zeros((1, 1)), walk="wild")


def test_wrong_shapes():
    with pytest.raises(ValueError, match=r"got \(2, 4\) and \(3, 2\)"):
        infer_states(np.zeros((2, 4)), np.zeros((3, 2)))
    with pytest.raises(ValueError, match="no duration is possible at position 1"):
        infer_states(np.zeros((2, 4)), np.array([[0.0], [-np.inf]]))
    with pytest.raises(ValueError, match=r"rise from 0.*\[0, 2, 2\]"):
        certain_posterior([0, 2, 2])


def test_starts_are_those_that_some_path_has():
    first, last = reachable_starts(np.array([1, 2, 1]), np.array([3, 2, 4]), 7)
    paths = [(0, a, a + 2, 7) for a in (1, 2, 3) if 1 <= 5 - a <= 4]
    assert_array_equal(first, np.min(paths, axis=0))
    assert_array_equal(last, np.max(paths, axis=0))


@pytest.mark.parametrize("n_frames", [1, 2, 5, 8])
def test_densities_are_those_of_scipy(n_frames):
    random = np.random.default_rng(8)
    observations = random.normal(1e3, 1, (n_frames, 7))
    means, variances = random.normal(1e3, 1, (3, 7)), random.uniform(0.1, 2, (3, 7))
    terms = norm.logpdf(observations, means[:, np.newaxis], np.sqrt(variances)[:, np.newaxis])
    assert_allclose(log_densities(observations, means, variances), terms.sum(axis=2), rtol=1e-12)
    observations[-1, 2:4] = np.nan
    wanted = np.nansum(np.where(np.isnan(observations), np.nan, terms), axis=2)
    assert_allclose(log_densities(observations, means, variances), wanted, rtol=1e-12)


def test_densities_refuse_what_does_not_fit():
    with pytest.raises(ValueError, match=r"got \(2, 3\), \(1, 2\) and \(1, 2\)"):
        log_densities(np.zeros((2, 3)), np.zeros((1, 2)), np.ones((1, 2)))
    with pytest.raises(ValueError, match=r"got 0.0 for feature 1 of state 0; estimate them with a floor"):
        log_densities(np.zeros((2, 2)), np.zeros((1, 2)), np.array([[1.0, 0.0]]))


def test_durations_are_normalised_gaussians():
    means, variances = [7.3, 1.2, 30.0], [2.0, 4.0, 1e-6]
    logs = log_durations(means, variances)
    shortest, longest = duration_support(means, variances)
    durations = np.arange(1, logs.shape[1] + 1)
    assert_allclose(np.exp(logs).sum(axis=1), 1, rtol=1e-14)
    assert_array_equal(np.isfinite(logs), (durations >= shortest[:, None]) & (durations <= longest[:, None]))
    assert_allclose(np.diff(logs[0, shortest[0] - 1 : longest[0]], 2), -1 / 2.0)
    assert np.exp(logs[2, 29]) == 1
    assert shortest.tolist() == [1, 1, 30]


@pytest.mark.parametrize(("mean", "variance"), [(np.nan, 1.0), (3.0, 0.0), (3.0, np.inf)])
def test_impossible_durations(mean, variance):
    with pytest.raises(ValueError, match="finite means and positive, finite variances"):
        log_durations([mean], [variance])
