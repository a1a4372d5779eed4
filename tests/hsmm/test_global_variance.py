import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eigenwalker.hsmm.features import WINDOWS
from eigenwalker.hsmm.generation import generate_trajectory
from eigenwalker.hsmm.global_variance import GlobalVariance, generate_with_variance, measure_global_variance
from tests.hsmm.dense_generation import dense_equations, random_states

HTS_WINDOWS = ((1.0,), (-0.5, 0.0, 0.5), (1.0, -2.0, 1.0))


def _objective(trajectory, matrices, right, target, weight, *, used=slice(None), n_windows=3):
    """Return the logarithm of Eq. 15 up to a constant, one value a channel; and its gradient."""
    c, part = trajectory.T, trajectory.T[:, used]
    omega = weight / (n_windows * part.shape[1])
    product = np.einsum("dts,ds->dt", matrices, c)
    excess = part.var(axis=1) - target.means
    value = omega * ((right - 0.5 * product) * c).sum(axis=1) - 0.5 * excess**2 / target.variances
    deviation = np.zeros_like(c)
    deviation[:, used] = part - part.mean(axis=1, keepdims=True)
    slope = (2 / part.shape[1] * excess / target.variances)[:, np.newaxis] * deviation
    return value, (omega * (right - product) - slope).T


def _model(seed, *, ratio=1.4, n_states=10, n_frames=6, n_channels=5, windows=WINDOWS):
    """Return means, variances, and a target for the variance in relation to that of the plain trajectory."""
    means, variances = random_states(np.random.default_rng(seed), n_states, n_frames, n_channels)
    plain = generate_trajectory(means, variances, windows=windows).var(axis=0)
    return means, variances, GlobalVariance(ratio * plain, (0.2 * plain) ** 2)


models = {
    "seed": st.integers(0, 2**32 - 1),
    "ratio": st.floats(0.3, 5),
    "weight": st.floats(1e-6, 1e4),
    "windows": st.sampled_from([WINDOWS, HTS_WINDOWS, WINDOWS[:2]]),
}


@settings(deadline=None)
@given(**models)
def test_gradient_vanishes(seed, ratio, weight, windows):
    random = np.random.default_rng(seed)
    means, variances = random_states(random, 8, 4, 3, len(windows))
    plain = generate_trajectory(means, variances, windows=windows).var(axis=0)
    target = GlobalVariance(ratio * plain, (random.uniform(0.1, 1, 3) * plain) ** 2)
    trajectory = generate_with_variance(means, variances, target, weight=weight, windows=windows)
    matrices, right = dense_equations(means, variances, windows)
    _, gradient = _objective(trajectory, matrices, right, target, weight, n_windows=len(windows))
    # Of the two terms that cancel; with large weights these are large.
    size = weight / len(windows) / len(means) * np.abs(right).max()
    assert np.abs(gradient).max() < 1e-8 * max(1, size)


@settings(deadline=None)
@given(**models, size=st.floats(-6, 1))
def test_no_other_trajectory_has_a_larger_objective(seed, ratio, weight, windows, size):
    """Neither near nor far: the maximum is global."""
    means, variances, target = _model(seed, ratio=ratio, windows=WINDOWS)
    trajectory = generate_with_variance(means, variances, target, weight=weight)
    matrices, right = dense_equations(means, variances)
    best, _ = _objective(trajectory, matrices, right, target, weight)
    random = np.random.default_rng(seed)
    for _ in range(10):
        direction = np.cumsum(random.normal(size=trajectory.shape), axis=0) * random.choice([1, 1e-2])
        other, _ = _objective(trajectory + 10**size * direction, matrices, right, target, weight)
        assert (other <= best + 1e-9 * (1 + np.abs(best))).all()


def test_gradient_by_finite_differences():
    """Of the objective, which says what is maximized: Eq. 15."""
    means, variances, target = _model(0, n_states=4, n_frames=4)
    trajectory = generate_with_variance(means, variances, target)
    matrices, right = dense_equations(means, variances)
    for frame in range(len(means)):
        step = np.zeros_like(trajectory)
        step[frame] = 1e-5
        above, below = (_objective(trajectory + s, matrices, right, target, 1.0)[0] for s in (step, -step))
        assert np.abs(above - below).max() / 2e-5 < 1e-6  # rounding of the objective, over the step


def test_lowest_mode_nearly_constant():
    """B = R + lambda I has a negative eigenvalue here, which its change of rank one takes away again."""
    means, variances = random_states(np.random.default_rng(0), 10, 6, 3)
    variances[:, :3] *= 1e4  # little is known but the dynamics
    plain = generate_trajectory(means, variances, windows=HTS_WINDOWS).var(axis=0)
    target = GlobalVariance(3 * plain, (0.1 * plain) ** 2)
    trajectory = generate_with_variance(means, variances, target, weight=1e-3, windows=HTS_WINDOWS)
    matrices, right = dense_equations(means, variances, HTS_WINDOWS)
    # R c + lambda H c = r: lambda is negative, and below the lowest eigenvalue of R.
    deviation = trajectory - trajectory.mean(axis=0)
    residual = (right - np.einsum("dts,ds->dt", matrices, trajectory.T)).T
    lambdas = (deviation * residual).sum(axis=0) / (deviation**2).sum(axis=0)
    assert (lambdas < -np.linalg.eigvalsh(matrices)[:, 0]).all()
    centering = np.eye(60) - 1 / 60
    assert (np.linalg.eigvalsh(matrices + lambdas[:, None, None] * centering)[:, 0] > 0).all()
    assert np.allclose(residual, lambdas * deviation, rtol=0, atol=1e-8)


def test_weight_zero_gives_the_wanted_variance():
    means, variances, target = _model(0)
    assert np.allclose(generate_with_variance(means, variances, target, weight=0).var(axis=0), target.means, rtol=1e-12)


def test_weight_goes_from_one_limit_to_the_other():
    means, variances, target = _model(0)
    plain = generate_trajectory(means, variances)
    weights = [0, 1e-9, 1, 1e2, 1e4, 1e12, np.inf]
    trajectories = [generate_with_variance(means, variances, target, weight=weight) for weight in weights]
    reached = np.array([trajectory.var(axis=0) / target.means for trajectory in trajectories])
    assert (np.diff(reached, axis=0) <= 1e-12).all()
    assert np.allclose(trajectories[1], trajectories[0], rtol=0, atol=1e-8)
    assert np.allclose(trajectories[-2], plain, rtol=0, atol=1e-8)
    assert np.array_equal(trajectories[-1], plain)


def test_variance_ratio_does_not_depend_on_the_length():
    """The same states 4 and 40 times: with the paper's omega = 1 the target would count a tenth as much."""
    once, variances, _ = _model(0)
    ratios = []
    for n_times in (4, 40):
        means, spread = np.tile(once, (n_times, 1)), np.tile(variances, (n_times, 1))
        plain = generate_trajectory(np.tile(once, (40, 1)), np.tile(variances, (40, 1))).var(axis=0)
        target = GlobalVariance(1.4 * plain, (0.2 * plain) ** 2)
        ratios.append(generate_with_variance(means, spread, target, weight=20.0).var(axis=0) / target.means)
    assert (ratios[1] < 0.99).all()  # not at the limit, where nothing depends on anything
    # Apart from what the frames at both ends do, which are more of the shorter walk.
    assert np.allclose(ratios[0], ratios[1], rtol=0.02)


def test_target_of_the_plain_variance_changes_nothing():
    means, variances, target = _model(0, ratio=1.0)
    plain = generate_trajectory(means, variances)
    assert np.allclose(generate_with_variance(means, variances, target), plain, rtol=0, atol=1e-12)


def test_scale_of_a_channel_does_not_matter():
    means, variances, target = _model(0)
    scaled = GlobalVariance(target.means * 1e12, target.variances * 1e24)
    expected = generate_with_variance(means, variances, target)
    assert np.allclose(generate_with_variance(means * 1e6, variances * 1e12, scaled) / 1e6, expected, atol=1e-9)


def test_variance_over_some_frames():
    """Those between the first and last steps: in them the target is reached, and the gradient vanishes in all."""
    means, variances, _ = _model(0)
    used = np.arange(len(means)) // 12 % 4 != 0
    plain = generate_trajectory(means, variances)[used].var(axis=0)
    target = GlobalVariance(1.5 * plain, (0.2 * plain) ** 2)
    matrices, right = dense_equations(means, variances)
    trajectory = generate_with_variance(means, variances, target, frames=used)
    _, gradient = _objective(trajectory, matrices, right, target, 1.0, used=used)
    assert np.abs(gradient).max() < 1e-8
    exact = generate_with_variance(means, variances, target, weight=0, frames=used)
    assert np.allclose(exact[used].var(axis=0), target.means, rtol=1e-12)


def test_constant_channels_stay():
    means, variances, target = _model(0)
    means[:, [0, 5, 10]] = [2.0, 0.0, 0.0]  # one channel that does not move
    wanted = np.r_[0.5, target.means[1:4], 0.0]  # and one that should not
    target = GlobalVariance(wanted, np.full(5, 0.01))
    plain, trajectory = generate_trajectory(means, variances), generate_with_variance(means, variances, target)
    assert np.array_equal(trajectory[:, [0, 4]], plain[:, [0, 4]])
    assert (trajectory[:, 1:4].var(axis=0) > plain[:, 1:4].var(axis=0)).all()


@pytest.mark.parametrize("n_frames", [1, 2, 3, 4, 5])
def test_very_short(n_frames):
    means, variances = random_states(np.random.default_rng(0), n_frames, 1, 3)
    target = GlobalVariance(np.ones(3), np.full(3, 0.1))
    trajectory = generate_with_variance(means, variances, target, weight=0)
    assert np.allclose(trajectory.var(axis=0), 1.0 if n_frames > 1 else 0.0, rtol=1e-10)


def test_variance_that_nothing_in_the_means_can_give():
    """A single state has no motion but at its ends: it is enlarged as far as the matrix stays definite."""
    means, variances = random_states(np.random.default_rng(0), 1, 30, 3)
    target = GlobalVariance(np.ones(3), np.full(3, 0.01))
    plain, trajectory = generate_trajectory(means, variances), generate_with_variance(means, variances, target)
    reached = trajectory.var(axis=0)
    assert (reached >= plain.var(axis=0)).all()
    assert (reached < 1.01).all()
    assert np.abs(np.diff(trajectory, axis=0)).max() < 5


def test_measures_as_numpy_does():
    walks = [np.random.default_rng(seed).normal(size=(20 + seed, 4)) for seed in range(5)]
    measured = measure_global_variance(walks)
    each = np.array([walk.var(axis=0) for walk in walks])
    assert np.allclose(measured.means, each.mean(axis=0))
    assert np.allclose(measured.variances, each.var(axis=0))


def test_faults_are_named():
    means, variances, target = _model(0)
    with pytest.raises(ValueError, match="at least one walk"):
        measure_global_variance([])
    with pytest.raises(ValueError, match=r"target\.means must be 5 finite numbers from 0 up"):
        generate_with_variance(means, variances, GlobalVariance(-target.means, target.variances))
    with pytest.raises(ValueError, match=r"target\.variances must be 5 finite numbers"):
        generate_with_variance(means, variances, GlobalVariance(target.means, target.variances[:4]))
    with pytest.raises(ValueError, match="weight must be 0 or more, got -1"):
        generate_with_variance(means, variances, target, weight=-1)
    with pytest.raises(ValueError, match=r"frames must have shape \(60,\) and select some"):
        generate_with_variance(means, variances, target, frames=np.zeros(60, dtype=bool))
