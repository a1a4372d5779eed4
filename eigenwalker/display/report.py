"""The report on trait axes: what they are, whether to believe them, and what speaks against it."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from sklearn.pipeline import Pipeline

from eigenwalker._validation import check_choice
from eigenwalker.display.axis_display import AxisDisplay
from eigenwalker.display.curve_display import CurveDisplay
from eigenwalker.display.permutation_display import PermutationDisplay
from eigenwalker.display.scree_display import ScreeDisplay
from eigenwalker.model.blocks import PARTS
from eigenwalker.model.eigenwalkers import trait_axes
from eigenwalker.model.statistics import AxisStatistics, axis_statistics
from eigenwalker.motion.walk import JointWalk, Walk

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["AxisReport", "axis_report"]

_SCORES = {"auc": "area under the curve", "r": "correlation"}


def axis_report(
    model: Pipeline,
    walks: Sequence[Walk | JointWalk],
    y: ArrayLike,
    *,
    groups: ArrayLike | None = None,
    control: ArrayLike | None = None,
    sources: ArrayLike | None = None,
    **options: Any,
) -> AxisReport:
    """Return a report on the trait axes that a model finds in walks.

    Parameters
    ----------
    model : Pipeline
        From `make_eigenwalkers`; it need not be fitted.
    walks : list of Walk or JointWalk
        What the model is for.
    y : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_traits)
        Labels.
    groups : array-like of shape (n_walks,), default None
        Which person each walk is of.
    control : DataFrame, Series or array-like of shape (n_walks,) or (n_walks, n_controls), default None
        What no axis may go along with.
    sources : array-like of shape (n_walks,), default None
        In which session, place or data set each walk was recorded.
    **options : Any
        Of `axis_statistics`, as is what the arguments mean: n_harmonics, level, n_permutations, n_resamples,
        random_state, n_jobs.

    Returns
    -------
    AxisReport
        It shows itself in a notebook; ``save("report.html")`` writes a page, ``to_frame()`` gives the numbers.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import axis_report
    >>> from eigenwalker.model import make_eigenwalkers
    >>> walkers = make_walkers(40, random_state=0)
    >>> options = {"n_harmonics": [2], "n_permutations": 99, "n_resamples": 20, "random_state": 0}
    >>> report = axis_report(make_eigenwalkers(n_components=8), walkers.data, walkers.target["gender"], **options)
    >>> report.to_frame()[["n_persons", "p"]]
            n_persons     p
    trait
    gender         40  0.01
    """
    return AxisReport(axis_statistics(model, walks, y, groups=groups, control=control, sources=sources, **options))


@dataclass(frozen=True, eq=False)
class AxisReport:
    """Trait axes with what is known about them, as a table, in words and in pictures.

    Parameters
    ----------
    statistics : AxisStatistics
        From `axis_statistics`.
    """

    statistics: AxisStatistics

    @property
    def faults(self) -> tuple[str, ...]:
        """What speaks against an axis."""
        return self.statistics.faults

    @property
    def notes(self) -> tuple[str, ...]:
        """What should be said of any axis."""
        return self.statistics.notes

    def to_frame(self) -> pd.DataFrame:
        """Return the numbers, one row a trait: the summary, and shares and scores of structure and dynamics."""
        parts = self.statistics.parts[["share", "alone"]].unstack("part")
        parts = parts.set_axis([f"{part}_{what}" for what, part in parts.columns], axis=1)
        parts = parts[[f"{part}_{what}" for part in PARTS for what in ("share", "alone")]]
        return self.statistics.summary.join(parts)

    def plot_axis(self, trait: str, **options: Any) -> AxisDisplay:
        """Draw what an axis moves; options of `AxisDisplay.from_estimator`."""
        return AxisDisplay.from_estimator(self.statistics.model, self._name(trait), **options)

    def plot_permutations(self, trait: str, **options: Any) -> PermutationDisplay:
        """Draw the scores of shuffled labels; options of `PermutationDisplay.from_result`."""
        score = _SCORES[self.statistics.summary.loc[self._name(trait), "score"]]
        result = self.statistics.permutations[trait]
        return PermutationDisplay.from_result(result, score_name=f"{trait}: {score}", **options)

    def plot_components(self, **options: Any) -> CurveDisplay:
        """Draw scores against the number of Eigenwalkers; options of `CurveDisplay.from_frame`."""
        chosen = self.statistics.settings["n_components"]
        return CurveDisplay.from_frame(self.statistics.components, chosen=chosen, ylabel=self._score_words(), **options)

    def plot_harmonics(self, **options: Any) -> CurveDisplay:
        """Draw scores against the number of harmonics; options of `CurveDisplay.from_frame`."""
        curve, chosen = self.statistics.harmonics, self.statistics.settings["n_harmonics"]
        return CurveDisplay.from_frame(
            curve,
            chosen=chosen if chosen in curve.index else None,
            xlabel="number of harmonics",
            ylabel=self._score_words(),
            **options,
        )

    def plot_scree(self, **options: Any) -> ScreeDisplay:
        """Draw the shares of the Eigenwalkers in the variance; options of `ScreeDisplay.from_estimator`."""
        return ScreeDisplay.from_estimator(self.statistics.model, **options)

    def save(self, path: str | Path) -> None:
        """Write the report as one HTML page that needs no other file.

        Parameters
        ----------
        path : str or Path
            Where to.
        """
        page = (
            '<!DOCTYPE html>\n<html lang="en">\n<head><meta charset="utf-8">'
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>{escape(self._title())}</title></head>\n<body>\n{self._repr_html_()}</body>\n</html>\n"
        )
        Path(path).write_text(page, encoding="utf-8")

    def _name(self, trait: str) -> str:
        check_choice(trait, list(self.statistics.summary.index), name="trait")
        return trait

    def _score_words(self) -> str:
        return " or ".join(_SCORES[score] for score in self.statistics.summary["score"].unique())

    def _title(self) -> str:
        return f"Trait axes: {', '.join(self.statistics.summary.index)}"

    def __str__(self) -> str:
        """Return the report in plain text."""
        lines = [self._title(), self._settings(), *map(self._in_words, self.statistics.summary.index)]
        lines += [f"Warning: {fault}" for fault in self.faults]
        return "\n".join([*lines, *self.notes])

    def _settings(self) -> str:
        settings, summary = self.statistics.settings, self.statistics.summary
        controlled = f", controlled for {', '.join(settings['control'])}" if settings["control"] else ""
        return (
            f"{summary['n_walks'].max()} walks of {summary['n_persons'].max()} persons; {settings['n_harmonics']} "
            f"harmonics, {settings['n_components']} components, scaling {settings['scaling']}{controlled}; intervals "
            f"of {settings['level']:.0%}, {settings['n_permutations']} shuffles, {settings['n_resamples']} resamples"
        )

    def _in_words(self, trait: str) -> str:
        """Return unit, sign, poles and worth of an axis in a sentence or two."""
        row = self.statistics.summary.loc[trait]
        unit = {"sd": "one SD over persons", "label": "one unit of the label", "coefficient": "one filter c"}
        labels = "" if self.statistics.settings["alpha_unit"] == "label" else f", {row['unit']:.3g} units of the label"
        score = _interval(row["left_out"], row["left_out_low"], row["left_out_high"])
        return (
            f"{trait}: minus is {row['negative']}, plus is {row['positive']}; alpha = 1 is "
            f"{unit[self.statistics.settings['alpha_unit']]}{labels}. "
            f"{_SCORES[row['score']].capitalize()} of {row['n_persons']} persons left out: {score}, "
            f"{_p_value(row['p'], self.statistics.settings['n_permutations'])}; nested "
            f"{_interval(row['nested'], row['nested_low'], row['nested_high'])}."
        )

    def _repr_html_(self) -> str:
        """Show the report in a notebook."""
        folder, traits = files("eigenwalker.display") / "report_page", list(self.statistics.summary.index)
        faults = f'<div class="faults"><h2>Warnings</h2><ul>{_items(self.faults)}</ul></div>' if self.faults else ""
        several = len(traits) > 1
        return Template((folder / "report.html").read_text(encoding="utf-8")).substitute(
            style=(folder / "report.css").read_text(encoding="utf-8"),
            title=escape(self._title()),
            settings=escape(self._settings()),
            faults=faults,
            scores=_table(self._score_rows()),
            axes=_items(map(self._in_words, traits)),
            bodies=self._bodies(traits),
            parts=_table(self._part_rows()),
            cosines=f"<h2>Cosines between axes</h2>\n{_table(self._cosine_rows())}" if several else "",
            curves=_picture(self.plot_components().figure_, "score against number of components")
            + _picture(self.plot_harmonics().figure_, "score against number of harmonics"),
            permutations="".join(
                _picture(self.plot_permutations(trait).figure_, f"scores of shuffled labels of {trait}")
                for trait in traits
            ),
            scree=_picture(self.plot_scree().figure_, "share of each Eigenwalker in the variance"),
            notes=_items(self.notes),
        )

    def _bodies(self, traits: Sequence[str]) -> str:
        if isinstance(self.statistics.model[0].template_, JointWalk):
            return "<p>Axes of joint angles are not drawn on the body.</p>"
        alphas = {trait: self._two_sds(trait) for trait in traits}
        return "".join(
            _picture(self.plot_axis(trait, alpha=alpha).figure_, f"what the axis of {trait} moves")
            for trait, alpha in alphas.items()
        )

    def _two_sds(self, trait: str) -> float:
        """Return how much alpha two SDs over persons are, whatever its unit."""
        axes, unit = trait_axes(self.statistics.model), self.statistics.summary.loc[trait, "unit"]
        return float(f"{2 * axes.alpha_sd_[axes.trait_names_.index(trait)] / unit:.3g}")

    def _score_rows(self) -> pd.DataFrame:
        summary, n_permutations = self.statistics.summary, self.statistics.settings["n_permutations"]
        rows = {
            trait: {
                "persons": f"{row['n_persons']}",
                "score": _SCORES[row["score"]],
                "left out": _cell(row["left_out"], row["left_out_low"], row["left_out_high"]),
                "nested": _cell(row["nested"], row["nested_low"], row["nested_high"]),
                "p": _p_value(row["p"], n_permutations).removeprefix("p = "),
                "balanced accuracy": _cell(row["accuracy"], row["accuracy_low"], row["accuracy_high"]),
                "tempo": _number(row["tempo"]),
                "stability": f"{_number(row['stability'])}<small>{_number(row['stability_low'])}</small>",
            }
            for trait, row in summary.iterrows()
        }
        return pd.DataFrame.from_dict(rows, orient="index")

    def _part_rows(self) -> pd.DataFrame:
        rows = {
            trait: {
                f"{part}: {what}": text
                for part, row in table.droplevel("trait").iterrows()
                for what, text in (
                    ("share", f"{row['share']:.0%}"),
                    ("alone", _cell(row["alone"], row["alone_low"], row["alone_high"])),
                )
            }
            for trait, table in self.statistics.parts.groupby("trait", sort=False)
        }
        return pd.DataFrame.from_dict(rows, orient="index")

    def _cosine_rows(self) -> pd.DataFrame:
        return self.statistics.cosines.map(_number)


def _number(value: float) -> str:
    return "–" if np.isnan(value) else f"{value:.2f}".replace("-", "−")


def _interval(value: float, low: float, high: float) -> str:
    return f"{_number(value)} [{_number(low)}, {_number(high)}]"


def _cell(value: float, low: float, high: float) -> str:
    return _number(value) if np.isnan(low) else f"{_number(value)}<small>{_number(low)} to {_number(high)}</small>"


def _p_value(value: float, n_permutations: int) -> str:
    digits = len(str(n_permutations))  # the smallest p, 1 / (1 + n_permutations), has no fewer
    return f"p = {value:.{digits}f}"


def _items(texts: Iterable[str]) -> str:
    return "\n".join(f"<li>{escape(text)}</li>" for text in texts)


def _table(cells: pd.DataFrame) -> str:
    """Return an HTML table; its cells are HTML, its names are not."""
    head = "".join(f"<th>{escape(str(name))}</th>" for name in cells.columns)
    body = "".join(
        f"<tr><th>{escape(str(name))}</th>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>"
        for name, row in zip(cells.index, cells.to_numpy(), strict=True)
    )
    return f"<table><thead><tr><th></th>{head}</tr></thead><tbody>{body}</tbody></table>"


def _picture(figure: Figure, text: str) -> str:
    """Return a figure as part of the page."""
    from matplotlib import rc_context

    drawing = BytesIO()
    with rc_context({"svg.hashsalt": "eigenwalker"}):  # the same page each time
        figure.savefig(drawing, format="svg", metadata={"Date": None})
    data = base64.b64encode(drawing.getvalue()).decode()
    return f'<figure><img alt="{escape(text)}" src="data:image/svg+xml;base64,{data}"></figure>\n'
