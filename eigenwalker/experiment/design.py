"""Who is shown what, and when: one row per participant, session and trial."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker.display.body import find_azimuth
from eigenwalker.experiment.answer_columns import DESIGN_COLUMNS
from eigenwalker.experiment.dealing import deal_cards
from eigenwalker.experiment.design_table import design_from_values
from eigenwalker.experiment.stimulus import Stimulus
from eigenwalker.experiment.tasks import RatingTask, Task

__all__ = ["cyclic_square", "make_design"]

_Rows = list[dict[str, Any]]


def cyclic_square(conditions: Sequence[Any], n_rows: int) -> list[list[Any]]:
    """Return orders of conditions: each row begins one further on than the row before it.

    Every condition stands in every place equally often if n_rows is a multiple of their number; a cyclic square does
    not balance which condition comes right before which.

    Parameters
    ----------
    conditions : sequence
        What is put in order.
    n_rows : int
        Number of orders; after as many as there are conditions they begin anew.

    Examples
    --------
    >>> from eigenwalker.experiment import cyclic_square
    >>> cyclic_square([0, 30, 90], 3)
    [[0, 30, 90], [30, 90, 0], [90, 0, 30]]
    """
    listed = list(conditions)
    return [listed[row % len(listed) :] + listed[: row % len(listed)] for row in range(n_rows)]


def make_design(
    tasks: Sequence[Task], stimuli: Sequence[Stimulus], *, n_participants: int, seed: int = 0
) -> pd.DataFrame:
    """Return the design of a study.

    A participant does all tasks in order; of several rating tasks, the label groups, only one: participants go to the
    groups in turn, and within each the orders of viewpoints are those of a cyclic Latin square (Troje 2002, section 4).
    Each participant has random numbers of its own, so that more participants leave the first ones as they are; only
    balanced draws are dealt out over all of them.

    Parameters
    ----------
    tasks : sequence of Task
        Styles of recognition tasks must be filled in.
    stimuli : sequence of Stimulus
        Ratings take those without a kind or style as well as others; pairs are a synthetic stimulus and its reference.
    n_participants : int
        In all groups together.
    seed : int, default 0
        Of all that is random.

    Returns
    -------
    DataFrame
        With the columns of `DESIGN_COLUMNS`.

    Raises
    ------
    ValueError
        If a task has nothing to show.
    """
    ratings = [task for task in tasks if isinstance(task, RatingTask)]
    others = [(number, task) for number, task in enumerate(tasks) if not isinstance(task, RatingTask)]
    decks = {number: _decks(task, stimuli, n_participants, (seed, number)) for number, task in others}
    rows: _Rows = []
    for participant in range(1, n_participants + 1):
        sessions: list[_Rows] = []
        if ratings:
            group, member = (participant - 1) % len(ratings), (participant - 1) // len(ratings)
            random = np.random.default_rng((seed, len(tasks) + group, participant))
            sessions += _rating_sessions(ratings[group], stimuli, member, random)
        for number, task in others:
            random = np.random.default_rng((seed, number, participant))
            sessions += _drawn_sessions(task, stimuli, decks[number][participant - 1], random)
        for session, trials in enumerate(sessions, start=1):
            rows += [
                {"participant": participant, "session": session, "trial": trial, **row}
                for trial, row in enumerate(trials, start=1)
            ]
    return design_from_values({name: [row[name] for row in rows] for name in DESIGN_COLUMNS})


def _rating_sessions(
    task: RatingTask, stimuli: Sequence[Stimulus], member: int, random: np.random.Generator
) -> list[_Rows]:
    """Return the sessions of one participant, one a viewpoint, each with all stimuli."""
    first = {"first": True, "second": False, "alternate": member % 2 == 1}[task.left]
    left = task.poles[0] if first else task.poles[1]
    orders = cyclic_square(task.views, member + 1)[member]
    sessions = []
    for number, view in enumerate(orders):
        deck = [stimuli[at] for at in random.permutation(len(stimuli))]
        trials = [_row(task, stimulus, view=view, left=left) for stimulus in deck]
        if number == 0:
            trials = _practice(task, stimuli, random, view=view, left=left) + trials
        sessions.append(_with_attention(task, trials, random))
    return sessions


def _drawn_sessions(
    task: Any, stimuli: Sequence[Stimulus], drawn: NDArray[np.intp], random: np.random.Generator
) -> list[_Rows]:
    """Return the series of one participant, with the stimuli drawn for it."""
    view, known = find_azimuth(task.showing.view), {stimulus.name: stimulus for stimulus in stimuli}
    deck = _judged(task, stimuli)
    trials = [_row(task, deck[at], view=view, left=_left(task, deck[at], random), known=known) for at in drawn]
    series = [trials[start : start + task.n_trials] for start in range(0, len(trials), task.n_trials)]
    practice = [
        {**_row(task, one, view=view, left=_left(task, one, random), known=known), "part": "practice"}
        for one in _some(deck, task.n_practice, random)
    ]
    return [(practice if number == 0 else []) + _with_attention(task, one, random) for number, one in enumerate(series)]


def _decks(
    task: Any, stimuli: Sequence[Stimulus], n_participants: int, seed: tuple[int, ...]
) -> list[NDArray[np.intp]]:
    """Return which of the stimuli that are judged each participant gets."""
    n_cards = len(_judged(task, stimuli))
    n_hand = min(task.n_series * task.n_trials, n_cards)
    if task.draw == "balanced":
        return deal_cards(n_cards, n_hand, n_participants, np.random.default_rng(seed))
    hands = range(1, n_participants + 1)
    return [np.random.default_rng((*seed, hand, 1)).permutation(n_cards)[:n_hand] for hand in hands]


def _judged(task: Any, stimuli: Sequence[Stimulus]) -> list[Stimulus]:
    """Return the stimuli that a task asks about."""
    if not task.is_pair:
        return list(stimuli)
    pairs = [stimulus for stimulus in stimuli if stimulus.reference]
    if not pairs:
        raise ValueError(
            f"a {task.name} task needs synthetic walks that refer to their originals, got none; make the walks with "
            "cross_stimuli(originals, synthetics), or give Stimulus(..., reference='name of the original')"
        )
    return pairs


def _row(
    task: Any, stimulus: Stimulus, *, view: float, left: str, known: dict[str, Stimulus] | None = None
) -> dict[str, Any]:
    return {
        "task": task.name,
        "part": "main",
        "trait": task.trait,
        "stimulus": stimulus.name,
        "reference": known[stimulus.reference].name if task.is_pair and known else "",
        "left": left,
        "view": float(view),
        "kind": stimulus.kind,
        "style": stimulus.style,
        "condition": stimulus.condition,
        "expected": "",
    }


def _left(task: Any, stimulus: Stimulus, random: np.random.Generator) -> str:
    """Return which walk of a pair stands on the left."""
    if not task.is_pair:
        return ""
    reference_left = random.random() < 0.5 if task.reference == "random" else task.reference == "left"
    return stimulus.reference if reference_left else stimulus.name


def _practice(task: Any, stimuli: Sequence[Stimulus], random: np.random.Generator, **shown: Any) -> _Rows:
    some = _some(stimuli, task.n_practice, random)
    return [{**_row(task, stimulus, **shown), "part": "practice"} for stimulus in some]


def _some(stimuli: Sequence[Stimulus], number: int, random: np.random.Generator) -> list[Stimulus]:
    """Return stimuli drawn at random, different ones as long as there are any."""
    n_rounds = -(-number // len(stimuli))
    picks = [at for _ in range(n_rounds) for at in random.permutation(len(stimuli))]
    return [stimuli[at] for at in picks[:number]]


def _with_attention(task: Any, trials: _Rows, random: np.random.Generator) -> _Rows:
    """Return the trials of a session with some among them, not the first, that ask for a given answer."""
    result = list(trials)
    shown = [row for row in trials if row["part"] == "main"]
    answers = [button.answer for button in task.buttons]
    for _ in range(task.n_attention):
        copied = shown[int(random.integers(len(shown)))]
        asked = {**copied, "part": "attention", "expected": answers[int(random.integers(len(answers)))]}
        result.insert(int(random.integers(len(result) - len(shown) + 1, len(result) + 1)), asked)
    return result
