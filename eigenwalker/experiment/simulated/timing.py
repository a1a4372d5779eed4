"""When simulated observers answer: plausible times, as a page measures them, on a screen that drops no frames."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker.experiment.stimulus import Stimulus
from eigenwalker.experiment.study import Study

__all__ = ["simulate_timing"]

_START = "2026-01-05T09:00:00.000"  # of the first participant; others begin on the days that follow
_REFRESH = 60.0  # hertz
_PIXELS_PER_DEGREE = 38.0
_DECISION = (2.0, 0.5)  # median in seconds, and spread of its logarithm
_REPLAYS = 0.3  # of a walk that can be played again, on average
_DURATION = 7.0  # seconds, of walks that are not at hand
_BREAK = 60.0  # seconds
_DAY = 86400.0  # seconds


def simulate_timing(study: Study, design: pd.DataFrame, *, seed: int) -> pd.DataFrame:
    """Return what a page would have measured in each trial.

    Parameters
    ----------
    study : Study
        Which says how long walks are shown.
    design : DataFrame
        All trials of some participants, in order.
    seed : int
        Participants have random numbers of their own.

    Returns
    -------
    DataFrame
        One row a trial, the columns of `RESPONSE_COLUMNS` but answer and value.
    """
    showings = [study.task_of(name, trait).showing for name, trait in zip(design["task"], design["trait"], strict=True)]
    lasting = {stimulus.name: _duration(stimulus) for stimulus in study.stimuli}
    due = np.array(
        [
            lasting[name] if showing.duration is None else showing.duration
            for name, showing in zip(design["stimulus"], showings, strict=True)
        ]
    )
    self_paced = np.array([showing.self_paced for showing in showings])
    slowness, again = _draw(study, design, seed)
    replays = np.where(self_paced, again, 0)
    decision = _DECISION[0] * np.exp(_DECISION[1] * slowness)
    last = decision + np.where([showing.answer == "after" for showing in showings], due, 0.0)
    shown = np.where(self_paced, np.minimum(due, last), due)  # an answer ends the last play, if it is self-paced
    response = replays * due + last
    whole = np.maximum(response, np.where(self_paced, 0.0, due)) + [showing.blank for showing in showings]
    return pd.DataFrame(
        {
            "response_time_s": response.round(3),
            "replays": replays,
            "frames_drawn": np.round(_REFRESH * (replays * due + shown)).astype(np.int64),
            "frames_dropped": 0,
            "shown_s": shown.round(3),
            "shown_error_s": np.where(shown < due, np.nan, 0.0),
            "refresh_hz": _REFRESH,
            "pixels_per_degree": [np.nan if showing.height is None else _PIXELS_PER_DEGREE for showing in showings],
            "pixel_ratio": 1.0,
            "visit": 1,
            "answered_at": _times(design, whole),
        },
        index=design.index,
    )


def _duration(stimulus: Stimulus) -> float:
    return _DURATION if stimulus.walk is None else len(stimulus.walk.channels) / stimulus.walk.frame_rate


def _draw(study: Study, design: pd.DataFrame, seed: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return normal numbers, and numbers of replays, of each participant's own."""
    slowness, replays = np.empty(len(design)), np.empty(len(design), dtype=np.int64)
    for participant, rows in design.groupby("participant").indices.items():
        random = np.random.default_rng((seed, int(participant), len(study.tasks)))
        slowness[rows], replays[rows] = random.standard_normal(len(rows)), random.poisson(_REPLAYS, len(rows))
    return slowness, replays


def _times(design: pd.DataFrame, seconds: NDArray[np.float64]) -> list[str]:
    """Return when each trial ends."""
    since = pd.Series(seconds, design.index).groupby(design["participant"]).cumsum() + _BREAK * design["session"]
    milliseconds = np.round(1000 * (since + _DAY * (design["participant"] - 1))).astype(np.int64).to_numpy()
    times = np.datetime64(_START, "ms") + milliseconds.astype("timedelta64[ms]")
    return [f"{time}Z" for time in np.datetime_as_string(times, unit="ms")]
