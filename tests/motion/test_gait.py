"""Events, steps and the table of them."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker import WalkError, make_walkers
from eigenwalker.io import read_c3d
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
    step_frequency,
    stride_frequency,
    toe_offs,
)
from tests.recorded import bandai_joints, bandai_walks, style
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
    walk = _swinging(phase=1.0)
    late = _swinging(phase=1.0 - 0.2 * np.pi).marker("left_ankle")  # by 0.1 s
    heeled = Walk(
        np.concatenate((walk.positions, late[:, np.newaxis]), axis=1), 120, MarkerSet((*TROJE15.names, "left_heel"))
    )
    assert_allclose(heel_strikes(heeled, "left")[:4], heel_strikes(walk, "left")[:4] + 0.1, atol=5e-3)


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


@pytest.mark.parametrize("frame_rate", [30, 120, 250])
def test_events_near_the_ends_of_a_short_pass_are_found(frame_rate):
    """One stride and a little more: strikes 24 ms after its start and before its end."""
    times = np.arange(round(1.05 * frame_rate)) / frame_rate
    start, end = 0.024, times[-1] - 0.024
    swing = 0.4 * np.cos(2 * np.pi * (times - start) / (end - start))
    positions = np.zeros((len(times), 2, 3))
    positions[:, 1, 0] = swing
    walk = Walk(positions, frame_rate, MarkerSet(("pelvis", "left_ankle")))
    assert_allclose(heel_strikes(walk, "left"), [start, end], atol=0.004)


def test_noise_at_the_ends_makes_no_events():
    """A swing that is cut while the foot still goes forward."""
    rng = np.random.default_rng(0)
    times = np.arange(300) / 100
    for trial in range(50):
        swing = -0.4 * np.cos(2 * np.pi * times / 2) + 0.005 * rng.normal(size=300)  # its only top is after 1 s
        positions = np.zeros((240, 2, 3))
        positions[:, 1, 0] = swing[45:285]
        walk = Walk(positions, 100, MarkerSet(("pelvis", "left_ankle")))
        assert_allclose(heel_strikes(walk, "left"), [0.55], atol=0.03, err_msg=str(trial))


@pytest.mark.parametrize("n_frames", [1, 2, 3, 4, 5, 9])
def test_walks_of_a_few_frames_have_no_events(n_frames):
    walk = replace(_swinging(), positions=_swinging().positions[:n_frames])
    assert len(heel_strikes(walk, "left")) == 0


@pytest.fixture(scope="module")
def horst(data_dir):
    """Return the ten walks of `horst_c3d` with the markers of heels and toes, by name, and the measured events."""
    folder = data_dir / "horst_c3d"
    static = read_c3d(folder / "S01_0001_Static.c3d")
    walks = [read_c3d(path).to_markers(static=static, feet=True) for path in sorted(folder.glob("*Gait.c3d"))]
    return {walk.name: walk for walk in walks}, pd.read_csv(folder / "Gait_cycle_bounds.csv", index_col=0)


def test_recorded_events_are_those_of_the_force_plates(horst):
    """All six of both walks within 10 ms, and no others."""
    walks, bounds = horst
    assert len(bounds) == 2
    for name, measured in bounds.iterrows():
        walk = walks[name]
        assert_allclose(heel_strikes(walk, "right"), measured[["HS1r", "HS2r"]], atol=0.01)
        assert_allclose(heel_strikes(walk, "left"), measured[["HSl"]], atol=0.01)
        assert_allclose(toe_offs(walk, "right"), measured[["TOr"]], atol=0.01)
        assert_allclose(toe_offs(walk, "left"), measured[["TO1l", "TO2l"]], atol=0.01)


def test_recorded_feet_do_at_events_what_feet_do(horst):
    """Plain physics on all ten passes.

    The heel comes down before a strike and lies low and still 60 ms after it; the toe lies low and still 60 ms before
    a toe off and moves forward and up at it. Left and right take turns.
    """
    for walk in horst[0].values():
        events = detect_events(walk).events
        assert 4 <= len(events) <= 6, walk.name
        for kind in ("heel_strike", "toe_off"):
            sides = [event.side for event in events if event.kind == kind]
            assert all(first != second for first, second in pairwise(sides))
        for event in events:
            path = walk.marker(f"{event.side}_{'heel' if event.kind == 'heel_strike' else 'toe'}")
            velocity = np.gradient(path, 1 / walk.frame_rate, axis=0)
            frame, late = round(event.time * walk.frame_rate), round(0.06 * walk.frame_rate)
            rest = frame + late if event.kind == "heel_strike" else frame - late
            if not 0 <= rest < walk.n_frames:
                continue
            assert path[rest, 2] < path[:, 2].min() + 0.025, (walk.name, event)
            assert np.linalg.norm(velocity[rest]) < 0.6, (walk.name, event)
            assert np.linalg.norm(velocity[frame]) > 1.0, (walk.name, event)
            assert (velocity[frame, 2] < 0) == (event.kind == "heel_strike"), (walk.name, event)


def test_recorded_double_support_is_a_tenth_of_the_stride(horst):
    """From a strike of one foot to the toe off of the other: 10 to 18 % of the stride."""
    for walk in horst[0].values():
        strikes = heel_strikes(walk, "right")
        if len(strikes) == 2:
            both = toe_offs(walk, "left")[0] - strikes[0]
            assert 0.10 < both / np.diff(strikes)[0] < 0.18, walk.name


def test_step_frequency_is_that_of_the_steps():
    """Tilmanne & Dutoit 2012, section 2.2: the inverse of twice the mean step duration."""
    strikes = [
        Event(time, "heel_strike", side) for time, side in zip((0.1, 0.6, 1.2), ("left", "right", "left"), strict=True)
    ]
    walk = replace(make_walkers(1, random_state=0).data[0], events=tuple(strikes))
    assert_allclose(step_frequency(walk), 1 / (2 * (0.5 + 0.6) / 2))
    assert_allclose(step_frequency(_swinging(phase=1.0)), 1.0, rtol=1e-3)
    standing = replace(walk, positions=np.repeat(walk.positions[:1], walk.n_frames, axis=0), events=())
    with pytest.raises(WalkError, match="expected a step"):
        step_frequency(standing)


def test_step_frequency_is_nearly_the_stride_frequency(data_dir):
    _, prepared = bandai_walks(data_dir)
    errors = [step_frequency(walk) / stride_frequency(walk) - 1 for walk in prepared]
    assert np.abs(errors).max() < 0.015
    assert np.median(np.abs(errors)) < 0.003
    joints = bandai_joints(data_dir, 2)
    assert_allclose([step_frequency(walk) for walk in joints], [stride_frequency(walk) for walk in joints], rtol=0.015)
