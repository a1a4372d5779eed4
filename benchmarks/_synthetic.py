"""Random walks with realistic amplitudes, for timing and for errors against a known truth."""

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion import TROJE15, JointWalk, Skeleton, Walk, phase_weights

__all__ = ["ANKLES", "random_coefficients", "random_joint_walk", "random_walk"]

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


# Each chain of joints hangs from the joint before its colon; from joint to joint, in metres, forward, left and up.
_CHAINS = """
: Hips 0 0 0
Hips: LHipJoint 0 .02 -.02, LeftUpLeg 0 .07 -.06, LeftLeg 0 .02 -.41, LeftFoot 0 .02 -.40, LeftToeBase .12 0 -.04
Hips: RHipJoint 0 -.02 -.02, RightUpLeg 0 -.07 -.06, RightLeg 0 -.02 -.41, RightFoot 0 -.02 -.4, RightToeBase .12 0 -.04
Hips: LowerBack 0 0 .02, Spine 0 0 .11, Spine1 0 0 .11, Neck 0 0 .02, Neck1 .01 0 .08, Head .01 0 .09
Spine1: LeftShoulder 0 .01 .02, LeftArm 0 .18 .04, LeftForeArm 0 .28 0, LeftHand 0 .18 0, LeftFingerBase 0 .01 0
LeftFingerBase: LeftHandIndex1 0 .06 0
LeftHand: LThumb .04 .04 0
Spine1: RightShoulder 0 -.01 .02, RightArm 0 -.18 .04, RightForeArm 0 -.28 0, RightHand 0 -.18 0
RightHand: RightFingerBase 0 -.01 0
RightFingerBase: RightHandIndex1 0 -.06 0
RightHand: RThumb .04 -.04 0
"""


def random_joint_walk(random: np.random.Generator, n_frames: int) -> JointWalk:
    """Return smooth motion of a body with the 31 joints of the CMU database, 120 frames a second."""
    names, parents, offsets = list[str](), list[int](), list[list[float]]()
    for line in _CHAINS.strip().splitlines():
        held, _, chain = line.partition(":")
        for joint in chain.split(","):
            name, *offset = joint.split()
            parents.append(names.index(held) if held else -1)
            offsets.append([float(length) for length in offset])
            names.append(held := name)
    skeleton = Skeleton(tuple(names), np.array(parents), np.array(offsets))
    times = np.arange(n_frames)[:, np.newaxis, np.newaxis] / 120
    phases, speeds = random.uniform(0, 2 * np.pi, (2, len(names), 3))
    rotations = 0.4 * np.sin(speeds * times + phases)
    root = np.column_stack((1.3 * times.ravel(), 0.03 * np.sin(times.ravel()), 0.95 + 0.02 * np.cos(times.ravel())))
    return JointWalk(rotations, root, skeleton, 120.0, "random")
