"""Which foot stands, and where it carries the body."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.signal import find_peaks
from scipy.spatial.transform import Rotation

from eigenwalker.motion.support import (
    Stance,
    _prominent_peaks,
    find_stances,
    find_support,
    smooth_step,
    standing_points,
)


def _difference(n_frames=200, *, stride=60.0, shift=0.0, reach=0.5, second=0.0):
    """Return left minus right ankle, which is largest at `shift` frames, then every stride."""
    phase = 2 * np.pi * (np.arange(n_frames) - shift) / stride
    return reach * np.cos(phase) + second * np.sin(3 * phase)


def _times(stances):
    return np.array([stance.start for stance in stances[1:]])


@given(shift=st.floats(5.0, 25.0), stride=st.floats(30.0, 90.0))
def test_hand_overs_are_between_frames_where_the_peaks_are(shift, stride):
    """A parabola through three samples of a cosine misses its top by less than 1/200 of a frame."""
    stances, stride_found = find_stances(_difference(stride=stride, shift=shift))
    expected = np.arange(shift - stride, 200.0, stride / 2)
    expected = expected[(expected > 0.6) & (expected < 198.4)]
    found = _times(stances)
    inside = found[(found > 0.6) & (found < 198.4)]
    assert_allclose(inside, expected, atol=5e-3)
    assert_allclose(stride_found, stride, rtol=1e-3)


def test_the_foot_ahead_takes_over_and_feet_alternate():
    stances, stride = find_stances(_difference(shift=20.0))
    assert [stance.foot for stance in stances] == [1, 0, 1, 0, 1, 0, 1]
    assert stances[0].start == -np.inf
    assert stances[-1].end == np.inf
    for one, following in itertools.pairwise(stances):
        assert one.end == following.start
    assert_allclose(stride, 60.0, rtol=1e-3)
    right, _ = find_stances(-_difference(shift=20.0))
    assert [stance.foot for stance in right] == [0, 1, 0, 1, 0, 1, 0]
    assert_allclose(_times(right), _times(stances))


@given(seed=st.integers(0, 10_000))
def test_noise_makes_no_steps(seed):
    noise = np.random.default_rng(seed).normal(scale=0.01, size=200)
    stances, stride = find_stances(_difference(shift=20.0) + noise)
    times = _times(stances)  # at the very ends, beyond which there is a top as well, noise may be one
    inside = times[(times > 10) & (times < 190)]
    assert_allclose(inside, [20, 50, 80, 110, 140, 170], atol=6)  # the top of a cosine is flat
    assert_allclose(stride, 60.0, atol=6)


def test_two_peaks_of_one_foot_are_one_step():
    """A foot that hesitates while it swings takes over once, at first."""
    signal = _difference(shift=20.0)
    signal[75:85] -= 0.3 * np.hanning(10)
    stances, _ = find_stances(signal)
    assert [stance.foot for stance in stances] == [1, 0, 1, 0, 1, 0, 1]


def test_who_stands_takes_no_step():
    still = [Stance(0, -np.inf, np.inf)]
    for signal in (np.zeros(5), 0.02 * _difference(), np.full(3, 0.4)):
        assert find_stances(signal) == (still, float(len(signal)))


def test_half_a_step_has_one_stance():
    """Left swings ahead, so right stands; and the other way round."""
    for sign, foot in ((1.0, 1), (-1.0, 0)):
        assert find_stances(sign * np.linspace(-0.3, 0.3, 20)) == ([Stance(foot, -np.inf, np.inf)], 20.0)


@pytest.mark.parametrize("shift", [1.0, 2.3, 38.0])
def test_hand_overs_near_the_ends_are_found(shift):
    stances, _ = find_stances(_difference(41, shift=shift))
    assert np.abs(_times(stances) - shift).min() < 5e-3


def test_one_hand_over_is_one_step():
    stances, stride = find_stances(_difference(41, shift=20.0))
    assert [stance.foot for stance in stances] == [1, 0]
    assert_allclose(_times(stances), 20.0)
    assert stride == 41.0


def _sole(n_frames=1, *, pitch=0.0, place=(0.0, 0.0, -0.9)):
    """Return heel, ball and tip of both feet, 5 cm behind and 12 and 18 cm ahead of a place, pitched up."""
    points = np.array([[-0.05, 0, 0], [0.12, 0, 0], [0.18, 0, 0]])
    turned = Rotation.from_rotvec(np.outer(np.broadcast_to(-np.asarray(pitch), n_frames), [0.0, 1.0, 0.0])).as_matrix()
    feet = np.einsum("tij,pj->tpi", turned, points) + np.reshape(place, (-1, 1, 3))
    return np.repeat(feet[:, np.newaxis], 2, axis=1)


@pytest.mark.parametrize(("pitch", "point"), [(0.3, 0), (-0.3, 2)])
def test_a_foot_on_its_heel_or_tip_is_carried_by_it(pitch, point):
    """Of a foot that stands and turns about any axis, that point stays."""
    place = np.linspace([0.3, 0.1, -0.9], [-0.3, 0.12, -0.8], 20)
    soles = _sole(20, pitch=pitch + np.linspace(0, 0.1, 20), place=place)
    support = find_support(soles)
    assert_allclose(support.advance, -np.diff(soles[:, :, point, :2], axis=0), atol=1e-12)
    # Its height is the softer one: at 0.3 the ball is 1.8 cm over the tip, three times 6 mm.
    assert_allclose(support.height, -soles[:, :, point, 2], atol=2e-3)


def test_a_flat_foot_lies_on_the_floor():
    soles = _sole(2, place=np.array([[0.3, 0.1, -0.9], [0.2, 0.1, -0.9]]))
    support = find_support(soles)
    assert_allclose(support.height, 0.9)
    assert_allclose(support.advance, [[[0.1, 0.0]] * 2])
    assert_allclose(support.lowest, -0.9)
    assert_allclose(standing_points(soles), soles.mean(axis=2))


def test_rolling_over_from_heel_to_tip_never_slides():
    """The shares pass from point to point while the foot is within hundredths of a millimeter of flat."""
    pitch = np.linspace(0.3, -0.3, 2001)
    soles = _sole(2001, pitch=pitch)
    advance = find_support(soles).advance[:, 0]
    lowest = soles[:-1, 0, :, 2].argmin(axis=1)
    true = -np.diff(soles[:, 0, :, :2], axis=0)[np.arange(2000), lowest]
    assert np.abs(advance - true).sum() < 1e-4  # metres, all the way
    assert (-find_support(soles).height[:, 0] - soles[:, 0, :, 2].min(axis=1)).max() < 0.003
    assert (-find_support(soles).height[:, 0] >= soles[:, 0, :, 2].min(axis=1)).all()


@given(seed=st.integers(0, 1000))
def test_feet_stand_on_their_lowest_point_or_between_two_that_are_as_low(seed):
    soles = np.random.default_rng(seed).normal(scale=10.0 ** (seed % 7 - 4), size=(5, 2, 3, 3))
    points = standing_points(soles)
    assert (points >= soles.min(axis=2) - 1e-12).all()
    assert (points <= soles.max(axis=2) + 1e-12).all()
    over = points[..., 2] - soles[..., 2].min(axis=2)
    assert over.max() < 2e-5  # the height over which the floor passes from point to point
    apart = np.sort(soles[..., 2], axis=2)
    clear = apart[..., 1] - apart[..., 0] > 1e-3
    lowest = np.take_along_axis(soles, soles[..., 2].argmin(axis=2)[..., None, None], axis=2)[:, :, 0]
    assert_allclose(points[clear], lowest[clear], atol=1e-12)
    assert_allclose(standing_points(soles + 900.0) - 900.0, points, atol=1e-6)  # digits that 900 m leave


@given(seed=st.integers(0, 10_000))
def test_hand_overs_are_the_prominent_peaks_of_scipy(seed):
    rng = np.random.default_rng(seed)
    signal = np.round(_difference(150, shift=rng.uniform(0, 60)) + rng.normal(scale=0.2, size=150), 1)  # with plateaus
    for values in (signal, -signal):
        padded = np.pad(values, 1, constant_values=-np.inf)
        expected = find_peaks(padded, prominence=0.25)[0] - 1
        expected = expected[(expected > 0) & (expected < 149)]
        assert _prominent_peaks(values, 0.25).tolist() == expected.tolist()


def test_smooth_steps_are_smooth():
    x = np.linspace(-1, 2, 3001)
    y = smooth_step(x)
    assert_allclose(y[x <= 0], 0.0)
    assert_allclose(y[x >= 1], 1.0)
    assert_allclose(y + y[::-1], 1.0)
    assert np.abs(np.diff(y, 3)).max() < 61e-9  # 60 is the largest third derivative
    assert (np.diff(y) >= 0).all()
