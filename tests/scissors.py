"""Walkers in place: one with stiff legs, of whom it is known where each step leads, and one like a person."""

import numpy as np

from eigenwalker.datasets._gait_curves import NORMATIVE, curve_values, stride_waves
from eigenwalker.motion import JointWalk
from tests.planted import ANKLE, LEG, skeleton_with_feet

__all__ = ["HIGHEST", "SWING", "mirrored", "scissor_walk", "walker"]

SWING = 0.35  # radians by which a hip swings to either side
HIGHEST = LEG + ANKLE  # of the root, over both feet

_LEG = np.array([NORMATIVE[name] for name in ("hip_flexion", "knee_flexion", "foot_pitch")])


def scissor_walk(n_frames=300, *, frame_rate=60.0, frequency=0.9, start=0.0, skeleton=None, **fields):
    """Return a walk in place whose hips swing against each other, left foot ahead at first; feet stay level.

    Each leg is a stiff rod of 0.8 m and each sole is level, so that a standing ankle goes by the sine of the hip.
    """
    skeleton = skeleton or skeleton_with_feet()
    hip = SWING * np.cos(2 * np.pi * (frequency * np.arange(n_frames) / frame_rate + start))
    rotations = np.zeros((n_frames, len(skeleton.joint_names), 3))
    for side, sign in (("Left", -1.0), ("Right", 1.0)):
        rotations[:, skeleton.index(f"{side}UpLeg"), 1] = sign * hip
        rotations[:, skeleton.index(f"{side}Foot"), 1] = -sign * hip
    return JointWalk(rotations, np.zeros((n_frames, 3)), skeleton, frame_rate, **({"name": "scissors"} | fields))


def walker(n_frames=300, *, frame_rate=60.0, frequency=0.9, start=0.0, skeleton=None, **fields):
    """Return a walk in place like a person's: legs as the average adult's, feet turned out, a pelvis that turns."""
    skeleton = skeleton or skeleton_with_feet()
    phase = frequency * np.arange(n_frames) / frame_rate + start
    rotations, index = np.zeros((n_frames, len(skeleton.joint_names), 3)), skeleton.index
    for side, shift, out in (("Left", 0.0, 1.0), ("Right", 0.5, -1.0)):
        hip, knee, foot = curve_values(_LEG, stride_waves(phase + shift)).T
        rotations[:, index(f"{side}UpLeg"), 1] = -hip
        rotations[:, index(f"{side}Leg"), 1] = knee
        rotations[:, index(f"{side}Foot"), 1] = hip - knee - foot
        rotations[:, index(f"{side}Foot"), 2] = out * (0.1 + 0.02 * np.sin(2 * np.pi * (phase + shift)))
    turn = 2 * np.pi * phase
    rotations[:, index("Hips")] = 0.04 * np.column_stack((np.sin(turn), 0.5 * np.cos(2 * turn), np.cos(turn)))
    return JointWalk(rotations, np.zeros((n_frames, 3)), skeleton, frame_rate, **({"name": "walker"} | fields))


def mirrored(walk):
    """Return a walk of a symmetric skeleton in the mirror: left and right change places, y changes sign."""
    names = walk.skeleton.joint_names
    other = [names.index(_other(name)) for name in names]
    return JointWalk(
        walk.rotations[:, other] * [-1.0, 1.0, -1.0],
        walk.root * [1.0, -1.0, 1.0],
        walk.skeleton,
        walk.frame_rate,
        walk.name,
    )


def _other(name):
    if name.startswith("Left"):
        return "Right" + name.removeprefix("Left")
    return "Left" + name.removeprefix("Right") if name.startswith("Right") else name
