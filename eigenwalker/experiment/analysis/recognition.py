"""How often styles are recognized (Tilmanne, Moinet & Dutoit 2012, 6.2 and 6.3), whoever gave the answers.

Trials are rows of a DataFrame: ``truth``, the style of a walk; ``answer``, what it was taken for, where anything that
is no style, such as "don't know", is a wrong answer; ``kind``, "original" or "synthetic"; and, where walks were shown
more than once, ``walk``, and where several people answered, ``participant``, by which answers are grouped. A walk and
its synthesis may have the same name there: then their answers are compared in pairs. The answers are those of people,
see `trials_of`, or of a classifier, see `judge_styles`.
"""

import numpy as np
import pandas as pd

from eigenwalker.experiment.analysis.crossed import crossed_difference, crossed_rate, groupings
from eigenwalker.experiment.analysis.rates import Estimated
from eigenwalker.experiment.stimulus import KINDS
from eigenwalker.model.intervals import score_interval

__all__ = [
    "answer_shares",
    "check_trials",
    "confusion_tables",
    "rate_correlation",
    "recognition_difference",
    "recognition_table",
    "style_rates",
]


def check_trials(trials: pd.DataFrame) -> pd.DataFrame:
    """Return the trials with a column ``right``.

    Raises
    ------
    TypeError
        If it is no DataFrame.
    ValueError
        If a column is missing, there are no trials, a value is missing, or there are other kinds.
    """
    if not isinstance(trials, pd.DataFrame):
        raise TypeError(f"expected trials as a DataFrame, got {type(trials).__name__}")
    needed = ("truth", "answer", "kind")
    lacking = [name for name in needed if name not in trials.columns]
    if lacking:
        raise ValueError(f"expected the columns {', '.join(needed)}, missing: {', '.join(lacking)}")
    if not len(trials):
        raise ValueError("expected at least one trial, got none")
    gaps = [name for name in (*needed, "walk", "participant") if name in trials and trials[name].isna().any()]
    if gaps:
        raise ValueError(
            f"expected a value in every trial, but some are missing in: {', '.join(gaps)}; an answer that was not "
            'given is one, call it "don\'t know"'
        )
    foreign = sorted(set(trials["kind"]) - set(KINDS))
    if foreign:
        named = ", ".join(str(kind) or "an empty one" for kind in foreign)
        raise ValueError(f"expected the kinds {' and '.join(KINDS)}, got {named}")
    return trials.assign(right=trials["truth"].astype(str) == trials["answer"].astype(str))


def recognition_table(trials: pd.DataFrame, *, n_choices: int | None = None, level: float = 0.95) -> pd.DataFrame:
    r"""Return how often each kind of walk is recognized, and how much more often than by chance.

    .. math:: \eta = \frac{\text{achieved sensitivity}}{\text{sensitivity expected by chance}}

    (Eq. 16.) The paper gives the recognition rates as 45.9 % of original and 38.93 % of synthetic walks in its text,
    but puts 47.6 and 37.15 % into this formula; 13 answers could be chosen from, 7.69 % by chance. From the formula's
    rates the efficiencies are 6.19 and 4.83, as printed; from those of the text 5.97 and 5.06.

    Parameters
    ----------
    trials : DataFrame
        With the columns truth, answer, kind and maybe walk and participant.
    n_choices : int, default None
        How many answers could be chosen from. None counts those that occur, in truth or answer.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    DataFrame
        One row a kind: n_trials, n_right, rate, low and high (see `crossed_rate`), chance, efficiency,
        efficiency_low and efficiency_high.

    Raises
    ------
    TypeError, ValueError
        If the trials are not as they should be, or n_choices is less than 1.

    References
    ----------
    Tilmanne, Moinet & Dutoit 2012, 6.3; Bernhardt & Robinson 2007.

    Examples
    --------
    >>> trials = pd.DataFrame({"truth": ["sad"] * 4, "answer": ["sad", "sad", "sad", "cool"], "kind": "original"})
    >>> recognition_table(trials, n_choices=13)[["n_trials", "rate", "efficiency"]].round(2)
              n_trials  rate  efficiency
    kind
    original         4  0.75        9.75
    """
    known = check_trials(trials)
    if n_choices is None:
        n_choices = len(set(known["truth"].astype(str)) | set(known["answer"].astype(str)))
    if n_choices < 1:
        raise ValueError(f"n_choices must be 1 or more, got {n_choices!r}")
    rows = {kind: _recognition(part, 1 / n_choices, level) for kind, part in known.groupby("kind")}
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("kind")


def _recognition(part: pd.DataFrame, chance: float, level: float) -> dict[str, float]:
    found = crossed_rate(part["right"], groupings(part), level=level)
    return {
        "n_trials": len(part),
        "n_right": int(part["right"].sum()),
        "rate": found.value,
        "low": found.low,
        "high": found.high,
        "chance": chance,
        "efficiency": found.value / chance,
        "efficiency_low": found.low / chance,
        "efficiency_high": found.high / chance,
    }


def recognition_difference(trials: pd.DataFrame, *, level: float = 0.95) -> Estimated:
    """Return how much more often synthetic walks are recognized than original ones, less than 0 if they are not.

    Parameters
    ----------
    trials : DataFrame
        Of both kinds, see `recognition_table`.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    Estimated
        See `crossed_difference`.

    Raises
    ------
    TypeError, ValueError
        If the trials are not as they should be, or one kind is missing.
    """
    known = _both_kinds(trials)
    parts = [known[known["kind"] == kind] for kind in KINDS]
    return crossed_difference(*[part["right"] for part in parts], *map(groupings, parts), level=level)


def style_rates(trials: pd.DataFrame) -> pd.DataFrame:
    """Return how often each style is recognized: one row a style, one column a kind.

    Parameters
    ----------
    trials : DataFrame
        See `recognition_table`.

    Returns
    -------
    DataFrame
        NaN where a style was not shown in a kind.
    """
    known = check_trials(trials)
    return known.pivot_table(index="truth", columns="kind", values="right", aggfunc="mean").astype(float)


def rate_correlation(rates: pd.DataFrame, *, level: float = 0.95) -> Estimated:
    """Return Pearson's correlation of the rates of original and synthetic walks over the styles.

    The interval is from Fisher's transformation. The paper prints 0.8849 for 11 styles: from 0.61 to 0.97.

    Parameters
    ----------
    rates : DataFrame
        From `style_rates`; styles that lack a kind are left out.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    Estimated
        NaN where the rates of one kind are all the same; three styles or fewer leave the interval open.

    Raises
    ------
    ValueError
        If a kind is missing, or there are fewer than two styles.

    Examples
    --------
    >>> rates = pd.DataFrame({"original": [0.2, 0.4, 0.6, 0.9], "synthetic": [0.1, 0.5, 0.4, 0.8]})
    >>> [round(part, 2) for part in rate_correlation(rates)]
    [0.91, -0.41, 1.0]
    """
    lacking = [kind for kind in KINDS if kind not in rates.columns]
    if lacking:
        raise ValueError(f"expected the rates of both kinds, {' and '.join(KINDS)}, missing: {', '.join(lacking)}")
    pairs = rates[list(KINDS)].dropna().to_numpy(dtype=np.float64)
    if len(pairs) < 2:
        raise ValueError(f"expected two styles or more with rates of both kinds, got {len(pairs)}")
    if (np.ptp(pairs, axis=0) == 0).any():
        return Estimated(*[float("nan")] * 3)
    value = float(np.corrcoef(pairs.T)[0, 1])
    return Estimated(value, *score_interval(pairs[:, 0], pairs[:, 1], "r", level=level))


def confusion_tables(trials: pd.DataFrame, *, normalize: bool = True) -> dict[str, pd.DataFrame]:
    """Return what each style is taken for (Table 2), one table a kind.

    Parameters
    ----------
    trials : DataFrame
        See `recognition_table`.
    normalize : bool, default True
        Whether rows are shares of the trials of the style; else numbers of answers.

    Returns
    -------
    dict of str to DataFrame
        Rows are styles, columns answers: styles first, in the same order, then what else was answered. All kinds have
        the same rows and columns; NaN where a style was not shown.

    Examples
    --------
    >>> trials = pd.DataFrame(
    ...     {"truth": ["cool", "sad"], "answer": ["sad", "don't know"], "kind": ["original", "original"]}
    ... )
    >>> confusion_tables(trials, normalize=False)["original"]
    answer  cool  sad  don't know
    truth
    cool       0    1           0
    sad        0    0           1
    """
    known = check_trials(trials)
    styles = sorted(set(known["truth"]))
    answers = [*styles, *sorted(set(known["answer"]) - set(styles))]
    tables = {}
    for kind, part in known.groupby("kind"):
        counts = pd.crosstab(part["truth"], part["answer"]).reindex(index=styles, columns=answers, fill_value=0)
        tables[str(kind)] = counts.div(counts.sum(axis=1).replace(0, np.nan), axis=0) if normalize else counts
    return tables


def answer_shares(trials: pd.DataFrame) -> pd.DataFrame:
    """Return how often each answer is given to walks of each kind, as in the test of naturalness (6.2, Fig. 5).

    There people said of single walks whether they are "real", "synthetic", or "I don't know": 65.45 % of the original
    and 50.39 % of the synthetic walks were taken for real ones.

    Parameters
    ----------
    trials : DataFrame
        With the columns kind and answer; the truth may be anything, the kind for instance.

    Returns
    -------
    DataFrame
        One row a kind, one column an answer; rows sum to 1.
    """
    known = check_trials(trials.assign(truth=trials.get("truth", trials.get("kind"))))
    return pd.crosstab(known["kind"], known["answer"], normalize="index")


def _both_kinds(trials: pd.DataFrame) -> pd.DataFrame:
    known = check_trials(trials)
    lacking = [kind for kind in KINDS if kind not in set(known["kind"])]
    if lacking:
        raise ValueError(f"expected trials with both kinds of walks, there are none with {lacking[0]} ones")
    return known
