"""Walks to look at."""

from eigenwalker.display.plotting import StickFigureDisplay, project

__all__ = ["StickFigureDisplay", "project"]
