"""Shares of the answers that could be given, each with its interval."""

from collections.abc import Sequence

import pandas as pd

from eigenwalker.experiment.analysis.crossed import crossed_rate, groupings

__all__ = ["share_table"]


def share_table(trials: pd.DataFrame, words: Sequence[str], *, level: float = 0.95) -> pd.DataFrame:
    """Return how often each answer was given.

    Parameters
    ----------
    trials : DataFrame
        With the column answer, and maybe participant and walk, see `crossed_rate`.
    words : sequence of str
        The answers that could be given.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    DataFrame
        One row an answer, those that nobody gave as well: n_trials, of all answers; n_answers, so many were this one;
        share, low and high.

    Raises
    ------
    ValueError
        If there are no trials, or other answers.

    Examples
    --------
    >>> trials = pd.DataFrame({"answer": ["real"] * 161 + ["synthetic"] * 79 + ["don't know"] * 6})
    >>> share_table(trials, ("real", "synthetic", "don't know")).round(4)
                n_trials  n_answers   share     low    high
    answer
    real             246        161  0.6545  0.5931  0.7111
    synthetic        246         79  0.3211  0.2659  0.3819
    don't know       246          6  0.0244  0.0112  0.0522
    """
    foreign = sorted(set(trials["answer"]) - set(words))
    if foreign or not len(trials):
        raise ValueError(f"expected answers out of {', '.join(words)}, got {', '.join(foreign) or 'none at all'}")
    rows = {}
    for word in words:
        given = trials["answer"] == word
        share, low, high = crossed_rate(given, groupings(trials), level=level)
        rows[word] = {
            "n_trials": len(trials),
            "n_answers": int(given.sum()),
            "share": share,
            "low": low,
            "high": high,
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("answer")
