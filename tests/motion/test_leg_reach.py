"""Legs that reach: where nothing is asked nothing moves; else the ankle is where it should be."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from eigenwalker.motion.leg_reach import reach

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
    pelvis, feet = (Rotation.from_matrix(part).as_quat(scalar_first=True) for part in (pelvis, feet))
    found = reach(rotations, pelvis, hips, THIGH, SHANK, ankles, feet, pivot, held, swivel, max_knee=max_knee)
    return found._replace(foot=Rotation.from_quat(found.foot, scalar_first=True).as_matrix())


@given(st.integers(0, 10_000), st.floats(0, 1))
def test_nothing_asked_is_nothing_done(seed, held):
    rotations, pelvis, hips, ankles, feet = _leg(seed)
    found = _reach(rotations, pelvis, hips, ankles, feet, held=held)
    assert_allclose(found.rotations, rotations, atol=1e-9)
    assert_allclose(found.foot, feet, atol=1e-12)
    assert_allclose(found.knee, 0.0, atol=1e-9)
    assert_allclose(found.missed, 0.0, atol=1e-12)


def test_nothing_asked_of_a_straight_leg_is_nothing_done():
    """Its knee would turn by the root of any rounding."""
    rotations = np.zeros((3, 3, 3))
    pelvis, hips = _matrices(np.random.default_rng(0).normal(scale=0.2, size=(3, 3))), np.zeros((3, 3))
    ankles, feet = _forward(rotations, pelvis, hips)
    assert_allclose(_reach(rotations, pelvis, hips, ankles, feet).rotations, 0.0, atol=1e-9)


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
    assert_allclose(found.foot, lying, atol=1e-14)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.02, 0.4))
def test_the_knee_keeps_to_its_bound_and_what_is_missed_is_said(seed, max_knee):
    rotations, pelvis, hips, ankles, feet = _leg(seed)
    asked = hips + (ankles - hips) * 1.5  # further than any leg
    found = _reach(rotations, pelvis, hips, asked, feet, max_knee=max_knee)
    there, _ = _forward(found.rotations, pelvis, hips)
    assert (np.abs(found.knee) <= max_knee + 1e-9).all()
    assert_allclose(np.linalg.norm(there - asked, axis=1), found.missed, atol=1e-9)


@given(st.integers(0, 10_000), st.floats(0.02, 0.15))
def test_what_a_held_foot_does_is_roll_about_its_pivot_and_its_own_axis(seed, far):
    """By 20 degrees at most; by what that does not do the pivot is missed."""
    rotations, pelvis, hips, ankles, feet = _leg(seed)
    away = (ankles - hips) / np.linalg.norm(ankles - hips, axis=1, keepdims=True)
    toes = np.array([0.13, 0.0, -0.09])
    asked = ankles + far * away
    pivot = asked + feet @ toes
    found = _reach(rotations, pelvis, hips, asked, feet, pivot=pivot, held=1.0, max_knee=0.05)
    there, lying = _forward(found.rotations, pelvis, hips)
    assert_allclose(lying, found.foot, atol=1e-9)
    rolled = Rotation.from_matrix(lying @ feet.transpose(0, 2, 1)).as_rotvec()
    about = (rolled * feet[:, :, 1]).sum(axis=1)
    assert_allclose(rolled, about[:, np.newaxis] * feet[:, :, 1], atol=1e-9)
    assert (np.abs(about) <= np.deg2rad(20) + 1e-9).all()
    assert_allclose(np.linalg.norm(there + lying @ toes - pivot, axis=1), found.missed, atol=1e-9)


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
    up = (hips - ankles) / np.linalg.norm(hips - ankles, axis=1, keepdims=True)
    assert_allclose(knees[1] - ankles, Rotation.from_rotvec(0.2 * up).apply(knees[0] - ankles), atol=1e-9)


def test_a_leg_that_is_too_short_is_nearly_stretched():
    rotations, pelvis, hips, ankles, feet = _leg(4)
    found = _reach(rotations, pelvis, hips, hips + 1.5 * (ankles - hips), feet, max_knee=np.pi)
    there, _ = _forward(found.rotations, pelvis, hips)
    length = np.linalg.norm(THIGH) + np.linalg.norm(SHANK)
    assert_allclose(np.linalg.norm(there - hips, axis=1), 0.9999 * length, rtol=1e-9)


@given(st.integers(0, 10_000))
def test_knees_that_are_nearly_straight_get_there_too(seed):
    """Their axis is hardly known, and leans toward y."""
    rng = np.random.default_rng(seed)
    rotations = rng.normal(scale=0.02, size=(5, 3, 3))
    pelvis, hips = _matrices(rng.normal(scale=0.2, size=(5, 3))), np.zeros((5, 3))
    ankles, feet = _forward(rotations, pelvis, hips)
    asked = 0.95 * ankles
    there, _ = _forward(_reach(rotations, pelvis, hips, asked, feet, max_knee=np.pi).rotations, pelvis, hips)
    assert_allclose(there, asked, atol=1e-9)


def test_a_straight_leg_bends_forward():
    rotations = np.zeros((1, 3, 3))
    pelvis, hips = np.eye(3)[np.newaxis], np.zeros((1, 3))
    ankles, feet = _forward(rotations, pelvis, hips)
    asked = ankles + np.array([0.0, 0.0, 0.05])
    found = _reach(rotations, pelvis, hips, asked, feet, max_knee=1.0)
    assert found.rotations[0, 1, 1] > 0.3
    assert_allclose(_forward(found.rotations, pelvis, hips)[0], asked, atol=1e-9)
