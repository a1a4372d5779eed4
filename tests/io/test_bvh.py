"""BVH files: joint positions against the definition of the format, then hand-made files."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker._validation import WalkError
from eigenwalker.io import read_bvh
from eigenwalker.motion.walk import JointWalk

POSITIONS = ("Xposition", "Yposition", "Zposition")
ROTATIONS = ("Xrotation", "Yrotation", "Zrotation")


@dataclass
class Body:
    """A random file: for each joint its parent, offset and channels, then the ends and the numbers."""

    parents: list
    offsets: list
    channels: list
    ends: dict
    motion: np.ndarray


@st.composite
def bodies(draw):
    """Draw a tree with channels in any order and number, different ones on every joint."""
    numbers = st.integers(-200, 200).map(lambda value: value / 8)
    triples = st.tuples(numbers, numbers, numbers)
    n_joints = draw(st.integers(1, 6))
    parents = [-1] + [draw(st.integers(0, joint - 1)) for joint in range(1, n_joints)]
    names = st.lists(st.sampled_from(POSITIONS + ROTATIONS), unique=True, max_size=6)
    channels = [draw(names) for _ in range(n_joints)]
    if not any(channels):
        channels[0] = ["Zrotation"]
    ends = {joint: draw(triples) for joint in range(n_joints) if joint not in parents}
    n_frames, n_channels = draw(st.integers(1, 4)), sum(map(len, channels))
    angles = st.integers(-400, 400).map(lambda value: value * 1.25)
    motion = [[draw(angles) for _ in range(n_channels)] for _ in range(n_frames)]
    return Body(parents, [draw(triples) for _ in range(n_joints)], channels, ends, np.array(motion))


def bvh_text(body, *, word=str, newline="\n", gap=" ", brace="\n"):
    """Return the body as the text of a file; `word` spells keywords and channels."""
    lines = [word("HIERARCHY")]

    def block(joint):
        title = word("ROOT") if joint == 0 else word("JOINT")
        lines.append(f"{title}{gap}joint {joint}{brace}{{")
        lines.append(gap + gap.join([word("OFFSET"), *map(str, body.offsets[joint])]))
        channels = body.channels[joint]
        lines.append(gap + gap.join([word("CHANNELS"), str(len(channels)), *map(word, channels)]) + gap)
        for child in (child for child, parent in enumerate(body.parents) if parent == joint):
            block(child)
        if joint in body.ends:
            offset = gap.join(map(str, body.ends[joint]))
            lines.extend([f"{word('End')}{gap}{word('Site')}{brace}{{", word("OFFSET") + gap + offset, "}"])
        lines.append("}")

    block(0)
    lines.extend([word("MOTION"), f"{word('Frames')}:{gap}{len(body.motion)}"])
    lines.append(f"{word('Frame')}{gap}{word('Time')}:{gap}.0083333")
    order = np.concatenate([_columns(body, joint) for joint in _file_order(body)]).astype(int)
    lines.extend(gap.join(map(str, row[order])) + gap for row in body.motion)
    return newline.join("\n".join(lines).split("\n")) + newline


def _file_order(body, joint=0):
    """Return the joints in the order of the file, each before its children."""
    children = [child for child, parent in enumerate(body.parents) if parent == joint]
    return [joint, *itertools.chain.from_iterable(_file_order(body, child) for child in children)]


def _columns(body, joint):
    first = sum(len(channels) for channels in body.channels[:joint])
    return list(range(first, first + len(body.channels[joint])))


def _elementary(axis, degrees):
    """Return the 4 x 4 matrix of a turn about one axis."""
    matrix = np.eye(4)
    first, second = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
    sine, cosine = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    matrix[first, first] = matrix[second, second] = cosine
    matrix[first, second], matrix[second, first] = -sine, sine
    return matrix


def _transform(body, joint, row):
    """Return the 4 x 4 matrix from a joint to the room, straight from the definition of the format."""
    local = np.array(body.offsets[joint], dtype=float)
    turn = np.eye(4)
    for channel, value in zip(body.channels[joint], row[_columns(body, joint)], strict=True):
        if channel.endswith("position"):
            local["XYZ".index(channel[0])] = value
        else:
            turn = turn @ _elementary(channel[0], value)
    move = np.eye(4)
    move[:3, 3] = local
    above = np.eye(4) if joint == 0 else _transform(body, body.parents[joint], row)
    return above @ move @ turn


def _expected(body, up):
    """Return joints (n_frames, n_joints, 3) in the order of the body, and ends, in metres."""
    joints = [[_transform(body, joint, row)[:3, 3] for joint in range(len(body.parents))] for row in body.motion]
    ends = [
        [(_transform(body, joint, row) @ [*offset, 1])[:3] for joint, offset in body.ends.items()]
        for row in body.motion
    ]
    axes = [2, 0, 1] if up == "y" else [0, 1, 2]
    return 0.01 * np.array(joints)[..., axes], 0.01 * np.array(ends)[..., axes]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder that the examples of one law share."""
    return tmp_path_factory.mktemp("bvh")


def _read(folder, text, **options):
    path = folder / "walk.bvh"
    path.write_bytes(text.encode())
    return read_bvh(path, **options)


@settings(max_examples=100, deadline=None)
@given(body=bodies(), up=st.sampled_from(["y", "z"]))
def test_positions_follow_the_definition(folder, body, up):
    walk = _read(folder, bvh_text(body), up=up)
    order = [int(name.removeprefix("joint ")) for name in walk.skeleton.joint_names]
    joints, ends = _expected(body, up)
    # Sums of up to six lengths of less than 5 m: rounding leaves some 1e-15 m.
    assert_allclose(walk.joint_positions(), joints[:, order], atol=1e-12)
    tips = [list(body.ends).index(order[parent]) for parent in walk.skeleton.end_parents]
    assert_allclose(walk.end_positions(), ends[:, tips], atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(
    body=bodies(),
    word=st.sampled_from([str.upper, str.lower, str.title]),
    newline=st.sampled_from(["\n", "\r\n", "\r", "\n\n", "\n \t \n"]),
    gap=st.sampled_from([" ", "\t", "   "]),
    brace=st.sampled_from(["\n", " ", ""]),
)
def test_spelling_does_not_matter(folder, body, word, newline, gap, brace):
    plain = _read(folder, bvh_text(body))
    other = _read(folder, "\ufeff" + bvh_text(body, word=word, newline=newline, gap=gap, brace=brace))
    assert other.skeleton.joint_names == plain.skeleton.joint_names
    assert_array_equal(other.rotations, plain.rotations)
    assert_array_equal(other.joint_positions(), plain.joint_positions())


@settings(max_examples=40, deadline=None)
@given(body=bodies())
def test_unit_scales_and_up_permutes(folder, body):
    text = bvh_text(body)
    walk = _read(folder, text, up="z", unit="cm")
    inches = _read(folder, text, up="z", unit="in")
    turned = _read(folder, text, up="y", unit=0.01)
    assert_allclose(inches.joint_positions(), 2.54 * walk.joint_positions(), atol=1e-12)
    assert_allclose(turned.joint_positions(), walk.joint_positions()[..., [2, 0, 1]], atol=1e-12)
    assert_allclose(turned.rotations, walk.rotations[..., [2, 0, 1]], atol=1e-12)


@settings(max_examples=100, deadline=None)
@given(body=bodies(), data=st.data())
def test_any_text_is_read_or_refused(folder, body, data):
    text = bvh_text(body)
    place = data.draw(st.integers(0, len(text)))
    length = data.draw(st.integers(0, 12))
    put = data.draw(st.sampled_from(["", "{", "}", "nan", "1e308 ", "\n", "MOTION\n", "é", "-", "\0", "9999"]))
    broken = text[:place] + put + text[place + length :]
    try:
        walk = _read(folder, data.draw(st.sampled_from([broken, broken[:place], broken + put])))
    except WalkError as error:
        assert "walk.bvh, line " in str(error)  # noqa: PT017
    else:
        assert isinstance(walk, JointWalk)


TWO_JOINTS = """HIERARCHY
ROOT reference
{
  OFFSET 1 2 3
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT pelvis
  {
    OFFSET 0 90 0
    CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 10 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.0333333
0 0 0 0 0 0  0 95 10 0 90 0
0 0 0 0 0 0  0 95 20 0 90 0
"""


def test_root_is_the_first_joint_that_moves(tmp_path):
    walk = _read(tmp_path, TWO_JOINTS)
    assert walk.skeleton.root == 1
    assert_allclose(walk.root, [[0.1, 0, 0.95], [0.2, 0, 0.95]])
    assert walk.translations == {}
    assert_array_equal(walk.skeleton.offsets[0], 0)  # its position channels replace its OFFSET


def test_turn_about_the_left_axis_tips_the_body_forward(tmp_path):
    walk = _read(tmp_path, TWO_JOINTS)
    assert_allclose(walk.rotations[0, 1], [0, math.pi / 2, 0])
    assert_allclose(walk.end_positions()[0, 0], [0.1 + 0.1, 0, 0.95], atol=1e-12)


def test_other_joints_that_move_keep_their_path(tmp_path):
    walk = _read(tmp_path, TWO_JOINTS.replace("\n0 0 0 0 0 0  0 95 20", "\n7 0 0 0 0 0  0 95 20"))
    assert walk.skeleton.root == 0
    assert list(walk.translations) == ["pelvis"]
    assert_allclose(walk.translations["pelvis"][:, 0], [0.1, 0.2])
    assert_allclose(walk.joint_positions()[1, 1], [0.2, 0.07, 0.95])


def test_without_position_channels_the_root_stays_at_its_offset(tmp_path):
    text = TWO_JOINTS.replace("CHANNELS 6 Xposition Yposition Zposition", "CHANNELS 3")
    walk = _read(tmp_path, text.replace("0 0 0 0 0 0  0 95 10", "0 0 0").replace("0 0 0 0 0 0  0 95 20", "0 0 0"))
    assert walk.skeleton.root == 0
    assert_allclose(walk.root, [[0.03, 0.01, 0.02]] * 2)


def test_rotations_do_not_jump(tmp_path):
    turns = np.arange(0, 900, 30)
    rows = "\n".join(f"0 0 0 0 0 0 0 95 10 0 0 {(turn + 180) % 360 - 180}" for turn in turns)
    head = TWO_JOINTS.replace("Frames: 2", f"Frames: {len(turns)}").split("0 0 0 0 0 0  0 95 10")[0]
    walk = _read(tmp_path, head + rows)
    assert_allclose(walk.rotations[:, 1, 2], np.deg2rad(turns), atol=1e-9)


@pytest.mark.parametrize(
    ("seconds", "rate"),
    [("0.0333333", 30), (".0083333", 120), ("0.016667", 60), ("0.0333667", 1 / 0.0333667), ("1.5", 1 / 1.5)],
)
def test_frame_rate_is_whole_where_the_digits_allow(tmp_path, seconds, rate):
    assert _read(tmp_path, TWO_JOINTS.replace("0.0333333", seconds)).frame_rate == rate


def test_name_is_the_stem_unless_given(tmp_path):
    assert _read(tmp_path, TWO_JOINTS).name == "walk"
    assert _read(tmp_path, TWO_JOINTS, name="anna").name == "anna"


def test_one_frame_is_enough(tmp_path):
    walk = _read(tmp_path, TWO_JOINTS.replace("Frames: 2", "Frames: 1").rsplit("\n", 2)[0])
    assert walk.n_frames == 1
    assert_allclose(walk.joint_positions()[0, 1], [0.1, 0, 0.95])


@pytest.mark.parametrize(
    ("options", "kind", "match"),
    [
        ({"unit": "feet"}, ValueError, "unit must be one of 'm', 'cm', 'mm', 'in', got 'feet'"),
        ({"unit": 0.0}, ValueError, "unit must be positive and finite"),
        ({"unit": None}, TypeError, "unit must be one of"),
        ({"up": "x"}, ValueError, "up must be one of 'y', 'z', got 'x'"),
    ],
)
def test_options_are_checked_before_the_file(tmp_path, options, kind, match):
    with pytest.raises(kind, match=match):
        read_bvh(tmp_path / "missing.bvh", **options)


def test_missing_file_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"missing\.bvh"):
        read_bvh(tmp_path / "missing.bvh")
