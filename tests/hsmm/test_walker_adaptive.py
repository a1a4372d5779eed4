"""Walker-adaptive training."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from eigenwalker import WalkError
from eigenwalker.hsmm import StateParameters, append_dynamics, fit_states, variance_floors
from eigenwalker.hsmm.canonical_states import nearest_to_identity
from eigenwalker.hsmm.duration_transform import DurationTransform, duration_units
from eigenwalker.hsmm.estimation import overall_moments
from eigenwalker.hsmm.transform_estimation import standard_units
from eigenwalker.hsmm.transformed_inference import WalkerTransforms, expect_transformed, one_class
from eigenwalker.hsmm.walker_adaptive import fit_walker_adaptive
from tests.hsmm.adapted import STATIC, draw_transform, draw_walker, rows_of
from tests.hsmm.planted import draw_parameters

_CHAIN = (0, 1, 2, 3, 4, 5)


def _world(seed, *, n_walkers=4, n_walks=6, n_cycles=1, n_channels=2, size=0.25):
    """Return canonical states, the walkers' transforms, and their walks without dynamics.

    Variances differ much between states, else the channels of the model could be turned: covariances that are nearly
    spheres stay nearly diagonal.
    """
    random = np.random.default_rng(seed)
    planted = draw_parameters(random, n_states=6, n_features=n_channels, duration=8.0)
    planted = planted._replace(variances=10 ** random.uniform(-1, 0.5, planted.variances.shape))
    walkers, walks = [], {}
    for number in range(n_walkers):
        transform = draw_transform(random, n_channels, size)
        durations = DurationTransform(random.uniform(0.8, 1.2, 1), random.normal(0, 0.2, 1))
        walkers.append(WalkerTransforms((transform,), durations))
        name = f"walker {number}"
        walks[name] = draw_walker(random, planted, transform, durations, _CHAIN * n_cycles, n_walks, name)
    return planted, walkers, walks


def _every(walks):
    return [walk for own in walks.values() for walk in own]


def _start(planted, walks):
    """Return what plain training makes of all walks, from the planted states."""
    wide = planted._replace(variances=3 * planted.variances, duration_variances=planted.duration_variances + 6)
    return fit_states(_every(walks), wide, max_iter=20).parameters


@settings(deadline=None, max_examples=8)
@given(
    seed=st.integers(0, 2**32 - 1),
    weight=st.sampled_from([0.5, 30.0, 1e4]),
    classes=st.sampled_from([None, [0, 0, 0, 1, 1, 1]]),
)
def test_the_objective_never_falls(seed, weight, classes):
    planted, _, walks = _world(seed, n_walkers=3, n_walks=3)
    start = _start(planted, walks)
    found = fit_walker_adaptive(
        walks,
        start._replace(duration_variances=start.duration_variances + 1),
        weight=weight,
        windows=STATIC,
        state_classes=classes,
        duration_classes=classes,
        max_iter=6,
        tol=-np.inf,
        max_condition=np.inf,
    )
    assert len(found.objectives) == 7
    assert (np.diff(found.objectives) >= -1e-8 * np.abs(found.objectives[1:])).all()  # rounding, and rare durations
    assert all(np.linalg.det(part.matrix) > 0 for own in found.transforms.values() for part in own.channels)


def test_the_objective_never_falls_with_dynamics():
    planted, _, walks = _world(0)
    dynamic = {
        name: [walk._replace(observations=append_dynamics(walk.observations)) for walk in own]
        for name, own in walks.items()
    }
    _, variances = overall_moments(_every(dynamic))
    start = StateParameters(
        np.column_stack((planted.means, np.zeros((6, 4)))), np.tile(variances, (6, 1)), *planted[2:]
    )._replace(duration_variances=planted.duration_variances + 6)
    start = fit_states(_every(dynamic), start, floors=variance_floors(_every(dynamic))).parameters
    found = fit_walker_adaptive(dynamic, start, weight=1.0, max_iter=8, tol=-np.inf)
    assert (np.diff(found.objectives) >= -1e-8 * np.abs(found.objectives[1:])).all()
    assert found.objectives[-1] > found.objectives[0]


def test_floors_hold_for_channels_that_others_make_up():
    """A third channel is the sum of two: without floors a transform finds what stands still, and blows it up."""
    planted, _, walks = _world(6, n_channels=2, n_walks=8)
    redundant = {
        name: [
            walk._replace(observations=np.column_stack((walk.observations, walk.observations.sum(axis=1))))
            for walk in own
        ]
        for name, own in walks.items()
    }
    floors = variance_floors(_every(redundant), relative=0.05)
    start = planted._replace(
        means=np.column_stack((planted.means, planted.means.sum(axis=1))),
        variances=np.column_stack((planted.variances, planted.variances.sum(axis=1))),
    )
    found = fit_walker_adaptive(
        redundant, start, weight=20.0, windows=STATIC, floors=floors, duration_floor=0.5, max_iter=12, tol=-np.inf
    )
    assert (np.diff(found.objectives) >= -1e-8 * np.abs(found.objectives[1:])).all()
    assert (found.parameters.variances >= floors * (1 - 1e-9)).all()
    assert (found.parameters.duration_variances >= 0.5 * (1 - 1e-9)).all()
    assert (found.parameters.means.std(axis=0) > 0.1 * start.means.std(axis=0)).all()  # no channel has vanished


def test_objectives_are_likelihoods_less_penalties():
    planted, _, walks = _world(1)
    found = fit_walker_adaptive(walks, _start(planted, walks), weight=1e-12, windows=STATIC, max_iter=5, tol=-np.inf)
    classes = one_class(found.parameters)
    likelihood = sum(
        expect_transformed(
            walk, found.parameters, found.transforms[name], classes=classes, windows=STATIC
        ).log_likelihood
        for name, own in walks.items()
        for walk in own
    )
    assert found.objectives[-1] == pytest.approx(likelihood, rel=1e-9)


def _errors(n_walks, seed):
    """Return errors of canonical means, of transforms, and of plain training's means; means in standard deviations."""
    planted, walkers, walks = _world(seed, n_walks=n_walks, n_cycles=4)
    start = _start(planted, walks)
    found = fit_walker_adaptive(walks, start, weight=1e-3, windows=STATIC, max_iter=30, tol=1e-5)
    means, variances = overall_moments(_every(walks))
    wanted, transforms = nearest_to_identity(
        planted,
        walkers,
        classes=one_class(planted),
        units=standard_units(2, origin=means, scales=np.sqrt(variances)),
        duration_units=duration_units(*start[2:]),
        windows=STATIC,
    )
    misses = [
        rows_of(mine.channels[0]) - rows_of(theirs.channels[0])
        for mine, theirs in zip(found.transforms.values(), transforms, strict=True)
    ]
    spread = np.sqrt(wanted.variances)
    scaled = (found.parameters.means - wanted.means) / spread, misses, (start.means - wanted.means) / spread
    return [np.sqrt(np.mean(np.square(part))) for part in scaled]


def test_planted_states_are_found_with_errors_as_one_over_root_n_and_not_by_plain_training():
    """Medians of three worlds: in some the climb takes hundreds of iterations."""
    sizes = (2, 8)
    errors = np.array([np.median([_errors(n_walks, seed) for seed in range(3)], axis=0) for n_walks in sizes])
    slopes = np.log(errors[1] / errors[0]) / np.log(sizes[1] / sizes[0])
    assert (np.abs(slopes[:2] + 0.5) < 0.2).all(), (slopes, errors)
    assert (errors[:, 2] > 0.3).all()  # more walks of the same walkers do not mend plain training
    assert errors[-1, 0] < 0.1 * errors[-1, 2], errors


def test_walkers_held_at_the_identity_are_plain_training():
    planted, _, walks = _world(2)
    start = _start(planted, walks)
    wide = start._replace(variances=2 * start.variances, duration_variances=start.duration_variances + 9)
    found = fit_walker_adaptive(walks, wide, weight=np.inf, windows=STATIC, max_iter=4, tol=-np.inf)
    plain = fit_states(_every(walks), wide, max_iter=4, tol=-np.inf)
    # Durations that hardly ever occur widen those of plain training, and are left out here.
    assert_allclose(found.objectives, plain.log_likelihoods, rtol=5e-3)
    assert (found.objectives >= plain.log_likelihoods - 1e-6).all()
    spread = np.sqrt(plain.parameters.variances)
    assert_allclose(found.parameters.means / spread, plain.parameters.means / spread, atol=0.2)
    for own in found.transforms.values():
        assert_allclose(rows_of(own.channels[0]), np.eye(2, 3), atol=1e-12)


def test_order_of_walkers_units_and_threads_do_not_matter():
    planted, _, walks = _world(3)
    start = _start(planted, walks)
    arguments = {"weight": 5.0, "windows": STATIC, "max_iter": 4, "tol": -np.inf}
    one = fit_walker_adaptive(walks, start, **arguments)
    threads = fit_walker_adaptive(walks, start, n_jobs=2, **arguments)
    assert (threads.objectives == one.objectives).all()
    turned = fit_walker_adaptive(dict(reversed(walks.items())), start, **arguments)
    assert_allclose(turned.parameters.means, one.parameters.means, rtol=1e-6)
    units, origin = np.array([1e-3, 50.0]), np.array([3.0, -40.0])
    moved = {
        name: [walk._replace(observations=walk.observations * units + origin) for walk in own]
        for name, own in walks.items()
    }
    moved_start = start._replace(means=start.means * units + origin, variances=start.variances * units**2)
    other = fit_walker_adaptive(moved, moved_start, **arguments)
    assert_allclose(other.parameters.means, one.parameters.means * units + origin, rtol=1e-6)
    for name, own in other.transforms.items():
        before = one.transforms[name].channels[0]
        assert_allclose(own.channels[0].matrix, before.matrix * units[:, np.newaxis] / units, rtol=1e-5, atol=1e-9)
        channels = walks[name][0].observations
        assert_allclose(
            own.channels[0].apply(channels * units + origin), before.apply(channels) * units + origin, rtol=1e-5
        )


def test_convergence_and_report():
    planted, _, walks = _world(4)
    seen = []
    found = fit_walker_adaptive(
        walks,
        _start(planted, walks),
        weight=1.0,
        windows=STATIC,
        max_iter=50,
        tol=1e-3,
        report=lambda *entry: seen.append(entry),
    )
    assert found.converged
    n_frames = sum(len(walk.observations) for own in walks.values() for walk in own)
    assert seen == list(enumerate(found.objectives / n_frames))


def test_what_does_not_fit_is_refused():
    planted, _, walks = _world(5)
    with pytest.raises(ValueError, match="got none of 'gone'"):
        fit_walker_adaptive({**walks, "gone": []}, planted, weight=1.0, windows=STATIC)
    with pytest.raises(ValueError, match="at least one walk"):
        fit_walker_adaptive({}, planted, weight=1.0, windows=STATIC)
    cut = walks["walker 0"][0]._replace(observations=np.eye(2))
    with pytest.raises(WalkError, match=r"walk 'walker 0 0'.*got 2"):
        fit_walker_adaptive({"a": [cut]}, planted, weight=1.0, windows=STATIC)
