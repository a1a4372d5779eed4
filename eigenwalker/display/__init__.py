"""Walks to look at, and what the statistics found in them."""

from eigenwalker.display.axis_display import AxisDisplay
from eigenwalker.display.body import project
from eigenwalker.display.conditions import make_display
from eigenwalker.display.confusion_display import ConfusionDisplay
from eigenwalker.display.curve_display import CurveDisplay
from eigenwalker.display.decomposition_display import DecompositionDisplay
from eigenwalker.display.deviation_display import DeviationDisplay
from eigenwalker.display.estimate_display import EstimateDisplay
from eigenwalker.display.figure_movie import draw_figures, write_figure_movie
from eigenwalker.display.figures import FigureDisplay
from eigenwalker.display.movie import draw_frames, write_movie
from eigenwalker.display.movie_table import write_movies
from eigenwalker.display.permutation_display import PermutationDisplay
from eigenwalker.display.plotting import StickFigureDisplay
from eigenwalker.display.pose_display import PoseDisplay
from eigenwalker.display.ratings_display import RatingsDisplay
from eigenwalker.display.report import AxisReport, axis_report
from eigenwalker.display.score_display import ScoreDisplay
from eigenwalker.display.scree_display import ScreeDisplay
from eigenwalker.display.screen import Screen
from eigenwalker.display.share_display import ShareDisplay
from eigenwalker.display.spectrum_display import SpectrumDisplay
from eigenwalker.display.stimuli import PointLightDisplay
from eigenwalker.display.trajectory_display import TrajectoryDisplay
from eigenwalker.display.walker_view import WalkerView, view

__all__ = [
    "AxisDisplay",
    "AxisReport",
    "ConfusionDisplay",
    "CurveDisplay",
    "DecompositionDisplay",
    "DeviationDisplay",
    "EstimateDisplay",
    "FigureDisplay",
    "PermutationDisplay",
    "PointLightDisplay",
    "PoseDisplay",
    "RatingsDisplay",
    "ScoreDisplay",
    "ScreeDisplay",
    "Screen",
    "ShareDisplay",
    "SpectrumDisplay",
    "StickFigureDisplay",
    "TrajectoryDisplay",
    "WalkerView",
    "axis_report",
    "draw_figures",
    "draw_frames",
    "make_display",
    "project",
    "view",
    "write_figure_movie",
    "write_movie",
    "write_movies",
]
