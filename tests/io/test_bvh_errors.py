"""Every way in which a BVH file can be wrong: the error names file and line and says what should stand there."""

import tracemalloc

import pytest

from eigenwalker._validation import WalkError
from eigenwalker.io import read_bvh
from tests.bvh_files import BVH

LINES = BVH.splitlines(keepends=True)


def _refusal(folder, content):
    path = folder / "walk.bvh"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(WalkError) as caught:
        read_bvh(path)
    return str(caught.value)


def test_the_text_itself_is_sound(tmp_path):
    path = tmp_path / "walk.bvh"
    path.write_text(BVH)
    assert read_bvh(path).n_frames == 3


CHANGES = {
    "not a BVH file": ("HIERARCHY\n", "ply\n", r"line 1: expected HIERARCHY.*got 'ply'"),
    "unknown keyword": ("  JOINT Knee", "  JIONT Knee", r"line 6: expected one of ROOT, JOINT.*got 'JIONT'"),
    "unknown channel": ("3 Zrotation", "3 Wrotation", r"line 9: expected channels among Xposition.*got 'Wrotation'"),
    "wrong channel count": ("CHANNELS 3 Z", "CHANNELS 4 Z", r"line 9: expected CHANNELS, a number from 0 to 6 and as"),
    "channels without number": ("CHANNELS 3 Z", "CHANNELS Z", r"line 9: expected CHANNELS, a number"),
    "huge channel count": ("CHANNELS 3 Z", "CHANNELS 999999999999 Z", r"line 9: expected CHANNELS, a number"),
    "position twice": ("Yposition Zposition", "Yposition Yposition", r"line 5: expected each position channel once"),
    "channels twice": ("    End Site", "    CHANNELS 0\n    End Site", r"line 10: expected one line of CHANNELS"),
    "missing offset": ("    OFFSET 0 -40 0\n", "", r"line 13: expected an OFFSET in JOINT 'Knee' of line 6, got none"),
    "missing end offset": ("      OFFSET 0 -45 0\n", "", r"line 12: expected an OFFSET in End Site of line 10"),
    "short offset": ("OFFSET 0 -40 0", "OFFSET 0 -40", r"line 8: expected one OFFSET with three finite.*got '0 -40'"),
    "offset not a number": ("OFFSET 0 -40 0", "OFFSET 0 nan 0", r"line 8: expected one OFFSET.*got '0 nan 0'"),
    "offset outside": ("ROOT Hips", "OFFSET 0 0 0\nROOT Hips", r"line 2: expected OFFSET within the braces"),
    "joint outside": ("ROOT Hips", "JOINT Hips", r"line 2: expected JOINT within the braces"),
    "joint without name": ("JOINT Knee", "JOINT", r"line 6: expected a name after JOINT, got none"),
    "duplicated name": ("JOINT Knee", "JOINT Hips", r"line 6: expected a new name, got 'Hips' again, as in line 2"),
    "root in root": ("JOINT Knee", "ROOT Knee", r"line 6: expected JOINT within ROOT 'Hips', got ROOT 'Knee'"),
    "joint in end site": (
        "      OFFSET 0 -45 0\n",
        "      OFFSET 0 -45 0\n      JOINT Toe\n",
        r"line 13: .* End Site of",
    ),
    "no opening brace": ("JOINT Knee\n  {", "JOINT Knee\n", r"line 8: expected '\{' after JOINT 'Knee', got 'OFFSET"),
    "brace without name": ("  JOINT Knee\n", "", r"line 6: expected a ROOT, JOINT or End Site before '\{'"),
    "one brace too few": ("}\nMOTION", "MOTION", r"line 15: expected '\}' for ROOT 'Hips' of line 2.*do not balance"),
    "one brace too many": ("}\nMOTION", "}\n}\nMOTION", r"line 16: expected no '\}' here.*do not balance"),
    "missing MOTION": ("MOTION\n", "", r"line 16: expected one of ROOT.*MOTION, got 'Frames:'"),
    "missing Frames": ("Frames: 3\n", "", r"line 17: expected 'Frames:' and a number.*got 'Frame Time: 0\.01'"),
    "missing Frame Time": ("Frame Time: 0.01\n", "", r"line 18: expected 'Frame Time:' and a number.*got '0 90 0"),
    "frames not a number": ("Frames: 3", "Frames: many", r"line 17: expected a whole number of frames, got 'many'"),
    "frames negative": ("Frames: 3", "Frames: -3", r"line 17: expected a whole number of frames, got '-3'"),
    "zero frames": ("Frames: 3", "Frames: 0", r"line 17: expected at least one frame"),
    "frame time zero": ("Time: 0.01", "Time: 0", r"line 18: expected a positive Frame Time in seconds, got '0'"),
    "frame time negative": ("Time: 0.01", "Time: -1", r"line 18: expected a positive Frame Time"),
    "frame time tiny": ("Time: 0.01", "Time: 1e-320", r"line 18: expected a positive Frame Time"),
    "frame time a word": ("Time: 0.01", "Time: fast", r"line 18: expected a positive Frame Time.*got 'fast'"),
    "more lines": (
        "Frames: 3",
        "Frames: 2",
        r"line 21: expected the end of the file, as Frames: in line 17 says 2, got 3",
    ),
    "fewer lines": (
        "Frames: 3",
        "Frames: 9",
        r"line 21: expected 9 lines of motion, as Frames: in line 17 .*, got 3; .*cut",
    ),
    "too few values": ("0 90 1 1 2 3 4 5 6", "0 90 1 1 2 3 4 5", r"line 20: expected 9 numbers, one a channel, got 8$"),
    "too many values": ("0 90 1 1 2 3 4 5 6", "0 90 1 1 2 3 4 5 6 7", r"line 20: expected 9 numbers.*got 10$"),
    "compensating lines": ("6\n0 90 1 1", "6 0\n90 1 1", r"line 19: expected 9 numbers, one a channel, got 10$"),
    "all lines short": (" 4 5 6\n", " 4 5\n", r"line 19: expected 9 numbers, one a channel, got 8$"),
    "not a number": ("90 1 1", "90 one 1", r"line 20: expected a finite number as value 3 of 9, got 'one'"),
    "nan": ("90 1 1", "90 nan 1", r"line 20: expected a finite number as value 3 of 9, got 'nan'"),
    "infinite": ("90 1 1", "90 1e999 1", r"line 20: expected a finite number as value 3 of 9, got '1e999'"),
    "decimal comma": ("90 1 1", "90 1,5 1", r"line 20: expected a finite number as value 3 of 9, got '1,5'"),
    "python spelling": ("90 1 1", "90 1_0 1", r"line 20: expected a finite number as value 3 of 9, got '1_0'"),
    "long rubbish": ("90 1 1", "90 " + "x" * 999 + " 1", r"line 20: .*got 'x{37}\.\.\.'$"),
}


@pytest.mark.parametrize(("old", "new", "match"), CHANGES.values(), ids=CHANGES.keys())
def test_refused_with_file_and_line(tmp_path, old, new, match):
    assert old in BVH
    path = tmp_path / "walk.bvh"
    path.write_text(BVH.replace(old, new))
    with pytest.raises(WalkError, match=match) as caught:
        read_bvh(path)
    assert str(caught.value).startswith(f"{path}, line ")
    assert "\n" not in str(caught.value)


def test_a_file_cut_anywhere_is_refused(tmp_path):
    for end in range(len(BVH) - len("6\n")):  # the last number may lose its end without a trace
        message = _refusal(tmp_path, BVH[:end])
        assert "walk.bvh, line " in message


def test_a_cut_file_says_so(tmp_path):
    assert "open; the file seems to be cut off" in _refusal(tmp_path, "".join(LINES[:9]))
    assert "line 16: expected 'Frames:'" in _refusal(tmp_path, "".join(LINES[:16]))
    assert "line 20: expected 3 lines of motion" in _refusal(tmp_path, "".join(LINES[:20]))
    assert "line 21: expected 9 numbers, one a channel, got 5; the file seems to be cut off" in _refusal(
        tmp_path, "".join(LINES)[:-9]
    )


def test_several_bodies_are_named(tmp_path):
    second = "".join(LINES[1:15]).replace("Hips", "Pelvis").replace("Knee", "Shin")
    message = _refusal(tmp_path, BVH.replace("MOTION\n", second + "MOTION\n"))
    assert "got 2: 'Hips' (line 2), 'Pelvis' (line 16); split" in message


def test_no_body_and_no_channels(tmp_path):
    assert "expected one ROOT before MOTION, got 0: none" in _refusal(tmp_path, "HIERARCHY\nMOTION\n")
    still = "HIERARCHY\nROOT a {\nOFFSET 0 0 0\n}\nMOTION\nFrames: 1\nFrame Time: 1\n\n"
    assert "expected joints with channels before MOTION, got none" in _refusal(tmp_path, still)


@pytest.mark.parametrize(
    ("content", "match"),
    [
        (b"", "line 1: expected HIERARCHY"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "line 3: expected the text of a BVH file, got binary data"),
        (BVH.replace("Knee", "Kn\xe9").encode("latin-1"), "line 6: expected UTF-8 text, got byte 0xe9"),
        (bytes(range(1, 256)), "expected UTF-8 text"),
    ],
)
def test_what_is_not_text_is_refused(tmp_path, content, match):
    assert match in _refusal(tmp_path, content)


def test_a_false_number_of_frames_costs_no_memory(tmp_path):
    text = BVH.replace("Frames: 3", "Frames: 1000000000000")
    tracemalloc.start()
    message = _refusal(tmp_path, text)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert "expected 1000000000000 lines of motion" in message
    assert peak < 1_000_000
    assert "expected a whole number of frames" in _refusal(tmp_path, BVH.replace("Frames: 3", "Frames: " + "9" * 5000))
    assert "got '1e12'" in _refusal(tmp_path, BVH.replace("Frames: 3", "Frames: 1e12"))
