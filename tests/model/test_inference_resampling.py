"""Persons drawn again, and learning curves."""

import numpy as np
import pandas as pd
import pytest
from joblib import parallel_config
from numpy.testing import assert_allclose
from scipy.stats import bootstrap
from sklearn.decomposition import PCA
from sklearn.metrics import roc_auc_score
from sklearn.pipeline import Pipeline

from eigenwalker.model import (
    BlockScaler,
    TraitRegressor,
    bootstrap_axes,
    learning_curve_walkers,
)
from eigenwalker.model._resampling import feature_axes, fit_weighted, fit_without_each, predict_weighted
from eigenwalker.model._sample import Reduction, take_sample
from eigenwalker.model.bootstrap import bca_interval


def fit_copies(vectors, labels, persons, counts, n_components, scaling, direction):
    """Return the fitted Pipeline, its vectors and its axes, with each person copied as often as drawn."""
    walks = np.concatenate([np.flatnonzero(persons == p) for p, count in enumerate(counts) for _ in range(count)])
    copies = np.concatenate(
        [np.full((persons == p).sum(), 100 * p + copy) for p, count in enumerate(counts) for copy in range(count)]
    )
    steps = [] if scaling is None else [("scaler", BlockScaler(unit=scaling))]
    steps += [("eigenwalkers", PCA(n_components, svd_solver="full")), ("trait", TraitRegressor(direction=direction))]
    options = {"scaler__groups": copies} if scaling == "noise" else {}
    model = Pipeline(steps).fit(vectors[walks], labels[walks], trait__groups=copies, **options)
    steps = np.vstack([model[-1].step([[1.0]], [name]) for name in model[-1].trait_names_])
    zero = np.zeros((1, n_components))
    axes = model[:-1].inverse_transform(steps) - model[:-1].inverse_transform(zero)
    return model, axes


@pytest.mark.parametrize("direction", ["pattern", "filter"])
@pytest.mark.parametrize("scaling", [None, "blocks", "features", "noise"])
@pytest.mark.parametrize("n_features", [7, 40])
def test_a_person_drawn_twice_counts_twice(n_features, scaling, direction):
    random = np.random.default_rng(0)
    persons = np.repeat(np.arange(10), [1, 2, 3, 2, 1, 2, 2, 3, 1, 2])
    vectors = random.normal(size=(19, n_features)) + 2 * random.normal(size=(10, n_features))[persons]
    labels = random.normal(size=(10, 2))[persons]
    labels[persons == 4, 1] = np.nan
    counts = np.array([2, 1, 0, 1, 3, 0, 1, 1, 0, 1])
    sample = take_sample(vectors, persons, None)
    fit = fit_weighted(sample, labels, counts, Reduction(4, scaling))
    model, axes = fit_copies(vectors, labels, persons, counts, 4, scaling, direction)
    assert_allclose(feature_axes(fit, direction), axes, atol=1e-10)
    assert_allclose(predict_weighted(fit, vectors), model.predict(vectors), atol=1e-10)


@pytest.mark.parametrize("scaling", [None, "blocks", "features", "noise"])
def test_nobody_left_out_is_fitted_anew(scaling):
    random = np.random.default_rng(1)
    persons = np.repeat(np.arange(7), [1, 2, 3, 2, 1, 2, 2])
    vectors, labels = random.normal(size=(13, 9)), random.normal(size=(13, 2))
    labels[2, 1] = np.nan
    sample, reduction = take_sample(vectors, persons, None), Reduction(4, scaling)
    for person, fit in enumerate(fit_without_each(sample, labels, reduction)):
        expected = fit_weighted(sample, labels, (np.arange(7) != person).astype(int), reduction)
        for direction in ("pattern", "filter"):
            assert_allclose(feature_axes(fit, direction), feature_axes(expected, direction), atol=1e-10)


def test_bootstrap_is_repeatable_and_does_not_depend_on_n_jobs():
    random = np.random.default_rng(1)
    vectors, labels = random.normal(size=(12, 5)), random.normal(size=(12, 2))
    with parallel_config(backend="threading"):
        one, two, other = (
            bootstrap_axes(vectors, labels, n_components=2, n_resamples=80, random_state=seed, n_jobs=jobs)
            for seed, jobs in ((0, None), (0, 2), (1, None))
        )
    for first, second in zip(one, two, strict=True):
        assert_allclose(first, second, rtol=0, atol=0)
    assert not np.allclose(one.cosines, other.cosines)
    assert one.axes.shape == one.low.shape == one.high.shape == (2, 5)
    assert one.cosines.shape == (80, 2)
    assert (one.low <= one.high).all()
    assert (np.abs(one.cosines) <= 1 + 1e-12).all()
    alone = bootstrap_axes(vectors, labels[:, 0], n_components=2, n_resamples=80, random_state=0)
    assert_allclose(alone.low, one.low[0])


def test_bca_intervals_are_those_of_scipy():
    random = np.random.default_rng(2)
    values = random.exponential(size=(25, 3))
    expected = bootstrap((values,), np.mean, axis=0, n_resamples=400, method="BCa", rng=np.random.default_rng(3))
    draws = np.moveaxis(expected.bootstrap_distribution, -1, 0)
    jackknife = np.stack([np.delete(values, person, axis=0).mean(axis=0) for person in range(25)])
    low, high = bca_interval(values.mean(axis=0), draws, jackknife, 0.95)
    spread = draws.std(axis=0)
    assert (np.abs(low - expected.confidence_interval.low) < 0.05 * spread).all()  # quantiles are defined differently
    assert (np.abs(high - expected.confidence_interval.high) < 0.05 * spread).all()


def test_resamples_with_one_label_are_drawn_again():
    vectors = np.random.default_rng(4).normal(size=(8, 4))
    codes = np.array([1.0, *[-1.0] * 7])
    result = bootstrap_axes(vectors, codes, n_components=2, n_resamples=60, random_state=0)
    assert (result.cosines != 0).all()
    with pytest.raises(ValueError, match="two different labels of every trait"):
        bootstrap_axes(vectors, np.ones(8), n_components=2, n_resamples=60, random_state=0)
    with pytest.raises(ValueError, match="level must be between 0 and 1"):
        bootstrap_axes(vectors, codes, n_components=2, level=95)
    with pytest.raises(ValueError, match="n_components must be a whole number, got None"):
        bootstrap_axes(vectors, codes, n_components=None)
    with pytest.raises(ValueError, match="n_resamples must be at least 2"):
        bootstrap_axes(vectors, codes, n_components=2, n_resamples=1)


def test_the_learning_curve_is_that_of_refits():
    random = np.random.default_rng(5)
    persons = np.repeat(np.arange(16), 2)
    codes = np.where(np.arange(16) < 8, 1.0, -1.0)[persons]
    vectors = random.normal(size=(32, 6)) + codes[:, np.newaxis] * [1, 0, 0, 1, 0, 0]
    curve = learning_curve_walkers(
        vectors,
        codes,
        n_persons=[5, 11],
        n_components=2,
        scaling="blocks",
        groups=persons,
        n_test=5,
        n_repeats=3,
        random_state=0,
    )
    draws = np.random.RandomState(0)
    for repeat in range(3):
        order = draws.permutation(16)
        tested = order[:5]
        for position, size in enumerate((5, 11)):
            walks = np.isin(persons, order[5 : 5 + size])
            steps = [("s", BlockScaler()), ("e", PCA(2, svd_solver="full")), ("t", TraitRegressor())]
            guesses = pd.Series(Pipeline(steps).fit(vectors[walks], codes[walks]).predict(vectors)).groupby(persons)
            expected = roc_auc_score(codes[::2][tested], guesses.mean()[tested])
            assert_allclose(curve.scores[position, repeat], expected)
    assert_allclose(curve.mean, curve.scores.mean(axis=1))


def test_the_learning_curve_checks_its_sizes():
    vectors, labels = np.random.default_rng(6).normal(size=(20, 5)), np.arange(20.0)
    assert learning_curve_walkers(vectors, labels, n_components=3, n_repeats=2).n_persons.tolist() == [5, 8, 10, 13, 16]
    with pytest.raises(ValueError, match="between n_components \\+ 2 = 5 and the 16 who are not kept apart"):
        learning_curve_walkers(vectors, labels, n_components=3, n_persons=[4])
    with pytest.raises(ValueError, match="score='auc' needs two groups"):
        learning_curve_walkers(vectors, labels, n_components=3, score="auc")
