"""Lengths of the body, and legs of a length that people have."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker._validation import WalkError
from eigenwalker.motion import TROJE15, MarkerSet, Walk, check_leg_length, stature


def _walk(leg, n_frames=4):
    """Return a walk whose legs are straight and `leg` metres long."""
    positions = np.zeros((n_frames, 15, 3))
    for side in ("left", "right"):
        for joint, height in (("hip", 1.0), ("knee", 0.5), ("ankle", 0.0)):
            positions[:, TROJE15.index(f"{side}_{joint}"), 2] = height * leg
    return Walk(positions, 30, name="anna")


@pytest.mark.parametrize("leg", [0.3, 0.85, 1.3])
def test_legs_of_people_pass(leg):
    check_leg_length(_walk(leg), unit="m")


@pytest.mark.parametrize(
    ("leg", "unit", "advice"),
    [
        (85.0, "m", r"walk 'anna': legs are 85 m long with unit='m', expected 0\.3 to 1\.3 m; read it with unit='cm'"),
        (850.0, "m", r"unit='mm'"),
        (0.0085, "cm", r"unit='m'"),
        (0.35 / 2.54, "cm", r"metres per unit, about 0\.062 for legs of 0\.85 m"),
        (33.0, "m", r"unit='in'"),
        (5.0, "m", r"about 0\.17 for legs"),
        (0.0, "m", r"are not those of a body"),
        (1e300, "m", r"legs are inf m long"),
    ],
)
def test_other_legs_are_refused_with_advice(leg, unit, advice):
    with pytest.raises(WalkError, match=advice):
        check_leg_length(_walk(leg), unit=unit)


def test_gaps_do_not_matter():
    positions = np.array(_walk(0.8).positions)
    positions[1:] = np.nan
    check_leg_length(Walk(positions, 30), unit="m")
    with pytest.raises(WalkError, match="legs are 80 m long"):
        check_leg_length(Walk(100 * positions, 30), unit="m")


def test_legs_that_are_nowhere_known_are_not_judged():
    check_leg_length(Walk(np.full((3, 15, 3), np.nan), 30), unit="m")


def test_legs_of_a_unit_body_are_not_judged():
    check_leg_length(replace(_walk(0.2), size=1.7))


def test_stature_is_the_sum_of_the_stretched_body():
    positions = np.array(_walk(0.8).positions)
    for marker, height in (("pelvis", 0.8), ("clavicle", 1.3), ("head", 1.6)):
        positions[:, TROJE15.index(marker), 2] = height
    assert_allclose(stature(Walk(positions, 30)), 0.8 + 0.5 + 0.3)


def test_stature_needs_its_markers():
    feet = MarkerSet(("left_ankle", "right_ankle"))
    with pytest.raises(WalkError, match="without the markers head, clavicle, pelvis"):
        stature(Walk(np.zeros((4, 2, 3)), 30, feet))
