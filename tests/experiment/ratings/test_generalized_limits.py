"""Generalized intervals: those of drawn chi-squares, in the limits, and how often they hold."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment.ratings.generalized_limits import generalized_interval


@pytest.mark.parametrize(
    ("n_walkers", "n_observers", "squares"),
    [(80, 3, (10.0, 50.0, 1.0)), (6, 4, (11.2, 32.5, 1.0)), (3, 2, (10.0, 2.0, 1.0)), (20, 3, (0.5, 3.0, 1.0))],
)
def test_limits_are_quantiles_of_draws(n_walkers, n_observers, squares):
    """200,000 draws know a 2.5 % quantile to a few thousandths."""
    random, free = np.random.default_rng(0), (n_walkers - 1, n_observers - 1, (n_walkers - 1) * (n_observers - 1))
    walkers, observers, error = (
        square * degrees / random.chisquare(degrees, 200_000) for square, degrees in zip(squares, free, strict=True)
    )
    harshness = n_observers * (observers - error) / n_walkers
    drawn = (walkers - error) / (walkers + (n_observers - 1) * error + harshness)
    found = generalized_interval(squares, n_walkers, n_observers)
    assert_allclose(found, np.quantile(drawn, [0.025, 0.975]), atol=5e-3)


def test_units_do_not_matter():
    assert_allclose(
        generalized_interval((70.0, 30.0, 10.0), 20, 4), generalized_interval((7.0, 3.0, 1.0), 20, 4), atol=1e-8
    )


def test_a_higher_level_is_wider():
    wide, narrow = (generalized_interval((7.0, 3.0, 1.0), 20, 4, level=level) for level in (0.99, 0.5))
    assert wide[0] < narrow[0] < narrow[1] < wide[1]


def test_ratings_without_error():
    assert generalized_interval((5.0, 0.0, 0.0), 20, 3) == (1.0, 1.0)
    low, high = generalized_interval((5.0, 3.0, 0.0), 20, 3)
    assert 0 < low < high < 1


def test_walkers_who_do_not_differ():
    low, high = generalized_interval((0.0, 3.0, 1.0), 20, 3)
    assert -1 < low < high < 0


def test_two_walkers_and_two_observers():
    low, high = generalized_interval((5.0, 1.0, 1.0), 2, 2)
    assert low < -1
    assert high < 1
