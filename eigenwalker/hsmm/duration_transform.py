"""Linear transforms of durations: how much longer or shorter the states of a walker last than those of the model.

    d_z = a d + e,    a > 0

with d in frames and d_z the duration that the model's Gaussians N(m, s^2) are of. In frames the adapted durations have
mean (m - e) / a and standard deviation s / a.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.transform_estimation import StandardUnits, estimate_transform, standard_units
from eigenwalker.hsmm.transform_statistics import TransformStatistics

__all__ = [
    "DurationTransform",
    "duration_penalty",
    "duration_units",
    "estimate_duration_transform",
    "expected_log_durations",
    "identity_durations",
    "transformed_durations",
]

_RARE = 1e-7  # of the counts of a state: less may leave the support, and the likelihood falls by no more than that
_REACH = 4  # times the longest duration counted or likely, up to which sums over durations go


class DurationTransform(NamedTuple):
    """d_z = a d + e, for each class of states.

    Attributes
    ----------
    factors : ndarray of shape (n_classes,)
        a, positive. More than 1 for states that are shorter than those of the model.
    shifts : ndarray of shape (n_classes,)
        e, in frames.
    """

    factors: NDArray[np.float64]
    shifts: NDArray[np.float64]


def identity_durations(n_classes: int = 1) -> DurationTransform:
    """Return the transform that changes nothing."""
    return DurationTransform(np.ones(n_classes), np.zeros(n_classes))


def transformed_durations(
    transform: DurationTransform, means: ArrayLike, variances: ArrayLike, *, duration_classes: ArrayLike | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return means and variances of durations in frames: (m - e) / a and s^2 / a^2.

    Parameters
    ----------
    transform : DurationTransform
        From frames to what the Gaussians are of.
    means, variances : array-like of shape (n_duration_states,)
        m and s^2 of the model.
    duration_classes : array-like of int of shape (n_duration_states,), default None
        Class of each state. None is the first for all.

    Returns
    -------
    means, variances : ndarray of shape (n_duration_states,)
        In frames and frames squared.

    References
    ----------
    Tilmanne, Moinet & Dutoit 2012, Eq. 6, with 1 / a for their A and e / a for their b.

    Examples
    --------
    >>> transformed_durations(DurationTransform(np.array([2.0]), np.array([1.0])), [9.0], [4.0])
    (array([4.]), array([1.]))
    """
    classes = 0 if duration_classes is None else np.asarray(duration_classes)
    factors, shifts = transform.factors[classes], transform.shifts[classes]
    return (np.asarray(means, dtype=np.float64) - shifts) / factors, np.asarray(variances) / factors**2


def duration_units(means: ArrayLike, variances: ArrayLike) -> StandardUnits:
    """Return zero and unit of durations: the mean of all means, and the root of the mean variance, in frames."""
    return standard_units(1, origin=[np.asarray(means).mean()], scales=[np.sqrt(np.asarray(variances).mean())])


def expected_log_durations(counts: NDArray[np.floating], means: ArrayLike, variances: ArrayLike) -> NDArray[np.float64]:
    """Return the expected log-probability of counted durations, for each state.

    Parameters
    ----------
    counts : ndarray of shape (n_states, n_durations)
        Column d - 1 is how often a state is expected to last d frames.
    means, variances : array-like of shape (n_states,)
        Of the Gaussians on whole frames, see `log_durations`.

    Returns
    -------
    ndarray of shape (n_states,)
        Minus infinity where a duration cannot be, unless it was counted less than 1e-7 of the state's times.

    Examples
    --------
    >>> expected_log_durations(np.array([[0.0, 2.0]]), [2.0], [0.25]).round(3)
    array([-0.48])
    """
    logs = log_durations(means, variances)
    width = max(counts.shape[1], logs.shape[1])
    logs = np.pad(logs, ((0, 0), (0, width - logs.shape[1])), constant_values=-np.inf)
    counts = np.pad(counts, ((0, 0), (0, width - counts.shape[1])))
    common = counts > _RARE * counts.sum(axis=1, keepdims=True)
    return np.where(common, counts * np.where(common, logs, 0.0), 0.0).sum(axis=1)


def estimate_duration_transform(
    duration_counts: NDArray[np.floating],
    means: ArrayLike,
    variances: ArrayLike,
    *,
    weight: float = 0.0,
    duration_classes: ArrayLike | None = None,
    n_classes: int = 1,
    units: StandardUnits | None = None,
    start: DurationTransform | None = None,
) -> DurationTransform:
    """Return the transform of durations of largest posterior density.

    For the continuous density of d, N(a d + e; m, s^2) a, that is one row of `estimate_transform`: a quadratic
    equation. As durations are whole and at least one frame, their probabilities are the density divided by its sum over
    frames, which differs where s / a is below half a frame or the mean near one frame; so a few steps uphill follow on
    these probabilities.

    Parameters
    ----------
    duration_counts : ndarray of shape (n_duration_states, n_durations)
        Column d - 1 is how often a state is expected to last d frames.
    means, variances : array-like of shape (n_duration_states,)
        m and s^2 of the model.
    weight : float, default 0.0
        Of the prior, a Gaussian about a = 1, e = 0 in standard units; infinity is that itself. As of
        `estimate_transform`.
    duration_classes : array-like of int of shape (n_duration_states,), default None
        Class of each state. None is one class for all.
    n_classes : int, default 1
        Number of classes. One that was never seen stays as it is.
    units : StandardUnits, default None
        Zero and unit of durations for the prior; None is those of `duration_units`.
    start : DurationTransform, default None
        The transform so far; None is the identity. The result is at least as good.

    Returns
    -------
    DurationTransform

    Raises
    ------
    ValueError
        If the weight is negative, or without a prior the states of a class do not determine both a and e: they
        all last equally long.

    References
    ----------
    Yamagishi & Kobayashi 2007, 3.2 (constrained regression of durations of an HSMM).

    Examples
    --------
    >>> counts = np.array([[0, 0, 0, 1, 2, 1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 1]], dtype=float)
    >>> factors, shifts = estimate_duration_transform(counts, [10.0, 20.0], [2.0, 2.0])
    >>> factors.round(2), shifts.round(2)
    (array([2.]), array([0.]))
    """
    means, variances = np.asarray(means, dtype=np.float64), np.asarray(variances, dtype=np.float64)
    classes = np.zeros(len(means), dtype=int) if duration_classes is None else np.asarray(duration_classes)
    before = identity_durations(n_classes) if start is None else start
    factors, shifts = before.factors.copy(), before.shifts.copy()
    units = duration_units(means, variances) if units is None else units
    if not weight >= 0:
        raise ValueError(f"weight must not be negative, got {weight!r}")
    settings: dict[str, Any] = {"weight": weight, "units": units}
    for group in range(n_classes):
        chosen = classes == group
        if duration_counts[chosen].any():
            own = duration_counts[chosen], means[chosen], variances[chosen]
            factors[group], shifts[group] = _estimate_class(*own, before=(factors[group], shifts[group]), **settings)
    return DurationTransform(factors, shifts)


def _estimate_class(
    counts: NDArray[np.float64],
    means: NDArray[np.float64],
    variances: NDArray[np.float64],
    *,
    before: tuple[float, float],
    weight: float,
    units: StandardUnits,
) -> tuple[float, float]:
    statistics = _one_channel(counts, means, variances)
    try:
        matrix, bias = estimate_transform(statistics, weight=weight, units=units, max_condition=np.inf)
    except ValueError:
        raise ValueError(
            f"durations of {len(means)} states do not determine their transform without a prior; give it a weight"
        ) from None
    if np.isinf(weight):
        return float(matrix[0, 0]), float(bias[0])
    goal = _climb((float(matrix[0, 0]), float(bias[0])), counts, means, variances, weight, units)

    def value(pair: tuple[float, float]) -> float:
        moved = transformed_durations(_pair(*pair), means, variances)
        return float(expected_log_durations(counts, *moved).sum()) - duration_penalty(_pair(*pair), weight, units)

    so_far = value(before)
    # Where a duration that was counted would leave the support, only as far towards the goal as none does.
    for share in 0.5 ** np.arange(20.0) if so_far > -np.inf else ():
        pair = before[0] + share * (goal[0] - before[0]), before[1] + share * (goal[1] - before[1])
        if value(pair) > so_far:
            return pair
    return before if so_far > -np.inf else goal


def _pair(factor: float, shift: float) -> DurationTransform:
    return DurationTransform(np.array([factor]), np.array([shift]))


def duration_penalty(transform: DurationTransform, weight: float, units: StandardUnits) -> float:
    """Return what the prior takes from the log-likelihood, summed over classes."""
    origin, scale = units.origin[0], units.scales[0]
    shifts = (transform.shifts + (transform.factors - 1) * origin) / scale
    distance = float(((transform.factors - 1) ** 2 + shifts**2).sum())
    return 0.5 * weight * distance if distance else 0.0


def _one_channel(
    counts: NDArray[np.float64], means: NDArray[np.float64], variances: NDArray[np.float64]
) -> TransformStatistics:
    """Return counts of durations as statistics of one channel: zeta = (d, 1)."""
    zeta = np.column_stack((np.arange(1.0, counts.shape[1] + 1), np.ones(counts.shape[1])))
    weighted, total = counts / variances[:, np.newaxis], np.array([counts.sum()])
    quadratic = zeta.T @ (weighted.sum(axis=0)[:, np.newaxis] * zeta)
    linear = (means @ weighted) @ zeta
    constant = -0.5 * counts.sum(axis=1) @ (np.log(2 * np.pi * variances) + means**2 / variances)
    shaped = quadratic[np.newaxis, np.newaxis], linear[np.newaxis, np.newaxis]
    return TransformStatistics(total, total, *shaped, np.array([constant]))


def _climb(
    start: tuple[float, float],
    counts: NDArray[np.float64],
    means: NDArray[np.float64],
    variances: NDArray[np.float64],
    weight: float,
    units: StandardUnits,
) -> tuple[float, float]:
    """Return a and e of the largest objective on whole frames, without a bound to the support."""
    origin, scale = units.origin[0], units.scales[0]
    moved, spreads = transformed_durations(_pair(*start), means, variances)
    longest = _REACH * max(counts.shape[1], np.ceil((moved + 6 * np.sqrt(spreads)).max()))
    durations = np.arange(1.0, longest + 1)
    padded = np.pad(counts, ((0, 0), (0, len(durations) - counts.shape[1])))

    def loss(point: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        factor, shift = point[0], scale * point[1] + origin - point[0] * origin  # of durations in standard units
        misses = factor * durations + shift - means[:, np.newaxis]
        energies = 0.5 * misses**2 / variances[:, np.newaxis]
        lowest = energies.min(axis=1, keepdims=True)
        shares = np.exp(lowest - energies)
        totals = shares.sum(axis=1, keepdims=True)
        value = (padded * (energies - lowest + np.log(totals))).sum()
        slopes = (padded - padded.sum(axis=1, keepdims=True) * shares / totals) * misses / variances[:, np.newaxis]
        gradient = np.array([(slopes * (durations - origin)).sum(), scale * slopes.sum()])
        away = point - [1.0, 0.0]
        return value + 0.5 * weight * (away @ away), gradient + weight * away

    at = np.array([start[0], (start[1] + (start[0] - 1) * origin) / scale])
    found = minimize(loss, at, jac=True, method="L-BFGS-B", bounds=[(1e-3, None), (None, None)], tol=1e-14).x
    return float(found[0]), float(scale * found[1] + origin - found[0] * origin)
