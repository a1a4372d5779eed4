"""Synthetic walkers with planted traits."""

import numbers

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from sklearn.utils import Bunch, check_random_state

from eigenwalker._validation import check_frame_rate
from eigenwalker.datasets._parameters import PARAMETERS, average_parameters, individual_sd
from eigenwalker.datasets._recording import record_on_floor, record_on_treadmill
from eigenwalker.datasets._traits import (
    TRAIT_CENTERS,
    TRAIT_SCALES,
    TRAITS,
    draw_traits,
    trait_effects,
    trait_table,
)
from eigenwalker.datasets._walker import FEATURES, make_walker, stride_features
from eigenwalker.motion import Walk

__all__ = ["make_walkers"]

_SHORTEST = 3.0  # seconds: two strides of the slowest walkers
_SLOWEST = 0.7  # hertz
_STEP = 0.1  # standard deviations, of the finite differences

_DESCRIPTION = """\
Synthetic walkers
-----------------
Stick figures of 15 virtual markers (Troje 2002), moved by published normative joint angles through bodies of
published proportions, with planted effects of gender, age, height, weight and two ratings, and with individual
deviations that no trait explains.

The data are made up. They say nothing about people: the sizes of the effects were chosen so that gender is about as
hard to tell, and the variance about as spread out, as Troje (2002) reports. Use them to learn, to test and to compare
methods against a known truth.
"""


def make_walkers(
    n_walkers: int = 80,
    *,
    duration: float = 12.0,
    frame_rate: float = 120.0,
    noise: float = 0.001,
    treadmill: bool = True,
    random_state: int | np.random.RandomState | None = None,
) -> Bunch:
    """Return synthetic walkers whose traits are known.

    Each walker is a body with published proportions (Drillis & Contini 1966) whose joints follow published normative
    angles of level walking (Perry & Burnfield 2010, Kadaba et al. 1990, Murray et al. 1967), through forward
    kinematics, with the stance foot on the ground. A linear model changes 256 parameters of body, posture, joint
    curves and frequency: parameters = average + sum over traits of axis * (trait - center) + individual
    deviation. Traits do what Troje (2002, section 5) saw: men have a larger ratio of shoulder to hip width, sway more
    to the sides, tilt the pelvis in opposite phase and hold their elbows away from the body; heavy walkers are slower,
    wider and bob less. Happy walkers are upright, bouncy and swing their arms, nervous ones are quick and stiff with
    raised shoulders.

    Parameters
    ----------
    n_walkers : int, default 80
        Number of walkers, half of them female (one more of either gender if the number is odd).
    duration : float, default 12.0
        Seconds per walk, at least 3.
    frame_rate : float, default 120.0
        Frames per second, at least 20.
    noise : float, default 0.001
        Standard deviation of the measurement error of every coordinate, in metres.
    treadmill : bool, default True
        Whether the walks stay in place on a belt whose speed is their `Walk.speed`. Otherwise they start slowly, cross
        a floor in some direction on a gently bent path, and slow down; their `Walk.speed` is NaN.
    random_state : int, RandomState or None, default None
        Seed. Walkers have seeds of their own: with the same one, a walker's motion does not depend on `noise`, and
        its first frames not on `duration` if it stays in place.

    Returns
    -------
    sklearn.utils.Bunch
        With the attributes

        - data : list of Walk. `TROJE15` markers, metres, x forward, y left, z up, the floor at z = 0.
        - target : DataFrame, one row a walk, indexed by its name, with gender ("female" or "male"), age (years),
          height (m), weight (kg), and happy and nervous (ratings with mean 0 and standard deviation 1).
        - parameters : DataFrame (n_walkers, n_parameters), the linear parameters of each walker. SI units; gains are
          relative changes, delays are in strides.
        - true_axes : DataFrame (n_parameters, n_traits), the change of each parameter per unit of a trait while the
          other traits stay; gender counts -1 for female and +1 for male.
        - feature_axes : DataFrame (226, n_traits), the change of the noise-free features (mean, sin1, cos1, sin2, cos2
          of all 45 channels in common phase, then frequency) per standard deviation of a trait while the others stay,
          for the average walker. Traits are correlated (men are taller and heavier), so that what *goes along* with
          a trait, ``feature_axes @ target.corr()[trait]`` with gender in numbers, differs from what it does.
        - DESCR : str.

    Raises
    ------
    ValueError
        If `n_walkers` is below 1, `duration` below 3 s, `noise` negative or `frame_rate` below 20.

    References
    ----------
    Troje (2002), The little difference: Fourier based synthesis of gender-specific biological motion. The modules
    beside this one cite the sources of the curves, the proportions and the distributions.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> walkers = make_walkers(4, random_state=0)
    >>> walkers.data[0].positions.shape
    (1440, 15, 3)
    >>> sorted(walkers.target.gender)
    ['female', 'female', 'male', 'male']
    >>> bool(walkers.true_axes.loc["shoulder_breadth", "gender"] > 0)
    True
    """
    frame_rate = check_frame_rate(frame_rate)
    _check(n_walkers, duration, noise, frame_rate)
    random = check_random_state(random_state)
    seeds = random.randint(2**31 - 1, size=n_walkers)
    genders = random.permutation(np.where(np.arange(n_walkers) % 2 == random.randint(2), 1.0, -1.0))
    streams = [[np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(5)] for seed in seeds]
    traits = np.array([draw_traits(gender, rng[0]) for gender, rng in zip(genders, streams, strict=True)])
    parameters = _parameters(traits, [rng[1] for rng in streams])
    names = [f"walker_{number:03d}" for number in range(n_walkers)]
    times = np.arange(max(round(duration * frame_rate), 1)) / frame_rate
    walks = [
        _record(row, name, times, frame_rate, noise, treadmill, rng[2:])
        for row, name, rng in zip(parameters, names, streams, strict=True)
    ]
    return Bunch(
        data=walks,
        target=trait_table(traits, names),
        parameters=pd.DataFrame(parameters, index=pd.Index(names, name="name"), columns=list(PARAMETERS)),
        true_axes=pd.DataFrame(trait_effects() / TRAIT_SCALES, index=list(PARAMETERS), columns=list(TRAITS)),
        feature_axes=_feature_axes(),
        DESCR=_DESCRIPTION,
    )


def _check(n_walkers: int, duration: float, noise: float, frame_rate: float) -> None:
    if not isinstance(n_walkers, numbers.Integral):
        raise TypeError(f"n_walkers must be a whole number, got {n_walkers!r}")
    faults = []
    if n_walkers < 1:
        faults.append(f"n_walkers must be at least 1, got {n_walkers}")
    if not (np.isfinite(duration) and duration >= _SHORTEST):
        faults.append(f"duration must be at least {_SHORTEST} s, two strides of a slow walker, got {duration}")
    if not (np.isfinite(noise) and noise >= 0):
        faults.append(f"noise must be a standard deviation in metres, zero or positive, got {noise}")
    if frame_rate < 20:
        faults.append(f"frame_rate must be at least 20 frames per second to carry a stride, got {frame_rate}")
    if faults:
        raise ValueError("; ".join(faults))


def _parameters(traits: NDArray[np.float64], rngs: list[np.random.Generator]) -> NDArray[np.float64]:
    """Average, traits and individual deviations, shape (n_walkers, n_parameters)."""
    deviations = np.array([rng.standard_normal(len(PARAMETERS)) for rng in rngs]) * individual_sd()
    parameters = average_parameters() + (traits - TRAIT_CENTERS) / TRAIT_SCALES @ trait_effects().T + deviations
    frequency = PARAMETERS.index("frequency")
    parameters[:, frequency] = np.maximum(parameters[:, frequency], _SLOWEST)
    return parameters


def _record(
    parameters: NDArray[np.float64],
    name: str,
    times: NDArray[np.float64],
    frame_rate: float,
    noise: float,
    treadmill: bool,
    rngs: list[np.random.Generator],
) -> Walk:
    strides, path, error = rngs
    walker = make_walker(parameters)
    if treadmill:
        markers, speed = record_on_treadmill(walker, times, strides), walker.stride_length * walker.frequency
    else:
        markers, speed = record_on_floor(walker, times, strides, path), float("nan")
    return Walk(markers + noise * error.standard_normal(markers.shape), frame_rate, name=name, speed=speed)


def _feature_axes() -> pd.DataFrame:
    """Central differences around the average walker, one pair of strides a trait."""
    average, effects = average_parameters(), trait_effects()
    axes = [
        (stride_features(average + _STEP * effect) - stride_features(average - _STEP * effect)) / (2 * _STEP)
        for effect in effects.T
    ]
    return pd.DataFrame(np.column_stack(axes), index=list(FEATURES), columns=list(TRAITS))
