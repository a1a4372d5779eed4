"""The splits of a decision tree of contexts, on arrays: sums of sets of contexts, and the best questions."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["FEWEST", "Branch", "Growth", "count_frames", "grow", "log_likelihoods", "pool", "take_sums"]

FEWEST = 1e-6  # frames below which a feature of a context is not seen: what is left of them is rounding
_ROUNDING = 1e-9  # nats per frame and feature by which gains may be off


class Sums(NamedTuple):
    """Of contexts, or of sets of them, one a row; all of shape (n_rows, n_features)."""

    counts: NDArray[np.float64]
    sums: NDArray[np.float64]
    squares: NDArray[np.float64]


class Growth(NamedTuple):
    """What is the same at every leaf."""

    rows: Sums
    answers: NDArray[np.bool_]  # (n_questions, n_contexts)
    floors: NDArray[np.float64]
    penalty: float
    min_count: float

    @property
    def cost(self) -> float:
        """What a leaf costs: penalty n_features log N."""
        totals = self.rows.counts.sum(axis=0)
        return self.penalty * int((totals > 0).sum()) * math.log(max(totals.max(), 1.0))


class Branch(NamedTuple):
    """A split by the number of its question; what follows is the split of that number, or leaf -1 - number."""

    question: int
    yes: int
    no: int
    gain: float


def grow(growth: Growth) -> tuple[list[Branch], list[NDArray[np.bool_]]]:
    """Return the splits of all contexts, and the members of each leaf, of shape (n_contexts,)."""
    branches: list[Branch] = []
    leaves: list[NDArray[np.bool_]] = []
    _grow(np.full(len(growth.rows.counts), True), growth, branches, leaves)
    return branches, leaves


def _grow(members: NDArray[np.bool_], growth: Growth, branches: list[Branch], leaves: list[NDArray[np.bool_]]) -> int:
    """Append the splits and leaves of some contexts, and return the number of the first, as in `Branch`."""
    best = _choose_question(members, growth)
    if best is None:
        leaves.append(members)
        return -len(leaves)
    at, answers = len(branches), growth.answers[best.question]
    branches.append(best)
    yes = _grow(members & answers, growth, branches, leaves)
    no = _grow(members & ~answers, growth, branches, leaves)
    branches[at] = best._replace(yes=yes, no=no)
    return at


def _choose_question(members: NDArray[np.bool_], growth: Growth) -> Branch | None:
    """Return the first of the best questions about some contexts, or None if none is worth its cost."""
    whole = pool(growth.rows, members[np.newaxis])
    rounding = _ROUNDING * whole.counts.sum()
    # (n_questions, n_contexts) each -> (2 n_questions, n_contexts): all yes, then all no
    sides = pool(growth.rows, np.concatenate([members & growth.answers, members & ~growth.answers]))
    enough = (count_frames(sides).reshape(2, -1) >= growth.min_count).all(axis=0)
    after = log_likelihoods(sides, growth.floors).reshape(2, -1).sum(axis=0)
    gains = np.where(enough, after - log_likelihoods(whole, growth.floors), -np.inf)
    best = np.flatnonzero((gains > growth.cost + rounding) & (gains >= gains.max(initial=-np.inf) - rounding))
    return Branch(int(best[0]), 0, 0, float(gains[best[0]])) if len(best) else None


def take_sums(
    counts: NDArray[np.float64], sums: NDArray[np.float64], squares: NDArray[np.float64], n_contexts: int
) -> Sums:
    """Return the sums of contexts; the last of them, beyond the rows given, were never seen."""
    unseen = ((0, n_contexts - len(counts)), (0, 0))
    return Sums(*(np.pad(np.where(counts > FEWEST, part, 0.0), unseen) for part in (counts, sums, squares)))


def pool(rows: Sums, sets: NDArray[np.bool_]) -> Sums:
    """Return the sums of each of some sets of contexts, `sets` of shape (n_sets, n_contexts)."""
    return Sums(*(sets @ part for part in rows))


def count_frames(pooled: Sums) -> NDArray[np.float64]:
    """Return the frames of each set: features lack some of them at the edges of walks, but not all features do."""
    return pooled.counts.max(axis=1)


def log_likelihoods(pooled: Sums, floors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest log-likelihood that Gaussians with variances of at least `floors` give each set."""
    counts, sums, squares = pooled
    divisors = np.where(counts > 0, counts, 1.0)
    scatters = np.maximum(squares - sums**2 / divisors, 0.0)  # about the means
    variances = np.maximum(scatters / divisors, floors)
    return -0.5 * (counts * np.log(2 * np.pi * variances) + scatters / variances).sum(axis=1)
