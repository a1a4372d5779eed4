"""The transform of channels that makes walks most likely: maximum likelihood (CMLLR) or with a prior (CSMAPLR).

Maximized is Q(W) - weight / 2 ||W~ - W~_0||^2 with Q the expected log-density of `transform_statistics` and
W~ = (A~ b~) the transform of channels in standard units, (c - origin) / scale:

    A~ = S^-1 A S,    b~ = S^-1 (A m + b - m),    S = diag(scales), m = origin

so that the weight means the same for a channel that hardly moves and for one that does, wherever its zero is.
"""

import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm._transform_ascent import ascend_rows, make_problem, polish
from eigenwalker.hsmm.transform_statistics import TransformStatistics
from eigenwalker.hsmm.transforms import ChannelTransform, identity_transform

__all__ = ["StandardUnits", "estimate_transform", "standard_units", "transform_penalty"]

_SINGULAR = 1e14  # condition of G_i beyond which rounding decides
_MAX_SWEEPS = 40
_UNFINISHED = 1e-7  # nats a frame and window
_SWEEP_GAIN = 1e-9  # nats a frame and window, below which Newton steps take over


class StandardUnits(NamedTuple):
    """Zero and unit of each channel in which transforms are compared.

    Attributes
    ----------
    origin, scales : ndarray of shape (n_channels,)
        As the mean and the standard deviation of each channel over all frames.
    """

    origin: NDArray[np.float64]
    scales: NDArray[np.float64]


def standard_units(
    n_channels: int, *, origin: ArrayLike | None = None, scales: ArrayLike | None = None
) -> StandardUnits:
    """Return zero and unit of each channel.

    Parameters
    ----------
    n_channels : int
        Number of static channels.
    origin, scales : array-like of shape (n_channels,), default None
        None is zero and one. For real walks take the mean and the standard deviation over all frames of the walks of
        the model, see `overall_moments`.

    Returns
    -------
    StandardUnits

    Raises
    ------
    ValueError
        If there is not one of each a channel, an origin is not finite, or a scale is not positive and finite.

    Examples
    --------
    >>> standard_units(2, scales=[0.5, 0.1]).scales
    array([0.5, 0.1])
    """
    zero = np.zeros(n_channels) if origin is None else np.asarray(origin, dtype=np.float64)
    unit = np.ones(n_channels) if scales is None else np.asarray(scales, dtype=np.float64)
    if zero.shape != (n_channels,) or unit.shape != (n_channels,) or not np.isfinite(zero).all():
        raise ValueError(
            f"expected a finite origin and a scale for each of {n_channels} channels, got shapes {zero.shape} and "
            f"{unit.shape}"
        )
    wrong = np.flatnonzero(~((unit > 0) & (unit < np.inf)))
    if len(wrong):
        raise ValueError(
            f"scales must be positive and finite, got {unit[wrong[:4]].tolist()} for channels {wrong[:4].tolist()}; "
            "leave channels that do not move out, or give their scale a floor"
        )
    return StandardUnits(zero, unit)


def estimate_transform(
    statistics: TransformStatistics,
    *,
    weight: float = 0.0,
    center: ChannelTransform | None = None,
    units: StandardUnits | None = None,
    start: ChannelTransform | None = None,
    max_condition: float = 1e4,
) -> ChannelTransform:
    """Return the transform of largest posterior density for all classes of the statistics together.

    Parameters
    ----------
    statistics : TransformStatistics
        Of the frames that share the transform.
    weight : float, default 0.0
        Of the prior. 0 is maximum likelihood (CMLLR), infinity the center itself. The prior is worth as many static
        frames as its weight, of states whose variances are one in standard units; narrower states give frames more
        say. To be chosen on walks held out.
    center : ChannelTransform, default None
        Where the prior is largest; None is the identity.
    units : StandardUnits, default None
        In which channels are standardized for the prior. None is the channels' own.
    start : ChannelTransform, default None
        Where to climb from, with det A > 0; the result is at least as good. None is the center.
    max_condition : float, default 1e4
        Condition number of A, in standard units, above which a warning is given.

    Returns
    -------
    ChannelTransform
        With det A > 0: mirror images are no transforms.

    Raises
    ------
    ValueError
        If the weight is negative, a matrix of center or start has no positive determinant, or the frames do not
        determine the transform.

    Warns
    -----
    UserWarning
        If A is nearly singular, so that A^-1 blows noise up, or if the climb did not reach the top.

    Notes
    -----
    Rows in turn by cofactors, which never lowers the objective, then Newton steps until its gradient vanishes. The
    objective need not be concave: the result is the top of the hill on which the start lies.

    References
    ----------
    Gales 1998, 3 (rows and cofactors); Yamagishi, Kobayashi, Nakano, Ogata & Isogai 2009 (CSMAPLR: a matrix-normal
    prior, here with Psi = I and Omega = I / weight in standard units); Tilmanne, Moinet & Dutoit 2012, 5.1.3, which
    says CSMAPLR, and 5.2.2, which says CMLLR.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.hsmm.transform_statistics import accumulate_transform
    >>> channels = np.array([[-1.0], [3.0], [1.0]])  # mean 1, variance 8 / 3
    >>> statistics = accumulate_transform(
    ...     channels, np.ones((3, 1)), states=[0], means=np.array([[0.0]]), variances=np.array([[6.0]]),
    ...     windows=((1.0,),)
    ... )
    >>> matrix, bias = estimate_transform(statistics)  # to mean 0 and variance 6
    >>> round(float(matrix[0, 0]), 6), round(float(bias[0]), 6)
    (1.5, -1.5)
    >>> estimate_transform(statistics, weight=np.inf)
    ChannelTransform(matrix=array([[1.]]), bias=array([0.]))
    """
    n_channels = statistics.linear.shape[1]
    center = identity_transform(n_channels) if center is None else center
    units = standard_units(n_channels) if units is None else standard_units(n_channels, **units._asdict())
    if not weight >= 0:
        raise ValueError(f"weight must not be negative, got {weight!r}")
    count = float(statistics.n_volumes.sum())
    if np.isinf(weight) or (count == 0 and weight > 0):
        return center
    middle, rows = (_to_standard(part, units) for part in (center, center if start is None else start))
    _check_orientation(middle, rows)
    quadratic, linear = _standardize(statistics, units)
    quadratic = quadratic + weight * np.eye(n_channels + 1)
    problem, condition = make_problem(count, quadratic, linear + weight * middle)
    if not condition < _SINGULAR:
        raise ValueError(
            f"the frames do not determine the transform: {statistics.n_frames.sum():.1f} frames for {n_channels} "
            f"channels, condition number {condition:.0e} of the normal equations (limit {_SINGULAR:.0e}); raise the "
            f"weight of the prior above {weight:g}, share the transform among more states, or give more walks"
        )
    rows, _ = ascend_rows(problem, rows, tolerance=_SWEEP_GAIN, max_sweeps=_MAX_SWEEPS)
    rows, left = polish(problem, rows)
    _warn(np.linalg.cond(rows[:, :-1]), max_condition, left / count, weight)
    return _from_standard(rows, units)


def transform_penalty(
    transforms: Sequence[ChannelTransform],
    *,
    weight: float,
    center: ChannelTransform | None = None,
    units: StandardUnits | None = None,
) -> float:
    """Return what the prior takes from the log-likelihood: weight / 2 ||W~ - W~_0||^2 summed over transforms.

    Parameters
    ----------
    transforms : sequence of ChannelTransform
        At least one.
    weight, center, units : float, ChannelTransform and StandardUnits
        As of `estimate_transform`.

    Returns
    -------
    float
        In nats. With an infinite weight zero for the center, and infinity for all others.

    Examples
    --------
    >>> import numpy as np
    >>> transform_penalty([ChannelTransform(np.array([[3.0]]), np.array([1.0]))], weight=10.0)  # 5 (2^2 + 1^2)
    25.0
    """
    n_channels = len(transforms[0].bias)
    units = standard_units(n_channels) if units is None else units
    middle = _to_standard(identity_transform(n_channels) if center is None else center, units)
    distance = sum(float(((_to_standard(part, units) - middle) ** 2).sum()) for part in transforms)
    return 0.5 * weight * distance if distance else 0.0


def _standardize(statistics: TransformStatistics, units: StandardUnits) -> tuple[NDArray, NDArray]:
    """Return G_i and k_i of all classes together, of channels in standard units.

    zeta = T zeta~ with T = (S m; 0 1), and what z~ misses is 1 / scale of what z misses. The last entry of zeta is the
    sum of its window's coefficients, so that the last row of G_i is what k_i loses when z counts from the origin.
    """
    n_channels = len(units.scales)
    back = np.eye(n_channels + 1)  # T^-1
    back[:-1, :-1] /= units.scales
    back[:-1, -1] = -units.origin / units.scales
    quadratic = statistics.quadratic.sum(axis=0)
    linear = statistics.linear.sum(axis=0) - units.origin[:, np.newaxis] * quadratic[:, -1]
    quadratic = units.scales[:, np.newaxis, np.newaxis] ** 2 * (back @ quadratic @ back.T)
    quadratic = 0.5 * (quadratic + quadratic.transpose(0, 2, 1))
    return quadratic, units.scales[:, np.newaxis] * (linear @ back.T)


def _to_standard(transform: ChannelTransform, units: StandardUnits) -> NDArray[np.float64]:
    """Return W~ of shape (n_channels, n_channels + 1)."""
    matrix = transform.matrix * units.scales / units.scales[:, np.newaxis]
    bias = (transform.matrix @ units.origin + transform.bias - units.origin) / units.scales
    return np.column_stack((matrix, bias))


def _from_standard(rows: NDArray[np.float64], units: StandardUnits) -> ChannelTransform:
    matrix = rows[:, :-1] * units.scales[:, np.newaxis] / units.scales
    return ChannelTransform(matrix, units.scales * rows[:, -1] + units.origin - matrix @ units.origin)


def _check_orientation(middle: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
    for name, matrix in (("center", middle), ("start", rows)):
        sign = np.linalg.slogdet(matrix[:, :-1]).sign
        if not sign > 0:
            raise ValueError(f"{name} must be a transform with a positive determinant, got one of sign {sign:g}")


def _warn(condition: float, limit: float, left: float, weight: float) -> None:
    if condition > limit:
        warnings.warn(
            f"the transform is nearly singular: condition number {condition:.1e} in standard units (limit "
            f"{limit:.0e}), and what is generated with it will blow up; raise the weight above {weight:g}",
            UserWarning,
            stacklevel=3,
        )
    if left > _UNFINISHED:
        warnings.warn(
            f"the transform is not quite at the maximum: {left:.0e} nats a frame and window could still be gained, "
            f"as the objective is nearly flat; raise the weight of the prior above {weight:g}",
            UserWarning,
            stacklevel=3,
        )
