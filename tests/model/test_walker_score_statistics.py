"""One walker against a group: whether intervals and shares are what they say, and a patient on recorded walks."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_array_equal
from scipy.stats import kstest

from eigenwalker import FourierLinearizer, make_eigenwalkers, make_walkers
from eigenwalker.model._guards import share_beyond
from eigenwalker.model.walker_score import score_walker
from eigenwalker.motion import pool_walks, stride_frequency
from tests.recorded import bandai_walks, style
from tests.synthetic import body_coefficients, make_walk
from tests.varying_strides import make_varying_walk


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(31, duration=8, frame_rate=60, random_state=0)


@pytest.fixture(scope="module")
def model(walkers):
    labels = walkers.target[["gender", "weight", "happy"]]
    return make_eigenwalkers(n_components=8).fit(walkers.data[:30], labels[:30])


@pytest.fixture(scope="module")
def patient(walkers):
    return walkers.data[30]


def test_noise_widens_the_interval(model, patient):
    rng, widths = np.random.default_rng(2), []
    for noise in (0.0, 0.06):
        walk = replace(patient, positions=patient.positions + noise * rng.normal(size=patient.positions.shape))
        axes = score_walker(model, walk).axes
        widths.append(axes["high"] - axes["low"])
    assert (np.diff(widths, axis=0) > 0).all()


def test_level_widens_the_interval(model, patient):
    narrow, wide = (score_walker(model, patient, level=level).axes for level in (0.8, 0.99))
    assert (wide["low"] < narrow["low"]).all()
    assert (wide["high"] > narrow["high"]).all()
    assert (narrow["low"] < narrow["alpha"]).all()
    assert (narrow["alpha"] < narrow["high"]).all()


@pytest.mark.parametrize(("n_strides", "time_sd"), [(5, 0.0), (12, 0.03)])
def test_intervals_hold_the_alpha_of_the_mean_stride(n_strides, time_sd):
    """On 160 walks of independent strides: 95 % of them have a standard error of 1.7 %."""
    rng = np.random.default_rng(3)
    group = [make_walk(rng, n_harmonics=4, frequency=rng.uniform(0.8, 1.1), frame_rate=60)[0] for _ in range(20)]
    linearizer = FourierLinearizer().fit(group)
    labels = np.column_stack((linearizer.transform(group)[:, [-1, 79]], np.arange(20)))
    model = make_eigenwalkers(n_components=6).fit(group, labels)
    coefficients = body_coefficients(rng, 4)
    truth = model[1:].transform([[*coefficients[:5].ravel(), 0.93]])[0]
    held = []
    for _ in range(160):
        walk, _ = make_varying_walk(rng, coefficients, n_strides=n_strides, time_sd=time_sd)
        score = score_walker(model, walk)
        assert score.n_strides == n_strides
        held.append((score.axes["low"] < truth) & (truth < score.axes["high"]))
    shares = np.mean(held, axis=0)
    assert (shares >= 0.90).all(), shares
    assert 0.92 <= shares.mean() <= 0.99, shares


def test_shares_beyond_are_uniform_for_fresh_walkers_in_the_eigenwalkers_of_others():
    """In those of the training walkers themselves fresh ones vary less, so that shares are too large."""
    walkers = make_walkers(400, duration=6, frame_rate=30, random_state=5)
    others, training, fresh = (walkers.data[start : start + 150] for start in (0, 150, 300))
    labels = walkers.target["weight"]
    model = make_eigenwalkers(n_components=10).fit(others, labels[:150])
    model[-1].fit(model[:-1].transform(training), labels[150:300])
    assert kstest([score_walker(model, walk).share_beyond for walk in fresh], "uniform").pvalue > 0.05
    model.fit(training, labels[150:300])
    shares = share_beyond(model[-1].distance(model[:-1].transform(fresh)), 150, 10)
    assert kstest(shares, "uniform", alternative="greater").pvalue > 0.5  # stochastically not smaller
    assert 0.55 < np.median(shares) < 0.85


def test_too_few_strides_have_no_interval(model):
    walk, _ = make_walk(np.random.default_rng(4), n_cycles=2.9, phase=1.0, name="anna")
    with pytest.warns(UserWarning, match=r"'anna': an interval .* at least 3 strides .*, got 2; low and high are NaN"):
        score = score_walker(model, walk)
    assert score.n_strides == 2
    assert score.axes[["low", "high"]].isna().all(axis=None)
    assert_array_equal(score.axes["alpha"], model.transform([walk])[0])


def test_pooled_walks_are_scored_stride_by_stride(model, patient):
    passes = [replace(patient, positions=patient.positions[frames]) for frames in (slice(0, 250), slice(210, 480))]
    (pooled,) = pool_walks(passes, ["anna", "anna"])
    score = score_walker(model, pooled)
    assert score.n_strides == round(pooled.duration * pooled.frequency)
    assert (score.axes["low"] < score.axes["high"]).all()


def test_an_acted_old_man_is_far_from_the_same_actors_walk(data_dir):
    """`bandai2`: 24 normal walks as the group; they are one person's, so that everybody else is far away."""
    _, prepared = bandai_walks(data_dir)
    group = [walk for walk in prepared if style(walk) == "normal"]
    cadence = pd.Series([stride_frequency(walk) for walk in group], name="cadence")
    model = make_eigenwalkers(n_components=5).fit(group, cadence)
    normal = [score_walker(model, walk) for walk in group]
    elderly = [score_walker(model, walk) for walk in prepared if style(walk) == "elderly"]
    assert max(score.distance for score in normal) < normal[0].distance_limit
    assert min(score.distance for score in elderly) > 2 * normal[0].distance_limit
    assert max(score.share_beyond for score in elderly) < 1e-3
    assert min(score.residual for score in elderly) > 10 * max(score.residual for score in normal)
    assert all(score.n_strides >= 3 for score in [*normal, *elderly])
