"""What speaks against an axis is said, and nothing where nothing does."""

import numpy as np
import pandas as pd
import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.model import FourierLinearizer, axis_statistics, make_eigenwalkers
from eigenwalker.model._findings import find_faults, state_notes

GOOD = {
    "n_persons": 40,
    "score": "auc",
    "p": 0.01,
    "tempo": 0.55,
    "stability": 0.9,
    "left_out": 0.9,
    "left_out_low": 0.75,
    "nested": 0.85,
    "nested_low": 0.7,
    "nested_high": 0.95,
}
LABELS = np.repeat([-1.0, 1.0], 20)


def faults(labels=LABELS, *, persons=None, sources=None, alone=(0.8, 0.7), curve=(0.7, 0.9), **row):
    """Return the faults of a trait that is good but for what is given."""
    summary = pd.DataFrame({"trait": GOOD | row}).T.infer_objects()
    index = pd.MultiIndex.from_product([["trait"], ["structure", "dynamics"]])
    parts = pd.DataFrame({"alone": alone}, index=index)
    components = pd.DataFrame({"trait": curve}, index=[3, 8])
    persons = np.arange(len(labels)) if persons is None else persons
    codes = pd.DataFrame({"trait": labels})
    return find_faults(summary, parts, components, codes, persons, sources, {"n_components": 8})


def the_fault(**changes):
    """Return the only fault there is."""
    (text,) = faults(**changes)
    return text


def test_a_good_axis_has_no_fault():
    assert faults() == []
    assert faults(sources=np.tile(["here", "there"], 20)) == []


@pytest.mark.parametrize(
    ("good", "wrong", "message"),
    [
        ({"p": 0.05}, {"p": 0.06}, "not told from chance: shuffled labels do as well in 6% of cases"),
        ({"alone": (0.98, 1.0)}, {"alone": (0.99, 1.0)}, "too good: structure alone and dynamics alone both"),
        ({"alone": (1.0, np.nan)}, {"alone": (1.0, 1.0)}, "too good"),
        ({"tempo": 0.74}, {"tempo": 0.75}, "frequency and speed alone do about as well .area under the curve 0.75 be"),
        ({"tempo": np.nan}, {"tempo": 0.8, "score": "r"}, r"about as well \(r 0.80 beside 0.90\)"),
        ({"curve": (0.2, 0.95)}, {"curve": (0.2, 0.96)}, "best of all numbers of components, 8, has 0.96, but .* 0.85"),
        ({"stability": 0.8}, {"stability": 0.79}, "unstable: with persons drawn again the median cosine .* 0.79"),
        ({"n_persons": 16}, {"n_persons": 15}, "few persons: 15 for 8 components; at least 2 persons a component"),
    ],
)
def test_each_fault_begins_where_it_should(good, wrong, message):
    assert faults(**good) == []
    with pytest.raises(AssertionError, match=message):
        raise AssertionError(the_fault(**wrong))


def test_correlations_have_no_ceiling():
    """Height tells of structure and of the length of steps; both may tell a number well."""
    assert faults(alone=(0.995, 0.995), score="r") == []


def test_chance_is_not_blamed_on_tempo():
    assert the_fault(p=0.5, tempo=0.9).startswith("trait: not told from chance")


def test_sources_that_tell_the_label():
    sources = np.repeat(["here", "there"], 20)
    text = the_fault(sources=sources)
    assert "confounded with the source: where a walk was recorded tells its label always (2 sources)" in text
    mixed = sources.copy()
    mixed[:2] = "there"
    assert "to 8" in the_fault(sources=mixed)
    assert "always (4 sources)" in the_fault(sources=np.repeat([1, 2, 3, 4], 10))


def test_sources_that_do_not():
    random = np.random.default_rng(0)
    assert faults(sources=np.full(40, "here")) == []
    for n_sources in (2, 5, 10, 20):
        assert faults(sources=random.permutation(np.arange(40) % n_sources)) == []


def test_a_session_for_each_person_tells_nothing():
    """Every label follows from who it is."""
    assert faults(sources=np.arange(40)) == []
    assert faults(sources=np.repeat(np.arange(20), 2), persons=np.repeat(np.arange(20), 2)) == []
    assert faults(sources=np.r_[0, 0, np.arange(38)]) == []


def test_walks_of_a_person_count_once():
    """Ten women in one place and ten men in the other, but for one man with many walks."""
    labels = np.r_[np.repeat([-1.0, 1.0], 10), np.ones(40)]
    sources = np.r_[np.repeat(["here", "there"], 10), np.repeat(["here"], 40)]
    persons = np.r_[np.arange(20), np.full(40, 20)]
    assert "to 8" in the_fault(labels=labels, sources=sources, persons=persons)


def test_moods_that_go_with_the_session():
    """Each person calm in the first session and glad in the second; or both in both."""
    persons = np.tile(np.arange(10), 4)
    assert "always (2 sources)" in the_fault(sources=np.repeat(["first", "second"], 20), persons=persons)
    assert faults(sources=np.tile(np.repeat(["first", "second"], 10), 2), persons=persons) == []


def test_missing_labels_and_sources_do_not_count():
    labels, sources = LABELS.copy(), np.repeat(["here", "there"], 20).astype(object)
    sources[25:30], labels[25:30] = "here", np.nan
    sources[30:35] = None
    assert "always (2 sources)" in the_fault(labels=labels, sources=sources)
    assert faults(labels=labels, sources=pd.Series([None] * 40)) == []


def test_numbers_go_with_sources_too():
    weight = np.random.default_rng(0).normal(size=40) + np.repeat([0, 10], 20)
    assert "confounded with the source" in the_fault(labels=weight, sources=np.repeat([0, 1], 20))
    assert faults(labels=weight, sources=np.tile([0, 1], 20)) == []


def test_faults_are_of_each_trait():
    summary = pd.DataFrame({"good": GOOD, "poor": GOOD | {"p": 0.4}}).T
    index = pd.MultiIndex.from_product([["good", "poor"], ["structure", "dynamics"]])
    parts, curve = pd.DataFrame({"alone": 0.7}, index=index), pd.DataFrame({"good": [0.8], "poor": [0.8]})
    codes = pd.DataFrame({"good": LABELS, "poor": LABELS})
    found = find_faults(summary, parts, curve, codes, np.arange(40), None, {"n_components": 8})
    assert [text.split(":")[0] for text in found] == ["poor"]


def test_notes():
    assert len(state_notes({"control": []})) == 2
    assert state_notes({"control": ["age", "height"]})[2].startswith("Controlled for age, height: ")


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(40, duration=4, frame_rate=50, random_state=0)


@pytest.fixture(scope="module")
def found(walkers):
    """Return the statistics of labels that are planted, by chance, of tempo, and of a place."""
    frequency = FourierLinearizer().fit_transform(walkers.data)[:, -1]
    chance = np.random.default_rng(2).permutation(np.repeat(["no", "yes"], 20))
    y = walkers.target[["happy", "gender"]].assign(chance=chance, tempo=frequency)
    options = {"n_harmonics": [2], "n_permutations": 99, "n_resamples": 20, "random_state": 0}
    model = make_eigenwalkers(n_components=8)
    return axis_statistics(model, walkers.data, y, sources=walkers.target["gender"], **options)


def of(found, trait):
    return [text.removeprefix(f"{trait}: ").split(":")[0] for text in found.faults if text.startswith(f"{trait}:")]


def test_planted_faults_are_found(found):
    assert of(found, "happy") == []
    assert of(found, "gender") == ["confounded with the source"]
    assert of(found, "chance") == ["not told from chance", "unstable"]
    (tempo,) = of(found, "tempo")
    assert tempo.startswith("frequency and speed alone do about as well (r 1.00")


def test_few_persons(walkers):
    options = {"n_harmonics": [2], "n_permutations": 99, "n_resamples": 10, "random_state": 0}
    some, labels = walkers.data[:12], walkers.target["happy"][:12]
    found = axis_statistics(make_eigenwalkers(n_components=8), some, labels, **options)
    assert "few persons" in of(found, "happy")
    found = axis_statistics(make_eigenwalkers(n_components=6), some, labels, **options)
    assert "few persons" not in of(found, "happy")


def test_walks_of_a_person_are_one_person(walkers):
    """Forty walks, but ten persons, for eight components."""
    options = {"n_harmonics": [2], "n_permutations": 99, "n_resamples": 10, "random_state": 0}
    persons = np.arange(40) // 4
    labels = walkers.target["happy"].groupby(persons).transform("mean")
    found = axis_statistics(make_eigenwalkers(n_components=8), walkers.data, labels, groups=persons, **options)
    assert "few persons" in of(found, "happy")
