"""How likely each answer is about each walk, as simulated observers give them: what is planted, or the papers' own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import brentq

from eigenwalker.experiment.stimulus import KINDS, Stimulus
from eigenwalker.experiment.tasks import DONT_KNOW, RatingTask, Task

__all__ = ["answer_chances", "answer_order", "latent_traits", "spread_over"]

_TABLES = {  # shares of answers to original and synthetic walks, of what people said in the papers
    "naturalness": {  # Tilmanne, Moinet & Dutoit 2012, 6.2
        "original": {"real": 0.6545, "synthetic": 1 - 0.6545 - 0.0244, DONT_KNOW: 0.0244},
        "synthetic": {"real": 0.5039, "synthetic": 1 - 0.5039 - 0.0669, DONT_KNOW: 0.0669},
    },
}
_RIGHT = {"original": 0.459, "synthetic": 0.3893}  # the same, 6.3
_MEANS = {"pair": 2.91 / 4, "resemblance": 3.15 / 4}  # Tilmanne & Dutoit 2012, section 3; the same, 6.4: over the best
_STEEPEST = 700.0  # of the exponents of graded answers
_FARTHEST = 10.0  # standard deviations of a trait


def latent_traits(task: RatingTask, stimuli: Sequence[Stimulus], truth: Any) -> NDArray[np.float64]:
    """Return how much of a trait each stimulus has, in standard deviations; 0 without a truth.

    Parameters
    ----------
    task : RatingTask
        Whose trait is rated.
    stimuli : sequence of Stimulus
        What is rated.
    truth : Series, DataFrame, mapping or None
        By names of stimuli, styles or kinds, see `spread_over`; a DataFrame has a column of the trait's name.

    Raises
    ------
    ValueError
        If names or values are not as they should be.
    """
    if truth is None:
        return np.zeros(len(stimuli))
    if isinstance(truth, pd.DataFrame):
        if task.trait not in truth.columns:
            columns = ", ".join(map(str, truth.columns))
            raise ValueError(f"truth of the rating of {task.trait}: expected a column of this name, got {columns}")
        truth = truth[task.trait]
    values = spread_over(truth, stimuli, what=f"the rating of {task.trait}").to_numpy()[:, 0]
    if np.abs(values).max() > _FARTHEST:
        raise ValueError(
            f"truth of the rating of {task.trait}: expected standard deviations, 0 between both poles, got values from "
            f"{values.min():.4g} to {values.max():.4g}; take (trait - trait.mean()) / trait.std()"
        )
    return values


def answer_chances(task: Task, stimuli: Sequence[Stimulus], truth: Any = None) -> pd.DataFrame:
    r"""Return how likely each answer to a task is about each stimulus.

    Grades 0 to m with a mean g have the chances of largest entropy, which fall from the best grade to the worst one
    where g > m / 2, as those of Fig. 8 do (Tilmanne, Moinet & Dutoit 2012, 6.4):

    .. math:: p_k = e^{\theta k} / \sum_j e^{\theta j}, \quad \theta \text{ such that } \sum_k k\, p_k = g

    Parameters
    ----------
    task : Task
        Any but a rating task.
    stimuli : sequence of Stimulus
        What is judged.
    truth : float, Series, mapping, DataFrame or None
        A number for each stimulus, style or kind (see `spread_over`), or one for all: of graded answers their mean,
        of naturalness the share of "real", all others being "synthetic", of recognition the share of right answers,
        the others being equally likely. Or a DataFrame with the answers as columns and the chances of each, as
        `confusion_tables` returns it. None is what the papers found: 2.91 for pairs, scaled to other numbers of
        grades; 65.45 and 50.39 % "real", 2.44 and 6.69 % "don't know" of original and synthetic walks; 45.9 and
        38.93 % right; 3.15 for resemblance.

    Returns
    -------
    DataFrame
        One row a stimulus, one column an answer, in the order of the buttons. Rows sum to 1.

    Raises
    ------
    ValueError
        If names or values are not as they should be, or stimuli have no kind where the papers tell kinds apart.

    Examples
    --------
    >>> from eigenwalker.experiment import ResemblanceTask
    >>> stimuli = [Stimulus("sad_synthetic", style="sad", kind="synthetic", reference="sad_original")]
    >>> answer_chances(ResemblanceTask(), stimuli).round(2).T
                          sad_synthetic
    identical                      0.51
    slightly different             0.26
    different                      0.13
    very different                 0.07
    nothing in common              0.03
    """
    what, answers = f"the task {task.name}", [button.answer for button in task.buttons]
    if isinstance(truth, pd.DataFrame):
        table = _check_table(spread_over(truth, stimuli, what=what), answers, what)
    elif truth is None and task.name in _TABLES:
        table = _by_kind(pd.DataFrame(_TABLES[task.name]).T, stimuli, what)
    elif task.name in _MEANS:
        table = _graded(task, stimuli, _MEANS[task.name] * (len(answers) - 1) if truth is None else truth, what)
    elif task.name == "naturalness":
        table = _shared(spread_over(truth, stimuli, what=what), ["real"] * len(stimuli), ["real", "synthetic"], what)
    else:
        of_kinds = pd.DataFrame({"right": _RIGHT})
        right = _by_kind(of_kinds, stimuli, what) if truth is None else spread_over(truth, stimuli, what=what)
        table = _shared(right, [stimulus.style for stimulus in stimuli], answers, what)
    return table.reindex(columns=answers, fill_value=0.0)


def answer_order(task: Task, stimuli: Sequence[Stimulus]) -> NDArray[np.intp]:
    """Return the order of the answers about each stimulus, from the worst to the best, shape (n_stimuli, n_answers).

    Grades rise; "synthetic" comes before "don't know" and "real"; of styles the right one is last.
    """
    buttons = task.buttons
    if task.name == "recognition":
        worth = np.array([[button.answer == stimulus.style for button in buttons] for stimulus in stimuli])
    elif task.name == "naturalness":
        worth = np.tile(
            [["synthetic", DONT_KNOW, "real"].index(button.answer) for button in buttons], (len(stimuli), 1)
        )
    else:
        worth = np.tile([float(button.value or 0.0) for button in buttons], (len(stimuli), 1))
    return np.argsort(worth, axis=1, kind="stable")


def spread_over(truth: Any, stimuli: Sequence[Stimulus], *, what: str = "the task") -> pd.DataFrame:
    """Return a row of truth for each stimulus.

    Parameters
    ----------
    truth : float, Series, mapping or DataFrame
        One number for all, or by names: those of the stimuli, their styles, or their kinds, whichever of these has a
        name in common with the truth first.
    stimuli : sequence of Stimulus
        In the order of the rows.
    what : str
        For errors.

    Raises
    ------
    ValueError
        If the truth has other names than all of these, some twice, or values that are no numbers; all faults at once.
    """
    names = [stimulus.name for stimulus in stimuli]
    if np.isscalar(truth):
        truth = pd.Series(truth, index=names)
    table = pd.DataFrame(pd.Series(truth) if isinstance(truth, Mapping) else truth)
    given = [str(name) for name in table.index]
    levels = {
        "stimuli": names,
        "styles": [stimulus.style for stimulus in stimuli],
        "kinds": [stimulus.kind for stimulus in stimuli],
    }
    level = next((one for one, known in levels.items() if set(known) & set(given)), "stimuli")
    wanted = levels[level]
    values = table.apply(pd.to_numeric, errors="coerce").set_axis(given, axis=0)
    faults = {
        f"{level} without a truth": sorted(set(wanted) - set(given)),
        f"truths of no {level}": sorted(set(given) - set(wanted)),
        "truths that are there twice": sorted({name for name in given if given.count(name) > 1}),
        "truths that are no numbers": sorted(set(values.index[~np.isfinite(values).all(axis=1)])),
    }
    found = [
        f"{len(some)} {fault}: {', '.join(name or 'no name' for name in some[:10])}{' ...' if len(some) > 10 else ''}"
        for fault, some in faults.items()
        if some
    ]
    if found:
        raise ValueError(f"truth of {what}: {'; '.join(found)}")
    return values.loc[wanted].set_axis(names, axis=0)


def _check_table(table: pd.DataFrame, answers: Sequence[str], what: str) -> pd.DataFrame:
    foreign = [str(column) for column in table.columns if column not in answers]
    if foreign:
        raise ValueError(f"truth of {what}: expected columns among {', '.join(answers)}, got {', '.join(foreign)}")
    odd = table.index[(table < 0).any(axis=1) | (np.abs(table.sum(axis=1) - 1) > 1e-6)].tolist()
    if odd:
        raise ValueError(f"truth of {what}: expected shares that sum to 1 in each row, not so: {', '.join(odd[:10])}")
    return table


def _by_kind(table: pd.DataFrame, stimuli: Sequence[Stimulus], what: str) -> pd.DataFrame:
    """Return the rows of the papers, which tell original from synthetic walks."""
    unknown = [stimulus.name for stimulus in stimuli if stimulus.kind not in KINDS]
    if unknown:
        raise ValueError(
            f"truth of {what}: the papers' answers are to original and synthetic walks, and these are neither: "
            f"{', '.join(unknown[:10])}; pass truth=, or make the walks with cross_stimuli(originals, synthetics)"
        )
    kinds = [stimulus.kind for stimulus in stimuli]
    return table.loc[kinds].set_axis([stimulus.name for stimulus in stimuli], axis=0)


def _shared(shares: pd.DataFrame, chosen: Sequence[str], answers: Sequence[str], what: str) -> pd.DataFrame:
    """Return chances of which the chosen answer has the given share, the other answers equal ones."""
    values = shares.to_numpy()[:, 0]
    if values.min() < 0 or values.max() > 1:
        raise ValueError(f"truth of {what}: expected shares from 0 to 1, got {values.min():.4g} to {values.max():.4g}")
    is_chosen = np.array([[answer == one for answer in answers] for one in chosen])
    rest = (1 - values) / (len(answers) - 1)
    return pd.DataFrame(np.where(is_chosen, values[:, np.newaxis], rest[:, np.newaxis]), shares.index, list(answers))


def _graded(task: Task, stimuli: Sequence[Stimulus], truth: Any, what: str) -> pd.DataFrame:
    """Return the chances of grades with given means."""
    grades = {button.answer: float(button.value or 0.0) for button in task.buttons}
    means = spread_over(truth, stimuli, what=what).iloc[:, 0]
    worth = np.array(list(grades.values()))
    if means.min() < worth.min() or means.max() > worth.max():
        raise ValueError(
            f"truth of {what}: expected mean grades from {worth.min():g} to {worth.max():g}, got {means.min():.4g} to "
            f"{means.max():.4g}"
        )
    known = {mean: _exponential(worth, mean) for mean in set(means)}
    return pd.DataFrame([known[mean] for mean in means], means.index, list(grades))


def _exponential(worth: NDArray[np.float64], mean: float) -> NDArray[np.float64]:
    """Return chances proportional to exp(theta worth) with a given mean."""

    def chances(theta: float) -> NDArray[np.float64]:
        weights = np.exp(theta * (worth - (worth.max() if theta > 0 else worth.min())))
        return weights / weights.sum()

    if mean in (worth.min(), worth.max()):
        return (worth == mean).astype(np.float64)
    return chances(float(brentq(lambda theta: chances(theta) @ worth - mean, -_STEEPEST, _STEEPEST)))
