"""Trait axes on the body."""

import numpy as np
import pytest
from matplotlib.quiver import Quiver
from numpy.testing import assert_allclose

from eigenwalker.display import AxisDisplay, project
from eigenwalker.model import TraitClassifier, axis_features, axis_shares, make_eigenwalkers, walk_along_axis
from eigenwalker.motion import JointWalk, Skeleton


def _arrows(ax):
    return next(item for item in ax.collections if isinstance(item, Quiver))


@pytest.mark.parametrize("alpha", [2.0, 0.7])
@pytest.mark.parametrize(("panel", "azimuth"), [(0, 0.0), (1, 90.0), (2, 45.0)])
def test_arrows_are_the_change_of_the_mean_posture(model, alpha, panel, azimuth):
    display = AxisDisplay.from_estimator(model, "happy", alpha=alpha, views=("frontal", "side", 45.0))
    change = axis_features(model).loc["happy"].to_numpy()[:45].reshape(15, 3)
    expected = project(2 * alpha * change, azimuth)
    arrows = _arrows(display.axes_[panel])
    assert_allclose(np.column_stack((arrows.U, arrows.V)), expected[:, :2], atol=1e-12)
    assert (arrows.scale, arrows.scale_units, arrows.angles) == (1, "xy", "xy")  # to scale


def test_paths_are_those_of_the_walks_along_the_axis(model):
    display = AxisDisplay.from_estimator(model, "gender", alpha=1.5, views=("side",))
    lines = display.axes_[0].lines
    assert len(lines) == 30
    dashed, solid = lines[0::2], lines[1::2]
    assert {line.get_linestyle() for line in dashed} == {"--"}
    assert {line.get_linestyle() for line in solid} == {"-"}
    walks = walk_along_axis(model, "gender", [-1.5, 1.5])
    for marker, drawn in enumerate(zip(dashed, solid, strict=True)):
        for walk, line in zip(walks, drawn, strict=True):
            seen = project(walk.positions[:, marker], 90)
            # The walk has other frames than the path has points, so that their extremes are only close.
            assert_allclose(np.ptp(line.get_xydata(), axis=0), np.ptp(seen[:, :2], axis=0), atol=1e-3)
            assert_allclose(line.get_xydata()[0], seen[0, :2], atol=1e-12)


def test_arrows_start_at_the_mean_of_the_dashed_paths(model):
    ax = AxisDisplay.from_estimator(model, "happy").axes_[1]
    starts = np.array([line.get_xydata()[:-1].mean(axis=0) for line in ax.lines[0::2]])
    assert_allclose(_arrows(ax).XY, starts, atol=1e-12)


@pytest.mark.parametrize(
    ("view", "far"),
    [("frontal", "none"), ("half-profile", "left_"), ("side", "left_"), (-90.0, "right_"), (180.0, "none")],
)
def test_far_side_of_the_body_is_paler(model, view, far):
    ax = AxisDisplay.from_estimator(model, "happy", views=[view]).axes_[0]
    names = model["linearizer"].template_.marker_set.names
    is_pale = [line.get_color() != "0" for line in ax.lines[1::2]]
    assert is_pale == [name.startswith(far) for name in names]


def test_words_say_trait_poles_shares_and_frequency(model):
    display = AxisDisplay.from_estimator(model, "happy")
    title = display.axes_[0].get_title(loc="left")
    change = 4 * axis_features(model).loc["happy", "frequency"]
    assert "happy: from sad (alpha = −2) to happy (alpha = +2)" in title
    assert f"structure {axis_shares(model).loc['happy', 'structure']:.0%}" in title
    assert f"{change:+.2f} Hz".replace("-", "−") in title
    vectors = model["linearizer"].transform(walk_along_axis(model, "happy", [-2, 2]))
    assert_allclose(display.frequencies[[0, 2]], vectors[:, -1], rtol=1e-9)


def test_views_are_drawn_to_one_scale(model):
    display = AxisDisplay.from_estimator(model, "gender", views=("frontal", "side"))
    display.figure_.canvas.draw()
    heights = [ax.get_window_extent().height for ax in display.axes_]
    assert heights[0] == pytest.approx(heights[1], rel=0.02)
    assert display.axes_[0].get_ylim() == display.axes_[1].get_ylim()


def test_one_view_can_be_drawn_on_one_axes(model):
    ax = AxisDisplay.from_estimator(model, "gender").axes_[0]
    assert AxisDisplay.from_estimator(model, "gender", views=["side"], ax=ax).axes_ == [ax]


def test_classifiers_weights_and_extras_are_drawn(walkers):
    trait = TraitClassifier(poles={"gender": ("female", "male")})
    model = make_eigenwalkers(n_components=5, trait=trait, extras=("speed",), weights={"dynamics": 0.5})
    model.fit(walkers.data, walkers.target["gender"])
    display = AxisDisplay.from_estimator(model, "gender")
    assert display.axes_[0].get_title(loc="left").startswith("gender: from female")
    assert display.coefficients.shape == (3, 5, 15, 3)


@pytest.mark.parametrize(
    ("trait", "options", "message"),
    [
        ("sad", {}, "trait must be one of 'gender', 'happy', got 'sad'"),
        ("happy", {"alpha": 0.0}, "alpha must be positive"),
        ("happy", {"alpha": float("nan")}, "alpha must be positive"),
        ("happy", {"views": "side"}, r"views must be a sequence of one view or more, \('side',\), got 'side'"),
        ("happy", {"views": ()}, "views must be a sequence of one view or more"),
        ("happy", {"views": ("above",)}, "view must be one of frontal, half-profile, side"),
    ],
)
def test_wrong_arguments_are_refused(model, trait, options, message):
    with pytest.raises(ValueError, match=message):
        AxisDisplay.from_estimator(model, trait, **options)


def test_joint_walks_have_no_body_to_draw():
    skeleton = Skeleton(("hips", "left", "right"), [-1, 0, 0], np.zeros((3, 3)))
    angle = 2 * np.pi * np.arange(300) / 100
    walks = []
    for size in (0.3, 0.4, 0.5, 0.7):
        rotations = np.zeros((300, 3, 3))
        rotations[:, 1, 0], rotations[:, 2, 0] = size * np.cos(angle), -(size**2) * np.cos(angle)
        walks.append(JointWalk(rotations, np.zeros((300, 3)), skeleton, 100.0))
    model = make_eigenwalkers(n_components=1, scaling=None)
    model.set_params(linearizer__phase_reference={"left_x": 1.0, "right_x": -1.0}).fit(walks, [1.0, 2.0, 2.5, 4.0])
    with pytest.raises(TypeError, match=r"expected walks of markers \(Walk\).*got JointWalk.*to_markers"):
        AxisDisplay.from_estimator(model, "trait")
