"""Which states of which contexts are one: states tied by decision trees, by hand, or not at all.

An untied model has its own states in every context. Its sums (`Statistics`) show which of them could be one; the rows
of those that are add up to the sums of the tied model.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm.accumulation import Statistics
from eigenwalker.hsmm.context_trees import (
    GAIT_QUESTIONS,
    Context,
    ContextTree,
    Question,
    find_context_faults,
    grow_tree,
)

__all__ = [
    "GAIT_GROUPS",
    "Tying",
    "pool_rows",
    "sum_durations",
    "tie_by",
    "tie_durations",
    "tie_states",
    "untied",
]


GAIT_GROUPS: tuple[tuple[Context, ...], ...] = tuple(
    tuple((side, position) for position in positions)
    for positions in (("first",), ("second", "inside", "last but one"), ("last",))
    for side in ("right", "left")
)
"""The six groups that were left of the ten contexts in Tilmanne et al. 2012, 5.2.1."""


class Tying(NamedTuple):
    """Which tied state each state of each context is.

    Attributes
    ----------
    contexts : tuple of tuples of str
        One a row.
    states : ndarray of int of shape (n_contexts, n_states)
        Numbers of tied states, from 0 on.
    trees : tuple of ContextTree
        Of each state, or the one of all durations; empty if no tree tied them.
    """

    contexts: tuple[Context, ...]
    states: NDArray[np.int_]
    trees: tuple[ContextTree, ...] = ()

    @property
    def n_tied(self) -> int:
        """Number of tied states."""
        return int(self.states.max()) + 1


def untied(contexts: Sequence[Context], n_states: int) -> Tying:
    """Return states of which no two are one, those of the first context first.

    Parameters
    ----------
    contexts : sequence of tuples of str
        All different.
    n_states : int
        Of each context.

    Returns
    -------
    Tying

    Raises
    ------
    ValueError
        If there are no contexts or states, or contexts are given twice.

    Examples
    --------
    >>> untied([("right",), ("left",)], 3).states
    array([[0, 1, 2],
           [3, 4, 5]])
    """
    return tie_by(contexts, [(context,) for context in dict.fromkeys(contexts)], n_states)


def tie_by(contexts: Sequence[Context], groups: Sequence[Sequence[Context]], n_states: int) -> Tying:
    """Return states that are one within groups of contexts, those of the first group first.

    Parameters
    ----------
    contexts : sequence of tuples of str
        All different.
    groups : sequence of sequences of contexts
        Each context is in one of them, such as `GAIT_GROUPS`, or the leaves of a tree.
    n_states : int
        Of each context.

    Returns
    -------
    Tying

    Raises
    ------
    ValueError
        If there are no contexts or states, contexts are given twice, a context is not in exactly one group, or a
        group has none of them.

    Examples
    --------
    >>> tie_by([("first",), ("inside",), ("last",)], [[("first",), ("last",)], [("inside",)]], 2).states
    array([[0, 1],
           [2, 3],
           [0, 1]])
    """
    owners = {context: [at for at, group in enumerate(groups) if context in group] for context in contexts}
    faults = find_context_faults(contexts) + [
        f"expected context {context!r} in one group, got it in {len(found)}"
        for context, found in owners.items()
        if len(found) != 1
    ]
    faults += [
        f"expected contexts in group {list(group)}, got none of those given"
        for group in groups
        if not set(group) & set(contexts)
    ]
    faults += [] if n_states >= 1 else [f"n_states must be at least 1, got {n_states!r}"]
    if faults:
        raise ValueError("\n".join(faults))
    numbers = np.array([found[0] for found in owners.values()])
    return Tying(tuple(contexts), numbers[:, np.newaxis] * n_states + np.arange(n_states))


def tie_states(
    statistics: Statistics,
    contexts: Sequence[Context],
    questions: Sequence[Question] = GAIT_QUESTIONS,
    *,
    floors: ArrayLike,
    penalty: float = 1.0,
    min_count: float = 10.0,
) -> Tying:
    """Return the states that observations tie, by one tree for each state.

    Parameters
    ----------
    statistics : Statistics
        Of the states of `untied(contexts, n_states)`, of observations about their overall means.
    contexts : sequence of tuples of str
        All that the model is to know, those included that no walk has: their rows are zero.
    questions : sequence of Question, default GAIT_QUESTIONS
        That trees may ask.
    floors, penalty, min_count
        As of `grow_tree`.

    Returns
    -------
    Tying
        The leaves of the first state's tree are first.

    Raises
    ------
    ValueError
        If there is not the same number of rows for each context, a state was never seen, and as of `grow_tree`.
    """
    n_states = _count_states(statistics.counts, contexts)
    # (n_contexts * n_states, n_features) -> (n_contexts, n_states, n_features)
    shape = (len(contexts), n_states, -1)
    counts, sums, squares = (part.reshape(shape) for part in (statistics.counts, statistics.sums, statistics.squares))
    unseen = [state for state in range(n_states) if not counts[:, state].any()]
    if unseen:
        raise ValueError(f"expected frames of every state in at least one context, got none of state {unseen}")
    trees = tuple(
        grow_tree(
            counts[:, state],
            sums[:, state],
            squares[:, state],
            contexts,
            questions,
            floors=floors,
            penalty=penalty,
            min_count=min_count,
        )
        for state in range(n_states)
    )
    firsts = np.cumsum([0, *(tree.n_leaves for tree in trees[:-1])])
    states = [
        [first + tree.leaf_of(context) for first, tree in zip(firsts, trees, strict=True)] for context in contexts
    ]
    return Tying(tuple(contexts), np.array(states), trees)


def tie_durations(
    statistics: Statistics,
    contexts: Sequence[Context],
    questions: Sequence[Question] = GAIT_QUESTIONS,
    *,
    floor: float = 1.0,
    penalty: float = 1.0,
    min_count: float = 10.0,
) -> Tying:
    """Return the states that durations tie, by one tree: those of a step are one Gaussian of as many dimensions.

    Parameters
    ----------
    statistics : Statistics
        Of the duration states of `untied(contexts, n_states)`.
    contexts : sequence of tuples of str
        All that the model is to know, those included that no walk has: their rows are zero.
    questions : sequence of Question, default GAIT_QUESTIONS
        That the tree may ask.
    floor : float, default 1.0
        Least variance of a duration, in frames squared.
    penalty, min_count : float, default 1.0, and float, default 10.0
        As of `grow_tree`, with steps for frames.

    Returns
    -------
    Tying
        The states of the tree's first leaf are first.

    Raises
    ------
    ValueError
        If there is not the same number of rows for each context, and as of `grow_tree`.
    """
    n_states = _count_states(statistics.duration_counts, contexts)
    sums = sum_durations(statistics.duration_counts, n_states)
    tree = grow_tree(*sums, contexts, questions, floors=floor, penalty=penalty, min_count=min_count)
    return tie_by(contexts, tree.leaves, n_states)._replace(trees=(tree,))


def sum_durations(
    duration_counts: NDArray[np.floating], n_states: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return how often each state of each context was passed, and the sums of its durations and of their squares.

    Parameters
    ----------
    duration_counts : ndarray of shape (n_contexts * n_states, n_durations)
        How often each lasts d frames, in column d - 1; the states of a context follow each other.
    n_states : int
        Of each context.

    Returns
    -------
    counts, sums, squares : ndarray of shape (n_contexts, n_states)

    Examples
    --------
    >>> counts, sums, squares = sum_durations(np.array([[0.0, 1.0, 1.0], [2.0, 0.0, 0.0]]), 2)
    >>> counts.tolist(), sums.tolist(), squares.tolist()
    ([[2.0, 2.0]], [[5.0, 2.0]], [[13.0, 2.0]])
    """
    durations = np.arange(1, duration_counts.shape[1] + 1)
    counts, sums, squares = (
        (duration_counts @ durations.astype(np.float64) ** power).reshape(-1, n_states) for power in range(3)
    )
    return counts, sums, squares


def pool_rows(array: NDArray[np.floating], ids: ArrayLike, n: int) -> NDArray[np.float64]:
    """Return the sums of the rows that are the same tied state.

    Parameters
    ----------
    array : ndarray of shape (n_rows, ...)
        Sums of states that are not tied.
    ids : array-like of int of n_rows entries
        Tied state of each row; those of a `Tying` are taken context by context.
    n : int
        Number of tied states.

    Returns
    -------
    ndarray of shape (n, ...)

    Raises
    ------
    ValueError
        If there are not as many ids as rows, or they are not from 0 to n - 1.

    Examples
    --------
    >>> pool_rows(np.array([[1.0], [10.0], [100.0], [1000.0]]), [[0, 1], [0, 2]], 3).ravel().tolist()
    [101.0, 10.0, 1000.0]
    """
    array, ids = np.asarray(array, dtype=np.float64), np.asarray(ids).ravel()
    if len(array) != len(ids):
        raise ValueError(f"expected one id a row, got {len(ids)} ids for {len(array)} rows")
    wrong = ids[(ids < 0) | (ids >= n)]
    if len(wrong):
        raise ValueError(f"expected ids from 0 to {n - 1}, got {np.unique(wrong).tolist()}")
    pooled = np.zeros((n, *array.shape[1:]))
    np.add.at(pooled, ids, array)
    return pooled


def _count_states(rows: NDArray[np.floating], contexts: Sequence[Context]) -> int:
    """Return how many states a context has, if rows are those of `untied`."""
    faults = find_context_faults(contexts)
    if not faults and (not len(rows) or len(rows) % len(contexts)):
        faults = [f"expected the same number of rows for each of {len(contexts)} contexts, got {len(rows)} rows"]
    if faults:
        raise ValueError("\n".join(faults))
    return len(rows) // len(contexts)
