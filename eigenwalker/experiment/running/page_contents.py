"""What the page of a study is told: one plain dictionary of words, numbers, and arrays written as text."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from eigenwalker._validation import WalkError
from eigenwalker.display.dots import Dots, walker_dots
from eigenwalker.display.viewer.contents import walk_contents
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS
from eigenwalker.experiment.design_table import design_values
from eigenwalker.experiment.running.shown_motion import shown_markers, shown_motion
from eigenwalker.experiment.stimulus import Stimulus
from eigenwalker.experiment.study import Study
from eigenwalker.experiment.tasks import RatingTask, Task
from eigenwalker.motion.walk import Walk

__all__ = ["movie_file", "page_contents"]

_DISTANCE = 0.57  # metres from eye to screen, at which a centimetre is a degree
_HARMONICS = 4  # as many as PointLightDisplay keeps
_BREAK = "Have a short break. Go on when you are ready."
_TITLES = {
    "rating": "Walkers",
    "pair": "Pairs of walks",
    "naturalness": "Real or synthetic?",
    "recognition": "Which style?",
    "resemblance": "How alike?",
}


def page_contents(study: Study) -> dict[str, Any]:
    """Return what the page of a study is told.

    Parameters
    ----------
    study : Study
        With the walks of its stimuli.

    Returns
    -------
    dict
        Ready for JSON: words of the study and its tasks, the design by columns, and the stimuli. Walks in place become
        Fourier coefficients, others frames; arrays are little-endian, as base64.

    Raises
    ------
    WalkError
        If a walk cannot be shown; all faults at once.
    """
    repeating = [stimulus for stimulus in study.stimuli if stimulus.walk is not None and not stimulus.condition]
    framed = [stimulus for stimulus in study.stimuli if stimulus.walk is not None and stimulus.condition]
    space, stimuli, faults = _harmonics(repeating)
    motions: dict[int, tuple[str, dict[str, Any]]] = {}
    for stimulus in framed:
        key = id(stimulus.walk)  # the same walk under both conditions is there once
        try:
            if key not in motions:
                motions[key] = f"motion{len(motions) + 1}", _motion(stimulus)
            _check_path(stimulus, motions[key][1])
            stimuli[stimulus.name] = _frames(stimulus, motions[key][0])
        except (WalkError, ValueError) as error:
            faults.append(_fault(stimulus, error))
    if faults:
        raise WalkError("; ".join(faults))
    for stimulus in study.stimuli:
        if stimulus.movie is not None:
            stimuli[stimulus.name] = {"source": "movie", "file": movie_file(study, stimulus)}
    return {
        "format": 1,
        "study": study.id,
        "title": study.title,
        "consent": study.consent,
        "calibrate": any(task.showing.height is not None for task in study.tasks),
        "viewing_distance": _DISTANCE,
        "n_participants": study.n_participants,
        "columns": list(ANSWER_COLUMNS),
        "design": design_values(study.design),
        "tasks": [_task(task) for task in study.tasks],
        "space": space,
        "motions": {name: _encoded(motion) for name, motion in motions.values()},
        "stimuli": {stimulus.name: stimuli[stimulus.name] for stimulus in study.stimuli},
    }


def movie_file(study: Study, stimulus: Stimulus) -> str:
    """Return where the movie of a stimulus lies, beside the page: a plain name, whatever the stimulus is called."""
    return f"stimuli/stimulus_{1 + study.stimuli.index(stimulus):03d}.mp4"


def _harmonics(stimuli: list[Stimulus]) -> tuple[dict[str, Any] | None, dict[str, Any], list[str]]:
    """Return what is said of walks in place together, and of each, and what is wrong with them."""
    walks: list[tuple[Walk, Dots]] = []
    said: dict[str, Any] = {}
    faults = []
    for stimulus in stimuli:
        try:
            assert stimulus.walk is not None
            walk = shown_markers(stimulus.walk)
            dots, height = walker_dots(walk, _HARMONICS)
        except (WalkError, TypeError, ValueError) as error:
            faults.append(_fault(stimulus, error))
            continue
        said[stimulus.name] = {
            "source": "harmonics",
            "walker": len(walks),
            "height": height,
            "elevation": 0.0,
            "duration": walk.duration,
        }
        walks.append((walk, dots))
    if faults or not walks:
        return None, said, faults
    space = walk_contents([walk for walk, _ in walks], _HARMONICS)
    vectors = _decode(space["center"]) + _decode(space["basis"]).reshape(len(walks), -1)
    for one, vector, (_, dots) in zip(said.values(), vectors, walks, strict=True):
        one["middle"] = (vector[:3] - dots.coefficients[0, 0]).tolist()  # what walker_dots took out of all markers
    return space, said, faults


def _fault(stimulus: Stimulus, error: Exception) -> str:
    """Return what is wrong with a stimulus, with its name."""
    return str(error) if repr(stimulus.name) in str(error) else f"{stimulus.name}: {error}"


def _motion(stimulus: Stimulus) -> dict[str, Any]:
    assert stimulus.walk is not None
    motion = shown_motion(stimulus.walk)
    markers = motion.marker_set
    return {
        "rate": motion.frame_rate,
        "markers": list(markers.names),
        "sticks": [[markers.index(start), markers.index(end)] for start, end in markers.sticks],
        "positions": motion.positions,
        "path": motion.path,
    }


def _check_path(stimulus: Stimulus, motion: dict[str, Any]) -> None:
    if stimulus.condition == "displacement" and not np.isfinite(motion["path"]).all():
        raise WalkError(
            "a walk that is shown on its way must travel, or its speed must be known; set it on the walk, "
            "dataclasses.replace(walk, speed=1.3), or leave this condition out"
        )


def _frames(stimulus: Stimulus, motion: str) -> dict[str, Any]:
    return {"source": "frames", "motion": motion, "displacement": stimulus.condition == "displacement"}


def _encoded(motion: dict[str, Any]) -> dict[str, Any]:
    path = motion["path"]
    known = path if np.isfinite(path).all() else np.zeros_like(path)  # of a walk that is only shown in place
    return motion | {"positions": _encode(motion["positions"]), "path": _encode(known)}


def _task(task: Task) -> dict[str, Any]:
    question, instruction = task.words
    showing = task.showing
    return {
        "task": task.name,
        "trait": task.trait,
        "title": _TITLES[task.name],
        "instruction": instruction,
        "question": question,
        "buttons": [button._asdict() for button in task.buttons],
        "buttons_at": "top" if isinstance(task, RatingTask) else "bottom",
        "pair": task.is_pair,
        "mark_reference": task.name == "pair",
        "figure": showing.figure,
        "height_degrees": showing.height,
        "dot_degrees": showing.dot_diameter,
        "duration": showing.duration,
        "self_paced": showing.self_paced,
        "answer": showing.answer,
        "blank": showing.blank,
        "break_text": _BREAK,
    }


def _encode(array: ArrayLike) -> str:
    return base64.b64encode(np.ascontiguousarray(array, dtype="<f4").tobytes()).decode("ascii")


def _decode(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype="<f8")
