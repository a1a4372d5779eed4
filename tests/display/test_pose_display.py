"""Poses: the frames that they are, side by side or on their way."""

from dataclasses import replace

import numpy as np
import pytest

from eigenwalker import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.display import PoseDisplay
from tests.joint_bodies import swinging
from tests.planted import standing_walk


def test_phases_start_where_the_left_foot_is_furthest_ahead():
    walk = make_walkers(1, random_state=0).data[0]
    (strip,) = PoseDisplay.from_walks([walk], n_poses=8).strips
    ahead = strip.positions[:, strip.markers.index("left_ankle"), 0]
    ahead = ahead - strip.positions[:, strip.markers.index("right_ankle"), 0]
    assert ahead.argmax() == 0
    assert ahead.argmin() == 4


def test_poses_are_frames_of_the_walk():
    walk = make_walkers(1, treadmill=False, random_state=0).data[0]
    (strip,) = PoseDisplay.from_walks([walk], every=0.1, n_poses=5).strips
    frames = np.rint(0.1 * walk.frame_rate * np.arange(5)).astype(int)
    np.testing.assert_array_equal(strip.positions, walk.positions[frames])


def test_joint_walks_have_bones_soles_and_a_head():
    walk = swinging(2 * np.pi * np.arange(240) / 120)
    (strip,) = PoseDisplay.from_walks([walk]).strips
    names = strip.markers.names
    assert {"left heel", "right tip", "head"} <= set(names)
    assert {walk.skeleton.joint_names[joint] for joint in walk.skeleton.above(walk.skeleton.root)}.isdisjoint(names)
    assert strip.positions.shape == (6, len(names), 3)


def test_each_walk_has_a_row_with_its_name():
    walks = make_walkers(3, random_state=0).data
    display = PoseDisplay.from_walks(walks)
    assert [text.get_text() for text in display.ax_.texts] == [walk.name for walk in walks]
    assert display._repr_png_().startswith(b"\x89PNG")


def test_one_stride_is_enough():
    walk = make_walkers(1, random_state=0).data[0]
    n_frames = int(walk.frame_rate * 1.2)
    short = replace(walk, positions=walk.positions[:n_frames], frequency=1.0)
    PoseDisplay.from_walks([short])


def test_what_cannot_be_drawn_is_refused():
    walk = make_walkers(1, random_state=0).data[0]
    with pytest.raises(WalkError, match=r"expected at least \d+ frames for its poses"):
        PoseDisplay.from_walks([walk], every=5.0)
    with pytest.raises(ValueError, match="n_poses must be 1 or more and every positive or None, got 0 and None"):
        PoseDisplay.from_walks([walk], n_poses=0)
    with pytest.raises(WalkError, match="phase reference"):
        PoseDisplay.from_walks([standing_walk(40)])
