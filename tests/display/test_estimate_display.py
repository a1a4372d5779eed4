"""Rates and means with intervals."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.display import EstimateDisplay
from tests.display.answer_tables import estimates


def names(display):
    return [label.get_text() for label in display.ax_.get_yticklabels()]


def markers(display):
    """Return the lines of series, without that of the reference."""
    return [line for line in display.ax_.lines if line.get_marker() not in ("None", "")]


def test_markers_are_the_values_and_lines_the_intervals():
    table = estimates(series=())
    display = EstimateDisplay.from_frame(table, xlabel="mean score")
    assert names(display) == list(table.index)
    assert_allclose(markers(display)[0].get_xdata(), table["value"])
    segments = np.array(display.ax_.collections[0].get_segments())  # (n_groups, 2 ends, 2)
    assert_allclose(segments[:, :, 0], table[["low", "high"]])
    assert_allclose(segments[:, 0, 1], range(len(table)))
    assert display.ax_.get_xlabel() == "mean score"
    assert display.ax_.get_legend() is None


def test_series_are_told_apart_without_color_and_stand_beside_each_other():
    display = EstimateDisplay.from_frame(estimates(series=("one", "two", "three")))
    lines = markers(display)
    assert len({(line.get_marker(), line.get_markerfacecolor()) for line in lines}) == 3
    heights = np.array([line.get_ydata() for line in lines])
    assert (np.diff(heights, axis=0) > 0).all()
    assert (np.abs(heights - np.arange(3)) < 0.5).all()
    assert [text.get_text() for text in display.ax_.get_legend().get_texts()] == ["one", "two", "three"]


def test_the_first_group_is_at_the_top():
    low, high = EstimateDisplay.from_frame(estimates()).ax_.get_ylim()
    assert low > high


def test_groups_are_sorted_by_the_first_series():
    table = estimates()
    first = table.xs("original", level=1)["value"].sort_values(ascending=False)
    assert names(EstimateDisplay.from_frame(table, sort=True)) == list(first.index)
    assert names(EstimateDisplay.from_frame(table)) == ["cool", "sad", "afraid"]


def test_groups_that_the_first_series_lacks_come_last():
    table = estimates().drop(index=("cool", "original"))
    display = EstimateDisplay.from_frame(table.loc[["sad", "afraid", "cool"]], sort=True)
    assert names(display)[-1] == "cool"
    assert len(markers(display)[0].get_xdata()) == 2


def test_a_value_that_is_missing_leaves_its_place_empty():
    table = estimates(series=())
    table.loc["sad"] = np.nan
    assert_allclose(markers(EstimateDisplay.from_frame(table))[0].get_ydata(), [0, 2])


@pytest.mark.parametrize(("reference", "n_bands"), [(7.69, 0), ((50.0, 45.0, 55.0), 1)])
def test_the_reference_is_a_line_and_its_interval_a_band(reference, n_bands):
    display = EstimateDisplay.from_frame(estimates(), reference=reference, reference_name="chance", xlim=(0, 100))
    lines = [line for line in display.ax_.lines if line.get_label() == "chance"]
    assert lines[0].get_xdata()[0] == np.ravel(reference)[0]
    assert len(display.ax_.patches) == n_bands
    assert display.ax_.get_xlim() == (-2, 102)


def test_errors():
    with pytest.raises(TypeError, match="expected a DataFrame, got list"):
        EstimateDisplay.from_frame([1, 2])
    with pytest.raises(ValueError, match="missing: low, high"):
        EstimateDisplay.from_frame(estimates()[["value"]])
    with pytest.raises(ValueError, match="got an empty one"):
        EstimateDisplay.from_frame(estimates()[:0])
    with pytest.raises(ValueError, match="got more levels or rows that repeat"):
        EstimateDisplay.from_frame(estimates(("sad", "sad")))
