"""Which states share a transform: a tree of regression classes, from one transform for all down to one a leaf.

Few frames determine one transform, more frames one a class. Down the tree each node's transform has its parent's as the
center of its prior (structural prior); a node with too few frames takes its parent's.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm.transform_blocks import estimate_blocks
from eigenwalker.hsmm.transform_estimation import StandardUnits
from eigenwalker.hsmm.transform_statistics import TransformStatistics, select_classes
from eigenwalker.hsmm.transforms import ChannelTransform, identity_transform

__all__ = ["RegressionTree", "TreeTransforms", "estimate_along_tree", "group_states", "split_states"]

_FEWEST_FRAMES = 55.0  # a class; below, transforms of 50 channels without a prior were worse than none


class RegressionTree(NamedTuple):
    """Classes of states, coarse to fine.

    Attributes
    ----------
    parents : ndarray of int of shape (n_nodes,)
        Parent of each node, which comes before it; -1 for the root, node 0.
    state_nodes : ndarray of int of shape (n_states,)
        Node that each state hangs on, usually a leaf. These are the classes of `accumulate_transform`.
    """

    parents: NDArray[np.int_]
    state_nodes: NDArray[np.int_]


class TreeTransforms(NamedTuple):
    """The transform of each node of a tree.

    Attributes
    ----------
    transforms : tuple of ChannelTransform of length n_nodes
        State s has ``transforms[tree.state_nodes[s]]``.
    sources : ndarray of int of shape (n_nodes,)
        Node whose frames the transform of each node comes from: itself, or an ancestor if it had too few; -1 is the
        identity, if the root had too few.
    n_frames : ndarray of shape (n_nodes,)
        Frames of each node and all below it.
    """

    transforms: tuple[ChannelTransform, ...]
    sources: NDArray[np.int_]
    n_frames: NDArray[np.float64]


def group_states(state_classes: ArrayLike) -> RegressionTree:
    """Return the tree with one leaf for each class under the root, or the root alone for one class.

    Parameters
    ----------
    state_classes : array-like of int of shape (n_states,)
        Class of each state, any whole numbers: side of the body that is in stance, half of the step.

    Returns
    -------
    RegressionTree
        Leaf k + 1 is the k-th class in rising order.

    Raises
    ------
    ValueError
        If there are no states, or classes are not whole numbers.

    Examples
    --------
    >>> group_states([0, 0, 1])
    RegressionTree(parents=array([-1,  0,  0]), state_nodes=array([1, 1, 2]))
    """
    classes = np.asarray(state_classes)
    if classes.ndim != 1 or not len(classes) or classes.dtype.kind not in "iub":
        raise ValueError(f"state_classes must be a whole number for each state, got {classes.tolist()}")
    names, nodes = np.unique(classes, return_inverse=True)
    if len(names) == 1:
        return RegressionTree(np.array([-1]), np.zeros(len(classes), dtype=int))
    return RegressionTree(np.array([-1] + [0] * len(names)), nodes + 1)


def split_states(
    means: ArrayLike, *, n_leaves: int, counts: ArrayLike | None = None, scales: ArrayLike = 1.0
) -> RegressionTree:
    """Return a tree whose leaves are states with means near each other.

    The leaf with the largest sum of squares is split into two, until there are `n_leaves`. It is cut across its longest
    axis at its mean, and states then move to the nearer center until none does.

    Parameters
    ----------
    means : array-like of shape (n_states, n_features)
        Where states are near each other: means of their static channels, or of all features.
    n_leaves : int
        Number of leaves. There are fewer if fewer means differ.
    counts : array-like of shape (n_states,), default None
        Frames of each state, which weigh it. None is equal.
    scales : array-like of shape (n_features,), default 1.0
        What differences are divided by: the features' standard deviations.

    Returns
    -------
    RegressionTree
        Children are numbered in the order of their first states.

    Raises
    ------
    ValueError
        If shapes do not fit, there are fewer than one leaf or more leaves than states, or counts are negative or all
        zero.

    Notes
    -----
    As the splitting of centroids in HTK, but along the axis of largest variance rather than that of a fixed sign in
    all features, so that neither the order nor the sign of channels matters.

    Examples
    --------
    >>> split_states([[0.0], [5.0], [0.2], [9.0]], n_leaves=3)
    RegressionTree(parents=array([-1,  0,  0,  2,  2]), state_nodes=array([1, 3, 1, 4]))
    """
    points, weights = _check_points(means, n_leaves, counts, scales)
    parents, nodes = [-1], np.zeros(len(points), dtype=int)
    for _ in range(n_leaves - 1):
        leaves = np.unique(nodes)
        spreads = [_spread(points[nodes == leaf], weights[nodes == leaf]) for leaf in leaves]
        leaf = leaves[np.argmax(spreads)]
        if max(spreads) <= 1e-24 * float(weights @ (points**2).sum(axis=1)):
            break
        members = np.flatnonzero(nodes == leaf)
        far = _halve(points[members], weights[members])
        nodes[members] = len(parents) + (far != far[0])
        parents += [int(leaf)] * 2
    return RegressionTree(np.array(parents), nodes)


def _check_points(
    means: ArrayLike, n_leaves: int, counts: ArrayLike | None, scales: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    points = np.asarray(means, dtype=np.float64) / np.asarray(scales, dtype=np.float64)
    weights = np.ones(len(points)) if counts is None else np.asarray(counts, dtype=np.float64)
    if points.ndim != 2 or weights.shape != (len(points),):
        raise ValueError(
            "expected means of shape (n_states, n_features) and counts of shape (n_states,), got "
            f"{points.shape} and {weights.shape}"
        )
    if not 1 <= n_leaves <= len(points):
        raise ValueError(f"n_leaves must be from 1 to the number of states, {len(points)}, got {n_leaves}")
    if not ((weights >= 0).all() and weights.sum() > 0):
        raise ValueError(f"counts must not be negative nor all zero, got {weights.tolist()}")
    return points, weights


def _spread(points: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    """Return the weighted sum of squares about the mean; zero where there is no weight."""
    if not weights.any():
        return 0.0
    center = np.average(points, axis=0, weights=weights)
    return float(weights @ ((points - center) ** 2).sum(axis=1))


def _halve(points: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which of two clusters each point is in."""
    deviations = points - np.average(points, axis=0, weights=weights)
    axis = np.linalg.svd(np.sqrt(weights)[:, np.newaxis] * deviations, full_matrices=False)[2][0]
    far = deviations @ axis > 0
    for _ in range(100):
        centers = [np.average(points[side], axis=0, weights=weights[side]) for side in (far, ~far)]
        distances = [((points - center) ** 2).sum(axis=1) for center in centers]
        before, far = far, distances[0] < distances[1]
        if (far == before).all():
            break
    return far


def estimate_along_tree(
    statistics: TransformStatistics,
    tree: RegressionTree,
    *,
    weight: float = 0.0,
    blocks: Sequence[NDArray[np.integer]] | None = None,
    min_frames: float | None = None,
    units: StandardUnits | None = None,
    start: Sequence[ChannelTransform] | None = None,
    max_condition: float = 1e4,
) -> TreeTransforms:
    """Return the transform of each node, each with its parent's as the center of its prior.

    Parameters
    ----------
    statistics : TransformStatistics
        With one class a node, from ``accumulate_transform(..., state_classes=tree.state_nodes, n_classes=n_nodes)``.
        A node has the frames of all nodes below it, too.
    tree : RegressionTree
        From `group_states` or `split_states`.
    weight : float, default 0.0
        Of the prior at every node, see `estimate_transform`. 0 is CMLLR, more is CSMAPLR.
    blocks : sequence of ndarray of int, default None
        Channels that transforms mix with each other, see `estimate_blocks`. None mixes all.
    min_frames : float, default None
        Fewest frames of a node of its own. None is 55, and without a prior at least twice what a row of the transform
        has unknowns, 2 (n_channels + 1), with the channels of the largest block.
    units : StandardUnits, default None
        As of `estimate_transform`.
    start : sequence of ChannelTransform of length n_nodes, default None
        Where each climb starts; None is the center of each prior.
    max_condition : float, default 1e4
        As of `estimate_transform`.

    Returns
    -------
    TreeTransforms

    Raises
    ------
    ValueError
        If the statistics are not those of the tree; as `estimate_transform`.

    References
    ----------
    Yamagishi, Kobayashi, Nakano, Ogata & Isogai 2009, III (structural prior: the estimate of a node is the prior's
    center of its children).

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.hsmm.transform_statistics import accumulate_transform
    >>> tree = group_states([0, 1])
    >>> statistics = accumulate_transform(
    ...     np.array([[1.0], [3.0], [4.0]]), np.eye(2)[[0, 0, 1]], states=[0, 1], means=np.array([[2.0], [2.0]]),
    ...     variances=np.ones((2, 1)), state_classes=tree.state_nodes, n_classes=3, windows=((1.0,),)
    ... )
    >>> estimate_along_tree(statistics, tree, weight=1.0, min_frames=2).sources  # the last class has one frame
    array([0, 1, 0])
    """
    n_nodes, n_channels = len(tree.parents), statistics.linear.shape[1]
    _check_tree(tree, len(statistics.n_frames), start)
    blocks = [np.arange(n_channels)] if blocks is None else blocks
    largest = max(len(block) for block in blocks)
    fewest = min_frames if min_frames is not None else max(_FEWEST_FRAMES, 0 if weight else 2.0 * (largest + 1))
    below = _nodes_below(tree)
    n_frames = below @ statistics.n_frames
    settings: dict[str, Any] = {"weight": weight, "units": units, "max_condition": max_condition}
    transforms: list[ChannelTransform] = []
    sources = np.full(n_nodes, -1)
    for node, parent in enumerate(tree.parents):
        center = identity_transform(n_channels) if parent < 0 else transforms[parent]
        if n_frames[node] >= fewest:
            chosen = select_classes(statistics, np.flatnonzero(below[node]))
            own_start = None if start is None else start[node]
            transforms.append(estimate_blocks(chosen, blocks, center=center, start=own_start, **settings))
            sources[node] = node
        else:
            transforms.append(center)
            sources[node] = sources[parent] if parent >= 0 else -1
    return TreeTransforms(tuple(transforms), sources, n_frames)


def _check_tree(tree: RegressionTree, n_classes: int, start: Sequence | None) -> None:
    n_nodes = len(tree.parents)
    if n_classes != n_nodes or (start is not None and len(start) != n_nodes):
        given = "" if start is None else f" and a start for {len(start)}"
        raise ValueError(f"expected statistics of one class for each of {n_nodes} nodes, got {n_classes}{given}")
    if tree.parents[0] != -1 or not all(0 <= parent < node for node, parent in enumerate(tree.parents) if node):
        raise ValueError(f"parents must come before their children, the root first as -1, got {tree.parents.tolist()}")


def _nodes_below(tree: RegressionTree) -> NDArray[np.float64]:
    """Return ones where a node (row) is another (column) or above it: (n_nodes, n_nodes)."""
    below = np.eye(len(tree.parents))
    for node in range(len(tree.parents) - 1, 0, -1):
        below[tree.parents[node]] += below[node]
    return below
