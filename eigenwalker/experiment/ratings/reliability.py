"""How far ratings can be relied on: over observers, over viewpoints, over halves (Troje 2002, section 4)."""

from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker._validation import check_choice
from eigenwalker.experiment.analysis.trials import trials_of
from eigenwalker.experiment.ratings.array import RatedTrait, rated_traits
from eigenwalker.experiment.ratings.gaps import CompleteCases, complete_cases
from eigenwalker.experiment.ratings.intraclass import ICC_INTERVALS, check_level, intraclass_correlation
from eigenwalker.experiment.ratings.split_half import split_half_reliability
from eigenwalker.model.intervals import score_interval

__all__ = ["reliability_table", "view_correlations"]

_NOTHING = (float("nan"),) * 3


def reliability_table(
    answers: pd.DataFrame,
    *,
    missing: str = "error",
    interval: str = "generalized",
    level: float = 0.95,
    n_splits: int = 1000,
    random_state: int | np.random.RandomState | None = None,
) -> pd.DataFrame:
    """Return how reliable the ratings of each trait are, each number with its confidence interval.

    Every observer rates every walker in every view, as in the paper: there, three observers, three views, 80 walkers
    and two traits; its text gives no reliability. Walkers are a sample of walkers, in all columns; what else each
    generalizes to is said below.

    Parameters
    ----------
    answers : DataFrame
        Answers of a study, see `ratings_to_traits`.
    missing : {"error", "drop_walkers", "drop_observers"}, default "error"
        What is done about gaps: raise, or leave out the walkers that somebody has not rated in some view, or the
        observers who have not rated every walker in every view. For each trait by itself.
    interval : {"generalized", "satterthwaite"}, default "generalized"
        How intervals of ICC(2,1) and ICC(2,k) are made, see `intraclass_correlation`. "satterthwaite" is what other
        programs print; it is too narrow with three observers.
    level : float, default 0.95
        Of confidence.
    n_splits, random_state : int, default 1000, and int, RandomState or None, default None
        See `split_half_reliability`. Up to 12 observers all splits are taken, and none is random.

    Returns
    -------
    DataFrame
        One row a trait. Names that end in _low and _high are limits.

        - n_observers, n_views, n_walkers: that were used; n_observers_left_out and n_walkers_left_out because of gaps.
        - icc_single: ICC(2,1) of ratings averaged over these views. The reliability of *one observer taken at random*,
          who sees all these views; that some observers are harsher counts as error.
        - icc_mean: ICC(2,k), of the mean over *as many observers taken at random*: of `ratings_to_traits`.
        - split_half: that of the same mean, but how harsh observers are does not matter, as it does not to a trait axis
          if everybody has rated all walkers. Of observers like *these*.
        - view_icc: ICC(3,1) of ratings averaged over these observers, between *these views*. The same people see all
          of them: what they privately think of a walker counts as agreement. See `view_correlations` for pairs.
        - n_attention and n_attention_failed: attention trials that the observers of the trait answered, those left out
          as well, and otherwise than asked for; n_observers_failing: observers with such a trial. Nobody is left out
          for them. By participant: ``trials_of(answers, "rating").attention``.

        NaN, with one observer: icc_single, icc_mean and split_half; with one view: view_icc; with two walkers:
        split_half; and where ratings do not differ, see `intraclass_correlation` and `split_half_reliability`.

    Raises
    ------
    TypeError
        If the answers are no DataFrame.
    ValueError
        If the answers are not as they should be, there are gaps, fewer than two walkers, or an unknown option.

    References
    ----------
    Shrout & Fleiss 1979; McGraw & Wong 1996; Horst 1951: see the functions named above.

    Examples
    --------
    >>> ratings = [[6, 2, 5, 5], [4, 1, 3, 2], [5, 4, 6, 5], [4, 1, 2, 4], [6, 5, 6, 6], [4, 2, 4, 5]]
    >>> answers = pd.DataFrame(ratings, index=list("abcdef")).melt(ignore_index=False, var_name="participant")
    >>> answers = answers.rename_axis("stimulus").reset_index()
    >>> answers = answers.assign(task="rating", part="main", trait="happy", view=0.0)
    >>> table = reliability_table(answers)
    >>> table.loc["happy", ["icc_single", "icc_single_low", "icc_single_high"]].round(2).tolist()
    [0.49, 0.07, 0.86]
    """
    check_choice(interval, ICC_INTERVALS, name="interval")
    check_level(level)
    traits = rated_traits(answers)
    attention = _attention(answers)
    rows = {}
    for name, rated in traits.items():
        whole = _whole(name, rated, missing)
        n_walkers, n_observers, n_views = whole.ratings.shape
        rows[name] = {
            "n_observers": n_observers,
            "n_views": n_views,
            "n_walkers": n_walkers,
            "n_observers_left_out": len(whole.observers_left_out),
            "n_walkers_left_out": len(whole.walkers_left_out),
            **_over_observers(whole.ratings.mean(axis=2), interval, level, n_splits, random_state),
            **_with_limits("view_icc", _between_views(whole.ratings.mean(axis=1), level)),
            **_attention_of(attention.reindex(rated.observers, fill_value=0)),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("trait")


def view_correlations(answers: pd.DataFrame, *, missing: str = "error", level: float = 0.95) -> pd.DataFrame:
    """Return how alike walkers are rated in each pair of views: the correlation over walkers of the mean ratings.

    The means are over observers, the same ones in both views: what they privately think of a walker makes views alike.
    Intervals are from Fisher's transformation; they are about other walkers, with these observers and views.

    Parameters
    ----------
    answers : DataFrame
        Answers of a study, see `ratings_to_traits`.
    missing : {"error", "drop_walkers", "drop_observers"}, default "error"
        See `reliability_table`.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    DataFrame
        One row a trait and pair of views: trait, view, other_view, n_walkers, r, low and high. Without rows where there
        is one view; NaN where all walkers have the same mean in a view; three walkers or fewer leave the interval open.

    Raises
    ------
    TypeError, ValueError
        As `reliability_table`.
    """
    check_level(level)
    rows = []
    for name, rated in rated_traits(answers).items():
        means = _whole(name, rated, missing).ratings.mean(axis=1)  # (n_walkers, n_views)
        for one, other in combinations(range(len(rated.views)), 2):
            r, low, high = _correlation(means[:, one], means[:, other], level)
            rows.append((name, rated.views[one], rated.views[other], len(means), r, low, high))
    return pd.DataFrame(rows, columns=["trait", "view", "other_view", "n_walkers", "r", "low", "high"])


def _whole(trait: str, rated: RatedTrait, missing: str) -> CompleteCases:
    """Return the ratings of a trait without gaps."""
    try:
        whole = complete_cases(rated.ratings, rated.walkers, rated.observers, missing=missing)
    except ValueError as error:
        raise ValueError(f"trait {trait!r}: {error}") from None
    if len(whole.ratings) < 2:
        raise ValueError(f"trait {trait!r}: expected two walkers or more that everybody has rated, got one")
    return whole


def _with_limits(name: str, estimate: tuple[float, ...]) -> dict[str, float]:
    return dict(zip((name, f"{name}_low", f"{name}_high"), estimate, strict=True))


def _over_observers(
    means: NDArray[np.float64],
    interval: str,
    level: float,
    n_splits: int,
    random_state: int | np.random.RandomState | None,
) -> dict[str, float]:
    """Return the coefficients of ratings averaged over views, shape (n_walkers, n_observers)."""
    single, mean, halves = _NOTHING, _NOTHING, _NOTHING
    if means.shape[1] > 1:
        single = intraclass_correlation(means, kind="ICC(2,1)", level=level, interval=interval)[:3]
        mean = intraclass_correlation(means, kind="ICC(2,k)", level=level, interval=interval)[:3]
        if len(means) > 2:
            halves = split_half_reliability(means, n_splits=n_splits, level=level, random_state=random_state)
    return _with_limits("icc_single", single) | _with_limits("icc_mean", mean) | _with_limits("split_half", halves)


def _between_views(means: NDArray[np.float64], level: float) -> tuple[float, ...]:
    return intraclass_correlation(means, kind="ICC(3,1)", level=level)[:3] if means.shape[1] > 1 else _NOTHING


def _correlation(one: NDArray[np.float64], other: NDArray[np.float64], level: float) -> tuple[float, ...]:
    if np.ptp(one) == 0 or np.ptp(other) == 0:
        return _NOTHING
    return float(np.corrcoef(one, other)[0, 1]), *score_interval(one, other, "r", level=level)


def _attention(answers: pd.DataFrame) -> pd.DataFrame:
    """Return how many attention trials of ratings each observer answered, and how many otherwise than asked for."""
    if not ((answers["task"] == "rating") & (answers["part"] == "attention")).any():
        return pd.DataFrame({"n_trials": [], "n_failed": []}, dtype=int)
    return trials_of(answers, "rating").attention


def _attention_of(observers: pd.DataFrame) -> dict[str, int]:
    return {
        "n_attention": int(observers["n_trials"].sum()),
        "n_attention_failed": int(observers["n_failed"].sum()),
        "n_observers_failing": int((observers["n_failed"] > 0).sum()),
    }
