"""Random walks with realistic amplitudes, for timing and for errors against a known truth."""

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion import TROJE15, Walk, phase_weights

__all__ = ["ANKLES", "random_coefficients", "random_walk"]

# Amplitude of the first harmonic in metres along x, y and z.
_AMPLITUDES = {
    "ankle": (0.25, 0.02, 0.06),
    "knee": (0.12, 0.015, 0.02),
    "wrist": (0.15, 0.03, 0.02),
    "elbow": (0.06, 0.02, 0.01),
    "shoulder": (0.02, 0.01, 0.008),
    "hip": (0.02, 0.01, 0.012),
    "center": (0.005, 0.02, 0.002),
}
# Second to fourth harmonic as shares of the first; up and down the step (the second) is the main motion.
_HIGHER = np.array([[0.2, 0.3, 1.5], [0.1, 0.1, 0.3], [0.05, 0.05, 0.1]])  # (harmonic, axis)

#: Weight of each channel in the phase reference: left minus right ankle, forward.
ANKLES = phase_weights(Walk(np.zeros((1, len(TROJE15.names), 3)), frame_rate=1.0))


def random_coefficients(random: np.random.Generator, *, n_harmonics: int = 4) -> NDArray[np.float64]:
    """Return coefficients of a random walker, shape (2 n_harmonics + 1, 45), rows mean, sin1, cos1, ...

    Limbs swing in opposite phase left and right; all amplitudes and phases vary between walkers and markers.
    """
    first = np.array([_AMPLITUDES.get(name.split("_")[-1], _AMPLITUDES["center"]) for name in TROJE15.names])
    shares = np.concatenate((np.ones((1, 3)), _HIGHER))[:n_harmonics]
    amplitudes = shares[:, np.newaxis] * first * random.uniform(0.6, 1.4, (n_harmonics, *first.shape))
    phases = random.normal(scale=0.4, size=amplitudes.shape)
    right = np.array([name.startswith("right") for name in TROJE15.names])
    phases += np.pi * np.arange(1, n_harmonics + 1)[:, np.newaxis, np.newaxis] * right[:, np.newaxis]
    # Arms swing against legs.
    arms = np.array([name.endswith(("wrist", "elbow")) for name in TROJE15.names])
    phases[0] += np.pi * arms[:, np.newaxis]
    coefficients = np.empty((2 * n_harmonics + 1, first.size))
    coefficients[0] = random.normal(scale=0.5, size=first.size)
    coefficients[1::2] = (-amplitudes * np.sin(phases)).reshape(n_harmonics, -1)  # (K, 15, 3) -> (K, 45)
    coefficients[2::2] = (amplitudes * np.cos(phases)).reshape(n_harmonics, -1)
    return coefficients


def random_walk(
    random: np.random.Generator,
    coefficients: NDArray[np.float64],
    angles: NDArray[np.float64],
    noise: float,
) -> NDArray[np.float64]:
    """Return channels (n_frames, n_channels) of a walker at fundamental phases `angles`, with white noise in metres."""
    harmonics = np.exp(1j * np.outer(angles, np.arange(1, len(coefficients) // 2 + 1)))
    waves = np.stack((harmonics.imag, harmonics.real), axis=2).reshape(len(angles), -1)  # (n_frames, 2 K)
    channels = waves @ coefficients[1:]
    channels += coefficients[0]
    channels += noise * random.standard_normal(channels.shape)
    return channels
