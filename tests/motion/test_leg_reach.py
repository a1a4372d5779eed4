"""Legs that reach: where nothing is asked nothing moves; else the ankle is where it should be."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from eigenwalker.motion.leg_reach import reach
from eigenwalker.motion.rotations import rotvecs_of_matrices

THIGH, SHANK = np.array([0.01, 0.0, -0.4]), np.array([0.0, 0.005, -0.42])


def _matrices(rotvecs):
    return Rotation.from_rotvec(rotvecs).as_matrix()


def _leg(seed, n_frames=5):
    """Return rotations, axes of the pelvis, hips, ankles and feet of random legs with bent knees."""
    rng = np.random.default_rng(seed)
    rotations = rng.normal(scale=0.3, size=(n_frames, 3, 3))
    rotations[:, 1] = np.column_stack((np.zeros(n_frames), rng.uniform(0.7, 1.2, n_frames), np.zeros(n_frames)))
    pelvis, hips = _matrices(rng.normal(scale=0.2, size=(n_frames, 3))), rng.normal(size=(n_frames, 3))
    return (rotations, pelvis, hips, *_forward(rotations, pelvis, hips))


def _forward(rotations, pelvis, hips):
    """Return ankles and the axes of the feet, by forward kinematics."""
    thigh = pelvis @ _matrices(rotations[:, 0])
    shank = thigh @ _matrices(rotations[:, 1])
    return hips + thigh @ THIGH + shank @ SHANK, shank @ _matrices(rotations[:, 2])


def _reach(rotations, pelvis, hips, ankles, feet, *, pivot=None, held=0.0, swivel=0.0, max_knee=0.5):
    n_frames = len(rotations)
    pivot = ankles - [0.0, 0.0, 0.1] if pivot is None else pivot
    held, swivel = np.full(n_frames, held), np.full(n_frames, swivel)
    return reach(rotations, pelvis, hips, THIGH, SHANK, ankles, feet, pivot, held, swivel, max_knee=max_knee)


def test_nothing_asked_is_nothing_done():
    rotations, pelvis, hips, ankles, feet = _leg(0)
    found = _reach(rotations, pelvis, hips, ankles, feet, held=1.0)
    assert_allclose(_matrices(found.rotations.reshape(-1, 3)), _matrices(rotations.reshape(-1, 3)), atol=1e-9)
    assert_allclose(found.knee, 0.0, atol=1e-9)
    assert_allclose(found.missed, 0.0, atol=1e-12)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10_000))
def test_the_ankle_gets_there_and_the_foot_lies_as_asked(seed):
    rotations, pelvis, hips, ankles, _ = _leg(seed)
    rng = np.random.default_rng(seed + 1)
    asked = ankles + rng.uniform(-0.02, 0.02, ankles.shape)
    lying = _matrices(rng.normal(scale=0.4, size=(len(ankles), 3)))
    found = _reach(rotations, pelvis, hips, asked, lying, max_knee=1.0)
    there, feet = _forward(found.rotations, pelvis, hips)
    assert_allclose(there, asked, atol=1e-9)
    assert_allclose(feet, lying, atol=1e-9)
    assert_allclose(found.foot, lying, atol=1e-15)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.02, 0.4))
def test_the_knee_keeps_to_its_bound_and_what_is_missed_is_said(seed, max_knee):
    rotations, pelvis, hips, ankles, feet = _leg(seed)
    asked = hips + (ankles - hips) * 1.5  # further than any leg
    found = _reach(rotations, pelvis, hips, asked, feet, max_knee=max_knee)
    there, _ = _forward(found.rotations, pelvis, hips)
    assert (np.abs(found.knee) <= max_knee + 1e-9).all()
    assert_allclose(np.linalg.norm(there - asked, axis=1), found.missed, atol=1e-9)


def test_a_held_foot_rolls_about_its_pivot():
    """Where the leg is too short by a little, heel or toes rise, and the point on the floor stays."""
    rotations = np.array([[[0.0, -0.4, 0.0], [0.0, 0.05, 0.0], [0.0, 0.3, 0.0]]])
    pelvis, hips = np.eye(3)[np.newaxis], np.array([[0.0, 0.0, 0.9]])
    ankles, feet = _forward(rotations, pelvis, hips)
    toes = np.array([0.2, 0.0, -0.1])
    pivot = ankles + (feet @ toes) + [0.03, 0.0, 0.0]
    asked = ankles + np.array([0.03, 0.0, 0.0])
    free = _reach(rotations, pelvis, hips, asked, feet, pivot=pivot, max_knee=0.1)
    rolled = _reach(rotations, pelvis, hips, asked, feet, pivot=pivot, held=1.0, max_knee=0.1)
    assert free.missed[0] > 0.005
    assert rolled.missed[0] < 1e-9
    there, lying = _forward(rolled.rotations, pelvis, hips)
    assert_allclose(there + lying @ toes, pivot, atol=1e-9)


def test_swivel_turns_the_knee_out_and_leaves_the_foot():
    rotations, pelvis, hips, ankles, feet = _leg(3)
    found = _reach(rotations, pelvis, hips, ankles, feet, swivel=0.2)
    there, lying = _forward(found.rotations, pelvis, hips)
    assert_allclose(there, ankles, atol=1e-9)
    assert_allclose(lying, feet, atol=1e-9)
    knees = [hips + pelvis @ _matrices(turn[:, 0]) @ THIGH for turn in (rotations, found.rotations)]
    assert (np.linalg.norm(knees[1] - knees[0], axis=1) > 0.003).all()


def test_a_straight_leg_bends_forward():
    rotations = np.zeros((1, 3, 3))
    pelvis, hips = np.eye(3)[np.newaxis], np.zeros((1, 3))
    ankles, feet = _forward(rotations, pelvis, hips)
    asked = ankles + np.array([0.0, 0.0, 0.05])
    found = _reach(rotations, pelvis, hips, asked, feet, max_knee=1.0)
    assert found.rotations[0, 1, 1] > 0.3
    assert_allclose(_forward(found.rotations, pelvis, hips)[0], asked, atol=1e-9)


def test_exponential_maps_of_matrices_at_all_angles():
    rng = np.random.default_rng(0)
    axes = rng.normal(size=(400, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    angles = np.concatenate(
        (np.linspace(0, np.pi, 390), [1e-12, 1e-9, 1e-5, 1e-3, *np.pi - np.geomspace(1e-9, 1e-2, 6)])
    )
    matrices = _matrices(axes * angles[:, np.newaxis])
    found = rotvecs_of_matrices(matrices)
    assert (np.linalg.norm(found, axis=1) <= np.pi + 1e-12).all()
    assert_allclose(_matrices(found), matrices, atol=1e-14)
