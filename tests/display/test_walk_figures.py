"""Paths and spectra of a walk, and Eigenwalkers on the body."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

from eigenwalker.display import AxisDisplay, SpectrumDisplay, StickFigureDisplay, TrajectoryDisplay, project
from eigenwalker.model import eigenwalker_features
from eigenwalker.motion import spectrum, step_frequency, stride_frequency
from tests.display.test_axis_display import _arrows
from tests.recorded import bandai_joints, style


def test_an_eigenwalker_is_drawn_as_an_axis_is(model):
    display = AxisDisplay.from_eigenwalker(model, 2, n_sd=3.0, views=("side",))
    change = eigenwalker_features(model).loc[2].to_numpy()[:45].reshape(15, 3)
    arrows = _arrows(display.axes_[0])
    assert_allclose(np.column_stack((arrows.U, arrows.V)), project(6 * change, 90)[:, :2], atol=1e-12)
    assert "Eigenwalker 2, " in display.axes_[0].get_title(loc="left")
    assert "\N{MINUS SIGN}3 SD" in display.axes_[0].get_title(loc="left")
    with pytest.raises(ValueError, match="number must be one of 1, 2"):
        AxisDisplay.from_eigenwalker(model, 0)
    with pytest.raises(ValueError, match="must be positive"):
        AxisDisplay.from_eigenwalker(model, n_sd=-1)


def test_eigenwalkers_are_the_directions_of_the_pca(model, walkers):
    """One SD along an Eigenwalker moves its own score by one SD, and no other."""
    changes = eigenwalker_features(model)
    average = model["linearizer"].transform(walkers.data).mean(axis=0)
    moved = model[1:-1].transform(average + changes.to_numpy()) - model[1:-1].transform([average])
    assert_allclose(moved, np.diag(np.sqrt(model["eigenwalkers"].explained_variance_)), atol=1e-10)


def test_paths_are_recorded_and_fitted(walkers):
    walk = walkers.data[0]
    display = TrajectoryDisplay.from_walk(walk, n_harmonics=2, views=("side",))
    recorded, fitted = display.axes_[0].lines[:15], display.axes_[0].lines[15:]
    assert len(fitted) == 15
    for marker, (raw, series) in enumerate(zip(recorded, fitted, strict=True)):
        seen = project(walk.positions[:, marker], 90)[:, :2]
        assert_allclose(raw.get_xydata(), seen)
        nearest = np.linalg.norm(series.get_xydata()[:, np.newaxis] - seen, axis=2).min(axis=1)
        assert nearest.mean() < 0.02  # metres; two harmonics do not hold all of it
    with pytest.raises(ValueError, match="views must be a sequence"):
        TrajectoryDisplay.from_walk(walk, views="side")


def test_spectra_are_those_of_the_channels(walkers):
    walk = walkers.data[0]
    display = SpectrumDisplay.from_walk(walk, n_harmonics=3)
    frequency = stride_frequency(walk)
    expected = spectrum(walk, max_frequency=3.5 * frequency).iloc[1:]
    lines = display.ax_.lines
    assert_allclose(lines[7].get_ydata(), expected.iloc[:, 7])
    assert_allclose(lines[45].get_ydata(), np.sqrt((expected**2).mean(axis=1)))
    assert_allclose([line.get_xdata()[0] for line in lines[46:]], frequency * np.arange(1, 4))
    with pytest.raises(ValueError, match="n_harmonics must be at least 1"):
        SpectrumDisplay.from_walk(walk, n_harmonics=0)


def test_spectra_of_several_walks_stand_side_by_side(walkers):
    walks = walkers.data[:4]
    display = SpectrumDisplay.from_walks(walks, labels=list("abcd"), n_harmonics=3, steps=True)
    assert len(display.axes_) == 4
    assert display.ax_ is display.axes_[0]
    top = 3.5 * max(stride_frequency(walk) for walk in walks)
    for walk, label, ax in zip(walks, "abcd", display.axes_, strict=True):
        expected = spectrum(walk, max_frequency=top).iloc[1:]
        assert_allclose(ax.lines[45].get_ydata(), np.sqrt((expected**2).mean(axis=1)))
        assert_allclose(ax.lines[-1].get_xdata(), step_frequency(walk))
        assert ax.get_title(loc="left") == f"{label}, {stride_frequency(walk):.2f} Hz"
    assert len({ax.get_ylim() for ax in display.axes_}) == len({ax.get_xlim() for ax in display.axes_}) == 1
    own = SpectrumDisplay.from_walks(walks, same_scale=False)
    assert len({ax.get_ylim() for ax in own.axes_}) == 4
    assert len({ax.get_xlim() for ax in own.axes_}) == 1
    axes = list(Figure().subplots(1, 4))
    assert SpectrumDisplay.from_walks(walks, ax=axes).axes_ == axes
    assert display._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match="ax must be 4 axes, one a panel, got 3"):
        SpectrumDisplay.from_walks(walks, ax=axes[:3])
    with pytest.raises(ValueError, match="labels must be 4 names, one a walk, got 1"):
        SpectrumDisplay.from_walks(walks, labels=["a"])


def test_walks_of_joints_have_spectra_and_stick_figures(data_dir, walkers):
    walks = bandai_joints(data_dir, 1)
    display = SpectrumDisplay.from_walks(walks, labels=[style(walk) for walk in walks], steps=True)
    assert len(display.axes_) == 7
    assert {shown.unit for shown in display.spectra} == {"rad"}
    with pytest.raises(ValueError, match="walks must be all of markers or all of joints"):
        SpectrumDisplay.from_walks([walks[0], walkers.data[0]])
    figures = StickFigureDisplay.from_walks([walks[0], walkers.data[0]], n_phases=3)
    assert [walk.name for walk in figures.walks] == [walks[0].name, walkers.data[0].name]
    assert_allclose(figures.walks[0].positions, walks[0].to_markers().positions)
