"""Studies that are simulated many times over: how many people one has to ask."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pandas as pd
from joblib import Parallel, delayed
from sklearn.utils import check_random_state

from eigenwalker.display._numbers import check_count
from eigenwalker.experiment.simulated.observers import simulate_answers
from eigenwalker.experiment.study import Study

__all__ = ["simulate_studies"]


def simulate_studies(
    study: Study,
    analyze: Callable[[pd.DataFrame], Mapping[str, Any] | pd.Series | float],
    *,
    n_sets: int = 100,
    random_state: Any = None,
    n_jobs: int | None = None,
    **observers: Any,
) -> pd.DataFrame:
    """Return what an analysis finds in many sets of simulated answers: the power of a study before it is run.

    Parameters
    ----------
    study : Study
        With as many participants as are asked about.
    analyze : callable
        Takes a table of answers; returns a number, or several by names.
    n_sets : int, default 100
        How often the study is simulated.
    random_state : int, RandomState or None, default None
        Seed; sets have seeds of their own.
    n_jobs : int, default None
        Number of processes, as in joblib. Results do not depend on it.
    **observers
        Of `simulate_answers`: truth, noise, taste, bias, gain, lapse, missing and participants.

    Returns
    -------
    DataFrame
        One row a set, one column a name; of a single number the column "value".

    Raises
    ------
    ValueError
        As of `simulate_answers`, or if there are no sets.

    Examples
    --------
    How many observers it takes. Those of a smaller study are the first ones of a larger one:

    >>> import pandas as pd
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import RatingTask, make_study, ratings_to_traits, simulate_studies
    >>> walkers = make_walkers(40, duration=4, frame_rate=60, random_state=0)
    >>> happy = walkers.target["happy"]
    >>> study = make_study(RatingTask(("sad", "happy")), walks=walkers.data, n_participants=12, random_state=0)
    >>> def correlation(answers):
    ...     return ratings_to_traits(answers, walks=walkers.data)["happy"].corr(happy)
    >>> found = {
    ...     n: simulate_studies(study, correlation, n_sets=5, participants=range(1, n + 1), truth=happy, random_state=0)
    ...     for n in (1, 3, 12)
    ... }
    >>> {n: round(float(table["value"].median()), 2) for n, table in found.items()}
    {1: 0.75, 3: 0.91, 12: 0.97}
    """
    n_sets = check_count(n_sets, "n_sets", at_least=1)
    seeds = check_random_state(random_state).randint(2**31 - 1, size=n_sets)

    def simulate(seed: int) -> Any:
        return analyze(simulate_answers(study, random_state=seed, **observers))

    found = Parallel(n_jobs=n_jobs)(delayed(simulate)(int(seed)) for seed in seeds)
    named = [one if isinstance(one, (Mapping, pd.Series)) else {"value": one} for one in found]
    return pd.DataFrame([dict(one) for one in named], index=pd.RangeIndex(1, n_sets + 1, name="set"))
