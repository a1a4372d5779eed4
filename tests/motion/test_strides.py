"""Walks cut from strike to strike, and short walks of one person put together."""

from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import WalkError, make_walkers, prepare
from eigenwalker.io.c3d import read_c3d
from eigenwalker.model import FourierLinearizer
from eigenwalker.motion import (
    Event,
    MarkerSet,
    cut_to_strides,
    explained_power,
    fit_harmonics,
    gait_table,
    heel_strikes,
    phase_weights,
    pool_walks,
    prepare_walks,
    reference_phase,
    walk_quality,
)
from tests.recordings import over_the_floor
from tests.synthetic import make_walk

FREQUENCY = 0.93


def _walk(seed=0, **options):
    """Return a walk in place; walks of one seed are of one walker, whatever their length and noise."""
    rng = np.random.default_rng(seed)
    return make_walk(rng, frequency=options.pop("frequency", FREQUENCY), name="anna", **options)[0]


def _strikes(times, side="left", kind="heel_strike"):
    return tuple(Event(float(time), kind, side) for time in times)


def _features(*walks, **options):
    return FourierLinearizer(**options).fit_transform(list(walks))


def test_strides_are_counted_between_strikes():
    walk = replace(_walk(), events=_strikes([0.31, 1.39, 2.46]))
    cut = cut_to_strides(walk)
    assert_allclose(cut.frequency, 2 / (2.46 - 0.31))
    first = int(0.31 * 120)
    assert_array_equal(cut.positions, walk.positions[first : int(np.ceil(2.46 * 120)) + 1])
    assert_allclose(heel_strikes(cut, "left"), np.array([0.31, 1.39, 2.46]) - first / 120, atol=1e-12)


@given(first=st.integers(0, 60), n_frames=st.integers(90, 150), frame_rate=st.sampled_from([30.0, 50.0, 119.88, 250.0]))
def test_strikes_on_frames_are_cut_there(first, n_frames, frame_rate):
    """Quotients of whole numbers and the frame rate miss their frame by rounding, and no frame more is taken for it."""
    times = np.array([first, first + n_frames]) / frame_rate
    walk = replace(_walk(n_cycles=10), frame_rate=frame_rate, events=_strikes(times))
    cut = cut_to_strides(walk)
    assert cut.n_frames == n_frames + 1
    assert len(heel_strikes(cut, "left")) == 2
    assert cut.events[0].time == pytest.approx(0.0, abs=1e-9)


def test_the_foot_with_the_longer_time_is_taken():
    events = _strikes([0.4, 1.5]) + _strikes([0.9, 2.0, 3.05], "right")
    assert_allclose(cut_to_strides(replace(_walk(), events=events)).frequency, 2 / (3.05 - 0.9))


def test_events_in_the_walk_are_preferred():
    walk = _walk(n_cycles=3.0)
    found = cut_to_strides(walk)
    assert_allclose(found.frequency, FREQUENCY, rtol=2e-3)
    assert cut_to_strides(replace(walk, events=_strikes([0.5, 1.45]))).frequency == pytest.approx(1 / 0.95)


def test_toe_offs_do_where_no_foot_strikes_twice():
    walk = _walk(n_cycles=1.6)
    strikes = _strikes([0.5]) + _strikes([1.05], "right")
    offs = _strikes([0.15, 1.22], kind="toe_off") + _strikes([0.7], "right", kind="toe_off")
    cut = cut_to_strides(replace(walk, events=strikes + offs))
    assert_allclose(cut.frequency, 1 / 1.07)


def test_events_beyond_the_walk_do_not_count():
    """A plate may have seen the next stride, of which there are no frames."""
    walk = _walk(n_cycles=3.0)
    events = _strikes([-1.0, 0.1, 1.2, 2.25, walk.duration + 0.4])
    assert_allclose(cut_to_strides(replace(walk, events=events)).frequency, 2 / 2.15)


def test_what_cannot_be_cut_is_refused():
    walk = _walk()
    few = replace(walk, positions=walk.positions[:100])
    message = r"'anna': expected two heel strikes, or two toe offs, of the same foot, one stride.* twice in 0\.833 s"
    with pytest.raises(WalkError, match=message):
        cut_to_strides(few)
    missed = replace(walk, events=_strikes([0.3, 1.4, 3.5, 4.6]))
    with pytest.raises(WalkError, match=r"'anna': expected strides of about one length, got 1\.1 to 2\.1 s.*missing"):
        cut_to_strides(missed)


@pytest.mark.parametrize("n_cycles", [1.5, 2.2, 4.0])
@pytest.mark.parametrize("phase", [0.5, 2.5, 4.5])
def test_one_stride_over_the_floor_is_enough(n_cycles, phase):
    """Strikes found in a walk without noise are a few milliseconds off, and each part of the walk stays in its place.

    At 1.5 strides there is one whole stride and its path is a straight line, which a slow sine resembles: features
    are within 4 mm, the frequency and the speed within 1 %.
    """
    still = _walk(n_cycles=n_cycles, phase=phase)
    prepared = prepare(over_the_floor(still), frequency="events")
    assert_allclose(prepared.frequency, FREQUENCY, rtol=0.01)
    assert_allclose(prepared.speed, 1.3, atol=0.02)
    wanted = prepare(over_the_floor(_walk(n_cycles=6.0)))
    found, expected = _features(prepared, wanted)
    assert np.abs(found - expected)[:-1].max() < 0.01
    assert np.sqrt(np.mean((found - expected) ** 2)) < 0.002


def test_known_events_of_one_stride_give_the_walk():
    """With the true strikes the only error is the path's, and that is none."""
    still = _walk(n_cycles=1.3, frequency=1.0)
    walk = replace(over_the_floor(still), events=_strikes([0.125, 1.125]))
    prepared = prepare(walk, frequency="events")
    assert prepared.frequency == 1.0
    assert_allclose(prepared.speed, 1.3, atol=1e-9)
    assert_allclose(*_features(prepared, prepare(over_the_floor(_walk(n_cycles=6.0, frequency=1.0)))), atol=1e-6)


def test_one_walk_pooled_is_the_walk():
    walk = _walk(n_cycles=5.3, phase=1.0, speed=1.2)
    (pooled,) = pool_walks([walk], ["anna"])
    assert_allclose(_features(pooled), _features(walk), atol=1e-6)
    assert (pooled.name, pooled.speed, pooled.size) == ("anna", 1.2, 1.0)


@given(
    phases=st.lists(st.floats(0.0, 6.28), min_size=2, max_size=4),
    frame_rate=st.sampled_from([60.0, 120.0, 100.0]),
    n_cycles=st.floats(1.05, 4.0),
)
@settings(max_examples=30)
def test_copies_of_a_walk_are_the_walk(phases, frame_rate, n_cycles):
    """Wherever each starts, all are brought to one phase."""
    walks = [_walk(n_cycles=n_cycles + place, phase=phase, frame_rate=frame_rate) for place, phase in enumerate(phases)]
    (pooled,) = pool_walks(walks, ["anna"] * len(walks))
    assert_allclose(_features(pooled), _features(_walk(n_cycles=6.0)), atol=1e-5)


def test_frames_are_whole_strides_that_start_at_phase_zero():
    walks = [_walk(n_cycles=cycles, phase=phase) for cycles, phase in ((2.4, 1.0), (3.7, 4.0))]
    (pooled,) = pool_walks(walks, [1, 1])
    n_samples = pooled.frame_rate / pooled.frequency
    assert_allclose(n_samples, round(n_samples))
    assert_allclose(pooled.n_frames / n_samples, 5.0)
    strides = pooled.channels.reshape(5, round(n_samples), -1)
    for stride in strides:
        coefficients = fit_harmonics(stride, pooled.frame_rate, pooled.frequency, 2)
        assert abs(reference_phase(coefficients, phase_weights(pooled))) < 1e-6
    assert_allclose(strides, np.broadcast_to(strides[0], strides.shape), atol=1e-5)


@pytest.mark.parametrize("n_missing", [0, 1, 2])
def test_a_single_stride_may_lack_its_last_frames(n_missing):
    """A cycle of an animation ends one frame before it starts again."""
    for phase in np.linspace(0.0, 6.0, 7):
        walk = _walk(n_cycles=1.0, phase=phase, frequency=1.0)
        walk = replace(walk, positions=walk.positions[: walk.n_frames - n_missing], frequency=1.0)
        (pooled,) = pool_walks([walk], ["anna"])
        assert pooled.n_frames == 120
        assert_allclose(_features(pooled), _features(_walk(n_cycles=6.0, frequency=1.0)), atol=1e-4)


def test_noise_falls_with_the_square_root():
    """Sixteen passes of two strides against one: the error falls to a quarter, here known to some 5 %."""
    truth = _features(_walk(n_cycles=20))[0, :-1]
    clean = _walk(n_cycles=2.0, phase=1.0)
    rng = np.random.default_rng(0)
    errors = {1: [], 16: []}
    for _ in range(4):
        noisy = [
            replace(clean, positions=clean.positions + 0.01 * rng.normal(size=clean.positions.shape)) for _ in range(16)
        ]
        for number in errors:
            (pooled,) = pool_walks(noisy[:number], ["anna"] * number)
            errors[number].append(_features(pooled)[0, :-1] - truth)
    ratio = np.std(errors[1]) / np.std(errors[16])
    assert ratio == pytest.approx(4.0, rel=0.15)


def test_frequency_and_speed_are_those_of_all_the_time():
    """Strides over seconds, meters over seconds: a slow walk of many strides counts for more than a quick short one."""
    quick, slow = _walk(n_cycles=2.0, frequency=1.1, speed=1.8), _walk(n_cycles=6.0, frequency=0.8, speed=1.0)
    (pooled,) = pool_walks([quick, slow], ["anna", "anna"])
    time = 2 / 1.1 + 6 / 0.8
    assert_allclose(pooled.frequency, 8 / time, rtol=1e-6)
    assert_allclose(pooled.speed, (2 / 1.1 * 1.8 + 6 / 0.8 * 1.0) / time, rtol=1e-6)
    assert_allclose(_features(pooled)[0, :-1], _features(quick)[0, :-1], atol=1e-5)


def test_persons_keep_their_order_and_unknown_speeds_stay_unknown():
    walks = [_walk(seed, n_cycles=3.0, speed=speed) for seed, speed in ((1, 1.0), (0, np.nan), (1, 1.2), (0, 1.1))]
    pooled = pool_walks(walks, pd.Series(["bert", "anna", "bert", "anna"]))
    assert [walk.name for walk in pooled] == ["bert", "anna"]
    assert_allclose([walk.speed for walk in pooled], [1.1, np.nan])
    assert_allclose(_features(*pooled), _features(walks[0], walks[1]), atol=1e-5)


def test_made_walkers_are_pooled_to_their_long_walk():
    """Passes of three seconds against the minute they come from: closer than each pass alone."""
    long = make_walkers(1, duration=60, random_state=1).data[0]
    passes = [replace(long, positions=long.positions[first : first + 360]) for first in range(0, 7200, 400)]
    wanted, pooled, *alone = _features(long, *pool_walks(passes, [0] * len(passes)), *passes)
    errors = [np.sqrt(np.mean((features - wanted) ** 2)) for features in alone]
    assert np.sqrt(np.mean((pooled - wanted) ** 2)) < 0.5 * np.median(errors)


def _with_gap(walk):
    positions = walk.positions.copy()
    positions[7, 3] = np.nan
    return replace(walk, positions=positions, name="bert")


def test_refusals_come_at_once_or_are_left_out():
    good, bad = _walk(), _with_gap(_walk())
    short = replace(good, positions=good.positions[:60], name="cleo")
    with pytest.raises(WalkError, match=r"(?s)2 of 3 walks.*'bert'.*'cleo'"):
        pool_walks([good, bad, short], ["a", "a", "c"])
    with pytest.warns(UserWarning, match=r"(?s)2 of 3 walks.*'bert'.*'cleo'"):
        pooled = pool_walks([good, bad, short], ["a", "a", "c"], on_error="skip")
    assert [walk.name for walk in pooled] == ["a"]
    assert_allclose(_features(*pooled), _features(good), atol=1e-5)
    with pytest.raises(WalkError, match="nothing is left"):
        pool_walks([bad], ["a"], on_error="skip")


def test_groups_and_markers_must_fit():
    walk = _walk()
    with pytest.raises(ValueError, match="expected one group a walk, 2, got 1"):
        pool_walks([walk, walk], ["a"])
    for missing in (None, np.nan, pd.NA):
        with pytest.raises(ValueError, match="groups must name the person of each walk, got a missing one"):
            pool_walks([walk, walk], ["a", missing])
    other = replace(walk, marker_set=MarkerSet(tuple(f"m{n}" for n in range(15))), name="bert")
    with pytest.raises(WalkError, match="'bert': expected the markers of the first walk"):
        pool_walks([walk, other], ["a", "a"])


@cache
def _horst(data_dir):
    """Return the ten walks of `horst_c3d`, prepared by their events."""
    folder = data_dir / "horst_c3d"
    static = read_c3d(folder / "S01_0001_Static.c3d")
    recorded = [read_c3d(path).to_markers(static=static) for path in sorted(folder.glob("*Gait.c3d"))]
    return prepare_walks(recorded, frequency="events")


def test_passes_of_one_stride_are_prepared(data_dir):
    """About one stride each, which no search could time; the strides of the two that were timed by plates agree."""
    walks = _horst(data_dir)
    assert len(walks) == 10
    for walk in walks:
        assert 0.85 < walk.frequency < 1.0
        assert 0.99 < walk.frequency * walk.duration < 1.05
        assert 1.2 < walk.speed < 1.8
        assert walk_quality(walk).explained_power > 0.98
    bounds = pd.read_csv(data_dir / "horst_c3d" / "Gait_cycle_bounds.csv", index_col=0)
    timed = 1 / (bounds["HS2r"] - bounds["HS1r"])
    assert_allclose([walk.frequency for walk in walks if walk.name in timed.index], timed, rtol=0.01)


def test_passes_of_one_stride_are_pooled_to_one_vector(data_dir):
    """Ten strides of one man. Halves agree within 3 mm, root mean square over the features, and 3 % in frequency."""
    walks = _horst(data_dir)
    (person,) = pool_walks(walks, ["S01"] * 10)
    linearizer = FourierLinearizer(extras=("speed",)).fit([person])
    (vector,) = linearizer.transform([person])
    assert vector.shape == (227,)
    strides = np.array([round(walk.frequency * walk.duration) for walk in walks])
    times = np.array([1 / walk.frequency for walk in walks])
    assert_allclose(vector[-2], strides.sum() / times.sum(), rtol=1e-6)
    assert 1.2 < vector[-1] < 1.8
    assert explained_power(person.channels, person.frame_rate, person.frequency, 2) > 0.9
    for groups in ([0] * 5 + [1] * 5, [0, 1] * 5):
        one, other = linearizer.transform(pool_walks(walks, groups))
        assert np.sqrt(np.mean((one - other)[:225] ** 2)) < 0.003
        assert_allclose(one[-2:], other[-2:], rtol=0.03)


def test_strikes_at_the_ends_stay_known():
    walk = _walk(n_cycles=6)
    strides = cut_to_strides(walk)
    table = gait_table([strides])
    assert_allclose(table["cadence_steps_per_min"], 120 * strides.frequency, rtol=0.01)
    assert len(heel_strikes(strides, "left")) + len(heel_strikes(strides, "right")) >= 10
