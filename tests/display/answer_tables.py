"""Tables as reports of answers have them."""

import numpy as np
import pandas as pd

__all__ = ["confusions", "estimates", "ratings", "scores", "shares"]


def estimates(groups=("cool", "sad", "afraid"), series=("original", "synthetic")):
    """Return estimates of groups and series; without series those of groups alone."""
    values = np.random.default_rng(0).uniform(20, 80, max(1, len(series)) * len(groups))
    index = pd.MultiIndex.from_product([groups, series]) if series else pd.Index(groups)
    return pd.DataFrame({"value": values, "low": values - 10, "high": values + 15}, index=index)


def shares(series=("original", "synthetic"), answers=("real", "synthetic", "don't know")):
    """Return shares of answers to series of walks; without series those of answers alone."""
    counts = np.random.default_rng(1).integers(5, 50, (max(1, len(series)), len(answers)))
    table = pd.DataFrame({"n_answers": counts.ravel(), "n_trials": np.repeat(counts.sum(axis=1), len(answers))})
    table["share"] = table["n_answers"] / table["n_trials"]
    table = table.assign(low=0.8 * table["share"], high=np.minimum(1, 1.2 * table["share"]))
    return table.set_index(pd.MultiIndex.from_product([series, answers]) if series else pd.Index(answers))


def scores(styles=("cool", "sad", "afraid")):
    """Return shares of the scores 0 to 4, and means."""
    parts = np.random.default_rng(2).dirichlet(np.ones(5), len(styles))
    means = parts @ np.arange(5)
    return (
        pd.DataFrame(parts, index=styles, columns=range(5)),
        pd.DataFrame({"value": means, "low": means - 0.2, "high": means + 0.2}, index=styles),
    )


def confusions(kinds=("original", "synthetic"), styles=("cool", "sad")):
    """Return confusion tables with one more answer than there are styles."""
    answers = [*styles, "don't know"]
    random = np.random.default_rng(3)
    return {
        kind: pd.DataFrame(random.dirichlet(np.ones(len(answers)), len(styles)), index=styles, columns=answers)
        for kind in kinds
    }


def ratings(n_walkers=5, traits=("happy", "nervous")):
    """Return mean ratings, and the ends of their intervals."""
    names = [f"walker {number}" for number in range(n_walkers)]
    values = np.random.default_rng(4).uniform(2, 5, (n_walkers, len(traits)))
    means = pd.DataFrame(values, index=names, columns=list(traits))
    return means, means - 0.5, means + 0.7
