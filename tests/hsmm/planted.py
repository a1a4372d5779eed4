"""Walks drawn from known states: chains of Gaussian segments with Gaussian whole durations."""

import numpy as np

from eigenwalker.hsmm.accumulation import ObservedWalk
from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.estimation import StateParameters

__all__ = ["draw_parameters", "draw_walk", "draw_walks"]


def draw_parameters(random, *, n_states, n_features, duration=6.0, spread=2.0):
    """Return states whose means lie `spread` standard deviations apart or so."""
    return StateParameters(
        random.normal(0, spread, (n_states, n_features)),
        random.uniform(0.5, 2.0, (n_states, n_features)),
        random.uniform(0.8, 1.2, n_states) * duration,
        random.uniform(0.7, 1.5, n_states) ** 2,
    )


def draw_walk(random, parameters, states, name="walk"):
    """Return a walk through a chain of states, and the boundaries of its positions."""
    logs = log_durations(parameters.duration_means, parameters.duration_variances)
    lengths = [random.choice(logs.shape[1], p=np.exp(logs[state])) + 1 for state in states]
    frames = np.repeat(states, lengths)
    observations = random.normal(parameters.means[frames], np.sqrt(parameters.variances[frames]))
    walk = ObservedWalk(name, observations, np.asarray(states), np.asarray(states))
    return walk, np.concatenate(([0], np.cumsum(lengths)))


def draw_walks(random, parameters, chains):
    """Return a walk for each chain, and the boundaries of each."""
    drawn = [draw_walk(random, parameters, chain, f"walk {at}") for at, chain in enumerate(chains)]
    return [walk for walk, _ in drawn], [edges for _, edges in drawn]
