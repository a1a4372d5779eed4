"""The generator's linear parameter space: names, the average walker, and how much people differ."""

import numpy as np
from numpy.typing import NDArray

from eigenwalker.datasets._anatomy import BODY_PARAMETERS
from eigenwalker.datasets._gait_curves import AXIAL_CURVES, LIMB_CURVES

__all__ = ["CURVE_TERMS", "PARAMETERS", "SIDE_TERMS", "average_parameters", "individual_sd", "unit_of"]

CURVE_TERMS = ("mean", "gain", "delay", "sin1", "cos1", "sin2", "cos2", "sin3", "cos3")
"""What can differ in the curve of a joint: its mean, the factor on its excursion (minus one), its delay in strides,
and what is added to its first harmonics."""

SIDE_TERMS = ("side_mean", "side_gain", "side_sin1", "side_cos1", "side_sin2", "side_cos2")
"""Left minus right, of limbs."""

PARAMETERS: tuple[str, ...] = (
    *BODY_PARAMETERS,
    *(f"{curve}_{term}" for curve in LIMB_CURVES for term in (*CURVE_TERMS, *SIDE_TERMS)),
    *(f"{curve}_{term}" for curve in AXIAL_CURVES for term in CURVE_TERMS),
    "bounce",
    "frequency",
)

_AVERAGE = {"stature": 1.692, "bounce": np.deg2rad(3.0), "frequency": 0.94}
_WITHOUT_UNIT = ("gain", "delay", "side_gain")

# Standard deviations between people that no trait explains. Body: metres and relative deviations.
_BODY_SD: dict[str, float] = {
    "stature": 0.0,  # it is a trait
    "leg_length": 0.018,
    "shank_share": 0.012,
    "arm_length": 0.028,
    "forearm_share": 0.010,
    "neck_length": 0.05,
    "shoulder_breadth": 0.052,
    "hip_breadth": 0.070,
    "pelvis_depth": 0.008,
    "shoulder_lift": 0.012,
    "shoulder_forward": 0.011,
    "clavicle_forward": 0.010,
    "head_forward": 0.012,
}
# Shifts of joints along x, y and z, in metres.
_SHIFT_SD = {
    "shoulder": (0.008, 0.007, 0.008),
    "elbow": (0.010, 0.010, 0.005),
    "wrist": (0.010, 0.010, 0.005),
    "hip": (0.007, 0.005, 0.005),
    "knee": (0.010, 0.011, 0.004),
    "ankle": (0.010, 0.010, 0.003),
}
# Curves: mean (degrees), gain, delay (strides), first, second and third harmonic (degrees); left minus right: mean,
# gain, first and second harmonic.
_CURVE_SD: dict[str, tuple[float, ...]] = {
    "hip_flexion": (1.2, 0.030, 0.005, 1.1, 1.3, 0.9, 2.0, 0.05, 2.1, 1.8),
    "hip_abduction": (0.6, 0.12, 0.015, 0.50, 0.40, 0.25, 1.1, 0.08, 0.9, 0.8),
    "hip_rotation": (3.0, 0.30, 0.03, 2.6, 2.5, 1.0, 4.5, 0.20, 4.0, 4.0),
    "knee_flexion": (2.0, 0.045, 0.008, 2.1, 2.2, 1.5, 3.2, 0.05, 3.4, 3.2),
    "foot_pitch": (0.8, 0.080, 0.010, 0.9, 0.9, 0.7, 0.8, 0.06, 0.8, 0.8),
    "shoulder_flexion": (2.3, 0.11, 0.016, 2.1, 1.9, 0.8, 4.2, 0.15, 4.2, 3.3),
    "shoulder_abduction": (1.8, 0.18, 0.020, 1.8, 1.5, 0.6, 3.5, 0.15, 3.3, 2.6),
    "shoulder_rotation": (5.0, 0.25, 0.020, 3.7, 2.8, 0.8, 9.0, 0.20, 5.5, 4.0),
    "elbow_flexion": (4.0, 0.20, 0.020, 3.2, 3.0, 1.2, 6.5, 0.20, 6.0, 5.0),
    "pelvis_tilt": (3.5, 0.30, 0.03, 0.7, 1.2, 0.3),
    "pelvis_obliquity": (1.2, 0.20, 0.02, 1.6, 0.8, 0.4),
    "pelvis_rotation": (2.2, 0.25, 0.02, 2.2, 1.0, 0.6),
    "trunk_tilt": (1.7, 0.30, 0.03, 0.9, 0.9, 0.3),
    "trunk_obliquity": (1.2, 0.25, 0.02, 1.0, 0.8, 0.4),
    "trunk_rotation": (2.3, 0.25, 0.02, 2.0, 1.2, 0.5),
    "neck_flexion": (3.5, 0.30, 0.03, 1.4, 1.3, 0.4),
    "neck_obliquity": (2.9, 0.30, 0.03, 1.9, 1.3, 0.4),
}
_OTHER_SD = {"bounce": np.deg2rad(1.2), "frequency": 0.036}


def unit_of(parameter: str) -> float:
    """Return what one unit of this module's tables is in SI: a degree in radians for angles, else 1."""
    relative = any(parameter.endswith(f"_{term}") for term in _WITHOUT_UNIT)
    is_angle = parameter == "bounce" or (parameter.startswith(LIMB_CURVES + AXIAL_CURVES) and not relative)
    return float(np.deg2rad(1.0)) if is_angle else 1.0


def average_parameters() -> NDArray[np.float64]:
    """Return the average walker, shape (n_parameters,)."""
    return np.array([_AVERAGE.get(name, 0.0) for name in PARAMETERS])


def individual_sd() -> NDArray[np.float64]:
    """Return the standard deviation of each parameter between people with the same traits, shape (n_parameters,)."""
    spread = _BODY_SD | _OTHER_SD
    for joint, shifts in _SHIFT_SD.items():
        for side in ("left", "right"):
            spread |= {f"{side}_{joint}_shift_{axis}": sd for axis, sd in zip("xyz", shifts, strict=True)}
    for curve, (mean, gain, delay, first, second, third, *sides) in _CURVE_SD.items():
        terms = [mean, gain, delay, first, first, second, second, third, third]
        if sides:
            side_mean, side_gain, side_first, side_second = sides
            terms += [side_mean, side_gain, side_first, side_first, side_second, side_second]
        names = [f"{curve}_{term}" for term in (*CURVE_TERMS, *SIDE_TERMS)[: len(terms)]]
        spread |= {name: term * unit_of(name) for name, term in zip(names, terms, strict=True)}
    return np.array([spread[name] for name in PARAMETERS])
