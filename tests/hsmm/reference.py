"""Hidden semi-Markov models in the plainest way: every path written down; and messages in NumPy."""

import itertools

import numpy as np
from scipy.special import logsumexp

__all__ = ["all_paths", "enumerate_states", "numpy_messages"]


def all_paths(n_positions, n_frames, n_durations):
    """Yield the durations of every way to cut a walk."""
    for durations in itertools.product(range(1, n_durations + 1), repeat=n_positions):
        if sum(durations) == n_frames:
            yield durations


def enumerate_states(log_densities, log_durations):
    """Return log-likelihood, state posteriors, duration counts, and the best path with its log-probability.

    log_densities : (n_positions, n_frames)
    """
    n_positions, n_frames = log_densities.shape
    paths, logs = [], []
    for durations in all_paths(n_positions, n_frames, log_durations.shape[1]):
        edges = np.concatenate(([0], np.cumsum(durations)))
        value = sum(
            log_durations[k, d - 1] + log_densities[k, edges[k] : edges[k + 1]].sum() for k, d in enumerate(durations)
        )
        if value > -np.inf:
            paths.append(edges)
            logs.append(value)
    likelihood = logsumexp(logs)
    states, counts = np.zeros((n_frames, n_positions)), np.zeros_like(log_durations)
    for edges, value in zip(paths, logs, strict=True):
        weight = np.exp(value - likelihood)
        for k in range(n_positions):
            states[edges[k] : edges[k + 1], k] += weight
            counts[k, edges[k + 1] - edges[k] - 1] += weight
    return likelihood, states, counts, paths[int(np.argmax(logs))], max(logs)


def _log_sum(terms):
    """Return logsumexp over the last axis, without the checks that make scipy's several times slower."""
    tops = terms.max(axis=1)
    tops[tops == -np.inf] = 0.0
    return np.log(np.exp(terms - tops[:, np.newaxis]).sum(axis=1)) + tops


def numpy_messages(cumulated, log_durations):
    """Return log-likelihood, state posteriors and duration counts by messages, all boundaries of a position at once."""
    n_positions, n_boundaries = cumulated.shape
    n_durations = log_durations.shape[1]
    never = np.full(n_durations, -np.inf)
    alpha = np.full((n_positions + 1, n_boundaries), -np.inf)
    beta = np.full((n_positions + 1, n_boundaries), -np.inf)
    alpha[0, 0] = beta[-1, -1] = 0.0
    for k in range(n_positions):
        x = np.concatenate((never, alpha[k] - cumulated[k]))
        # Row e holds x at e - n_durations, ..., e - 1: (n_boundaries, n_durations)
        windows = np.lib.stride_tricks.sliding_window_view(x, n_durations)[:n_boundaries]
        with np.errstate(divide="ignore"):
            alpha[k + 1] = cumulated[k] + _log_sum(windows + log_durations[k, ::-1])
    likelihood = alpha[-1, -1]
    counts = np.empty_like(log_durations)
    for k in range(n_positions - 1, -1, -1):
        x = np.concatenate((beta[k + 1] + cumulated[k], never))
        terms = np.lib.stride_tricks.sliding_window_view(x, n_durations)[1 : n_boundaries + 1] + log_durations[k]
        with np.errstate(divide="ignore"):
            beta[k] = _log_sum(terms) - cumulated[k]
        counts[k] = np.exp(terms + (alpha[k] - cumulated[k] - likelihood)[:, np.newaxis]).sum(axis=0)
    on = np.cumsum(np.exp(alpha + beta - likelihood), axis=1)[:, :-1]  # started before or at a frame
    return likelihood, (on[:-1] - on[1:]).T, counts
