"""Warnings: of walks that lie outside of what was learned from, and of walks of one person on both sides of a split."""

import re
import warnings
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import f as fisher

__all__ = [
    "LIMIT",
    "LeakageWarning",
    "OutsideDataWarning",
    "distance_limit",
    "distances",
    "share_beyond",
    "warn_leakage",
    "warn_outside",
]

LIMIT = 0.99
"""Share of new walkers, of the same kind as those in training, that are expected within the limit."""


class OutsideDataWarning(UserWarning):
    """A generated walk lies further from the training walkers than nearly all walkers of their kind."""


class LeakageWarning(UserWarning):
    """Walks of one person seem to be on both sides of a split, so that predictions come out too well."""


def distances(scores: NDArray[np.float64], covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the Mahalanobis distance of centered scores, sqrt(s' Cov^-1 s), shape (n_walkers,).

    Directions in which the training walkers do not vary do not count.
    """
    variances, directions = np.linalg.eigh(covariance)
    varies = variances > np.finfo(np.float64).eps * len(variances) * variances.max(initial=0.0)
    along = scores @ directions[:, varies]
    return np.sqrt((along**2 / variances[varies]).sum(axis=1))


def _scale(n_walkers: int, n_components: int) -> float:
    return n_components * (n_walkers**2 - 1) / (n_walkers * (n_walkers - n_components))


def distance_limit(n_walkers: int, n_components: int, share: float = LIMIT) -> float:
    """Return the distance within which a share of new walkers lie, if all are of one normal distribution.

    For n walkers in training and k components d^2 n (n - k) / (k (n^2 - 1)) of a new one has the F distribution with k
    and n - k degrees of freedom (Hotelling). Infinite where n <= k. Where the components were chosen as those in which
    the training walkers vary most, others vary less in them, and more than the share lie within.
    """
    if n_walkers <= n_components:
        return float("inf")
    return float(np.sqrt(_scale(n_walkers, n_components) * fisher.ppf(share, n_components, n_walkers - n_components)))


def share_beyond(distance: NDArray[np.float64], n_walkers: int, n_components: int) -> NDArray[np.float64]:
    """Return which share of new walkers is expected further away, 1 - share of `distance_limit`; NaN where n <= k."""
    if n_walkers <= n_components:
        return np.full(np.shape(distance), np.nan)
    ratio = np.asarray(distance) ** 2 / _scale(n_walkers, n_components)
    return np.asarray(fisher.sf(ratio, n_components, n_walkers - n_components))


def warn_outside(distance: NDArray[np.float64], limit: float, names: Sequence[str], *, stacklevel: int = 3) -> None:
    """Warn if walks are further from the training walkers than the limit, naming the furthest."""
    if not (distance > limit).any():
        return
    furthest = int(np.argmax(distance))
    warnings.warn(
        f"outside your data: {int((distance > limit).sum())} of {len(distance)} walks lie further from the training "
        f"walkers than {LIMIT:.0%} of walkers of their kind, who are within {limit:.3g} SD; the furthest, "
        f"{names[furthest]!r}, at {distance[furthest]:.3g} SD; nobody walks like that, use an alpha nearer to zero",
        OutsideDataWarning,
        stacklevel=stacklevel,
    )


def warn_leakage(names: Sequence[str], groups: ArrayLike | None) -> list[str]:
    """Warn if walks look like several of one person by their names, and nobody says who is who; return the warning.

    Names that repeat are of one person, as are passes and strides of one recording; of names with two numbers that
    vary, such as "S01_0003" or "07_walk_02", the first is taken for the person and what follows for the trial. Walks
    without a name say nothing.
    """
    if groups is not None:
        return []
    named = [name for name in names if name]
    persons = _persons_by_name(named)
    several = {person: count for person, count in Counter(persons).items() if count > 1}
    if not several:
        return []
    shown = [f"{person!r} {count} times" for person, count in several.items()]
    shown = shown if len(shown) < 4 else [*shown[:3], "..."]
    text = (
        f"{len(named)} walks look like those of {len(set(persons))} persons by their names ({', '.join(shown)}), "
        "but no groups are given: walks of one person are on both sides of a split, and scores are too good. Pass "
        "groups, the person of each walk; range(len(walks)) if each is another person's"
    )
    warnings.warn(text, LeakageWarning, stacklevel=3)
    return [text]


def _persons_by_name(names: Sequence[str]) -> list[str]:
    """Return the part of each name that stands for a person, or the name."""
    names = [re.sub(r"(_(pass|stride)\d+)+$", "", name) for name in names]
    tokens = [re.split(r"[_\-\s.]+", name) for name in names]
    n_tokens = {len(parts) for parts in tokens}
    if len(n_tokens) != 1:
        return list(names)
    varied = [place for place in range(n_tokens.pop()) if len({parts[place] for parts in tokens}) > 1]
    numbered = [place for place in varied if all(re.search(r"\d", parts[place]) for parts in tokens)]
    if len(numbered) < 2:
        return list(names)
    return ["_".join(parts[place] for place in varied if place <= numbered[0]) for parts in tokens]
