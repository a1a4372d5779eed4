"""Walks to look at, and what the statistics found in them."""

from eigenwalker.display.axis_display import AxisDisplay
from eigenwalker.display.body import project
from eigenwalker.display.conditions import make_display
from eigenwalker.display.curve_display import CurveDisplay
from eigenwalker.display.decomposition_display import DecompositionDisplay
from eigenwalker.display.deviation_display import DeviationDisplay
from eigenwalker.display.movie import draw_frames, write_movie
from eigenwalker.display.movie_table import write_movies
from eigenwalker.display.permutation_display import PermutationDisplay
from eigenwalker.display.plotting import StickFigureDisplay
from eigenwalker.display.pose_display import PoseDisplay
from eigenwalker.display.report import AxisReport, axis_report
from eigenwalker.display.scree_display import ScreeDisplay
from eigenwalker.display.screen import Screen
from eigenwalker.display.spectrum_display import SpectrumDisplay
from eigenwalker.display.stimuli import PointLightDisplay
from eigenwalker.display.trajectory_display import TrajectoryDisplay
from eigenwalker.display.walker_view import WalkerView, view

__all__ = [
    "AxisDisplay",
    "AxisReport",
    "CurveDisplay",
    "DecompositionDisplay",
    "DeviationDisplay",
    "PermutationDisplay",
    "PointLightDisplay",
    "PoseDisplay",
    "ScreeDisplay",
    "Screen",
    "SpectrumDisplay",
    "StickFigureDisplay",
    "TrajectoryDisplay",
    "WalkerView",
    "axis_report",
    "draw_frames",
    "make_display",
    "project",
    "view",
    "write_movie",
    "write_movies",
]
