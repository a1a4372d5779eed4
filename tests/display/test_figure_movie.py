"""Movies of bodies frame by frame, read back from their files."""

import re
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.display import Screen
from eigenwalker.display._ffmpeg import find_ffmpeg
from eigenwalker.display.figure_movie import draw_figures, write_figure_movie
from eigenwalker.display.figures import FigureDisplay

pytest.importorskip("imageio_ffmpeg")

SMALL = Screen(size=(160, 240))


@pytest.fixture(scope="module")
def display(walk):
    return FigureDisplay.from_walk(walk).seen_from(30)


def _read(path):
    """Return the pictures (n_frames, height, width) of an MP4, and its frames per second."""
    command = [find_ffmpeg(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "gray", "-fps_mode", "passthrough", "-"]
    done = subprocess.run(command, check=True, capture_output=True)
    about = done.stderr.decode()
    width, height = (int(side) for side in re.search(r"Video: h264 .*?, (\d+)x(\d+)", about).groups())
    return np.frombuffer(done.stdout, dtype=np.uint8).reshape(-1, height, width), float(
        re.search(r"([\d.]+) fps", about)[1]
    )


@pytest.mark.parametrize("figure", ["sticks", "dots"])
def test_a_movie_has_the_pictures_at_their_times(display, tmp_path, figure):
    shown = display.drawn_as(figure)
    movie = write_figure_movie(shown, tmp_path / "a.mp4", duration=0.4, rate=50, screen=SMALL)
    pictures, rate = _read(tmp_path / "a.mp4")
    assert rate == 50
    assert_allclose(movie.times, np.arange(20) / 50)
    assert_allclose(movie.duration, 0.4)
    expected = draw_figures(shown, movie.times, SMALL)
    assert pictures.shape == expected.shape
    assert np.abs(pictures.astype(float) - expected).mean() < 1  # next to no loss
    assert [path.name for path in tmp_path.iterdir()] == ["a.mp4"]


def test_a_movie_lasts_as_long_as_the_walk(display, tmp_path):
    short = replace(display, positions=display.positions[:60])
    movie = write_figure_movie(short, tmp_path / "a.mp4", screen=SMALL)
    assert len(_read(tmp_path / "a.mp4")[0]) == len(movie.times) == round(60 * short.duration)


def test_a_movie_is_the_same_twice(display, tmp_path):
    for name in ("a.mp4", "b.mp4"):
        write_figure_movie(display, tmp_path / name, duration=0.2, screen=SMALL)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_markers_are_where_they_are_seen(display):
    scale = 90.0
    (picture,) = draw_figures(display.drawn_as("dots"), [0.3], SMALL, scale=scale)
    width, height = SMALL.size
    for right, up in scale * display.evaluate([0.3])[0]:
        column, row = round(width / 2 + right - 0.5), round(height / 2 - up - 0.5)
        assert picture[row, column] > 128


def test_sticks_are_light_gray_on_black_and_dots_white(display):
    (sticks,) = draw_figures(display, [0.0], SMALL)
    (dots,) = draw_figures(display.drawn_as("dots"), [0.0], SMALL)
    assert (sticks.min(), sticks.max()) == (0, 204)
    assert (dots.min(), dots.max()) == (0, 255)


def test_a_body_that_is_far_away_is_still_seen(display):
    (picture,) = draw_figures(display, [0.0], SMALL, scale=10.0)
    assert picture.max() > 180
    rows = np.flatnonzero(picture.any(axis=1))
    assert 12 < rows[-1] - rows[0] < 22


def test_nothing_is_cut_off(display):
    pictures = draw_figures(display, np.arange(0, display.duration, 0.05), SMALL)
    border = np.concatenate([pictures[:, 0], pictures[:, -1], pictures[:, :, 0], pictures[:, :, -1]], axis=1)
    assert not border.any()
    rows = np.flatnonzero(pictures.any(axis=(0, 2)))
    columns = np.flatnonzero(pictures.any(axis=(0, 1)))
    filled = np.array([columns[-1] - columns[0] + 1, rows[-1] - rows[0] + 1]) / SMALL.size
    assert 0.85 < filled.max() < 0.91  # 0.9 if it reached as far down, without a head there, as it does up


def test_a_walk_on_its_way_crosses_the_picture_while_the_camera_holds_still(display):
    way = np.zeros((len(display.positions), 1, 3))
    way[:, 0, 0] = np.linspace(0, 3, len(way))
    going = replace(display, positions=display.positions + way, azimuth=90.0)
    pictures = draw_figures(going, [0.0, going.duration / 2, going.duration], Screen(size=(480, 240)))
    columns = [np.flatnonzero(picture.any(axis=0)).mean() for picture in pictures]
    assert columns[0] < 120
    assert_allclose(columns[1], 240, atol=20)
    assert columns[2] > 360


def test_one_scale_makes_bodies_comparable(display):
    tall = replace(display, positions=1.2 * display.positions)
    scale = min(one.pixels_per_meter(SMALL) for one in (display, tall))
    rows = [
        draw_figures(one, np.arange(0, 1, 0.1), SMALL, scale=scale).any(axis=(0, 2)).sum() for one in (display, tall)
    ]
    assert_allclose(rows[1] / rows[0], 1.2, atol=0.03)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"screen": Screen(size=(161, 240))}, r"an MP4's width and height must be even, got 161 x 240; use .*162, 240"),
        ({"duration": 0}, "duration must be a number above 0"),
        ({"rate": -1}, "rate must be a number above 0"),
        ({"scale": 0}, "scale must be a number above 0"),
        ({"scale": 1000}, r"'anna': expected a picture of \d+ x \d+ pixels or more, got 160 x 240"),
    ],
)
def test_what_cannot_be_written_leaves_nothing(display, tmp_path, options, said):
    with pytest.raises(ValueError, match=said):
        write_figure_movie(display, tmp_path / "a.mp4", **{"screen": SMALL} | options)
    assert not list(tmp_path.iterdir())


def test_other_suffixes_and_folders_are_refused(display, tmp_path):
    with pytest.raises(ValueError, match=r"the suffix of path must be one of '\.mp4', got '\.gif'"):
        write_figure_movie(display, tmp_path / "a.gif")
    with pytest.raises(FileNotFoundError, match="no folder"):
        write_figure_movie(display, tmp_path / "gone" / "a.mp4")


def test_pictures_of_several_times_are_those_of_each(display):
    times = [0.5, 0.0, 0.25]
    together = draw_figures(display, times, SMALL)
    assert_array_equal(together, [draw_figures(display, time, SMALL)[0] for time in times])
