"""Rigs: what they need, where they put markers, and what is wrong with them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.motion import FEET, RIGS, TROJE15, Estimate, MarkerSet, Rig, Walk, find_rig
from eigenwalker.motion.joint_centers import midpoint
from eigenwalker.motion.rig import as_rig, locate, sources

MAP = {name: name.upper() for name in TROJE15.names} | {"left_knee": {"LKNE": 0.5, "LKNM": 0.5}}
NAMES = [*(name for name in map(str.upper, TROJE15.names) if name != "LEFT_KNEE"), "LKNE", "LKNM", "NOSE"]


def _walk(**changes):
    positions = np.random.default_rng(0).normal(size=(4, len(NAMES), 3))
    return Walk(positions, 100, MarkerSet(tuple(NAMES)), "anna", **changes)


def test_places():
    positions = np.arange(12.0).reshape(2, 2, 3)
    between = {"A": 0.25, "B": 0.75}
    assert_allclose(locate("B", "AB", positions), positions[:, 1])
    assert_allclose(locate(between, "AB", positions), 0.25 * positions[:, 0] + 0.75 * positions[:, 1])
    middle = Estimate(midpoint, ("A", Estimate(midpoint, ("A", "B"))))
    assert_allclose(locate(middle, "AB", positions), 0.75 * positions[:, 0] + 0.25 * positions[:, 1])
    assert sources(middle) == {"A", "B"}


def test_a_gap_elsewhere_does_no_harm():
    walk = _walk()
    positions = walk.positions.copy()
    positions[2, NAMES.index("NOSE")] = np.nan
    positions[1, NAMES.index("LKNM")] = np.nan
    placed = Walk(positions, 100, walk.marker_set).to_markers(MAP)
    assert np.argwhere(np.isnan(placed.positions).any(axis=2)).tolist() == [[1, TROJE15.index("left_knee")]]


def test_a_dictionary_is_enough():
    walk = _walk(speed=1.2, size=1.7, frequency=0.9)
    placed = walk.to_markers(MAP)
    assert placed.marker_set is TROJE15
    assert (placed.name, placed.speed, placed.size, placed.frequency) == ("anna", 1.2, 1.7, 0.9)
    assert_allclose(placed.marker("left_knee"), (walk.marker("LKNE") + walk.marker("LKNM")) / 2)
    assert_allclose(placed.marker("head"), walk.marker("HEAD"))
    assert_allclose(walk.to_markers(Rig("mine", MAP)).positions, placed.positions)


def test_feet_are_kept_when_asked_for():
    walk = _walk()
    placed = walk.to_markers(MAP | dict.fromkeys(FEET, "NOSE"), feet=True)
    assert placed.marker_set.names == TROJE15.names + FEET
    assert_allclose(placed.marker("right_toe"), walk.marker("NOSE"))
    again = placed.to_markers()
    assert again.marker_set is TROJE15
    assert_allclose(again.positions, walk.to_markers(MAP).positions)
    assert_allclose(placed.to_markers(feet=True).positions, placed.positions)
    with pytest.raises(ValueError, match="'anna': rig 'map' does not place left_heel, left_toe, right_heel, right_toe"):
        walk.to_markers(MAP, feet=True)


def test_a_walk_of_the_15_markers_stays_as_it_is():
    walk = Walk(np.zeros((3, 15, 3)), 100)
    assert walk.to_markers() is walk
    backwards = Walk(np.arange(45.0).reshape(1, 15, 3), 100, MarkerSet(TROJE15.names[::-1]))
    assert_allclose(backwards.to_markers().channels, backwards.positions[:, ::-1].reshape(1, 45))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"head": None, "left_hip": 3}, "names with weights, but does not for head, left_hip; found HEAD, CLAVICLE"),
        ({"nose": "NOSE"}, "may place the 15 markers and left_heel, .*, but not nose"),
        ({"head": {"HEAD": 0.7}, "pelvis": {"PELVIS": float("nan")}}, "must sum to one, but not for head, pelvis"),
        ({"head": {}}, "must sum to one, but not for head"),
        ({"head": ""}, "names with weights, but does not for head"),
        ({"head": "SKULL", "pelvis": {"SACR": 1}}, "needs SACR, SKULL; found HEAD, CLAVICLE, .*, LKNE, LKNM, NOSE"),
        (
            {"head": "SKULL", "nose": "NOSE", "pelvis": {"PELVIS": 2}},
            "but not nose; weights must sum to one, but not for pelvis; needs SKULL; found",
        ),
    ],
)
def test_all_faults_of_a_dictionary_come_at_once(changes, message):
    with pytest.raises(ValueError, match=f"walk 'anna': the map of markers .*{message}"):
        _walk().to_markers(MAP | changes)


def test_markers_that_a_dictionary_forgets_are_named():
    some = {name: place for name, place in MAP.items() if name not in ("head", "left_ankle")}
    with pytest.raises(ValueError, match="must place all 15 markers; it lacks head, left_ankle; found HEAD, CLAV"):
        _walk().to_markers(some)
    with pytest.raises(TypeError, match="expected a Rig or a dictionary of the 15 markers, got str"):
        _walk().to_markers("cmu")


def test_rigs_are_checked():
    with pytest.raises(ValueError, match="rig 'half' must place all 15 markers; it lacks head, clavicle"):
        Rig("half", {name: {"hips": 1.0} for name in TROJE15.names[2:]})
    with pytest.raises(ValueError, match="weights must sum to one, but not for head"):
        Rig("odd", {name: {"hips": 1.0} for name in TROJE15.names} | {"head": {"hips": 0.7}})
    with pytest.raises(ValueError, match="weights must sum to one, but not for head"):
        Rig("odd", dict.fromkeys(TROJE15.names, "hips") | {"head": Estimate(midpoint, ("hips", {"hips": 2.0}))})
    assert as_rig(RIGS[0]) is RIGS[0]


def test_each_rig_is_found_by_what_it_needs():
    assert [find_rig(rig.sources) for rig in RIGS] == list(RIGS)


def test_what_the_nearest_known_set_lacks_is_said():
    names = sorted(RIGS[-2].sources - {"SACR", "LKNE"})
    with pytest.raises(
        ValueError, match=r"no known rig \(bandai, .*, horst\) fits the names C7, .* \(the nearest, plug-in gait, lacks"
    ):
        find_rig(names)
    with pytest.raises(ValueError, match=r"fits the names a, b; pass rig="):
        find_rig("ab")


def test_a_known_set_asks_for_its_static_trial():
    names = RIGS[-1].sources - {name for segment in RIGS[-1].segments for name in segment.carried}
    with pytest.raises(ValueError, match=r"nearest, horst, lacks L ANKLE LAT, .*, which a static trial has: pass stat"):
        find_rig(names)
