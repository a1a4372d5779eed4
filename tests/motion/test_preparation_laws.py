"""What changes nothing downstream, in the features of prepared walks, beyond 1e-6.

For walks on a treadmill and over the floor, and with each way of preparation. The walks are without noise, so that it
does not matter which strides are cut out.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import prepare
from eigenwalker.model import FourierLinearizer
from eigenwalker.motion import TROJE15, mirror_walk, resample, symmetrize_walk
from tests.recordings import around, over_the_floor, turned
from tests.synthetic import make_walk

WAYS = {
    "default": {},
    "whole": {"clip": "whole"},
    "body": {"heading": "body"},
    "curve": {"heading": "curve"},
    "camera": {"camera": "moving"},
    "size": {"normalize_size": True},
    "steady": {"cadence": "steady"},
    "symmetric": {"symmetrize": True},
    "all": {"cadence": "steady", "symmetrize": True, "normalize_size": True, "heading": "curve"},
}
ways = pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
places = pytest.mark.parametrize("over_floor", [False, True], ids=["in place", "over the floor"])


def _clean(over_floor, *, frame_rate=120.0, n_cycles=6.3, stiff=False):
    """Return a walk without noise whose number of strides is not whole.

    A stiff walker has legs and a trunk of constant length, which its size is the median of.
    """
    rng = np.random.default_rng(7)
    still = around(make_walk(rng, frame_rate=frame_rate, n_cycles=n_cycles, phase=1.0, name="anna")[0])
    still = _stiff(still) if stiff else still
    return over_the_floor(still) if over_floor else still


def _stiff(walk):
    """Let each leg, and the trunk, move as a whole."""
    positions = walk.positions.copy()
    chains = [[f"{side}_{joint}" for joint in ("ankle", "knee", "hip")] for side in ("left", "right")]
    for leader, *others in (*chains, ["pelvis", "clavicle", "head"]):
        path = walk.marker(leader) - walk.marker(leader)[0]
        for name in others:
            positions[:, TROJE15.index(name)] = walk.marker(name)[0] + path
    return replace(walk, positions=positions)


def _features(walk):
    return FourierLinearizer().fit_transform([walk])


def _assert_same(one, other, way):
    assert_allclose(_features(prepare(one, **way)), _features(prepare(other, **way)), atol=1e-6)


@ways
@places
def test_no_way_knows_the_heading(over_floor, way):
    walk = _clean(over_floor)
    for degrees in (37.0, 171.0):
        _assert_same(turned(walk, degrees), walk, way)


@places
@pytest.mark.parametrize("change", [lambda walk: turned(walk, 37.0), lambda walk: mirror_walk(mirror_walk(walk))])
def test_events_are_found_whatever_the_heading(over_floor, change):
    """They lie between frames, so that only what keeps the frames can leave them where they are."""
    walk = _clean(over_floor)
    _assert_same(change(walk), walk, {"frequency": "events"})


@ways
def test_no_way_knows_the_place_over_the_floor(way):
    walk = _clean(over_floor=True)
    _assert_same(replace(walk, positions=walk.positions + np.array([30.0, -12.0, 0.0])), walk, way)


@ways
@places
def test_two_mirrors_change_nothing_and_one_mirrors_the_result(over_floor, way):
    walk = _clean(over_floor)
    assert_allclose(mirror_walk(mirror_walk(walk)).positions, walk.positions)
    assert_allclose(
        _features(prepare(mirror_walk(walk), **way)), _features(mirror_walk(prepare(walk, **way))), atol=1e-6
    )


@ways
@places
@pytest.mark.parametrize("factor", [2.0, 0.5, 0.25])
def test_other_frame_rates_change_nothing(over_floor, way, factor):
    """By whole numbers up and down: the number of frames and so the length in strides changes, too."""
    walk = _clean(over_floor, stiff=way.get("normalize_size"))
    _assert_same(resample(walk, frame_rate=factor * 120.0), walk, way)


@ways
@places
def test_the_number_of_frames_changes_nothing(over_floor, way):
    """Means over frames depend on where in a stride a recording ends; headings and heights are means over strides."""
    walk = _clean(over_floor, stiff=way.get("normalize_size"))
    for frames in (slice(0, -50), slice(40, None)):
        _assert_same(replace(walk, positions=walk.positions[frames]), walk, way)


@ways
def test_paths_that_the_model_spans_change_nothing(way):
    """Six strides have four coefficients of x and of y: the path may speed up, bend to a side and come back.

    Only `heading="curve"` turns with the bend, and without a fixed camera there is no path.
    """
    walk = _clean(over_floor=True)
    line = np.linspace(-1.0, 1.0, walk.n_frames)
    aside = np.zeros_like(line) if way.get("heading") == "curve" else 0.2 * line**2
    path = np.column_stack((0.3 * line**2 + 0.1 * line**3, aside, np.zeros_like(line)))
    _assert_same(replace(walk, positions=walk.positions + path[:, np.newaxis]), walk, way | {"clip": "whole"})


@places
def test_a_symmetric_walk_is_symmetrized_to_itself(over_floor):
    walk = symmetrize_walk(around(_clean(over_floor=False)))
    walk = over_the_floor(walk) if over_floor else walk
    plain, symmetric = prepare(walk), prepare(walk, symmetrize=True)
    assert_allclose(symmetric.positions, plain.positions, atol=1e-6)
