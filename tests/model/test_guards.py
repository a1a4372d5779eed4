"""Warnings come where they should, as often as they should, and nowhere else."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import kstest, t

from eigenwalker.datasets import make_walkers
from eigenwalker.model import (
    LeakageWarning,
    OutsideDataWarning,
    TraitClassifier,
    TraitRegressor,
    axis_features,
    axis_statistics,
    make_eigenwalkers,
    walk_along_axis,
    walk_at,
)
from eigenwalker.model._guards import LIMIT, distance_limit, distances, share_beyond, warn_leakage, warn_outside
from eigenwalker.motion import split_passes

TRAITS = ["gender", "weight", "happy"]


def draw_distances(n, k, n_sets, n_fresh):
    """Return the distances of fresh draws from n in training, in another basis each time, shape (n_sets, n_fresh)."""
    random, found = np.random.default_rng(0), []
    for _ in range(n_sets):
        basis = random.normal(size=(k, k))
        training, fresh = random.normal(size=(n, k)) @ basis + 3, random.normal(size=(n_fresh, k)) @ basis + 3
        found.append(distances(fresh - training.mean(axis=0), np.cov(training.T).reshape(k, k)))
    return np.array(found)


def test_one_in_a_hundred_fresh_walkers_is_beyond_the_limit():
    """Of 300 times 50: the share has a standard error of about 0.1 %, draws about one training set included."""
    beyond = draw_distances(30, 10, 300, 50) > distance_limit(30, 10, 0.99)
    assert abs(beyond.mean() - 0.01) < 4 * beyond.mean(axis=1).std() / np.sqrt(300) < 0.006


@pytest.mark.parametrize(("n", "k"), [(30, 10), (12, 11), (5, 1), (200, 15)])
def test_shares_beyond_are_uniform(n, k):
    """One draw a training set, so that they are independent."""
    shares = share_beyond(draw_distances(n, k, 400, 1)[:, 0], n, k)
    assert kstest(shares, "uniform").pvalue > 0.01


@pytest.mark.parametrize("share", [0.5, 0.95, 0.99])
def test_limit_and_share_are_inverse(share):
    for n, k in ((30, 10), (11, 10), (1000, 2)):
        limit = distance_limit(n, k, share)
        assert_allclose(share_beyond(np.array([0.0, limit, np.inf]), n, k), [1, 1 - share, 0], rtol=1e-9)


def test_with_one_component_the_limit_is_a_prediction_interval():
    """Of a single new value: t of n - 1 degrees of freedom, times sqrt(1 + 1 / n); t of 4 at 97.5 % is 2.776."""
    assert_allclose(distance_limit(5, 1, 0.95), 2.776445 * np.sqrt(1.2), rtol=1e-6)
    assert_allclose(distance_limit(30, 1, 0.99), t.ppf(0.995, 29) * np.sqrt(31 / 30))


def test_with_many_walkers_the_limit_is_that_of_chi_squared():
    assert_allclose(distance_limit(10**6, 1, 0.95), 1.959964, atol=1e-4)
    assert_allclose(distance_limit(10**6, 2, 0.99), np.sqrt(-2 * np.log(0.01)), atol=1e-4)


@pytest.mark.parametrize(("n", "k"), [(10, 10), (9, 10), (1, 1)])
def test_too_few_walkers_have_no_limit(n, k):
    assert distance_limit(n, k) == np.inf
    assert np.isnan(share_beyond(np.array([0.0, 1e9]), n, k)).all()


def test_distances_by_hand():
    covariance = np.array([[4.0, 0.0], [0.0, 9.0]])
    assert_allclose(distances(np.array([[2.0, 0.0], [0.0, 3.0], [4.0, 6.0]]), covariance), [1, 1, np.sqrt(8)])


def test_directions_without_variance_do_not_count():
    scores = np.array([[2.0, 5.0], [0.0, 1.0]])
    assert_allclose(distances(scores, np.diag([4.0, 0.0])), [1, 0])
    assert_allclose(distances(scores, np.zeros((2, 2))), [0, 0])


def test_distances_do_not_depend_on_the_basis():
    random = np.random.default_rng(0)
    training, turn = random.normal(size=(20, 4)), random.normal(size=(4, 4))
    one = distances(training, np.cov(training.T))
    assert_allclose(distances(training @ turn, np.cov((training @ turn).T)), one)


def test_the_furthest_walk_is_named():
    with pytest.warns(OutsideDataWarning, match=r"2 of 3 walks .* 99% .* within 2 SD; the furthest, 'b', at 7.5 SD"):
        warn_outside(np.array([1.0, 7.5, 2.5]), 2.0, ["a", "b", "c"])
    warn_outside(np.array([1.0, 2.0]), 2.0, ["a", "b"])
    warn_outside(np.array([1e9]), np.inf, ["a"])


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(30, duration=4, frame_rate=50, random_state=0)


@pytest.fixture(scope="module")
def model(walkers):
    return make_eigenwalkers(n_components=5).fit(walkers.data, walkers.target[TRAITS])


def reach(model, trait):
    """Return the alpha at which the average walker moved along an axis is at the limit."""
    return model[-1].distance_limit() / model[-1].distance(model[-1].mean_ + model[-1].step([[1.0]], [trait]))[0]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("trait", TRAITS)
def test_walks_beyond_the_limit_warn(model, trait, sign):
    edge = sign * reach(model, trait)
    walk_along_axis(model, trait, [0.999 * edge])
    with pytest.warns(OutsideDataWarning, match="outside your data: 1 of 2 walks") as caught:
        walk_along_axis(model, trait, [0.0, 1.001 * edge])
    assert caught[0].filename == __file__


def test_walks_from_a_base_are_as_far_as_they_get(model, walkers):
    base = walkers.data[3]
    score = model[:-1].transform([base])
    step = model[-1].step([[1.0]], ["weight"])
    own = model.transform([base])[0, 1]
    steps = np.arange(0.0, 20.0, 0.05)
    far = model[-1].distance(score + steps[:, np.newaxis] * step) > model[-1].distance_limit()
    first = steps[far][0]
    walk_along_axis(model, "weight", [own + first - 0.1], base=base)
    with pytest.warns(OutsideDataWarning, match=re.escape(f"'weight {own + first:+g}'")):
        walk_along_axis(model, "weight", [own + first], base=base)


def test_holding_others_goes_further_for_the_same_alpha(model):
    alpha = 0.999 * reach(model, "weight")
    walk_along_axis(model, "weight", [alpha])
    with pytest.warns(OutsideDataWarning):
        walk_along_axis(model, "weight", [alpha], hold=("gender", "happy"))


@pytest.mark.parametrize("part", ["structure", "dynamics"])
def test_parts_are_as_far_as_the_walk_they_make(walkers, model, part):
    """A half of the change alone may break what goes together, or be less of it."""
    for base in (None, walkers.data[3]):
        for alpha in (3.0, 6.0):
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                walks = walk_along_axis(model, "weight", [alpha], base=base, part=part)
            (distance,) = model[-1].distance(model[:-1].transform(walks))
            assert len(caught) == (distance > model[-1].distance_limit())
            if caught:
                assert f"at {distance:.3g} SD" in str(caught[0].message)


def test_the_inverse_of_the_axes_warns(model):
    alphas = np.zeros((2, 3))
    assert len(model[-1].inverse_transform(alphas)) == 2
    alphas[1] = 9.0, -9.0, 9.0
    with pytest.warns(OutsideDataWarning, match="1 of 2 walks .* the furthest, 'walk 1'") as caught:
        model[-1].inverse_transform(alphas)
    assert caught[0].filename == __file__
    with pytest.warns(OutsideDataWarning):
        model.inverse_transform(alphas)


def test_classifiers_warn_too(walkers):
    gender = walkers.target["gender"]
    model = make_eigenwalkers(n_components=5, trait=TraitClassifier()).fit(walkers.data, gender)
    with pytest.warns(OutsideDataWarning):
        walk_along_axis(model, "gender", [15.0])
    with pytest.warns(OutsideDataWarning):
        model.inverse_transform([[15.0]])


def test_the_limit_counts_persons(walkers):
    weight = walkers.target["weight"]
    model = make_eigenwalkers(n_components=5)
    model.fit(walkers.data, weight, trait__groups=np.arange(30) // 2)
    assert model[-1].distance_limit() == distance_limit(15, 5, LIMIT)
    model.fit(walkers.data, weight, trait__groups=np.arange(30) // 6)
    assert model[-1].distance_limit() == np.inf
    walk_along_axis(model, "weight", [9.0])
    assert TraitRegressor().fit(np.eye(4)[:, :2], range(4)).distance_limit(0.5) == distance_limit(4, 2, 0.5)


def zero_frequency(model, trait, start=None, hold=()):
    """Return the alpha at which the frequency is 0: it is linear in alpha."""
    axes, own, frequency = model[-1], 0.0, model[1:-1].inverse_transform(model[-1].mean_[np.newaxis])[0, -1]
    if start is not None:
        alphas = model.transform([start])[0]
        own, frequency = alphas[TRAITS.index(trait)], model[0].transform([start])[0, -1]
    step = axes.step([[1.0, *[0.0] * len(hold)]], [trait, *hold])
    ends = model[1:-1].inverse_transform(np.vstack((axes.mean_, axes.mean_ + step)))[:, -1]
    return own - frequency / (ends[1] - ends[0])


@pytest.fixture(scope="module")
def short(model, walkers):
    """Return the model with walks of a fraction of a stride, which is long enough at hardly any frequency."""
    linearizer = type(model[0])(n_cycles=0.05, frame_rate=50).fit(walkers.data)
    return type(model)([("linearizer", linearizer), *model.steps[1:]])


@pytest.mark.parametrize("hold", [(), ("gender",), ("gender", "happy")])
@pytest.mark.parametrize("based", [False, True])
def test_unreachable_alphas_are_refused_with_how_far_one_can_go(short, walkers, based, hold):
    base = walkers.data[2] if based else None
    zero = zero_frequency(short, "weight", base, hold)
    with pytest.warns(OutsideDataWarning):
        (walk,) = walk_along_axis(short, "weight", [0.999 * zero], base=base, hold=hold)
    assert walk.n_frames > 1000  # strides of many minutes
    message = rf"no walk lies that far out, .* -.* Hz; on the way there it becomes 0 at alpha = {zero:.3g}, stay"
    for beyond in (1.001 * zero, 20 * zero):
        with pytest.raises(ValueError, match=re.escape(f"weight {beyond:+g}: ") + message):
            walk_along_axis(short, "weight", [0.0, beyond], base=base, hold=hold)


def test_several_alphas_shrink_together(short):
    """On the way from the average walker to that place all alphas come near in proportion."""
    slopes = axis_features(short)["frequency"]
    wanted = {"gender": 300.0, "weight": 900.0}
    with pytest.raises(ValueError, match="becomes 0 at alpha") as caught:
        walk_at(short, wanted)
    first, second = map(float, re.search(r"alpha = (\S+), (\S+), stay", str(caught.value)).groups())
    assert_allclose(second / first, 3, rtol=0.01)
    with pytest.warns(OutsideDataWarning):
        walk = walk_at(short, {"gender": 0.98 * first, "weight": 0.98 * second})
    assert walk.n_frames > 100
    assert (slopes != 0).all()


def test_structure_reaches_anywhere(short):
    """It does not move the frequency."""
    with pytest.warns(OutsideDataWarning):
        walk_along_axis(short, "weight", [2 * zero_frequency(short, "weight")], part="structure")


LEAKING = [
    [f"S01_{trial:04d}" for trial in range(1, 4)] + [f"S02_{trial:04d}" for trial in range(1, 4)],
    ["07_walk_01", "07_walk_02", "08_walk_01", "35_walk_09"],
    ["anna", "bob", "anna"],
    ["p1 trial-1", "p1 trial-2", "p2 trial-1"],
    ["anna_pass1", "anna_pass2", "bob_pass1"],
    ["anna_pass1_stride1", "anna_pass2_stride1", "bob_pass1_stride1"],
    ["walker_000_pass1", "walker_000_pass2", "walker_001_pass1"],
]
HARMLESS = [
    [f"walker_{number:03d}" for number in range(20)],
    ["subject_01", "control_01", "subject_02", "control_02"],
    ["dataset-2_walk_active_001", "dataset-2_walk_active_002", "dataset-2_walk_happy_001"],
    ["anna", "bob", "carl_2"],
    ["S01_0001", "S02_0001", "S03_0001"],
    ["anna_pass1", "bob_pass1"],
    ["S01_0001", "S02_0002", "S03_0003"],
    ["", "", ""],
    ["anna"],
    [],
]


@pytest.mark.parametrize("names", LEAKING)
def test_several_walks_a_person_warn(names):
    with pytest.warns(LeakageWarning, match="no groups are given.*Pass groups") as caught:
        texts = warn_leakage(names, None)
    assert texts == [str(caught[0].message)]
    assert warn_leakage(names, range(len(names))) == []


@pytest.mark.parametrize("names", HARMLESS)
def test_other_names_do_not(names):
    assert warn_leakage(names, None) == []


def test_the_warning_says_who():
    names = [f"{letter}{person:02d}_{trial}" for letter in "SP" for person in range(3) for trial in range(2)]
    with pytest.warns(LeakageWarning, match=r"12 walks .* 6 persons by their names \('S00' 2 times, .*, \.\.\.\)"):
        warn_leakage(names, None)
    with pytest.warns(LeakageWarning, match=r"3 walks .* of 2 persons by their names \('anna' 2 times\)"):
        warn_leakage(["anna", "", "bob", "anna"], None)


def test_names_that_this_package_gives():
    recording = make_walkers(1, duration=8, frame_rate=50, treadmill=False, random_state=0).data[0]
    (one,) = split_passes(recording)
    assert warn_leakage([one.name], None) == []
    with pytest.warns(LeakageWarning, match="'walker_000' 2 times"):
        warn_leakage([one.name, one.name.replace("pass1", "pass2")], None)


def test_leakage_is_among_the_faults(walkers):
    walks = [replace(walk, name=f"S{number // 2:02d}_{number % 2:04d}") for number, walk in enumerate(walkers.data)]
    options = {"n_harmonics": [2], "n_permutations": 19, "n_resamples": 5, "random_state": 0}
    model, weight = make_eigenwalkers(n_components=5), walkers.target["weight"]
    with pytest.warns(LeakageWarning, match="30 walks look like those of 15 persons") as caught:
        found = axis_statistics(model, walks, weight, **options)
    assert found.faults[0] == str(caught[0].message)
    assert caught[0].filename == __file__
    found = axis_statistics(model, walks, weight, groups=range(30), **options)
    assert not [fault for fault in found.faults if "by their names" in fault]
