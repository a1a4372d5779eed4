"""What all displays of statistics share: given axes are drawn on, and no figure is left behind."""

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure

from eigenwalker.display import AxisDisplay, CurveDisplay, DeviationDisplay, PermutationDisplay, ScreeDisplay
from eigenwalker.model import PermutationResult
from eigenwalker.model.walker_score import score_walker


def _draw_axis(model, walkers, ax):
    return AxisDisplay.from_estimator(model, "happy", ax=ax)


def _draw_curve(model, walkers, ax):
    return CurveDisplay.from_frame(pd.DataFrame({"happy": [0.1, 0.3]}, index=[1, 2]), ax=ax)


def _draw_deviation(model, walkers, ax):
    return DeviationDisplay.from_score(score_walker(model, walkers.data[0]), ax=ax)


def _draw_permutation(model, walkers, ax):
    return PermutationDisplay.from_result(PermutationResult(0.9, 0.2, np.linspace(0.3, 0.7, 4)), ax=ax)


def _draw_scree(model, walkers, ax):
    return ScreeDisplay.from_estimator(model, ax=ax)


SINGLE = [_draw_curve, _draw_permutation, _draw_scree]
DOUBLE = [_draw_axis, _draw_deviation]


@pytest.mark.parametrize("draw", SINGLE)
def test_single_panels_are_drawn_on_given_axes(draw, model, walkers):
    ax = Figure().subplots()
    display = draw(model, walkers, ax)
    assert display.ax_ is ax
    assert display.figure_ is ax.figure
    assert ax.has_data()
    assert len(display.figure_.axes) == 1


@pytest.mark.parametrize("draw", DOUBLE)
def test_double_panels_are_drawn_on_given_axes(draw, model, walkers):
    axes = Figure().subplots(1, 2)
    display = draw(model, walkers, axes)
    assert display.axes_ == list(axes)
    assert display.figure_ is axes[0].figure
    assert all(ax.has_data() for ax in axes)
    assert len(display.figure_.axes) == 2


@pytest.mark.parametrize("draw", DOUBLE)
def test_wrong_number_of_axes_is_refused(draw, model, walkers):
    with pytest.raises(ValueError, match="ax must be 2 axes, one a panel, got 1"):
        draw(model, walkers, Figure().subplots())


@pytest.mark.parametrize("draw", SINGLE + DOUBLE)
def test_figures_are_new_and_unknown_to_pyplot(draw, model, walkers):
    first, second = draw(model, walkers, None), draw(model, walkers, None)
    assert first.figure_ is not second.figure_
    assert first.plot().figure_ is not second.figure_
    assert not pyplot.get_fignums()


@pytest.mark.parametrize("draw", SINGLE + DOUBLE)
def test_notebooks_show_a_picture(draw, model, walkers):
    assert draw(model, walkers, None)._repr_png_().startswith(b"\x89PNG")
