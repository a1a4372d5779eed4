"""Ratings of observers become labels of traits (Troje 2002, section 4)."""

import warnings
from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker._validation import check_names
from eigenwalker.experiment.ratings.additive_effects import additive_means, linked_parts
from eigenwalker.experiment.ratings.array import RatedTrait, rated_traits
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["rating_counts", "ratings_to_traits"]

_Walks = Sequence[Walk | JointWalk | str]


def ratings_to_traits(
    answers: pd.DataFrame,
    *,
    walks: _Walks | None = None,
    standardize: bool = False,
    adjust: bool = False,
    min_ratings: int = 1,
) -> pd.DataFrame:
    r"""Return what observers on average thought of every walker: the vector r of Eq. 5, one column a trait.

    .. math:: r_w = \frac{1}{n_w} \sum_{o, v} r_{w o v}

    over the n_w ratings r of walker w by observers o in views v. Those of one walker by one observer in one view are
    averaged first, however many they are. The paper's three observers rated every walker once in each of three views,
    so that n_w is 9; with gaps, `adjust` is what the paper did not need. The columns are labels for `TraitRegressor`,
    which learns each trait from the walkers that have a label:
    ``make_eigenwalkers().fit(walks, ratings_to_traits(answers, walks=walks))``.

    Parameters
    ----------
    answers : DataFrame
        Answers of a study, one row a trial: participant, task, part, trait, stimulus, view and value, 1 to 6 with
        six buttons. Used are the rows of the task "rating" and the part "main" that have a value. Where the column
        study has several studies, participants of the same number are different observers.
    walks : list of Walk, JointWalk or str, default None
        In whose order the rows come, by their names, which are those of the stimuli. None: all rated walkers, in
        alphabetical order.
    standardize : bool, default False
        Whether the ratings of an observer are turned into z-scores before they are averaged, not in the paper: less
        the mean of all ratings that the observer gave to the trait, in all views and sessions, over their standard
        deviation. Observers then count the same, whether they use the middle buttons or the outer ones.
    adjust : bool, default False
        Whether gaps are accounted for, not in the paper: the mean of a walker that a harsh observer did not rate is
        too high. Returned is what the mean would be without gaps, if observers and views shift all walkers alike, see
        `additive_means`; it can be below 1 or above 6. Without gaps it is the mean.
    min_ratings : int, default 1
        A walker with fewer ratings of a trait, in how many views and by how many observers, gets NaN.

    Returns
    -------
    DataFrame
        One row a walker, index "walker"; one column a trait, alphabetical; NaN where a walker has no rating of a trait,
        or fewer than `min_ratings`.

    Warns
    -----
    UserWarning
        If `standardize` leaves out observers who have no z-scores because all their ratings of a trait are the same.

    Raises
    ------
    TypeError
        If the answers are no DataFrame or walks are neither walks nor names.
    ValueError
        If the answers are not as they should be, ratings are of a walker that is not among the walks, walks have the
        same name, `min_ratings` is less than 1, nobody's ratings of a trait can be standardized, or gaps leave walkers
        without any link so that they cannot be adjusted to each other.

    References
    ----------
    Troje 2002, section 4 and Eq. 5.

    Examples
    --------
    >>> answers = pd.DataFrame({"stimulus": ["anna", "bert"] * 3, "value": [5, 2, 6, 1, 4, 3]})
    >>> answers = answers.assign(participant=[1, 1, 2, 2, 3, 3], task="rating", part="main", trait="happy", view=0.0)
    >>> ratings_to_traits(answers, walks=["bert", "anna", "carl"])
            happy
    walker
    bert      2.0
    anna      5.0
    carl      NaN
    """
    if min_ratings < 1:
        raise ValueError(f"min_ratings must be 1 or more, got {min_ratings!r}")
    traits = rated_traits(answers)
    rows = _row_names(traits, walks)
    same = {name: _pressing_one_button(rated) for name, rated in traits.items()} if standardize else {}
    _warn_left_out(traits, same)
    columns = {}
    for name, rated in traits.items():
        ratings = _z_scores(rated.ratings, same[name]) if standardize else rated.ratings
        means = _walker_means(ratings.reshape(len(ratings), -1), rated.walkers, name, adjust=adjust)
        enough = (~np.isnan(ratings)).sum(axis=(1, 2)) >= min_ratings
        columns[name] = pd.Series(np.where(enough, means, np.nan), rated.walkers).reindex(rows)
    return pd.DataFrame(columns, index=rows)


def rating_counts(answers: pd.DataFrame, *, walks: _Walks | None = None) -> pd.DataFrame:
    """Return how many ratings the means of `ratings_to_traits` are of: by so many observers in so many views.

    Parameters
    ----------
    answers : DataFrame
        See `ratings_to_traits`.
    walks : list of Walk, JointWalk or str, default None
        In whose order the rows come. None: all rated walkers, in alphabetical order.

    Returns
    -------
    DataFrame
        One row a walker, index "walker", one column a trait; 0 where there are none. Ratings of one walker by one
        observer in one view count as one.

    Raises
    ------
    TypeError, ValueError
        As `ratings_to_traits`.
    """
    traits = rated_traits(answers)
    rows = _row_names(traits, walks)
    counts = {
        name: pd.Series((~np.isnan(rated.ratings)).sum(axis=(1, 2)), rated.walkers).reindex(rows, fill_value=0)
        for name, rated in traits.items()
    }
    return pd.DataFrame(counts, index=rows)


def _row_names(traits: dict[str, RatedTrait], walks: _Walks | None) -> pd.Index:
    rated = sorted(set().union(*[one.walkers for one in traits.values()]))
    if walks is None:
        return pd.Index(rated, name="walker")
    if isinstance(walks, (str, Walk, JointWalk)):
        raise TypeError(f"expected a list of walks or names, got a single {type(walks).__name__}: wrap it, [walk]")
    wrong = [walk for walk in walks if not isinstance(walk, (str, Walk, JointWalk))]
    if wrong:
        raise TypeError(f"expected a list of walks or names, got {type(wrong[0]).__name__} among them")
    names = check_names([walk if isinstance(walk, str) else walk.name for walk in walks], name="names of walks")
    foreign = sorted(set(rated) - set(names))
    if foreign:
        shown = ", ".join(foreign[:8]) + (f" and {len(foreign) - 8} more" if len(foreign) > 8 else "")
        raise ValueError(
            f"expected ratings of the {len(names)} walks only, but {len(foreign)} rated walkers are not among them: "
            f"{shown}; add these walks, or leave out their answers"
        )
    return pd.Index(names, name="walker")


def _pressing_one_button(rated: RatedTrait) -> NDArray[np.bool_]:
    """Return which observers have no z-scores."""
    return np.nanmax(rated.ratings, axis=(0, 2)) == np.nanmin(rated.ratings, axis=(0, 2))


def _warn_left_out(traits: dict[str, RatedTrait], same: dict[str, NDArray[np.bool_]]) -> None:
    none = [name for name, alike in same.items() if alike.all()]
    if none:
        raise ValueError(
            f"expected an observer whose ratings of a trait differ, to standardize them, there is none for: "
            f"{', '.join(none)}; use standardize=False or leave out the trait's answers"
        )
    left_out = [
        f"{', '.join(map(str, traits[name].observers[alike]))} ({name})" for name, alike in same.items() if alike.any()
    ]
    if left_out:
        warnings.warn(
            f"left out, because all their ratings of a trait are the same and have no z-scores: {'; '.join(left_out)}",
            stacklevel=3,
        )


def _z_scores(ratings: NDArray[np.float64], same: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return z-scores within observers, of those that have them, shape (n_walkers, n_varying_observers, n_views)."""
    varying = ratings[:, ~same]
    means = np.nanmean(varying, axis=(0, 2), keepdims=True)
    return (varying - means) / np.nanstd(varying, axis=(0, 2), ddof=1, keepdims=True)


def _walker_means(table: NDArray[np.float64], walkers: pd.Index, trait: str, *, adjust: bool) -> NDArray[np.float64]:
    """Return the means of the rows; NaN of those that only observers rated who were left out."""
    there = ~np.isnan(table)
    rated, used = there.any(axis=1), there.any(axis=0)
    means = np.full(len(table), np.nan)
    if not adjust:
        means[rated] = np.nanmean(table[rated], axis=1)
        return means
    kept = table[rated][:, used]
    parts = linked_parts(kept)
    if parts.any():
        groups = [", ".join(walkers[rated][parts == part][:3]) for part in range(parts.max() + 1)]
        raise ValueError(
            f"trait {trait!r}: ratings can be adjusted for who is missing only if walkers share observers and views, "
            f"but these share none with the others: {'; '.join(groups[:8])} ...; use adjust=False, or leave them out"
        )
    means[rated] = additive_means(kept)
    return means
