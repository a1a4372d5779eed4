"""Sums over walks that come in parts: the same whatever the parts, and no digits lost on the way."""

import pickle
from functools import reduce
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.model import Moments
from eigenwalker.model._scatter import centered_rows, scatter_of


def _walks(n_walks, seed=0, n_features=7):
    rng = np.random.default_rng(seed)
    vectors = rng.normal(size=(n_walks, n_features)) @ rng.normal(size=(n_features, n_features)) + 3
    labels = pd.DataFrame({"sex": rng.choice(["f", "m"], n_walks), "age": rng.normal(40, 10, n_walks)})
    labels.loc[rng.random(n_walks) < 0.3, "age"] = np.nan
    labels.loc[rng.random(n_walks) < 0.2, "sex"] = None
    return vectors, labels


def _of(vectors, labels, cuts=()):
    """Return the moments of each part."""
    edges = [0, *sorted(cuts), len(vectors)]
    slices = [slice(start, stop) for start, stop in pairwise(edges)]
    return [Moments().update(vectors[some], labels[some]) for some in slices]


def _relative(scatter, expected):
    """Return the largest difference of two scatters, with columns in units of their length."""
    lengths = np.sqrt(np.diagonal(expected))
    return np.abs((scatter - expected) / np.outer(lengths, lengths)).max()


def _scatter(values):
    """Return mean and scatter, counted from the first row so that neither loses digits to a mean far off."""
    away = np.asarray(values, dtype=np.longdouble) - values[0]
    centered = away - away.mean(axis=0)
    return values[0] + away.mean(axis=0), centered.T @ centered


def _assert_same(moments, others):
    assert moments.n_walks == others.n_walks
    one, other = moments.total(), others.total()
    for scatter, expected in zip([one.everyone, *one.labeled], [other.everyone, *other.labeled], strict=True):
        assert scatter.n_walks == expected.n_walks
        matrices = [each.rows.T @ each.rows for each in (scatter, expected)]
        # Labels are told apart by words in the order in which they came: their sign is free.
        signs = np.ones(len(scatter.mean))
        if one.traits[0].seen.tolist() != other.traits[0].seen.tolist():
            signs[-2] = -1
        assert _relative(np.outer(signs, signs) * matrices[0], matrices[1]) < 1e-12
        assert_allclose(signs * scatter.mean, expected.mean, rtol=1e-12, atol=1e-12)


@settings(max_examples=40)
@given(
    cuts=st.sets(st.integers(1, 59), max_size=59),
    seed=st.integers(0, 5),
    order=st.randoms(use_true_random=False),
)
def test_parts_and_their_order_do_not_matter(cuts, seed, order):
    """Any partition, added in any order and as any tree."""
    vectors, labels = _walks(60, seed)
    parts = _of(vectors, labels, cuts)
    while len(parts) > 1:
        order.shuffle(parts)
        parts.append(parts.pop() + parts.pop())
    whole = Moments().update(vectors, labels)
    _assert_same(parts[0], whole)
    mean, scatter = _scatter(vectors)
    assert_allclose(parts[0].mean, mean.astype(float), rtol=1e-12)
    assert _relative(parts[0].scatter, scatter.astype(float)) < 1e-12


@pytest.mark.parametrize("size", [1, 3, 500, 2500])
def test_a_mean_a_million_times_the_spread_costs_no_digits(size):
    """Only because sums are counted from the first row: about zero the mean alone is off by 1e-9 SDs."""
    rng = np.random.default_rng(0)
    vectors = 1e6 + rng.normal(size=(2500, 5)) @ rng.normal(size=(5, 5))
    moments = Moments()
    for start in range(0, len(vectors), size):
        moments.update(vectors[start : start + size], vectors[start : start + size, 0])
    mean, scatter = _scatter(vectors)
    assert _relative(moments.scatter, scatter.astype(float)) < 1e-12
    assert_allclose(moments.mean, mean.astype(float), rtol=1e-15)


def test_small_spreads_beside_large_ones_keep_their_digits():
    """A scatter matrix has the squares of singular values: of those below 1e-8 of the first nothing would be left."""
    rng = np.random.default_rng(0)
    left, right = (np.linalg.qr(rng.normal(size=shape))[0] for shape in ((3000, 6), (6, 6)))
    left -= left.mean(axis=0)
    vectors = left * np.geomspace(1, 1e-10, 6) @ right.T
    moments = reduce(Moments.merge, _of(vectors, vectors[:, 0], range(7, 3000, 50)))
    found = np.linalg.svd(moments.total().everyone.rows[:, :6], compute_uv=False)
    assert_allclose(found, np.linalg.svd(vectors - vectors.mean(axis=0), compute_uv=False), rtol=1e-5)


def test_sums_of_float32_are_those_in_float64():
    rng = np.random.default_rng(0)
    vectors = (100 + rng.normal(size=(6000, 4))).astype(np.float32)
    narrow, wide = (Moments().update(each, np.arange(6000.0)) for each in (vectors, vectors.astype(np.float64)))
    assert_array_equal(narrow.scatter, wide.scatter)
    assert_array_equal(narrow.mean, wide.mean)


def test_each_trait_has_the_moments_of_the_walks_with_a_label():
    vectors, labels = _walks(300)
    total = reduce(Moments.merge, _of(vectors, labels, range(11, 300, 13))).total()
    codes = dict(zip(total.traits[0].seen, (-1.0, 1.0), strict=True))
    columns = np.column_stack((vectors, labels["sex"].map(codes), labels["age"]))
    for place, name in enumerate(labels):
        known, own = labels[name].notna().to_numpy(), [*range(7), 7 + place]
        mean, scatter = _scatter(columns[known][:, own])
        found = total.labeled[place]
        assert found.n_walks == known.sum()
        assert_allclose(found.mean[own], mean.astype(float), rtol=1e-12)
        assert _relative((found.rows.T @ found.rows)[np.ix_(own, own)], scatter.astype(float)) < 1e-12


def test_words_may_come_in_any_order():
    """Here one process has seen "m" only, another "f" first."""
    vectors, _ = _walks(9)
    words = pd.Series(list("mmmfmfmmf"), name="sex")
    parts = [Moments().update(vectors[some], words[some]) for some in (slice(0, 3), slice(3, 6), slice(6, 9))]
    for order in ([0, 1, 2], [1, 0, 2], [2, 1, 0]):
        total = reduce(Moments.merge, pickle.loads(pickle.dumps([parts[place] for place in order]))).total()
        sign = 1.0 if total.traits[0].seen.iloc[1] == "m" else -1.0
        codes = sign * np.where(words == "m", 1.0, -1.0)
        mean, scatter = _scatter(np.column_stack((vectors, codes)))
        assert_allclose(total.everyone.mean, mean.astype(float), rtol=1e-12)
        assert _relative(total.everyone.rows.T @ total.everyone.rows, scatter.astype(float)) < 1e-12


def test_persons_may_be_in_several_parts():
    vectors, labels = _walks(80)
    persons = np.random.default_rng(1).integers(0, 12, 80)
    parts = [
        Moments().update(vectors[some], labels[some], groups=persons[some])
        for some in (slice(0, 1), slice(1, 30), slice(30, 80))
    ]
    found = reduce(Moments.merge, parts).total().persons
    means = pd.DataFrame(vectors).groupby(persons).mean()
    assert_allclose(found.table(), means, rtol=1e-12)
    within = (vectors - means.loc[persons].to_numpy()) ** 2
    assert_allclose(found.within(), np.sqrt(within.sum(axis=0) / (80 - len(means))), rtol=1e-12)


def test_adding_leaves_both_as_they_were():
    vectors, labels = _walks(40)
    groups = np.arange(40) // 2
    one, other = (
        Moments().update(vectors[some], labels[some], groups=groups[some]) for some in (slice(0, 21), slice(21, 40))
    )
    before = [each.scatter for each in (one, other)]
    both = one + other
    both.update(vectors, labels, groups=groups)
    assert [each.n_walks for each in (one, other, both)] == [21, 19, 80]
    for each, scatter in zip((one, other), before, strict=True):
        assert_array_equal(each.scatter, scatter)
        assert max(each.total().persons.counts.values()) == 2
    assert (Moments() + one).n_walks == (one + Moments()).n_walks == 21


def test_what_is_held_does_not_grow():
    vectors, labels = _walks(20_000)
    few, many = (pickle.dumps(Moments().update(vectors[:n], labels[:n])) for n in (200, 20_000))
    assert len(many) < 1.1 * len(few)


@pytest.mark.parametrize("n_walks", [1, 2, 3, 10])
def test_few_walks_are_that_many_rows(n_walks):
    """So that there are as many components as of the walks themselves."""
    vectors = np.random.default_rng(0).normal(size=(n_walks, 6))
    rows = centered_rows(scatter_of(vectors).rows)
    assert rows.shape == vectors.shape
    assert_allclose(rows.sum(axis=0), 0, atol=1e-13)
    assert_allclose(rows.T @ rows, _scatter(vectors)[1].astype(float), atol=1e-13)


# Columns.


def test_features_are_taken_by_name():
    vectors, labels = _walks(30)
    names = [f"mean_{number}" for number in range(7)]
    table = pd.DataFrame(vectors, columns=names)
    moments = Moments(names).update(table.assign(name="walk", note=1.0).iloc[:, ::-1], labels)
    assert_array_equal(moments.scatter, Moments().update(vectors, labels).scatter)
    assert Moments().update(table, labels).update(table.iloc[:, ::-1], labels).feature_names == names


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.drop(columns=["mean_1", "mean_3"]), r"the 4 features .* got 2 missing: mean_1, mean_3"),
        (lambda t: t.assign(sin3_head_x=0.0), "1 of another model: sin3_head_x"),
        (lambda t: pd.concat([t, t[["mean_2"]]], axis=1), "1 more than once: mean_2"),
        (lambda t: t.assign(mean_0="high"), "expected columns of numbers, got others in mean_0"),
        (lambda t: t.assign(mean_3=[0, 1, np.nan, 3]), "got nan in row 2, feature mean_3; leave out walks"),
        (lambda t: t.to_numpy()[:, :3], r"X must have shape \(n_walks, 4\), got \(4, 3\)"),
        (lambda t: t.to_numpy()[0], r"X must have shape \(n_walks, 4\), got \(4,\)"),
        (lambda t: t.iloc[:3], "y must have one row a walk, 3, got 4"),
    ],
)
def test_columns_that_do_not_fit_are_named(change, message):
    table = pd.DataFrame(np.arange(16.0).reshape(4, 4), columns=[f"mean_{number}" for number in range(4)])
    moments = Moments(list(table)).update(table, np.arange(4.0))
    with pytest.raises(ValueError, match=message):
        moments.update(change(table), np.arange(4.0))
    assert moments.n_walks == 4


@pytest.mark.parametrize(
    ("y", "options", "message"),
    [
        (["a", "b", "c"], {}, "trait 'trait': expected numbers or two classes, got 3 classes, 'a', 'b', 'c'"),
        (["c", "c", "c"], {}, "got 3 classes, 'a', 'b', 'c'"),
        ([1.0, 2.0, 3.0], {}, "expected numbers or two words in all parts, got both, 'a' and 1.0"),
        (pd.Series(["a", "b", "b"], name="sex"), {}, "the 1-D labels trait, no controls and no groups; got .* sex"),
        ([["a"], ["b"], ["b"]], {}, "got 2 features, the 2-D labels trait"),
        (["a", "b", "b"], {"control": [1, 2, 3]}, "no controls and no groups; got .* the controls control"),
        (["a", "b", "b"], {"groups": [1, 2, 3]}, "no groups; got .* and groups"),
        (["a", "b", "b"], {"control": [1, 2, np.nan]}, "control must have no missing values, got 1 of 3"),
    ],
)
def test_labels_of_another_kind_are_refused(y, options, message):
    vectors = np.arange(6.0).reshape(3, 2)
    moments = Moments().update(vectors, ["a", "b", "a"])
    with pytest.raises(ValueError, match=message):
        moments.update(vectors, y, **options)
    assert moments.n_walks == 3
    assert_array_equal(moments.scatter, Moments().update(vectors, ["a", "b", "a"]).scatter)


def test_groups_must_name_everybody():
    vectors = np.arange(6.0).reshape(3, 2)
    with pytest.raises(ValueError, match="groups must name the person of every walk, got 1 missing"):
        Moments().update(vectors, [1.0, 2, 3], groups=["a", None, "b"])
    with pytest.raises(ValueError, match=r"groups must have one entry a walk, 3, got shape \(2,\)"):
        Moments().update(vectors, [1.0, 2, 3], groups=["a", "b"])


def test_infinite_labels_are_refused():
    with pytest.raises(ValueError, match="trait 'trait', contains infinity"):
        Moments().update([[1.0], [2.0]], [1.0, np.inf])


def test_moments_of_other_things_are_not_added():
    vectors = np.arange(6.0).reshape(3, 2)
    moments = Moments(["a", "b"]).update(vectors, [1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="same features in the same order, got also c"):
        moments.merge(Moments(["a", "c"]).update(vectors, [1.0, 2.0, 3.0]))
    with pytest.raises(ValueError, match="got 2 in another order or number"):
        moments.merge(Moments(["b", "a"]).update(vectors, [1.0, 2.0, 3.0]))
    with pytest.raises(ValueError, match="expected every part to have 2 features"):
        moments.merge(Moments().update(vectors[:, :1], [1.0, 2.0, 3.0]))
    with pytest.raises(ValueError, match="got both"):
        moments.merge(Moments().update(vectors, ["f", "m", "m"]))
    with pytest.raises(TypeError, match="expected Moments, got int"):
        moments.merge(1)
    with pytest.raises(TypeError):
        moments + 1
    assert moments.n_walks == 3


def test_nothing_added_is_said():
    assert repr(Moments()) == "Moments(0 walks)"
    assert Moments().update(np.empty((0, 3)), []).n_walks == 0
    for moments in (Moments(), Moments() + Moments(["a"])):
        with pytest.raises(ValueError, match="expected moments of at least one walk, got none; call update first"):
            moments.total()
