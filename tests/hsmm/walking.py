"""Joint walks for gait models: steps that differ a little from each other, by a walker like a person."""

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from tests.scissors import walker

__all__ = ["shaken_walk", "shaken_walks", "step_arrays"]

_TURNING = ("Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "RightUpLeg", "RightLeg", "RightFoot")


def shaken_walk(
    seed=0, *, n_frames=300, frame_rate=60.0, frequency=0.9, start=0.1, noise=0.01, bend=0.0, jitter=0.0, **fields
):
    """Return a walk whose frequency differs by 3 %, with smooth noise of `noise` radians.

    `bend` radians more of each knee, all the time, are a style. Steps come early or late by `jitter` strides.
    """
    random = np.random.default_rng(seed)
    walk = walker(
        n_frames,
        frame_rate=frame_rate,
        frequency=frequency * (1 + 0.03 * random.normal()),
        start=start + 0.02 * random.normal() + jitter * _wander(seed, n_frames, frame_rate),
    )
    index = [walk.skeleton.index(name) for name in _TURNING]
    rotations = np.array(walk.rotations)
    white = random.normal(size=(n_frames + 20, len(index), 3))
    smooth = np.apply_along_axis(np.convolve, 0, white, np.hanning(21) / np.sqrt((np.hanning(21) ** 2).sum()), "valid")
    rotations[:, index] += noise * smooth
    rotations[:, [walk.skeleton.index("LeftLeg"), walk.skeleton.index("RightLeg")], 1] += bend
    kept = {"name": f"walk {seed}", "channel_joints": _TURNING} | fields
    return replace(walk, rotations=rotations, **kept)


def _wander(seed, n_frames, frame_rate):
    """Return a smooth path of independent normal values two seconds apart."""
    times = np.arange(n_frames) / frame_rate
    knots = np.arange(0.0, times[-1] + 2.0, 2.0)
    return CubicSpline(knots, np.random.default_rng([seed, 1]).normal(size=len(knots)))(times)


def shaken_walks(n_walks=6, *, first=0, **options):
    """Return some such walks, each with its own seed."""
    return [shaken_walk(first + at, **options) for at in range(n_walks)]


def step_arrays(n_walks=4, *, n_steps=8, noise=0.05, seed=0, frames=24):
    """Return arrays of two channels, a wave of two steps, and where their steps begin."""
    random = np.random.default_rng(seed)
    arrays, edges = [], []
    for _ in range(n_walks):
        lengths = frames + random.integers(-2, 3, size=n_steps)
        phase = np.concatenate([at + np.arange(n) / n for at, n in enumerate(lengths)]) * np.pi
        waves = np.column_stack((np.sin(phase), 0.5 * np.cos(2 * phase)))
        arrays.append(waves + noise * random.normal(size=waves.shape))
        edges.append(np.concatenate(([0], np.cumsum(lengths))))
    return arrays, edges
