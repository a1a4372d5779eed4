"""Some steps out of the middle of a walk, with the labels that gait models need."""

from typing import NamedTuple

from eigenwalker._validation import WalkError
from eigenwalker.hsmm.step_labels import StepLabel, label_steps
from eigenwalker.motion.clip import cut
from eigenwalker.motion.walk import JointWalk

__all__ = ["InnerSteps", "cut_inner_steps"]


class InnerSteps(NamedTuple):
    """What `cut_inner_steps` returns.

    Parameters
    ----------
    walk : JointWalk
        From the first frame of the first of the steps to the last frame of the last one.
    labels : list of tuple of str
        Side and position, "inside", of each step.
    """

    walk: JointWalk
    labels: list[StepLabel]


def cut_inner_steps(walk: JointWalk, n_steps: int | None = None) -> InnerSteps:
    """Return steps that are neither of the first two nor of the last two of a walk.

    A dozen steps of a style from several walks tell more of it than a dozen of one. A piece of a walk must bring its
    labels along: on its own its first step would be taken for the first step of a walk.

    Parameters
    ----------
    walk : JointWalk
        Prepared, whole.
    n_steps : int, default None
        How many, from the middle; None is all.

    Returns
    -------
    InnerSteps
        Lists of walks and of labels are what `GaitHSMM.adapt` and `score` take.

    Raises
    ------
    WalkError
        If the walk has fewer such steps, or as `label_steps`.
    ValueError
        If fewer than one are asked for.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.hsmm import cut_inner_steps
    >>> cut_inner_steps(make_walkers(1, random_state=0).data[0], 2).labels
    [('right', 'inside'), ('left', 'inside')]
    """
    if n_steps is not None and n_steps < 1:
        raise ValueError(f"n_steps must be 1 or more, or None, got {n_steps!r}")
    steps = label_steps(walk)
    inside = [number for number, (_, position) in enumerate(steps.labels) if position == "inside"]
    if len(inside) < (n_steps or 1):
        raise WalkError(
            f"walk {walk.name!r}: expected {n_steps or 1} steps or more that are neither of the first two nor of the "
            f"last two, got {len(inside)} of {len(steps.labels)}; use a longer recording"
        )
    start = 0 if n_steps is None else (len(inside) - n_steps) // 2
    taken = inside[start:] if n_steps is None else inside[start : start + n_steps]
    frames = slice(steps.boundaries[taken[0]], steps.boundaries[taken[-1] + 1])
    return InnerSteps(cut(walk, frames), [steps.labels[number] for number in taken])
