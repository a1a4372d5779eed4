"""Trajectories whose variance over time is that of real walks (Tilmanne et al. 2012, Eq. 12 to 15), exactly.

What is generated from means is too smooth. Eq. 15 adds to the log-likelihood, weighted by omega, that of the variance
over time v(c) of each channel, a Gaussian of mean mu_v and variance s^2:

    omega (-c' R c / 2 + r' c) - (v(c) - mu_v)^2 / (2 s^2),    R = W'PW,  r = W'P mu,  v(c) = c' H c / T

with H = I - 11'/T, which takes the mean out. The gradient vanishes where

    (R + lambda H) c = r    and    lambda = 2 (v(c) - mu_v) / (omega T s^2)

and where R + lambda H is positive definite that is the one global maximum, since the objective is a concave function
of v less a quadratic one of c. There v(c(lambda)) falls with lambda and the line rises: one root a channel, of one
number. The term 11' is a change of rank one. HTS takes some steps along the gradient instead (Toda & Tokuda 2007).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm.banded import count_negative, factorize, multiply_banded, solve_factorized
from eigenwalker.hsmm.features import WINDOWS
from eigenwalker.hsmm.generation import NormalEquations, generate_trajectory, normal_equations

__all__ = ["GlobalVariance", "generate_with_variance", "measure_global_variance"]

_EPS = float(np.finfo(np.float64).eps)
_MAX_STEPS = 100  # of Newton or bisection; about 8 are taken
_SMALLEST = 1e-12  # of the wanted variance: what moves less has nothing that could be enlarged


class GlobalVariance(NamedTuple):
    """The Gaussian of the variance over time, for each channel (lambda_v of Eq. 15, with a diagonal covariance).

    Attributes
    ----------
    means : ndarray of shape (n_channels,)
        mu_v, the mean over walks of the variance over time.
    variances : ndarray of shape (n_channels,)
        s^2, the variance over walks of the variance over time.
    """

    means: NDArray[np.float64]
    variances: NDArray[np.float64]


class _Point(NamedTuple):
    """The solution at one lambda a channel."""

    trajectory: NDArray[np.float64]
    variance: NDArray[np.float64]  # v
    slope: NDArray[np.float64]  # of v by lambda
    is_definite: NDArray[np.bool_]


def measure_global_variance(walks: Sequence[ArrayLike]) -> GlobalVariance:
    """Return mean and variance over walks of the variance over time (Eq. 12 to 14, where 54 stands for T).

    Parameters
    ----------
    walks : sequence of array-like of shape (n_frames, n_channels)
        Static channels, best without the first and last steps, see `frames` in `generate_with_variance`.

    Returns
    -------
    GlobalVariance
        From a single walk its variances over walks are zero: then the generated variance is that of the walk.

    Examples
    --------
    >>> measure_global_variance([[[0.0], [2.0]], [[0.0], [4.0]]])
    GlobalVariance(means=array([2.5]), variances=array([2.25]))
    """
    if not len(walks):
        raise ValueError("expected at least one walk, got an empty sequence")
    variances = np.array([np.var(np.asarray(walk, dtype=np.float64), axis=0) for walk in walks])
    return GlobalVariance(variances.mean(axis=0), variances.var(axis=0))


def generate_with_variance(
    means: ArrayLike,
    variances: ArrayLike,
    target: GlobalVariance,
    *,
    weight: float = 1.0,
    frames: ArrayLike | None = None,
    windows: Sequence[Sequence[float]] = WINDOWS,
) -> NDArray[np.float64]:
    """Return the static channels that maximize Eq. 15 for a given state sequence: the global maximum.

    Parameters
    ----------
    means, variances : array-like of shape (n_frames, n_windows * n_channels)
        Of each frame's state, see `generate_trajectory`.
    target : GlobalVariance
        The Gaussian of the variance over time.
    weight : float, default 1
        w in omega = w / (n_windows T). Eq. 15 weighs T n_windows Gaussians of frames against one of the variance:
        with omega = 1 the second fades as the walk gets longer. With w one frame's worth of likelihood stands against
        it, as in HTS, whatever the length. 0: the variance is exactly that of `target`. Infinity: as
        `generate_trajectory`. The paper's omega is w / (n_windows T).
    frames : array-like of bool of shape (n_frames,), default None
        Over which frames the variance is taken; T is their number. None is all of them.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of each window.

    Returns
    -------
    ndarray of shape (n_frames, n_channels)
        Channels that are constant when generated from the means alone, or whose wanted variance is zero, stay as they
        were generated.

    Raises
    ------
    ValueError
        As of `generate_trajectory`; if the target does not fit or is negative; if the weight is negative.

    See Also
    --------
    measure_global_variance : The target from real walks.

    Examples
    --------
    >>> import numpy as np
    >>> means = np.repeat([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], 20, axis=0)
    >>> target = GlobalVariance(np.array([0.3]), np.array([0.001]))
    >>> variances = np.ones((40, 3))
    >>> generate_trajectory(means, variances).var().round(3)
    np.float64(0.232)
    >>> generate_with_variance(means, variances, target).var().round(3)
    np.float64(0.3)
    """
    n_channels = np.shape(means)[-1] // len(windows)
    wanted, spread = (_check(values, n_channels, name) for name, values in target._asdict().items())
    if not weight >= 0:
        raise ValueError(f"weight must be 0 or more, got {weight!r}")
    trajectory = generate_trajectory(means, variances, windows=windows)
    used = np.ones(len(trajectory), dtype=bool) if frames is None else np.asarray(frames, dtype=bool)
    if used.shape != (len(trajectory),) or not used.any():
        raise ValueError(f"frames must have shape ({len(trajectory)},) and select some, got {used.shape}, {used.sum()}")
    moving = (wanted > 0) & (trajectory[used].var(axis=0) > _SMALLEST * wanted)
    if np.isinf(weight) or not moving.any():
        return trajectory
    bands, right, step = normal_equations(means, variances, windows=windows)
    equations = NormalEquations(bands[..., moving], right[:, moving], step)
    # omega T s^2 / 2 with omega = w / (n_windows T): T is gone
    rise = weight * spread[moving] / (2 * len(windows))
    trajectory[:, moving] = _maximize(equations, wanted[moving], rise, used, trajectory[:, moving])
    return trajectory


def _check(values: ArrayLike, n_channels: int, name: str) -> NDArray[np.float64]:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (n_channels,) or not ((array >= 0) & np.isfinite(array)).all():
        raise ValueError(f"target.{name} must be {n_channels} finite numbers from 0 up, one a channel, got {values!r}")
    return array


def _maximize(
    equations: NormalEquations, wanted: NDArray, rise: NDArray, used: NDArray, start: NDArray
) -> NDArray[np.float64]:
    """Return c at the root of v(lambda) = mu_v + rise lambda, shape (n_frames, n_channels).

    Newton's method on the difference of v^(-1/2) and (mu_v + rise lambda)^(-1/2), the first of which is nearly a line
    (Reinsch 1971), between bounds; a step over them is replaced by their middle.
    """
    lambdas, low, high = np.zeros_like(wanted), _lower_bound(equations, wanted, rise, used, start), np.inf * wanted
    result, active = start.copy(), np.arange(len(wanted))
    for _ in range(_MAX_STEPS):
        part = NormalEquations(equations.bands[..., active], equations.right[:, active], equations.step)
        at, line = lambdas[active], wanted[active] + rise[active] * lambdas[active]
        point = _solve_at(part, at, used)
        excess = np.where(point.is_definite, point.variance - line, np.inf)
        low[active] = np.where(excess > 0, at, low[active])
        high[active] = np.where(excess <= 0, at, high[active])
        result[:, active] = np.where(point.is_definite, point.trajectory, result[:, active])
        with np.errstate(all="ignore"):  # what is not finite is replaced
            value = point.variance**-0.5 - line**-0.5
            slope = -0.5 * point.variance**-1.5 * point.slope + 0.5 * rise[active] * line**-1.5
            proposed = np.where(point.is_definite, at - value / slope, np.nan)
        above, below = high[active], low[active]
        middle = np.where(np.isinf(above), 2 * np.abs(at) + np.abs(below), 0.5 * (below + above))
        lambdas[active] = np.where((proposed > below) & (proposed < above), proposed, middle)
        width = 2 * _EPS * np.maximum(np.abs(above), np.abs(below))
        is_done = (np.abs(excess) <= 2 * _EPS * (np.abs(line) + point.variance)) | (
            np.isfinite(above) & (above - below <= width)
        )
        is_done |= point.is_definite & (np.abs(lambdas[active] - at) <= _EPS * np.abs(at))
        active = active[~is_done]
        if not len(active):
            break
    return result


def _lower_bound(
    equations: NormalEquations, wanted: NDArray, rise: NDArray, used: NDArray, start: NDArray
) -> NDArray[np.float64]:
    """Return a lambda of each channel that is below the root.

    For x = H c with c at lambda = 0: x' (R + lambda H) x must be positive, and mu_v + rise lambda, which is v, too.
    """
    deviation = _deviate(start, used)
    energy = (deviation * multiply_banded(equations.bands, deviation, step=equations.step)).sum(axis=0)
    with np.errstate(divide="ignore"):
        return np.maximum(-energy / (deviation**2).sum(axis=0), -wanted / rise)


def _deviate(values: NDArray, used: NDArray) -> NDArray[np.float64]:
    """Return H values: less the mean in the frames used, zero in others."""
    return np.where(used[:, np.newaxis], values - values[used].mean(axis=0), 0.0)


def _solve_at(equations: NormalEquations, lambdas: NDArray, used: NDArray) -> _Point:
    """Return the solution of (R + lambda H) c = r, v and its slope -2 (Hc)' (R + lambda H)^-1 (Hc) / T.

    With B = R + lambda I and u ones, in the frames used, R + lambda H is B - lambda u u' / T (Sherman and Morrison).
    For negative lambda that is B plus a square, which takes away at most one negative eigenvalue of B, and does so if
    the determinant changes its sign.
    """
    bands, right, step = equations
    n_used, ones = used.sum(), np.repeat(used[:, np.newaxis].astype(np.float64), len(lambdas), axis=1)
    factors = factorize(bands, step=step, shift=ones * lambdas)
    of_ones = solve_factorized(factors, ones, step=step)
    scale = -lambdas / n_used
    change = 1 + scale * (ones * of_ones).sum(axis=0)  # of the determinant

    def invert(values: NDArray) -> NDArray:
        solution = solve_factorized(factors, values, step=step)
        return solution - of_ones * (scale * (ones * solution).sum(axis=0) / change)

    with np.errstate(all="ignore"):  # where the matrix is singular; not definite then
        n_negative = count_negative(factors)
        is_definite = (lambdas >= 0) | (n_negative == 0) | ((n_negative == 1) & (change < 0))
        trajectory = invert(right)
        # Once more for the rounding, which the solution of a nearly singular system has.
        product = multiply_banded(bands, trajectory, step=step) + lambdas * _deviate(trajectory, used)
        trajectory += invert(right - product)
        deviation = _deviate(trajectory, used)
        variance = (deviation**2).sum(axis=0) / n_used
        slope = -2 * (deviation * invert(deviation)).sum(axis=0) / n_used
    return _Point(trajectory, variance, slope, is_definite & np.isfinite(trajectory).all(axis=0))
