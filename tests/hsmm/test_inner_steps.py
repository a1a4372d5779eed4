"""Steps out of the middle of walks: which they are, where they lie, and too short walks."""

import numpy as np
import pytest

from eigenwalker import WalkError
from eigenwalker.hsmm import GaitHSMM, cut_inner_steps, label_steps
from tests.hsmm.walking import shaken_walk, shaken_walks


@pytest.fixture(scope="module")
def walk():
    return shaken_walk(n_frames=480)


def test_all_inner_steps(walk):
    steps, inner = label_steps(walk), cut_inner_steps(walk)
    assert inner.labels == steps.labels[2:-2]
    np.testing.assert_array_equal(inner.walk.channels, walk.channels[steps.boundaries[2] : steps.boundaries[-3]])


@pytest.mark.parametrize("n_steps", [1, 2, 3])
def test_some_of_the_middle(walk, n_steps):
    everything, some = cut_inner_steps(walk), cut_inner_steps(walk, n_steps)
    start = (len(everything.labels) - n_steps) // 2
    assert some.labels == everything.labels[start : start + n_steps]
    assert some.walk.n_frames < everything.walk.n_frames


def test_gait_models_take_them():
    walks = shaken_walks(4, n_frames=480)
    model = GaitHSMM(max_iter=2).fit(walks)
    pieces, labels = zip(*[cut_inner_steps(walk, 3) for walk in walks], strict=True)
    assert np.isfinite(model.adapt(pieces, labels, method="map", map_weight=10.0).score(pieces, labels))


def test_errors(walk):
    with pytest.raises(WalkError, match="walk 'walk 0': expected 50 steps or more"):
        cut_inner_steps(walk, 50)
    with pytest.raises(ValueError, match="n_steps must be 1 or more, or None, got 0"):
        cut_inner_steps(walk, 0)
