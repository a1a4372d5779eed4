"""A study: what is asked, what is shown, and to whom in which order."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import pandas as pd
from sklearn.utils import check_random_state

from eigenwalker.display._numbers import check_count
from eigenwalker.experiment.design import make_design
from eigenwalker.experiment.design_table import design_values
from eigenwalker.experiment.stimulus import AVERAGE, Stimulus, as_stimuli
from eigenwalker.experiment.study_words import stimulus_words, task_words
from eigenwalker.experiment.tasks import RatingTask, RecognitionTask, Task
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["Study", "make_study"]

_Walks = Sequence[Walk | JointWalk | Stimulus]


@dataclass(frozen=True, eq=False, repr=False)
class Study:
    """A study that can be run, simulated and analyzed. Make one with `build_study` or `make_study`.

    Parameters
    ----------
    tasks : tuple of Task
        What is asked.
    stimuli : tuple of Stimulus
        What is shown. Without walks, where the study was read back by `read_study`.
    design : DataFrame
        One row per participant, session and trial, see `make_design`.
    title, consent : str
        Words on the page.
    """

    tasks: tuple[Any, ...]
    stimuli: tuple[Stimulus, ...]
    design: pd.DataFrame
    title: str = ""
    consent: str = ""

    @property
    def n_participants(self) -> int:
        """How many participants the design has."""
        return int(self.design["participant"].nunique())

    @cached_property
    def id(self) -> str:
        """Twelve hexadecimal digits that stand in every answer: another design, or other words, are another study."""
        return hashlib.sha256(json.dumps(self.words(), sort_keys=True).encode()).hexdigest()[:12]

    def words(self) -> dict[str, Any]:
        """Return all of it but the walks, ready for JSON."""
        return {
            "title": self.title,
            "consent": self.consent,
            "tasks": [task_words(task) for task in self.tasks],
            "stimuli": [stimulus_words(stimulus) for stimulus in self.stimuli],
            "design": design_values(self.design),
        }

    def task_of(self, name: str, trait: str = "") -> Task:
        """Return the task that rows of the design with this task and trait belong to."""
        for task in self.tasks:
            if (task.name, task.trait) == (name, trait):
                return task
        raise ValueError(f"no task {name!r}{f' of {trait!r}' if trait else ''} in this study")

    def __repr__(self) -> str:
        """Say what there is, without the tables."""
        tasks = ", ".join(f"{task.name} of {task.trait}" if task.trait else task.name for task in self.tasks)
        return (
            f"<Study {self.id}: {tasks}; {len(self.stimuli)} stimuli, {self.n_participants} participants, "
            f"{len(self.design)} trials>"
        )


def make_study(
    tasks: Task | Sequence[Task],
    *,
    walks: _Walks,
    n_participants: int,
    random_state: Any = None,
    title: str = "How people walk",
    consent: str = "",
) -> Study:
    """Return a study, without writing anything; `build_study` writes its pages as well.

    Parameters
    ----------
    tasks, walks, n_participants, random_state, title, consent
        See `build_study`.

    Returns
    -------
    Study

    Raises
    ------
    TypeError, ValueError
        If tasks, walks or numbers are not as they should be.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import RatingTask, make_study
    >>> walkers = make_walkers(80, random_state=0).data
    >>> study = make_study(RatingTask(("sad", "happy")), walks=walkers, n_participants=3, random_state=0)
    >>> len(study.design), study.design.groupby("participant")["view"].unique().tolist()  # 80 walkers, 3 sessions each
    (720, [array([ 0., 30., 90.]), array([30., 90.,  0.]), array([90.,  0., 30.])])
    """
    stimuli = as_stimuli(walks)
    asked = tuple(_with_styles(task, stimuli) for task in _check_tasks(tasks))
    n_participants = check_count(n_participants, "n_participants", at_least=1)
    n_groups = sum(isinstance(task, RatingTask) for task in asked)
    if n_groups > n_participants:
        raise ValueError(f"n_participants must be at least {n_groups}, one for each rating task, got {n_participants}")
    seed = int(check_random_state(random_state).randint(2**31 - 1))
    design = make_design(asked, stimuli, n_participants=n_participants, seed=seed)
    return Study(asked, stimuli, design, title=str(title), consent=str(consent))


def _check_tasks(tasks: Any) -> list[Task]:
    listed = [tasks] if isinstance(tasks, Task) else list(tasks)
    if not listed:
        raise ValueError("expected at least one task, got none")
    foreign = [type(task).__name__ for task in listed if not isinstance(task, Task)]
    if foreign:
        raise TypeError(f"expected tasks such as RatingTask(('sad', 'happy')), got {', '.join(foreign)}")
    names = [(task.name, task.trait) for task in listed]
    repeated = sorted({" of ".join(filter(None, name)) for name in names if names.count(name) > 1})
    if repeated:
        raise ValueError(f"each task of a study must be another one, or of another trait; repeated: {repeated[0]}")
    return listed


def _with_styles(task: Task, stimuli: Sequence[Stimulus]) -> Task:
    """Return the task, a recognition task with the styles that can be chosen filled in."""
    if not isinstance(task, RecognitionTask):
        return task
    shown = sorted({stimulus.style for stimulus in stimuli} - {"", AVERAGE})
    unnamed = [stimulus.name for stimulus in stimuli if not stimulus.style]
    if unnamed or not shown:
        raise ValueError(
            "a recognition task needs the style of each stimulus, missing of: "
            f"{', '.join(unnamed[:10]) or 'all'}; make the walks with cross_stimuli(originals, synthetics)"
        )
    if not task.styles:
        return replace(task, styles=tuple(shown))
    lacking = sorted(set(shown) - set(task.styles))
    if lacking:
        raise ValueError(f"styles must have those of all stimuli, missing: {', '.join(lacking)}")
    return task
