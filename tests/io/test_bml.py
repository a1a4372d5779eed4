"""BML mm matrices: millimetres to a walk and back, MATLAB and text, and what is no such matrix."""

import io
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.io import loadmat, savemat
from scipy.sparse import csc_array

from eigenwalker._validation import WalkError
from eigenwalker.io import BmlFeatures, bml_to_features, features_to_bml, read_bml, write_bml
from eigenwalker.io.bml import _read_mat, _to_matrix
from eigenwalker.motion import TROJE15, JointWalk, MarkerSet, Skeleton, Walk
from tests.marker_walks import faults, outcome, refusal
from tests.synthetic import body_coefficients, make_walk

ORDER = TROJE15.names[::-1]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("bml")


def _matrix(seed=0, *, period=126.03, size=1.02, speed=11.3):
    """Return the matrix of a walker in the phase of the package."""
    coefficients = body_coefficients(np.random.default_rng(seed))
    return features_to_bml(BmlFeatures(coefficients, 120 / period, size, speed * 0.12))


def _saved(**variables):
    file = io.BytesIO()
    savemat(file, variables)
    return file.getvalue()


def test_layout_by_hand():
    matrix = np.arange(230.0).reshape(5, 46)
    features = bml_to_features(matrix)
    # Block 1, the first sine, starts at 46: 15 x, then 15 y from 61, 15 z from 76, the size factor at 91.
    assert_allclose(features.coefficients[1, :6] * 1000, [46, 61, 76, 47, 62, 77])
    assert features.frequency == 120 / 45
    assert features.size == 91
    assert features.speed == pytest.approx(137 * 0.12)
    back = features_to_bml(features)
    assert_allclose(back[:, :45], matrix[:, :45])
    assert_allclose(back[:, 45], [45, 91, 137, 0, 0])


@given(seed=st.integers(0, 100), period=st.floats(50, 390), speed=st.one_of(st.floats(0, 30), st.just(np.nan)))
def test_arrays_come_back(seed, period, speed):
    matrix = _matrix(seed, period=period, speed=speed)
    for order in (TROJE15.names, ORDER):
        back = features_to_bml(bml_to_features(matrix, marker_order=order), marker_order=order)
        assert_allclose(back, matrix, rtol=1e-14)
    assert_array_equal(
        bml_to_features(matrix, marker_order=ORDER).coefficients.reshape(5, 15, 3)[:, ::-1],
        bml_to_features(matrix).coefficients.reshape(5, 15, 3),
    )


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 1000), period=st.floats(80, 200), suffix=st.sampled_from([".mat", ".csv"]))
def test_millimetres_to_a_walk_and_back(folder, seed, period, suffix):
    """The law of this format, to 1e-9 of the matrix's largest number: only the stride frequency is estimated anew."""
    matrix = _matrix(seed, period=period)
    path = folder / f"source{suffix}"
    if suffix == ".mat":
        savemat(path, {"w": matrix})
    else:
        np.savetxt(path, matrix, delimiter=",", fmt="%.17g")
    walk = read_bml(path)
    write_bml(walk, folder / f"copy{suffix}")
    again = read_bml(folder / f"copy{suffix}")
    assert_allclose(again.positions, walk.positions, atol=1e-9)
    assert (again.size, again.n_frames) == (walk.size, walk.n_frames)
    assert again.speed == pytest.approx(walk.speed, rel=1e-14)
    copied = _stored(folder / f"copy{suffix}")
    assert_allclose(copied, matrix, rtol=1e-9, atol=1e-9 * np.abs(matrix).max())


def _stored(path):
    if path.suffix == ".csv":
        return np.genfromtxt(path, delimiter=",")
    return loadmat(path)["walker"]


def test_own_first_frame_can_be_kept(folder):
    walk, coefficients = make_walk(np.random.default_rng(3), phase=1.0, n_cycles=10, speed=1.3)
    write_bml(walk, folder / "turned.csv")
    write_bml(walk, folder / "kept.csv", phase_reference=None)
    turned, kept = (bml_to_features(_stored(folder / name)) for name in ("turned.csv", "kept.csv"))
    assert_allclose(turned.coefficients, coefficients, atol=1e-9)
    assert np.abs(kept.coefficients - coefficients).max() > 0.1
    assert_allclose(read_bml(folder / "kept.csv").positions, walk.positions, atol=1e-9)
    assert turned.speed == pytest.approx(1.3)


def test_what_is_read(folder):
    savemat(folder / "anna.mat", {"w": _matrix(), "n": 3.0, "text": "abc"})
    walk = read_bml(folder / "anna.mat")
    assert walk.marker_set is TROJE15
    assert (walk.name, walk.frame_rate, walk.n_frames) == ("anna", 120, 1260)
    assert (walk.size, walk.speed) == (pytest.approx(1.02), pytest.approx(1.356))
    assert_allclose(walk.positions[:, 0].mean(axis=0)[2], 1.65, atol=0.1)
    short = read_bml(folder / "anna.mat", n_cycles=1, frame_rate=60, name="eva")
    assert (short.name, short.frame_rate, short.n_frames) == ("eva", 60, 63)
    assert_array_equal(short.positions, walk.positions[:126:2])


def test_shapes_variables_and_unknown_speed(folder):
    matrix = _matrix(speed=np.nan)
    expected = bml_to_features(matrix)
    shapes = (matrix, matrix.T, matrix.reshape(1, 230), matrix.reshape(230, 1))
    for shaped in shapes:
        savemat(folder / "anna.mat", {"w": shaped})
        np.savetxt(folder / "anna.csv", shaped, delimiter=",", fmt="%.17g")
        for path in (folder / "anna.mat", folder / "anna.csv"):
            walk = read_bml(path)
            assert np.isnan(walk.speed)
            assert_allclose(walk.positions[0].ravel(), expected.coefficients[[0, 2, 4]].sum(axis=0))
    write_bml(walk, folder / "copy.csv")
    assert np.isnan(read_bml(folder / "copy.csv").speed)


@pytest.mark.parametrize(
    ("variables", "options", "match"),
    [
        (
            {"a": np.ones((5, 45))},
            {},
            r"a single numeric variable of 230 numbers, got a \(5 x 45 double\); name",
        ),
        ({"a": _matrix(), "b": _matrix()}, {}, r"expected a single numeric variable.*got a \(.*\), b \(.*\); name it"),
        (
            {"a": _matrix()},
            {"variable": "b"},
            r"a numeric variable 'b' of 230 numbers, got a \(5 x 46 double\)",
        ),
        ({"a": "x" * 230}, {}, r"expected a single numeric variable.*got a \(1 x 230 char\)"),
        ({}, {}, r"got no variable"),
        ({"a": _matrix(period=np.nan)}, {}, r"expected as last of each 46 numbers a positive period.*got nan, 1\.02"),
        ({"a": _matrix(size=0)}, {}, r"a positive size factor and a speed, got 126\.03, 0 and 11\.3"),
        ({"a": _matrix(period=1e9)}, {}, r"expected a stride's period of 48 to 400 frames at 120 Hz, got 1e\+09"),
        ({"a": _matrix(period=126030)}, {}, r"expected a stride's period of 48 to 400 frames"),
        ({"a": _matrix() * 1e7}, {}, r"expected positions in millimetres below 1e\+09, got larger ones or NaN"),
        ({"a": np.full((5, 46), np.nan)}, {}, r"expected positions in millimetres below"),
    ],
)
def test_other_variables_are_refused(folder, variables, options, match):
    with pytest.raises(WalkError, match=match):
        raise WalkError(refusal(read_bml, folder / "anna.mat", _saved(**variables), **options))


def test_what_is_no_matrix_is_refused(folder):
    path = folder / "anna.mat"
    sound = _saved(w=_matrix())
    newer = b"MATLAB 7.3 MAT-file" + b" " * 105 + b"\x00\x02IM" + b"\0" * 400
    cases = {
        "byte 124: expected a MATLAB file of version 5 to 7, got something else": [b"", b"HIERARCHY\n" * 30],
        "byte 124: expected a MATLAB file up to version 7, got version 7.3; save it with '-v7'": [newer],
        "byte 128: expected 1888 bytes, got 864; the file seems to be cut off": [sound[:1000]],
        "byte 2024: expected a data element, got the end of the file": [sound + b"\0"],
        "byte 128: expected a variable (type 14), got type 0": [sound[:128] + b"\0" * 16],
        "got no variable": [sound[:128]],
    }
    for message, contents in cases.items():
        for content in contents:
            assert message in refusal(read_bml, path, content)
    path = folder / "anna.csv"
    assert "anna.csv, line 1: expected 230 numbers, got an empty file" in refusal(read_bml, path, b"")
    assert "line 2: expected 2 fields, got 1; the file seems to be cut off" in refusal(read_bml, path, b"1,2\n3\n")
    assert "line 1: expected a finite number or a gap as value 2 of 2, got 'x'" in refusal(read_bml, path, b"1,x\n")
    assert "expected a matrix of 5 x 46, 46 x 5, 1 x 230, 230 x 1, got 1 x 2" in refusal(read_bml, path, b"1,2\n")
    assert "expected the text of a table of numbers, got binary" in refusal(read_bml, path, b"\0")


def test_wrong_walks_are_not_written(folder):
    path = folder / "no.mat"
    walk, _ = make_walk(np.random.default_rng(0))
    joints = JointWalk(np.zeros((2, 1, 3)), np.zeros((2, 3)), Skeleton(("Hips",), [-1], np.zeros((1, 3))), 30)
    with pytest.raises(TypeError, match=r"turn joints into markers with to_markers\(\)"):
        write_bml(joints, path)
    with pytest.raises(WalkError, match=r"expected the 15 markers of TROJE15, got none for head, clavicle"):
        write_bml(Walk(np.zeros((9, 1, 3)), 30, MarkerSet(("left_ankle",))), path)
    gaps = walk.channels.copy()
    gaps[3, 4] = np.nan
    with pytest.raises(WalkError, match=r"expected finite values, got 1 NaN"):
        write_bml(walk.with_channels(gaps), path)
    with pytest.raises(WalkError, match=r"the phase reference is too weak"):
        write_bml(walk.with_channels(np.ones_like(gaps)), path)
    with pytest.raises(ValueError, match=r"marker_order must hold the 15 names head, .*, got head, toe"):
        write_bml(walk, path, marker_order=("head", "toe"))
    assert not path.exists()


def test_markers_in_another_order_and_further_ones(folder):
    walk, _ = make_walk(np.random.default_rng(0), n_cycles=10)
    more = MarkerSet(("heel", *ORDER))
    places = [0, *(TROJE15.index(name) for name in ORDER)]
    write_bml(Walk(walk.positions[:, places], 120, more), folder / "more.csv")
    write_bml(walk, folder / "plain.csv", marker_order=ORDER)
    assert_allclose(read_bml(folder / "more.csv").positions, walk.positions, atol=1e-9)
    assert_allclose(read_bml(folder / "plain.csv", marker_order=ORDER).positions, walk.positions, atol=1e-9)


@settings(max_examples=200, deadline=None)
@given(data=st.data(), suffix=st.sampled_from([".mat", ".csv"]), packed=st.booleans())
def test_any_content_is_read_or_refused(folder, data, suffix, packed):
    if suffix == ".mat":
        file = io.BytesIO()
        savemat(file, {"w": _matrix()}, do_compression=packed)
        content = file.getvalue()
    else:
        content = "\n".join(",".join(map(repr, row)) for row in _matrix().tolist()).encode()
    outcome(read_bml, folder / f"broken{suffix}", data.draw(faults(content)))


def test_matlab_files_of_all_kinds(folder):
    matrix = np.round(_matrix())
    for kind in (np.float64, np.float32, np.int32, np.int16, ">f8"):
        for packed in (True, False):
            path = folder / "anna.mat"
            savemat(path, {"long_name_of_a_variable": matrix.astype(kind)}, do_compression=packed)
            assert_array_equal(_to_matrix(_read_mat(path.read_bytes(), None)), matrix)
    assert "(5 x 46 complex double)" in refusal(read_bml, path, _saved(w=matrix + 1j))
    assert "w (5 x 46 sparse)" in refusal(read_bml, path, _saved(w=csc_array(matrix)))


def test_false_sizes_cost_no_memory(folder):
    """A packed variable that is large is refused by its size and never unpacked."""
    file = io.BytesIO()
    savemat(file, {"w": np.zeros((1, 4_000_000))}, do_compression=True)
    tracemalloc.start()
    message = refusal(read_bml, folder / "huge.mat", file.getvalue())
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert "w (1 x 4000000 double)" in message
    assert peak < 1_000_000
