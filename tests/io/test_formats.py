"""Reading by suffix, and many files at once."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker._validation import WalkError
from eigenwalker.io import read_bvh, read_walk, read_walks, write_walk
from eigenwalker.io.formats import READERS, WRITERS, find_ending
from eigenwalker.motion import TROJE15, Event, JointWalk, Walk
from tests.synthetic import make_walk

TEXT = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 4 Xposition Yposition Zposition Yrotation
}
MOTION
Frames: 2
Frame Time: 0.01
0 90 0 0
0 90 STEP 10
"""


@pytest.fixture
def files(tmp_path):
    """Return five sound files, not in alphabetical order."""
    paths = [tmp_path / f"{name}.bvh" for name in ("eva", "anna", "dora", "cleo", "bert")]
    for step, path in enumerate(paths, 1):
        path.write_text(TEXT.replace("STEP", str(step)))
    return paths


@pytest.fixture
def mixed(files, tmp_path):
    """Return the files with three that cannot be read between them."""
    broken = tmp_path / "broken.bvh"
    broken.write_text(TEXT.replace("STEP", "far"))
    return [files[0], broken, files[1], tmp_path / "missing.bvh", tmp_path / "film.mp4", files[2]]


def test_suffix_chooses_the_reader(files, tmp_path):
    loud = tmp_path / "LOUD.BVH"
    loud.write_text(TEXT.replace("STEP", "1"))
    assert read_walk(loud).name == "LOUD"
    assert_array_equal(read_walk(str(files[0]), unit="m").root, read_bvh(files[0], unit="m").root)


def test_unknown_suffix_lists_the_known():
    with pytest.raises(WalkError, match=r"walk\.fbx: expected a file of type .*\.bvh, .*, got suffix '\.fbx'"):
        read_walk("walk.fbx")
    with pytest.raises(WalkError, match=r"got suffix ''"):
        read_walk("walk")


def test_unknown_option_lists_the_known(files):
    for read in (read_walk, lambda path, **options: read_walks([path], **options)):
        with pytest.raises(TypeError, match="read_bvh takes the options unit, up, frame_rate, name, got units, axis"):
            read(files[0], units="cm", axis="y")


def test_order_is_kept_for_any_number_of_processes(files):
    one = read_walks(files)
    two = read_walks(iter(map(str, files)), n_jobs=2, progress=True)
    assert [walk.name for walk in one] == [walk.name for walk in two] == ["eva", "anna", "dora", "cleo", "bert"]
    for first, second in zip(one, two, strict=True):
        assert_array_equal(first.root, second.root)
        assert_array_equal(first.rotations, second.rotations)


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_all_refusals_are_raised_at_once(mixed, n_jobs):
    with pytest.raises(WalkError) as caught:
        read_walks(mixed, n_jobs=n_jobs)
    first, *lines = str(caught.value).splitlines()
    assert first == "3 of 6 files were refused; mend them, or leave them out with on_error='skip':"
    assert lines[0] == f"  {mixed[1]}, line 11: expected a finite number as value 3 of 4, got 'far'"
    assert lines[1].startswith(f"  {mixed[3]}: [Errno 2] No such file")
    known = ", ".join(sorted(READERS))
    assert lines[2] == f"  {mixed[4]}: expected a file of type {known}, got suffix '.mp4'"
    assert len(lines) == 3


def test_skip_warns_once_and_returns_the_rest(mixed):
    with pytest.warns(UserWarning, match=r"3 of 6 files were refused and left out:") as caught:
        walks = read_walks(mixed, on_error="skip")
    assert [walk.name for walk in walks] == ["eva", "anna", "dora"]
    (warning,) = caught
    assert all(str(path) in str(warning.message) for path in (mixed[1], mixed[3], mixed[4]))
    assert Path(warning.filename).name == "test_formats.py"


def test_skip_is_silent_when_all_is_well(files):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(read_walks(files, on_error="skip")) == 5


def test_a_single_path_is_not_a_list(files):
    for path in (files[0], str(files[0])):
        with pytest.raises(TypeError, match=r"got the single path '.*eva\.bvh': wrap it, \[path\]"):
            read_walks(path)
    with pytest.raises(TypeError, match="paths must be a list of paths, got int"):
        read_walks(3)


def test_no_paths_are_refused(tmp_path):
    with pytest.raises(ValueError, match="expected at least one path, got none"):
        read_walks(tmp_path.glob("*.bvh"))


def test_wrong_choices_are_refused(files):
    with pytest.raises(ValueError, match="on_error must be one of 'raise', 'skip', got 'ignore'"):
        read_walks(files, on_error="ignore")
    with pytest.raises(TypeError, match="takes no name"):
        read_walks(files, name="anna")


MARKER_ENDINGS = [".csv", ".mat", ".npz", ".trc", ".tsv", "_motion.tsv"]


def test_the_longest_ending_counts():
    assert find_ending("sub-01_motion.tsv", READERS) == "_motion.tsv"
    assert find_ending("slow_motion_walk.TSV", READERS) == ".tsv"
    assert find_ending("anna.csv.gz", READERS) is None
    assert set(MARKER_ENDINGS) <= set(WRITERS)
    assert set(WRITERS) <= set(READERS)


@pytest.mark.parametrize("ending", MARKER_ENDINGS)
def test_every_format_of_markers_keeps_a_walk(tmp_path, ending):
    walk, _ = make_walk(np.random.default_rng(0), name="anna", n_cycles=10)
    path = tmp_path / f"anna{ending}"
    write_walk(walk, path)
    back = read_walk(path)
    assert isinstance(back, Walk)
    assert back.marker_set == TROJE15
    assert (back.name, back.frame_rate) == ("anna", 120)
    # BML holds the two harmonics that this walk is made of; its frequency is found to some 1e-12.
    assert_allclose(back.positions, walk.positions, rtol=1e-12, atol=1e-9 if ending == ".mat" else 0)


@pytest.mark.parametrize("ending", [".c3d", ".csv", ".npz", ".trc", ".tsv", "_motion.tsv"])
def test_gaps_and_events_are_kept(tmp_path, ending):
    walk, _ = make_walk(np.random.default_rng(0), name="anna", n_cycles=2)
    positions = walk.positions.copy()
    positions[10:20, 3] = np.nan
    events = (Event(0.25, "heel_strike", "left"), Event(0.5, "toe_off", "right"), Event(1.0, "stumble"))
    path = tmp_path / f"anna{ending}"
    write_walk(replace(walk, positions=positions, events=events), path)
    back = read_walk(path)
    assert_array_equal(np.isnan(back.positions), np.isnan(positions))
    assert_allclose(back.positions, positions, rtol=1e-6)
    assert [event[1:] for event in back.events] == [event[1:] for event in events]
    assert_allclose([event.time for event in back.events], [event.time for event in events], rtol=1e-6)
    write_walk(walk, path)
    assert read_walk(path).events == ()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "expected JSON, but"),
        ('{"time": 1}', "expected a list of events, got dict"),
        ('[{"time": 1, "kind": "toe_off", "side": ""}, 5]', "event 2: expected an object with a finite time"),
        ('[{"time": NaN, "kind": "toe_off", "side": ""}]', "event 1: expected an object with a finite time"),
        ('[{"time": 1, "kind": 3, "side": ""}]', "event 1: expected"),
        ("[" * 5000, "expected JSON, but"),
        (f'[{{"time": {10**400}, "kind": "toe_off", "side": ""}}]', "event 1: expected"),
    ],
)
def test_wrong_events_beside_a_file_are_refused(tmp_path, content, message):
    write_walk(make_walk(np.random.default_rng(0), n_cycles=1)[0], tmp_path / "anna.csv")
    (tmp_path / "anna.csv.events.json").write_text(content)
    with pytest.raises(WalkError, match=rf"anna.csv.events.json: {message}"):
        read_walk(tmp_path / "anna.csv")


@pytest.mark.parametrize("ending", [ending for ending in MARKER_ENDINGS if ending != ".npz"])
def test_joints_do_not_go_into_files_of_markers(files, tmp_path, ending):
    walk = read_walk(files[0])
    assert isinstance(walk, JointWalk)
    with pytest.raises(TypeError, match=r"expected a Walk, got JointWalk; .* with to_markers\(\)"):
        write_walk(walk, tmp_path / f"no{ending}")
    assert not (tmp_path / f"no{ending}").exists()


def test_npz_keeps_joints(files, tmp_path):
    walk = read_walk(files[0])
    write_walk(walk, tmp_path / "eva.npz")
    assert_array_equal(read_walk(tmp_path / "eva.npz").joint_positions(), walk.joint_positions())


def test_unknown_suffixes_and_options_of_writers(tmp_path):
    walk, _ = make_walk(np.random.default_rng(0))
    with pytest.raises(WalkError, match=r"walk\.fbx: expected a file of type .*\.csv, .*, got suffix '\.fbx'"):
        write_walk(walk, "walk.fbx")
    with pytest.raises(WalkError, match=r"walk\.txt: expected a file of type"):
        write_walk(walk, "walk.txt")
    with pytest.raises(TypeError, match="write_trc takes the options unit, up, got units"):
        write_walk(walk, tmp_path / "walk.trc", units="mm")
    with pytest.raises(TypeError, match="write_csv takes no options, got unit"):
        write_walk(walk, tmp_path / "walk.csv", unit="mm")
    write_walk(walk, tmp_path / "walk.trc", unit="m", up="z")
    assert_array_equal(read_walk(tmp_path / "walk.trc", up="z").positions, walk.positions)
