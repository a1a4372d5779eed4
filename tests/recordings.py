"""Recordings of a walker with turns and stops, and of one whose cadence drifts, with everything known."""

from dataclasses import replace

import numpy as np
from numpy.polynomial.legendre import legvander
from scipy.ndimage import gaussian_filter1d

from eigenwalker.motion import Walk
from tests.synthetic import body_coefficients

__all__ = ["around", "drifting_walk", "legendre_drift", "over_the_floor", "record", "turned", "walked_curve"]

FREQUENCY = 0.93
SPEED = 1.3


def turned(walk, degrees):
    """Return a walk turned about the vertical, counter-clockwise as seen from above."""
    return replace(walk, positions=walk.positions @ _rotations(np.deg2rad([degrees]))[0].T)


def around(walk):
    """Return a walk in place with the pelvis over the origin on average, as `prepare` leaves it."""
    place = walk.marker("pelvis").mean(axis=0) * [1, 1, 0]
    return replace(walk, positions=walk.positions - place)


def over_the_floor(still, *, speed=SPEED):
    """Return a walk in place as it goes along x."""
    along = speed * np.arange(still.n_frames) / still.frame_rate
    return replace(still, positions=still.positions + along[:, np.newaxis, np.newaxis] * [1.0, 0.0, 0.0])


def record(parts, *, seed=0, frame_rate=60.0, noise=0.0, name="anna"):
    """Return one recording of parts in a row: (what, seconds, degrees turned to the left meanwhile).

    "walk" goes ahead with full strides, "turn" steps on the spot with small ones, "stand" does not move. Between the
    parts everything changes within a fifth of a second.
    """
    n_frames = [round(seconds * frame_rate) for _, seconds, _ in parts]
    swing = np.repeat([{"walk": 1.0, "turn": 0.3, "stand": 0.0}[what] for what, *_ in parts], n_frames)
    ahead = np.repeat([SPEED * (what == "walk") for what, *_ in parts], n_frames)
    turning = np.repeat([np.deg2rad(angle) / seconds for _, seconds, angle in parts], n_frames)
    swing, ahead, turning = (gaussian_filter1d(values, 0.1 * frame_rate) for values in (swing, ahead, turning))
    angles = np.cumsum(turning) / frame_rate
    rng = np.random.default_rng(seed)
    coefficients = body_coefficients(rng)
    phase = 2 * np.pi * FREQUENCY * np.arange(len(angles)) / frame_rate
    moving = coefficients[0] + swing[:, np.newaxis] * (_waves(phase, 2) @ coefficients[1:])
    body = around(Walk(moving.reshape(len(phase), 15, 3), frame_rate)).positions
    steps = ahead[:, np.newaxis] * np.column_stack((np.cos(angles), np.sin(angles))) / frame_rate
    positions = body @ _rotations(angles).transpose(0, 2, 1)
    positions[..., :2] += np.cumsum(steps, axis=0)[:, np.newaxis]
    return Walk(positions + noise * rng.normal(size=positions.shape), frame_rate, name=name)


def walked_curve(still, total, *, speed=SPEED):
    """Return a walk in place as it goes along an arc and turns by `total` radians, its mean direction along x."""
    times = np.arange(still.n_frames) / still.frame_rate
    angles = total * (times / times[-1] - 0.5)
    radius = speed * times[-1] / total
    path = radius * np.column_stack((np.sin(angles), -np.cos(angles), np.zeros_like(angles)))
    return replace(still, positions=still.positions @ _rotations(angles).transpose(0, 2, 1) + path[:, np.newaxis])


def drifting_walk(drift, *, seed=0, frequency=FREQUENCY, frame_rate=60.0, n_harmonics=2, noise=0.0, **fields):
    """Return a walk in place whose phase runs ahead of a steady one by `drift` radians, and that phase."""
    rng = np.random.default_rng(seed)
    coefficients = body_coefficients(rng, n_harmonics)
    phase = 2 * np.pi * frequency * np.arange(len(drift)) / frame_rate + drift
    channels = coefficients[0] + _waves(phase, n_harmonics) @ coefficients[1:]
    channels = channels + noise * rng.normal(size=channels.shape)
    return Walk(channels.reshape(len(phase), 15, 3), frame_rate, name="anna", **fields), phase


def legendre_drift(seed, n_frames, n_terms, largest):
    """Return random polynomials P_2 ... P_n_terms over a walk, at most `largest` radians from zero."""
    terms = np.random.default_rng(seed).normal(size=n_terms - 1)
    drift = legvander(np.linspace(-1.0, 1.0, n_frames), n_terms)[:, 2:] @ terms
    return largest * drift / np.abs(drift).max()


def _waves(phase, n_harmonics):
    """Return sin 1, cos 1, sin 2, ... of a phase, shape (n_frames, 2 K)."""
    angles = np.outer(phase, np.arange(1, n_harmonics + 1))
    return np.stack((np.sin(angles), np.cos(angles)), axis=2).reshape(len(phase), -1)


def _rotations(angles):
    """Return rotations about z, counter-clockwise, shape (n_angles, 3, 3)."""
    cosine, sine, zero, one = np.cos(angles), np.sin(angles), np.zeros_like(angles), np.ones_like(angles)
    return np.array([[cosine, -sine, zero], [sine, cosine, zero], [zero, zero, one]]).transpose(2, 0, 1)
