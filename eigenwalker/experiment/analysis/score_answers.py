"""Scores that people give to walks beside their originals.

How natural they are (Tilmanne & Dutoit 2012, section 3), and how much they resemble them (Tilmanne, Moinet & Dutoit
2012, 6.4).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from eigenwalker.display.estimate_display import EstimateDisplay
from eigenwalker.display.score_display import ScoreDisplay
from eigenwalker.display.share_display import ShareDisplay
from eigenwalker.experiment.analysis.crossed import crossed_mean, groupings
from eigenwalker.experiment.analysis.means import mean_interval
from eigenwalker.experiment.analysis.part_tables import rows_of_parts, stack_parts
from eigenwalker.experiment.analysis.rates import Estimated
from eigenwalker.experiment.analysis.report_text import (
    estimate_cell,
    interval_words,
    percent_cell,
    report_text,
    text_table,
)
from eigenwalker.experiment.analysis.shares import share_table
from eigenwalker.experiment.analysis.trials import TaskTrials, split_trials, trials_of
from eigenwalker.experiment.tasks import RESEMBLANCE, PairTask, ResemblanceTask

__all__ = ["ScoreReport", "mean_resemblance", "pair_report", "resemblance_report"]

_SCALE = tuple(PairTask().scale)
_MEAN_COLUMNS = ("n_answers", "mean", "low", "high", "sd")


@dataclass(frozen=True, eq=False, repr=False)
class ScoreReport:
    """Scores of walks beside their originals; ``print(report)`` shows it.

    Parameters
    ----------
    trials : TaskTrials
        The answers, and what was left out.
    means : DataFrame
        Index: by, "all", "condition" or "style"; group, as "static" or "sad". Columns: n_answers, mean, low, high, and
        sd, the standard deviation of answers.
    shares : DataFrame
        Index: by, group, answer. Columns: score, n_trials, n_answers, share, low, high.
    scale : tuple of str
        The words of the scores 0, 1, ...; "" where one has none.
    title : str
        What was scored.
    level : float
        Of confidence, of the intervals.
    """

    trials: TaskTrials
    means: pd.DataFrame
    shares: pd.DataFrame
    scale: tuple[str, ...]
    title: str
    level: float

    def plot_scores(self, **options: Any) -> ScoreDisplay:
        """Draw the distribution of each style's scores, and their means (Fig. 4); see `ScoreDisplay.from_frames`."""
        means = self._style_means()
        shares = self.shares.loc["style"].reset_index().pivot(index="group", columns="score", values="share")
        return ScoreDisplay.from_frames(shares, means, **({"xlabel": self._in_words("score")} | options))

    def plot_means(self, **options: Any) -> EstimateDisplay:
        """Draw the mean score of each style, and the overall mean (Fig. 5); options of `EstimateDisplay.from_frame`."""
        mean, low, high = self.means.loc[("all", "all walks"), ["mean", "low", "high"]]
        drawn: dict[str, Any] = {
            "reference": (mean, low, high),
            "reference_name": f"overall mean, {estimate_cell((mean, low, high))}",
            "xlabel": self._in_words("mean score"),
            "xlim": (0.0, len(self.scale) - 1.0),
        }
        return EstimateDisplay.from_frame(self._style_means(), **(drawn | options))

    def plot_shares(self, **options: Any) -> ShareDisplay:
        """Draw how often each score was given (Fig. 8 of the other paper); options of `ShareDisplay.from_frame`."""
        table = self.shares.loc[("all", "all walks")]
        return ShareDisplay.from_frame(table, **({"xlabel": self._in_words("score")} | options))

    def __str__(self) -> str:
        """Return the report in plain text."""
        rows = {}
        for name, row in self.means.iterrows():
            shares = self.shares.loc[name].set_index("score")["share"]
            cells = {"answers": str(int(row["n_answers"])), "mean": estimate_cell(row[["mean", "low", "high"]])}
            rows[str(name[1])] = cells | {f"{score} (%)": f"{100 * share:.0f}" for score, share in shares.items()}
        counts = {
            str(answer): {"answers": str(int(row["n_answers"])), "%": percent_cell(row[["share", "low", "high"]])}
            for answer, row in self.shares.loc[("all", "all walks")].iterrows()
        }
        return report_text(
            f"{self.title}: {self._in_words('scores')}",
            self.trials.in_words(),
            text_table(rows),
            text_table(counts),
            interval_words(self.trials.table, self.level),
        )

    __repr__ = __str__

    def _in_words(self, name: str) -> str:
        least, most = (f" ({word})" if word else "" for word in (self.scale[0], self.scale[-1]))
        return f"{name}, 0{least} to {len(self.scale) - 1}{most}"

    def _style_means(self) -> pd.DataFrame:
        if "style" not in self.means.index:
            raise ValueError("expected answers about walks of known styles, none of the walks has one")
        return self.means.loc["style"].rename(columns={"mean": "value"})


def pair_report(answers: pd.DataFrame, *, scale: Sequence[str] = _SCALE, level: float = 0.95) -> ScoreReport:
    """Return how natural synthetic walks are beside their originals, of each style and overall.

    The paper's mean is 2.91, of 390 answers of 37 people about 21 pairs; styles range from 1.60 to 3.45, with intervals
    of 95 % that it does not explain. The intervals here are those of Student's t, and know that answers of one
    participant are alike, and answers about one walk, see `mean_interval` and `crossed_interval`; those of single
    styles know participants alone, of whom t has one degree of freedom less. Without the columns participant and
    stimulus every answer stands for itself.

    Parameters
    ----------
    answers : DataFrame
        Answers of people, see `trials_of`: "0", "1", ...; answers to other tasks are ignored.
    scale : sequence of str, default that of `PairTask`
        The words of the scores 0, 1, ...; "" where one has none.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    ScoreReport

    Raises
    ------
    TypeError, ValueError
        If there are no such answers, or other words.

    Examples
    --------
    >>> scores = {"manly": "4434", "drunk": "2112"}
    >>> answers = pd.DataFrame([(style, score) for style, row in scores.items() for score in row])
    >>> answers = answers.set_axis(["style", "answer"], axis=1).assign(task="pair", kind="synthetic")
    >>> pair_report(answers).means.round(2)
                     n_answers  mean   low  high    sd
    by    group
    all   all walks          8  2.62  1.54  3.71  1.30
    style drunk              4  1.50  0.58  2.42  0.58
          manly              4  3.75  2.95  4.00  0.50
    """
    words = tuple(map(str, range(len(scale))))
    return _score_report(answers, PairTask.name, words, scale, "Naturalness beside the original", level)


def resemblance_report(answers: pd.DataFrame, *, level: float = 0.95) -> ScoreReport:
    """Return how much synthetic walks resemble their originals, of each style and overall.

    The paper's mean is 3.15, of 865 answers, most of them "identical". Intervals are as of `pair_report`.

    Parameters
    ----------
    answers : DataFrame
        Answers of people, see `trials_of`: each one of RESEMBLANCE; answers to other tasks are ignored.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    ScoreReport

    Raises
    ------
    TypeError, ValueError
        If there are no such answers, or other words.

    Examples
    --------
    >>> said = ["identical"] * 3 + ["different"]
    >>> answers = pd.DataFrame({"task": "resemblance", "style": "sad", "kind": "synthetic", "answer": said})
    >>> resemblance_report(answers).shares.loc[("all", "all walks"), ["score", "n_answers"]]
                        score  n_answers
    answer
    nothing in common       0          0
    very different          1          0
    different               2          1
    slightly different      3          0
    identical               4          3
    """
    return _score_report(answers, ResemblanceTask.name, RESEMBLANCE, RESEMBLANCE, "Resemblance to the original", level)


def mean_resemblance(answers: Iterable[str], *, level: float = 0.95) -> Estimated:
    """Return the mean worth of answers, from 0, nothing in common, to 4, identical.

    The paper's is 3.15 in 865 comparisons.

    Parameters
    ----------
    answers : iterable of str
        Each one of RESEMBLANCE.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    Estimated
        With the interval of Student's t, within 0 and 4; a single answer leaves it open. Every answer stands for
        itself: `resemblance_report` knows whose they are.

    Raises
    ------
    ValueError
        If there are no answers, or others.

    Examples
    --------
    >>> [round(part, 2) for part in mean_resemblance(["identical", "slightly different", "identical", "different"])]
    [3.25, 1.73, 4.0]
    """
    given = list(answers)
    foreign = sorted({str(answer) for answer in given if answer not in RESEMBLANCE})
    if foreign or not given:
        raise ValueError(f"expected answers out of {', '.join(RESEMBLANCE)}, got {', '.join(foreign) or 'none at all'}")
    mean, low, high = mean_interval([RESEMBLANCE.index(answer) for answer in given], level=level)
    return Estimated(mean, max(0.0, low), min(len(RESEMBLANCE) - 1.0, high))


def _score_report(
    answers: pd.DataFrame, task: str, words: Sequence[str], scale: Sequence[str], title: str, level: float
) -> ScoreReport:
    """Return the report on answers that are worth 0, 1, ... in the order of their words."""
    trials = trials_of(answers, task)
    worth = {word: score for score, word in enumerate(words)}
    parts, means, shares = split_trials(trials.table), {}, {}
    for name, part in parts.items():
        table = share_table(part, words, level=level)
        table.insert(0, "score", range(len(words)))
        shares[name] = table
        scores = part["answer"].map(worth).to_numpy(dtype=np.float64)
        found = crossed_mean(scores, groupings(part), within=(0.0, len(words) - 1.0), level=level)
        spread = float(scores.std(ddof=1)) if len(scores) > 1 else float("nan")
        means[name] = {"n_answers": len(part), "mean": found.value, "low": found.low, "high": found.high, "sd": spread}
    return ScoreReport(
        trials,
        rows_of_parts(means, _MEAN_COLUMNS),
        stack_parts(shares),
        tuple(scale),
        title,
        level,
    )
