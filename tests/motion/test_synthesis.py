"""Synthesis of joint walks: any length, any frame rate, loops, variation."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker import read_walk, write_walk
from eigenwalker.motion import StrideVariation, plant_feet, resample, synthesize
from tests.joint_bodies import swinging
from tests.recorded import bandai_joints

PHASE = 2 * np.pi * 0.93 * np.arange(720) / 120


@pytest.fixture(scope="module")
def walk():
    return swinging(PHASE)


def test_a_periodic_walk_is_planted_as_it_is(walk):
    """Its harmonics are the walk; only near the ends it knows nothing of the steps before and after."""
    made, planted = synthesize(walk, duration=6, frame_rate=120, n_harmonics=2), plant_feet(walk)
    inside = slice(180, 540)
    assert_allclose(made.rotations[inside], planted.rotations[inside], atol=1e-5)
    assert_allclose(np.diff(made.root[inside], axis=0), np.diff(planted.root[inside], axis=0), atol=1e-5)


def test_frame_rates_agree_where_they_meet(walk):
    fine = synthesize(walk, duration=4, frame_rate=240)
    # Between frames the sole rolls on; what it does there a coarser walk does not see: 1.5 % of the way.
    for rate, apart in ((24, 0.08), (30, 0.08), (60, 0.04), (120, 0.02)):
        coarse = synthesize(walk, duration=4, frame_rate=rate)
        assert coarse.n_frames == 4 * rate
        assert_allclose(coarse.root, fine.root[:: 240 // rate], atol=apart)


def test_the_way_starts_over_the_origin(walk):
    for options in ({}, {"heading": 2.0}, {"curvature": 0.4}, {"path": [[0, 0], [1, 1]]}, {"travel": False}):
        assert_allclose(synthesize(walk, duration=2, **options).root[0, :2], 0, atol=1e-9)


@pytest.mark.parametrize("duration", [None, 5.0])
def test_loops_close(walk, duration):
    loop = synthesize(walk, loop=True, duration=duration)
    frames = loop.frame_rate / loop.frequency
    assert frames == pytest.approx(round(frames), abs=1e-9)
    assert (loop.n_frames - 1) / frames == pytest.approx(1 if duration is None else 5, abs=1e-9)
    assert_array_equal(loop.rotations[-1], loop.rotations[0])
    assert loop.root[-1, 2] == loop.root[0, 2]
    steps = np.linalg.norm(np.diff(loop.rotations, axis=0), axis=2).max(axis=1)
    assert steps[-1] < 1.5 * np.median(steps) + 0.1
    still = synthesize(walk, loop=True, duration=duration, travel=False)
    assert_allclose(still.root[-1], still.root[0], atol=1e-12)
    assert still.speed == pytest.approx(np.hypot(*(loop.root[-1] - loop.root[0])[:2]) * 60 / (loop.n_frames - 1))


def test_strides_of_a_loop_are_the_same(walk):
    loop = synthesize(walk, loop=True, duration=5.0)
    n_frames = round(loop.frame_rate / loop.frequency)
    assert_allclose(loop.rotations[n_frames:], loop.rotations[:-n_frames], atol=1e-6)


def test_a_list_gives_a_list_whatever_the_jobs(walk):
    walks = [replace(walk, name="one"), swinging(PHASE, seed=2, name="two")]
    made, again = (synthesize(walks, duration=2, n_jobs=n_jobs) for n_jobs in (1, 2))
    assert [one.name for one in made] == ["one", "two"]
    for one, other, alone in zip(made, again, walks, strict=True):
        assert_array_equal(one.rotations, other.rotations)
        assert_array_equal(one.root, synthesize(alone, duration=2).root)


def test_strides_vary_from_a_seed(data_dir):
    walks = [walk for walk in bandai_joints(data_dir, 4) if "elderly" in walk.name]
    variation = StrideVariation.from_walks(walks, n_harmonics=3)
    plain = synthesize(walks[0], duration=8)
    one, same, other = (synthesize(walks[0], duration=8, variation=variation, random_state=seed) for seed in (0, 0, 1))
    assert_array_equal(one.rotations, same.rotations)
    assert np.abs(one.rotations - other.rotations).max() > 0.01
    assert np.abs(one.rotations - plain.rotations).max() > 0.01
    assert np.linalg.norm(np.diff(one.root, 2, axis=0), axis=1).max() * 60 < 0.4


def test_files_hold_what_was_made(walk, tmp_path):
    made = synthesize(walk, duration=2)
    write_walk(made, tmp_path / "made.bvh")
    again = read_walk(tmp_path / "made.bvh")
    order = [again.skeleton.index(joint) for joint in made.skeleton.joint_names]
    assert_allclose(again.joint_positions()[:, order], made.joint_positions(), atol=1e-6)


def test_recordings_at_other_frame_rates_give_the_same_walk(walk):
    made, other = synthesize(walk, duration=3), synthesize(resample(walk, frame_rate=60), duration=3)
    assert_allclose(made.joint_positions(), other.joint_positions(), atol=2e-3)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"duration": 0}, "duration must be positive and finite, in seconds, got 0"),
        ({"frame_rate": -1}, "frame_rate must be"),
        ({"loop": True, "curvature": 0.1}, "a loop must be straight"),
        ({"travel": False, "path": [[0, 0], [1, 1]]}, "travel=False keeps the walk in place"),
        ({"n_harmonics": 40}, "must lie below half the frame rate"),
        ({"max_knee": np.nan}, "max_knee must be finite"),
    ],
)
def test_contradictions_are_refused(walk, options, match):
    with pytest.raises(ValueError, match=match):
        synthesize(walk, **options)


def test_markers_are_refused(walk):
    with pytest.raises(TypeError, match="JointWalk"):
        synthesize([walk.to_markers()])
