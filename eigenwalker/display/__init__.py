"""Walks to look at, and what the statistics found in them."""

from eigenwalker.display.axis_display import AxisDisplay
from eigenwalker.display.body import project
from eigenwalker.display.curve_display import CurveDisplay
from eigenwalker.display.deviation_display import DeviationDisplay
from eigenwalker.display.permutation_display import PermutationDisplay
from eigenwalker.display.plotting import StickFigureDisplay
from eigenwalker.display.report import AxisReport, axis_report
from eigenwalker.display.scree_display import ScreeDisplay

__all__ = [
    "AxisDisplay",
    "AxisReport",
    "CurveDisplay",
    "DeviationDisplay",
    "PermutationDisplay",
    "ScreeDisplay",
    "StickFigureDisplay",
    "axis_report",
    "project",
]
