"""Walker-adaptive training of GaitHSMM: people who differ, what they share, and a model that must be adapted."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from eigenwalker.hsmm import GaitHSMM
from tests.hsmm.walking import shaken_walk

N_PEOPLE = 5


def walks_of(person, n_walks=2, *, first=0):
    """Return walks of one of many people, each of whose joints has a posture and a size of movements of its own."""
    random = np.random.default_rng(1000 + person)
    size, posture = random.uniform(0.8, 1.2, (7, 3)), 0.15 * random.normal(size=(7, 3))
    walks = []
    for at in range(n_walks):
        walk = shaken_walk(100 * person + first + at)
        index = [walk.skeleton.index(name) for name in walk.channel_joints]
        rotations = np.array(walk.rotations)
        rotations[:, index] = size * rotations[:, index] + posture
        walks.append(replace(walk, rotations=rotations, name=f"person {person}, walk {first + at}"))
    return walks


@pytest.fixture(scope="module")
def people():
    return [walk for person in range(N_PEOPLE) for walk in walks_of(person)]


@pytest.fixture(scope="module")
def names():
    return [f"person {person}" for person in range(N_PEOPLE) for _ in range(2)]


@pytest.fixture(scope="module")
def plain(people):
    return GaitHSMM().fit(people)


@pytest.fixture(scope="module")
def adaptive(people, names):
    return GaitHSMM(walker_weight=10.0).fit(people, walkers=names)


def test_what_walkers_differ_in_is_no_spread_of_the_states(plain, adaptive):
    static = slice(0, 21)
    ratio = adaptive.covars_[:, static].mean() / plain.covars_[:, static].mean()
    assert ratio < 0.5
    assert adaptive.is_canonical_
    assert not plain.is_canonical_


def test_the_objective_rises(adaptive):
    assert (np.diff(adaptive.history_) > -1e-6).all()


def test_a_model_that_is_not_adapted_says_so(adaptive, people):
    for score in (adaptive.score, adaptive.score_samples):
        with pytest.warns(UserWarning, match="trained walker-adaptively and not adapted"):
            score(people[:1])


def test_a_new_person_is_met_better_than_by_the_plain_average(plain, adaptive):
    """The same adaptation to one walk of someone never seen; another walk of theirs is more likely."""
    gains = []
    for person in (11, 12, 13):
        seen, other = walks_of(person, 1), walks_of(person, 1, first=5)
        options = {"method": "csmaplr", "transform_weight": 10.0}
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            gains.append(adaptive.adapt(seen, **options).score(other) - plain.adapt(seen, **options).score(other))
    assert np.median(gains) > 0


def test_walkers_must_be_several_and_one_a_walk(people):
    with pytest.raises(ValueError, match="expected a walker for each of the 10 walks, got 2"):
        GaitHSMM().fit(people, walkers=["a", "b"])
    with pytest.raises(ValueError, match=r"needs walks of several people, got walkers=\['a'\]"):
        GaitHSMM().fit(people[:2], walkers=["a", "a"])
