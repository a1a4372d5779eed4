"""Sums over walks from which states are estimated: how often, where, how wide, how long.

Positions of the chains of all walks that are the same state add to the same row, which is all there is to tying.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from eigenwalker.hsmm.inference import Posterior

__all__ = ["ObservedWalk", "Statistics", "accumulate_walk", "add_statistics"]


class ObservedWalk(NamedTuple):
    """One walk, as estimation takes it.

    Attributes
    ----------
    name : str
        What the walk is called in an error.
    observations : ndarray of shape (n_frames, n_features)
        Static channels and their dynamics; NaN is what was not observed.
    states : ndarray of int of shape (n_positions,)
        State of each position of the walk's chain, which owns a Gaussian of observations.
    duration_states : ndarray of int of shape (n_positions,)
        The same for the Gaussian of durations, which may be shared in another way.
    """

    name: str
    observations: NDArray[np.floating]
    states: NDArray[np.integer]
    duration_states: NDArray[np.integer]


class Statistics(NamedTuple):
    """Sums over frames and walks, weighted by posteriors.

    Attributes
    ----------
    log_likelihood : float
        Of all walks together.
    n_frames : int
        In all walks together.
    counts : ndarray of shape (n_states, n_features)
        Frames in each state in which each feature was observed.
    sums, squares : ndarray of shape (n_states, n_features)
        Of the observed values and of their squares.
    duration_counts : ndarray of shape (n_duration_states, n_durations)
        How often each state lasts d frames, in column d - 1.
    """

    log_likelihood: float
    n_frames: int
    counts: NDArray[np.float64]
    sums: NDArray[np.float64]
    squares: NDArray[np.float64]
    duration_counts: NDArray[np.float64]


def accumulate_walk(walk: ObservedWalk, posterior: Posterior, *, n_states: int, n_duration_states: int) -> Statistics:
    """Return the sums of one walk.

    Parameters
    ----------
    walk : ObservedWalk
        The walk.
    posterior : Posterior
        From `infer_states`, or from `certain_posterior`.
    n_states, n_duration_states : int
        Number of all states, those of other walks included.

    Returns
    -------
    Statistics
    """
    observations = np.ascontiguousarray(walk.observations, dtype=np.float64)
    n_frames, n_features = observations.shape
    counts, sums, squares = np.zeros((3, n_states, n_features))
    whole = np.isfinite(observations.sum(axis=1))
    # (n_positions, n_frames)
    weights = np.ascontiguousarray(posterior.state_posteriors.T)
    _add_frames(observations, whole, weights, np.asarray(walk.states, dtype=np.int64), counts, sums, squares)
    durations = np.zeros((n_duration_states, posterior.duration_counts.shape[1]))
    np.add.at(durations, walk.duration_states, posterior.duration_counts)
    return Statistics(posterior.log_likelihood, n_frames, counts, sums, squares, durations)


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _add_frames(observations, whole, weights, states, counts, sums, squares):
    """Add the frames of each position to its state; frames whose weight is zero are not read."""
    n_positions, n_frames = weights.shape
    n_features = observations.shape[1]
    for position in range(n_positions):
        state, total = states[position], 0.0
        for frame in range(n_frames):
            weight = weights[position, frame]
            if weight == 0.0:
                continue
            if whole[frame]:
                total += weight
                for i in range(n_features):
                    value = weight * observations[frame, i]
                    sums[state, i] += value
                    squares[state, i] += value * observations[frame, i]
                continue
            for i in range(n_features):
                value = observations[frame, i]
                if not np.isnan(value):
                    counts[state, i] += weight
                    sums[state, i] += weight * value
                    squares[state, i] += weight * value * value
        for i in range(n_features):
            counts[state, i] += total


def add_statistics(one: Statistics, other: Statistics) -> Statistics:
    """Return the sums of both; the one with fewer durations has none of the longer ones."""
    width = max(one.duration_counts.shape[1], other.duration_counts.shape[1])
    durations = [
        np.pad(part, ((0, 0), (0, width - part.shape[1]))) for part in (one.duration_counts, other.duration_counts)
    ]
    return Statistics(
        one.log_likelihood + other.log_likelihood,
        one.n_frames + other.n_frames,
        one.counts + other.counts,
        one.sums + other.sums,
        one.squares + other.squares,
        durations[0] + durations[1],
    )
