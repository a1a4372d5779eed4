"""What displays of answers share: given axes are drawn on, no figure is left behind, 11 styles have room."""

from itertools import pairwise

import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure

from eigenwalker.display import ConfusionDisplay, EstimateDisplay, RatingsDisplay, ScoreDisplay, ShareDisplay
from tests.display.answer_tables import confusions, estimates, ratings, scores, shares

STYLES = ("afraid", "cool", "decided", "drunk", "heavy", "in a hurry", "manly", "proud", "sad", "tiptoeing", "topmodel")


def _draw_confusions(ax, styles=("cool", "sad")):
    return ConfusionDisplay.from_tables(confusions(styles=styles), ax=ax)


def _draw_estimates(ax, styles=("cool", "sad")):
    return EstimateDisplay.from_frame(estimates(styles), reference=7.69, reference_name="chance", ax=ax)


def _draw_ratings(ax, styles=None):
    return RatingsDisplay.from_frames(*ratings(40 if styles else 5), ax=ax)


def _draw_scores(ax, styles=("cool", "sad")):
    return ScoreDisplay.from_frames(*scores(styles), ax=ax)


def _draw_shares(ax, styles=None):
    return ShareDisplay.from_frame(shares(), ax=ax)


SINGLE = [_draw_estimates, _draw_scores, _draw_shares]
DOUBLE = [_draw_confusions, _draw_ratings]


@pytest.mark.parametrize("draw", SINGLE)
def test_single_panels_are_drawn_on_given_axes(draw):
    ax = Figure().subplots()
    display = draw(ax)
    assert display.ax_ is ax
    assert display.figure_ is ax.figure
    assert ax.has_data()
    assert len(display.figure_.axes) == 1


@pytest.mark.parametrize("draw", DOUBLE)
def test_double_panels_are_drawn_on_given_axes(draw):
    axes = Figure().subplots(1, 2)
    display = draw(axes)
    assert display.axes_ == list(axes)
    assert all(ax.has_data() for ax in axes)
    with pytest.raises(ValueError, match="ax must be 2 axes, one a panel, got 1"):
        draw(Figure().subplots())


@pytest.mark.parametrize("draw", SINGLE + DOUBLE)
def test_figures_are_new_and_unknown_to_pyplot(draw):
    first = draw(None)
    figure = first.figure_
    assert first.plot().figure_ is not figure
    assert not pyplot.get_fignums()
    assert first._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize("draw", SINGLE + DOUBLE)
def test_words_do_not_overlap(draw):
    figure = draw(None, STYLES).figure_
    figure.draw_without_rendering()
    for ax in figure.axes:
        for axis in (ax.xaxis, ax.yaxis):
            boxes = [label.get_window_extent() for label in axis.get_ticklabels() if label.get_text()]
            assert not [(one, other) for one, other in pairwise(boxes) if one.overlaps(other)]
    inside = figure.get_window_extent()
    for ax in figure.axes:
        box = ax.get_tightbbox()
        assert inside.x0 <= box.x0
        assert box.x1 <= inside.x1 + 1
        assert inside.y0 - 1 <= box.y0
        assert box.y1 <= inside.y1 + 1
