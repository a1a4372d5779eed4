"""Wide tables: what is written comes back, and every fault is named with its line."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.io import read_csv, write_csv
from eigenwalker.io._times import rate_from_times
from eigenwalker.motion import TROJE15, JointWalk, MarkerSet, Skeleton, Walk
from tests.marker_walks import assert_same_walk, body, faults, outcome, refusal, walks

TEXT = """time,heel_x,heel_y,heel_z,toe_x,toe_y,toe_z
0,0,1,2,3,4,5
0.01,,1,2,3,4,5
0.02,0,1,nan,3,4,5
0.03,0,1,2,3,4,5
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("tables")


def _read(folder, text, **options):
    path = folder / "anna.csv"
    path.write_bytes(text.encode())
    return read_csv(path, **options)


@settings(max_examples=60, deadline=None)
@given(walk=walks(), suffix=st.sampled_from([".csv", ".tsv"]))
def test_round_trip_is_exact(folder, walk, suffix):
    path = folder / f"anna{suffix}"
    write_csv(walk, path)
    back = read_csv(path, frame_rate=walk.frame_rate if walk.n_frames == 1 else None)
    assert_same_walk(back, walk)
    assert back.name == "anna"
    assert back.frame_rate == pytest.approx(walk.frame_rate, rel=1e-12)  # over times that were rounded to 53 bits
    assert read_csv(path, frame_rate=walk.frame_rate).frame_rate == walk.frame_rate


def test_short_times_are_not_taken_for_rounded_ones(folder):
    """0.0128 s is one over 78.125 Hz, and one over 78 Hz rounded to four decimals."""
    write_csv(Walk(np.zeros((2, 1, 3)), 78.125, MarkerSet(("heel",))), folder / "two.csv")
    assert read_csv(folder / "two.csv").frame_rate == pytest.approx(78.125, rel=1e-12)


def test_pandas_reads_what_is_written(folder):
    walk = body(np.random.default_rng(0), gaps=5)
    write_csv(walk, folder / "anna.csv")
    table = pd.read_csv(folder / "anna.csv")
    assert list(table.columns) == ["time", *walk.channel_names]
    assert_allclose(table[list(walk.channel_names)], walk.channels, rtol=1e-15)  # pandas' own parser is not exact


def test_single_precision_is_kept(folder):
    walk = Walk(np.float32([[[0.1, 0.2, 0.3]]]), 10, MarkerSet(("heel",)))
    write_csv(walk, folder / "anna.csv")
    assert_array_equal(np.float32(read_csv(folder / "anna.csv", frame_rate=10).positions), walk.positions)


def test_the_15_markers_come_in_their_order(folder):
    rng = np.random.default_rng(1)
    walk = body(rng, gaps=4)
    shuffled = rng.permutation(15)
    mixed = Walk(walk.positions[:, shuffled], 120, MarkerSet(tuple(TROJE15.names[place] for place in shuffled)))
    write_csv(mixed, folder / "anna.csv")
    back = read_csv(folder / "anna.csv")
    assert back.marker_set is TROJE15
    assert_same_walk(back, walk)


def test_further_markers_keep_the_order_of_the_file(folder):
    walk = body(np.random.default_rng(1))
    more = MarkerSet(("left_heel", *TROJE15.names))
    write_csv(Walk(walk.positions[:, [0, *range(15)]], 120, more), folder / "anna.csv")
    back = read_csv(folder / "anna.csv")
    assert back.marker_set == MarkerSet(more.names, TROJE15.sticks)
    assert read_csv(folder / "anna.csv", markers=TROJE15.names).marker_set is TROJE15


def test_gaps_units_and_axes(folder):
    walk = _read(folder, TEXT)
    assert np.isnan(walk.positions).sum() == 2
    assert_array_equal(walk.marker("toe")[0], [3, 4, 5])
    assert_array_equal(_read(folder, TEXT, unit="cm", up="y").marker("toe")[0], np.array([5, 3, 4]) * 0.01)
    assert walk.frame_rate == 100
    assert np.isnan(walk.speed)


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + TEXT,
        TEXT.replace("\n", "\r\n"),
        TEXT.replace("\n", "\r"),
        TEXT.replace("\n", "\n\n") + "\n\n",
        TEXT.replace("heel_x", '"heel_x"').replace("0.02", '"0.02"'),
        TEXT.replace("heel_x", " heel_X ").replace("time", "Time"),
        TEXT.replace("nan", "NaN").replace(",,", ", n/a ,"),
        TEXT.rstrip("\n"),
    ],
)
def test_spelling_does_not_matter(folder, text):
    assert_same_walk(_read(folder, text), _read(folder, TEXT))


def test_separators(folder):
    assert_same_walk(_read(folder, TEXT.replace(",", ";"), separator=";"), _read(folder, TEXT))
    with pytest.raises(ValueError, match=r"line 1: expected columns separated by ',', got a single one, 'time;heel_x"):
        _read(folder, TEXT.replace(",", ";"))


def test_one_frame_one_marker_and_all_gaps(folder):
    walk = _read(folder, "heel_x,heel_y,heel_z\n,,\n", frame_rate=50)
    assert walk.positions.shape == (1, 1, 3)
    assert np.isnan(walk.positions).all()
    (folder / "anna.tsv").write_text("heel_x\theel_y\theel_z\n\t\t\n1\t2\t3\n\t\t\n")
    assert read_csv(folder / "anna.tsv", frame_rate=50).n_frames == 3


def test_picked_markers_ignore_other_columns(folder):
    text = "sex,heel_x,heel_y,heel_z,toe_x\nF,1,2,3,far\nF,1,2,3,far\n"
    assert_array_equal(_read(folder, text, frame_rate=50, markers=["heel"]).positions, [[[1, 2, 3]]] * 2)
    with pytest.raises(ValueError, match=r"line 1: expected the columns toe_y, toe_z, got none.*found are heel$"):
        _read(folder, text, frame_rate=50, markers=["toe"])


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("toe_z", "toe_w", r"line 1: .*full triples.*, got 'toe_x', 'toe_y', 'toe_w'; rename or remove"),
        ("toe_z", "toe_y", r"line 1: expected a new name for each column, got toe_y more than once"),
        ("toe_x,toe_y,toe_z", "heel_x,heel_y,heel_z", r"line 1: .*got heel_x, heel_y, heel_z more than once"),
        ("time,", "", r"line 2: expected 6 fields, got 7"),
        ("time", "t", r"line 1: .*full triples.*, got 't'; rename"),
        (",heel_x,heel_y,heel_z,toe_x,toe_y,toe_z", "", r"line 1: expected columns separated by ',', got a single one"),
        ("0.02,0,1", "0.02,0", r"line 4: expected 7 fields, got 6$"),
        ("0.02,0,1", "0.02,0,1,1", r"line 4: expected 7 fields, got 8$"),
        ("0.03,0,1,2,3,4,5\n", "0.03,0,1,2", r"line 5: expected 7 fields, got 4; the file seems to be cut off"),
        ("0.02,0,1", "0.02,0,one", r"line 4: expected a finite number or a gap as value 3 of 7, got 'one'"),
        ("0.02,0,1", "0.02,0,1_0", r"line 4: .* value 3 of 7, got '1_0'"),
        ("0.02,0,1", "0.02,0,1e999", r"line 4: .* value 3 of 7, got '1e999'"),
        ("0.02,0,1", "0.02,0,-inf", r"line 4: .* value 3 of 7, got '-inf'"),
        ("0.02,0", "0.02,\u0661", r"line 4: .* value 2 of 7"),
        ("0.02", "", r"line 4: expected a time in seconds, got ''"),
        ("0.02", "0.021", r"line 4: expected evenly spaced times, 0.01 s apart within 1 %, got a step of 0.011 s"),
        ("0.02,0,1,nan,3,4,5\n", "", r"line 4: expected evenly spaced times.*got a step of 0.02 s"),
        ("0.01,,", "0.0,,", r"line 3: expected evenly spaced times.*got a step of 0 s"),
        ("heel_y", 'hee"l_y', r"line \d: expected fields|line 1: .*full triples"),
        ("heel_y", '"heel_y', r"line \d: expected fields separated by ',', but unexpected end of data"),
    ],
)
def test_faults_are_named_with_their_line(folder, old, new, match):
    assert old in TEXT
    with pytest.raises(ValueError, match=match):
        raise ValueError(refusal(read_csv, folder / "anna.csv", TEXT.replace(old, new, 1)))


@pytest.mark.parametrize(
    ("content", "match"),
    [
        (b"", "line 1: expected a header with columns such as left_ankle_x, got an empty file"),
        (b"\n\n", "line 1: expected a header"),
        (b"heel_x,heel_y,heel_z\n", "line 1: expected a line a frame after the header, got none"),
        (b"time\n0\n", "line 1: expected columns separated by"),
        (b"PK\x03\x04\0\0", "line 1: expected the text of a table, got binary data (a zero byte)"),
        (TEXT.encode().replace(b"heel_x", b"h\xe9el_x"), "line 1: expected UTF-8 text, got byte 0xe9"),
        (b"heel_x,heel_y,heel_z\n1,2,3\n", "line 1: expected a column 'time' in seconds, got none; add it, or pass"),
        (b"time,heel_x,heel_y,heel_z\n0,1,2,3\n", "line 2: expected at least two times, or frame_rate=..., got a sin"),
        (b"time,heel_x,heel_y,heel_z\n0,1,2,3\n0,1,2,3\n", "line 3: expected times in seconds that rise"),
    ],
)
def test_what_is_no_table_is_refused(folder, content, match):
    assert match in refusal(read_csv, folder / "anna.csv", content)


def test_time_and_frame_rate_must_agree(folder):
    assert _read(folder, TEXT, frame_rate=100.05).frame_rate == 100.05
    message = refusal(read_csv, folder / "anna.csv", TEXT, frame_rate=120)
    assert "line 5: expected time 0.025 at 120 frames a second, got '0.03', as if there were 100 a second" in message
    with pytest.raises(ValueError, match="frame_rate must be positive"):
        _read(folder, TEXT, frame_rate=0)


def test_rounded_times_are_even():
    exact = np.arange(500) / 120
    for digits in (3, 4, 6):
        words = [f"{time:.{digits}f}" for time in exact]
        assert rate_from_times(words, range(500)) == 120
        assert rate_from_times(words, range(500), frame_rate=120.0) == 120
    jittered = [f"{time:.6f}" for time in exact + 3e-4 * (np.arange(500) % 2)]
    with pytest.raises(ValueError, match=r"line \d: expected evenly spaced times, 0\.00\d+ s apart"):
        rate_from_times(jittered, range(500))


def test_legs_are_checked_with_the_unit(folder):
    write_csv(body(np.random.default_rng(2)), folder / "anna.csv")
    content = (folder / "anna.csv").read_bytes()
    assert "m long with unit='mm', expected 0.3 to 1.3 m; read it with unit='m'" in refusal(
        read_csv, folder / "anna.csv", content, unit="mm"
    )


def test_wrong_walks_are_not_written(folder):
    joints = JointWalk(np.zeros((2, 1, 3)), np.zeros((2, 3)), Skeleton(("Hips",), [-1], np.zeros((1, 3))), 30)
    with pytest.raises(TypeError, match=r"expected a Walk, got JointWalk; .* with to_markers\(\)"):
        write_csv(joints, folder / "no.csv")
    with pytest.raises(ValueError, match=r"expected markers with finite positions.*got infinite positions"):
        write_csv(Walk(np.full((1, 1, 3), np.inf), 30, MarkerSet(("heel",))), folder / "no.csv")
    with pytest.raises(ValueError, match=r"got no markers"):
        write_csv(Walk(np.zeros((1, 0, 3)), 30, MarkerSet(())), folder / "no.csv")
    with pytest.raises(ValueError, match=r"names of markers of printable characters.*got 'he\\nel'"):
        write_csv(Walk(np.zeros((1, 1, 3)), 30, MarkerSet(("he\nel",))), folder / "no.csv")
    assert not (folder / "no.csv").exists()


@settings(max_examples=200, deadline=None)
@given(content=faults(TEXT.encode()), rate=st.sampled_from([None, 100]))
def test_any_content_is_read_or_refused(folder, content, rate):
    walk, _ = outcome(read_csv, folder / "anna.csv", content, frame_rate=rate)
    assert walk is None or not np.isinf(walk.positions).any()


def test_huge_numbers_are_no_positions(folder):
    message = refusal(read_csv, folder / "anna.csv", TEXT.replace("3", "1e308", 1), unit=1e3)
    assert "expected finite positions with unit=1000.0, got infinite ones for toe" in message
    assert_allclose(_read(folder, TEXT.replace("3", "1e300", 1)).marker("toe")[0, 0], 1e300)
