"""Paths taken out of walks, straight and curved."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import WalkError, prepare
from eigenwalker.model import FourierLinearizer
from tests.recordings import around, over_the_floor, record, walked_curve
from tests.synthetic import make_walk


def _features(*walks):
    return FourierLinearizer().fit_transform(list(walks))


@pytest.mark.parametrize(("total", "tolerance"), [(0.3, 1e-4), (-0.6, 2e-4), (1.0, 1e-3)])
def test_a_gentle_curve_can_be_straightened(total, tolerance):
    """Eight strides on an arc, turning by `total` radians: four coefficients of the path bend nearly like it.

    The features are then those of the straight walk to a tenth of a millimeter, to one at a radian; as one direction
    for the whole, which `heading="path"` takes, they are a hundred times further off.
    """
    still = around(make_walk(np.random.default_rng(1), n_cycles=8, frame_rate=60.0, name="anna")[0])
    curve = walked_curve(still, total)
    straight, bent, wanted = (
        prepare(walk, clip="whole", heading=heading)
        for walk, heading in ((curve, "curve"), (curve, "path"), (over_the_floor(still), "path"))
    )
    found, plain, wanted_features = _features(straight, bent, wanted)
    assert np.abs(found - wanted_features).max() < tolerance
    assert np.abs(plain - wanted_features).max() > 10 * tolerance
    assert_allclose(straight.speed, 1.3, rtol=1e-3)


def test_a_curve_that_stays_on_the_floor_is_a_straight_walk():
    still = around(make_walk(np.random.default_rng(1), n_cycles=8, frame_rate=60.0)[0])
    walk = prepare(walked_curve(still, 0.5), clip="whole", heading="curve", treadmill=False)
    away = walk.marker("pelvis")[-1] - walk.marker("pelvis")[0]
    assert_allclose(away[0] / walk.duration, 1.3, rtol=0.01)
    assert abs(away[1]) < 0.05
    assert_allclose(_features(prepare(walk, clip="whole")), _features(prepare(over_the_floor(still))), atol=2e-4)


def test_a_path_that_stops_cannot_be_straightened():
    walk = record([("walk", 6, 0), ("stand", 5, 0)])
    with pytest.raises(
        WalkError, match=r"'anna': expected a path that leads on throughout.*nearly stops.*split_passes"
    ):
        prepare(walk, clip="whole", heading="curve")
