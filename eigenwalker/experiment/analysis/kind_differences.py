"""How much more often original walks are answered rightly than synthetic ones, over all and in parts."""

from collections.abc import Mapping

import pandas as pd

from eigenwalker.experiment.analysis.part_tables import rows_of_parts
from eigenwalker.experiment.analysis.recognition import recognition_difference
from eigenwalker.experiment.stimulus import KINDS

__all__ = ["kind_differences"]


def kind_differences(parts: Mapping[tuple[str, str], pd.DataFrame], *, level: float = 0.95) -> pd.DataFrame:
    """Return the share of right answers to original walks less that to synthetic ones, with its interval.

    Parameters
    ----------
    parts : mapping of (str, str) to DataFrame
        Trials by part, see `split_trials`: truth, answer, kind, and maybe walk and participant. Parts that lack a kind
        have no row.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    DataFrame
        One row a part: difference, low and high, see `crossed_difference`.

    Examples
    --------
    >>> said = ["real"] * 161 + ["synthetic"] * 85 + ["real"] * 128 + ["synthetic"] * 126
    >>> kinds = ["original"] * 246 + ["synthetic"] * 254
    >>> trials = pd.DataFrame({"truth": "real", "answer": said, "kind": kinds})
    >>> kind_differences({("all", "all walks"): trials}).round(3)
                   difference    low   high
    by  group
    all all walks       0.151  0.064  0.234
    """
    rows = {}
    for name, trials in parts.items():
        if set(KINDS) <= set(trials["kind"]):
            found = recognition_difference(trials, level=level)  # of synthetic walks, less original ones
            rows[name] = {"difference": 0.0 - found.value, "low": 0.0 - found.high, "high": 0.0 - found.low}
    return rows_of_parts(rows, ("difference", "low", "high")).astype(float)
