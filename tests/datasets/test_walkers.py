import numpy as np
import pytest
from sklearn.decomposition import PCA

from eigenwalker.datasets import make_walkers
from eigenwalker.datasets._parameters import PARAMETERS, average_parameters, individual_sd
from eigenwalker.datasets._traits import TRAIT_SCALES, TRAITS, trait_effects
from eigenwalker.datasets._walker import make_walker, stride_features, walker_markers
from eigenwalker.motion import (
    TROJE15,
    fit_harmonics,
    phase_weights,
    prepare,
    reference_phase,
    shift_phase,
    stride_frequency,
    walk_quality,
)
from eigenwalker.motion.path import stance_speed

PHASES = np.arange(100) / 100
MID_STANCE = slice(12, 35)  # percent of the stride in which the foot is flat
BONES = [
    (f"{side}_{upper}", f"{side}_{lower}")
    for side in ("left", "right")
    for upper, lower in (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"))
]


def features(walks):
    rows = []
    for walk in walks:
        frequency = stride_frequency(walk)
        coefficients = fit_harmonics(walk.channels, walk.frame_rate, frequency, 2)
        aligned = shift_phase(coefficients, reference_phase(coefficients, phase_weights(walk)))
        rows.append(np.append(aligned.ravel(), frequency))
    return np.array(rows)


def coded(target):
    return target.assign(gender=np.where(target.gender == "male", 1.0, -1.0))[list(TRAITS)].astype(float)


def stride(parameters):
    """One exact stride, as a dict of marker paths of shape (n_phases, 3)."""
    markers = walker_markers(make_walker(parameters), PHASES, PHASES)
    return dict(zip(TROJE15.names, markers.swapaxes(0, 1), strict=True))


def along(trait, amount):
    return average_parameters() + amount * trait_effects()[:, TRAITS.index(trait)]


@pytest.fixture(scope="module")
def exact():
    return make_walkers(20, noise=0.0, random_state=0)


@pytest.fixture(scope="module")
def crowd():
    return make_walkers(300, duration=3, frame_rate=20, random_state=0)


class TestRandomness:
    def test_the_same_seed_gives_the_same_walkers(self):
        first, second = (make_walkers(3, duration=3, random_state=4) for _ in range(2))
        for one, other in zip(first.data, second.data, strict=True):
            np.testing.assert_array_equal(one.positions, other.positions)
        assert first.target.equals(second.target)

    def test_seeds_differ(self):
        one, other = (make_walkers(1, duration=3, random_state=seed).data[0] for seed in (0, 1))
        assert np.abs(one.positions - other.positions).max() > 0.01

    def test_accepts_a_random_state_object(self):
        one = make_walkers(2, duration=3, random_state=np.random.RandomState(5))
        assert one.target.equals(make_walkers(2, duration=3, random_state=5).target)

    def test_noise_is_white_and_leaves_the_motion(self):
        clean, noisy = (make_walkers(2, noise=noise, random_state=1).data[0].positions for noise in (0.0, 0.002))
        error = noisy - clean
        assert error.std() == pytest.approx(0.002, rel=0.02)
        assert abs(np.corrcoef(error[1:].ravel(), error[:-1].ravel())[0, 1]) < 0.02

    def test_duration_does_not_change_the_first_frames(self):
        short, long = (make_walkers(2, duration=duration, random_state=1).data[1].positions for duration in (4, 8))
        np.testing.assert_allclose(long[: len(short)], short, atol=1e-12)

    def test_walkers_do_not_depend_on_how_many_follow(self):
        few, many = (make_walkers(n, duration=3, noise=0, random_state=3).target for n in (4, 9))
        assert few.age.equals(many.age[:4])


class TestTable:
    def test_one_row_a_walk_in_the_same_order(self, exact):
        assert [walk.name for walk in exact.data] == list(exact.target.index) == list(exact.parameters.index)
        assert list(exact.target.columns) == list(TRAITS)
        assert exact.data[3].name == "walker_003"

    @pytest.mark.parametrize("n_walkers", [1, 2, 7, 20])
    def test_the_genders_are_balanced(self, n_walkers):
        counts = make_walkers(n_walkers, duration=3, frame_rate=30, random_state=0).target.gender.value_counts()
        assert set(counts.index) <= {"female", "male"}
        assert abs(counts.get("female", 0) - counts.get("male", 0)) == n_walkers % 2

    def test_the_population_is_the_published_one(self, crowd):
        target = crowd.target
        means = target.groupby("gender")[["height", "weight"]].mean()
        # About three standard errors of 150 people.
        np.testing.assert_allclose(means.height, [1.629, 1.756], atol=0.017)
        np.testing.assert_allclose(means.weight, [67.8, 85.5], atol=3.3)
        ratings = target[["happy", "nervous"]]
        np.testing.assert_allclose(ratings.mean(), 0, atol=0.15)
        np.testing.assert_allclose(ratings.std(), 1, atol=0.12)
        assert -0.45 < ratings.corr().iloc[0, 1] < -0.05
        assert target.age.between(20, 60).all()

    def test_the_parameters_hold_the_planted_axes(self, crowd):
        traits = coded(crowd.target)
        design = np.column_stack((np.ones(len(traits)), traits))
        found = np.linalg.lstsq(design, crowd.parameters.to_numpy())[0][1:].T
        errors = (found - crowd.true_axes.to_numpy()) * TRAIT_SCALES
        spread = np.maximum(individual_sd(), 1e-9)[:, np.newaxis]
        # A slope of 300 walkers is good to 0.06 spreads times the inflation by correlated traits, below 2.
        assert np.abs(errors / spread).max() < 0.45
        assert np.sqrt(np.mean((errors / spread) ** 2)) < 0.1

    def test_feature_axes_are_what_a_trait_does(self, exact):
        assert exact.feature_axes.shape == (226, len(TRAITS))
        expected = stride_features(along("gender", 0.5)) - stride_features(along("gender", -0.5))
        found = exact.feature_axes["gender"].to_numpy()
        # The motion is nearly linear in the parameters over one standard deviation.
        assert np.linalg.norm(found - expected) < 0.03 * np.linalg.norm(expected)
        assert exact.feature_axes.loc["frequency", "nervous"] == pytest.approx(0.026)

    def test_the_description_says_that_the_data_are_made_up(self, exact):
        assert "ynthetic" in exact.DESCR
        assert "nothing about people" in exact.DESCR


class TestAnatomy:
    def test_bones_are_rigid(self, exact):
        for walk in exact.data:
            for upper, lower in BONES:
                lengths = np.linalg.norm(walk.marker(upper) - walk.marker(lower), axis=1)
                assert np.ptp(lengths) < 1e-9

    def test_proportions(self, exact):
        for walk, height in zip(exact.data, exact.target.height, strict=True):
            middle = {name: walk.marker(name).mean(axis=0) for name in TROJE15.names}
            leg = sum(np.linalg.norm(middle[f"left_{a}"] - middle[f"left_{b}"]) for a, b in (("hip", "knee"),))
            assert 0.7 < walk.marker("left_hip")[:, 2].mean() < 1.05
            assert 0.3 < leg < 0.55
            assert middle["head"][2] == max(point[2] for point in middle.values())
            assert 0.86 < middle["head"][2] / height < 0.97
            for joint in ("shoulder", "elbow", "hip"):
                assert middle[f"left_{joint}"][1] > middle[f"right_{joint}"][1]
            shoulders, hips = (middle[f"left_{part}"][1] - middle[f"right_{part}"][1] for part in ("shoulder", "hip"))
            assert shoulders > 1.2 * hips

    def test_joints_bend_the_right_way(self):
        body = stride(average_parameters())
        for side in ("left", "right"):
            line = (body[f"{side}_hip"] + body[f"{side}_ankle"]) / 2
            assert (body[f"{side}_knee"][:, 0] > line[:, 0] - 0.01).all()
            line = (body[f"{side}_shoulder"] + body[f"{side}_wrist"]) / 2
            assert (body[f"{side}_elbow"][:, 0] < line[:, 0]).all()

    def test_arms_swing_against_the_legs(self, exact):
        for walk in exact.data:
            for side, other in (("left", "right"), ("right", "left")):
                arm, leg = walk.marker(f"{side}_wrist")[:, 0], walk.marker(f"{side}_ankle")[:, 0]
                assert np.corrcoef(arm, leg)[0, 1] < -0.5
                assert np.corrcoef(arm, walk.marker(f"{other}_ankle")[:, 0])[0, 1] > 0.5


class TestGround:
    def test_feet_are_above_the_floor(self, exact):
        for walk, height in zip(exact.data, exact.target.height, strict=True):
            ankles = np.stack([walk.marker("left_ankle"), walk.marker("right_ankle")])[..., 2]
            assert ankles.min() > 0.039 * height - 0.015
            assert (ankles.min(axis=0) < 0.039 * height + 0.06).all()

    def test_the_flat_foot_moves_with_the_belt(self, exact):
        for parameters in exact.parameters.to_numpy():
            walker = make_walker(parameters)
            ankle = walker_markers(walker, PHASES, PHASES)[:, TROJE15.index("left_ankle")]
            velocity = np.gradient(ankle, axis=0)[MID_STANCE] * len(PHASES)
            slip = velocity + np.array([walker.stride_length, 0.0, 0.0])
            # An ankle turns a little about the ball of the foot, so it is not quite as still as the sole.
            assert np.sqrt((slip[:, 0] ** 2).mean()) < 0.12 * walker.stride_length
            assert np.abs(slip[:, :2].mean(axis=0)).max() < 0.08 * walker.stride_length

    def test_the_speed_is_that_of_the_belt(self, exact):
        for walk in exact.data:
            found = stance_speed(walk.marker("left_ankle")[:, 0], walk.marker("right_ankle")[:, 0], walk.frame_rate)
            # Below the belt's speed, because ankles roll over the foot at either end of stance.
            assert 0.88 < found / walk.speed < 1.02
            assert 0.75 < walk.speed < 1.85

    def test_steps_alternate(self, exact):
        for walk in exact.data:
            ahead = np.sign((walk.marker("left_ankle") - walk.marker("right_ankle"))[:, 0])
            changes = np.count_nonzero(np.diff(ahead))
            assert changes == pytest.approx(2 * stride_frequency(walk) * walk.duration, abs=1.5)

    def test_the_body_stays_in_place(self, exact):
        for walk in exact.data:
            assert np.abs(walk.marker("pelvis")[:, :2]).max() < 0.12
            assert np.ptp(walk.marker("pelvis")[:, 2]) < 0.13


class TestTraits:
    """What Troje (2002, section 5) saw, in walkers that differ in one trait only."""

    @staticmethod
    def pair(trait):
        return stride(along(trait, -2.0)), stride(along(trait, 2.0))

    @staticmethod
    def width(body, part):
        return (body[f"left_{part}"] - body[f"right_{part}"])[:, 1].mean()

    @staticmethod
    def range_of(body, marker, axis):
        return np.ptp(body[marker][:, axis])

    def test_men_have_wide_shoulders_and_elbows_and_sway(self):
        female, male = self.pair("gender")
        for body, ratio in ((female, 1.9), (male, 2.1)):
            sign = 1 if body is male else -1
            assert sign * (self.width(body, "shoulder") / self.width(body, "hip") - ratio) > 0
        assert self.width(male, "elbow") > self.width(female, "elbow") + 0.05
        assert self.range_of(male, "clavicle", 1) > 1.5 * self.range_of(female, "clavicle", 1)

    def test_hips_move_in_opposite_phase(self):
        waves = [np.fft.rfft((body["left_hip"] - body["right_hip"])[:, 2])[1] for body in self.pair("gender")]
        between = np.angle(waves[1] / waves[0])
        assert abs(between) > 0.9 * np.pi

    def test_heavy_walkers_are_slow_wide_and_bob_less(self):
        light, heavy = self.pair("weight")
        assert self.width(heavy, "ankle") > self.width(light, "ankle") + 0.03
        assert self.range_of(light, "clavicle", 2) > self.range_of(heavy, "clavicle", 2) + 0.004
        assert make_walker(along("weight", 2)).frequency < make_walker(along("weight", -2)).frequency

    def test_happy_walkers_are_bouncy_upright_fast_and_swing_their_arms(self):
        sad, happy = self.pair("happy")
        assert self.range_of(happy, "pelvis", 2) > self.range_of(sad, "pelvis", 2) + 0.004
        assert self.range_of(happy, "left_wrist", 0) > 1.3 * self.range_of(sad, "left_wrist", 0)
        assert happy["head"][:, 0].mean() < sad["head"][:, 0].mean() - 0.05
        assert happy["head"][:, 2].mean() > sad["head"][:, 2].mean()
        fast, slow = make_walker(along("happy", 2)), make_walker(along("happy", -2))
        assert fast.frequency * fast.stride_length > slow.frequency * slow.stride_length + 0.1

    def test_nervous_walkers_are_quick_small_and_raise_their_shoulders(self):
        relaxed, nervous = self.pair("nervous")
        raised = [(body["left_shoulder"] - body["clavicle"])[:, 2].mean() for body in (relaxed, nervous)]
        assert raised[1] > raised[0] + 0.02
        assert self.range_of(nervous, "left_wrist", 0) < 0.8 * self.range_of(relaxed, "left_wrist", 0)
        assert self.range_of(nervous, "left_ankle", 0) < self.range_of(relaxed, "left_ankle", 0)
        assert nervous["left_wrist"][:, 2].mean() > relaxed["left_wrist"][:, 2].mean()
        assert make_walker(along("nervous", 2)).frequency > make_walker(along("nervous", -2)).frequency + 0.05


class TestOverTheFloor:
    def test_travels_in_some_direction(self):
        walks = make_walkers(8, treadmill=False, random_state=0).data
        ways = np.array([walk.marker("pelvis")[-1, :2] - walk.marker("pelvis")[0, :2] for walk in walks])
        assert all(np.isnan(walk.speed) for walk in walks)
        assert (np.hypot(*ways.T) > 7).all()
        assert np.hypot(*(ways / np.hypot(*ways.T)[:, np.newaxis]).mean(axis=0)) < 0.9

    def test_faces_where_it_goes(self):
        walk = make_walkers(1, treadmill=False, noise=0, random_state=2).data[0]
        way = walk.marker("pelvis")[-1, :2] - walk.marker("pelvis")[0, :2]
        left = (walk.marker("left_hip") - walk.marker("right_hip"))[:, :2].mean(axis=0)
        assert way[0] * left[1] - way[1] * left[0] > 0.95 * np.hypot(*way) * np.hypot(*left)

    def test_starts_and_ends_slowly_but_is_mostly_steady(self):
        walk = make_walkers(1, treadmill=False, noise=0, random_state=1).data[0]
        speed = np.hypot(*np.gradient(walk.marker("pelvis")[:, :2], 1 / walk.frame_rate, axis=0).T)
        steady = np.median(speed)
        assert speed[0] < 0.7 * steady
        assert speed[-1] < 0.7 * steady
        assert np.mean(np.abs(speed / steady - 1) < 0.2) > 0.7

    def test_prepare_brings_back_the_treadmill_walk(self):
        in_place = make_walkers(20, random_state=3)
        floor = make_walkers(20, treadmill=False, random_state=3)
        assert floor.target.equals(in_place.target)
        prepared = [prepare(walk) for walk in floor.data]
        expected, found = features(in_place.data), features(prepared)
        spread = np.sqrt(expected.var(axis=0)[:-1].sum())
        distances = np.linalg.norm((found - expected)[:, :-1], axis=1)
        assert np.median(distances) < 0.06 * spread
        assert distances.max() < 0.12 * spread
        np.testing.assert_allclose(found[:, -1], expected[:, -1], atol=0.02)
        speeds = [walk.speed for walk in in_place.data]
        np.testing.assert_allclose([walk.speed for walk in prepared], speeds, rtol=0.05)


def leave_one_out(vectors, labels, n_components=15):
    """Predictions of least squares on components that are fitted again in every fold."""
    predictions = np.empty_like(labels)
    for left_out in range(len(vectors)):
        rest = np.delete(np.arange(len(vectors)), left_out)
        mean = vectors[rest].mean(axis=0)
        components = np.linalg.svd(vectors[rest] - mean, full_matrices=False)[2][:n_components]
        design = np.column_stack((np.ones(len(rest)), (vectors[rest] - mean) @ components.T))
        weights = np.linalg.lstsq(design, labels[rest])[0]
        predictions[left_out] = np.append(1.0, (vectors[left_out] - mean) @ components.T) @ weights
    return predictions


@pytest.mark.parametrize("seed", [0, 1])
def test_is_as_hard_as_reality(seed):
    walkers = make_walkers(random_state=seed)
    vectors = features(walkers.data)
    assert vectors[:, -1].min() > 0.72
    assert vectors[:, -1].max() < 1.18
    vectors[:, -1] *= np.sqrt(vectors[:, :-1].var(axis=0).mean()) / vectors[:, -1].std()
    assert 0.75 < PCA(15, svd_solver="full").fit(vectors).explained_variance_ratio_.sum() < 0.90
    labels = coded(walkers.target)
    predicted = leave_one_out(vectors, labels.to_numpy())
    correct = np.sign(predicted[:, 0]) == labels.gender
    assert 0.80 <= correct.mean() <= 0.95
    for trait in ("weight", "happy", "nervous"):
        column = labels.columns.get_loc(trait)
        assert 0.4 < np.corrcoef(predicted[:, column], labels[trait])[0, 1] < 0.9
    powers = [walk_quality(prepare(walk)).explained_power for walk in walkers.data]
    assert 0.94 < np.median(powers) < 0.985


class TestErrors:
    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            ({"n_walkers": 0}, "n_walkers must be at least 1, got 0"),
            ({"duration": 1.0}, "duration must be at least 3.0 s.*got 1.0"),
            ({"duration": float("nan")}, "duration must be at least"),
            ({"noise": -0.001}, "noise must be a standard deviation.*got -0.001"),
            ({"frame_rate": 0}, "frame_rate must be positive"),
            ({"frame_rate": 5}, "frame_rate must be at least 20"),
            ({"n_walkers": -1, "noise": -1}, "n_walkers.*; noise"),
        ],
    )
    def test_bad_values(self, arguments, message):
        with pytest.raises(ValueError, match=message):
            make_walkers(**arguments)

    def test_a_number_of_walkers_is_whole(self):
        with pytest.raises(TypeError, match=r"n_walkers must be a whole number, got 2\.5"):
            make_walkers(2.5)


def test_every_parameter_has_a_spread():
    assert len(set(PARAMETERS)) == len(PARAMETERS)
    assert np.flatnonzero(individual_sd() == 0).tolist() == [PARAMETERS.index("stature")]
