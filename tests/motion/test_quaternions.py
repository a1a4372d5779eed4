"""Quaternions of compiled loops against those of scipy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from eigenwalker.motion._quaternions import (
    about,
    from_rotvec,
    product,
    product_of_inverse,
    rotvecs_between,
    shortest_turn,
    to_rotvec,
    turned,
)

_angles = st.floats(0, np.pi) | st.sampled_from([0.0, 1e-300, 1e-12, 1e-9, 1e-5, np.pi - 1e-9, np.pi / 2, np.pi])
_random_axes = st.integers(0, 10_000).map(lambda seed: np.random.default_rng(seed).normal(size=3))
_axes = _random_axes | st.sampled_from(tuple(np.eye(3)))


def _rotation(turn):
    return Rotation.from_quat(turn, scalar_first=True)


@given(angle=_angles, axis=_axes)
def test_exponential_maps_come_back(angle, axis):
    """At half a turn either direction will do."""
    rotvec = angle * axis / np.linalg.norm(axis)
    turn = from_rotvec(tuple(rotvec))
    assert_allclose(_rotation(turn).as_matrix(), Rotation.from_rotvec(rotvec).as_matrix(), atol=1e-14)
    assert_allclose(about(tuple(axis), angle), turn, atol=1e-15)
    back = np.array(to_rotvec(turn))
    assert np.linalg.norm(back) <= np.pi + 1e-12
    assert min(np.abs(back - sign * rotvec).max() for sign in (1, -1 if angle > np.pi - 1e-6 else 1)) < 1e-9
    assert_allclose(to_rotvec(tuple(-np.array(turn))), back, atol=1e-9 if angle < np.pi - 1e-6 else 7)


@given(seed=st.integers(0, 10_000))
def test_products_are_those_of_rotations(seed):
    rng = np.random.default_rng(seed)
    a, b = (tuple(part / np.linalg.norm(part)) for part in rng.normal(size=(2, 4)))
    vector = tuple(rng.normal(size=3))
    assert_allclose(turned(a, vector), _rotation(a).apply(vector), atol=1e-14)
    assert_allclose(_rotation(product(a, b)).as_matrix(), (_rotation(a) * _rotation(b)).as_matrix(), atol=1e-14)
    between = _rotation(product_of_inverse(a, b))
    assert_allclose((_rotation(a) * between).as_matrix(), _rotation(b).as_matrix(), atol=1e-14)


@given(seed=st.integers(0, 10_000), share=st.sampled_from([0.0, 1e-9, 1e-3, 1.0]))
def test_the_shortest_turn_leads_from_one_direction_to_the_other(seed, share):
    start, aside = np.random.default_rng(seed).normal(size=(2, 3))
    end = 2.0 * (start + share * aside)
    turn = _rotation(shortest_turn(tuple(start), tuple(end)))
    assert_allclose(turn.apply(start) * np.linalg.norm(end), end * np.linalg.norm(start), atol=1e-12)
    assert_allclose(turn.as_rotvec() @ start, 0.0, atol=1e-12)  # about an axis across both


def test_turns_between_arrays_of_quaternions():
    first, second = (Rotation.random(20, random_state=seed) for seed in (0, 1))
    found = rotvecs_between(*(turns.as_quat(scalar_first=True) for turns in (first, second)))
    assert_allclose((first * Rotation.from_rotvec(found)).as_matrix(), second.as_matrix(), atol=1e-14)
    assert rotvecs_between(np.zeros((0, 4)), np.zeros((0, 4))).shape == (0, 3)
