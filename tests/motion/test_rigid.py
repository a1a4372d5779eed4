"""The motion of a rigid body from its points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

from eigenwalker.motion import fit_rigid


def _moved(rng, n_points, n_frames=7):
    source = rng.normal(size=(n_points, 3))
    rotation, translation = Rotation.random(n_frames, random_state=rng).as_matrix(), rng.normal(size=(n_frames, 3))
    return source, source @ np.swapaxes(rotation, 1, 2) + translation[:, np.newaxis], rotation, translation


@given(seed=st.integers(0, 10_000), n_points=st.integers(3, 7))
def test_motions_are_found_again(seed, n_points):
    source, target, rotation, translation = _moved(np.random.default_rng(seed), n_points)
    found = fit_rigid(source, target)
    # Three points may be nearly on a line, which costs digits.
    assert_allclose(found[0], rotation, atol=1e-6)
    assert_allclose(found[1], translation, atol=1e-6)


@given(seed=st.integers(0, 10_000), n_points=st.integers(3, 7))
def test_no_body_is_turned_inside_out(seed, n_points):
    rng = np.random.default_rng(seed)
    source, target, *_ = _moved(rng, n_points)
    rotation, _ = fit_rigid(source, -target + 0.3 * rng.normal(size=target.shape))
    assert_allclose(np.linalg.det(rotation), 1.0)
    assert_allclose(rotation @ np.swapaxes(rotation, 1, 2), np.broadcast_to(np.eye(3), rotation.shape), atol=1e-9)


def test_no_other_motion_is_nearer():
    rng = np.random.default_rng(0)
    source, target, *_ = _moved(rng, 5, n_frames=1)
    target = target + 0.2 * rng.normal(size=target.shape)
    rotation, translation = fit_rigid(source, target)
    best = np.linalg.norm(source @ rotation[0].T + translation - target[0])
    for turn, shift in zip(Rotation.random(50, random_state=1) ** 0.02, 0.02 * rng.normal(size=(50, 3)), strict=True):
        other = source @ (turn.as_matrix() @ rotation[0]).T + translation + shift
        assert np.linalg.norm(other - target[0]) >= best


def test_frames_without_all_points_stay_unknown():
    source, target, *_ = _moved(np.random.default_rng(0), 4)
    target[2, 1, 0] = np.nan
    target[5] = 0.0  # all points in one place tell nothing of a rotation
    rotation, translation = fit_rigid(source, target)
    assert_array_equal(np.isnan(rotation).any(axis=(1, 2)), np.isin(np.arange(7), (2, 5)))
    assert_array_equal(np.isnan(translation).any(axis=1), np.isin(np.arange(7), (2, 5)))


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (np.outer(np.arange(4.0), [1.0, 2.0, 3.0]), "not on one line.*add another"),
        (np.zeros((3, 3)), "not on one line"),
        (np.eye(3)[:2], "at least three points, got 2"),
        (np.full((3, 3), np.nan), "must be finite"),
        (np.zeros((3, 2)), r"source must have shape \(n_points, 3\), got \(3, 2\)"),
    ],
)
def test_bodies_that_tell_no_rotation_are_refused(source, message):
    with pytest.raises(ValueError, match=message):
        fit_rigid(source, np.zeros((1, len(source), 3)))


def test_points_must_be_the_same():
    with pytest.raises(ValueError, match=r"target must have shape \(n_frames, 3, 3\), got \(5, 4, 3\)"):
        fit_rigid(np.eye(3), np.zeros((5, 4, 3)))
