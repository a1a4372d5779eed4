"""Walks as vectors, and back."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import FourierLinearizer, WalkError
from eigenwalker.motion import TROJE15, MarkerSet, Walk, mirror_walk
from tests import contract
from tests.joint_bodies import swinging
from tests.synthetic import make_walk


def _walks(n=3, **options):
    return [make_walk(np.random.default_rng(seed), name=f"walk {seed}", **options)[0] for seed in range(n)]


@settings(deadline=None, max_examples=25)
@given(
    seed=st.integers(0, 10_000),
    phase=st.floats(0, 6.2),
    n_harmonics=st.integers(1, 4),
    frequency=st.floats(0.7, 1.3),
    frame_rate=st.sampled_from([30.0, 60.0, 120.0]),
)
def test_band_limited_walks_come_back(seed, phase, n_harmonics, frequency, frame_rate):
    """Walk -> vector -> walk, after undoing the time shift."""
    rng = np.random.default_rng(seed)
    walk, coefficients = make_walk(
        rng, n_harmonics=n_harmonics, frequency=frequency, frame_rate=frame_rate, phase=phase
    )
    linearizer = FourierLinearizer(n_harmonics, n_cycles=5, frame_rate=frame_rate)
    vector = linearizer.fit_transform([walk])[0]
    assert_allclose(vector, [*coefficients.ravel(), frequency], atol=1e-9)
    (back,) = linearizer.inverse_transform([vector])
    aligned, _ = make_walk(
        np.random.default_rng(seed), n_harmonics=n_harmonics, frequency=frequency, frame_rate=frame_rate
    )
    assert back.n_frames == aligned.n_frames
    assert_allclose(back.positions, aligned.positions, atol=1e-9)


def test_names_say_what_the_columns_are():
    walk, coefficients = make_walk(np.random.default_rng(1), speed=1.4)
    linearizer = FourierLinearizer(extras=("speed", "size")).fit([walk])
    names = list(linearizer.get_feature_names_out())
    vector = linearizer.transform([walk])[0]
    assert len(names) == 228
    assert_allclose(vector[names.index("mean_head_z")], walk.marker("head")[:, 2].mean(), atol=0.02)
    channel = walk.channel_names.index("right_knee_y")
    assert_allclose(vector[names.index("sin2_right_knee_y")], coefficients[3, channel], atol=1e-9)
    assert_allclose(vector[names.index("cos1_right_knee_y")], coefficients[2, channel], atol=1e-9)
    assert names[-3:] == ["frequency", "speed", "size"]
    assert_allclose(vector[-3:], [0.93, 1.4, 1.0])
    assert linearizer.inverse_transform([vector])[0].speed == 1.4


def test_time_zero_changes_nothing():
    walk, _ = make_walk(np.random.default_rng(0), n_cycles=6)
    late = replace(walk, positions=walk.positions[97:])
    vectors = FourierLinearizer().fit_transform([walk, late])
    assert_allclose(vectors[0], vectors[1], atol=1e-9)


def test_marker_order_changes_nothing_but_columns():
    walk, _ = make_walk(np.random.default_rng(0), noise=0.003)
    order = np.random.default_rng(1).permutation(15)
    shuffled = Walk(walk.positions[:, order], 120, MarkerSet(tuple(TROJE15.names[i] for i in order)))
    one, other = (FourierLinearizer().set_output(transform="pandas").fit_transform([w]) for w in (walk, shuffled))
    assert_allclose(other[one.columns], one, atol=1e-9)


def test_mirroring_permutes_and_signs():
    """A mirrored walk is half a cycle later: y and the odd harmonics change sign, the sides change places."""
    walk, _ = make_walk(np.random.default_rng(0), noise=0.003)
    plain, mirrored = (FourierLinearizer().fit_transform([w])[0] for w in (walk, mirror_walk(walk)))
    blocks = plain[:-1].reshape(5, 15, 3)[:, TROJE15.mirror]
    expected = blocks * np.array([1, -1, 1]) * np.array([1, -1, -1, 1, 1])[:, np.newaxis, np.newaxis]
    assert_allclose(mirrored[:-1].reshape(5, 15, 3), expected, atol=1e-8)
    assert_allclose(mirrored[-1], plain[-1], atol=1e-9)


def test_a_given_phase_reference_is_used():
    walk, _ = make_walk(np.random.default_rng(0))
    linearizer = FourierLinearizer(phase_reference={"right_ankle_x": 1.0})
    table = linearizer.set_output(transform="pandas").fit_transform([walk])
    assert abs(table["sin1_right_ankle_x"].item()) < 1e-12
    assert table["cos1_right_ankle_x"].item() > 0


def test_a_known_frequency_is_taken_and_no_other_looked_for():
    walk, coefficients = make_walk(np.random.default_rng(0), n_cycles=1, frequency=0.93, noise=0.01)
    linearizer = FourierLinearizer().fit([walk])
    (searched,), (known,) = (linearizer.transform([item]) for item in (walk, replace(walk, frequency=0.93)))
    assert known[-1] == 0.93
    assert searched[-1] != known[-1]
    assert_allclose(known[:-1], coefficients.ravel(), atol=0.01)


def test_residual_power_is_what_the_harmonics_leave():
    clean, noisy = make_walk(np.random.default_rng(0))[0], make_walk(np.random.default_rng(0), noise=0.05)[0]
    powers = FourierLinearizer().fit([clean]).residual_power([clean, noisy])
    assert powers[0] < 1e-12
    about = noisy.channels - noisy.channels.mean(axis=0)
    assert_allclose(powers[1], 0.05**2 / np.mean(about**2), rtol=0.1)


def test_low_power_warns_and_names_the_walk():
    walk, _ = make_walk(np.random.default_rng(0), noise=0.3, name="anna")
    with pytest.warns(UserWarning, match="less than 50% of the motion in 1 of 1 walks: 'anna'"):
        FourierLinearizer().fit_transform([walk])


def _gap(walk):
    positions = walk.positions.copy()
    positions[3, 2] = np.nan
    return replace(walk, positions=positions)


@pytest.mark.parametrize(
    ("spoil", "options", "message"),
    [
        (_gap, {}, "'walk 0'.*3 NaN or infinite ones in left_shoulder_x"),
        (lambda walk: replace(walk, positions=walk.positions[:60]), {}, "at least one stride|periodic part"),
        (lambda walk: replace(walk, positions=np.zeros((500, 15, 3))), {}, "too weak to carry a phase"),
        (lambda walk: walk, {"extras": ("speed",)}, "'walk 0': its speed must be known"),
        (lambda walk: walk, {"phase_reference": {"tail_x": 1.0}}, "no channel tail_x for the phase reference"),
    ],
)
def test_unusable_walks_are_refused(spoil, options, message):
    walk = spoil(_walks(1)[0])
    with pytest.raises(WalkError, match=message):
        FourierLinearizer(**options).fit([walk]).transform([walk])


def test_different_markers_are_refused():
    walk = _walks(1)[0]
    feet = Walk(walk.positions[:, -4:], 120, MarkerSet(TROJE15.names[-4:]), "feet")
    message = "'feet': expected the 45 channels.*got 12; missing: head_x, .*one marker set"
    with pytest.raises(WalkError, match=message):
        FourierLinearizer().fit([walk, feet])
    with pytest.raises(WalkError, match=message):
        FourierLinearizer().fit([walk]).transform([walk, feet])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"n_harmonics": 0}, "n_harmonics must be a whole number of at least 1, got 0"),
        ({"n_harmonics": 1.5}, "n_harmonics must be a whole number"),
        ({"extras": ("age",)}, "extras must be a sequence out of speed, size"),
        ({"extras": "speed"}, "extras must be a sequence"),
        ({"phase_reference": "ankles"}, "phase_reference must be 'auto' or a mapping"),
        ({"phase_reference": {}}, "at least one channel"),
    ],
)
def test_wrong_parameters_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        FourierLinearizer(**options).fit(_walks(1))


def test_impossible_vectors_are_refused():
    linearizer = FourierLinearizer().fit(_walks(1))
    vector = linearizer.transform(_walks(1))[0]
    with pytest.raises(ValueError, match=r"walk 0: expected a positive frequency, got -0\.1 Hz"):
        linearizer.inverse_transform([[*vector[:-1], -0.1]])
    with pytest.raises(ValueError, match="below half of frame_rate"):
        linearizer.inverse_transform([[*vector[:-1], 31.0]])
    with pytest.raises(ValueError, match="expected 226 features a walk, got 3"):
        linearizer.inverse_transform([[1.0, 2.0, 3.0]])
    with pytest.raises(ValueError, match="contains NaN"):
        linearizer.inverse_transform([[*vector[:-1], np.nan]])


# Walks in joint angles.


def _joint_walks(n=3):
    return [swinging(0.05 * np.arange(600), seed=seed, name=f"walk {seed}") for seed in range(n)]


def test_joint_walks_come_back_with_their_features():
    """In phase: left minus right hip flexion is a pure cosine. The bones are those of the first walk."""
    walks = _joint_walks()
    linearizer = FourierLinearizer(n_cycles=5, frame_rate=60.0, phase_reference="auto").fit(walks)
    table = linearizer.transform(walks)
    assert table.shape == (3, 5 * 3 * 22 + 1)
    assert_allclose(table[:, -1], 0.05 * 120 / (2 * np.pi), rtol=1e-9)
    names = list(linearizer.get_feature_names_out())
    sine, cosine = (table[:, names.index(f"{wave}1_LeftUpLeg_y")] for wave in ("sin", "cos"))
    other = [table[:, names.index(f"{wave}1_RightUpLeg_y")] for wave in ("sin", "cos")]
    assert_allclose(sine, other[0], atol=1e-12)
    assert (cosine < other[1]).all()  # forward is negative
    made = linearizer.inverse_transform(table)
    assert_allclose(linearizer.transform(made), table, atol=1e-9)
    for walk in made:
        assert walk.skeleton is linearizer.template_.skeleton
        assert np.ptp(walk.root, axis=0).max() == 0


def test_joints_without_channels_stand_as_in_the_first_walk():
    walks = [replace(walk, channel_joints=("LeftUpLeg", "RightUpLeg", "Head")) for walk in _joint_walks()]
    linearizer = FourierLinearizer().fit(walks)
    vectors = linearizer.transform(walks)
    assert vectors.shape == (3, 5 * 3 * 3 + 1)
    made = linearizer.inverse_transform(vectors)[2]
    still = np.setdiff1d(np.arange(22), made._columns())
    assert_array_equal(
        made.rotations[:, still], np.broadcast_to(walks[0].rotations[0, still], made.rotations[:, still].shape)
    )
    assert_allclose(linearizer.transform([made]), vectors[2:], atol=1e-9)


def test_other_joints_are_refused():
    walk = _joint_walks(1)[0]
    linearizer = FourierLinearizer().fit([walk])
    few = replace(walk, channel_joints=("Hips", "LeftUpLeg", "RightUpLeg"), name="few")
    message = (
        "'few': expected the 66 channels .* got 9; missing: Spine_x, .*; unknown: none; .* one skeleton, and prepare"
    )
    with pytest.raises(WalkError, match=message):
        linearizer.transform([walk, few])
    names = tuple("Tail" if joint == "Head" else joint for joint in walk.skeleton.joint_names)
    tailed = replace(walk, skeleton=replace(walk.skeleton, joint_names=names), name="tailed")
    with pytest.raises(WalkError, match=r"missing: Head_x, Head_y, Head_z; unknown: Tail_x, Tail_y, Tail_z"):
        FourierLinearizer().fit([walk, tailed])
    in_file = replace(walk, skeleton=replace(walk.skeleton, upright=False), name="in file")
    with pytest.raises(
        WalkError, match="'in file': expected rotations along the axes of the room in all walks or in none"
    ):
        linearizer.transform([in_file])


@pytest.mark.parametrize("check", contract.CHECKS, ids=lambda check: check.__name__)
def test_contract_of_joint_walks(check):
    check(FourierLinearizer(), [replace(walk, speed=1.2) for walk in _joint_walks()])


@pytest.mark.parametrize("check", contract.CHECKS, ids=lambda check: check.__name__)
def test_contract(check):
    check(FourierLinearizer(), _walks(3, speed=1.2))
