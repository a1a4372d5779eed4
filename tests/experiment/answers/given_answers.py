"""A small study of all five tasks, and answers to it as people could give them."""

import json

import numpy as np
import pandas as pd

from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS
from eigenwalker.experiment.stimulus import cross_stimuli
from eigenwalker.experiment.study import make_study
from eigenwalker.experiment.tasks import (
    NaturalnessTask,
    PairTask,
    RatingTask,
    RecognitionTask,
    ResemblanceTask,
)

__all__ = ["answers_to", "as_lines", "as_table", "small_study"]


def small_study(**options):
    """Return a study of two participants and all tasks."""
    walks = make_walkers(4, random_state=0).data
    stimuli = cross_stimuli(
        {"sad": walks[0], "cool, very": walks[1]}, {"sad": walks[2], "cool, very": walks[3]}, conditions=["static"]
    )
    tasks = [
        RatingTask(("sad", "happy"), views=(0, 22.5), n_attention=1),
        PairTask(n_series=1, n_trials=2, reference="random"),
        NaturalnessTask(n_trials=2, n_practice=1),
        RecognitionTask(n_trials=3),
        ResemblanceTask(n_trials=2),
    ]
    return make_study(tasks, walks=stimuli, n_participants=2, random_state=1, **options)


def answers_to(study, seed=0):
    """Return an answer to each trial, in the types of the contract."""
    random = np.random.default_rng(seed)
    rows, number_of_study = [], study.id
    for number, row in enumerate(study.design.to_dict("records")):
        buttons = study.task_of(row["task"], row["trait"]).buttons
        button = buttons[random.integers(len(buttons))]
        rows.append(
            {
                "study": number_of_study,
                **row,
                "answer": button.answer,
                "value": np.nan if button.value is None else button.value,
                "response_time_s": float(random.gamma(3)),
                "replays": int(random.integers(3)),
                "frames_drawn": 420,
                "frames_dropped": int(random.integers(2)),
                "shown_s": 7.0,
                "shown_error_s": float(random.normal(0, 0.01)),
                "refresh_hz": 59.94,
                "pixels_per_degree": 45.5 if row["task"] == "rating" else np.nan,
                "pixel_ratio": 1.5,
                "visit": 1,
                "answered_at": f"2026-11-23T10:{number // 60:02d}:{number % 60:02d}.125Z",
            }
        )
    types = {"int": "int64", "float": "float64", "str": "str"}
    table = pd.DataFrame(rows)[list(ANSWER_COLUMNS)]
    return table.astype({name: types[column.kind] for name, column in ANSWER_COLUMNS.items()})


def as_table(answers):
    """Return answers as a file that a page downloads."""
    return answers.to_csv(index=False, lineterminator="\n").encode()


def as_lines(answers):
    """Return answers as result data of JATOS."""
    rows = [
        {name: None if isinstance(value, float) and np.isnan(value) else value for name, value in row.items()}
        for row in answers.to_dict("records")
    ]
    return "".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows).encode()
