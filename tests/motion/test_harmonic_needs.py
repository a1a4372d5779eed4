"""How many harmonics walks need."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker import Walk, WalkError, make_walkers
from eigenwalker.motion import explained_power, harmonics_table, stride_frequency
from tests.planted import planted_walk
from tests.recorded import bandai_joints, style
from tests.synthetic import make_walk


def test_columns_are_medians_of_the_explained_power():
    walks = make_walkers(5, random_state=0).data
    table = harmonics_table(walks, ["b", "a", "b", "b", "a"], n_harmonics=(3, 1))
    assert table.index.to_list() == ["b", "a"]
    assert table["n_walks"].to_list() == [3, 2]
    expected = [explained_power(walk.channels, walk.frame_rate, stride_frequency(walk), 3) for walk in walks]
    assert_allclose(table[3], [np.median([expected[0], *expected[2:4]]), np.mean([expected[1], expected[4]])])


def test_as_many_are_needed_as_were_put_in():
    rng = np.random.default_rng(0)
    walks = [make_walk(rng, n_harmonics=number)[0] for number in (1, 3)]
    table = harmonics_table(walks, ["plain", "rich"])
    assert table["needed_for_99_percent"].to_list() == [1, 3]
    assert_allclose(table.loc["rich", [3, 8]].astype(float), 1.0)
    assert (np.diff(table[list(range(1, 9))].to_numpy(dtype=float), axis=1) > -1e-9).all()


def test_a_share_is_of_the_most_harmonics():
    """Hand-made: waves with powers of 0.94, 0.05 and 0.01: one explains 94 %, two 99 %, and three are all."""
    times = np.arange(600) / 60
    positions = np.zeros((600, 15, 3))
    powers = np.array([0.94, 0.05, 0.01])
    wave = np.sqrt(powers) @ np.cos(2 * np.pi * np.outer([1, 2, 3], times))
    positions[:, :, 0] = wave[:, np.newaxis] * np.arange(15)
    walk = Walk(positions, 60.0, frequency=1.0)
    table = harmonics_table([walk], ["made"], n_harmonics=range(1, 4))
    assert_allclose(table.loc["made", [1, 2, 3]].astype(float), np.cumsum(powers))
    assert table.loc["made", "needed_for_95_percent"] == 2
    assert harmonics_table([walk], ["made"], n_harmonics=[1]).loc["made", "needed_for_99_percent"] == 1


def test_faults_are_told():
    walks = make_walkers(2, random_state=0).data
    with pytest.raises(ValueError, match="expected one label a walk, 2, got 1"):
        harmonics_table(walks, ["a"])
    with pytest.raises(ValueError, match="got a missing one"):
        harmonics_table(walks, ["a", None])
    with pytest.raises(ValueError, match="n_harmonics must be one number or more"):
        harmonics_table(walks, ["a", "b"], n_harmonics=[0, 1])
    with pytest.raises(ValueError, match="below half the frame rate"):
        harmonics_table(walks, ["a", "b"], n_harmonics=[200])
    gap = np.array(walks[0].positions)
    gap[0] = np.nan
    with pytest.raises(WalkError, match="expected finite values"):
        harmonics_table([Walk(gap, 60.0)], ["a"])
    with pytest.raises(TypeError, match="expected a list of walks"):
        harmonics_table(planted_walk(), ["a"])


def test_joint_angles_need_more_than_positions(data_dir):
    walks = bandai_joints(data_dir, 3)
    table = harmonics_table(walks, [style(walk) for walk in walks])
    assert len(table) == 7
    assert table["n_walks"].eq(3).all()
    assert table["needed_for_95_percent"].between(2, 3).all()
    assert table["needed_for_99_percent"].between(3, 5).all()
