"""Static trials: what clusters carry, and legs that keep their lengths."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from eigenwalker import WalkError
from eigenwalker.io import read_c3d
from eigenwalker.motion import MarkerSet, Segment, Walk, carry_markers, mirror_walk
from eigenwalker.motion.static_trial import hold_lengths
from tests.marker_sets import horst_markers, known_body, mirrored, moved, plug_in_gait_markers

THIGH = Segment(("T1", "T2", "T3"), ("KNEE",))
NAMES = ("T1", "T2", "T3", "KNEE")
BODY = np.array([[0.0, 0.1, 0.7], [0.1, 0.1, 0.6], [0.0, 0.15, 0.5], [0.05, 0.0, 0.4]])


def _still(points, names, **changes):
    return Walk(np.repeat(points[np.newaxis], 3, axis=0), 100, MarkerSet(names), **changes)


STATIC = _still(BODY, NAMES, name="static")


def _only(walk, names):
    columns = [walk.marker_set.index(name) for name in names]
    return replace(walk, positions=walk.positions[:, columns], marker_set=MarkerSet(tuple(names)))


_turns = st.tuples(*[st.floats(-3, 3)] * 3).map(lambda turn: Rotation.from_rotvec(turn).as_matrix())
_shifts = st.tuples(*[st.floats(-5, 5)] * 3).map(np.array)


@given(rotation=_turns, shift=_shifts)
def test_a_body_that_moves_rigidly_is_carried_exactly(rotation, shift):
    walk = moved(STATIC, rotation, shift)
    carried = carry_markers(_only(walk, NAMES[:3]), STATIC, [THIGH])
    assert carried.marker_set.names == NAMES
    assert_allclose(carried.positions, walk.positions, atol=1e-12)


@given(rotation=_turns, shift=_shifts)
def test_where_the_static_trial_stands_does_not_matter(rotation, shift):
    rng = np.random.default_rng(0)
    walk = _only(STATIC, NAMES[:3])
    walk = replace(walk, positions=walk.positions + 0.005 * rng.normal(size=walk.positions.shape))
    expected = carry_markers(walk, STATIC, [THIGH]).positions
    assert_allclose(carry_markers(walk, moved(STATIC, rotation, shift), [THIGH]).positions, expected, atol=1e-9)


def test_what_two_segments_carry_is_put_midway():
    other = Segment(("S1", "S2", "S3"), ("KNEE",))
    names = (*NAMES, "S1", "S2", "S3")
    static = _still(np.concatenate((BODY, BODY[:3] - 0.4)), names)
    walk = _only(static, ("T1", "T2", "T3", "S1", "S2", "S3"))
    slid = walk.positions + np.array([0.0, 0, 0, 0.02, 0.02, 0.02])[:, np.newaxis] * [1.0, 0, 0]
    carried = carry_markers(replace(walk, positions=slid), static, [THIGH, other])
    assert_allclose(carried.marker("KNEE"), static.marker("KNEE") + np.array([0.01, 0, 0]), atol=1e-12)


def test_a_cluster_may_use_what_was_carried_before():
    static = _still(np.concatenate((BODY, [[0.0, 0.0, 0.1]])), (*NAMES, "ANKLE"))
    chain = [THIGH, Segment(("KNEE", "T3", "T2"), ("ANKLE",))]
    assert_allclose(
        carry_markers(_only(static, NAMES[:3]), static, chain).marker("ANKLE"), static.marker("ANKLE"), atol=1e-12
    )


def test_markers_of_the_walk_are_kept():
    walk = _still(BODY + 0.001, NAMES, name="anna")
    assert_allclose(carry_markers(walk, STATIC, [THIGH]).positions, walk.positions)
    assert carry_markers(_only(walk, NAMES[:3]), _only(STATIC, NAMES[:3]), [THIGH]).marker_set.names == NAMES[:3]


def test_gaps_stay_gaps():
    positions = STATIC.positions[:, :3].copy()
    positions[1, 2] = np.nan
    carried = carry_markers(Walk(positions, 100, MarkerSet(NAMES[:3])), STATIC, [THIGH])
    assert np.isnan(carried.marker("KNEE")).any(axis=1).tolist() == [False, True, False]
    seen_once = STATIC.positions.copy()
    seen_once[:2, 3] = np.nan
    carried = carry_markers(_only(STATIC, NAMES[:3]), replace(STATIC, positions=seen_once), [THIGH])
    assert_allclose(carried.marker("KNEE"), STATIC.marker("KNEE"), atol=1e-12)


LINE = np.array([[0.0, 0.1, 0.7], [0.0, 0.1, 0.6], [0.0, 0.1, 0.5], [0.05, 0.0, 0.4]])
LOST = np.where(np.arange(4)[:, np.newaxis] == 1, np.nan, BODY)


@pytest.mark.parametrize(
    ("static", "segment", "message"),
    [
        (STATIC, Segment(("T1", "T2", "T9"), ("KNEE",)), "needs T9, which the walk lacks; it has T1, T2, T3"),
        (
            _still(BODY[1:], NAMES[1:], name="static"),
            THIGH,
            "needs T1, which the static trial lacks; it has T2, T3, KN",
        ),
        (_still(LINE, NAMES, name="static"), THIGH, r"\(T1, T2, T3\) must have at least three markers .* not on one"),
        (STATIC, Segment(("T1", "T2"), ("KNEE",)), r"\(T1, T2\) must have at least three markers that are not on one"),
        (_still(LOST, NAMES, name="static"), THIGH, r"\(T1, T2, T3\) is never seen as a whole in the static trial"),
        (
            _still(1.5 * BODY, NAMES, name="static"),
            THIGH,
            r"another shape .*, by 4. mm, expected up to 30 mm; is it the",
        ),
    ],
)
def test_clusters_that_cannot_carry_are_refused(static, segment, message):
    walk = replace(_only(STATIC, NAMES[:3]), name="anna")
    with pytest.raises(
        WalkError, match=f"'anna' with static trial 'static': the cluster that carries KNEE .*{message}"
    ):
        carry_markers(walk, static, [segment])


def test_a_marker_that_is_never_seen_cannot_be_carried():
    static = _still(np.where(np.arange(4)[:, np.newaxis] == 3, np.nan, BODY), NAMES, name="static")
    with pytest.raises(WalkError, match="KNEE is never seen in the static trial"):
        carry_markers(_only(STATIC, NAMES[:3]), static, [THIGH])


def test_a_chain_is_moved_as_little_as_possible():
    rng = np.random.default_rng(0)
    chain = np.array([[0, 0.1, 0.9], [0.05, 0.1, 0.5], [0, 0.1, 0.1]]) + 0.02 * rng.normal(size=(5, 3, 3))
    lengths = np.array([0.41, 0.38])
    held = hold_lengths(chain, lengths)
    assert_allclose(np.linalg.norm(np.diff(held, axis=1), axis=2), np.tile(lengths, (5, 1)), atol=1e-12)
    for points, nearest in zip(chain, held, strict=True):
        found = minimize(
            lambda p, points=points: np.sum((p - points.ravel()) ** 2),
            points.ravel(),
            constraints={
                "type": "eq",
                "fun": lambda p: np.linalg.norm(np.diff(p.reshape(3, 3), axis=0), axis=1) - lengths,
            },
            options={"ftol": 1e-14},
        )
        assert_allclose(nearest.ravel(), found.x, atol=1e-6)
    assert_allclose(hold_lengths(held, lengths), held, atol=1e-12)


def test_gaps_do_not_spread_along_a_chain_of_frames():
    chain = np.array([[[0, 0, 0.9], [0.05, 0, 0.5], [0, 0, 0.1]]] * 3)
    chain[1, 1] = np.nan
    held = hold_lengths(chain, np.array([0.4, 0.4]))
    assert np.isnan(held).any(axis=(1, 2)).tolist() == [False, True, False]


@cache
def _recording(build, seed=0):
    """Return a walk without the markers of knees and ankles that its static trial has, and the static trial.

    Skin moves: the cluster markers slide by some millimetres.
    """
    body = known_body(seed)
    whole = build(body)
    rng = np.random.default_rng(seed)
    names = [name for name in whole.marker_set.names if name[1:] not in ("KNM", "MED")]
    walk = _only(whole, [name for name in names if "KNEE" not in name and "ANKLE" not in name])
    walk = replace(walk, positions=walk.positions + 0.004 * rng.normal(size=walk.positions.shape))
    return walk, replace(whole, positions=whole.positions[:1], name="static")


RECORDINGS = pytest.mark.parametrize("build", [plug_in_gait_markers, horst_markers])


@RECORDINGS
def test_knees_and_ankles_come_back(build):
    """With 4 mm of noise on each marker; bones of the synthetic body are rigid."""
    walk, static = _recording(build)
    placed = walk.to_markers(static=static)
    body = known_body()
    for side in ("left", "right"):
        for joint in ("knee", "ankle"):
            error = placed.marker(f"{side}_{joint}") - body.marker(f"{side}_{joint}")
            assert np.sqrt((error**2).sum(axis=1).mean()) < 0.015
        thigh = np.linalg.norm(placed.marker(f"{side}_hip") - placed.marker(f"{side}_knee"), axis=1)
        assert_allclose(thigh, np.linalg.norm(body.marker(f"{side}_hip") - body.marker(f"{side}_knee"), axis=1)[0])


@RECORDINGS
@given(rotation=_turns, shift=_shifts)
def test_markers_turn_and_move_with_the_walk(build, rotation, shift):
    walk, static = _recording(build)
    walk = replace(walk, positions=walk.positions[:5])
    expected = moved(walk.to_markers(static=static, feet=True), rotation, shift)
    assert_allclose(moved(walk, rotation, shift).to_markers(static=static, feet=True).positions, expected.positions)


@RECORDINGS
@pytest.mark.parametrize("with_static", [True, False])
def test_what_is_left_and_right_changes_places_in_a_mirror(build, with_static):
    walk, static = _recording(build)
    if with_static:
        seen = mirrored(walk).to_markers(static=mirrored(static))
        walk = walk.to_markers(static=static)
    else:
        seen, walk = mirrored(build(known_body())).to_markers(), build(known_body()).to_markers()
    assert_allclose(seen.positions, mirror_walk(walk).positions, atol=1e-12)


@RECORDINGS
def test_a_frame_depends_on_no_other(build):
    walk, static = _recording(build)
    whole = walk.to_markers(static=static)
    part = replace(walk, positions=walk.positions[30:40]).to_markers(static=static)
    assert_allclose(part.positions, whole.positions[30:40], atol=1e-12)


def test_the_pelvis_stays_between_its_hips():
    walk, static = _recording(horst_markers)
    placed = walk.to_markers(static=static)
    assert_allclose(placed.marker("pelvis"), (placed.marker("left_hip") + placed.marker("right_hip")) / 2, atol=1e-12)


def test_a_static_trial_must_be_a_walk():
    walk, static = _recording(horst_markers)
    with pytest.raises(TypeError, match="static must be a Walk, the static trial, got ndarray"):
        walk.to_markers(static=static.positions)
    unseen = static.positions.copy()
    unseen[:, static.marker_set.index("L GTROCH")] = np.nan
    with pytest.raises(WalkError, match="static trial 'static': the markers of the left leg are never seen"):
        walk.to_markers(static=replace(static, positions=unseen))


@pytest.fixture(scope="module")
def horst(data_dir):
    """Return the ten walks and the static trial of `horst_c3d`."""
    folder = data_dir / "horst_c3d"
    static = read_c3d(folder / "S01_0001_Static.c3d")
    return [read_c3d(path) for path in sorted(folder.glob("*Gait.c3d"))], static


def test_recorded_segments_keep_their_lengths(horst):
    """Largest distance from the median within a walk, 5 mm.

    Thighs and shanks are held; upper arms and forearms have markers on both sides of their joints in every frame.
    """
    walks, static = horst
    assert len(walks) == 10
    for walk in walks:
        placed = walk.to_markers(static=static)
        for side in ("left", "right"):
            for ends in (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle")):
                first, second = (placed.marker(f"{side}_{end}") for end in ends)
                lengths = np.linalg.norm(first - second, axis=1)
                assert np.abs(lengths - np.median(lengths)).max() < 0.005, (walk.name, side, ends)


def test_holding_the_lengths_moves_recorded_joints_by_no_more_than_skin_moves(horst):
    """Without it thighs change by up to 26 mm from their median, as the skin slides over the trochanters."""
    walks, static = horst
    for walk in walks:
        placed = walk.to_markers(static=static)
        own = 0.75 * walk.marker("L GTROCH") + 0.25 * walk.marker("R GTROCH")
        assert np.linalg.norm(placed.marker("left_hip") - own, axis=1).max() < 0.02


def test_clusters_of_recorded_walks_fit_those_of_the_static_trial(horst):
    """Each carried marker lands where its neighbours on the skin are: heel and ankle on one foot."""
    walks, static = horst
    for walk in walks:
        placed = walk.to_markers(static=static, feet=True)
        for side in ("left", "right"):
            reach = np.linalg.norm(placed.marker(f"{side}_ankle") - placed.marker(f"{side}_heel"), axis=1)
            still = static.to_markers(feet=True)
            expected = np.linalg.norm(still.marker(f"{side}_ankle") - still.marker(f"{side}_heel"), axis=1).mean()
            assert np.abs(reach - expected).max() < 0.025, (walk.name, side)
