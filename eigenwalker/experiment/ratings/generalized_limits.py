"""Intervals of intraclass correlations that hold with few observers."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import chdtr, chdtri

__all__ = ["generalized_interval"]

_N_OBSERVERS, _N_ERROR, _FEW = 64, 24, 40


def generalized_interval(
    squares: tuple[float, float, float], n_walkers: int, n_observers: int, *, level: float = 0.95
) -> tuple[float, float]:
    r"""Return the generalized confidence interval (Weerahandi 1993) of ICC(2,1).

    In the two-way random model the mean squares of walkers R, observers C and error E are distributed as their
    expectations times chi-squares over degrees of freedom. So where the sums of squares are known, and chi-squares are
    drawn, R* = SS_R / chi2(n - 1), C* = SS_C / chi2(k - 1), E* = SS_E / chi2((n - 1)(k - 1)) and

    .. math:: \rho^* = \frac{R^* - E^*}{R^* + (k - 1) E^* + k (C^* - E^*) / n}

    tell where the coefficient may be. The limits are quantiles of its distribution. It is integrated here, not drawn:
    the interval is the same at every call, and right to about 0.001.

    Parameters
    ----------
    squares : (float, float, float)
        Mean squares of walkers, observers and error; not all 0.
    n_walkers, n_observers : int
        n and k, 2 or more.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    low, high : float

    References
    ----------
    Weerahandi 1993, Journal of the American Statistical Association 88, 899-905. Ionan, Polley, McShane & Dobbin 2014,
    BMC Medical Research Methodology 14:121, compare it with others for this coefficient.
    """
    if squares[1] == 0 == squares[2]:
        return 1.0, 1.0
    share = _share_below(squares, n_walkers, n_observers)
    return _quantile(share, (1 - level) / 2), _quantile(share, (1 + level) / 2)


def _share_below(squares: tuple[float, float, float], n_walkers: int, n_observers: int) -> Callable[[float], float]:
    """Return the distribution function of the coefficient."""
    free = n_walkers - 1, n_observers - 1, (n_walkers - 1) * (n_observers - 1)
    total = squares[0] * free[0]
    (observers, observer_weights), (error, error_weights) = (
        _nodes(free[1], _N_OBSERVERS),
        _nodes(free[2], _N_ERROR if free[2] < _FEW else _N_ERROR // 2),
    )
    spread = (squares[1] * free[1] / observers)[:, np.newaxis] * n_observers / n_walkers
    noise = squares[2] * free[2] / error
    inner = n_observers - 1 - n_observers / n_walkers

    def share(coefficient: float) -> float:
        # rho* <= r is R* (1 - r) <= E* (1 + r (k - 1 - k / n)) + r C* k / n.
        most = noise * (1 + coefficient * inner) + coefficient * spread
        if coefficient >= 1:
            return 1.0
        least = np.divide(total * (1 - coefficient), most, out=np.full(most.shape, np.inf), where=most > 0)
        return float(observer_weights @ (1 - chdtr(free[0], least)) @ error_weights)

    return share


@cache
def _nodes(free: int, n_nodes: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return quantiles of chi-square and weights with which a mean over them is an integral over its distribution."""
    places, weights = np.polynomial.legendre.leggauss(n_nodes)
    return chdtri(free, (1 - places) / 2), weights / 2


def _quantile(share: Callable[[float], float], wanted: float) -> float:
    low = -1.0
    while share(low) > wanted:
        low *= 2
    return float(brentq(lambda place: share(place) - wanted, low, 1.0, xtol=1e-8))
