"""Rules for joint centres: their figures by hand, and what turning the body does to them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.motion.joint_centers import hip_center, inward_center, midpoint, shoulder_center


def _point(*coordinates):
    return np.array([coordinates], dtype=float)


def test_the_hip_by_the_regression():
    """A level pelvis 240 mm wide and 150 mm deep, walking along x; Harrington et al. 2007 in millimetres."""
    left, right, back = _point(0, 0.12, 1), _point(0, -0.12, 1), _point(-0.15, 0, 1)
    aside = (0.33 * 240 + 7.3) / 1000
    expected = [-(0.24 * 150 + 9.9) / 1000, aside, 1 - (0.30 * 240 + 10.9) / 1000]
    assert_allclose(hip_center(left, right, back, side="left"), [expected], atol=1e-12)
    expected[1] = -aside
    assert_allclose(hip_center(left, right, back, side="right"), [expected], atol=1e-12)


def test_a_marker_beside_the_middle_of_the_back_only_counts_for_the_depth():
    left, right = _point(0, 0.12, 1), _point(0, -0.12, 1)
    plain = hip_center(left, right, _point(-0.15, 0, 1), side="left")
    beside = hip_center(left, right, _point(-0.15, 0.01, 1), side="left")
    assert_allclose(beside[:, 1:], plain[:, 1:], atol=1e-12)
    assert_allclose(beside, plain, atol=1e-4)


def test_the_shoulder_below_the_acromion():
    """Acromia 360 mm apart: 17 % of it is 61.2 mm."""
    left, right, pelvis = _point(0, 0.18, 1.45), _point(0, -0.18, 1.45), _point(0, 0, 0.95)
    assert_allclose(shoulder_center(left, right, pelvis), [[0, 0.18, 1.45 - 0.0612]], atol=1e-12)
    assert_allclose(shoulder_center(right, left, pelvis), [[0, -0.18, 1.45 - 0.0612]], atol=1e-12)


def test_a_lateral_marker_is_moved_inward_at_right_angles():
    hip, other, marker = _point(0, 0.09, 0.9), _point(0, -0.09, 0.9), _point(0, 0.09, 0.5)
    assert_allclose(inward_center(marker, hip, hip, other, share=0.12), [[0, 0.09 - 0.048, 0.5]], atol=1e-12)
    forward = _point(0.4, 0.09, 0.9)  # the thigh swung forward
    assert_allclose(inward_center(forward, hip, hip, other, share=0.12), [[0.4, 0.09 - 0.048, 0.9]], atol=1e-12)


@pytest.mark.parametrize("rule", [midpoint, shoulder_center, hip_center, inward_center])
def test_rules_turn_with_the_body(rule):
    rng = np.random.default_rng(0)
    points = [base + 0.01 * rng.normal(size=(3, 3)) for base in ([0, 0.1, 1], [0, -0.1, 1], [-0.1, 0, 0.9], [0, 0, 0])]
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    n_points, more = {midpoint: (2, {}), shoulder_center: (3, {})}.get(rule, (3, {"side": "left"}))
    if rule is inward_center:
        n_points, more = 4, {"share": 0.1}
    turned = [point @ rotation.T + [1.0, 2.0, 3.0] for point in points]
    expected = rule(*points[:n_points], **more) @ rotation.T + [1.0, 2.0, 3.0]
    assert_allclose(rule(*turned[:n_points], **more), expected, atol=1e-12)
