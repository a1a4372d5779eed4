"""Events, steps and the table of them."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import WalkError, make_walkers
from eigenwalker.motion import (
    TROJE15,
    Event,
    MarkerSet,
    Walk,
    detect_events,
    find_steps,
    gait_table,
    heel_strikes,
    mirror_walk,
    stride_frequency,
    toe_offs,
)
from tests.recorded import bandai_walks, style
from tests.synthetic import make_walk


def _swinging(n_cycles=6.2, phase=0.0):
    """Return a walk whose feet swing as pure cosines, the left one in front at the start."""
    rng = np.random.default_rng(0)
    walk, _ = make_walk(rng, frequency=1.0, n_cycles=n_cycles, phase=phase)
    positions = np.tile(walk.positions.mean(axis=0), (walk.n_frames, 1, 1))
    swing = 0.3 * np.cos(2 * np.pi * np.arange(walk.n_frames) / 120 + phase)
    positions[:, TROJE15.index("left_ankle"), 0] = swing
    positions[:, TROJE15.index("right_ankle"), 0] = -swing
    return replace(walk, positions=positions)


def test_strikes_are_where_the_foot_is_in_front():
    walk = _swinging(phase=1.0)
    late = 1 - 1.0 / (2 * np.pi)
    assert_allclose(heel_strikes(walk, "left"), late + np.arange(6), atol=2e-3)
    assert_allclose(heel_strikes(walk, "right"), (late + 0.5) % 1 + np.arange(6), atol=2e-3)
    assert_allclose(toe_offs(walk, "left"), heel_strikes(walk, "right"), atol=2e-3)


def test_sides_change_places_in_a_mirror():
    walk = make_walkers(1, random_state=0).data[0]
    assert_allclose(heel_strikes(mirror_walk(walk), "left"), heel_strikes(walk, "right"))


def test_steps_alternate_and_know_their_place():
    steps = find_steps(_swinging(phase=1.0))
    assert [step.side for step in steps[:4]] == ["left", "right", "left", "right"]
    assert [step.position for step in steps] == ["first", "second", *["inside"] * 7, "last but one", "last"]
    assert_allclose([step.end - step.start for step in steps], 0.5, atol=2e-3)
    assert [step.position for step in find_steps(_swinging(n_cycles=2.2, phase=1.0))] == ["first", "second", "last"]


def test_events_of_the_file_are_preferred():
    walk = replace(_swinging(), events=(Event(1.25, "heel_strike", "left"), Event(0.3, "clap")))
    assert_allclose(heel_strikes(walk, "left"), [1.25])
    assert len(heel_strikes(walk, "left", marker="ankle")) > 1
    found = detect_events(walk)
    assert Event(0.3, "clap") in found.events
    assert [event.time for event in found.events if event[1:] == ("heel_strike", "left")] == [1.25]
    assert len([event for event in found.events if event.kind == "toe_off"]) > 4


def test_a_heel_is_taken_where_there_is_one():
    walk = _swinging()
    late = np.roll(walk.marker("left_ankle"), 12, axis=0)
    heeled = Walk(
        np.concatenate((walk.positions, late[:, np.newaxis]), axis=1), 120, MarkerSet((*TROJE15.names, "left_heel"))
    )
    assert_allclose(heel_strikes(heeled, "left")[1:4], heel_strikes(walk, "left")[1:4] + 0.1, atol=5e-3)


def test_table_of_known_walkers():
    walkers = make_walkers(6, random_state=2)
    table = gait_table(walkers.data).set_index("name")
    frequencies = [stride_frequency(walk) for walk in walkers.data]
    assert_allclose(table["cadence_steps_per_min"], 120 * np.array(frequencies), rtol=0.02)
    speeds = np.array([walk.speed for walk in walkers.data])
    assert_allclose(table["stride_length_m"], speeds / frequencies, rtol=0.02)
    assert table["stance_ratio"].between(0.5, 0.7).all()
    assert table["step_width_m"].between(0.0, 0.3).all()
    assert table["step_time_asymmetry"].abs().lt(0.2).all()


def test_walks_without_steps_have_no_measures():
    walk, _ = make_walk(np.random.default_rng(0), name="anna")
    row = gait_table([replace(walk, positions=np.repeat(walk.positions[:1], 200, axis=0))]).iloc[0]
    assert row["n_steps"] == 0
    assert np.isnan(row["cadence_steps_per_min"])


def test_missing_markers_and_gaps_are_refused():
    walk = _swinging()
    with pytest.raises(WalkError, match="events need the markers pelvis and left_heel or left_ankle; it has head"):
        heel_strikes(Walk(walk.positions[:, :2], 120, MarkerSet(TROJE15.names[:2])), "left")
    positions = walk.positions.copy()
    positions[5, TROJE15.index("left_ankle")] = np.nan
    with pytest.raises(WalkError, match="left_ankle_x - pelvis_x, first in frame 5"):
        heel_strikes(replace(walk, positions=positions), "left")
    with pytest.raises(ValueError, match="side must be one of 'left', 'right', got 'both'"):
        heel_strikes(walk, "both")


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_recorded_steps_alternate_and_agree_with_the_frequency(data_dir, noise):
    """All walks of `bandai2`, as they are and with 10 mm of noise on every coordinate."""
    rng = np.random.default_rng(0)
    for walk in bandai_walks(data_dir)[1]:
        noisy = replace(walk, positions=walk.positions + noise * rng.normal(size=walk.positions.shape))
        strikes = [heel_strikes(noisy, side) for side in ("left", "right")]
        assert len(find_steps(noisy)) == sum(map(len, strikes)) - 1, walk.name
        stride_time = sum(times[-1] - times[0] for times in strikes) / sum(len(times) - 1 for times in strikes)
        assert_allclose(stride_time, 1 / stride_frequency(noisy), rtol=0.015, err_msg=walk.name)


def test_recorded_styles_differ_as_they_should(data_dir):
    _, prepared = bandai_walks(data_dir)
    means = gait_table(prepared).groupby([style(walk) for walk in prepared]).mean(numeric_only=True)
    assert means["speed_m_per_s"].idxmin() == "elderly"
    assert means["speed_m_per_s"].idxmax() == "active"
    assert means["stance_ratio"].between(0.5, 0.7).all()
