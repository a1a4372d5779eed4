"""Mean ratings of walkers, with what other observers would leave open."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker.experiment.analysis.means import mean_interval
from eigenwalker.experiment.ratings.array import RatedTrait, rated_traits

__all__ = ["MeanRatings", "mean_ratings"]


class MeanRatings(NamedTuple):
    """Mean ratings of walkers and their intervals, as `RatingsDisplay.from_frames` takes them.

    Parameters
    ----------
    means, low, high : DataFrame
        One row a walker, one column a trait, both in alphabetical order; NaN where a walker has no rating of a trait.
    """

    means: pd.DataFrame
    low: pd.DataFrame
    high: pd.DataFrame


def mean_ratings(answers: pd.DataFrame, *, scale: tuple[float, float] = (1.0, 6.0), level: float = 0.95) -> MeanRatings:
    """Return the mean rating of each walker with the interval of Student's t over observers.

    The ratings of one observer in several views are alike, see `mean_interval`. Three observers, as in Troje 2002,
    section 4, leave much open: t has two degrees of freedom and is 4.3. The means are those of `ratings_to_traits`.

    Parameters
    ----------
    answers : DataFrame
        Answers of a study, see `ratings_to_traits`.
    scale : (float, float), default (1.0, 6.0)
        The lowest and the highest rating there can be, at which intervals end; that of a single observer is all of it.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    MeanRatings

    Raises
    ------
    TypeError, ValueError
        If the answers are not as they should be, or ratings are outside the scale.

    Examples
    --------
    >>> answers = pd.DataFrame({"stimulus": ["anna", "bert"] * 3, "value": [5, 2, 6, 1, 5, 3]})
    >>> answers = answers.assign(participant=[1, 1, 2, 2, 3, 3], task="rating", part="main", trait="happy", view=0.0)
    >>> found = mean_ratings(answers)
    >>> pd.concat(found._asdict(), axis=1).droplevel(1, axis=1).round(2)
            means  low  high
    walker
    anna     5.33  3.9  6.00
    bert     2.00  1.0  4.48
    """
    traits = rated_traits(answers)
    low, high = scale
    outside = [
        name for name, rated in traits.items() if np.nanmin(rated.ratings) < low or np.nanmax(rated.ratings) > high
    ]
    if outside:
        raise ValueError(f"expected ratings from {low:g} to {high:g}, got others of: {', '.join(outside)}; pass scale=")
    found = {name: _estimates(rated, level) for name, rated in traits.items()}
    rows = pd.Index(sorted(set().union(*[rated.walkers for rated in traits.values()])), name="walker")
    parts = [
        pd.DataFrame({name: pd.Series(table[:, at], traits[name].walkers) for name, table in found.items()}, index=rows)
        for at in range(3)
    ]
    return MeanRatings(parts[0], parts[1].clip(lower=low), parts[2].clip(upper=high))


def _estimates(rated: RatedTrait, level: float) -> NDArray[np.float64]:
    """Return mean, low and high of each walker, shape (n_walkers, 3)."""
    observers = np.repeat(np.arange(len(rated.observers)), len(rated.views))
    estimates = []
    for ratings in rated.ratings.reshape(len(rated.walkers), -1):  # (n_observers * n_views,)
        there = ~np.isnan(ratings)
        estimates.append(mean_interval(ratings[there], observers[there], level=level))
    return np.array(estimates)
