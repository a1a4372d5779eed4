"""Synthesized walks of recorded styles: what stands, what slides, what is kept.

A few walks of each style; `benchmarks.feet` has all of them. Lengths in metres; the lines are those of the benchmark.
"""

from dataclasses import replace
from functools import cache
from itertools import permutations

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from eigenwalker import read_walk, write_walk
from eigenwalker.motion import euler_from_rotvec, prepare, quality_table, rotvec_from_euler, synthesize
from eigenwalker.motion.posture import lean_back
from tests.recorded import bandai_walks, style

STYLES = ("active", "elderly", "exhausted", "feminine", "masculine", "normal", "youthful")


@cache
def _recorded(data_dir):
    """Return the first and the last walk of each style, as recorded."""
    recorded, _ = bandai_walks(data_dir)
    by_style = {name: [walk for walk in recorded if style(walk) == name] for name in STYLES}
    return [walk for walks in by_style.values() for walk in (walks[0], walks[-1])]


@cache
def _made(data_dir):
    """Return these walks in place, synthesized, and synthesized without reaching legs."""
    walks = [prepare(walk, representation="joints") for walk in _recorded(data_dir)]
    return walks, synthesize(walks), synthesize(walks, hold=False)


@pytest.fixture(scope="module")
def tables(data_dir, tmp_path_factory):
    """Return the measures of walks that were written and read again, and of the recordings."""
    folder, read = tmp_path_factory.mktemp("synthesized"), []
    recorded = _recorded(data_dir)
    for walk, original in zip(_made(data_dir)[1], recorded, strict=True):
        write_walk(lean_back(walk, original), folder / f"{walk.name}.bvh", unit="cm")
        read.append(read_walk(folder / f"{walk.name}.bvh", unit="cm"))
    originals = [prepare(walk, representation="joints", treadmill=False) for walk in recorded]
    return read, quality_table(read), quality_table(originals)


def _below(values, names, limit):
    over = pd.Series(np.asarray(values, dtype=float), index=names)
    assert (over <= limit).all(), over[~(over <= limit)]


def test_bones_are_those_of_the_file(tables, data_dir):
    for walk, original in zip(tables[0], _recorded(data_dir), strict=True):
        parents, places = walk.skeleton.parents, walk.joint_positions()
        assert walk.skeleton.joint_names == original.skeleton.joint_names
        bones = [joint for joint in range(1, len(parents)) if joint != walk.skeleton.root]
        lengths = np.linalg.norm(places[:, bones] - places[:, parents[bones]], axis=2)
        expected = np.linalg.norm(original.skeleton.offsets[bones], axis=1)
        assert_allclose(lengths, np.broadcast_to(expected, lengths.shape), atol=1e-9)


def test_feet_that_stand_do_not_slip(tables):
    _, made, _ = tables
    assert (made["n_steps"] >= 12).all()
    _below(made["worst_foot_slip_m_per_step"], made["name"], 0.001)


def test_feet_that_trail_slide_no_further_than_they_did(tables):
    _, made, recorded = tables
    _below(made["trailing_foot_slide_m"] - recorded["trailing_foot_slide_m"], made["name"], 0.0)


def test_feet_are_on_the_floor(tables):
    _, made, recorded = tables
    _below(made["foot_above_ground_m"], made["name"], 0.005)
    _below(made["foot_below_ground_m"] - recorded["foot_below_ground_m"], made["name"], 0.005)


def test_speed_is_kept(tables, data_dir):
    speeds = np.array([walk.speed for walk in _made(data_dir)[0]])
    errors = np.abs(tables[1]["speed_m_per_s"] / speeds - 1)
    _below(errors, tables[1]["name"], 0.05)
    assert errors.median() < 0.005  # legs reach for the 3 % that they may


def test_the_root_does_not_jump(tables):
    _below(tables[1]["root_jump_m_per_s"], tables[1]["name"], 0.4)


def test_knees_change_by_15_degrees_at_most(data_dir):
    _walks, made, free = _made(data_dir)
    for held, bare in zip(made, free, strict=True):
        assert np.abs(_flexion(held) - _flexion(bare)).max() < 15 + 1e-5
        assert_allclose(held.rotations[:, 0], bare.rotations[:, 0])


def _flexion(walk):
    """Return the angles of both knees in degrees."""
    places, index = walk.joint_positions(), walk.skeleton.index
    angles = []
    for side in "LR":
        hip, knee, ankle = (places[:, index(f"{joint}_{side}")] for joint in ("UpperLeg", "LowerLeg", "Foot"))
        across = np.linalg.norm(np.cross(knee - hip, ankle - knee), axis=1)
        angles.append(np.arctan2(across, ((knee - hip) * (ankle - knee)).sum(axis=1)))
    return np.rad2deg(angles)


def test_walks_go_round_circles(data_dir):
    """The standing foot slips a little more: the pelvis turns over it, and the root follows the arc."""
    walks, _, _ = _made(data_dir)
    table = quality_table(synthesize(walks[::3], curvature=0.25))
    assert table["worst_foot_slip_m_per_step"].max() < 0.005
    assert table["foot_above_ground_m"].max() < 0.005


@pytest.mark.parametrize("order", ["".join(order) for order in permutations("XYZ")])
def test_the_order_of_the_angles_in_a_file_changes_nothing(order, data_dir):
    recorded = _recorded(data_dir)[4]
    angles = euler_from_rotvec(recorded.rotations, order)
    orders = (order,) * len(recorded.skeleton.joint_names)
    skeleton = replace(recorded.skeleton, rotation_orders=orders)
    other = replace(recorded, rotations=rotvec_from_euler(angles, order), skeleton=skeleton)
    one, two = (synthesize(prepare(walk, representation="joints")) for walk in (recorded, other))
    assert_allclose(two.joint_positions(), one.joint_positions(), atol=1e-9)


def test_frame_rates_agree_at_common_times(data_dir):
    """Root and pose, over 4 s; feet pass from point to point between frames, and the sums differ by that."""
    walk = _made(data_dir)[0][10]
    base = synthesize(walk, duration=4, frame_rate=60)
    for rate in (24, 30, 120, 240):
        other = synthesize(walk, duration=4, frame_rate=rate)
        common = int(np.gcd(60, rate))
        ours, theirs = base.root[:: 60 // common], other.root[:: rate // common]
        assert_allclose(theirs, ours, atol=0.04)
