"""Every way in which ASF and AMC files can be wrong: the error names file and line and what should stand there."""

import tracemalloc

import pytest

from eigenwalker._validation import WalkError
from eigenwalker.io.amc import read_amc
from tests.acclaim import AMC, ASF, Bone, amc_text, asf_text


def _read(folder, asf, amc, **options):
    (folder / "07.asf").write_bytes(asf if isinstance(asf, bytes) else asf.encode())
    (folder / "07_01.amc").write_bytes(amc if isinstance(amc, bytes) else amc.encode())
    return read_amc(folder / "07_01.amc", **options)


ASF_CHANGES = {
    "other file": ("# a skeleton\n", "ply\n", r"line 1: expected a section of an ASF file, such as :units, got 'ply'"),
    "no hierarchy": (":hierarchy", ":hier", r"line [0-9]+: expected the section :hierarchy"),
    "section twice": (":units", ":root\n:units", r"line [0-9]+: expected one section :root, got a second one"),
    "zero length unit": ("  length 0.45", "  length 0", r"line 6: expected a positive length unit, got 0"),
    "angle unit": ("angle deg", "angle gon", r"line 7: expected angle deg or rad, got 'gon'"),
    "no order": ("   order TX", "   sequence TX", r"line 10: expected 'order TX TY TZ RX RY RZ' in :root, got none"),
    "wrong order": ("TX TY TZ RX", "TX TX TZ RX", r"line 11: expected order with each of tx, .* once, got 'tx tx tz"),
    "turned root": (
        "orientation 0 0 0",
        "orientation 0 90 0",
        r"line 14: expected orientation 0 0 0, because programs",
    ),
    "begin twice": ("  begin\n     id 2\n", "  begin\n  begin\n", r"line [0-9]+: expected begin and end .*got 'begin'"),
    "end twice": ("  end\n  begin\n     id 2", "  end\n  end\n     id 2", r"expected begin and end .*got 'end'"),
    "no direction": ("     direction 0.0 1.0 0.0\n     length 2.1", "     length 2.1", r"line 16: .*got no direction"),
    "short direction": (
        "direction 0.0 1.0 0.0",
        "direction 0.0 1.0",
        r"line 19: expected direction with 3 finite numbers",
    ),
    "huge length": ("length 7.2", "length 1e300", r"expected length with 1 finite numbers, got '1e300'"),
    "axis order": ("axis 0 0 0  XYZ", "axis 0 0 0  XYX", r"line 21: expected three angles and an order .*got 'xyx'"),
    "stretching bone": ("dof rx ry rz", "dof rx l", r"line 22: expected dof with each of rx, ry, rz once, got 'rx l'"),
    "name twice": ("name upperback", "name lowerback", r"expected a new name, got a second bone 'lowerback'"),
    "unknown child": ("root lowerback", "root tail lowerback", r"expected a bone and its children .*got 'tail'"),
    "second parent": (
        "    thorax lowerneck",
        "    thorax head lowerneck",
        r"expected one parent .*got a second for 'head'",
    ),
    "ring": ("    root lowerback", "    head lowerback", r"expected all bones to hang from the root .*not 'head'"),
    "binary": ("VICON", "VIC\0N", r"line 3: expected the text of an ASF file, got binary data"),
}


@pytest.mark.parametrize("change", ASF_CHANGES)
def test_wrong_skeletons_are_refused(tmp_path, change):
    old, new, message = ASF_CHANGES[change]
    assert old in ASF
    with pytest.raises(WalkError, match=rf"07\.asf, .*{message}"):
        _read(tmp_path, ASF.replace(old, new, 1), AMC)


AMC_CHANGES = {
    "no frames": ("1\nroot", "root", r"line 4: expected the number of a frame before its bones, got 'root'"),
    "lost frame": ("\n2\n", "\n3\n", r"line 30: expected frame 2, got frame 3; frames are missing"),
    "unknown bone": ("lowerback 0", "tail 0", r"line 6: expected each bone .*got 'tail', which the ASF file does not"),
    "bone twice": ("upperback 0 0 0", "lowerback 0 0 0", r"line 7: expected each bone .*got 'lowerback', again"),
    "short bone": (
        "lowerback 0 0 0",
        "lowerback 0 0",
        r"line 6: expected 3 numbers \(rx, ry, rz\) for 'lowerback', got 2",
    ),
    "no number": ("lowerback 0 0 0", "lowerback 0 O 0", r"line 6: expected finite numbers, got 'O'"),
    "nan": ("lowerback 0 0 0", "lowerback 0 nan 0", r"line 6: expected finite numbers, got 'nan'"),
    "two dots": ("lowerback 0 0 0", "lowerback 0 1.2.3 0", r"line 6: expected finite numbers, got '1\.2\.3'"),
    "huge number": ("root 3", "root 1e300", r"line 5: expected finite numbers, got '1e300'"),
    "late bone": ("lowerback 0 0 0\n", "", r"line 31: expected the bones of the first frame, got 'lowerback' besides"),
}


@pytest.mark.parametrize("change", AMC_CHANGES)
def test_wrong_motion_is_refused(tmp_path, change):
    old, new, message = AMC_CHANGES[change]
    assert old in AMC
    with pytest.raises(WalkError, match=rf"07_01\.amc, .*{message}"):
        _read(tmp_path, ASF, AMC.replace(old, new, 1))


def test_a_cut_off_file_is_refused(tmp_path):
    with pytest.raises(WalkError, match=r"line 33: expected values of head in frame 2 of the file.*cut off"):
        _read(tmp_path, ASF, "\n".join(AMC.splitlines()[:33]))
    with pytest.raises(
        WalkError, match=r"line 3: expected frames, each a number and the values of its bones, got none"
    ):
        _read(tmp_path, ASF, "\n".join(AMC.splitlines()[:3]))


def test_many_bones_times_many_frames_are_refused_before_allocating(tmp_path):
    bones = {f"bone{number}": Bone("root", (0.0, 1.0, 0.0), 1.0) for number in range(2000)}
    frames = [{"root": [0] * 6}] * 2000
    tracemalloc.start()
    with pytest.raises(WalkError, match="expected at most 500 bones of a body, got 2000"):
        _read(tmp_path, asf_text(bones), amc_text(frames))
    assert tracemalloc.get_traced_memory()[1] < 50e6
    tracemalloc.stop()


@pytest.mark.parametrize(
    ("options", "kind", "match"),
    [
        ({"unit": "feet"}, ValueError, "unit must be one of"),
        ({"up": "x"}, ValueError, "up must be one of"),
        ({"frame_rate": 0}, ValueError, "frame_rate must be positive"),
    ],
)
def test_options_are_checked_before_the_file(tmp_path, options, kind, match):
    with pytest.raises(kind, match=match):
        read_amc(tmp_path / "missing.amc", **options)


def test_missing_files_are_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"missing\.amc"):
        read_amc(tmp_path / "missing.amc")
    (tmp_path / "07_01.amc").write_text(AMC)
    with pytest.raises(FileNotFoundError, match=r"missing\.asf"):
        read_amc(tmp_path / "07_01.amc", skeleton=tmp_path / "missing.asf")
