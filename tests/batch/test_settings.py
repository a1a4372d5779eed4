"""Equal settings have equal descriptions, other settings others."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eigenwalker import WalkPreparer
from eigenwalker.batch.settings import describe, read_settings
from eigenwalker.motion import find_rig
from tests.batch.walk_files import make_from_seed

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=10,
)


@given(VALUES)
def test_plain_values_stay_as_json_has_them(value):
    assert json.dumps(describe(value)) == json.dumps(value)


def test_numbers_of_numpy_are_numbers():
    given = {"a": np.float32(0.5), "b": np.int64(3), "c": np.arange(3), "d": (np.True_,)}
    assert describe(given) == {"a": 0.5, "b": 3, "c": [0, 1, 2], "d": [True]}


def test_long_arrays_are_told_apart():
    array = np.zeros((100, 3))
    other = array.copy()
    other[50] = 1e-12
    assert describe(array) == describe(array.copy()) != describe(other)
    assert describe(array) != describe(array.reshape(3, 100))


def test_walks_and_rigs_are_told_apart():
    walk = make_from_seed(0)
    assert describe(walk) == describe(replace(walk)) != describe(make_from_seed(1))
    rig = find_rig(walk.marker_set.names)
    assert describe(rig) == describe(replace(rig)) != describe(replace(rig, name="other"))


def test_functions_are_known_by_name_and_by_what_is_bound():
    assert describe(make_from_seed) == "tests.batch.walk_files.make_from_seed"
    bound = describe(partial(make_from_seed, n_cycles=4.0))
    assert bound == {"function": describe(make_from_seed), "arguments": [], "n_cycles": 4.0}
    assert describe(partial(make_from_seed, n_cycles=5.0)) != bound


def test_other_objects_are_described_by_what_they_hold():
    assert describe(WalkPreparer()) == describe(WalkPreparer()) != describe(WalkPreparer(cutoff=6.0))
    assert describe({"b", "a"}) == ["a", "b"]
    assert "at 0x" not in json.dumps(describe(WalkPreparer()))


@pytest.mark.parametrize("text", ["", "[]", '{"program": {"format": 2}}', '{"program": {"format": 1}}'])
def test_settings_that_cannot_be_read(tmp_path, text):
    (tmp_path / "_settings.json").write_text(text)
    with pytest.raises(ValueError, match=r"expected the settings that linearize_files wrote in _settings\.json and"):
        read_settings(tmp_path)


def test_a_free_folder_has_no_settings(tmp_path):
    for name in ("_lock", "_template.npz", "._settings.json.tmp"):
        (tmp_path / name).touch()
    assert read_settings(tmp_path) is None
    assert read_settings(tmp_path / "absent") is None
