"""Dots of limited lifetime: which of them are lit at which time."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Lifetime", "lit_dots"]

_ROUNDING = 1e-9  # of a renewal, by which a frame may come early and still show it


class Lifetime(NamedTuple):
    """Dots of which only some are lit at a time, see `lit_dots`.

    Parameters
    ----------
    first, stop : int
        They are the dots from `first` to before `stop`.
    n_visible : int
        How many of them are lit at a time.
    duration : float
        How long each stays lit, in seconds.
    seed : int
        What their order is drawn with.
    """

    first: int
    stop: int
    n_visible: int
    duration: float
    seed: int


def lit_dots(times: NDArray[np.floating], lifetime: Lifetime) -> NDArray[np.bool_]:
    """Return which dots are lit, a pure function of time.

    At time zero `n_visible` dots are lit, drawn at random. From then on one dot goes out every duration / n_visible
    seconds, the one that has been lit for longest, and in that moment another one is lit, drawn evenly from those that
    are dark, the one that goes out left aside. So at any time exactly `n_visible` dots are lit, each of them stays lit
    for `duration` (those of time zero for less), and the display changes a little at a time and never as a whole.

    The draws are made from the start on, in order, so that the answer for a time does not depend on which other times
    are asked for, nor on the frame rate.

    Parameters
    ----------
    times : ndarray of shape (n_times,)
        In seconds, not negative, in any order.
    lifetime : Lifetime
        How many are lit, and for how long.

    Returns
    -------
    ndarray of shape (n_times, stop - first)

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.display.lifetime import Lifetime, lit_dots
    >>> lit_dots(np.array([0.0, 0.19, 0.2]), Lifetime(0, 5, 2, 0.4, seed=0)).sum(axis=1)
    array([2, 2, 2])
    """
    if len(times) and times.min() < 0:
        raise ValueError(f"times must not be negative for dots of limited lifetime, got {times.min():g} s")
    n_dots = lifetime.stop - lifetime.first
    renewals = np.floor(times * lifetime.n_visible / lifetime.duration + _ROUNDING).astype(np.intp)
    lit = np.zeros((len(times), n_dots), dtype=bool)
    if len(times):
        orders = _orders(n_dots, lifetime.n_visible, int(renewals.max()), lifetime.seed)
        np.put_along_axis(lit, orders[renewals], True, axis=1)
    return lit


def _orders(n_dots: int, n_visible: int, n_renewals: int, seed: int) -> NDArray[np.intp]:
    """Return which dots are lit after 0, 1, 2, ... renewals, shape (n_renewals + 1, n_visible)."""
    uniform = np.random.RandomState(seed).random_sample(n_dots + n_renewals)
    shuffled = [int(dot) for dot in np.argsort(uniform[:n_dots], kind="stable")]
    lit, dark = shuffled[:n_visible], shuffled[n_visible:]
    orders = np.empty((n_renewals + 1, n_visible), dtype=np.intp)
    orders[0] = lit
    for renewal, draw in enumerate(uniform[n_dots:]):
        oldest, drawn = renewal % n_visible, int(draw * len(dark))
        lit[oldest], dark[drawn] = dark[drawn], lit[oldest]
        orders[renewal + 1] = lit
    return orders
