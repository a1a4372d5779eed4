"""Strides that differ: as much as in recordings, smoothly, and only if asked."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import WalkError, make_walkers
from eigenwalker.motion import MarkerSet, StrideVariation, evaluate_harmonics
from eigenwalker.motion.stride_statistics import lag_one_correlation
from tests.recorded import bandai_joints, style
from tests.synthetic import body_coefficients
from tests.varying_strides import make_varying_walk

_FREQUENCY = 0.93


def _recordings(rng, coefficients, n_walks=8, **options):
    return [make_varying_walk(rng, coefficients, frequency=_FREQUENCY, **options)[0] for _ in range(n_walks)]


@pytest.fixture(scope="module")
def learned():
    rng = np.random.default_rng(0)
    coefficients = body_coefficients(rng)[:5]
    walks = _recordings(rng, coefficients)
    return StrideVariation.from_walks(walks), coefficients, walks


def _generate(variation, coefficients, walk, *, n_strides, seed, **options):
    """Return a walk that starts at phase zero, and has so many strides and a bit."""
    times = np.arange(0, (n_strides + 0.2) / _FREQUENCY, 1 / 60)
    channels = variation.series(coefficients, _FREQUENCY, times, random_state=seed, **options)
    return walk.with_channels(channels, frame_rate=60.0)


def test_learns_the_spread_that_was_put_in():
    """SD of the coefficients is 4 % of their amplitude, of mean postures 4 mm, of durations 2 %; about 80 strides."""
    rng = np.random.default_rng(1)
    coefficients = body_coefficients(rng)[:5]
    variation = StrideVariation.from_walks(_recordings(rng, coefficients))
    amplitudes = np.repeat(np.hypot(coefficients[1::2], coefficients[2::2]), 2, axis=0)
    expected = 0.04 * np.vstack((np.full((1, 45), 0.1), amplitudes))
    ratios = variation.coefficient_sd**2 / expected**2
    assert_allclose(np.sqrt(np.median(ratios, axis=1)), 1, atol=0.15)  # the SD of an SD of 80 strides is 8 %
    assert variation.duration_sd == pytest.approx(0.02, rel=0.25)
    assert abs(variation.correlation) < 0.1  # they were independent
    assert variation.n_harmonics == 2


def test_generated_strides_spread_as_much_as_recorded_ones(learned):
    """200 strides: an SD of one coefficient is known to 5 %, that of all of them together better."""
    variation, coefficients, walks = learned
    generated = [_generate(variation, coefficients, walks[0], n_strides=25, seed=seed) for seed in range(8)]
    found = StrideVariation.from_walks(generated)
    assert len(found.deviations) >= 8 * 24
    ratios = np.sqrt((found.coefficient_sd**2).mean(axis=1) / (variation.coefficient_sd**2).mean(axis=1))
    assert_allclose(ratios, 1, atol=0.12)
    assert found.duration_sd == pytest.approx(variation.duration_sd, rel=0.15)
    assert found.correlation == pytest.approx(variation.correlation, abs=0.15)


def test_the_mean_stays(learned):
    """Over 400 strides, within four standard errors: 4 SD / sqrt(400)."""
    variation, coefficients, walks = learned
    long = _generate(variation, coefficients, walks[0], n_strides=400, seed=3)
    assert_allclose(long.channels.mean(axis=0), coefficients[0], atol=0.2 * variation.coefficient_sd[0].max())


def test_without_scale_it_is_the_periodic_walk(learned):
    variation, coefficients, _ = learned
    times = np.linspace(0, 5, 301)
    periodic = evaluate_harmonics(coefficients, _FREQUENCY, times)
    assert_array_equal(variation.series(coefficients, _FREQUENCY, times, scale=0, random_state=0), periodic)
    little = variation.series(coefficients, _FREQUENCY, times, scale=1e-9, random_state=0)
    assert_allclose(little, periodic, atol=1e-8)


def test_the_same_seed_gives_the_same_strides_and_longer_walks_start_alike(learned):
    variation, coefficients, _ = learned
    times = np.linspace(0, 8, 481)
    once = variation.series(coefficients, _FREQUENCY, times, random_state=5)
    assert_array_equal(once, variation.series(coefficients, _FREQUENCY, times, random_state=5))
    assert_array_equal(once, variation.series(coefficients, _FREQUENCY, times, random_state=np.random.RandomState(5)))
    assert np.abs(once - variation.series(coefficients, _FREQUENCY, times, random_state=6)).max() > 1e-3
    short = variation.series(coefficients, _FREQUENCY, times[:200], random_state=5)
    assert_allclose(once[:200], short, atol=1e-9)


def test_velocity_and_acceleration_have_no_steps(learned):
    """At 1200 frames a second a step of the second derivative would be seen beside the periodic walk's."""
    variation, coefficients, _ = learned
    times = np.arange(0, 20, 1 / 1200)
    varied = variation.series(coefficients, _FREQUENCY, times, scale=2, random_state=1)
    periodic = evaluate_harmonics(coefficients, _FREQUENCY, times)
    for order, factor in ((2, 2.0), (3, 8.0)):  # blends over 0.4 of a stride are faster than harmonics
        assert np.abs(np.diff(varied, order, axis=0)).max() < factor * np.abs(np.diff(periodic, order, axis=0)).max()


def test_recorded_styles_have_their_variation(data_dir):
    walks = [walk for walk in bandai_joints(data_dir, 5) if style(walk) == "normal"]
    variation = StrideVariation.from_walks(walks)
    assert variation.coefficient_sd.shape == (5, len(walks[0].channel_names))
    assert 0.1 < np.rad2deg(np.sqrt((variation.coefficient_sd**2).mean())) < 3
    assert 0.005 < variation.duration_sd < 0.06


def test_alternating_and_persistent_strides_are_told_apart():
    """Deviations from the mean of five strides are correlated by -0.2 if strides are not; that is made up for."""
    rng = np.random.default_rng(2)
    for truth in (-0.4, 0.0, 0.5):
        blocks = []
        for _ in range(400):
            strides = rng.normal(size=(5, 10))
            for stride in range(1, 5):
                strides[stride] = truth * strides[stride - 1] + np.sqrt(1 - truth**2) * strides[stride]
            blocks.append(strides - strides.mean(axis=0))
        assert lag_one_correlation(blocks) == pytest.approx(truth, abs=0.04)


def test_joints_that_go_together_stay_together(learned):
    """What is linear in all recorded strides is so in all that are made, as where a rig shares a bend among joints."""
    _, coefficients, walks = learned
    coupled = [_couple(walk.channels) for walk in walks[:2]]
    variation = StrideVariation.from_walks(
        [walk.with_channels(channels) for walk, channels in zip(walks[:2], coupled, strict=True)]
    )
    made = variation.series(_couple(coefficients), _FREQUENCY, np.linspace(0, 9, 500), random_state=0)
    assert_allclose(made[:, 7], 2 * made[:, 4] - made[:, 5], atol=1e-9)


def _couple(channels):
    coupled = np.array(channels)
    coupled[:, 7] = 2 * coupled[:, 4] - coupled[:, 5]
    return coupled


def test_pickles(learned):
    variation = pickle.loads(pickle.dumps(learned[0]))
    assert_array_equal(variation.deviations, learned[0].deviations)
    assert not variation.deviations.flags.writeable


def test_a_walk_without_variation_has_none():
    walk = make_walkers(1, random_state=0).data[0]
    steady = walk.with_channels(
        evaluate_harmonics(body_coefficients(np.random.default_rng(0))[:5], 1.0, np.arange(600) / 120)
    )
    variation = StrideVariation.from_walks([replace(steady, frame_rate=120.0)])
    assert variation.coefficient_sd.max() < 1e-6
    assert variation.duration_sd < 1e-6


def test_refuses_what_it_cannot_learn_from_or_vary(learned):
    variation, coefficients, walks = learned
    short = walks[0].with_channels(walks[0].channels[:75])
    with pytest.raises(WalkError, match="at least two whole strides in a walk"):
        StrideVariation.from_walks([short])
    headless = replace(
        walks[0], positions=walks[0].positions[:, 1:], marker_set=MarkerSet(walks[0].marker_set.names[1:])
    )
    with pytest.raises(WalkError, match="channels of the first walk"):
        StrideVariation.from_walks([walks[0], headless])
    with pytest.raises(WalkError, match="at least 81 frames a stride for 40 harmonics"):
        StrideVariation.from_walks(walks, n_harmonics=40)
    with pytest.raises(ValueError, match=r"shape \(5, 45\).*got \(3, 45\); learn it with"):
        variation.series(coefficients[:3], 1.0, [0.0])
    with pytest.raises(ValueError, match="from 0 on"):
        variation.series(coefficients, 1.0, [-1.0, 0.0])
    with pytest.raises(ValueError, match="frequency must be positive"):
        variation.series(coefficients, 0.0, [0.0])
    with pytest.raises(ValueError, match="scale must be 0 or more"):
        variation.series(coefficients, 1.0, [0.0], scale=-1)
    with pytest.raises(ValueError, match="correlation must be between"):
        replace(variation, correlation=1.0)
    with pytest.raises(ValueError, match="deviations must be finite"):
        replace(variation, deviations=variation.deviations[:, 1:])
