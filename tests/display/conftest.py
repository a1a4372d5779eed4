"""One fitted model for all displays of statistics."""

import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.model import TraitRegressor, make_eigenwalkers

POLES = {"gender": ("female", "male"), "happy": ("sad", "happy")}


@pytest.fixture(scope="session")
def walkers():
    return make_walkers(40, random_state=0)


@pytest.fixture(scope="session")
def model(walkers):
    trait = TraitRegressor(poles=POLES)
    return make_eigenwalkers(n_components=10, trait=trait).fit(walkers.data, walkers.target[list(POLES)])
