"""Where in a walk each step is: the labels that say which states it passes (Tilmanne et al. 2012, 5.1.1 and 5.2.1).

A step ends where a heel touches the ground (section 4); its label is the side of that heel and its position in the
walk, ``("right", "first")``. Two sides in five positions are ten contexts.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from eigenwalker._validation import WalkError, check_choice
from eigenwalker.motion.gait import SIDES, STEP_POSITIONS, heel_strikes, step_position
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["CONTEXTS", "StepLabel", "Steps", "check_labels", "label_steps", "make_labels"]

StepLabel = tuple[str, str]
CONTEXTS: tuple[StepLabel, ...] = tuple((side, position) for side in SIDES[::-1] for position in STEP_POSITIONS)

_WHOLE = 0.75  # of the median step: what lasts as long before the first strike, or after the last, is a step


class Steps(NamedTuple):
    """The steps of a walk, what `label_steps` returns.

    Parameters
    ----------
    labels : list of tuple of str
        Side and position of each step.
    boundaries : list of int
        First frame of each step, and the frame after the last one.
    """

    labels: list[StepLabel]
    boundaries: list[int]


def make_labels(n_steps: int, *, first: str = "right") -> list[StepLabel]:
    """Return the labels of a walk of some steps.

    Parameters
    ----------
    n_steps : int
        At least one.
    first : {"right", "left"}, default "right"
        The foot that makes the first step.

    Returns
    -------
    list of tuple of str
        The sides alternate. A walk of fewer than five steps has a first one; then a last one; then a second one; then
        one that is last but one.

    Raises
    ------
    ValueError
        If there is no step, or no such side.

    Examples
    --------
    >>> make_labels(3)
    [('right', 'first'), ('left', 'second'), ('right', 'last')]
    """
    check_choice(first, SIDES, name="first")
    if n_steps < 1:
        raise ValueError(f"n_steps must be at least 1, got {n_steps}")
    sides = (first, SIDES[1 - SIDES.index(first)])
    return [(sides[number % 2], step_position(number, n_steps)) for number in range(n_steps)]


def label_steps(walk: JointWalk | Walk) -> Steps:
    """Return the steps of a recorded walk.

    They lie between heel strikes, see `heel_strikes`. What is before the first strike, or after the last one, is a step
    as well where it lasts at least 3/4 of the median one, as when a walker starts from standing; shorter parts of steps
    are no part of the walk that is modeled.

    Parameters
    ----------
    walk : JointWalk or Walk
        Leading along x, over the floor or in place: from `prepare`, whole (``clip="whole"``), as first and last steps
        are not steady.

    Returns
    -------
    Steps

    Raises
    ------
    WalkError
        If there is no step, or a strike of one foot was missed, so that the sides do not alternate.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> walk = make_walkers(1, random_state=0).data[0]
    >>> label_steps(walk).labels[:2]
    [('left', 'first'), ('right', 'second')]
    """
    markers = walk.to_markers() if isinstance(walk, JointWalk) else walk
    strikes = sorted((time, side) for side in SIDES for time in heel_strikes(markers, side).tolist())
    if len(strikes) < 2:
        raise WalkError(
            f"walk {walk.name!r}: expected a step, from one heel strike to the next one of the other foot, but there "
            f"are {len(strikes)} strikes in {walk.duration:.3g} s; use a longer recording"
        )
    doubled = [f"{two[1]} at {one[0]:.2f} and {two[0]:.2f} s" for one, two in pairwise(strikes) if one[1] == two[1]]
    if doubled:
        raise WalkError(
            f"walk {walk.name!r}: expected heel strikes of both feet in turn, but one foot strikes twice: "
            f"{', '.join(doubled)}; cut the walk there, or give its step labels"
        )
    times = [time for time, _ in strikes]
    sides = [side for _, side in strikes]
    whole = _WHOLE * float(np.median(np.diff(times)))
    starts, ends = times[0] >= whole, walk.duration - times[-1] >= whole
    boundaries = [0] * starts + [round(time * walk.frame_rate) for time in times] + [walk.n_frames] * ends
    first = sides[0] if starts else sides[1]
    return Steps(make_labels(len(boundaries) - 1, first=first), boundaries)


def check_labels(labels: Sequence[StepLabel], *, walk: str) -> list[StepLabel]:
    """Return the labels of one walk as tuples.

    Parameters
    ----------
    labels : sequence of tuple of str
        Side and position of each step.
    walk : str
        What the walk is called in an error.

    Raises
    ------
    WalkError
        If there are none, one is not of CONTEXTS, or the sides do not alternate.
    """
    known = [tuple(label) for label in labels]
    foreign = [label for label in known if label not in CONTEXTS]
    if not known or foreign:
        raise WalkError(
            f"walk {walk!r}: expected a label for each step, such as ('right', 'first'), of {', '.join(SIDES)} and "
            f"{', '.join(STEP_POSITIONS)}, got {foreign[:3] or 'none'}; make_labels(n_steps, first='right') makes them"
        )
    wrong = [number for number, (one, two) in enumerate(pairwise(known)) if one[0] == two[0]]
    if wrong:
        raise WalkError(
            f"walk {walk!r}: expected left and right steps in turn, but steps {wrong[0]} and {wrong[0] + 1} are both "
            f"{known[wrong[0]][0]}; a step was missed there, cut the walk in two"
        )
    return [(side, position) for side, position in known]
