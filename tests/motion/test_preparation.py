"""From a recording to the treadmill, and back over the floor."""

import inspect
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import WalkError, WalkPreparer, make_walkers, prepare
from eigenwalker.model import FourierLinearizer
from eigenwalker.motion import (
    TROJE15,
    Event,
    MarkerSet,
    Walk,
    fill_gaps,
    low_pass,
    mirror_walk,
    prepare_walks,
    resample,
    steady_cadence,
    stride_frequency,
    symmetrize_walk,
    walk_quality,
)
from tests import contract
from tests.recordings import around, drifting_walk, over_the_floor, turned
from tests.synthetic import make_walk


def _overground(seed=0, *, speed=1.3, n_cycles=6.0, noise=0.0, bend=0.0):
    """Return a walk that goes along x, with or without a bend, and the same walk in place."""
    still, coefficients = make_walk(np.random.default_rng(seed), n_cycles=n_cycles, noise=noise, name="anna")
    pelvis = coefficients[0].reshape(15, 3)[TROJE15.index("pelvis")]
    still = replace(still, positions=still.positions - [*pelvis[:2], 0.0])
    times = np.arange(still.n_frames) / still.frame_rate
    path = np.column_stack((speed * times, bend * (times / times[-1]) ** 2, np.zeros_like(times)))
    return replace(still, positions=still.positions + path[:, np.newaxis]), still


def _features(*walks):
    return FourierLinearizer().fit_transform(list(walks))


def test_a_straight_path_is_taken_out_whole():
    moving, still = _overground()
    prepared = prepare(moving, clip="whole")
    assert_allclose(prepared.speed, 1.3, atol=1e-6)
    assert_allclose(_features(prepared), _features(still), atol=1e-6)


@pytest.mark.parametrize("degrees", [37.0, 90.0, 180.0, -123.0])
def test_heading_changes_nothing(degrees):
    moving, _ = _overground(noise=0.002)
    angle = np.deg2rad(degrees)
    turn = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    turned = replace(moving, positions=moving.positions @ turn)
    assert_allclose(_features(prepare(turned)), _features(prepare(moving)), atol=1e-6)


@pytest.mark.parametrize("degrees", [37.0, 180.0])
def test_heading_changes_nothing_in_place(degrees):
    _, still = _overground(noise=0.002)
    angle = np.deg2rad(degrees)
    turn = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    turned = replace(still, positions=still.positions @ turn)
    assert_allclose(_features(prepare(turned)), _features(prepare(still)), atol=1e-6)


def test_place_changes_nothing():
    moving, _ = _overground(noise=0.002)
    elsewhere = replace(moving, positions=moving.positions + np.array([30.0, -12.0, 0.0]))
    assert_allclose(_features(prepare(elsewhere)), _features(prepare(moving)), atol=1e-6)


def test_mirrored_recordings_give_mirrored_walks():
    moving, _ = _overground(noise=0.002)
    assert_allclose(prepare(mirror_walk(moving)).positions, mirror_walk(prepare(moving)).positions, atol=1e-9)
    assert_allclose(mirror_walk(mirror_walk(moving)).positions, moving.positions)


def test_a_bend_within_the_model_is_taken_out():
    """Six strides give the path four coefficients: a parabola is among them. The heading is that of its mean."""
    moving, still = _overground(bend=0.4)
    prepared = prepare(moving, clip="whole")
    turn = np.arctan2(0.4, 1.3 * (still.n_frames - 1) / still.frame_rate)
    cosine, sine = np.cos(turn), np.sin(turn)
    turned = still.positions @ np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    assert_allclose(_features(prepared), _features(replace(still, positions=turned)), atol=1e-6)


def test_start_and_stop_are_cut_off():
    moving, _ = _overground(n_cycles=9)
    times = np.arange(moving.n_frames) / moving.frame_rate
    lost = 0.8 * (np.exp(-2 * times) - 1) / 2 + 0.8 * np.exp(-2 * times[::-1]) / 2  # slow at both ends
    slowed = moving.positions + (lost[:, np.newaxis, np.newaxis] * [1.0, 0.0, 0.0])
    prepared = prepare(replace(moving, positions=slowed))
    assert 5 < walk_quality(prepared).n_cycles < 8.5


def test_in_place_frames_stay_and_speed_is_that_of_the_feet():
    walks = make_walkers(2, noise=0.0, random_state=3).data
    for walk in walks:
        prepared = prepare(replace(walk, speed=np.nan))
        assert prepared.n_frames == walk.n_frames
        assert_allclose(prepared.speed, walk.speed, rtol=0.15)
        assert prepare(walk).speed == walk.speed


def test_size_is_taken_out_and_kept():
    moving, _ = _overground()
    small, large = (replace(moving, positions=factor * moving.positions) for factor in (0.9, 1.1))
    alike = [prepare(walk, normalize_size=True) for walk in (small, large)]
    assert_allclose(alike[0].positions, alike[1].positions, atol=1e-9)
    assert_allclose(alike[1].size / alike[0].size, 1.1 / 0.9)
    assert 1.3 < alike[0].size < 1.7


def test_inverse_restores_speed_and_size():
    moving, _ = _overground()
    preparer = WalkPreparer(clip="whole", normalize_size=True)
    (back,) = preparer.inverse_transform(preparer.fit_transform([moving]))
    shift = (moving.positions - back.positions).reshape(moving.n_frames, -1, 3)
    assert_allclose(shift, np.broadcast_to(shift[0, 0] * [1, 1, 0], shift.shape), atol=1e-3)
    assert back.size == 1.0


def test_inverse_needs_a_speed():
    _, still = _overground()
    with pytest.raises(WalkError, match=r"'anna': its speed is unknown.*extras=\('speed',\)"):
        WalkPreparer().inverse_transform([still])


def test_frames_of_zeros_are_left_out_with_a_warning():
    moving, _ = _overground()
    positions = np.concatenate((np.zeros((3, 15, 3)), moving.positions + np.array([2.0, 0.0, 0.0])))
    with pytest.warns(UserWarning, match=r"'anna'.*kept frames 3 to .* left the other 3 out"):
        prepared = prepare(replace(moving, positions=positions))
    assert_allclose(_features(prepared), _features(prepare(moving)), atol=1e-6)


def _with_gap(walk):
    positions = walk.positions.copy()
    positions[7, TROJE15.index("left_knee")] = np.nan
    return replace(walk, positions=positions)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (_with_gap, r"'anna'.*3 NaN or infinite ones in left_knee_x, .*frame 7.*fill the gaps"),
        (lambda walk: replace(walk, positions=100 * walk.positions), r"legs are 8.* m long.*unit='cm'"),
        (lambda walk: replace(walk, positions=walk.positions[:40]), "at least one stride|periodic part"),
        (lambda walk: replace(walk, positions=np.repeat(walk.positions[:1], 600, axis=0)), "periodic part"),
        (
            lambda walk: Walk(walk.positions[:, :2], 120, MarkerSet(TROJE15.names[:2]), "anna"),
            r"'anna'.*no known rig .* fits the names head, clavicle; pass rig=",
        ),
    ],
)
def test_bad_walks_are_refused(spoil, message):
    moving, _ = _overground()
    with pytest.raises(WalkError, match=message):
        prepare(spoil(moving))


def test_all_refusals_come_at_once():
    moving, _ = _overground()
    walks = [
        moving,
        replace(_with_gap(moving), name="bert"),
        replace(moving, positions=moving.positions[:9], name="cleo"),
    ]
    with pytest.raises(WalkError, match=r"(?s)2 of 3 walks.*'bert'.*'cleo'"):
        prepare_walks(walks)
    with pytest.warns(UserWarning, match=r"(?s)2 of 3 walks.*'bert'.*'cleo'"):
        assert [walk.name for walk in prepare_walks(walks, on_error="skip")] == ["anna"]


def test_events_move_with_the_frames_that_are_kept():
    moving, _ = _overground(n_cycles=8)
    events = tuple(Event(time, "heel_strike", "left") for time in np.arange(0.5, 8, 1.0))
    prepared = prepare(replace(moving, events=events))
    cut = moving.n_frames - prepared.n_frames
    assert cut > 0
    (first, *_), times = prepared.events, [event.time for event in prepared.events]
    assert len(times) < len(events)
    assert first.time >= 0
    assert times[-1] < prepared.duration
    start = (events[0].time - first.time) % 1.0
    assert_allclose(start * 120, round(start * 120), atol=1e-6)


def test_wrong_choices_are_refused():
    moving, _ = _overground()
    with pytest.raises(ValueError, match="clip must be one of 'steady', 'whole', got 'best'"):
        prepare(moving, clip="best")
    with pytest.raises(ValueError, match="heading must be one of"):
        prepare(moving, heading="north")
    with pytest.raises(TypeError, match="expected a Walk or a JointWalk, got ndarray"):
        prepare(moving.positions)


def _clean(over_floor, *, n_cycles=6.3):
    """Return a walk without noise whose number of strides is not whole."""
    still, _ = make_walk(np.random.default_rng(7), n_cycles=n_cycles, phase=1.0, name="anna")
    return over_the_floor(around(still)) if over_floor else around(still)


@pytest.mark.parametrize("over_floor", [False, True])
def test_options_are_the_functions_they_name(over_floor):
    """Each step that can be asked for is the function of its name, before or after the plain preparation."""
    walk = _clean(over_floor)
    plain = prepare(walk)
    assert_allclose(prepare(walk, cadence="steady").positions, steady_cadence(plain).positions, atol=1e-9)
    assert_allclose(prepare(walk, symmetrize=True).positions, symmetrize_walk(plain).positions, atol=1e-9)
    for name, function in (("cutoff", low_pass), ("frame_rate", resample)):
        changed = function(walk, **{name: 50.0})
        assert_allclose(prepare(walk, **{name: 50.0}).positions, prepare(changed).positions, atol=1e-12)


def test_gaps_are_filled_before_the_markers_are_placed():
    walk = _with_gap(_clean(over_floor=True))
    assert_allclose(prepare(walk, max_gap=0.1).positions, prepare(fill_gaps(walk, max_gap=0.1)).positions)
    assert_allclose(_features(prepare(walk, max_gap=0.1)), _features(prepare(_clean(over_floor=True))), atol=1e-4)
    with pytest.raises(WalkError, match="fill the gaps"):
        prepare(walk, max_gap=0.001)


def test_a_camera_that_follows_leaves_what_the_body_does():
    """The pelvis stays over the origin; apart from that, motion about it is that of the walk over the floor."""
    walk = _clean(over_floor=True)
    followed = replace(walk, positions=walk.positions - walk.marker("pelvis")[:, np.newaxis] * [1, 1, 0] + [3, 2, 1])
    seen = prepare(turned(followed, 80.0), camera="moving")
    assert_allclose(seen.marker("pelvis")[:, :2], 0.0, atol=1e-9)
    known = prepare(walk, clip="whole")
    about = known.positions - known.marker("pelvis")[:, np.newaxis] * [1, 1, 0]
    twist = np.abs(seen.positions - about)[..., :2].max()
    assert twist < 0.03  # the legs swing along x instead of the path: half a degree
    heights = seen.positions[..., 2] - about[..., 2]
    assert_allclose(heights, heights[0, 0], atol=1e-9)
    ankles = [TROJE15.index(f"{side}_ankle") for side in ("left", "right")]
    assert_allclose(_features(seen)[0, :45].reshape(15, 3)[ankles, 2].mean(), 0.0, atol=1e-9)
    assert_allclose(seen.speed, prepare(_clean(over_floor=False)).speed, rtol=0.05)


def test_speed_is_in_meters_per_second_whatever_the_size():
    walk = _clean(over_floor=True)
    sizes = [prepare(replace(walk, positions=walk.positions / size, size=size)) for size in (1.0, 1.6)]
    assert_allclose([one.speed for one in sizes], 1.3, atol=1e-6)
    still = _clean(over_floor=False)
    in_place = [prepare(replace(still, positions=still.positions / size, size=size)) for size in (1.0, 1.6)]
    assert_allclose(in_place[0].speed, in_place[1].speed)


def test_a_known_frequency_stays_known_and_right():
    """Counted strides time the walk as recorded. Where drift is taken out the mean cadence is what the result has."""
    drift = 0.8 * np.linspace(-1.0, 1.0, 700) ** 2
    walk = over_the_floor(around(drifting_walk(drift)[0]))
    for options in ({}, {"cadence": "steady"}, {"symmetrize": True}):
        known = prepare(walk, frequency="events", **options)
        assert_allclose(known.frequency, stride_frequency(replace(known, frequency=np.nan)), rtol=5e-3)
        assert np.isnan(prepare(walk, **options).frequency)
    steady = prepare(walk, frequency="events", cadence="steady")
    assert walk_quality(steady).explained_power > 0.999


@pytest.mark.parametrize("option", [{"cadence": "steady"}, {"symmetrize": True}])
def test_what_needs_a_treadmill_says_so(option):
    with pytest.raises(WalkError, match=r"'anna': expected a walk in place, got one that .* treadmill=True first"):
        prepare(_clean(over_floor=True), treadmill=False, **option)
    prepare(_clean(over_floor=False), treadmill=False, **option)


def test_the_direction_of_a_walk_that_turns_back_is_its_drift():
    """Out and nearly back: from start to end it goes nowhere, while the line through its path has a direction."""
    still = around(_clean(over_floor=False, n_cycles=12.0))
    line = np.linspace(0.0, 1.0, still.n_frames)
    away = np.where(line < 0.9, 0.5 * still.duration * line, 0.5 * still.duration * 9 * (1 - line))
    walk = replace(still, positions=still.positions + away[:, np.newaxis, np.newaxis] * [1.0, 0.0, 0.0])
    assert_allclose(_features(prepare(walk)), _features(prepare(over_the_floor(still, speed=0.5))), atol=1e-3)


NEW = {
    "max_gap": 0.1,
    "cutoff": 10.0,
    "frame_rate": 60.0,
    "frequency": "events",
    "heading": "curve",
    "cadence": "steady",
    "symmetrize": True,
}


@pytest.mark.parametrize("check", contract.CHECKS, ids=lambda check: check.__name__)
def test_contract_with_all_steps(check):
    check(WalkPreparer(**NEW), [_overground(seed, n_cycles=8)[0] for seed in range(3)])


def test_the_step_takes_what_the_function_takes():
    """Same names and same defaults, in the same order."""
    ours, theirs = (inspect.signature(one).parameters for one in (WalkPreparer, prepare))
    assert {name: one.default for name, one in ours.items()} == {
        name: one.default for name, one in theirs.items() if name != "walk"
    }
    assert list(ours) == list(theirs)[1:]


def test_wrong_choices_of_new_steps_are_refused():
    moving, _ = _overground()
    for name, choices in (
        ("camera", "'still', 'moving'"),
        ("frequency", "'search', 'events'"),
        ("cadence", "'recorded', 'steady'"),
        ("heading", "'path', 'curve', 'body', None"),
    ):
        with pytest.raises(ValueError, match=f"{name} must be one of {choices}, got 'other'"):
            prepare(moving, **{name: "other"})


@pytest.mark.parametrize("check", contract.CHECKS, ids=lambda check: check.__name__)
def test_contract(check):
    check(WalkPreparer(), [_overground(seed)[0] for seed in range(3)])


def test_frames_without_markers_at_the_ends_are_left_out_with_a_warning():
    moving, _ = _overground(n_cycles=8)
    positions = moving.positions.copy()
    positions[:20, 3] = np.nan
    positions[-7:] = np.nan
    with pytest.warns(UserWarning, match=rf"kept frames 20 to {moving.n_frames - 8} of .* left the other 27 out"):
        prepared = prepare(replace(moving, positions=positions), clip="whole")
    assert prepared.n_frames == moving.n_frames - 27
    assert_allclose(_features(prepared), _features(prepare(moving)), atol=1e-6)


def test_a_range_of_frequencies_holds_on():
    moving, _ = _overground()
    assert np.isnan(prepare(moving).frequency)
    kept = prepare(moving, frequency_range=(0.6, 1.3))
    assert kept.frequency == stride_frequency(prepare(moving))
    with pytest.raises(WalkError, match=r"periodic part between 1.2 and 1.3 Hz"):
        prepare(moving, frequency_range=(1.2, 1.3))
