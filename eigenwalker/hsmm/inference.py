"""Which state a walk is in when: likelihood, posteriors and the best alignment of an explicit-duration chain.

A walk passes once through each position k = 0, ..., K - 1 of a chain, which its step labels give. With cum_k the
running sum over time of the log-density of the state at position k,

    alpha[k, e] = cum_k[e] + logsumexp_d (alpha[k - 1, e - d] - cum_k[e - d] + log p_k(d))

is the log-density of the frames before e if position k ends there. The first position starts at the first frame and
the last one ends at the last. All functions take one row a position; states that positions share are repeated.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import WalkError
from eigenwalker.hsmm._messages import backward, best_starts, forward

__all__ = ["Posterior", "align_states", "certain_posterior", "infer_states", "reachable_starts", "sum_paths"]


class Posterior(NamedTuple):
    """What is known of the states of a walk.

    Attributes
    ----------
    log_likelihood : float
        Log-density of the walk, summed over all paths.
    state_posteriors : ndarray of shape (n_frames, n_positions)
        gamma: probability that a frame belongs to each position. Rows sum to one.
    duration_counts : ndarray of shape (n_positions, n_durations)
        Probability that a position lasts d frames, in column d - 1. Rows sum to one.
    """

    log_likelihood: float
    state_posteriors: NDArray[np.float64]
    duration_counts: NDArray[np.float64]


def infer_states(
    cumulated: NDArray[np.floating], log_durations: NDArray[np.floating], *, walk: str = "walk"
) -> Posterior:
    """Return likelihood and posteriors of a walk (the E step, forward and backward).

    Parameters
    ----------
    cumulated : ndarray of shape (n_positions, n_frames + 1)
        Running sums of log-densities, from `accumulate_over_time`.
    log_durations : ndarray of shape (n_positions, n_durations)
        Log-probability of d frames in column d - 1, from `log_durations`.
    walk : str, default "walk"
        What the walk is called in an error.

    Returns
    -------
    Posterior

    Raises
    ------
    WalkError
        If no durations of the positions add up to the length of the walk.

    Examples
    --------
    >>> import numpy as np
    >>> posterior = infer_states(np.zeros((2, 4)), np.log([[0.5, 0.5], [0.5, 0.5]]))
    >>> posterior.state_posteriors
    array([[1. , 0. ],
           [0.5, 0.5],
           [0. , 1. ]])
    """
    cumulated, log_durations, ranges = _prepare(cumulated, log_durations, walk)
    alpha = forward(cumulated, log_durations, *ranges)
    likelihood = _check_possible(float(alpha[-1, -1]), walk)
    states, counts = backward(cumulated, log_durations, alpha, *ranges)
    return Posterior(likelihood, states.T, counts)  # states: (n_frames, n_positions)


def sum_paths(cumulated: NDArray[np.floating], log_durations: NDArray[np.floating], *, walk: str = "walk") -> float:
    """Return the log-likelihood of a walk alone; arguments and errors as of `infer_states`."""
    cumulated, log_durations, ranges = _prepare(cumulated, log_durations, walk)
    return _check_possible(float(forward(cumulated, log_durations, *ranges)[-1, -1]), walk)


def align_states(
    cumulated: NDArray[np.floating], log_durations: NDArray[np.floating], *, walk: str = "walk"
) -> tuple[NDArray[np.int64], float]:
    """Return the most likely path of a walk and its log-probability (Viterbi); arguments as of `infer_states`.

    Returns
    -------
    boundaries : ndarray of int of shape (n_positions + 1,)
        Position k is on in frames boundaries[k], ..., boundaries[k + 1] - 1. Of equally likely durations the shortest
        at the end of the walk is taken first.
    log_probability : float
        Joint log-density of walk and path.

    Raises
    ------
    WalkError
        If no durations of the positions add up to the length of the walk.
    """
    cumulated, log_durations, ranges = _prepare(cumulated, log_durations, walk)
    boundaries, log_probability = best_starts(cumulated, log_durations, *ranges)
    return boundaries, _check_possible(float(log_probability), walk)


def certain_posterior(boundaries: ArrayLike) -> Posterior:
    """Return the posterior of a walk whose path is known, to start from; its likelihood is not (NaN).

    Parameters
    ----------
    boundaries : sequence of int of shape (n_positions + 1,)
        First frame of each position, and the number of frames; rising.

    Returns
    -------
    Posterior

    Raises
    ------
    ValueError
        If the boundaries do not rise from zero.

    Examples
    --------
    >>> certain_posterior([0, 1, 3]).duration_counts
    array([[1., 0.],
           [0., 1.]])
    """
    edges = np.asarray(boundaries)
    durations = np.diff(edges)
    if len(edges) < 2 or edges[0] != 0 or (durations < 1).any():
        raise ValueError(f"boundaries must rise from 0 to the number of frames, got {edges.tolist()}")
    positions = np.arange(len(durations))
    states = np.repeat(np.eye(len(durations)), durations, axis=0)  # (n_frames, n_positions)
    counts = np.zeros((len(durations), durations.max()))
    counts[positions, durations - 1] = 1.0
    return Posterior(float("nan"), states, counts)


def reachable_starts(
    shortest: NDArray[np.integer], longest: NDArray[np.integer], n_frames: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return between which boundaries each position can start if the whole walk is to be cut.

    Parameters
    ----------
    shortest, longest : ndarray of int of shape (n_positions,)
        Durations each position can have, in frames.
    n_frames : int
        Length of the walk.

    Returns
    -------
    first, last : ndarray of int of shape (n_positions + 1,)
        The last of them is about the end of the walk. There is no path where `first` exceeds `last`.

    Examples
    --------
    >>> import numpy as np
    >>> first, last = reachable_starts(np.array([1, 1]), np.array([4, 2]), 5)
    >>> first.tolist(), last.tolist()
    ([0, 3, 5], [0, 4, 5])
    """
    fewest, most = (np.concatenate(([0], np.cumsum(edge))).astype(np.int64) for edge in (shortest, longest))
    first = np.maximum(fewest, n_frames - (most[-1] - most))
    last = np.minimum(most, n_frames - (fewest[-1] - fewest))
    return first, last


class _Ranges(NamedTuple):
    shortest: NDArray[np.int64]
    longest: NDArray[np.int64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]


def _prepare(
    cumulated: NDArray[np.floating], log_durations: NDArray[np.floating], walk: str
) -> tuple[NDArray[np.float64], NDArray[np.float64], _Ranges]:
    """Return what the compiled loops take: contiguous arrays, and the ranges of durations and starts."""
    cumulated, log_durations = (np.ascontiguousarray(array, dtype=np.float64) for array in (cumulated, log_durations))
    if cumulated.ndim != 2 or log_durations.ndim != 2 or len(cumulated) != len(log_durations) or not len(cumulated):
        raise ValueError(
            "expected cumulated of shape (n_positions, n_frames + 1) and log_durations of shape "
            f"(n_positions, n_durations), with at least one position, got {cumulated.shape} and {log_durations.shape}"
        )
    if not np.isfinite(cumulated).all():
        raise WalkError(
            f"walk {walk!r}: expected finite log-densities, got others; check its frames for infinite values"
        )
    possible = log_durations > -np.inf
    if not possible.any(axis=1).all():
        raise ValueError(f"no duration is possible at position {int(possible.any(axis=1).argmin())}")
    shortest = possible.argmax(axis=1) + 1
    longest = possible.shape[1] - possible[:, ::-1].argmax(axis=1)
    n_frames = cumulated.shape[1] - 1
    if not shortest.sum() <= n_frames <= longest.sum():
        raise WalkError(
            f"walk {walk!r}: expected {shortest.sum()} to {longest.sum()} frames, which is what the durations of its "
            f"{len(cumulated)} states can add up to, got {n_frames}; check its step labels and its frame rate"
        )
    first, last = reachable_starts(shortest, longest, n_frames)
    return cumulated, log_durations, _Ranges(shortest, longest, first, last)


def _check_possible(log_likelihood: float, walk: str) -> float:
    if np.isfinite(log_likelihood):
        return log_likelihood
    raise WalkError(
        f"walk {walk!r}: expected a finite log-likelihood, got {log_likelihood}: no possible durations of its states "
        "add up to its length; check its step labels and its frame rate"
    )
