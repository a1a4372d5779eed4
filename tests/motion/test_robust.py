"""The harmonic series that jumps of a marker do not disturb."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from eigenwalker.model import FourierLinearizer
from eigenwalker.motion import TROJE15, fit_harmonics, fit_harmonics_robust
from tests.synthetic import make_walk

FREQUENCY = 0.93
MARKER = TROJE15.index("left_wrist")
CHANNELS = slice(3 * MARKER, 3 * MARKER + 3)


def _noisy(seed, *, n_cycles=6.0, noise=0.005):
    """Return channels at 60 frames a second, and their true coefficients."""
    walk, coefficients = make_walk(
        np.random.default_rng(seed), frequency=FREQUENCY, n_cycles=n_cycles, frame_rate=60.0, noise=noise
    )
    return walk.channels.copy(), coefficients


def _fit(channels):
    return fit_harmonics_robust(channels, 60.0, FREQUENCY, 2)


def test_clean_walks_are_fitted_as_by_least_squares():
    channels, coefficients = _noisy(0, noise=0.0)
    fitted, weights = _fit(channels)
    assert_allclose(fitted, coefficients, atol=1e-10)
    assert_allclose(weights, 1.0, atol=1e-6)


def test_efficiency_is_that_of_the_docstring():
    """In normal noise the variance is that of least squares over 0.95; from 60 walks of 45 channels it is known to 1 %.

    The true coefficients are known, and the errors of both fits belong to the same noise.
    """
    errors = np.zeros(2)
    for seed in range(60):
        channels, coefficients = _noisy(seed)
        for place, fitted in enumerate((fit_harmonics(channels, 60.0, FREQUENCY, 2), _fit(channels)[0])):
            errors[place] += ((fitted - coefficients) ** 2).sum()
    assert errors[0] / errors[1] == pytest.approx(0.95, abs=0.015)


@given(
    seed=st.integers(0, 1000),
    share=st.floats(0.02, 0.3),
    size=st.sampled_from([0.05, 0.3, 3.0]),
    kind=st.sampled_from(["jumps", "away", "frozen"]),
)
@settings(max_examples=40)
def test_outlying_frames_of_a_marker_do_not_count(seed, share, size, kind):
    """Jumps scattered over the frames, a stretch elsewhere, and a marker that hangs: up to 30 % of six strides.

    The error stays at what fewer frames of the same noise give, 5 mm sqrt(2 / 270) = 0.4 mm a coefficient.
    """
    channels, coefficients = _noisy(seed)
    rng = np.random.default_rng(seed)
    n_bad = round(share * len(channels))
    first = rng.integers(len(channels) - n_bad)
    bad = rng.choice(len(channels), n_bad, replace=False) if kind == "jumps" else np.arange(first, first + n_bad)
    if kind == "frozen":
        channels[bad, CHANNELS] = channels[first, CHANNELS] + size
    else:
        channels[bad, CHANNELS] += size * rng.normal(size=(n_bad if kind == "jumps" else 1, 3)) + size
    fitted, weights = _fit(channels)
    assert np.abs(fitted - coefficients).max() < 0.003
    assert weights.min() >= 0
    assert weights.max() <= 1
    if size >= 0.3:
        assert weights[bad, MARKER].max() < 0.1


def test_other_markers_lose_nothing():
    channels, _ = _noisy(1)
    before = _fit(channels)[0]
    channels[100:150, CHANNELS] += 1.0
    after = _fit(channels)[0]
    changed = np.abs(after - before).max(axis=0) > 1e-12
    assert set(np.flatnonzero(changed)) <= set(range(CHANNELS.start, CHANNELS.stop))


def test_axes_and_units_change_nothing():
    """Distances are those in space: turning a marker about any axis turns its coefficients; millimeters are as good."""
    channels, _ = _noisy(2)
    channels[40:60, CHANNELS] += [0.3, -0.2, 0.1]
    rotation = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    fitted, weights = _fit(channels)
    turned, same = _fit((channels.reshape(-1, 15, 3) @ rotation).reshape(channels.shape))
    assert_allclose(turned.reshape(5, 15, 3), fitted.reshape(5, 15, 3) @ rotation, atol=1e-8)
    assert_allclose(same, weights, atol=1e-6)
    assert_allclose(_fit(1000 * channels)[0], 1000 * fitted, atol=1e-5)


def test_a_marker_that_does_not_move_is_met():
    channels, _ = _noisy(3)
    channels[:, CHANNELS] = [0.2, -0.3, 1.0]
    fitted, weights = _fit(channels)
    assert_allclose(fitted[:, CHANNELS], [[0.2, -0.3, 1.0], *[[0, 0, 0]] * 4], atol=1e-12)
    assert_allclose(weights[:, MARKER], 1.0)


def test_channels_come_in_threes():
    with pytest.raises(ValueError, match="expected three channels a marker, got 44 channels"):
        _fit(_noisy(0)[0][:, :44])


def test_the_linearizer_takes_it():
    """Jumps that spoil the ordinary features leave the robust ones; a walk made from features has these features."""
    rng = np.random.default_rng(4)
    walk, _ = make_walk(rng, frequency=FREQUENCY, n_cycles=8, frame_rate=60.0, noise=0.003)
    channels = walk.channels.copy()
    channels[rng.choice(len(channels), 60, replace=False), CHANNELS] += [0.4, 0.3, -0.2]
    spoiled = walk.with_channels(channels)
    plain, robust = (FourierLinearizer(robust=flag).fit([walk]) for flag in (False, True))
    wanted = plain.transform([walk])
    assert np.abs(plain.transform([spoiled]) - wanted).max() > 0.02
    assert np.abs(robust.transform([spoiled]) - wanted).max() < 0.003
    vectors = robust.transform([spoiled])
    assert_allclose(robust.transform(robust.inverse_transform(vectors)), vectors, atol=1e-9)
