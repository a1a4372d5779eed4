"""Trees of regression classes, and transforms along them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.hsmm.transform_estimation import estimate_transform
from eigenwalker.hsmm.transform_statistics import select_classes
from eigenwalker.hsmm.transform_tree import RegressionTree, estimate_along_tree, group_states, split_states
from tests.hsmm.adapted import noisy_world, rows_of, sum_world


def _partition(tree):
    """Return which states are together."""
    return tree.state_nodes[:, np.newaxis] == tree.state_nodes


@settings(deadline=None)
@given(seed=st.integers(0, 2**32 - 1), n_states=st.integers(1, 12), share=st.floats(0, 1))
def test_every_tree_is_one(seed, n_states, share):
    random = np.random.default_rng(seed)
    n_leaves = 1 + int(share * (n_states - 1))
    counts = random.choice([0.0, 1.0, 20.0], n_states)
    counts[0] = 1.0
    tree = split_states(random.normal(size=(n_states, 2)), n_leaves=n_leaves, counts=counts)
    assert tree.parents[0] == -1
    assert (tree.parents[1:] < np.arange(1, len(tree.parents))).all()
    assert (np.bincount(tree.parents[1:], minlength=len(tree.parents)) % 2 == 0).all()  # two children or none
    leaves = np.setdiff1d(np.arange(len(tree.parents)), tree.parents)
    assert_array_equal(np.unique(tree.state_nodes), leaves)
    assert len(leaves) <= n_leaves


def test_planted_clusters_are_found():
    random = np.random.default_rng(0)
    clusters = random.integers(4, size=40)
    means = np.array([[0, 0, 0], [9, 0, 0], [0, 30, 0], [9, 30, 5]])[clusters] + random.normal(size=(40, 3))
    tree = split_states(means, n_leaves=4)
    assert_array_equal(_partition(tree), clusters[:, np.newaxis] == clusters)
    first = split_states(means, n_leaves=2)
    assert_array_equal(_partition(first), (clusters[:, np.newaxis] < 2) == (clusters < 2))  # the widest gap


def test_order_sign_and_units_do_not_matter():
    random = np.random.default_rng(1)
    means, counts, scales = random.normal(size=(20, 4)), random.uniform(1, 9, 20), np.array([1e-3, 1, 5, 100])
    tree = split_states(means, n_leaves=5, counts=counts)
    channels, states = random.permutation(4), random.permutation(20)
    signs = np.array([1, -1, -1, 1])
    changed = (means * scales * signs)[:, channels]
    assert_array_equal(split_states(changed, n_leaves=5, counts=counts, scales=scales[channels])[1], tree.state_nodes)
    shuffled = split_states(means[states], n_leaves=5, counts=counts[states])
    assert_array_equal(_partition(shuffled), _partition(tree)[np.ix_(states, states)])


def test_equal_means_stay_together():
    tree = split_states([[0.0], [1.0], [0.0], [1.0]], n_leaves=4)
    assert_array_equal(tree.state_nodes, [1, 2, 1, 2])


def test_groups_are_leaves():
    assert_array_equal(group_states([7, -1, 7]).state_nodes, [2, 1, 2])
    assert_array_equal(group_states([3, 3]).parents, [-1])
    with pytest.raises(ValueError, match=r"a whole number for each state, got \[0\.5\]"):
        group_states([0.5])


def _three():
    """Return a tree of three leaves, root > (1, 2), 2 > (3, 4), and statistics of its nodes."""
    tree = RegressionTree(np.array([-1, 0, 0, 2, 2]), np.array([1, 3, 4, 3]))
    world = noisy_world(0, n_frames=200)
    return tree, world, sum_world(world, state_classes=tree.state_nodes, n_classes=5)


def test_each_node_is_held_by_its_parent():
    tree, _, statistics = _three()
    found = estimate_along_tree(statistics, tree, weight=20.0, min_frames=1)
    assert_array_equal(found.sources, np.arange(5))
    assert_allclose(found.n_frames[0], 200)
    assert_allclose(found.n_frames[2], statistics.n_frames[3:].sum())
    for node, classes, parent in ((2, [3, 4], 0), (4, [4], 2)):
        wanted = estimate_transform(select_classes(statistics, classes), weight=20.0, center=found.transforms[parent])
        assert_allclose(rows_of(found.transforms[node]), rows_of(wanted))


def test_few_frames_take_the_parents_transform():
    tree, _, statistics = _three()
    between = np.sort(statistics.n_frames[[1, 3, 4]])
    found = estimate_along_tree(statistics, tree, weight=20.0, min_frames=between[1])
    few = [1, 3, 4][np.argmin(statistics.n_frames[[1, 3, 4]])]
    assert found.sources[few] == tree.parents[few]
    assert found.transforms[few] is found.transforms[tree.parents[few]]
    one = estimate_along_tree(statistics, tree, weight=20.0, min_frames=150)
    assert_array_equal(one.sources[tree.state_nodes], found.sources[0])
    none = estimate_along_tree(statistics, tree, weight=20.0, min_frames=201)
    assert_array_equal(none.sources, -1)
    assert_array_equal(rows_of(none.transforms[3]), np.eye(3, 4))


def test_without_a_prior_leaves_know_nothing_of_each_other():
    tree, world, statistics = _three()
    found = estimate_along_tree(statistics, tree, min_frames=10)
    alone = estimate_transform(select_classes(statistics, 3), start=found.transforms[2])
    assert_allclose(rows_of(found.transforms[3]), rows_of(alone), atol=1e-7)
    root = estimate_transform(sum_world(world))
    assert_allclose(rows_of(found.transforms[0]), rows_of(root), atol=1e-7)


def test_classes_that_may_not_differ_are_one():
    """Children held infinitely strongly have the root's estimate."""
    tree, _, statistics = _three()
    root = estimate_transform(statistics, weight=20.0)
    for leaf in (1, 3, 4):
        child = estimate_transform(select_classes(statistics, leaf), weight=np.inf, center=root)
        assert_array_equal(rows_of(child), rows_of(root))
    fixed = estimate_along_tree(statistics, tree, weight=np.inf, min_frames=1)
    assert all((rows_of(transform) == np.eye(3, 4)).all() for transform in fixed.transforms)


def test_fewest_frames_by_default():
    tree, _, statistics = _three()
    held = estimate_along_tree(statistics, tree, weight=1.0).sources
    assert_array_equal(held >= 0, True)
    assert_array_equal(held == np.arange(5), statistics_below(statistics) >= 55)
    world = noisy_world(1, n_channels=30, n_frames=60)
    assert_array_equal(estimate_along_tree(sum_world(world), group_states([0] * 4), weight=5.0).sources, [0])
    # Without a prior 60 frames are less than the 62 that 31 unknowns a row need.
    assert_array_equal(estimate_along_tree(sum_world(world), group_states([0] * 4)).sources, [-1])


def statistics_below(statistics):
    frames = statistics.n_frames
    return np.array([frames.sum(), frames[1], frames[3] + frames[4], frames[3], frames[4]])


def test_what_does_not_fit_is_refused():
    tree, world, statistics = _three()
    with pytest.raises(ValueError, match="one class for each of 5 nodes, got 1"):
        estimate_along_tree(sum_world(world), tree)
    with pytest.raises(ValueError, match=r"parents must come before.*got \[-1, 2, 0, 2, 2\]"):
        estimate_along_tree(statistics, tree._replace(parents=np.array([-1, 2, 0, 2, 2])))
    with pytest.raises(ValueError, match="from 1 to the number of states, 2, got 3"):
        split_states(np.eye(2), n_leaves=3)
    with pytest.raises(ValueError, match=r"got \(2, 2\) and \(3,\)"):
        split_states(np.eye(2), n_leaves=1, counts=np.ones(3))
    with pytest.raises(ValueError, match="not be negative nor all zero"):
        split_states(np.eye(2), n_leaves=1, counts=np.zeros(2))
