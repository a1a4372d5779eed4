"""What varies, and by how much: strides that repeat, that differ by a known amount, and variances in proportion."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.experiment import cut_alike, stride_variability, variance_ratio
from eigenwalker.model import FourierLinearizer
from tests.experiment.judging.styled import styled_walks


@pytest.fixture(scope="module")
def steady():
    """Return a walk whose strides are all the same."""
    walks = make_walkers(2, random_state=0).data
    linearizer = FourierLinearizer().fit(walks)
    return linearizer.inverse_transform(linearizer.transform(walks))[0]


def test_strides_that_repeat_do_not_vary(steady):
    found = stride_variability(steady)
    assert found.motion < 1e-6  # metres, from the resolution of phase
    assert found.duration < 1e-3  # from frames


def test_noise_of_a_known_size_is_found(steady):
    """Slow noise, constant over each stride, of 1 cm: the standard deviation over strides is 1 cm, of 10 strides."""
    random = np.random.default_rng(0)
    strides = np.arange(steady.n_frames) * 10 // steady.n_frames
    shaken = steady.channels + 0.01 * random.normal(size=(10, steady.channels.shape[1]))[strides]
    assert_allclose(stride_variability(steady.with_channels(shaken)).motion, 0.01, rtol=0.25)


def test_more_noise_varies_more():
    calm, wild = (styled_walks(1, bends=(0.0,), noise=noise)[0][0] for noise in (0.005, 0.05))
    assert stride_variability(wild).motion > 3 * stride_variability(calm).motion


def test_a_single_stride_does_not_vary(steady):
    short = cut_alike([steady], duration=1.5 * steady.duration / 10)[0]
    assert np.isnan(stride_variability(replace(short, frequency=10 / steady.duration))).all()


def test_variance_of_walks_that_are_twice_as_large(steady):
    larger = steady.with_channels(steady.channels.mean(axis=0) + 2 * (steady.channels - steady.channels.mean(axis=0)))
    assert_allclose(variance_ratio([larger], [steady], least=0.001), 4.0)
    assert_allclose(variance_ratio([steady, larger], [steady], least=0.001), 2.5)


def test_channels_that_hardly_move_do_not_count(steady):
    assert len(variance_ratio([steady], [steady], least=10.0)) == 0
    moving = np.asarray(steady.channels).std(axis=0) > 0.02
    assert len(variance_ratio([steady], [steady], least=0.02)) == moving.sum()


def test_cut_walks_are_alike_and_in_the_middle(steady):
    other = replace(steady, frame_rate=60.0)
    cut = cut_alike([steady, other], duration=2.0)
    assert [walk.n_frames for walk in cut] == [240, 120]
    start = (steady.n_frames - 240) // 2
    np.testing.assert_array_equal(cut[0].channels, steady.channels[start : start + 240])


def test_the_shortest_sets_the_length(steady):
    short = cut_alike([steady], duration=3.0)[0]
    assert {walk.n_frames for walk in cut_alike([steady, short])} == {short.n_frames}
    assert cut_alike([short], duration=100.0)[0].n_frames == short.n_frames


def test_errors(steady):
    with pytest.raises(ValueError, match="duration must be positive, in seconds, got -1"):
        cut_alike([steady], duration=-1)
    with pytest.raises(WalkError, match="channels"):
        variance_ratio([steady], styled_walks(1)[0])
    with pytest.raises(ValueError, match="at least one walk"):
        variance_ratio([], [steady])
