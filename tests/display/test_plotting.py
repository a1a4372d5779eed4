"""Stick figures."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from numpy.testing import assert_allclose

from eigenwalker.display import StickFigureDisplay, project
from tests.synthetic import make_walk


def test_views_are_seen_from_where_they_say():
    forward, left, up = np.eye(3)
    assert_allclose(project([forward, left, up], 0), [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-12)
    assert_allclose(project([forward, left, up], 90), [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-12)


def test_projection_keeps_lengths():
    points = np.random.default_rng(0).normal(size=(4, 3))
    assert_allclose(np.linalg.norm(project(points, 33.0), axis=1), np.linalg.norm(points, axis=1))


@pytest.mark.parametrize("view", ["frontal", "half-profile", "side", 45.0])
def test_every_walk_is_drawn_at_every_phase(view):
    walks = [make_walk(np.random.default_rng(seed), name=f"walker {seed}")[0] for seed in range(2)]
    display = StickFigureDisplay.from_walks(walks, view=view, n_phases=4)
    sticks = [c for c in display.ax_.collections if isinstance(c, LineCollection)]
    assert [len(c.get_segments()) for c in sticks] == [4 * len(walks[0].marker_set.sticks)] * 2
    assert [text.get_text() for text in display.ax_.texts] == ["walker 0", "walker 1"]
    assert display.plot(ax=display.ax_).figure_ is display.figure_


def test_first_phase_has_the_left_foot_in_front():
    walk, _ = make_walk(np.random.default_rng(0), phase=2.0)
    display = StickFigureDisplay.from_walks([walk], view="side", n_phases=2)
    dots = next(c.get_offsets() for c in display.ax_.collections if len(c.get_offsets()) == 30).reshape(2, 15, 2)
    left, right = (walk.marker_set.index(f"{side}_ankle") for side in ("left", "right"))
    assert dots[0, left, 0] - dots[0, right, 0] > 0.5


def test_unknown_views_are_refused():
    walk, _ = make_walk(np.random.default_rng(0))
    with pytest.raises(ValueError, match="view must be one of frontal, half-profile, side or an azimuth"):
        StickFigureDisplay.from_walks([walk], view="above")
    with pytest.raises(TypeError, match="wrap it"):
        StickFigureDisplay.from_walks(walk)
