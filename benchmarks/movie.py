"""Movies of point lights: ``python -m benchmarks.movie [--short]``.

The same frames as MP4 and as GIF by this package and by matplotlib's FuncAnimation: as many, as large, with the same
dots. Linear algebra on one core; ffmpeg takes what it gets, in each row alike.
"""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib import rc_context
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image
from threadpoolctl import threadpool_limits

from benchmarks import _measure
from benchmarks._command import run
from benchmarks._findings import Check, Finding, Row
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table
from eigenwalker.datasets import make_walkers
from eigenwalker.display import PointLightDisplay, Screen, write_movie
from eigenwalker.display._ffmpeg import find_ffmpeg

_OURS = "eigenwalker"
_PEER = "FuncAnimation"
_BETWEEN = f"{_PEER}, between pixels"
_RATE = 50  # frames per second, which a GIF can show as well
_SCREEN = Screen()
_WANTED = {".mp4": 6, ".gif": 15}
_BOUNDS = {".mp4": 0.3, ".gif": 0.1}  # pixels

Array = NDArray[np.float64]


def findings(*, short: bool) -> list[Finding]:
    """Print a table for each kind of movie; return their rows, and whether a movie lasts as long as it says."""
    duration, n_rounds = (2.0, 3) if short else (5.0, 5)
    walker = PointLightDisplay.from_walk(make_walkers(1, random_state=0).data[0])
    masked = walker.add_mask(60, area=(2.0, 1.5), random_state=0)
    with threadpool_limits(1), TemporaryDirectory() as folder:
        print(describe_machine(("numpy", "matplotlib", "pillow", "imageio-ffmpeg")))
        found: list[Finding] = [
            _compare(walker, kind, Path(folder), duration, n_rounds, peer_alone=short) for kind in _WANTED
        ]
        if not short:
            found += [
                _compare(masked, kind, Path(folder), duration, n_rounds)._replace(wanted=None) for kind in _WANTED
            ]
            print(
                f"{_PEER} copies dots of one color to whole pixels; with a color for each they are between pixels, as "
                "ours are, and\nthe frames are the same: that row is the peer. With our encoding even the files are."
            )
        return [*found, _lasts(Path(folder, "ours.mp4"), duration)]


def _compare(
    display: PointLightDisplay, suffix: str, folder: Path, duration: float, n_rounds: int, *, peer_alone: bool = False
) -> Row:
    """Print the table of one kind of movie, with or without other ways to use the peer, and return its row."""
    files = {_OURS: folder / f"ours{suffix}"}
    calls: dict[str, Callable[[], object]] = {
        _OURS: lambda: write_movie(display, files[_OURS], duration=duration, rate=_RATE, screen=_SCREEN)
    }
    writers = _writers(suffix)
    for name, (writer, between) in writers.items() if not peer_alone else [(_BETWEEN, writers[_BETWEEN])]:
        files[name] = folder / f"{len(files)}{suffix}"
        calls[name] = lambda name=name, writer=writer, between=between: _animate(
            display, duration, files[name], writer(), between=between
        )
    seconds = _measure.interleaved({name: _measure.once(call) for name, call in calls.items()}, n_rounds)
    times = np.arange(round(duration * _RATE)) / _RATE
    centers = _centers(display, times)
    rows, pictures = [], {}
    for name, path in files.items():
        pictures[name] = _read(path)
        per_frame = f"{1e3 * np.median(seconds[name]) / len(times):.1f}"
        same = len(pictures[name]) == len(times)
        off = f"{_most_off(pictures[name], centers):.2f}" if same else "other frames"
        size = f"{path.stat().st_size / 1e3:.0f}"
        factor = f"{_measure.ratio(seconds, name, _OURS):.1f}"
        rows.append([name, per_frame, factor, f"{len(pictures[name])}", off, size])
    print_table(
        f"{suffix[1:].upper()} of {len(display.names)} dots, {len(times)} frames of {'{} x {}'.format(*_SCREEN.size)} "
        f"pixels, median of {n_rounds} rounds",
        ["", "ms a frame", "time / ours", "frames read back", "dots most off, px", "kB"],
        rows,
    )
    return _measure.beside(
        f"{suffix[1:].upper()} of {duration:g} s, {len(display.names)} dots, a movie",
        seconds,
        _OURS,
        _BETWEEN,
        wanted=_WANTED[suffix],
        error=_most_off(pictures[_OURS], centers),
        bound=_BOUNDS[suffix],
        unit="px",
        note="the error is that of the dots from where they belong",
    )


def _writers(suffix: str) -> dict[str, tuple[Callable[[], AbstractMovieWriter], bool]]:
    """Return writers, and whether they are given dots between pixels."""
    if suffix == ".gif":
        return {
            _PEER: (lambda: PillowWriter(fps=_RATE), False),
            _BETWEEN: (lambda: PillowWriter(fps=_RATE), True),
        }
    ours = ["-preset", "ultrafast", "-qp", "8", "-threads", "1", "-pix_fmt", "yuv420p"]
    return {
        _PEER: (lambda: FFMpegWriter(fps=_RATE), False),
        _BETWEEN: (lambda: FFMpegWriter(fps=_RATE), True),
        f"{_PEER}, between pixels, our encoding": (lambda: FFMpegWriter(fps=_RATE, extra_args=ours), True),
    }


def _animate(
    display: PointLightDisplay, duration: float, path: Path, writer: AbstractMovieWriter, *, between: bool
) -> None:
    """Write a display as a user of matplotlib would: one scatter whose offsets are set anew for each frame.

    Dots of one color are drawn once and copied to whole pixels, which makes them jump; a color for each puts them where
    they belong, `between` the pixels.
    """
    places = display.frames(duration, _RATE, unit="px", screen=_SCREEN)
    width, height = _SCREEN.size
    figure = Figure(figsize=(width / 100, height / 100), dpi=100, facecolor="black")
    ax = figure.add_axes((0, 0, 1, 1))
    ax.set_axis_off()
    ax.set(xlim=(-width / 2, width / 2), ylim=(-height / 2, height / 2))
    points = 0.72 * _SCREEN.pixels_across(display.dot_diameter)  # 72 of them are 100 pixels
    dots = ax.scatter(*places[0].T, s=points**2, c=["white"] * places.shape[1] if between else "white", linewidths=0)

    def update(frame: int):
        dots.set_offsets(places[frame])
        return [dots]

    animation = FuncAnimation(figure, update, frames=len(places), blit=True)
    with rc_context({"animation.ffmpeg_path": find_ffmpeg()}):
        animation.save(path, writer=writer, savefig_kwargs={"facecolor": "black"})


def _read(path: Path) -> NDArray[np.uint8]:
    """Return the pictures of a movie, shape (n_frames, height, width)."""
    if path.suffix == ".gif":
        with Image.open(path) as file:
            return np.array([_seek(file, frame) for frame in range(file.n_frames)])
    command = [find_ffmpeg(), "-v", "error", "-i", str(path), "-f", "rawvideo", "-pix_fmt", "gray", "-"]
    raw = subprocess.run(command, check=True, capture_output=True).stdout
    return np.frombuffer(raw, dtype=np.uint8).reshape(-1, *_SCREEN.size[::-1])


def _seek(file: Image.Image, frame: int) -> NDArray[np.uint8]:
    file.seek(frame)
    return np.array(file.convert("L"))


def _centers(display: PointLightDisplay, times: Array) -> Array:
    """Return columns and rows of the dots in pixels, shape (n_frames, n_dots, 2)."""
    tangents = np.tan(np.deg2rad(display.evaluate(times, unit="deg")))
    width, height = _SCREEN.size
    middle = np.array([width / 2 - 0.5, height / 2 - 0.5])
    return middle + tangents * _SCREEN.distance / _SCREEN.pixel_pitch * (1, -1)


def _most_off(pictures: NDArray[np.uint8], centers: Array, *, reach: int = 8) -> float:
    """Return how far the dots' centers of mass are from where they belong, the most of those that stand apart."""
    most = 0.0
    steps = np.arange(-reach, reach + 1)
    for picture, places in zip(pictures, centers, strict=True):
        gaps = np.linalg.norm(places[:, np.newaxis] - places, axis=2) + 1e9 * np.eye(len(places))
        inside = ((places > reach + 1) & (places < np.array(_SCREEN.size) - reach - 2)).all(axis=1)
        for column, row in places[(gaps.min(axis=1) > 3 * reach) & inside]:
            columns, rows = round(column) + steps, round(row) + steps
            spot = picture[np.ix_(rows, columns)].astype(float)
            found = spot.sum(axis=0) @ columns, spot.sum(axis=1) @ rows
            most = max(most, float(np.hypot(*(np.array(found) / spot.sum() - (column, row)))))
    return most


def _lasts(path: Path, duration: float) -> Check:
    """Return whether a movie lasts as long as it should, by its own account."""
    said = subprocess.run([find_ffmpeg(), "-i", str(path)], check=False, capture_output=True, text=True).stderr
    found = re.search(r"Duration: (\d+):(\d+):([\d.]+)", said)
    seconds = sum(float(part) * unit for part, unit in zip(found.groups(), (3600, 60, 1), strict=True)) if found else 0
    return Check(f"an MP4 of {duration:g} s lasts as long", f"{seconds:g} s", abs(seconds - duration) < 0.011)


if __name__ == "__main__":
    run(findings, __doc__, short="two seconds instead of five, and fewer rounds")
