"""Whether people take walks for real ones (Tilmanne, Moinet & Dutoit 2012, 6.2)."""

from dataclasses import dataclass
from typing import Any

import pandas as pd

from eigenwalker.display.share_display import ShareDisplay
from eigenwalker.experiment.analysis.kind_differences import kind_differences
from eigenwalker.experiment.analysis.part_tables import PART_LEVELS, stack_parts
from eigenwalker.experiment.analysis.recognition import check_trials
from eigenwalker.experiment.analysis.report_text import interval_words, percent_cell, report_text, text_table
from eigenwalker.experiment.analysis.shares import share_table
from eigenwalker.experiment.analysis.trials import TaskTrials, split_trials, trials_of
from eigenwalker.experiment.stimulus import KINDS
from eigenwalker.experiment.tasks import NaturalnessTask

__all__ = ["NaturalnessReport", "naturalness_report"]

_WORDS = tuple(button.answer for button in NaturalnessTask().buttons)
_REAL = _WORDS[0]
_ENDS = ["share", "low", "high"]


@dataclass(frozen=True, eq=False, repr=False)
class NaturalnessReport:
    """How often walks were taken for real, or synthetic ones, or neither; ``print(report)`` shows it.

    Parameters
    ----------
    trials : TaskTrials
        The answers, and what was left out.
    shares : DataFrame
        Index: by, "all", "condition" or "style"; group, as "static" or "sad"; kind; answer. Columns: n_trials,
        n_answers, share, low, high. ``shares.loc["style"]`` is the table of styles.
    differences : DataFrame
        Index: by, group. Columns: difference, of the share of "real" answers to original walks less that to synthetic
        ones, low, high; only where both kinds were shown.
    level : float
        Of confidence, of the intervals.
    """

    trials: TaskTrials
    shares: pd.DataFrame
    differences: pd.DataFrame
    level: float

    def plot_shares(self, **options: Any) -> ShareDisplay:
        """Draw the shares of answers to both kinds (Fig. 5); options of `ShareDisplay.from_frame`."""
        return ShareDisplay.from_frame(self.shares.loc[("all", "all walks")], **options)

    def __str__(self) -> str:
        """Return the report in plain text."""
        rows: dict[str, dict[str, str]] = {}
        for (_, group, kind), part in self.shares.groupby(level=[*PART_LEVELS, "kind"], sort=False):
            row = {"answers": str(part["n_trials"].iloc[0])}
            row |= {word: percent_cell(part.loc[(*part.index[0][:3], word), _ENDS]) for word in _WORDS}
            rows[f"{group}, {kind}"] = row
        differences = {
            str(group): {"original less synthetic": percent_cell(found)}
            for (_, group), found in zip(self.differences.index, self.differences.to_numpy(), strict=True)
        }
        return report_text(
            "Naturalness: what walks were taken for, in percent",
            self.trials.in_words(),
            text_table(rows),
            f'Taken for "{_REAL}", in percentage points\n\n{text_table(differences)}' if differences else "",
            interval_words(self.trials.table, self.level),
        )

    __repr__ = __str__


def naturalness_report(answers: pd.DataFrame, *, level: float = 0.95) -> NaturalnessReport:
    """Return how often walks were taken for real ones, with intervals.

    People said of single walks whether they are "real", "synthetic", or "I don't know": 65.45 % of 246 original and
    50.39 % of 254 synthetic walks were taken for real ones, 2.44 and 6.69 % for neither.

    The paper gives no intervals. Those here know that answers of one participant are alike, and answers about one walk,
    see `crossed_interval`; those of single styles know participants alone. Without the columns participant and stimulus
    every answer stands for itself.

    Parameters
    ----------
    answers : DataFrame
        Answers of people, see `trials_of`; answers to other tasks are ignored.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    NaturalnessReport

    Raises
    ------
    TypeError, ValueError
        If there are no such answers, other words, or kinds other than original and synthetic.

    Examples
    --------
    >>> kinds, said = ["original"] * 246, ["real"] * 161 + ["synthetic"] * 79 + ["don't know"] * 6
    >>> answers = pd.DataFrame({"task": "naturalness", "style": "sad", "kind": kinds, "answer": said})
    >>> report = naturalness_report(answers)
    >>> report.shares.loc[("all", "all walks", "original"), ["share", "low", "high"]].round(4)
                 share     low    high
    answer
    real        0.6545  0.5931  0.7111
    synthetic   0.3211  0.2659  0.3819
    don't know  0.0244  0.0112  0.0522
    """
    trials = trials_of(answers, NaturalnessTask.name)
    parts = split_trials(check_trials(trials.table))
    shares = {
        (*name, kind): share_table(part[part["kind"] == kind], _WORDS, level=level)
        for name, part in parts.items()
        for kind in KINDS
        if (part["kind"] == kind).any()
    }
    return NaturalnessReport(
        trials,
        stack_parts(shares, [*PART_LEVELS, "kind"]),
        kind_differences({name: part.assign(truth=_REAL) for name, part in parts.items()}, level=level),
        level,
    )
