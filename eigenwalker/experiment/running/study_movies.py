"""Movies of the stimuli of a study, as its tasks show them."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import WalkError
from eigenwalker._whole_files import whole_file
from eigenwalker.display.dots import walker_dots
from eigenwalker.display.figure_movie import write_figure_movie
from eigenwalker.display.figures import FigureDisplay
from eigenwalker.display.movie import write_movie
from eigenwalker.display.point_lights import frame_times
from eigenwalker.display.screen import Screen
from eigenwalker.display.stimuli import PointLightDisplay
from eigenwalker.experiment.running.shown_motion import shown_markers, shown_motion
from eigenwalker.experiment.showing import Showing
from eigenwalker.experiment.stimulus import Stimulus

__all__ = ["Shown", "write_stimuli"]

_HARMONICS = 4  # as many as PointLightDisplay keeps
_STRIDES = 10  # of a walk in place, where nobody says how long it lasts


class Shown(NamedTuple):
    """A stimulus as a task shows it.

    Parameters
    ----------
    stimulus : Stimulus
        What.
    view : float
        From where, in degrees.
    showing : Showing
        How.
    """

    stimulus: Stimulus
    view: float
    showing: Showing

    @property
    def look(self) -> tuple[Any, ...]:
        """What of the showing makes another movie."""
        showing = self.showing
        return showing.figure, showing.height, showing.dot_diameter, showing.duration


class _Job(NamedTuple):
    """One movie to write, or to copy."""

    path: Path
    display: PointLightDisplay | FigureDisplay | Path
    duration: float
    rate: float
    screen: Screen
    scale: float | None = None


def write_stimuli(
    wanted: Sequence[tuple[Path, Shown]], *, rate: float, screen: Screen, n_jobs: int | None = None
) -> list[float]:
    """Write movies, all of which can be written or none.

    Point lights of a given height come from `write_movie`. Stick figures, and point lights as large as they can be,
    are drawn as on the page of a study, and on one scale for an original and what refers to it. Stimuli that are movies
    are copied.

    Parameters
    ----------
    wanted : sequence of (Path, Shown)
        Where to, and what.
    rate : float
        Frames per second.
    screen : Screen
        Distance, pixels and size of the picture.
    n_jobs : int, default None
        Number of processes, as in joblib.

    Returns
    -------
    list of float
        How long each lasts, in seconds; NaN for copies that no task cuts.

    Raises
    ------
    WalkError
        If walks cannot be shown, or movies cannot be written, with the names of the stimuli.
    ImportError
        If ffmpeg is not installed.
    """
    names = [shown.stimulus.name for _, shown in wanted]
    plans, refusals = collect(partial(_plan, rate=rate, screen=screen), wanted, names)
    report_refusals(refusals, len(wanted), on_error="raise", what="stimuli")
    jobs = _on_one_scale([job for job in plans if job is not None], [shown for _, shown in wanted])
    _, failures = collect(_write, jobs, names, n_jobs=n_jobs, progress=True, description="writing movies")
    report_refusals(failures, len(jobs), on_error="raise", what="movies")
    return [job.duration for job in jobs]


def _plan(wanted: tuple[Path, Shown], *, rate: float, screen: Screen) -> _Job:
    """Return how what is wanted is made."""
    path, (stimulus, view, showing) = wanted
    if stimulus.movie is not None:
        length = np.nan if showing.duration is None else showing.duration
        return _Job(path, Path(stimulus.movie), length, rate, screen)
    if stimulus.walk is None:
        raise WalkError("expected a walk or a movie, got neither; build the study anew with its walks")
    display, length = _display(stimulus, showing, rate)
    return _Job(path, display.seen_from(view), length, rate, screen)


def _display(stimulus: Stimulus, showing: Showing, rate: float) -> tuple[PointLightDisplay | FigureDisplay, float]:
    """Return the display of a walk, from the side, and how long it is shown."""
    assert stimulus.walk is not None
    if stimulus.condition:
        motion = shown_motion(stimulus.walk)
        positions = motion.positions
        if stimulus.condition == "displacement":
            way = np.pad(motion.path, ((0, 0), (0, 1)))  # (n_frames, 2) -> (n_frames, 3)
            positions = positions + way[:, np.newaxis]
        display = FigureDisplay(positions, motion.frame_rate, motion.marker_set, name=stimulus.name)
        return _sized(display, showing), display.duration if showing.duration is None else showing.duration
    markers = shown_markers(stimulus.walk)
    dots, height = walker_dots(markers, _HARMONICS)
    length = _STRIDES / float(dots.frequencies[0]) if showing.duration is None else showing.duration
    if showing.figure == "dots" and showing.height is not None:
        lights = PointLightDisplay.from_walk(markers, n_harmonics=_HARMONICS)
        return lights.sized(height=showing.height).with_dots(showing.dot_diameter), length
    positions = dots.evaluate(frame_times(length, rate), np.eye(3), 0.0)
    display = FigureDisplay(
        positions, rate, markers.marker_set, body_height=height, middle=np.zeros(3), name=stimulus.name
    )
    return _sized(display, showing), length


def _sized(display: FigureDisplay, showing: Showing) -> FigureDisplay:
    dot = None if showing.height is None else showing.dot_diameter
    return display.drawn_as(showing.figure, dot_diameter=dot).sized(showing.height)


def _on_one_scale(jobs: Sequence[_Job], shown: Sequence[Shown]) -> list[_Job]:
    """Return the jobs with one scale for each original and what refers to it, that of the one that needs most room."""
    scales: dict[tuple[Any, ...], float] = {}
    keys = [(one.stimulus.reference or one.stimulus.name, one.view, one.look) for one in shown]
    for key, job in zip(keys, jobs, strict=True):
        if isinstance(job.display, FigureDisplay):
            scales[key] = min(scales.get(key, np.inf), job.display.pixels_per_meter(job.screen))
    return [
        job._replace(scale=scales[key]) if isinstance(job.display, FigureDisplay) else job
        for key, job in zip(keys, jobs, strict=True)
    ]


def _write(job: _Job) -> None:
    if isinstance(job.display, Path):
        with whole_file(job.path) as part:
            shutil.copyfile(job.display, part)
    elif isinstance(job.display, PointLightDisplay):
        write_movie(job.display, job.path, duration=job.duration, rate=job.rate, screen=job.screen)
    else:
        write_figure_movie(
            job.display, job.path, duration=job.duration, rate=job.rate, screen=job.screen, scale=job.scale
        )
