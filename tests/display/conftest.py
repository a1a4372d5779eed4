"""One fitted model for all displays of statistics, one walker for all point-light displays."""

import numpy as np
import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.display import PointLightDisplay
from eigenwalker.model import TraitRegressor, make_eigenwalkers
from tests.synthetic import make_walk

POLES = {"gender": ("female", "male"), "happy": ("sad", "happy")}


@pytest.fixture(scope="session")
def walkers():
    return make_walkers(40, random_state=0)


@pytest.fixture(scope="session")
def model(walkers):
    trait = TraitRegressor(poles=POLES)
    return make_eigenwalkers(n_components=10, trait=trait).fit(walkers.data, walkers.target[list(POLES)])


@pytest.fixture(scope="session")
def walk():
    """Return a walk with known coefficients."""
    return make_walk(np.random.default_rng(0), n_harmonics=3, name="anna", speed=1.3)[0]


@pytest.fixture(scope="session")
def walker(walk):
    return PointLightDisplay.from_walk(walk)
