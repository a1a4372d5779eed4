"""Tasks and stimuli as plain words and numbers, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from eigenwalker.experiment.showing import Showing
from eigenwalker.experiment.stimulus import Stimulus
from eigenwalker.experiment.tasks import TASKS, Task

__all__ = ["stimulus_from_words", "stimulus_words", "task_from_words", "task_words"]

_STIMULUS = ("name", "style", "kind", "condition", "reference")


def task_words(task: Task) -> dict[str, Any]:
    """Return the fields of a task, ready for JSON, with its name as ``task``."""
    return {"task": task.name, **asdict(task)}


def task_from_words(words: Mapping[str, Any]) -> Task:
    """Return the task that `task_words` made these of."""
    given = dict(words)
    kind = given.pop("task", None)
    if kind not in TASKS:
        raise ValueError(f"task must be one of {', '.join(TASKS)}, got {kind!r}")
    return TASKS[kind](**{**given, "showing": Showing(**given["showing"])})


def stimulus_words(stimulus: Stimulus) -> dict[str, Any]:
    """Return what is known of a stimulus, without its walk or movie."""
    return {name: getattr(stimulus, name) for name in _STIMULUS}


def stimulus_from_words(words: Mapping[str, Any]) -> Stimulus:
    """Return the stimulus that `stimulus_words` made these of, without its walk or movie."""
    return Stimulus(**{name: words[name] for name in _STIMULUS})
