"""Mean ratings with intervals over observers."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker.display import RatingsDisplay
from eigenwalker.experiment.ratings.intervals import mean_ratings
from eigenwalker.experiment.ratings.traits import ratings_to_traits


def rated(n_observers=3, *, seed=0, trait="happy"):
    """Return whole ratings of ten walkers in three views."""
    random = np.random.default_rng(seed)
    rows = [
        (observer, f"walker {walker}", view, int(np.clip(random.normal(2 + walker / 3, 1), 1, 6).round()))
        for observer in range(1, n_observers + 1)
        for view in (0.0, 30.0, 90.0)
        for walker in range(10)
    ]
    table = pd.DataFrame(rows, columns=["participant", "stimulus", "view", "value"])
    return table.assign(task="rating", part="main", trait=trait)


def test_means_are_the_labels_of_traits():
    answers = pd.concat([rated(), rated(seed=1, trait="nervous")[:60]])
    pd.testing.assert_frame_equal(mean_ratings(answers).means, ratings_to_traits(answers))


def test_the_interval_is_over_observers():
    """Of observers who say the same in each view, and so are three ratings: 3, 4 and 5, t of two degrees is 4.303."""
    answers = rated().assign(value=lambda table: table["participant"] + 2)
    means, low, high = mean_ratings(answers)
    assert_allclose(means, 4.0)
    assert_allclose(high, np.minimum(4 + 4.302653 / np.sqrt(3), 6), rtol=1e-6)
    assert_allclose(low, 4 - 4.302653 / np.sqrt(3), rtol=1e-6)


def test_more_observers_leave_less_open():
    widths = [(found.high - found.low).mean().item() for found in map(mean_ratings, (rated(3), rated(20)))]
    assert widths[1] < 0.5 * widths[0]


def test_one_observer_leaves_all_open():
    found = mean_ratings(rated(1))
    assert (found.low == 1).all(axis=None)
    assert (found.high == 6).all(axis=None)


def test_walkers_without_ratings_of_a_trait_have_none():
    answers = pd.concat([rated(), rated(seed=1, trait="nervous").query("stimulus != 'walker 3'")])
    for table in mean_ratings(answers):
        assert table["nervous"].isna().to_dict() == {f"walker {number}": number == 3 for number in range(10)}


def test_the_picture_takes_them():
    display = RatingsDisplay.from_frames(*mean_ratings(rated()), poles={"happy": ("sad", "happy")})
    assert len(display.axes_[0].get_yticklabels()) == 10


def test_ratings_outside_the_scale_are_refused():
    with pytest.raises(ValueError, match="ratings from 1 to 3, got others of: happy; pass scale="):
        mean_ratings(rated(), scale=(1, 3))
