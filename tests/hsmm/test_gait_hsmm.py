"""GaitHSMM as users meet it: training, scoring, alignment, new walks, and what scikit-learn asks of it."""

import pickle
import warnings
from dataclasses import replace

import numpy as np
import pytest
from sklearn.exceptions import NotFittedError
from sklearn.model_selection import GroupKFold, cross_val_score

from eigenwalker import WalkError
from eigenwalker.hsmm import CONTEXTS, NEIGHBOR_WINDOWS, WINDOWS, GaitHSMM, make_labels
from eigenwalker.hsmm.observation import log_densities
from eigenwalker.motion import quality_table
from tests import contract
from tests.hsmm.walking import shaken_walk, shaken_walks, step_arrays

ESTIMATOR_CHECKS = [
    contract.arguments_are_stored_untouched,
    contract.clone_forgets_and_keeps_parameters,
    contract.parameters_are_documented,
    contract.other_things_than_walks_are_refused,
]


@pytest.fixture(scope="module")
def walks():
    return shaken_walks(6)


@pytest.fixture(scope="module")
def model(walks):
    return GaitHSMM().fit(walks)


@pytest.mark.parametrize("check", ESTIMATOR_CHECKS, ids=lambda check: check.__name__)
def test_contract(check, walks):
    check(GaitHSMM(), walks)


def test_fit_returns_itself_and_forgets(walks, model):
    twice = GaitHSMM().fit(walks[:2])
    assert twice.fit(walks) is twice
    assert twice.score(walks) == model.score(walks)


def test_input_is_unchanged(walks):
    before = [np.array(walk.channels) for walk in walks]
    GaitHSMM().fit(walks).predict(walks)
    for walk, copied in zip(walks, before, strict=True):
        np.testing.assert_array_equal(walk.channels, copied)


@pytest.mark.parametrize("method", ["score", "score_samples", "predict"])
def test_not_fitted(method, walks):
    with pytest.raises(NotFittedError):
        getattr(GaitHSMM(), method)(walks)
    for generate in (GaitHSMM().sample, GaitHSMM().synthesize):
        with pytest.raises(NotFittedError):
            generate()


def test_pickle(walks, model):
    assert pickle.loads(pickle.dumps(model)).score(walks) == model.score(walks)


def test_n_jobs_changes_nothing(walks, model):
    other = GaitHSMM(n_jobs=2).fit(walks)
    np.testing.assert_array_equal(other.means_, model.means_)
    np.testing.assert_array_equal(other.durations_, model.durations_)


def test_cross_validation_by_groups(walks):
    scores = cross_val_score(GaitHSMM(), walks, groups=[0, 0, 1, 1, 2, 2], cv=GroupKFold(3))
    assert scores.shape == (3,)
    assert np.isfinite(scores).all()


def test_the_likelihood_rises_with_each_iteration(walks):
    model = GaitHSMM(tying=None, variance_floor=0.0, duration_floor=0.0, max_iter=8, tol=0.0).fit(walks)
    assert (np.diff(model.history_) > -1e-9).all()


def test_walks_like_those_of_fit_are_more_likely_than_others(model):
    alike, bent = shaken_walks(3, first=50), shaken_walks(3, first=50, bend=0.4)
    assert model.score(alike) > model.score(bent) + 50


def test_score_is_that_of_all_frames(walks, model):
    log_likelihoods, posteriors = model.score_samples(walks)
    n_frames = [len(part) for part in posteriors]
    assert model.score(walks) == pytest.approx(log_likelihoods.sum() / np.sum(n_frames))
    for part in posteriors:
        np.testing.assert_allclose(part.sum(axis=1), 1.0)


def test_score_is_the_density_of_a_known_path():
    """One walk of one state a step, each of a certain duration: the sum over paths has one term."""
    arrays, edges = step_arrays(3, n_steps=3, frames=10)
    arrays = [array[: edge[-1]] for array, edge in zip(arrays, edges, strict=True)]
    model = GaitHSMM(n_states=1, tying=None, windows=((1.0,),), duration_floor=1e-4).fit(
        [arrays[0]], [make_labels(3)], boundaries=[edges[0]]
    )
    assert (model.durations_[:, 1] < 1e-3).any()
    frames = np.repeat(np.arange(3), np.diff(edges[0]))
    rows = model.states_[[CONTEXTS.index(label) for label in make_labels(3)], 0]
    densities = log_densities(arrays[0], model.means_[rows], model.covars_[rows])
    path = densities[frames, np.arange(len(frames))].sum()
    assert model.score_samples([arrays[0]], [make_labels(3)])[0][0] == pytest.approx(path, abs=1e-6)


def test_predict_finds_the_steps():
    arrays, edges = step_arrays(8, noise=0.02)
    labels = [make_labels(8)] * 8
    model = GaitHSMM().fit(arrays, labels)  # from steps of equal length
    for positions, edge in zip(model.predict(arrays, labels), edges, strict=True):
        steps = positions // model.n_states
        found = np.concatenate(([0], np.flatnonzero(np.diff(steps)) + 1, [len(steps)]))
        assert np.abs(found - edge).max() <= 3


def test_frames_outside_of_steps_are_no_state(walks, model):
    positions = model.predict(walks)[0]
    assert positions[0] == -1
    assert positions.max() >= 0
    inside = positions[positions >= 0]
    assert (np.diff(inside) >= 0).all()
    assert inside[0] == 0


def test_boundaries_are_only_where_it_starts():
    arrays, edges = step_arrays(6)
    labels = [make_labels(8)] * 6
    started, even = (GaitHSMM(tol=1e-9, max_iter=100).fit(arrays, labels, boundaries=given) for given in (edges, None))
    # They climb to tops that differ by the paths of a few frames.
    assert started.score(arrays, labels) == pytest.approx(even.score(arrays, labels), abs=0.1)


def test_contexts_that_were_never_seen_have_states(walks, model):
    few = GaitHSMM().fit(*([part[:2] for part in (step_arrays(2, n_steps=3)[0], [make_labels(3)] * 2)]))
    assert (few.states_ >= 0).all()
    assert len(few.sample(8, first="left", random_state=0)[0]) > 100
    untied = GaitHSMM(tying=None).fit(step_arrays(2, n_steps=3)[0], [make_labels(3)] * 2)
    with pytest.raises(ValueError, match=r"no walk in fit had a step \('left', 'first'\).*tying='tree'"):
        untied.sample(8, first="left")


def test_tying_as_in_the_paper(walks):
    model = GaitHSMM(tying="paper").fit(walks)
    groups = {tuple(row) for row in model.states_.tolist()}
    assert len(groups) == 6


def test_walks_of_several_rates_are_resampled_if_asked(walks):
    slow = [shaken_walk(at, n_frames=150, frame_rate=30.0) for at in range(6)]
    with pytest.raises(WalkError, match="expected walks of one frame rate, 60 as the first has, got 'walk 0' 30"):
        GaitHSMM().fit([*walks, slow[0]])
    model = GaitHSMM(frame_rate=60.0).fit([*walks[:3], *slow[3:]])
    assert model.frame_rate_ == 60.0
    assert np.isfinite(model.score(slow))
    with pytest.raises(ValueError, match="expected 60 frames per second, as in fit, got 30"):
        GaitHSMM().fit(walks).score(slow)


def test_new_walks_keep_to_the_floor(model):
    walk = model.synthesize(8, name="new")
    assert walk.name == "new"
    assert walk.frame_rate == 60.0
    row = quality_table([walk]).iloc[0]
    assert row["foot_slip_m_per_step"] < 1e-3
    assert row["root_jump_m_per_s"] < 0.4
    assert row["speed_m_per_s"] > 0.5


def test_new_walks_have_the_variance_of_walks(walks, model):
    inner = slice(40, -40)
    wanted = model.global_variance_[0] > 1e-3
    exact = model.synthesize(16, global_variance_weight=0.0).channels[inner].var(axis=0)
    smooth = model.synthesize(16, global_variance=None).channels[inner].var(axis=0)
    real = model.global_variance_[0]
    assert np.abs(np.log(exact[wanted] / real[wanted])).mean() < np.abs(np.log(smooth[wanted] / real[wanted])).mean()


def test_durations_are_carried_and_drawn(model):
    mean = model.synthesize(10)
    assert model.synthesize(10).n_frames == mean.n_frames
    irregular = GaitHSMM(max_iter=3).fit(shaken_walks(3, jitter=0.04))
    drawn = [irregular.synthesize(10, durations="sample", random_state=seed).n_frames for seed in range(6)]
    assert len(set(drawn)) > 1
    assert model.synthesize(10, speed=1.2).n_frames == pytest.approx(mean.n_frames / 1.2, abs=1)
    again = irregular.synthesize(10, durations="sample", random_state=0).n_frames
    assert again == drawn[0]


def test_the_first_step_is_of_the_foot_that_is_asked_for(model):
    right, left = (model.synthesize(8, first=side, travel=False) for side in ("right", "left"))
    hips = [walk.rotations[:20, walk.skeleton.index("RightUpLeg"), 1] for walk in (right, left)]
    assert abs(hips[0] - hips[1]).max() > 0.2


def test_arrays_give_arrays():
    arrays, _ = step_arrays(4)
    model = GaitHSMM().fit(arrays, [make_labels(8)] * 4)
    assert model.template_ is None
    assert np.isnan(model.frame_rate_)
    assert model.synthesize(6).shape[1] == 2


def test_samples_have_the_moments_of_the_states():
    """Without dynamics frames of samples are those of the states."""
    arrays, _ = step_arrays(6, noise=0.1)
    model = GaitHSMM(windows=((1.0,),)).fit(arrays, [make_labels(8)] * 6)
    drawn = [model.sample(8, random_state=seed) for seed in range(200)]
    channels = np.concatenate([part[0] for part in drawn])
    positions = np.concatenate([part[1] for part in drawn])
    for position in (0, 12, 33):
        row = model.states_[CONTEXTS.index(make_labels(8)[position // 5]), position % 5]
        part = channels[positions == position]
        np.testing.assert_allclose(part.mean(axis=0), model.means_[row], atol=5 * np.sqrt(0.1 / len(part)))
        np.testing.assert_allclose(part.var(axis=0), model.covars_[row], rtol=0.25)


def test_windows_are_data(walks):
    paper, default = GaitHSMM(windows=WINDOWS).fit(walks), GaitHSMM().fit(walks)
    explicit = GaitHSMM(windows=NEIGHBOR_WINDOWS).fit(walks)
    np.testing.assert_array_equal(explicit.means_, default.means_)
    third = [np.abs(np.diff(m.synthesize(8, travel=False).channels, 3, axis=0)).mean() for m in (paper, default)]
    assert third[0] > third[1]


def test_verbose_prints_each_iteration(walks, capsys):
    GaitHSMM(max_iter=2, tol=0.0, verbose=True).fit(walks[:2])
    assert "iteration 1: log-likelihood" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("parameters", "match"),
    [
        ({"n_states": 0}, "n_states must be 1 or more, got 0"),
        ({"tying": "forest"}, "tying"),
        ({"max_iter": 0, "tol": -1.0}, "max_iter must be 1 or more, got 0\ntol must be 0 or more"),
        ({"windows": ((1.0,), (1.0, -1.0))}, "odd number"),
    ],
)
def test_impossible_parameters(parameters, match, walks):
    with pytest.raises(ValueError, match=match):
        GaitHSMM(**parameters).fit(walks)


def test_walks_that_do_not_fit(walks, model):
    other = replace(walks[0], channel_joints=walks[0].channel_joints[:-1], name="odd")
    with pytest.raises(WalkError, match="walk 'odd': expected the 21 channels of the first walk in fit, got 18"):
        GaitHSMM().fit([*walks, other])
    with pytest.raises(TypeError, match="expected JointWalks, as in fit, got arrays"):
        model.score([np.zeros((50, 21))], [make_labels(2)])
    with pytest.raises(ValueError, match="arrays need step labels"):
        GaitHSMM().fit([np.zeros((50, 2))])
    with pytest.raises(WalkError, match="walk 'walk 0': expected left and right"):
        GaitHSMM().fit(walks[:1], [[("left", "first"), ("left", "last")]])
    with pytest.raises(ValueError, match="expected y for each of the 6 walks, got 1"):
        GaitHSMM().fit(walks, [make_labels(3)])
    with pytest.raises(WalkError, match="at least 5 frames a step, one a state, got 4"):
        GaitHSMM().fit([np.zeros((12, 2))], [make_labels(3)])
    with pytest.raises(WalkError, match="expected boundaries that rise"):
        GaitHSMM().fit([np.zeros((50, 2))], [make_labels(2)], boundaries=[[0, 60, 50]])


def test_no_path_through_the_durations_names_the_walk(walks, model):
    with pytest.raises(WalkError, match=r"'walk 0': expected .* frames, which is what the durations"):
        model.score(walks[:1], [make_labels(80)])


def test_missing_values_are_refused(walks):
    holed = np.array(walks[0].rotations)
    holed[3, 0, 0] = np.nan
    with pytest.raises(WalkError):
        GaitHSMM().fit([replace(walks[0], rotations=holed)])


def test_nothing_is_warned_of(walks):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        GaitHSMM().fit(walks).synthesize(6)


def test_strides_of_drawn_durations_vary_as_those_of_the_walks():
    regular, irregular = (GaitHSMM().fit(shaken_walks(5, n_frames=600, jitter=jitter)) for jitter in (0.0, 0.04))
    assert regular.timing_share_ < irregular.timing_share_ <= 1.0
    assert regular.sample(8, random_state=0)[0].shape != regular.sample(8, random_state=1)[0].shape

    def spread(model):
        starts = [
            np.flatnonzero(
                np.diff(model.predict([model.synthesize(16, durations="sample", random_state=seed)])[0] // 5)
            )
            for seed in range(3)
        ]
        return np.mean([np.std(part[2:] - part[:-2]) for part in starts])

    assert spread(irregular) > spread(regular)


@pytest.mark.parametrize("n_states", [5, 8])
def test_steps_last_as_long_as_those_of_the_walks(n_states):
    """Also where states last for two frames, and durations cannot be Gaussian."""
    walks = shaken_walks(6, frame_rate=30.0, n_frames=200, jitter=0.03)
    model = GaitHSMM(n_states=n_states).fit(walks)
    per_step = model.synthesize(30).duration / 30
    assert per_step == pytest.approx(1 / 0.9 / 2, rel=0.06)


@pytest.mark.parametrize("n_steps", [1, 2, 3])
def test_walks_of_few_steps_keep_their_knees(walks, model, n_steps):
    knee = model.synthesize(n_steps, hold=False).rotations[:, walks[0].skeleton.index("LeftLeg"), 1]
    real = walks[0].rotations[:, walks[0].skeleton.index("LeftLeg"), 1]
    assert knee.min() > real.min() - 0.1


def test_walks_that_were_not_prepared_are_refused(walks):
    raw = replace(walks[0], skeleton=replace(walks[0].skeleton, upright=False))
    with pytest.raises(WalkError, match=r"expected joints that count along the axes of the room.*clip='whole'"):
        GaitHSMM().fit([raw])


def test_boundaries_at_the_end_are_resampled():
    slow = shaken_walk(0, n_frames=151, frame_rate=30.0)
    edges = [0, *range(20, 141, 20), 151]
    GaitHSMM(frame_rate=60.0, max_iter=2).fit([slow], [make_labels(8)], boundaries=[edges])


def test_frame_rates_of_few_digits_are_the_same(walks):
    near = replace(walks[1], frame_rate=60.0003)
    assert GaitHSMM(max_iter=2).fit([walks[0], near]).frame_rate_ == 60.0


def test_settings_after_the_fit_change_nothing(walks, model):
    other = pickle.loads(pickle.dumps(model)).set_params(windows=WINDOWS)
    assert other.score(walks) == model.score(walks)
