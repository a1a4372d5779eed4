"""ASF/AMC: positions against the definition of the format, then a small body."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker._validation import WalkError
from eigenwalker.io.amc import read_amc
from eigenwalker.io.bvh import read_bvh
from eigenwalker.io.bvh_writer import write_bvh
from eigenwalker.motion import find_rig, stand_upright
from eigenwalker.motion.walk import JointWalk
from tests.acclaim import AMC, ASF, BODY, ROOT_ORDER, Bone, amc_text, asf_text, stand

INCH = 0.0254


def _elementary(axis, degrees):
    sine, cosine = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis.lower()]
    matrix = np.eye(3)
    matrix[first, first] = matrix[second, second] = cosine
    matrix[first, second], matrix[second, first] = -sine, sine
    return matrix


def _turn(axes, angles):
    """Return the matrix of turns about fixed axes, the first one first."""
    matrix = np.eye(3)
    for axis, angle in zip(axes, angles, strict=True):
        matrix = _elementary(axis, angle) @ matrix
    return matrix


def _expected(bones, frame, root_order, position):
    """Return start and end of each bone in the units and axes of the file, straight from the definition."""
    values = dict(zip(root_order, frame["root"], strict=True))
    turns = [(axis[1], value) for axis, value in values.items() if axis.startswith("R")]
    start = np.array(position) + [values.get(f"T{axis}", 0) for axis in "XYZ"]
    held = {"root": (start, _turn(*zip(*turns, strict=True)) if turns else np.eye(3))}
    starts = {"root": start}
    for name, bone in bones.items():  # parents come first in these bodies
        place, above = held[bone.parent]
        frame_of_bone = _turn(bone.order, bone.axis)
        turned = _turn([axis[1] for axis in bone.dof], frame.get(name, ()))
        matrix = above @ frame_of_bone @ turned @ np.linalg.inv(frame_of_bone)
        starts[name] = place
        held[name] = (place + matrix @ (bone.length * np.array(bone.direction)), matrix)
    return starts, {name: end for name, (end, _) in held.items()}


_numbers = st.integers(-40, 40).map(lambda value: value / 8)
_angles = st.integers(-360, 360).map(lambda value: value * 1.25)
_triples = st.tuples(_numbers, _numbers, _numbers)


@st.composite
def bodies(draw):
    """Draw a tree of bones with any axes and degrees of freedom, and some frames."""
    bones = {}
    for number in range(draw(st.integers(1, 6))):
        parent = draw(st.sampled_from(["root", *bones]))
        dof = draw(st.lists(st.sampled_from(["rx", "ry", "rz"]), unique=True, max_size=3))
        axis = draw(st.tuples(_angles, _angles, _angles))
        order = "".join(draw(st.permutations("XYZ")))
        bones[f"bone{number}"] = Bone(parent, draw(_triples), draw(_numbers), axis, order, tuple(dof))
    root_order = tuple(draw(st.permutations(ROOT_ORDER))[: draw(st.integers(1, 6))])
    moving = [name for name, bone in bones.items() if bone.dof]
    frames = [
        {"root": [draw(_angles) for _ in root_order]}
        | {name: [draw(_angles) for _ in bones[name].dof] for name in moving}
        for _ in range(draw(st.integers(1, 3)))
    ]
    return bones, root_order, draw(_triples), frames


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder that the examples of one law share."""
    return tmp_path_factory.mktemp("amc")


def _read(folder, asf, amc, **options):
    (folder / "07.asf").write_bytes(asf if isinstance(asf, bytes) else asf.encode())
    (folder / "07_01.amc").write_bytes(amc if isinstance(amc, bytes) else amc.encode())
    return read_amc(folder / "07_01.amc", **options)


@settings(max_examples=80, deadline=None)
@given(body=bodies(), up=st.sampled_from(["y", "z"]))
def test_positions_follow_the_definition(folder, body, up):
    bones, root_order, position, frames = body
    asf = asf_text(bones, root_order=root_order, position=position)
    walk = _read(folder, asf, amc_text(frames), up=up, unit=0.5)
    axes = [2, 0, 1] if up == "y" else [0, 1, 2]
    names = walk.skeleton.joint_names
    joints, tips = walk.joint_positions(), walk.end_positions()
    assert set(names) == {"root", *bones}
    for number, frame in enumerate(frames):
        starts, ends = _expected(bones, frame, root_order, position)
        for joint, name in enumerate(names):
            assert_allclose(joints[number, joint], 0.5 * starts[name][axes], atol=1e-10)
        for tip, parent in enumerate(walk.skeleton.end_parents):
            assert_allclose(tips[number, tip], 0.5 * ends[names[parent]][axes], atol=1e-10)
    assert {names[parent] for parent in walk.skeleton.end_parents} == set(bones) - {b.parent for b in bones.values()}


@settings(max_examples=30, deadline=None)
@given(body=bodies())
def test_radians_and_spelling_do_not_matter(folder, body):
    bones, root_order, position, frames = body
    plain = _read(folder, asf_text(bones, root_order=root_order, position=position), amc_text(frames))
    turning = {name: [axis.startswith("R") for axis in ("RX",) * 3] for name in bones}
    turning["root"] = [axis.startswith("R") for axis in root_order]
    radians = [
        {
            name: [math.radians(v) if t else v for v, t in zip(values, turning[name], strict=False)]
            for name, values in frame.items()
        }
        for frame in frames
    ]
    asf = asf_text(bones, root_order=root_order, position=position, degrees=False).replace("\n", "\r\n")
    other = _read(folder, asf, amc_text(radians, first=17, degrees=False).replace("\n", " \r\n"))
    assert other.skeleton.joint_names == plain.skeleton.joint_names
    # Whole turns are rounded in radians: 450 degrees by some 1e-15, times bones of less than 2 m.
    assert_allclose(other.joint_positions(), plain.joint_positions(), atol=1e-11)


@settings(max_examples=30, deadline=None)
@given(body=bodies())
def test_the_way_through_bvh_keeps_positions(folder, body):
    bones, root_order, position, frames = body
    walk = _read(folder, asf_text(bones, root_order=root_order, position=position), amc_text(frames))
    write_bvh(walk, folder / "walk.bvh", unit="m")
    again = read_bvh(folder / "walk.bvh", unit="m")
    order = [again.skeleton.joint_names.index(name) for name in walk.skeleton.joint_names]
    assert_allclose(again.joint_positions()[:, order], walk.joint_positions(), atol=1e-6)


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_any_text_is_read_or_refused(folder, data):
    texts = [ASF, AMC]
    which = data.draw(st.integers(0, 1))
    place, length = data.draw(st.integers(0, len(texts[which]))), data.draw(st.integers(0, 12))
    put = data.draw(
        st.sampled_from(["", "(", "#", "nan", "1e308 ", "\n", ":root\n", "begin\n", "end\n", "é", "-", "\0"])
    )
    texts[which] = texts[which][:place] + put + texts[which][place + length :]
    if data.draw(st.booleans()):
        texts[which] = texts[which][:place]
    try:
        walk = _read(folder, *texts)
    except WalkError as error:
        assert ("07.asf" if which == 0 else "07_01.amc") in str(error) or "07_01.amc" in str(error)  # noqa: PT017
    else:
        assert isinstance(walk, JointWalk)


def test_the_humanoid_has_plain_anatomy(tmp_path):
    walk = _read(tmp_path, ASF, AMC)
    assert find_rig(walk.skeleton.joint_names).name == "asf"
    assert (walk.name, walk.frame_rate) == ("07_01", 120.0)
    unit = INCH / 0.45
    assert_allclose(walk.root, np.tile([-20 * unit, 3 * unit, 17.0 * unit], (2, 1)))
    markers = walk.to_markers()
    heights = [markers.marker(name)[0, 2] for name in ("head", "clavicle", "pelvis", "left_knee", "left_ankle")]
    assert heights == sorted(heights, reverse=True)
    assert 1.5 < heights[0] < 1.8
    for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle"):
        assert markers.marker(f"left_{name}")[0, 1] > markers.marker(f"right_{name}")[0, 1]
    assert_allclose(markers.marker("left_hip")[0] - markers.marker("left_knee")[0], [0, 0, 7.2 * unit], atol=1e-12)
    # The forearm is the radius and the bone called wrist.
    assert_allclose(markers.marker("left_wrist")[0] - markers.marker("left_elbow")[0], [0, 4.8 * unit, 0], atol=1e-12)


def test_a_leg_that_swings_forward_does(tmp_path):
    frame = stand() | {"lfemur": [-30, 0, 0]}
    frame["root"] = [0, 17.0, 0, 0, 0, 0]
    straight = asf_text(BODY | {"lfemur": Bone("lhipjoint", (0.0, -1.0, 0.0), 7.2, dof=("rx", "ry", "rz"))})
    recorded = _read(tmp_path, straight, amc_text([frame]))
    with pytest.raises(ValueError, match=r"'07_01': in the axes of a file no channel is hip flexion; .*stand_upright"):
        _ = recorded.phase_channels
    walk = stand_upright(recorded)
    markers = walk.to_markers()
    assert_allclose(markers.positions, recorded.to_markers().positions, atol=1e-12)
    assert markers.marker("left_knee")[0, 0] - markers.marker("left_hip")[0, 0] > 0.1
    flexion = sum(
        weight * walk.channels[0, walk.channel_names.index(channel)] for channel, weight in walk.phase_channels.items()
    )
    assert flexion == pytest.approx(math.radians(30))


def test_unit_replaces_that_of_the_file(tmp_path):
    with pytest.raises(WalkError, match=r"07_01\.amc': legs are 0\.146 m long with unit='cm'.*about 0\.058"):
        _read(tmp_path, ASF, AMC, unit="cm")
    assert_allclose(_read(tmp_path, ASF, AMC, unit=0.05).root[0, 2], 17.0 * 0.05)
    inches = _read(tmp_path, ASF.replace("length 0.45", "length 0.5"), AMC)
    assert_allclose(inches.root[0, 2], 17.0 * INCH / 0.5)


def test_a_bone_that_no_frame_names_rests(tmp_path):
    lines = [line for line in AMC.splitlines() if not line.startswith("ltoes")]
    walk = _read(tmp_path, ASF, "\n".join(lines))
    assert_array_equal(walk.rotations[:, walk.skeleton.joint_names.index("ltoes")], 0)


def test_the_skeleton_is_found_beside(tmp_path):
    walk = tmp_path / "07_01.amc"
    walk.write_text(AMC)
    with pytest.raises(
        WalkError, match=r"07_01\.amc: expected its skeleton beside it, 07_01\.asf or 07\.asf .*got none"
    ):
        read_amc(walk)
    (tmp_path / "Anna.ASF").write_text(ASF)
    assert read_amc(walk).n_frames == 2
    (tmp_path / "ben.asf").write_text(":root\n")
    with pytest.raises(WalkError, match=r"got Anna\.ASF, ben\.asf; pass skeleton="):
        read_amc(walk)
    assert read_amc(walk, skeleton=tmp_path / "Anna.ASF").n_frames == 2
    (tmp_path / "07.asf").write_text(ASF)
    assert read_amc(walk).n_frames == 2
    (tmp_path / "07_01.asf").write_text(":root\n")
    with pytest.raises(WalkError, match=r"07_01\.asf, line 1: expected the section :bonedata"):
        read_amc(walk)
