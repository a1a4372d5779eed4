"""Walks of walkers who have transforms of their own, and what transforms are worth, in the plainest way."""

import numpy as np

from eigenwalker.hsmm.accumulation import ObservedWalk
from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.duration_transform import DurationTransform, transformed_durations
from eigenwalker.hsmm.features import WINDOWS, append_dynamics
from eigenwalker.hsmm.observation import log_densities
from eigenwalker.hsmm.transform_statistics import accumulate_transform
from eigenwalker.hsmm.transforms import ChannelTransform

__all__ = [
    "STATIC",
    "brute_objective",
    "draw_frames",
    "draw_transform",
    "draw_walker",
    "noisy_world",
    "rows_of",
    "sum_world",
]

STATIC = ((1.0,),)


def draw_transform(random, n_channels, size=0.2):
    """Return a transform near the identity, of positive determinant."""
    while True:
        matrix = np.eye(n_channels) + random.normal(0, size, (n_channels, n_channels))
        if np.linalg.det(matrix) > 0.1:
            return ChannelTransform(matrix, random.normal(0, size, n_channels))


def rows_of(transform):
    """Return (A b)."""
    return np.column_stack((transform.matrix, transform.bias))


def noisy_world(seed, *, n_channels=3, n_states=4, n_frames=60, windows=WINDOWS, edges=True):
    """Return observations, soft posteriors of states, and their means and variances: any numbers at all."""
    random = np.random.default_rng(seed)
    channels = np.cumsum(random.normal(size=(n_frames, n_channels)), axis=0) * 0.3 + random.normal(size=n_channels)
    observations = append_dynamics(channels, windows=windows)
    observations = observations if edges else observations[2:-2]
    posteriors = random.dirichlet(np.full(n_states, 0.3), len(observations))
    size = (n_states, len(windows) * n_channels)
    return observations, posteriors, random.normal(size=size), random.uniform(0.3, 3.0, size)


def sum_world(world, **settings):
    """Return the statistics of such a world, each column of posteriors a state."""
    observations, posteriors, means, variances = world
    states = np.arange(len(means))
    return accumulate_transform(observations, posteriors, states=states, means=means, variances=variances, **settings)


def brute_objective(world, transform, windows=WINDOWS):
    """Return the sum of posteriors times log-densities of channels, frame by frame."""
    observations, posteriors, means, variances = world
    n_channels = len(transform.bias)
    moved = np.empty_like(observations)
    for number, window in enumerate(windows):
        part = slice(number * n_channels, (number + 1) * n_channels)
        moved[:, part] = observations[:, part] @ transform.matrix.T + sum(window) * transform.bias
    n_windows = np.isfinite(observations).sum(axis=1) / n_channels
    volume = np.log(abs(np.linalg.det(transform.matrix)))
    return float((posteriors.T * (log_densities(moved, means, variances) + n_windows * volume)).sum())


def draw_frames(random, transform, n_frames, *, n_states=6):
    """Return a world of static frames drawn from states, whose channels the transform makes those of the states."""
    n_channels = len(transform.bias)
    means = random.normal(0, 2, (n_states, n_channels))
    variances = random.uniform(0.5, 2.0, (n_states, n_channels))
    states = random.integers(n_states, size=n_frames)
    z = random.normal(means[states], np.sqrt(variances[states]))
    return transform.inverse().apply(z), np.eye(n_states)[states], means, variances


def draw_walker(random, parameters, transform, durations, chain, n_walks, name):
    """Return walks of a walker with transforms, without dynamics."""
    logs = log_durations(
        *transformed_durations(
            DurationTransform(*map(np.atleast_1d, durations)), parameters.duration_means, parameters.duration_variances
        )
    )
    walks = []
    for number in range(n_walks):
        lengths = [random.choice(logs.shape[1], p=np.exp(logs[state])) + 1 for state in chain]
        frames = np.repeat(chain, lengths)
        z = random.normal(parameters.means[frames], np.sqrt(parameters.variances[frames]))
        states = np.asarray(chain)
        walks.append(ObservedWalk(f"{name} {number}", transform.inverse().apply(z), states, states))
    return walks
