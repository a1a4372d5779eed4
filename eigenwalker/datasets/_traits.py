"""Who the walkers are, and what each trait does to the generator's parameters.

Height and weight by sex: Gordon et al. (2014), 2012 Anthropometric Survey of U.S. Army Personnel, NATICK/TR-15/007.
What the traits do: Troje (2002), section 5, for gender and weight; Michalak, Troje et al. (2009), Psychosom. Med. 71,
580-587, and Montepare, Goldstein & Clausen (1987), J. Nonverbal Behav. 11, 33-42, for mood. The sizes of the effects
are chosen so that gender is about as hard to tell as in Troje (2002), and are not measurements of people.
"""

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker.datasets._parameters import PARAMETERS, unit_of

__all__ = ["TRAITS", "TRAIT_CENTERS", "TRAIT_SCALES", "draw_traits", "trait_effects", "trait_table"]

TRAITS = ("gender", "age", "height", "weight", "happy", "nervous")
"""Gender counts -1 for female and +1 for male."""

# Standing height in m and weight in kg: mean and standard deviation.
_HEIGHT = {-1.0: (1.629, 0.064), 1.0: (1.756, 0.069)}
_WEIGHT = {-1.0: (67.8, 11.0), 1.0: (85.5, 14.2)}
_HEIGHT_WEIGHT_CORRELATION = 0.47  # within a sex
_HAPPY_NERVOUS_CORRELATION = -0.25
_AGES = (20.0, 60.0)  # evenly spread

TRAIT_CENTERS = np.array([0.0, 40.0, 1.692, 76.6, 0.0, 0.0])
TRAIT_SCALES = np.array([1.0, 11.5, 0.092, 15.5, 1.0, 1.0])
"""Mean and standard deviation of each trait over both sexes."""

# Change per standard deviation of the trait, the others held. Angles in degrees, lengths in metres, hertz.
_EFFECTS: dict[str, dict[str, float]] = {
    "gender": {
        "shoulder_breadth": 0.030,
        "hip_breadth": -0.028,
        "pelvis_obliquity_sin1": -1.2,
        "pelvis_obliquity_cos1": -0.85,
        "hip_abduction_gain": 0.12,
        "trunk_obliquity_gain": 0.20,
        "shoulder_abduction_mean": 1.6,
        "elbow_flexion_mean": 1.0,
        "pelvis_rotation_gain": -0.12,
        "pelvis_tilt_mean": -1.0,
        "hip_abduction_mean": 0.25,
    },
    "age": {
        "trunk_tilt_mean": 0.8,
        "neck_flexion_mean": 1.5,
        "hip_flexion_gain": -0.02,
        "foot_pitch_gain": -0.03,
        "shoulder_flexion_gain": -0.04,
    },
    "height": {"stature": 0.092, "frequency": -0.022},
    "weight": {
        "hip_breadth": 0.03,
        "hip_abduction_mean": 0.75,
        "shoulder_abduction_mean": 2.4,
        "hip_abduction_gain": 0.10,
        "frequency": -0.022,
        "bounce": -1.1,
        "hip_flexion_gain": -0.022,
        "foot_pitch_gain": -0.04,
        "trunk_tilt_mean": -0.8,
    },
    "happy": {
        "bounce": 1.3,
        "shoulder_flexion_gain": 0.14,
        "elbow_flexion_gain": 0.12,
        "trunk_tilt_mean": -1.3,
        "neck_flexion_mean": -2.8,
        "shoulder_lift": 0.004,
        "shoulder_forward": -0.006,
        "head_forward": -0.005,
        "hip_flexion_gain": 0.020,
        "knee_flexion_gain": 0.02,
        "foot_pitch_gain": 0.06,
        "frequency": 0.018,
    },
    "nervous": {
        "shoulder_lift": 0.007,
        "elbow_flexion_mean": 3.2,
        "shoulder_flexion_gain": -0.09,
        "elbow_flexion_gain": -0.15,
        "trunk_rotation_gain": -0.15,
        "pelvis_rotation_gain": -0.15,
        "trunk_obliquity_gain": -0.15,
        "hip_flexion_gain": -0.02,
        "shoulder_flexion_mean": 1.5,
        "frequency": 0.026,
    },
}


def trait_effects() -> NDArray[np.float64]:
    """Return the change of each parameter per standard deviation of each trait, shape (n_parameters, n_traits)."""
    effects = np.zeros((len(PARAMETERS), len(TRAITS)))
    for column, trait in enumerate(TRAITS):
        for parameter, change in _EFFECTS[trait].items():
            effects[PARAMETERS.index(parameter), column] = change * unit_of(parameter)
    return effects


def draw_traits(gender: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return the traits of one random person of a gender, shape (n_traits,)."""
    age, tall, heavy, happy, nervous = (rng.random(), *rng.standard_normal(4))
    heavy = _correlated(tall, heavy, _HEIGHT_WEIGHT_CORRELATION)
    nervous = _correlated(happy, nervous, _HAPPY_NERVOUS_CORRELATION)
    height, weight = (mean + sd * z for (mean, sd), z in ((_HEIGHT[gender], tall), (_WEIGHT[gender], heavy)))
    return np.array([gender, np.interp(age, (0, 1), _AGES), height, max(weight, 40.0), happy, nervous])


def _correlated(first: float, second: float, correlation: float) -> float:
    return correlation * first + np.sqrt(1 - correlation**2) * second


def trait_table(traits: NDArray[np.float64], names: list[str]) -> pd.DataFrame:
    """Return the traits of walkers, shape (n_walkers, n_traits), as a table with words for the genders."""
    table = pd.DataFrame(traits, index=pd.Index(names, name="name"), columns=list(TRAITS))
    return table.assign(gender=np.where(traits[:, 0] > 0, "male", "female"))
