import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import solveh_banded

from eigenwalker.hsmm import generation
from eigenwalker.hsmm.features import WINDOWS, append_dynamics
from eigenwalker.hsmm.generation import generate_trajectory, normal_equations, undo_transform
from tests.hsmm.dense_generation import dense_equations, dense_windows, random_states

HTS_WINDOWS = ((1.0,), (-0.5, 0.0, 0.5), (1.0, -2.0, 1.0))  # of HTS: its second delta couples all frames
LOPSIDED_WINDOWS = ((1.0,), (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.5), (0.3, -0.1, 0.7))  # frames 3 to 5 apart not coupled


@given(
    seed=st.integers(0, 2**32 - 1),
    n_states=st.integers(1, 8),
    n_frames=st.integers(1, 6),
    n_channels=st.integers(1, 20),
    windows=st.sampled_from([WINDOWS, HTS_WINDOWS, LOPSIDED_WINDOWS, WINDOWS[:1], WINDOWS[:2]]),
)
def test_equals_a_dense_solution(seed, n_states, n_frames, n_channels, windows):
    means, variances = random_states(np.random.default_rng(seed), n_states, n_frames, n_channels, len(windows))
    matrices, right = dense_equations(means, variances, windows)
    expected = np.linalg.solve(matrices, right[..., np.newaxis])[..., 0].T
    assert np.allclose(generate_trajectory(means, variances, windows=windows), expected, rtol=0, atol=1e-10)


def test_equals_banded_solutions_of_scipy():
    means, variances = random_states(np.random.default_rng(0), 60, 10, 54)
    bands, right, step = normal_equations(means, variances)
    trajectory = generate_trajectory(means, variances)
    for channel in range(54):
        lower = np.zeros((5, 600))
        for band in range(3):
            lower[band * step, : 600 - band * step] = bands[band * step :, band, channel]
        expected = solveh_banded(lower, right[:, channel], lower=True)
        assert np.allclose(trajectory[:, channel], expected, rtol=0, atol=1e-12)


def test_blocks_of_channels_change_nothing(monkeypatch):
    means, variances = random_states(np.random.default_rng(0), 10, 5, 54)
    whole = generate_trajectory(means, variances)
    monkeypatch.setattr(generation, "_BLOCK_BYTES", 0)
    assert np.array_equal(generate_trajectory(means, variances), whole)


def test_a_walk_with_its_own_dynamics_comes_back():
    """Means without contradiction: no trajectory is more likely than they are."""
    walk = np.cumsum(np.random.default_rng(0).normal(size=(80, 7)), axis=0)
    means = np.nan_to_num(append_dynamics(walk))
    variances = np.random.default_rng(1).uniform(0.1, 2, means.shape)
    assert np.allclose(generate_trajectory(means, variances), walk, rtol=0, atol=1e-12)


def test_dynamics_of_which_nothing_is_known_leave_the_means():
    means, variances = random_states(np.random.default_rng(0), 5, 4, 3)
    variances[:, 3:] = np.inf
    assert np.allclose(generate_trajectory(means, variances), means[:, :3], rtol=1e-15)


@pytest.mark.parametrize("n_frames", [1, 2])
def test_shorter_than_any_dynamics(n_frames):
    """No window but the static one lies within the walk."""
    means, variances = random_states(np.random.default_rng(0), 1, n_frames, 3)
    assert np.allclose(generate_trajectory(means, variances), means[:, :3], rtol=1e-15)


def test_one_state_without_motion_is_constant():
    means, variances = random_states(np.random.default_rng(0), 1, 20, 3)
    means[:, 3:] = 0.0
    assert np.allclose(generate_trajectory(means, variances), means[:, :3], rtol=0, atol=1e-14)


def test_even_and_odd_frames_are_not_coupled():
    """By the windows of Eq. 2 and 3, which a jump of the means turns into a zigzag; by those of HTS they are."""
    means, variances = np.repeat([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], 3, axis=0), np.tile([1.0, 0.1, 0.1], (6, 1))
    assert np.diff(generate_trajectory(means, variances).ravel()).min() < -0.1
    assert np.diff(generate_trajectory(means, variances, windows=HTS_WINDOWS).ravel()).min() > 0
    assert normal_equations(np.zeros((9, 3)), np.ones((9, 3))).step == 2
    assert normal_equations(np.zeros((9, 3)), np.ones((9, 3)), windows=HTS_WINDOWS).step == 1


@pytest.mark.parametrize("windows", [WINDOWS, HTS_WINDOWS])
def test_a_shared_transform_is_the_full_covariance_answer(windows):
    """Dense, over all channels at once: means A^-1 (mu - b) and covariances A^-1 S A^-T of each frame and window."""
    random = np.random.default_rng(0)
    n_frames, n_channels = 24, 4
    means, variances = random_states(random, 6, 4, n_channels)
    transform = np.eye(n_channels) + 0.3 * random.normal(size=(n_channels, n_channels))
    bias = random.normal(size=n_channels)

    matrix, right = np.zeros((n_frames * n_channels,) * 2), np.zeros(n_frames * n_channels)
    for position, rows in enumerate(dense_windows(n_frames, windows)):
        part = slice(position * n_channels, (position + 1) * n_channels)
        for frame in range(n_frames):
            row = np.kron(rows[frame], np.eye(n_channels))  # (n_channels, n_frames * n_channels)
            mean = np.linalg.solve(transform, means[frame, part] - (bias if position == 0 else 0))
            precision = transform.T / variances[frame, part] @ transform
            matrix += row.T @ precision @ row
            right += row.T @ precision @ mean
    expected = np.linalg.solve(matrix, right).reshape(n_frames, n_channels)

    trajectory = undo_transform(generate_trajectory(means, variances, windows=windows), transform, bias)
    assert np.allclose(trajectory, expected, rtol=0, atol=1e-10)


def test_faults_are_named():
    means, variances = np.zeros((5, 6)), np.ones((5, 6))
    with pytest.raises(ValueError, match=r"means must have shape \(n_frames, 3 \* n_channels\).*got \(5, 4\)"):
        generate_trajectory(means[:, :4], variances)
    with pytest.raises(ValueError, match=r"variances must have the shape of means, \(5, 6\), got \(4, 6\)"):
        generate_trajectory(means, variances[:4])
    with pytest.raises(ValueError, match="means must be finite"):
        generate_trajectory(np.full((5, 6), np.nan), variances)
    for wrong in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="variances must be positive, and finite for static channels"):
            generate_trajectory(means, np.full((5, 6), wrong))
    with pytest.raises(ValueError, match="odd number of coefficients"):
        generate_trajectory(means, variances, windows=((1.0,), (1.0, -1.0)))
