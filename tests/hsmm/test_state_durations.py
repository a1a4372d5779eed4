import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.state_durations import mean_durations, sample_durations

means_of_states = st.lists(st.floats(0.2, 30), min_size=1, max_size=30)


def _variances(means):
    return np.random.default_rng(len(means)).uniform(0.1, 9, len(means))


@given(means=means_of_states, longer=st.integers(0, 400))
def test_sum_is_the_length_asked_for(means, longer):
    durations = mean_durations(means, _variances(means), n_frames=len(means) + longer)
    assert durations.sum() == len(means) + longer
    assert durations.min() >= 1


@given(means=st.lists(st.floats(1, 30), min_size=1, max_size=200))
def test_ends_are_within_half_a_frame(means):
    """The remainder is carried: rounding errors do not add up over the walk."""
    ends = np.cumsum(mean_durations(means, np.ones(len(means))))
    assert np.abs(ends - np.cumsum(means)).max() <= 0.5 + 1e-6


def test_carrying_by_hand():
    """2.4 leaves 0.4 behind, 2.8 is 3 and takes 0.2 in advance, 2.2 is 2, 2.6 is 3, 2.0 is 2."""
    assert mean_durations([2.4] * 5, [1.0] * 5).tolist() == [2, 3, 2, 3, 2]
    assert np.round([2.4] * 5).sum() == 10  # without, the walk would lose half a second a minute


def test_whole_means_stay():
    means = np.random.default_rng(0).integers(1, 20, 100)
    assert np.array_equal(mean_durations(means, np.ones(100)), means)


def test_change_is_shared_by_variance():
    """rho = (50 - 40) / (1 + 2 + 3 + 4) = 1."""
    assert mean_durations([10.0] * 4, [1.0, 2.0, 3.0, 4.0], n_frames=50).tolist() == [11, 12, 13, 14]
    assert mean_durations([10.0] * 4, [1.0, 2.0, 3.0, 4.0], speed=0.8).tolist() == [11, 12, 13, 14]


def test_no_state_falls_below_a_frame():
    """The second would last -2 frames at rho = -6; with it at 1 the other gives up the rest."""
    assert mean_durations([10.0, 4.0], [1.0, 1.0], n_frames=2).tolist() == [1, 1]
    assert mean_durations([10.0, 4.0], [1.0, 4.0], n_frames=8).tolist() == [7, 1]


@pytest.mark.parametrize("speed", [0.5, 1.0, 1.6])
def test_drawn_durations_follow_the_model(speed):
    """Shares of 20,000 draws, within 5 standard errors; at another speed the mean is as for mean durations."""
    means, variances = np.full(20_000, 8.0), np.full(20_000, 3.0)
    drawn = sample_durations(means, variances, speed=speed, random_state=0)
    shares = np.exp(log_durations([8.0 / speed], [3.0]))[0]
    counts = np.bincount(drawn, minlength=len(shares) + 1)[1:]
    assert len(counts) == len(shares)
    assert (np.abs(counts / 20_000 - shares) <= 5 * np.sqrt(shares / 20_000) + 1e-12).all()
    assert drawn.mean() == pytest.approx(8.0 / speed, abs=0.1)


def test_seeds():
    means, variances = np.full(50, 8.0), np.full(50, 3.0)
    first, again, other = (sample_durations(means, variances, random_state=seed) for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_drawn_durations_are_a_frame_at_least():
    assert sample_durations(np.full(1000, 0.5), np.full(1000, 4.0), random_state=0).min() == 1


def test_faults_are_named():
    with pytest.raises(ValueError, match=r"shape \(n_states,\) of at least one state, got \(0,\)"):
        mean_durations([], [])
    with pytest.raises(ValueError, match=r"got \(2,\) and \(1,\)"):
        sample_durations([1.0, 2.0], [1.0])
    with pytest.raises(ValueError, match="positive, finite means and variances"):
        mean_durations([1.0, 2.0], [1.0, 0.0])
    with pytest.raises(ValueError, match="n_frames must be at least one a state, 2, got 1"):
        mean_durations([1.0, 2.0], [1.0, 1.0], n_frames=1)
    with pytest.raises(ValueError, match="expected n_frames or speed, got both"):
        mean_durations([1.0, 2.0], [1.0, 1.0], n_frames=5, speed=2.0)
    for function in (mean_durations, sample_durations):
        with pytest.raises(ValueError, match="speed must be positive and finite, got 0"):
            function([1.0, 2.0], [1.0, 1.0], speed=0)
