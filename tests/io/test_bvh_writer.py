"""BVH files that are written: what is read back is the walk, for all orders of axes and all recorded walks."""

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

from eigenwalker._validation import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.io import read_bvh
from eigenwalker.io.bvh_writer import write_bvh
from eigenwalker.motion import JointWalk, Skeleton, rotvec_from_euler, unroll_rotvec

ORDERS = ["".join(order) for order in itertools.permutations("XYZ")]
RATES = [24, 25, 30, 50, 59.94, 60, 100, 119.88, 120, 23.976, 29.97, 240]


@st.composite
def joint_walks(draw):
    """Draw a walk on any tree, with any orders, with quarter turns, and with joints that move besides the root."""
    n_joints, n_frames = draw(st.integers(1, 6)), draw(st.integers(1, 4))
    parents = [-1] + [draw(st.integers(0, joint - 1)) for joint in range(1, n_joints)]
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    # Multiples of a quarter turn meet gimbal lock; others do not.
    angles = rng.choice([rng.uniform(-4, 4), np.pi / 2, -np.pi / 2, np.pi, 0.0], (n_frames, n_joints, 3))
    turns = np.stack([rotvec_from_euler(angles[:, joint], rng.choice(ORDERS)) for joint in range(n_joints)], axis=1)
    names = [f"joint {number}" for number in range(n_joints)]
    n_ends = draw(st.integers(0, 3))
    skeleton = Skeleton(
        names,
        parents,
        rng.normal(size=(n_joints, 3)),
        rng.integers(0, n_joints, n_ends),
        rng.normal(size=(n_ends, 3)),
        int(rng.integers(0, n_joints)),
        draw(st.none() | st.lists(st.sampled_from(ORDERS), min_size=n_joints, max_size=n_joints).map(tuple)),
    )
    moving = draw(st.sets(st.sampled_from(names)))
    return JointWalk(
        unroll_rotvec(turns),
        rng.normal(size=(n_frames, 3)),
        skeleton,
        draw(st.sampled_from(RATES)),
        translations={name: rng.normal(size=(n_frames, 3)) for name in moving},
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder that the examples of one law share."""
    return tmp_path_factory.mktemp("bvh")


def _matrices(walk, names=None):
    """Return rotation matrices, shape (n_frames n_joints, 3, 3), of the joints in the order of `names`."""
    columns = [walk.skeleton.joint_names.index(name) for name in names or walk.skeleton.joint_names]
    return Rotation.from_rotvec(walk.rotations[:, columns].reshape(-1, 3)).as_matrix()


def _there_and_back(walk, folder, **options):
    write_bvh(walk, folder / "walk.bvh", **options)
    options.pop("orders", None)
    return read_bvh(folder / "walk.bvh", **options)


@settings(max_examples=150, deadline=None)
@given(walk=joint_walks(), up=st.sampled_from(["y", "z"]), unit=st.sampled_from(["m", "cm", "mm", "in", 0.0564]))
def test_any_walk_comes_back(folder, walk, up, unit):
    again = _there_and_back(walk, folder, up=up, unit=unit)
    names = walk.skeleton.joint_names
    columns = [again.skeleton.joint_names.index(name) for name in names]
    assert_allclose(_matrices(again, names), _matrices(walk), atol=1e-6)
    assert_allclose(again.joint_positions()[:, columns], walk.joint_positions(), atol=1e-6)
    assert again.frame_rate == walk.frame_rate
    if walk.skeleton.rotation_orders is not None:
        assert tuple(again.skeleton.rotation_orders[column] for column in columns) == walk.skeleton.rotation_orders
    ends = [
        sorted((w.skeleton.joint_names[parent], *offset.round(6)) for parent, offset in _tips(w)) for w in (walk, again)
    ]
    assert_allclose([end[1:] for end in ends[0]], [end[1:] for end in ends[1]], atol=2e-6)
    assert [end[0] for end in ends[0]] == [end[0] for end in ends[1]]


def _tips(walk):
    """Return joint and offset of each tip, with tips of length zero where a chain has none, as the file has them."""
    skeleton = walk.skeleton
    bare = set(range(len(skeleton.joint_names))) - set(skeleton.parents.tolist()) - set(skeleton.end_parents.tolist())
    tips = list(zip(skeleton.end_parents.tolist(), np.asarray(skeleton.end_offsets) + 0.0, strict=True))
    return tips + [(joint, np.zeros(3)) for joint in bare]


@settings(max_examples=60, deadline=None)
@given(walk=joint_walks(), order=st.sampled_from(ORDERS))
def test_orders_can_be_asked_for(folder, walk, order):
    again = _there_and_back(walk, folder, orders=order)
    assert_allclose(_matrices(again, walk.skeleton.joint_names), _matrices(walk), atol=1e-6)
    assert _channels(folder / "walk.bvh") == [list(order)] * len(walk.skeleton.joint_names)
    last = walk.skeleton.joint_names[-1]
    write_bvh(walk, folder / "walk.bvh", orders={last: order})
    assert _channels(folder / "walk.bvh")[again.skeleton.joint_names.index(last)] == list(order)


def _channels(path):
    """Return the letters of each joint's rotation channels, in the order of the file."""
    return [re.findall(r"(\w)rotation", line) for line in path.read_text().splitlines() if "CHANNELS" in line]


TEXT = """HIERARCHY
ROOT hips
{
  OFFSET 1 2 3
  CHANNELS 6 Xposition Yposition Zposition {root}
  JOINT knee
  {
    OFFSET 0 -40 0
    CHANNELS {knee}
    End Site
    {
      OFFSET 0 -45 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.0333667
"""


@settings(max_examples=60, deadline=None)
@given(
    root=st.permutations("XYZ"),
    knee=st.lists(st.sampled_from("XYZ"), unique=True, max_size=3),
    seed=st.integers(0, 1000),
    up=st.sampled_from(["y", "z"]),
)
def test_files_with_other_channels_come_back(folder, root, knee, seed, up):
    """Joints with fewer than three rotation channels are written with three, their own ones first."""
    words = [" ".join(f"{axis}rotation" for axis in axes) for axes in (root, knee)]
    head = TEXT.replace("{root}", words[0]).replace("{knee}", f"{len(knee)} {words[1]}")
    rows = np.random.default_rng(seed).integers(-12, 13, (3, 6 + len(knee))) * 15.0
    (folder / "made.bvh").write_text(head + "\n".join(" ".join(map(str, row)) for row in rows))
    walk = read_bvh(folder / "made.bvh", up=up)
    again = _there_and_back(walk, folder, up=up)
    assert_allclose(_matrices(again), _matrices(walk), atol=1e-6)
    assert_allclose(again.end_positions(), walk.end_positions(), atol=1e-6)
    assert again.skeleton.rotation_orders == walk.skeleton.rotation_orders
    assert again.frame_rate == walk.frame_rate
    written = _channels(folder / "walk.bvh")
    assert written[0] == list(root)
    assert written[1][: len(knee)] == knee


def test_angles_do_not_jump_where_two_axes_meet(tmp_path):
    """A middle angle that goes through a quarter turn and on goes on in the file, too."""
    smooth = np.stack([np.linspace(-1, 2, 200), np.linspace(-1, 5, 200), np.linspace(0.5, 0, 200)], axis=-1)
    turns = rotvec_from_euler(smooth, "XYZ")[:, np.newaxis]
    walk = JointWalk(turns, np.zeros((200, 3)), Skeleton(("hips",), [-1], np.zeros((1, 3))), 60)
    write_bvh(walk, tmp_path / "walk.bvh", up="z", orders="XYZ")
    written = np.loadtxt((tmp_path / "walk.bvh").read_text().splitlines()[-200:])[:, 3:]
    assert_allclose(np.deg2rad(written), smooth, atol=1e-7)


@pytest.mark.parametrize(("source", "unit", "count"), [("bandai2", "cm", 175), ("cmu_bvh", 0.0564, 27)])
def test_recorded_walks_come_back(data_dir, tmp_path, source, unit, count):
    paths = sorted((data_dir / source).glob("*.bvh"))
    assert len(paths) == count
    for path in paths:
        walk = read_bvh(path, unit=unit)
        again = _there_and_back(walk, tmp_path, unit=unit)
        # Rotations as they are unrolled: the branch of each map is the same one. Maps near a full turn would
        # amplify the rounding; none is.
        assert_allclose(again.rotations, walk.rotations, atol=1e-6, err_msg=path.name)
        assert_allclose(_matrices(again), _matrices(walk), atol=1e-6, err_msg=path.name)
        assert_allclose(again.joint_positions(), walk.joint_positions(), atol=1e-6, err_msg=path.name)
        assert_allclose(again.end_positions(), walk.end_positions(), atol=1e-6, err_msg=path.name)
        assert_allclose(again.root, walk.root, atol=1e-6, err_msg=path.name)
        for field in ("joint_names", "root", "rotation_orders"):
            assert getattr(again.skeleton, field) == getattr(walk.skeleton, field)
        assert_array_equal(again.skeleton.end_parents, walk.skeleton.end_parents)
        assert again.frame_rate == walk.frame_rate
        assert _channels(tmp_path / "walk.bvh") == _channels(path)


def _walk(**changes):
    skeleton = Skeleton(("base", "hips"), [-1, 0], [[0, 0, 0], [0, 0, 0.9]], end_parents=[1], end_offsets=[[0, 0, 0.1]])
    path = np.array([[0.0, 0, 0.9], [0.1, 0, 0.9]])
    walk = JointWalk(np.zeros((2, 2, 3)), path, replace(skeleton, root=1), 100, "anna")
    return replace(walk, **changes)


def test_only_what_moves_has_position_channels(tmp_path):
    write_bvh(_walk(), tmp_path / "walk.bvh")
    text = (tmp_path / "walk.bvh").read_text()
    assert text.count("CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation") == 2
    assert text.splitlines()[-1] == " ".join(
        ["0.000000"] * 6 + ["0.000000", "90.000000", "10.000000"] + ["0.000000"] * 3
    )
    still = replace(_walk().skeleton, root=0)
    write_bvh(_walk(skeleton=still), tmp_path / "walk.bvh")
    assert "CHANNELS 3 Zrotation Xrotation Yrotation" in (tmp_path / "walk.bvh").read_text()


def test_frame_rates_come_back(tmp_path):
    for rate in [*RATES, *np.arange(1001, 30000, 97) / 100, 1e-3, 48000.0]:
        if rate == round(rate) or abs(rate - round(rate)) > 1e-3 * rate:
            assert _there_and_back(_walk(frame_rate=rate), tmp_path).frame_rate == rate
    long = 1000 / 8.3417
    assert _there_and_back(_walk(frame_rate=long), tmp_path).frame_rate == pytest.approx(long, rel=3e-16)


def test_a_large_file_is_written_fast_and_small(tmp_path):
    rng = np.random.default_rng(0)
    names = [f"j{number}" for number in range(31)]
    skeleton = Skeleton(names, np.arange(-1, 30), np.zeros((31, 3)))
    turns = unroll_rotvec(np.cumsum(0.01 * rng.normal(size=(2752, 31, 3)), axis=0))
    walk = JointWalk(turns, rng.normal(size=(2752, 3)), skeleton, 120)
    again = _there_and_back(walk, tmp_path)
    assert_allclose(_matrices(again), _matrices(walk), atol=1e-6)
    assert (tmp_path / "walk.bvh").stat().st_size < 11 * 2752 * 96


@pytest.mark.parametrize(
    ("changes", "options", "kind", "match"),
    [
        ({}, {"unit": "feet"}, ValueError, "unit must be one of"),
        ({}, {"up": "x"}, ValueError, "up must be one of 'y', 'z', got 'x'"),
        ({}, {"orders": "ZXZ"}, ValueError, "orders must have X, Y and Z once each, such as 'ZXY', got 'ZXZ'"),
        ({}, {"orders": {"tail": "ZXY"}}, ValueError, "orders must name joints of the skeleton, got tail; it has base"),
        ({"rotations": np.full((2, 2, 3), np.nan)}, {}, WalkError, "walk 'anna': expected finite values"),
        ({"root": np.full((2, 3), np.inf)}, {}, WalkError, "walk 'anna': expected finite values"),
        ({"skeleton": Skeleton(("a{b", "c"), [-1, 0], np.zeros((2, 3)))}, {}, WalkError, r"joint 'a\{b' needs a name"),
        (
            {"skeleton": Skeleton(("a", "c\nd"), [-1, 0], np.zeros((2, 3)))},
            {},
            WalkError,
            "needs a name without braces",
        ),
    ],
)
def test_wrong_input_is_refused(tmp_path, changes, options, kind, match):
    with pytest.raises(kind, match=match):
        write_bvh(_walk(**changes), tmp_path / "walk.bvh", **options)
    assert not (tmp_path / "walk.bvh").exists()


def test_markers_are_refused(tmp_path):
    with pytest.raises(TypeError, match="expected a JointWalk, got Walk; markers have no joints to turn"):
        write_bvh(make_walkers(1, random_state=0).data[0], tmp_path / "walk.bvh")


def test_orders_of_a_skeleton_are_checked():
    for orders in (("XYZ",), ("XYZ", "XYX"), "XYZ"):
        with pytest.raises(ValueError, match="rotation_orders must be 2 orders of X, Y and Z, one a joint, got"):
            replace(_walk().skeleton, rotation_orders=orders)
