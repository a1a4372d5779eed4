"""How well people recognize styles (Tilmanne, Moinet & Dutoit 2012, 6.3)."""

from dataclasses import dataclass
from typing import Any

import pandas as pd

from eigenwalker.display.confusion_display import ConfusionDisplay
from eigenwalker.display.estimate_display import EstimateDisplay
from eigenwalker.experiment.analysis.kind_differences import kind_differences
from eigenwalker.experiment.analysis.part_tables import stack_parts
from eigenwalker.experiment.analysis.rates import Estimated
from eigenwalker.experiment.analysis.recognition import (
    check_trials,
    confusion_tables,
    rate_correlation,
    recognition_table,
    style_rates,
)
from eigenwalker.experiment.analysis.report_text import (
    estimate_cell,
    interval_words,
    percent_cell,
    report_text,
    text_table,
)
from eigenwalker.experiment.analysis.trials import TaskTrials, split_trials, trials_of
from eigenwalker.experiment.stimulus import AVERAGE, KINDS
from eigenwalker.experiment.tasks import DONT_KNOW, RecognitionTask

__all__ = ["RecognitionReport", "recognition_report"]

_ENDS = ["rate", "low", "high"]


@dataclass(frozen=True, eq=False, repr=False)
class RecognitionReport:
    """How often styles were recognized, and what they were taken for; ``print(report)`` shows it.

    Parameters
    ----------
    trials : TaskTrials
        The answers, and what was left out.
    rates : DataFrame
        Index: by, "all", "condition" or "style"; group, as "static" or "sad"; kind. Columns as of `recognition_table`:
        n_trials, n_right, rate, low, high, chance, efficiency (Eq. 16), efficiency_low, efficiency_high.
        ``rates.loc["condition"]`` is Table 3.
    differences : DataFrame
        Index: by, group. Columns: difference, of the rate of original walks less that of synthetic ones, low, high;
        only where both kinds were shown. The average walk, which has no original, counts among the synthetic ones.
    correlation : Estimated
        Of the rates of both kinds over the styles, see `rate_correlation`; NaN where fewer than two styles were shown
        in both kinds.
    confusions : dict of str to DataFrame
        What each style was taken for, one table of shares a kind, see `confusion_tables` (Table 2); the average walk
        is the last style, and "don't know" the last answer.
    n_choices : int
        How many answers could be chosen from.
    level : float
        Of confidence, of the intervals.
    """

    trials: TaskTrials
    rates: pd.DataFrame
    differences: pd.DataFrame
    correlation: Estimated
    confusions: dict[str, pd.DataFrame]
    n_choices: int
    level: float

    def plot_rates(self, **options: Any) -> EstimateDisplay:
        """Draw the rates of styles in percent (Fig. 6), with chance; options of `EstimateDisplay.from_frame`."""
        table = 100 * self.rates.loc["style", _ENDS].rename(columns={"rate": "value"})
        drawn: dict[str, Any] = {
            "reference": 100 / self.n_choices,
            "reference_name": f"chance, 1 of {self.n_choices}",
            "xlabel": "recognition rate (%)",
            "xlim": (0.0, 100.0),
        }
        return EstimateDisplay.from_frame(table, **(drawn | options))

    def plot_confusions(self, **options: Any) -> ConfusionDisplay:
        """Draw what each style was taken for (Table 2); options of `ConfusionDisplay.from_tables`."""
        return ConfusionDisplay.from_tables(self.confusions, **options)

    def __str__(self) -> str:
        """Return the report in plain text."""
        chance = (
            f"Chance is {100 / self.n_choices:.2f} %, one of {self.n_choices} answers; efficiency is rate over chance."
        )
        n_styles = int(style_rates(self.trials.table)[self._kinds()].notna().all(axis=1).sum())
        correlation = (
            f"Correlation of original and synthetic over {n_styles} styles: {estimate_cell(self.correlation)}."
        )
        return report_text(
            "Recognition: styles that were named rightly, in percent",
            f"{self.trials.in_words()}\n{chance}",
            text_table(self._rate_rows()),
            text_table(self._style_rows()),
            f"{correlation if len(self._kinds()) > 1 else ''}\n{interval_words(self.trials.table, self.level)}".strip(),
        )

    __repr__ = __str__

    def _kinds(self) -> list[str]:
        return [kind for kind in KINDS if kind in self.confusions]

    def _rate_rows(self) -> dict[str, dict[str, str]]:
        """Return the rows of all walks and of conditions, and those of their differences."""
        rows = {}
        for (by, group, kind), row in self.rates.drop(index="style", level="by").iterrows():
            efficiency = estimate_cell(row[["efficiency", "efficiency_low", "efficiency_high"]])
            cells = {"answers": str(int(row["n_trials"])), "right": percent_cell(row[_ENDS]), "efficiency": efficiency}
            rows[f"{group}, {kind}"] = cells
            if kind == KINDS[1] and (by, group) in self.differences.index:
                rows[f"{group}, original less synthetic"] = {"right": percent_cell(self.differences.loc[(by, group)])}
        return rows

    def _style_rows(self) -> dict[str, dict[str, str]]:
        """Return rates of styles, and as what else they were seen most often."""
        rows: dict[str, dict[str, str]] = {}
        for (style, kind), row in self.rates.loc["style"].iterrows():
            others = self.confusions[kind].loc[style].drop(labels=style, errors="ignore")
            most = f"{others.idxmax()} {100 * others.max():.0f}" if others.max() > 0 else "-"
            rows.setdefault(style, {})
            rows[style] |= {kind: percent_cell(row[_ENDS]), f"{kind}, seen most as": most}
        return rows


def recognition_report(
    answers: pd.DataFrame, *, n_choices: int | None = None, level: float = 0.95
) -> RecognitionReport:
    """Return how often styles were recognized, with intervals, and what they were taken for.

    The paper's rates, 45.9 % of original and 38.93 % of synthetic walks in its text, 47.6 and 37.15 % in its Eq. 16,
    are of 922 answers about 46 walks by about 100 people; it gives no intervals. Those here know that answers of one
    participant are alike, and answers about one walk, see `crossed_interval`; those of single styles know participants
    alone. Without the columns participant and stimulus every answer stands for itself.

    Parameters
    ----------
    answers : DataFrame
        Answers of people, see `trials_of`; answers to other tasks are ignored. The style of walks of the average model
        is "average walk", and so is the right answer.
    n_choices : int, default None
        How many answers could be chosen from, by which chance is known: ``len(task.buttons)`` of a `RecognitionTask`
        with styles. None counts the styles that were asked about or answered, "average walk" and "I don't know": 13 in
        the paper.
    level : float, default 0.95
        Of confidence.

    Returns
    -------
    RecognitionReport

    Raises
    ------
    TypeError, ValueError
        If there are no such answers, kinds other than original and synthetic, or more answers than choices.

    Examples
    --------
    >>> said = ["sad", "sad", "cool", "don't know"] * 5
    >>> answers = pd.DataFrame({"task": "recognition", "style": "sad", "kind": "original", "answer": said})
    >>> report = recognition_report(answers, n_choices=13)
    >>> report.rates.loc["all", ["n_trials", "rate", "efficiency"]]
                        n_trials  rate  efficiency
    group     kind
    all walks original        20   0.5         6.5
    """
    trials = trials_of(answers, RecognitionTask.name)
    known = check_trials(trials.table)
    nameless = int((known["truth"].astype(str) == "").sum())
    if nameless:
        raise ValueError(f"expected answers about walks of known styles, {nameless} are about walks without one")
    occurring = {*_asked_styles(answers), *known["answer"], AVERAGE, DONT_KNOW}
    if n_choices is None:
        n_choices = len(occurring)
    n_given = known["answer"].nunique()
    if n_choices < n_given:
        raise ValueError(
            f"n_choices must be at least the {n_given} different answers that were given, got {n_choices!r}"
        )
    parts = split_trials(known)
    rates = {name: recognition_table(part, n_choices=n_choices, level=level) for name, part in parts.items()}
    return RecognitionReport(
        trials,
        stack_parts(rates),
        kind_differences(parts, level=level),
        _correlation(style_rates(known), level),
        _order_confusions(confusion_tables(known)),
        n_choices,
        level,
    )


def _asked_styles(answers: pd.DataFrame) -> set[str]:
    return set(answers.loc[answers["task"] == RecognitionTask.name, "style"].astype(str)) - {""}


def _correlation(rates: pd.DataFrame, level: float) -> Estimated:
    both = rates.reindex(columns=list(KINDS)).dropna()
    return rate_correlation(both, level=level) if len(both) > 1 else Estimated(*[float("nan")] * 3)


def _order_confusions(tables: dict[str, pd.DataFrame]) -> dict[str, pd.DataFrame]:
    """Return the tables with the average walk after the styles, and with "don't know" after all other answers."""

    def place(name: str) -> tuple[bool, bool]:
        return name == DONT_KNOW, name == AVERAGE

    return {
        kind: table.loc[sorted(table.index, key=place), sorted(table.columns, key=place)]
        for kind, table in tables.items()
    }
