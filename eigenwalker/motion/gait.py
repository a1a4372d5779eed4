"""Heel strikes, toe offs, steps and strides, and a table of them."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.signal import find_peaks, savgol_filter

from eigenwalker._validation import WalkError, check_choice, check_finite, check_walks
from eigenwalker.motion.walk import Event, JointWalk, Walk

__all__ = [
    "SIDES",
    "STEP_POSITIONS",
    "Step",
    "detect_events",
    "find_steps",
    "gait_table",
    "heel_strikes",
    "step_frequency",
    "step_position",
    "toe_offs",
]

SIDES = ("left", "right")
STEP_POSITIONS = ("first", "second", "inside", "last but one", "last")
_WINDOW = 0.2  # seconds, over which cubics smooth: they keep what is below some 7 Hz
_PROMINENCE = 0.35  # of the range of the signal
_CERTAIN = 4.0  # times the noise by which a foot must have turned back before the recording ends
_STILL = 0.05  # metres of range below which a foot does not walk


class Step(NamedTuple):
    """From one heel strike to the next one of the other foot.

    Parameters
    ----------
    side : str
        "left" or "right": the foot that strikes at the end of the step.
    start, end : float
        Seconds from the first frame.
    position : str
        Where in the walk: one of STEP_POSITIONS, "first", "second", "inside", "last but one" or "last".
    """

    side: str
    start: float
    end: float
    position: str


def heel_strikes(walk: Walk, side: str, *, marker: str | None = None) -> NDArray[np.float64]:
    """Return the times of heel strikes of one foot.

    The heel strikes when the foot is furthest in front of the pelvis (Zeni, Richards & Higginson 2008, Gait Posture
    27, 710-714). The distance is smoothed by cubics over 0.2 s (Savitzky & Golay 1964, Anal. Chem. 36, 1627-1639),
    which need no frames beyond the ends as the low-pass filter of the source does, so that strikes within the first
    and last frames of a short pass are found; the top is that of the parabola through three frames. Events that the
    walk itself holds are preferred.

    Parameters
    ----------
    walk : Walk
        Leading along x (see `prepare`), over the floor or in place.
    side : {"left", "right"}
        The foot.
    marker : str, default None
        Marker of the foot without its side. None is "heel" where there is one, else "ankle".

    Returns
    -------
    ndarray of shape (n_strikes,)
        Seconds from the first frame.

    Raises
    ------
    WalkError
        If a marker is missing or its path has gaps.
    """
    return _events(walk, side, "heel_strike", 1.0, marker, ("heel", "ankle"))


def toe_offs(walk: Walk, side: str, *, marker: str | None = None) -> NDArray[np.float64]:
    """Return the times at which one foot leaves the floor: when it is furthest behind the pelvis.

    Found as in `heel_strikes`. The ankle swings forward while the toe still pushes: without a marker on the toe, toe
    offs come some 40 ms early (`Walk.to_markers` keeps heels and toes with ``feet=True``).

    Parameters
    ----------
    walk : Walk
        Leading along x; see `heel_strikes`.
    side : {"left", "right"}
        The foot.
    marker : str, default None
        Marker of the foot without its side. None is "toe" where there is one, else "ankle".

    Returns
    -------
    ndarray of shape (n_toe_offs,)
        Seconds from the first frame.

    Raises
    ------
    WalkError
        If a marker is missing or its path has gaps.
    """
    return _events(walk, side, "toe_off", -1.0, marker, ("toe", "ankle"))


def _events(
    walk: Walk, side: str, kind: str, sign: float, marker: str | None, choices: Sequence[str]
) -> NDArray[np.float64]:
    check_choice(side, SIDES, name="side")
    known = [event.time for event in walk.events if (event.kind, event.side) == (kind, side)]
    if known and marker is None:
        return np.array(known)
    return _peaks(sign * _ahead_of_pelvis(walk, side, marker, choices), walk.frame_rate)


def _ahead_of_pelvis(walk: Walk, side: str, marker: str | None, choices: Sequence[str]) -> NDArray[np.float64]:
    wanted = [f"{side}_{marker}"] if marker is not None else [f"{side}_{choice}" for choice in choices]
    foot = next((name for name in wanted if name in walk.marker_set.names), None)
    if foot is None or "pelvis" not in walk.marker_set.names:
        raise WalkError(
            f"walk {walk.name!r}: events need the markers pelvis and {' or '.join(wanted)}; "
            f"it has {', '.join(walk.marker_set.names)}"
        )
    ahead = walk.marker(foot)[:, :1] - walk.marker("pelvis")[:, :1]
    check_finite(ahead, [f"{foot}_x - pelvis_x"], walk=walk.name)
    return np.asarray(ahead[:, 0], dtype=np.float64)


def _peaks(signal: NDArray[np.float64], frame_rate: float) -> NDArray[np.float64]:
    """Return the times of the clear maxima of a signal, between frames.

    A maximum stands out from the minima on both sides. Near an end of the recording there is no minimum on one side;
    there the signal must have come down from it by more than noise could.
    """
    if np.ptp(signal) < _STILL or len(signal) < 5:
        return np.empty(0)
    smooth = _smooth(signal, frame_rate)
    floor = np.pad(smooth, 1, constant_values=smooth.min())  # an end counts as the deepest minimum
    peaks = find_peaks(floor, prominence=_PROMINENCE * np.ptp(smooth))[0] - 1
    peaks = peaks[(peaks > 0) & (peaks < len(smooth) - 1)]
    turned = _CERTAIN * np.std(np.diff(signal, 3)) / np.sqrt(20)  # 20 = 1 + 9 + 9 + 1: white noise in third differences
    sure = [min(smooth[peak] - part.min() for part in (smooth[:peak], smooth[peak:])) > turned for peak in peaks]
    peaks = peaks[np.array(sure, dtype=bool)]
    before, top, after = smooth[peaks - 1], smooth[peaks], smooth[peaks + 1]
    return (peaks + 0.5 * (before - after) / (before - 2 * top + after)) / frame_rate


def _smooth(signal: NDArray[np.float64], frame_rate: float) -> NDArray[np.float64]:
    """Return a signal smoothed by cubics, up to its ends, which a filter that needs padding would bend."""
    window = max(5, 2 * round(_WINDOW * frame_rate / 2) + 1)
    return savgol_filter(signal, window, 3) if len(signal) >= window else signal


def detect_events(walk: Walk) -> Walk:
    """Return the walk with the heel strikes and toe offs of both feet as its events.

    Parameters
    ----------
    walk : Walk
        Leading along x. Kinds of events that it holds already are kept; other events stay.

    Returns
    -------
    Walk
    """
    finders = {"heel_strike": heel_strikes, "toe_off": toe_offs}
    found = [
        Event(float(time), kind, side) for kind, find in finders.items() for side in SIDES for time in find(walk, side)
    ]
    others = [event for event in walk.events if event.kind not in finders or event.side not in SIDES]
    return replace(walk, events=tuple(others + found))


def find_steps(walk: Walk) -> list[Step]:
    """Return the steps of a walk, from one heel strike to the next one of the other foot.

    Parameters
    ----------
    walk : Walk
        Leading along x.

    Returns
    -------
    list of Step
        Two strikes of the same foot in a row, with one of the other foot missed between them, make no step.
    """
    strikes = sorted((time, side) for side in SIDES for time in heel_strikes(walk, side).tolist())
    pairs = [(one, two) for one, two in pairwise(strikes) if one[1] != two[1]]
    return [
        Step(side, start, end, step_position(number, len(pairs)))
        for number, ((start, _), (end, side)) in enumerate(pairs)
    ]


def step_position(number: int, n_steps: int) -> str:
    """Return where in a walk of `n_steps` steps the one with this number is, counted from 0: one of STEP_POSITIONS."""
    from_end = n_steps - 1 - number
    named = {0: "first", 1: "second"} if number <= from_end else {}
    ends = {0: "last", 1: "last but one"}
    return named.get(number) or ends.get(from_end) or "inside"


def step_frequency(walk: Walk | JointWalk) -> float:
    """Return the stride frequency that the steps of a walk have: 1 / (2 mean step duration), in hertz.

    The mean cycle frequency of Tilmanne & Dutoit 2012, section 2.2, with the steps of `find_steps` for those of their
    segmentation. It takes two strikes, and their times as they are; `stride_frequency` takes all of the motion.

    Parameters
    ----------
    walk : Walk or JointWalk
        Leading along x, over the floor or in place. Joints are turned into markers, `to_markers`.

    Returns
    -------
    float

    Raises
    ------
    WalkError
        If there is no step in the walk, or if it lacks the markers that events need.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import step_frequency, stride_frequency
    >>> walk = make_walkers(1, random_state=0).data[0]
    >>> bool(abs(step_frequency(walk) / stride_frequency(walk) - 1) < 0.01)
    True
    """
    steps = find_steps(walk.to_markers() if isinstance(walk, JointWalk) else walk)
    if not steps:
        raise WalkError(
            f"walk {walk.name!r}: expected a step, from one heel strike to the next one of the other foot, but there "
            f"is none in {walk.duration:.3g} s; use a longer recording"
        )
    return 0.5 / _mean([step.end - step.start for step in steps])


def gait_table(walks: Sequence[Walk]) -> pd.DataFrame:
    """Return spatio-temporal measures of walks, one row a walk.

    Parameters
    ----------
    walks : list of Walk
        Prepared: leading along x; `speed` known for the lengths.

    Returns
    -------
    DataFrame
        Columns: name; n_steps; cadence_steps_per_min; speed_m_per_s; stride_length_m (speed times mean stride time);
        step_width_m (between the ankles, across, at heel strike); stance_ratio (share of the stride from heel strike
        to toe off of the same foot); step_time_asymmetry ((left - right) over their mean, 0 for a symmetric walker).
        NaN where a walk has too few events or an unknown speed.

    Raises
    ------
    WalkError
        If a walk lacks the markers that events need.
    """
    return pd.DataFrame([_measures(walk) for walk in check_walks(walks, kind=Walk)])


def _measures(walk: Walk) -> dict[str, object]:
    walk = detect_events(walk)  # once, for all that follows
    strikes = {side: heel_strikes(walk, side) for side in SIDES}
    steps = find_steps(walk)
    stride_times = np.concatenate([np.diff(times) for times in strikes.values()])
    stride_time = _mean(stride_times)
    durations = {side: _mean([step.end - step.start for step in steps if step.side == side]) for side in SIDES}
    middle = (durations["left"] + durations["right"]) / 2
    return {
        "name": walk.name,
        "n_steps": len(steps),
        "cadence_steps_per_min": 120 / stride_time,
        "speed_m_per_s": walk.speed,
        "stride_length_m": walk.speed * stride_time,
        "step_width_m": _step_width(walk, strikes),
        "stance_ratio": _stance_ratio(walk, strikes, stride_time),
        "step_time_asymmetry": (durations["left"] - durations["right"]) / middle,
    }


def _mean(values: Sequence[float] | NDArray[np.float64]) -> float:
    return float(np.mean(values)) if len(values) else float("nan")


def _step_width(walk: Walk, strikes: dict[str, NDArray[np.float64]]) -> float:
    across = walk.marker("left_ankle")[:, 1] - walk.marker("right_ankle")[:, 1]
    frames = np.rint(np.concatenate(list(strikes.values())) * walk.frame_rate).astype(int)
    return _mean(across[np.clip(frames, 0, walk.n_frames - 1)])


def _stance_ratio(walk: Walk, strikes: dict[str, NDArray[np.float64]], stride_time: float) -> float:
    """Mean over all strikes that are followed by a toe off of the same foot within the stride."""
    stances = []
    for side, times in strikes.items():
        offs = toe_offs(walk, side)
        for time in times:
            following = offs[(offs > time) & (offs < time + stride_time)]
            stances.extend(following[:1] - time)
    return _mean(stances) / stride_time
