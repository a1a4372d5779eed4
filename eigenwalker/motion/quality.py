"""How well a prepared walk fits the Fourier model."""

from typing import NamedTuple

import numpy as np

from eigenwalker.motion.fourier import SEARCH_HARMONICS, evaluate_harmonics, explained_power, fit_harmonics
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.walk import Walk

__all__ = ["WalkQuality", "walk_quality"]


class WalkQuality(NamedTuple):
    """What `walk_quality` returns. A list of them makes a DataFrame with one row a walk.

    Parameters
    ----------
    name : str
        The walk's name.
    duration : float
        In seconds.
    frequency : float
        Strides per second.
    n_cycles : float
        Strides in the walk.
    speed : float
        Of the belt, in m/s; NaN where unknown.
    explained_power : float
        Share of the power of all channels, about their means, that the harmonics explain.
    path_residual : float
        Root mean square distance of the pelvis over the floor, in metres, from 4 harmonics: what is left of the
        path after the smooth one was taken out.
    """

    name: str
    duration: float
    frequency: float
    n_cycles: float
    speed: float
    explained_power: float
    path_residual: float


def walk_quality(walk: Walk, *, n_harmonics: int = 2) -> WalkQuality:
    """Return how long, how regular and how well explained a prepared walk is.

    Parameters
    ----------
    walk : Walk
        From `prepare`.
    n_harmonics : int, default 2
        Harmonics of the model.

    Returns
    -------
    WalkQuality

    Raises
    ------
    WalkError
        If the walk has no period or less than one stride.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import prepare, walk_quality
    >>> walk = prepare(make_walkers(1, random_state=0).data[0])
    >>> bool(walk_quality(walk).explained_power > 0.9)
    True
    """
    frequency = stride_frequency(walk)
    pelvis = walk.marker("pelvis")[:, :2]
    coefficients = fit_harmonics(pelvis, walk.frame_rate, frequency, SEARCH_HARMONICS)
    rest = pelvis - evaluate_harmonics(coefficients, frequency, np.arange(walk.n_frames) / walk.frame_rate)
    return WalkQuality(
        name=walk.name,
        duration=walk.duration,
        frequency=frequency,
        n_cycles=frequency * walk.duration,
        speed=walk.speed,
        explained_power=explained_power(walk.channels, walk.frame_rate, frequency, n_harmonics),
        path_residual=float(np.sqrt((rest**2).sum(axis=1).mean())),
    )
