"""Small synthetic walks with known coefficients, for laws that must hold exactly."""

import numpy as np

from eigenwalker.motion import TROJE15, Walk, evaluate_harmonics, shift_phase

__all__ = ["body_coefficients", "make_walk"]

_HEIGHTS = {
    "head": 1.65,
    "clavicle": 1.45,
    "shoulder": 1.42,
    "elbow": 1.12,
    "wrist": 0.88,
    "pelvis": 0.95,
    "hip": 0.93,
    "knee": 0.51,
    "ankle": 0.09,
}
_WIDTHS = {"shoulder": 0.19, "elbow": 0.23, "wrist": 0.25, "hip": 0.1, "knee": 0.1, "ankle": 0.09}
_SWINGS = {"knee": 0.22, "ankle": 0.33, "elbow": -0.08, "wrist": -0.2}


def body_coefficients(rng, n_harmonics=2, spread=0.02):
    """Return coefficients, shape (2 K + 1, 45), of a walker with some individuality.

    The first harmonic of left minus right ankle, forward, is a pure cosine.
    """
    coefficients = np.zeros((2 * n_harmonics + 1, 15, 3))
    for marker, name in enumerate(TROJE15.names):
        side, _, joint = name.rpartition("_")
        sign = {"left": 1.0, "right": -1.0, "": 0.0}[side]
        coefficients[0, marker] = (0.0, sign * _WIDTHS.get(joint, 0.0), _HEIGHTS[joint])
        coefficients[2, marker, 0] = sign * _SWINGS.get(joint, 0.0)
        if n_harmonics > 1:
            coefficients[4, marker, 2] = 0.02
    coefficients += rng.normal(scale=spread, size=coefficients.shape)
    if n_harmonics > 2:
        coefficients[5:] *= 0.3
    left, right = TROJE15.index("left_ankle"), TROJE15.index("right_ankle")
    coefficients[1, left, 0] = coefficients[1, right, 0]
    return coefficients.reshape(2 * n_harmonics + 1, -1)


def make_walk(
    rng, *, n_harmonics=2, frequency=0.93, n_cycles=5.0, frame_rate=120.0, noise=0.0, phase=0.0, name="", **fields
):
    """Return a walk in place with known coefficients, and the coefficients."""
    coefficients = body_coefficients(rng, n_harmonics)
    times = np.arange(round(n_cycles * frame_rate / frequency)) / frame_rate
    channels = evaluate_harmonics(shift_phase(coefficients, phase), frequency, times)
    channels = channels + noise * rng.normal(size=channels.shape)
    return Walk(channels.reshape(len(times), 15, 3), frame_rate, name=name, **fields), coefficients
