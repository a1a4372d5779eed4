"""Decision trees of contexts: which of them are alike enough to share the Gaussian of a state.

A context is what sets one step of a walk apart from another, as its side and its place in the walk. A tree starts with
all contexts on one leaf and splits leaves by questions as long as that shortens the description of the data,

    D = -L + penalty n_leaves n_features log N

with L the log-likelihood of the frames by the most likely diagonal Gaussian of their leaf and N the number of frames.
A Gaussian has two parameters a feature, each of which costs (log N) / 2 (Shinoda & Watanabe 2000, J. Acoust. Soc. Jpn.
(E) 21, 79-86). Contexts without data lie on the leaf that the questions lead them to.
"""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm._tree_growth import FEWEST, Growth, count_frames, grow, log_likelihoods, pool, take_sums
from eigenwalker.hsmm.step_labels import CONTEXTS

__all__ = ["GAIT_QUESTIONS", "Context", "ContextTree", "Question", "Split", "grow_tree"]

Context = tuple[str, ...]


class Question(NamedTuple):
    """A question about contexts.

    Attributes
    ----------
    name : str
        How it reads, such as "right?".
    contexts : tuple of tuples of str
        Those it answers with yes.
    """

    name: str
    contexts: tuple[Context, ...]


class Split(NamedTuple):
    """One question of a tree.

    Attributes
    ----------
    question : Question
        What is asked.
    yes, no : int
        What follows: the split of that number, or, if negative, leaf -1 - number.
    gain : float
        By how much the split raises the log-likelihood.
    """

    question: Question
    yes: int
    no: int
    gain: float


class ContextTree(NamedTuple):
    """Contexts on leaves, and the questions that lead there. All of it is tuples, words and numbers.

    Attributes
    ----------
    splits : tuple of Split
        The root first, each before those that follow it.
    leaves : tuple of tuples of contexts
        Of each leaf, from left to right if yes is left. Those that only questions name are among them.
    counts : tuple of float
        Frames on each leaf.
    log_likelihood : float
        Of all frames, by the Gaussians of the leaves.
    cost : float
        What each leaf adds to the description length, and each split had to gain: penalty n_features log N.
    """

    splits: tuple[Split, ...]
    leaves: tuple[tuple[Context, ...], ...]
    counts: tuple[float, ...]
    log_likelihood: float
    cost: float

    @property
    def n_leaves(self) -> int:
        """Number of leaves."""
        return len(self.leaves)

    @property
    def description_length(self) -> float:
        """What splitting makes smaller, in nats."""
        return self.n_leaves * self.cost - self.log_likelihood

    def leaf_of(self, context: Context) -> int:
        """Return the number of the leaf that the questions lead a context to, whether it had data or not.

        Raises
        ------
        ValueError
            If neither the contexts that the tree was grown from nor its questions name the context.
        """
        if not any(context in leaf for leaf in self.leaves):
            known = ", ".join(str(other) for leaf in self.leaves for other in leaf)
            raise ValueError(f"expected one of the contexts {known}, got {context!r}; grow the tree with it")
        at = 0 if self.splits else -1
        while at >= 0:
            split = self.splits[at]
            at = split.yes if context in split.question.contexts else split.no
        return -1 - at

    def __str__(self) -> str:
        return "\n".join(_describe(self, 0 if self.splits else -1))


def _describe(tree: ContextTree, at: int) -> list[str]:
    """Return the lines of a split, or of a leaf if its number is negative, and of what follows."""
    if at < 0:
        listed = ", ".join(" ".join(context) for context in tree.leaves[-1 - at])
        return [f"leaf {-1 - at} (n = {tree.counts[-1 - at]:g}): {listed}"]
    split = tree.splits[at]
    lines = [f"{split.question.name} (gain {split.gain:.1f}, cost {tree.cost:.1f})"]
    for answer, then in (("yes", split.yes), ("no", split.no)):
        first, *others = _describe(tree, then)
        lines += [f"|--- {answer}: {first}", *(f"|   {line}" for line in others)]
    return lines


def _ask(name: str, *words: str) -> Question:
    return Question(name, tuple(context for context in CONTEXTS if set(context) & set(words)))


GAIT_QUESTIONS: tuple[Question, ...] = (
    _ask("right?", "right"),
    _ask("first?", "first"),
    _ask("last?", "last"),
    _ask("first or last?", "first", "last"),
    _ask("first or second?", "first", "second"),
    _ask("last or last but one?", "last", "last but one"),
    _ask("inside?", "inside"),
    _ask("second?", "second"),
    _ask("last but one?", "last but one"),
)
"""What may set steps apart: their side, and how a walk begins and ends. The paper does not list its questions."""


def grow_tree(
    counts: ArrayLike,
    sums: ArrayLike,
    squares: ArrayLike,
    contexts: Sequence[Context],
    questions: Sequence[Question],
    *,
    floors: ArrayLike,
    penalty: float = 1.0,
    min_count: float = 10.0,
) -> ContextTree:
    """Return the tree that describes the data of contexts in the shortest way, split by split.

    Of each leaf the question that raises the log-likelihood most is asked if the gain exceeds

        penalty n_features log N

    which is the change of the description length that Shinoda & Watanabe (2000) stop at. The likelihood is that of
    the most likely diagonal Gaussian whose variances are at least `floors`. A feature adds to it by the frames in
    which it was observed, and n_features are those observed at all. The frames of some contexts are the largest count
    that a feature has in all of them together, and N are the frames of all contexts.

    Parameters
    ----------
    counts, sums, squares : array-like of shape (n_contexts, n_features)
        Frames in which each feature was observed in each context, in one state, and the sums of the values and of
        their squares there. They must be of values about their overall means, or nearly so: far from zero the squares
        lose their digits. Of durations frames are steps, and features are the states, see `sum_durations`.
    contexts : sequence of tuples of str
        One a row. Those never seen have counts of zero.
    questions : sequence of Question
        Of questions that are equally good the first is asked. Other contexts that they name are taken as never seen.
    floors : array-like of shape (n_features,), or float
        Least variance of each feature, as from `variance_floors`.
    penalty : float, default 1.0
        0 splits by any gain, infinity does not split. More than 1 makes up for frames that are like those before,
        which the criterion takes for independent.
    min_count : float, default 10.0
        Fewest frames on each side of a split: variances of fewer look too good.

    Returns
    -------
    ContextTree

    Raises
    ------
    ValueError
        If contexts are given twice, a question is answered by none of them, arrays do not fit each other or cannot be
        sums of frames, nothing was seen at all, floors are not positive, or penalty or min_count is negative.

    References
    ----------
    Shinoda & Watanabe 2000, MDL-based context-dependent subword modeling for speech recognition, J. Acoust. Soc. Jpn.
    (E) 21, 79-86, there without floors. Tilmanne et al. 2012, 5.1.1 and 5.2.1.

    Examples
    --------
    Two frames at -6 and -4 after the right step, at 4 and 6 after the left one, and no second step so far:

    >>> contexts = [("right", "first"), ("left", "first"), ("left", "second")]
    >>> questions = [Question("right?", (("right", "first"),)), Question("second?", (("left", "second"),))]
    >>> tree = grow_tree(
    ...     [[2.0], [2.0], [0.0]], [[-10.0], [10.0], [0.0]], [[52.0], [52.0], [0.0]],
    ...     contexts, questions, floors=0.01, min_count=2,
    ... )
    >>> print(tree)
    right? (gain 6.5, cost 1.4)
    |--- yes: leaf 0 (n = 2): right first
    |--- no: leaf 1 (n = 2): left first, left second
    >>> tree.leaf_of(("left", "second"))
    1
    """
    counts, sums, squares, floors = (np.asarray(array, dtype=np.float64) for array in (counts, sums, squares, floors))
    faults = find_context_faults(contexts, questions) or _find_array_faults(counts, sums, squares, floors, contexts)
    faults += [
        f"{name} must be zero or more, got {value!r}"
        for name, value in (("penalty", penalty), ("min_count", min_count))
        if not value >= 0
    ]
    if faults:
        raise ValueError("\n".join(faults))
    everything, answers = _answer(contexts, questions)
    growth = Growth(take_sums(counts, sums, squares, len(everything)), answers, floors, penalty, min_count)
    branches, leaves = grow(growth)
    pooled = pool(growth.rows, np.array(leaves))
    return ContextTree(
        tuple(Split(questions[at], yes, no, gain) for at, yes, no, gain in branches),
        tuple(tuple(everything[at] for at in np.flatnonzero(members)) for members in leaves),
        tuple(count_frames(pooled).tolist()),
        float(log_likelihoods(pooled, floors).sum()),
        growth.cost,
    )


def _answer(contexts: Sequence[Context], questions: Sequence[Question]) -> tuple[list[Context], NDArray[np.bool_]]:
    """Return the contexts and those that only questions name, and which of them each question answers with yes."""
    everything = list(dict.fromkeys([*contexts, *(context for question in questions for context in question.contexts)]))
    yes = [frozenset(question.contexts) for question in questions]
    answers = [[context in those for context in everything] for those in yes]
    return everything, np.array(answers, dtype=bool).reshape(len(questions), len(everything))


def find_context_faults(contexts: Sequence[Context], questions: Sequence[Question] = ()) -> list[str]:
    """Return what is wrong with contexts and questions, one message a fault."""
    if not len(contexts):
        return ["expected at least one context, got none"]
    twice = [context for context, times in Counter(contexts).items() if times > 1]
    return [f"contexts must differ, got {context!r} more than once" for context in twice] + [
        f"question {question.name!r}: expected at least one of the contexts given, got {list(question.contexts)}; "
        "leave the question out"
        for question in questions
        if not set(question.contexts) & set(contexts)
    ]


def _find_array_faults(
    counts: NDArray, sums: NDArray, squares: NDArray, floors: NDArray, contexts: Sequence[Context]
) -> list[str]:
    shape = (len(contexts), *counts.shape[1:])
    if counts.ndim != 2 or not counts.size or {counts.shape, sums.shape, squares.shape} != {shape}:
        return [
            f"expected counts, sums and squares of shape (n_contexts, n_features) with {len(contexts)} contexts, "
            f"got {counts.shape}, {sums.shape} and {squares.shape}"
        ]
    if not all(np.isfinite(array).all() for array in (counts, sums, squares)):
        return ["counts, sums and squares must be finite, got NaN or infinity; leave out what was not observed"]
    faults = []
    if floors.shape not in ((), shape[1:]) or not ((floors > 0) & np.isfinite(floors)).all():
        faults.append(f"floors must be one positive number, or one of each of {shape[1]} features, got {floors}")
    # No sums of squares are smaller; the slack is for rounding, and what is too few frames is not read.
    impossible = (sums**2 > (1 + 1e-9) * counts * squares) & ((counts > FEWEST) | (counts == 0))
    for broken, message in (
        (counts < 0, "counts must be zero or more, got less"),
        (impossible & (counts >= 0), "squares must be at least sums**2 / counts, got less"),
    ):
        listed = ", ".join(str(contexts[row]) for row in np.flatnonzero(broken.any(axis=1))[:4])
        faults += [f"{message} in context {listed}"] if listed else []
    if not (counts > FEWEST).any():
        faults.append("expected frames in at least one context, got counts of zero; leave the state out")
    return faults
