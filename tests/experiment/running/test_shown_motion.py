from dataclasses import replace

import numpy as np
import pytest

from eigenwalker._validation import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.running.shown_motion import shown_motion
from eigenwalker.motion.heading import turn
from eigenwalker.motion.skeleton import MarkerSet
from eigenwalker.motion.walk import Walk

WALK = make_walkers(1, random_state=0).data[0]  # in place, its speed known
PELVIS = WALK.marker_set.index("pelvis")


def travelling(speed):
    """Return the walk on its way along x."""
    positions = np.array(WALK.positions)
    positions[..., 0] += speed * np.arange(WALK.n_frames)[:, np.newaxis] / WALK.frame_rate
    return replace(WALK, positions=positions, speed=float("nan"))


def test_the_pelvis_stays_over_zero_and_its_height_stays():
    shown = shown_motion(WALK)
    np.testing.assert_array_equal(shown.positions[:, PELVIS, :2], 0)
    np.testing.assert_array_equal(shown.positions[:, PELVIS, 2], WALK.positions[:, PELVIS, 2])


def test_body_and_path_together_are_the_walk():
    walk = travelling(1.3)
    shown = shown_motion(walk)
    whole = shown.positions[..., :2] + shown.path[:, np.newaxis]
    aligned = turn(walk, np.array([1.0, 0.0])).positions[..., :2]
    # The heading is the slope of the recorded path, which the sway of the pelvis turns a little.
    np.testing.assert_allclose(whole - whole[0, PELVIS], aligned - aligned[0, PELVIS], atol=0.1)
    np.testing.assert_allclose(
        np.linalg.norm(whole - whole[0, PELVIS], axis=-1),
        np.linalg.norm(aligned - aligned[0, PELVIS], axis=-1),
        atol=1e-12,
    )


def test_whichever_way_a_walk_goes_it_is_shown_going_forward():
    walk = travelling(1.3)
    shown = shown_motion(turn(walk, np.array([0.3, -0.7])))
    assert shown.path[-1, 0] > 1.2 * walk.duration
    straight = shown_motion(walk)
    np.testing.assert_allclose(shown.positions, straight.positions, atol=1e-12)
    np.testing.assert_allclose(shown.path, straight.path, atol=1e-12)


def test_a_walk_in_place_goes_with_its_speed():
    shown = shown_motion(replace(WALK, speed=1.5))
    way = shown.path[-1, 0] - shown.path[0, 0]
    assert way == pytest.approx(1.5 * (WALK.n_frames - 1) / WALK.frame_rate, abs=0.05)  # but for the pelvis's own sway
    assert np.isnan(shown_motion(replace(WALK, speed=float("nan"))).path[1:, 0]).all()


def test_a_size_that_was_taken_out_comes_back():
    small = replace(WALK, positions=0.5 * WALK.positions, size=2.0)
    np.testing.assert_allclose(shown_motion(small).positions, shown_motion(WALK).positions)


def test_walks_without_pelvis_or_with_gaps_are_refused():
    with pytest.raises(WalkError, match="expected a marker pelvis"):
        shown_motion(Walk(np.zeros((3, 1, 3)), 60, MarkerSet(("head",)), name="a"))
    holes = np.array(WALK.positions)
    holes[5] = np.nan
    with pytest.raises(WalkError, match="expected finite values"):
        shown_motion(replace(WALK, positions=holes))
