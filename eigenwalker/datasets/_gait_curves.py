"""Normative joint angles of level walking, as Fourier coefficients over one stride.

The key values are read off published curves and rounded; they are facts about the average adult, not tables:

- hip (thigh against the vertical), knee and foot (against the floor): Perry & Burnfield (2010), Gait Analysis, 2nd
  ed.; Winter (1991), The Biomechanics and Motor Control of Human Gait; Kadaba, Ramakrishnan & Wootten (1990),
  J. Orthop. Res. 8, 383-392.
- pelvis: Kadaba et al. (1990) and Perry & Burnfield (2010). Obliquity is small here, because it is a mean over two
  sexes that move in opposite phase (Troje 2002, section 5; Smith, Lelas & Kerrigan 2002, J. Womens Health 11, 453-458).
- trunk: Krebs, Wong, Jevsevar, Riley & Hodge (1992), Phys. Ther. 72, 505-514.
- shoulder and elbow: Murray, Sepic & Barnard (1967), Phys. Ther. 47, 272-284.

Time is in strides from the heel strike of the curve's own foot (limbs) or of the left foot (pelvis, trunk, neck).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

__all__ = [
    "AXIAL_CURVES",
    "HEEL_LIFT",
    "LIMB_CURVES",
    "NORMATIVE",
    "N_HARMONICS",
    "curve_values",
    "shift_curve",
    "stride_waves",
]

N_HARMONICS = 6

# (percent of the stride, degrees). Flexion, abduction, inward rotation and toes up are positive. The swing curves
# of the arms' rotation and abduction are small and not well documented; their means carry the hands before the thighs.
_LIMB_KEYS = {
    "hip_flexion": (
        (0, 21.5), (6, 20.5), (12, 17), (20, 8.5), (31, -3.5), (42, -14), (51, -19), (62, -8), (75, 15), (86, 24),
        (94, 23),
    ),
    "knee_flexion": (
        (0, 5), (7, 11.5), (15, 17), (28, 10.5), (40, 5), (50, 10), (62, 39), (72, 61), (80, 50), (88, 22), (96, 4),
    ),
    "foot_pitch": (
        (0, 17), (5, 7), (10, 0), (18, 0), (27, 0), (35, -2), (43, -8), (50, -19), (57, -43), (64, -63), (70, -62),
        (76, -46), (82, -22), (88, 2), (94, 16),
    ),
    "hip_abduction": ((5, -2.8), (30, -4.1), (55, -2.8), (80, -1.5)),
    "hip_rotation": ((5, 1), (30, 2), (55, -2), (80, -3)),
    "shoulder_flexion": ((2, -21), (27, -4), (52, 13), (77, -4)),
    "shoulder_abduction": ((0, 10), (25, 8.6), (50, 9), (75, 9.4)),
    "shoulder_rotation": ((2, 22), (27, 25), (52, 28), (77, 25)),
    "elbow_flexion": ((4, 17), (30, 25), (54, 38), (80, 27)),
}  # fmt: skip

# Tilts and the neck are positive forward, obliquity with the left side up, rotation turned to the left.
_AXIAL_KEYS = {
    "pelvis_tilt": ((5, 9.2), (30, 10.8), (55, 9.2), (80, 10.8)),
    "pelvis_obliquity": ((15, 1.0), (40, 0.0), (65, -1.0), (90, 0.0)),
    "pelvis_rotation": ((0, -4.5), (25, 0.0), (50, 4.5), (75, 0.0)),
    "trunk_tilt": ((0, 2.4), (25, 0.6), (50, 2.4), (75, 0.6)),
    "trunk_obliquity": ((0, 0.0), (25, -2.0), (50, 0.0), (75, 2.0)),
    "trunk_rotation": ((3, 4.0), (28, 0.0), (53, -4.0), (78, 0.0)),
    "neck_flexion": ((5, 7.2), (30, 8.8), (55, 7.2), (80, 8.8)),
    "neck_obliquity": ((0, 0.0), (25, 1.0), (50, 0.0), (75, -1.0)),
}

LIMB_CURVES = tuple(_LIMB_KEYS)
AXIAL_CURVES = tuple(_AXIAL_KEYS)


def _coefficients(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return mean, sin1, cos1, ... of one period of evenly spaced values."""
    spectrum = np.fft.rfft(values)[: N_HARMONICS + 1] / len(values)
    result = np.empty(2 * N_HARMONICS + 1)
    result[0], result[1::2], result[2::2] = spectrum[0].real, -2 * spectrum[1:].imag, 2 * spectrum[1:].real
    return result


def _through_keys(keys: tuple[tuple[float, float], ...]) -> NDArray[np.float64]:
    """Return the coefficients, in radians, of the smooth periodic curve through key values in degrees."""
    percent, degrees = np.array(keys, dtype=np.float64).T
    closed = CubicSpline(np.append(percent, percent[0] + 100), np.append(degrees, degrees[0]), bc_type="periodic")
    grid = np.arange(200) / 2
    return _coefficients(np.deg2rad(closed(percent[0] + (grid - percent[0]) % 100)))


NORMATIVE: dict[str, NDArray[np.float64]] = {
    name: _through_keys(keys) for name, keys in (_LIMB_KEYS | _AXIAL_KEYS).items()
}
"""Coefficients mean, sin1, cos1, ... of each curve, in radians."""

# Rising on the ball of the foot around mid-stance lifts the whole body: the more of it, the bouncier the walk.
HEEL_LIFT: NDArray[np.float64] = _coefficients(np.exp(6 * (np.cos(2 * np.pi * (np.arange(200) / 200 - 0.35)) - 1)))
"""Coefficients of a bump of height 1 at 35 % of the stride."""


def shift_curve(coefficients: NDArray[np.float64], delay: float) -> NDArray[np.float64]:
    """Return the coefficients, last axis mean, sin1, cos1, ..., of a curve that comes `delay` strides later."""
    angles = 2 * np.pi * delay * np.arange(1, N_HARMONICS + 1)
    sines, cosines = coefficients[..., 1::2], coefficients[..., 2::2]
    shifted = coefficients.copy()
    shifted[..., 1::2] = sines * np.cos(angles) + cosines * np.sin(angles)
    shifted[..., 2::2] = cosines * np.cos(angles) - sines * np.sin(angles)
    return shifted


def stride_waves(phase: NDArray[np.float64], amplitude: NDArray[np.float64] | float = 1.0) -> NDArray[np.float64]:
    """Return sines and cosines of the stride, shape (n_phases, 2 K): sin1, cos1, sin2, ...

    Parameters
    ----------
    phase : ndarray of shape (n_phases,)
        In strides.
    amplitude : float or ndarray of shape (n_phases,), default 1.0
        Factor on all of them.
    """
    turn = np.exp(2j * np.pi * phase)
    powers = np.empty((len(phase), N_HARMONICS), dtype=np.complex128)
    powers[:, 0] = turn
    for harmonic in range(1, N_HARMONICS):
        powers[:, harmonic] = powers[:, harmonic - 1] * turn
    waves = np.stack((powers.imag, powers.real), axis=2).reshape(len(phase), -1)  # (n_phases, K, 2) -> (n_phases, 2 K)
    return waves * np.reshape(amplitude, (-1, 1))


def curve_values(coefficients: NDArray[np.float64], waves: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return curves, shape (n_phases, n_curves), from their coefficients, one curve a row, and `stride_waves`."""
    return coefficients[:, 0] + waves @ coefficients[:, 1:].T
