"""How physical walks are: the table, and the rule that says when a foot stands."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import Walk, WalkError, make_walkers
from eigenwalker.motion import TROJE15, Event, mirror_walk, prepare_walks, quality_table, sole_points
from eigenwalker.motion.footing import contact_path, find_footing
from eigenwalker.motion.skeleton import TROJE15_AND_FEET
from tests.planted import planted_walk, standing_walk
from tests.recorded import bandai_walks
from tests.recordings import over_the_floor, turned, walked_curve

FRAME = 1 / 120


def _row(walk, *reference):
    return quality_table([walk], *([[one] for one in reference])).iloc[0]


def _with_feet(walk):
    """Return the 15 markers of a walk of joints, with heels and tips of the toes."""
    markers = walk.to_markers()
    ends = sole_points(walk)[:, :, [0, 2]].reshape(walk.n_frames, 4, 3)
    return replace(markers, positions=np.concatenate((markers.positions, ends), axis=1), marker_set=TROJE15_AND_FEET)


def test_planted_feet_do_not_slip():
    row = _row(planted_walk())
    assert row.n_steps in (9, 10)
    assert_allclose(row.speed_m_per_s, 1.2)
    assert_allclose(row.frequency_hz, 1.0, rtol=1e-3)
    assert_allclose([row.foot_slip_m_per_step, row.worst_foot_slip_m_per_step], 0.0, atol=1e-12)
    assert_allclose([row.foot_above_ground_m, row.foot_below_ground_m, row.root_jump_m], 0.0, atol=1e-12)
    # The foot swings at 2.5 times the speed of the walk: a frame or two of it are counted for trailing.
    assert row.worst_trailing_foot_slide_m < 2 * 1.2 / 0.4 * FRAME


@pytest.mark.parametrize("slide", [0.05, -0.1])
def test_feet_slip_by_as_much_as_they_were_made_to(slide):
    walk = planted_walk(slide=slide)
    row = _row(walk)
    lasting = 0.4  # seconds from toe off to heel strike of the other foot
    assert_allclose(row.foot_slip_m_per_step, abs(slide) * lasting, atol=2 * abs(slide) * FRAME)
    assert_allclose(row.worst_foot_slip_m_per_step, row.foot_slip_m_per_step, rtol=0.1)
    footing = find_footing(walk)
    for foot, frames in footing.supports:
        lasted = (frames.stop - 1 - frames.start) * FRAME
        assert_allclose(contact_path(footing.points[frames, foot]), abs(slide) * lasted)


def test_feet_over_and_under_the_floor_are_measured():
    assert_allclose(_row(planted_walk(height=0.01)).foot_above_ground_m, 0.01)
    assert_allclose(_row(planted_walk(height=-0.007)).foot_below_ground_m, 0.007)
    assert _row(planted_walk(height=-0.007)).foot_above_ground_m == 0
    assert _row(planted_walk(height=0.01)).foot_below_ground_m == 0


def test_the_floor_moves_with_the_belt():
    over, still = planted_walk(slide=0.05), planted_walk(slide=0.05, in_place=True)
    measured = ["foot_slip_m_per_step", "worst_foot_slip_m_per_step", "trailing_foot_slide_m", "speed_m_per_s"]
    assert_allclose(_row(still)[measured].astype(float), _row(over)[measured].astype(float), rtol=1e-9)
    unknown = _row(replace(still, speed=np.nan))
    assert unknown[measured].isna().all()
    assert unknown.n_steps == _row(still).n_steps
    assert_allclose(unknown.foot_above_ground_m, 0.0, atol=1e-12)


def test_events_of_a_walk_are_not_believed():
    walk = planted_walk(slide=0.05)
    lying = replace(walk, events=(Event(0.5, "heel_strike", "left"), Event(0.6, "toe_off", "right")))
    assert _row(lying).equals(_row(walk))


def test_stance_is_that_of_the_feet_that_were_put_down():
    """Left is down for phases 0 to 0.6 and starts at 0.25, right half a stride later."""
    supports = find_footing(planted_walk()).supports
    assert {foot for foot, _ in supports} == {0, 1}
    for foot, frames in supports:
        phases = (np.arange(frames.start, frames.stop) * FRAME + 0.25 + 0.5 * foot) % 1
        assert phases.min() > 0.1 - 2 * FRAME
        assert phases.max() < 0.5 + 2 * FRAME
        assert len(phases) > 0.36 / FRAME


def test_a_rolling_foot_does_not_slide():
    """A wheel with three spokes rolls over its rim: each point stands still while it is the lowest."""
    heel = [[0, 0, 0], [0, 0, 0], [0.05, 0, 0.1], [0.1, 0, 0.2]]
    toe = [[0.2, 0, 0.2], [0.2, 0, 0.05], [0.2, 0, 0], [0.2, 0, 0]]
    points = np.stack((heel, toe), axis=1).astype(float)
    assert contact_path(points) == 0.0
    assert_allclose(contact_path(points + np.arange(4)[:, None, None] * [0.003, 0.004, 1.0]), 0.015)


def test_bones_that_stretch_are_found():
    walk = standing_walk(50)
    arm = np.tile([0.0, 0.0, -0.25], (50, 1))
    arm[:, 2] += np.linspace(0, 0.03, 50)
    assert_allclose(_row(replace(walk, translations={"LeftHand": arm})).bone_length_variation_m, 0.03)
    rigid = replace(walk, rotations=np.random.default_rng(0).normal(size=walk.rotations.shape))
    assert_allclose(_row(rigid).bone_length_variation_m, 0.0, atol=1e-12)


def test_a_root_that_jumps_is_found():
    walk = planted_walk()
    root = np.array(walk.root)
    root[200:] += [0.03, 0.0, 0.04]
    row = _row(replace(walk, root=root))
    assert_allclose(row.root_jump_m, 0.05)
    assert_allclose(row.root_jump_m_per_s, 0.05 * 120)


def test_jerk_is_the_third_derivative_about_the_root():
    times = np.arange(60) / 60
    positions = np.tile(make_walkers(1, random_state=0).data[0].positions[0], (60, 1, 1))
    positions[:, TROJE15.index("head"), 0] += 7.0 * times**3 / 6
    positions[:, :, 1] += np.sin(9 * times)[:, np.newaxis]  # the whole body, root and all
    row = _row(Walk(positions, 60.0))
    assert_allclose(row.jerk_m_per_s3, 7.0 / np.sqrt(15), rtol=1e-6)
    assert np.isnan(row.jerk_ratio)


def test_jerk_is_compared_with_the_reference():
    walk = planted_walk()
    assert_allclose(_row(walk, walk).jerk_ratio, 1.0)
    assert_allclose(_row(walk, walk.to_markers()).jerk_ratio, 1.0)
    assert_allclose(_row(walk.to_markers(), walk).jerk_ratio, 1.0)
    rotations = np.random.default_rng(0).normal(scale=0.01, size=walk.rotations.shape)
    assert _row(replace(walk, rotations=rotations), walk).jerk_ratio > 1
    assert np.isnan(_row(walk, standing_walk(10)).jerk_ratio)  # nothing to compare with
    with pytest.raises(WalkError, match="expected the frame rate of its reference 'anna', 60 per second, got 120"):
        _row(walk, replace(walk, frame_rate=60.0, name="anna"))
    with pytest.raises(ValueError, match="reference must have one walk for each of the 1 walks, got 2"):
        quality_table([walk], [walk, walk])


def test_markers_of_the_feet_say_the_same_but_for_the_floor():
    walk = planted_walk(slide=0.05)
    joints, markers = _row(walk), _row(_with_feet(walk))
    same = ["speed_m_per_s", "n_steps", "foot_slip_m_per_step", "trailing_foot_slide_m", "bone_length_variation_m"]
    assert_allclose(markers[same].astype(float), joints[same].astype(float), atol=1e-9)
    assert markers[["foot_above_ground_m", "foot_below_ground_m"]].isna().all()
    ankles = _row(walk.to_markers())
    assert_allclose(ankles.foot_slip_m_per_step, joints.foot_slip_m_per_step, atol=2 * 0.05 * FRAME)


def test_size_side_and_heading_change_nothing():
    walk = over_the_floor(make_walkers(1, random_state=0).data[0])
    row = _row(walk).drop("name").astype(float)
    halved = replace(walk, positions=walk.positions / 2, size=2.0)
    for other in (halved, mirror_walk(walk), turned(walk, 77.0)):
        assert_allclose(_row(other).drop("name").astype(float), row, rtol=1e-6, atol=1e-9)


def test_walks_on_a_curve_are_measured_along_it():
    still = make_walkers(1, random_state=0).data[0]
    straight, circle = _row(over_the_floor(still)), _row(walked_curve(still, 2 * np.pi))
    assert circle.n_steps == straight.n_steps
    assert_allclose(circle.frequency_hz, straight.frequency_hz, rtol=1e-2)
    assert_allclose(circle.speed_m_per_s, straight.speed_m_per_s, rtol=0.05)  # the chords of a second are shorter
    assert circle.foot_slip_m_per_step < 2 * straight.foot_slip_m_per_step


def test_who_stops_is_still_looking_ahead():
    walk = over_the_floor(make_walkers(1, random_state=0).data[0])
    stopped = np.concatenate((walk.positions, np.repeat(walk.positions[-1:], round(2 * walk.frame_rate), axis=0)))
    row = _row(replace(walk, positions=stopped))
    assert row.n_steps >= _row(walk).n_steps
    assert np.isfinite(row.foot_slip_m_per_step)


def test_walks_without_steps_have_no_values_for_them():
    walks = [standing_walk(1), standing_walk(3), planted_walk(n_strides=0.3), make_walkers(1, random_state=0).data[0]]
    table = quality_table(walks)
    assert table["n_steps"].to_list()[:3] == [0, 0, 0]
    assert (
        table.loc[:2, ["foot_slip_m_per_step", "worst_foot_slip_m_per_step", "trailing_foot_slide_m"]]
        .isna()
        .all(axis=None)
    )
    assert table["frequency_hz"].isna().to_list() == [True, True, True, False]
    assert np.isnan(table.loc[0, "root_jump_m"])
    assert np.isnan(table.loc[1, "jerk_m_per_s3"])
    assert_allclose(table.loc[:1, "foot_below_ground_m"], 0.0, atol=1e-12)


def test_faults_are_told():
    walk = planted_walk().to_markers()
    gap = np.array(walk.positions)
    gap[3, 2, 1] = np.nan
    with pytest.raises(WalkError, match="expected finite values"):
        _row(replace(walk, positions=gap))
    with pytest.raises(TypeError, match="wrap it"):
        quality_table(walk)
    with pytest.raises(ValueError, match="no known rig"):
        _row(Walk(np.zeros((4, 1, 3)), 60.0, replace(TROJE15, names=("nose",), sticks=())))


def test_recorded_feet_hardly_slip(data_dir):
    recorded, _ = bandai_walks(data_dir)
    walks = prepare_walks(recorded[::5], representation="joints", treadmill=False)
    table = quality_table(walks, walks)
    medians = table.drop(columns="name").median()
    assert medians.foot_slip_m_per_step < 0.008
    assert 0.01 < medians.trailing_foot_slide_m < 0.03
    assert 0.004 < medians.foot_below_ground_m < 0.007
    assert medians.foot_above_ground_m < 0.015
    assert table.bone_length_variation_m.max() < 1e-9
    assert_allclose(table.jerk_ratio, 1.0)
    belts = quality_table(prepare_walks(recorded[::5], representation="joints"))
    # What the smooth path keeps of the speed's changes within a stride is no longer in the walk.
    assert_allclose(belts.speed_m_per_s, table.speed_m_per_s, rtol=0.03)
    assert_allclose(belts.frequency_hz, table.frequency_hz, rtol=0.01)
