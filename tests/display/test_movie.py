"""Movies, read back from their files: places of dots, times, sizes; in a browser too."""

import base64
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.display import Screen, draw_frames, write_movie
from eigenwalker.display._ffmpeg import encode_mp4, find_ffmpeg
from eigenwalker.display.discs import draw_discs
from eigenwalker.display.movie import plan_movie

pytest.importorskip("imageio_ffmpeg")
image = pytest.importorskip("PIL.Image")

SMALL = Screen(distance=0.57, pixel_pitch=0.00054, size=(160, 240))


@pytest.fixture(scope="module")
def apart(walker):
    """Return a display whose dots never touch."""
    names = ["head", "left_wrist", "right_wrist", "pelvis", "left_ankle"]
    return walker.only(names).seen_from("frontal").sized(height=9)


def _read_mp4(path):
    """Return the pictures (n_frames, height, width), frames per second and seconds of an MP4, by its own account."""
    command = [find_ffmpeg(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "gray", "-fps_mode", "passthrough", "-"]
    done = subprocess.run(command, check=True, capture_output=True)
    about = done.stderr.decode()
    hours, minutes, seconds = (float(part) for part in re.search(r"Duration: (\d+):(\d+):([\d.]+)", about).groups())
    width, height = (int(side) for side in re.search(r"Video: h264 .*?, (\d+)x(\d+)", about).groups())
    rate = float(re.search(r"([\d.]+) fps", about)[1])
    pictures = np.frombuffer(done.stdout, dtype=np.uint8).reshape(-1, height, width)
    return pictures, rate, 3600 * hours + 60 * minutes + seconds


def _read_gif(path):
    """Return the pictures (n_frames, height, width) and the delays in milliseconds of a GIF."""
    with image.open(path) as file:
        assert file.info["loop"] == 0  # for ever
        pictures, delays = [], []
        for frame in range(file.n_frames):
            file.seek(frame)
            pictures.append(np.array(file.convert("L")))
            delays.append(file.info["duration"])
    return np.array(pictures), delays


def _centroids(pictures, centers, reach):
    """Return the centers of mass around some places (n_frames, n_dots, 2), column and row in pixels."""
    found = np.empty_like(centers)
    rows, columns = np.mgrid[: pictures.shape[1], : pictures.shape[2]]
    for frame, picture in enumerate(pictures.astype(float)):
        for dot, (column, row) in enumerate(centers[frame]):
            near = picture * (np.hypot(rows - row, columns - column) < reach)
            found[frame, dot] = (near * columns).sum() / near.sum(), (near * rows).sum() / near.sum()
    return found


def _expected(display, times, screen):
    """Return where dots should be, column and row in pixels, from where they are in degrees."""
    tangents = np.tan(np.deg2rad(display.evaluate(times, unit="deg")))
    pixels = tangents * screen.distance / screen.pixel_pitch
    width, height = screen.size
    return np.stack((width / 2 + pixels[..., 0] - 0.5, height / 2 - pixels[..., 1] - 0.5), axis=-1)


# ---- discs


@given(column=st.floats(10, 20), row=st.floats(10, 20), diameter=st.floats(1, 9))
def test_discs_have_their_area_and_place(column, row, diameter):
    picture = next(draw_discs(np.array([[[column, row]]]), diameter, (32, 30))) / 255
    assert_allclose(picture.sum(), np.pi * diameter**2 / 4, rtol=0.01)
    rows, columns = np.mgrid[:30, :32]
    assert_allclose((picture * columns).sum() / picture.sum(), column, atol=0.1)
    assert_allclose((picture * rows).sum() / picture.sum(), row, atol=0.1)


@pytest.mark.parametrize("diameter", [0.4, 1.0, 2.5, 6.0])
def test_pixels_have_the_part_that_is_covered(diameter):
    """Against counting 10,000 points in each pixel."""
    points = (np.arange(100) + 0.5) / 100 - 0.5
    column, row = 7.13, 6.42
    x, y = ((np.arange(14)[:, np.newaxis] + points).ravel() - center for center in (column, row))
    inside = x**2 + y[:, np.newaxis] ** 2 < diameter**2 / 4
    covered = inside.reshape(14, 100, 14, 100).mean(axis=(1, 3))  # (rows, points, columns, points) -> (rows, columns)
    picture = next(draw_discs(np.array([[[column, row]]]), diameter, (14, 14)))
    assert_allclose(picture, 255 * covered, atol=0.5 + 0.3)  # of rounding, and of counting


def test_discs_across_the_edge_and_outside():
    """A picture is a window on a larger one."""
    centers = np.array([[[-1.3, 5.2], [8.0, -0.4], [19.5, 9.7], [-1e9, 4.0], [np.nan, np.nan], [7.0, 1e9]]])
    small = next(draw_discs(centers, 5.0, (20, 10))).copy()
    large = next(draw_discs(centers + 10, 5.0, (40, 30)))
    assert_array_equal(small, large[10:20, 10:30])
    assert small.any(axis=1).sum() > 5


def test_discs_overlap_by_the_larger_value_and_leave_no_trace():
    one, other = np.array([[4.2, 4.0]]), np.array([[6.1, 5.0]])
    frames = np.array([np.stack((one, other), axis=1)[0], np.full((2, 2), np.nan), np.stack((one, one), axis=1)[0]])
    both, empty, same = (picture.copy() for picture in draw_discs(frames, 4.0, (12, 10)))
    alone = [next(draw_discs(center[np.newaxis], 4.0, (12, 10))).copy() for center in (one, other)]
    assert_array_equal(both, np.maximum(*alone))
    assert not empty.any()
    assert_array_equal(same, alone[0])


# ---- files


def test_gif_shows_what_was_drawn(apart, tmp_path):
    """Without loss, and dots where they are projected to, within 0.1 px."""
    movie = write_movie(apart, tmp_path / "walker.gif", duration=0.6, screen=SMALL)
    pictures, delays = _read_gif(movie.path)
    assert_array_equal(pictures, draw_frames(apart, movie.times, SMALL))
    assert delays == [20] * 30
    expected = _expected(apart, np.arange(30) / 50, SMALL)
    assert_allclose(_centroids(pictures, expected, 8), expected, atol=0.1)


def test_mp4_shows_what_was_drawn(apart, tmp_path):
    """Dots where they are projected to, within 0.3 px, and grays within a few steps."""
    movie = write_movie(apart, tmp_path / "walker.mp4", duration=0.7, screen=SMALL)
    pictures, rate, duration = _read_mp4(movie.path)
    drawn = draw_frames(apart, movie.times, SMALL)
    assert pictures.shape == drawn.shape == (42, 240, 160)
    assert (rate, duration) == (60.0, 0.7)
    assert np.abs(pictures.astype(int) - drawn).mean() < 0.5
    assert np.abs(pictures.astype(int) - drawn).max() < 40
    expected = _expected(apart, np.arange(42) / 60, SMALL)
    assert_allclose(_centroids(pictures, expected, 8), expected, atol=0.3)
    assert list(tmp_path.iterdir()) == [movie.path]


def test_dark_dots_on_light(apart, tmp_path):
    dark = apart.with_dots(0.25, "dark")
    assert_array_equal(draw_frames(dark, [0.0], SMALL), 255 - draw_frames(apart, [0.0], SMALL))
    pictures, _ = _read_gif(write_movie(dark, tmp_path / "dark.gif", duration=0.1, screen=SMALL).path)
    assert pictures[0, 0, 0] == 255
    pictures, *_ = _read_mp4(write_movie(dark, tmp_path / "dark.mp4", duration=0.1, screen=SMALL).path)
    assert pictures[0, 0, 0] >= 254


def test_dots_that_are_not_lit_are_not_drawn(apart):
    limited = apart.limit_lifetime(2, 0.1, random_state=0)
    areas = (draw_frames(limited, np.arange(30) / 60, SMALL) / 255).sum(axis=(1, 2))
    assert_allclose(areas, 2 * np.pi / 4 * SMALL.pixels_across(0.25) ** 2, rtol=0.1)


# ---- one exact stride


@pytest.mark.parametrize("frequency", [0.7, 0.93, 1.0, 1.31])
@pytest.mark.parametrize("rate", [24.0, 59.94, 60.0, 144.0])
def test_one_stride_as_an_mp4_loops_without_a_seam(apart, tmp_path, frequency, rate):
    dots = replace(apart.dots, frequencies=np.full_like(apart.dots.frequencies, frequency))
    display = replace(apart, dots=dots)
    movie = plan_movie(display, tmp_path / "stride.mp4", duration=None, rate=rate, screen=SMALL)
    assert_allclose(movie.duration, 1 / frequency, rtol=1e-12)
    assert_allclose(movie.rate, rate, rtol=0.5 / len(movie.times))
    assert_allclose(np.diff([*movie.times, display.period]), 1 / movie.rate)  # the next frame would be the first
    assert_allclose(float(Fraction(movie.rate).limit_denominator(1001)), movie.rate, rtol=1e-6)  # as it is written


@pytest.mark.parametrize("frequency", [0.7, 0.93, 1.0, 1.31])
@pytest.mark.parametrize("rate", [12.5, 24.0, 30.0, 50.0])
def test_one_stride_as_a_gif_loops_without_a_seam(apart, tmp_path, frequency, rate):
    """Every frame is at the phase at which it is shown, and the whole lasts within half a hundredth of a stride."""
    dots = replace(apart.dots, frequencies=np.full_like(apart.dots.frequencies, frequency))
    movie = plan_movie(replace(apart, dots=dots), tmp_path / "a.gif", duration=None, rate=rate, screen=SMALL)
    assert abs(movie.duration - 1 / frequency) <= 0.005 + 1e-12
    begins = np.concatenate(([0.0], np.cumsum(movie.delays)[:-1]))
    assert_allclose(movie.times * frequency, begins / movie.duration, atol=1e-12)
    assert_allclose(100 * movie.delays, np.rint(100 * movie.delays), atol=1e-9)
    assert movie.delays.min() >= 0.02 - 1e-12
    assert movie.rate <= rate + 1e-9


def test_files_of_one_stride(apart, tmp_path):
    movie = write_movie(apart, tmp_path / "stride.mp4", screen=SMALL)
    pictures, rate, duration = _read_mp4(movie.path)
    assert len(pictures) == len(movie.times) == round(60 / 0.93)
    assert_allclose(rate, movie.rate, atol=0.01)  # printed with two digits
    assert_allclose(duration, 1 / 0.93, atol=0.006)
    movie = write_movie(apart, tmp_path / "stride.gif", screen=SMALL)
    pictures, delays = _read_gif(movie.path)
    assert sum(delays) == 1080
    assert_allclose(delays, 1000 * movie.delays)
    apart_again = draw_frames(apart, [apart.period], SMALL)[0]
    assert np.abs(apart_again.astype(int) - pictures[0]).max() <= 1


def test_displays_that_never_repeat_need_a_duration(walker, tmp_path):
    for endless in (walker.translating(), walker.scramble_period(random_state=0), walker.limit_lifetime(3, 0.1)):
        with pytest.raises(ValueError, match=r"'anna' does not repeat itself .* give a duration in seconds"):
            write_movie(endless, tmp_path / "a.mp4")


# ---- what is refused


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("a.avi", {}, "the suffix of path must be one of '.mp4', '.gif', got '.avi'"),
        ("a.gif", {"rate": 60}, "a GIF has at most 50 frames per second, .* got rate=60; use rate=50, or an MP4"),
        ("a.gif", {"duration": 0.001}, "at least one frame, got 0.001 s"),
        ("a.mp4", {"duration": 0.001}, "at least one frame, got 0.001 s"),
        ("a.mp4", {"rate": 0}, "rate must be a number above 0, in frames per second, got 0"),
        ("a.mp4", {"duration": float("nan")}, "duration must be a number above 0, in seconds, got nan"),
        ("a.mp4", {"screen": Screen(size=(641, 480))}, r"must be even, got 641 x 480; use Screen\(size=\(642, 480\)\)"),
        ("a.mp4", {"screen": Screen(distance=0.05)}, "at least 1 pixel wide, .* got 0.81 from a diameter of 0.25"),
    ],
)
def test_bad_values_are_refused(walker, tmp_path, name, arguments, message):
    with pytest.raises(ValueError, match=message):
        write_movie(walker, tmp_path / name, **arguments)
    assert not list(tmp_path.iterdir())


def test_missing_folders_are_refused(walker, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no folder .*nowhere for the movie a.gif"):
        write_movie(walker, tmp_path / "nowhere" / "a.gif")


def test_without_imageio_ffmpeg_the_system_is_asked(monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    assert find_ffmpeg() == "/usr/bin/ffmpeg"


def test_without_any_ffmpeg(walker, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(ImportError, match=r"need ffmpeg: pip install 'eigenwalker\[movie\]'"):
        write_movie(walker, tmp_path / "a.mp4")
    write_movie(walker, tmp_path / "a.gif", duration=0.04)


def test_without_pillow(walker, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(ImportError, match=r"need Pillow: pip install 'eigenwalker\[movie\]'"):
        write_movie(walker, tmp_path / "a.gif")


def test_words_of_ffmpeg_are_passed_on(walker, tmp_path, monkeypatch):
    pictures = iter(draw_frames(walker, np.arange(50) / 60, SMALL))
    with pytest.raises(OSError, match=r"ffmpeg could not write .*nowhere/a.mp4: .*No such file or directory"):
        encode_mp4(pictures, tmp_path / "nowhere" / "a.mp4", rate=Fraction(60), size=SMALL.size)


def test_an_interrupted_movie_leaves_the_old_one(walker, tmp_path, monkeypatch):
    for name in ("a.mp4", "a.gif"):
        path = tmp_path / name
        path.write_bytes(b"old")

        def fail(*arguments, **options):
            yield np.zeros((240, 160), dtype=np.uint8)
            raise KeyboardInterrupt

        monkeypatch.setattr("eigenwalker.display.movie._pictures", fail)
        with pytest.raises(KeyboardInterrupt):
            write_movie(walker, path, screen=SMALL)
        assert path.read_bytes() == b"old"
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.gif", "a.mp4"]


# ---- in a browser

PLAY = """async (moment) => {
    const video = document.querySelector('video');
    video.muted = true;
    await video.play();
    await new Promise(resolve => video.onended = resolve);
    const time = video.currentTime;
    video.currentTime = moment;
    await new Promise(resolve => video.onseeked = resolve);
    const frame = document.createElement('canvas');
    frame.width = video.videoWidth;
    frame.height = video.videoHeight;
    const context = frame.getContext('2d');
    context.drawImage(video, 0, 0);
    const gray = [...context.getImageData(0, 0, frame.width, frame.height).data].filter((_, i) => i % 4 == 0);
    return {duration: video.duration, time, width: frame.width, height: frame.height, gray};
}"""


def test_a_movie_plays_in_chromium(browser, apart, tmp_path):
    """In its own size and to its end; and going back to a time shows the frame of that time."""
    movie = write_movie(apart, tmp_path / "walker.mp4", duration=1.5, screen=SMALL)
    page = browser.new_page()
    data = base64.b64encode(movie.path.read_bytes()).decode()
    page.set_content(f'<video src="data:video/mp4;base64,{data}"></video>')
    seen = page.evaluate(PLAY, 50.5 / 60)
    assert (seen["width"], seen["height"]) == SMALL.size
    assert_allclose([seen["duration"], seen["time"]], 1.5, atol=1e-3)
    shown = np.array(seen["gray"]).reshape(1, 240, 160)
    expected = _expected(apart, movie.times[50:51], SMALL)
    assert_allclose(_centroids(shown, expected, 8), expected, atol=0.3)
    page.close()


def test_a_gif_is_shown_in_chromium(browser, apart, tmp_path):
    movie = write_movie(apart, tmp_path / "walker.gif", duration=0.2, screen=SMALL)
    page = browser.new_page()
    data = base64.b64encode(movie.path.read_bytes()).decode()
    page.set_content(f'<img src="data:image/gif;base64,{data}">')
    page.evaluate("document.images[0].decode()")
    assert tuple(page.evaluate("['naturalWidth', 'naturalHeight'].map(side => document.images[0][side])")) == SMALL.size
    page.close()


def test_an_error_of_the_drawing_is_not_taken_for_one_of_ffmpeg(tmp_path):
    def pictures():
        yield np.full((32, 32), 16, dtype=np.uint8)
        raise OSError("the disk with the pictures is gone")

    with pytest.raises(OSError, match="the disk with the pictures is gone"):
        encode_mp4(pictures(), tmp_path / "broken.mp4", rate=Fraction(25), size=(32, 32))
