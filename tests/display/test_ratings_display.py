"""Mean ratings of walkers."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.display import RatingsDisplay
from tests.display.answer_tables import ratings


def test_each_trait_is_sorted_with_the_highest_at_the_top():
    means, low, high = ratings()
    display = RatingsDisplay.from_frames(means, low, high)
    for ax, trait in zip(display.axes_, means.columns, strict=True):
        ordered = means[trait].sort_values(ascending=False)
        assert [label.get_text() for label in ax.get_yticklabels()] == list(ordered.index)
        assert_allclose(ax.lines[0].get_xdata(), ordered)
        segments = np.array(ax.collections[0].get_segments())
        assert_allclose(segments[:, 0, 0], low.loc[ordered.index, trait])
        assert_allclose(segments[:, 1, 0], high.loc[ordered.index, trait])
        assert ax.get_title(loc="left") == trait


def test_poles_and_scale_are_on_the_axis():
    means = ratings(traits=("happy", "heavy"))[0]
    axes = RatingsDisplay.from_frames(means, poles={"happy": ("sad", "happy")}, scale=(0, 10)).axes_
    assert [ax.get_xlabel() for ax in axes] == ["mean rating, 0 sad to 10 happy", "mean rating, 0 to 10"]
    assert all(ax.get_xlim()[0] < 0 and ax.get_xlim()[1] > 10 for ax in axes)


def test_without_intervals_there_are_markers_alone():
    means = ratings()[0]
    ax = RatingsDisplay.from_frames(means).axes_[0]
    assert len(ax.lines[0].get_xdata()) == len(means)
    assert not [segment for segment in ax.collections[0].get_segments() if np.isfinite(segment).any()]


def test_a_walker_without_ratings_is_left_out_of_that_trait():
    means = ratings()[0]
    means.loc["walker 2", "happy"] = np.nan
    counts = [len(ax.get_yticklabels()) for ax in RatingsDisplay.from_frames(means).axes_]
    assert counts == [4, 5]


def test_many_walkers_have_no_names():
    ax = RatingsDisplay.from_frames(*ratings(80)).axes_[0]
    assert len(ax.get_yticklabels()) == 0
    assert ax.get_ylabel() == "80 walkers, sorted by their ratings"


def test_errors():
    means, low, high = ratings()
    with pytest.raises(ValueError, match="both low and high, or none of them, got one"):
        RatingsDisplay.from_frames(means, low)
    with pytest.raises(ValueError, match="in the same order, got others"):
        RatingsDisplay.from_frames(means, low[::-1], high)
    with pytest.raises(ValueError, match="missing: nervous"):
        RatingsDisplay.from_frames(means, low, high[["happy"]])
