"""Compiled messages along a chain of segments. Boundaries between frames count from 0 to n_frames, both included.

Row k of the forward messages is about the boundary where position k starts, which is where k - 1 ends, so there is one
row more than positions. `first[k]` and `last[k]` are the earliest and latest boundary at which position k
can start such that the whole walk can still be cut; only those are visited.

Four things make this fast and leave results exact to rounding: with x = alpha - cum all ends of a position go side by
side through the loop over durations, as neighbors in memory; only ends that can be reached are visited; exponentials
below e^-45 = 3e-20 of the largest are left out; and so is, on the way back, every boundary whose posterior is below.
"""

import numpy as np
from numba import njit

__all__ = ["backward", "best_starts", "forward"]

_NATS = 45.0
_FLAGS = {"nnan", "nsz", "reassoc", "contract"}  # not ninf: minus infinity is what cannot happen


@njit(cache=True, nogil=True, fastmath=_FLAGS)
def forward(cumulated, log_durations, shortest, longest, first, last):
    """Return alpha of shape (n_positions + 1, n_frames + 1).

    alpha[k + 1, e] = cum_k[e] + logsumexp_d (alpha[k, e - d] - cum_k[e - d] + log p_k(d))
    """
    n_positions, n_boundaries = cumulated.shape
    alpha = np.full((n_positions + 1, n_boundaries), -np.inf)
    alpha[0, 0] = 0.0
    ahead, tops, totals = np.full(n_boundaries, -np.inf), np.empty(n_boundaries), np.empty(n_boundaries)
    for k in range(n_positions):
        from_start, to_start, from_end, to_end = first[k], last[k], first[k + 1], last[k + 1]
        for start in range(from_start, to_start + 1):
            ahead[start] = alpha[k, start] - cumulated[k, start]
        tops[from_end : to_end + 1], totals[from_end : to_end + 1] = -np.inf, 0.0
        for d in range(shortest[k], longest[k] + 1):
            log_duration = log_durations[k, d - 1]
            for end in range(max(from_end, from_start + d), min(to_end, to_start + d) + 1):
                tops[end] = max(tops[end], ahead[end - d] + log_duration)
        for d in range(shortest[k], longest[k] + 1):
            log_duration = log_durations[k, d - 1]
            for end in range(max(from_end, from_start + d), min(to_end, to_start + d) + 1):
                value = ahead[end - d] + log_duration
                if value > tops[end] - _NATS:  # written so that two infinities never meet
                    totals[end] += np.exp(value - tops[end])
        for end in range(from_end, to_end + 1):
            if totals[end] > 0.0:
                alpha[k + 1, end] = cumulated[k, end] + tops[end] + np.log(totals[end])
    return alpha


@njit(cache=True, nogil=True, fastmath=_FLAGS)
def backward(cumulated, log_durations, alpha, shortest, longest, first, last):
    """Return posteriors of states, shape (n_positions, n_frames), and expected counts of durations.

    beta[k, s] = logsumexp_d (beta[k + 1, s + d] + cum_k[s + d] - cum_k[s] + log p_k(d)), and each term, with alpha
    before it, is the posterior of the segment from s to s + d. A state is on from its starts to those of the next.
    """
    n_positions, n_boundaries = cumulated.shape
    likelihood = alpha[n_positions, n_boundaries - 1]
    states = np.zeros((n_positions, n_boundaries - 1))
    counts = np.zeros_like(log_durations)
    after, terms = np.full(n_boundaries, -np.inf), np.empty(log_durations.shape[1])
    beta, ends, starts = np.empty(n_boundaries), np.zeros(n_boundaries), np.zeros(n_boundaries)
    beta[n_boundaries - 1], ends[n_boundaries - 1] = 0.0, 1.0
    from_end, to_end = n_boundaries - 1, n_boundaries - 1  # where the next position starts, if not below e^-45
    for k in range(n_positions - 1, -1, -1):
        low, high = shortest[k], longest[k]
        for end in range(from_end, to_end + 1):
            after[end] = beta[end] + cumulated[k, end]
        from_start, to_start = n_boundaries, -1
        for start in range(max(first[k], from_end - high), min(last[k], to_end - low) + 1):
            begin, stop = max(from_end, start + low), min(to_end, start + high) + 1
            beta[start], starts[start] = -np.inf, 0.0
            shift = begin - start - 1
            top = -np.inf
            for i in range(stop - begin):
                terms[i] = after[begin + i] + log_durations[k, shift + i]
                top = max(top, terms[i])
            before = alpha[k, start] - cumulated[k, start] - likelihood
            if before + top + np.log(max(stop - begin, 1)) < -_NATS:
                continue
            total = 0.0
            for i in range(stop - begin):
                terms[i] = np.exp(terms[i] - top) if terms[i] > top - _NATS else 0.0
                total += terms[i]
            starts[start] = np.exp(before + top) * total
            beta[start] = top + np.log(total) - cumulated[k, start]
            share = starts[start] / total
            for i in range(stop - begin):
                counts[k, shift + i] += share * terms[i]
            from_start, to_start = min(from_start, start), start
        on = 0.0
        for frame in range(from_start, to_end):
            if frame <= to_start:
                on += starts[frame]
            if frame >= from_end:
                on -= ends[frame]
            states[k, frame] = on if on > 1e-14 else 0.0  # what the running sum leaves of rounding
        for boundary in range(from_end, to_end + 1):
            ends[boundary] = 0.0
        for boundary in range(from_start, to_start + 1):
            ends[boundary], starts[boundary] = starts[boundary], 0.0
        from_end, to_end = from_start, to_start
    return states, counts


@njit(cache=True, nogil=True, fastmath=_FLAGS)
def best_starts(cumulated, log_durations, shortest, longest, first, last):
    """Return the boundaries of the most likely path, shape (n_positions + 1,), and its log-probability.

    The forward messages with max for logsumexp. Of equals the shortest duration is taken.
    """
    n_positions, n_boundaries = cumulated.shape
    best = np.full((n_positions + 1, n_boundaries), -np.inf)
    chosen = np.zeros((n_positions + 1, n_boundaries), dtype=np.int64)
    best[0, 0] = 0.0
    ahead = np.empty(n_boundaries)
    for k in range(n_positions):
        from_start, to_start, from_end, to_end = first[k], last[k], first[k + 1], last[k + 1]
        for start in range(from_start, to_start + 1):
            ahead[start] = best[k, start] - cumulated[k, start]
        for d in range(shortest[k], longest[k] + 1):
            log_duration = log_durations[k, d - 1]
            for end in range(max(from_end, from_start + d), min(to_end, to_start + d) + 1):
                value, so_far = ahead[end - d] + log_duration, best[k + 1, end]
                chosen[k + 1, end] = d if value > so_far else chosen[k + 1, end]
                best[k + 1, end] = max(value, so_far)
        for end in range(from_end, to_end + 1):
            best[k + 1, end] += cumulated[k, end]
    boundaries = np.empty(n_positions + 1, dtype=np.int64)
    boundaries[n_positions] = n_boundaries - 1
    for k in range(n_positions, 0, -1):
        boundaries[k - 1] = boundaries[k] - chosen[k, boundaries[k]]
    return boundaries, best[n_positions, n_boundaries - 1]
