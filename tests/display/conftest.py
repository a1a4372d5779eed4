"""One fitted model for all displays of statistics, one walker for all point-light displays, one browser a module."""

import numpy as np
import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.display import PointLightDisplay, view
from eigenwalker.model import TraitRegressor, make_eigenwalkers
from tests.synthetic import make_walk
from tests.viewer_pages import four_axes, launch, opened, put, start_again

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


@pytest.fixture(scope="module")
def browser():
    with launch() as browser:
        yield browser


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """Return where the page of the model with four axes is."""
    return put(tmp_path_factory.mktemp("pages"), view(*four_axes()))


@pytest.fixture(scope="module")
def open_page(browser, address):
    with opened(browser, address) as page:
        yield page


@pytest.fixture
def page(open_page):
    """Return this page in the state in which it was opened."""
    return start_again(open_page)
