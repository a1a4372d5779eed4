"""A joint taken apart into its mean and its harmonics."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

from eigenwalker import WalkError
from eigenwalker.display import DecompositionDisplay
from eigenwalker.motion import fit_harmonics, project_harmonics, stride_frequency
from tests.planted import standing_walk


@pytest.fixture(scope="module")
def knees():
    """Return a walk of joints whose left knee turns as 0.5 + 0.4 cos(omega t + 1) + 0.1 cos(2 omega t - 2), at 1 Hz."""
    walk = standing_walk(300, name="anna", frequency=1.0)
    times = np.arange(300) / 120
    rotations = np.zeros(walk.rotations.shape)
    rotations[:, walk.skeleton.index("LeftLeg"), 1] = (
        0.5 + 0.4 * np.cos(2 * np.pi * times + 1) + 0.1 * np.cos(4 * np.pi * times - 2)
    )
    rotations[:, walk.skeleton.index("LeftUpLeg"), 1] = 0.3 * np.sin(2 * np.pi * times)
    return replace(walk, rotations=rotations)


def _values(ax):
    return np.column_stack([line.get_ydata() for line in ax.lines[-3:]])


def test_panels_are_the_parts_and_add_up(knees):
    display = DecompositionDisplay.from_walk(knees, "LeftLeg")
    original, mean, *waves, total = (_values(ax) for ax in display.axes_)
    assert_allclose(original, knees.rotations[:, knees.skeleton.index("LeftLeg")])
    assert_allclose(mean[:, 1], 0.5)
    times = np.arange(300) / 120
    assert_allclose(waves[0][:, 1], 0.4 * np.cos(2 * np.pi * times + 1), atol=1e-9)
    assert_allclose(waves[1][:, 1], 0.1 * np.cos(4 * np.pi * times - 2), atol=1e-9)
    assert_allclose(mean + sum(waves), total, atol=1e-12)
    assert_allclose(_values(display.axes_[-1]), original, atol=1e-9)
    assert_allclose(np.column_stack([line.get_ydata() for line in display.axes_[-1].lines[:3]]), original)


def test_the_table_has_amplitudes_and_phases(knees):
    table = DecompositionDisplay.from_walk(knees, "left_knee").table()
    assert_allclose(table.loc["LeftLeg_y", "amplitude"], [0.5, 0.4, 0.1])
    assert_allclose(table.loc["LeftLeg_y", "phase"], [np.nan, 1.0, -2.0])
    assert len(table) == 9


def test_markers_are_taken_apart_too(walk):
    display = DecompositionDisplay.from_walk(walk, "left_ankle", n_harmonics=3, fit=project_harmonics)
    assert len(display.axes_) == 6
    assert display.unit == "m"
    known = walk.marker("left_ankle"), walk.frame_rate, stride_frequency(walk), 3
    assert_allclose(display.coefficients, project_harmonics(*known))
    fitted = DecompositionDisplay.from_walk(walk, "left_ankle", n_harmonics=3)
    assert_allclose(fitted.coefficients, fit_harmonics(*known))
    assert "100.0 %" in list(fitted.parts())[-1]  # the walk was made of three harmonics


def test_all_panels_span_the_same(knees):
    display = DecompositionDisplay.from_walk(knees, "LeftUpLeg")
    spans = [np.ptp(ax.get_ylim()) for ax in display.axes_]
    assert_allclose(spans, spans[0])
    still = DecompositionDisplay.from_walk(knees, "LeftFoot")
    assert np.ptp(still.axes_[0].get_ylim()) > 0


def test_axes_are_taken_and_figures_unknown_to_pyplot(knees):
    axes = list(Figure().subplots(5, 1))
    display = DecompositionDisplay.from_walk(knees, "left_knee", ax=axes)
    assert display.axes_ == axes
    assert display.figure_ is axes[0].figure
    assert axes[2].get_ylabel() == "exponential map (rad)"
    with pytest.raises(ValueError, match="ax must be 5 axes, one a panel, got 2"):
        display.plot(ax=axes[:2])
    assert display._repr_png_().startswith(b"\x89PNG")
    assert not pyplot.get_fignums()


def test_unknown_joints_are_refused(knees, walk):
    with pytest.raises(WalkError, match="walk 'anna': no marker or joint 'left_tail' with channels; it has Hips"):
        DecompositionDisplay.from_walk(knees, "left_tail")
    with pytest.raises(WalkError, match="no marker or joint 'LeftLeg'"):
        DecompositionDisplay.from_walk(walk, "LeftLeg")
    with pytest.raises(WalkError, match="no marker or joint 'LeftLeg'"):
        DecompositionDisplay.from_walk(replace(knees, channel_joints=("LeftUpLeg", "RightUpLeg")), "LeftLeg")
    with pytest.raises(WalkError, match="no marker or joint 'pelvis'"):  # lies between two joints
        DecompositionDisplay.from_walk(knees, "pelvis")
