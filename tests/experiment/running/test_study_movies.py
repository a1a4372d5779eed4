"""Stimuli become movies as tasks show them: harmonics or frames, dots or sticks, in place or on their way."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker._validation import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.display import PointLightDisplay, Screen
from eigenwalker.display.figures import FigureDisplay
from eigenwalker.experiment.running import study_movies
from eigenwalker.experiment.running.shown_motion import shown_motion
from eigenwalker.experiment.running.study_movies import Shown, write_stimuli
from eigenwalker.experiment.showing import Showing
from eigenwalker.experiment.stimulus import Stimulus

pytest.importorskip("imageio_ffmpeg")

SMALL = Screen(size=(160, 240))
LIGHTS = Showing(figure="dots", height=5.0, duration=0.4)
STICKS = Showing(duration=0.4)


@pytest.fixture(scope="module")
def walks():
    return [replace(walk, speed=1.3) for walk in make_walkers(2, random_state=0).data]


@pytest.fixture
def written(monkeypatch):
    """Return the jobs that come to be written, which are not."""
    jobs = []
    monkeypatch.setattr(study_movies, "_write", jobs.append)
    return jobs


def _write(folder, *shown, **options):
    wanted = [(folder / f"{number}.mp4", one) for number, one in enumerate(shown)]
    return write_stimuli(wanted, **{"rate": 50.0, "screen": SMALL} | options)


def test_harmonics_in_degrees_are_point_lights(walks, written, tmp_path):
    assert _write(tmp_path, Shown(Stimulus("a", walks[0]), 30.0, LIGHTS)) == [0.4]
    (job,) = written
    expected = PointLightDisplay.from_walk(walks[0]).seen_from(30).sized(height=5).with_dots(0.25)
    times = np.arange(9) / 11
    assert_allclose(
        job.display.evaluate(times, unit="px", screen=SMALL), expected.evaluate(times, unit="px", screen=SMALL)
    )
    assert (job.display.dot_diameter, job.duration, job.rate) == (0.25, 0.4, 50.0)


def test_harmonics_as_sticks_are_where_the_lights_are(walks, written, tmp_path):
    lengths = _write(tmp_path, Shown(Stimulus("a", walks[0]), 30.0, Showing()))
    lights = PointLightDisplay.from_walk(walks[0]).seen_from(30)
    assert_allclose(lengths, 10 * lights.period)
    (job,) = written
    assert isinstance(job.display, FigureDisplay)
    times = np.arange(40) / 50
    assert_allclose(job.display.evaluate(times), lights.evaluate(times), atol=1e-12)
    assert job.display.body_height == lights.height


def test_frames_are_shown_as_they_are_in_place_and_on_their_way(walks, written, tmp_path):
    motion = shown_motion(walks[0])
    static, moving = (Stimulus(name, walks[0], condition=name) for name in ("static", "displacement"))
    showing = Showing(figure="dots", height=4.0, dot_diameter=0.5)
    lengths = _write(tmp_path, *(Shown(one, 90.0, showing) for one in (static, moving)))
    assert_allclose(lengths, walks[0].duration)
    held, going = (job.display for job in written)
    assert_allclose(held.positions, motion.positions)
    assert_allclose(going.positions[..., :2] - motion.positions[..., :2], motion.path[:, np.newaxis].repeat(15, axis=1))
    assert_allclose(going.positions[..., 2], motion.positions[..., 2])
    assert going.positions[-1, 0, 0] - going.positions[0, 0, 0] > 1
    assert (held.height, held.figure, held.dot_diameter) == (4.0, "dots", 0.5)


def test_an_original_and_what_refers_to_it_have_one_scale(walks, written, tmp_path):
    tall = replace(walks[1], positions=1.3 * walks[1].positions)
    original = Stimulus("o", walks[0], condition="static")
    made = Stimulus("s", tall, condition="static", reference="o")
    other = Stimulus("x", walks[0], condition="static")
    views = [(original, 30.0), (made, 30.0), (other, 30.0), (original, 90.0)]
    _write(tmp_path, *(Shown(stimulus, view, STICKS) for stimulus, view in views))
    scales = [job.scale for job in written]
    own = [job.display.pixels_per_meter(SMALL) for job in written]
    assert scales[0] == scales[1] == min(own[:2])
    assert scales[2] == own[2] > scales[0]
    assert scales[3] == own[3]


def test_movies_are_written_and_copied(walks, tmp_path):
    (tmp_path / "given.mp4").write_bytes(b"movie")
    lengths = _write(
        tmp_path,
        Shown(Stimulus("a", walks[0]), 0.0, LIGHTS),
        Shown(Stimulus("b", walks[0], condition="static"), 0.0, STICKS),
        Shown(Stimulus("c", movie=tmp_path / "given.mp4"), 0.0, STICKS),
        Shown(Stimulus("c", movie=tmp_path / "given.mp4"), 0.0, Showing()),
        n_jobs=1,
    )
    assert_allclose(lengths, [0.4, 0.4, 0.4, np.nan])
    assert (tmp_path / "2.mp4").read_bytes() == b"movie"
    assert b"ftyp" in (tmp_path / "0.mp4").read_bytes()[:12]
    assert {path.name for path in tmp_path.iterdir()} == {"given.mp4", "0.mp4", "1.mp4", "2.mp4", "3.mp4"}


def test_what_cannot_be_shown_is_named_before_anything_is_written(walks, tmp_path):
    torn = replace(walks[0], positions=np.where(walks[0].positions > 1.5, np.nan, walks[0].positions))
    with pytest.raises(WalkError, match=r"(?s)2 of 3 stimuli were refused.*bad: .*finite.*none: expected a walk or"):
        _write(
            tmp_path,
            Shown(Stimulus("good", walks[0]), 0.0, LIGHTS),
            Shown(Stimulus("bad", torn, condition="static"), 0.0, STICKS),
            Shown(Stimulus("none"), 0.0, STICKS),
        )
    with pytest.raises(WalkError, match=r"(?s)1 of 1 movies were refused.*gone: .*gone\.mp4"):
        _write(tmp_path, Shown(Stimulus("gone", movie=tmp_path / "gone.mp4"), 0.0, STICKS))
    assert not list(tmp_path.iterdir())


def test_what_makes_another_movie():
    one = Shown(Stimulus("a"), 0.0, STICKS)
    assert one.look == one._replace(showing=replace(STICKS, blank=2.0, answer="after", self_paced=False)).look
    for changes in ({"figure": "dots"}, {"height": 5.0}, {"duration": 1.0}, {"dot_diameter": 0.3}):
        assert one.look != one._replace(showing=replace(STICKS, **changes)).look
