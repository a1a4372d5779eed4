import base64
import json
from dataclasses import replace

import numpy as np
import pytest

from eigenwalker._validation import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.display import PointLightDisplay
from eigenwalker.experiment.running.page_contents import page_contents
from eigenwalker.experiment.running.shown_motion import shown_motion
from eigenwalker.experiment.stimulus import Stimulus, cross_stimuli
from eigenwalker.experiment.study import make_study
from eigenwalker.experiment.tasks import PairTask, RatingTask
from eigenwalker.motion.fourier import evaluate_harmonics

WALKS = make_walkers(5, random_state=0).data


def numbers(text, kind):
    return np.frombuffer(base64.b64decode(text), dtype=kind)


def test_walkers_of_a_rating_are_the_point_lights_of_the_package():
    contents = page_contents(make_study(RatingTask(), walks=WALKS, n_participants=1))
    space = contents["space"]
    vectors = numbers(space["center"], "<f8") + numbers(space["basis"], "<f8").reshape(5, -1)
    for walk, vector in zip(WALKS, vectors, strict=True):
        said = contents["stimuli"][walk.name]
        display = PointLightDisplay.from_walk(walk)
        assert said["height"] == pytest.approx(display.height, rel=1e-12)
        coefficients = vector[: 9 * 45].reshape(9, 45)  # mean, sin1, cos1, ... of 15 markers
        times = np.array([0.0, 0.31, 2.7])
        shown = evaluate_harmonics(coefficients, vector[9 * 45], times).reshape(3, 15, 3) - said["middle"]
        expected = display.dots.evaluate(times, np.eye(3), 0.0)
        np.testing.assert_allclose(shown, expected, atol=1e-9)  # metres


def test_walks_that_are_shown_frame_by_frame_are_there_once():
    walks = cross_stimuli({"sad": WALKS[0]}, {"sad": WALKS[1]}, average=WALKS[2])
    contents = page_contents(make_study(PairTask(), walks=walks, n_participants=1))
    assert len(contents["motions"]) == 3
    assert contents["space"] is None
    for stimulus in walks:
        said = contents["stimuli"][stimulus.name]
        motion = contents["motions"][said["motion"]]
        shown = shown_motion(stimulus.walk)
        assert said["displacement"] == (stimulus.condition == "displacement")
        positions = numbers(motion["positions"], "<f4").reshape(shown.positions.shape)
        np.testing.assert_allclose(positions, shown.positions, atol=1e-6)  # float32
        np.testing.assert_allclose(numbers(motion["path"], "<f4").reshape(-1, 2), shown.path, atol=1e-6)


def test_a_walk_of_unknown_speed_is_shown_in_place_only():
    unknown = replace(WALKS[0], speed=float("nan"))
    walks = cross_stimuli({"sad": unknown}, {"sad": WALKS[1]})
    with pytest.raises(WalkError, match=r"sad_original_displacement: .* its speed must be known"):
        page_contents(make_study(PairTask(), walks=walks, n_participants=1))
    still = cross_stimuli({"sad": unknown}, {"sad": WALKS[1]}, conditions=["static"])
    contents = page_contents(make_study(PairTask(), walks=still, n_participants=1))
    assert np.isfinite(numbers(contents["motions"]["motion1"]["path"], "<f4")).all()


def test_all_walks_that_cannot_be_shown_are_named():
    holes = np.array(WALKS[0].positions)
    holes[3] = np.nan
    bad = [replace(WALKS[0], positions=holes, name=name) for name in ("anna", "berta")]
    with pytest.raises(WalkError, match=r"(?s)'anna': .*'berta': "):
        page_contents(make_study(RatingTask(), walks=[*bad, WALKS[1]], n_participants=1))


def test_movies_have_plain_names_beside_the_page():
    walks = [Stimulus("a b<c>", movie="x y.mp4"), Stimulus("made", movie="z.mp4", reference="a b<c>")]
    contents = page_contents(make_study(PairTask(), walks=walks, n_participants=1))
    assert contents["stimuli"]["a b<c>"] == {"source": "movie", "file": "stimuli/stimulus_001.mp4"}


def test_contents_are_json_without_nan():
    walks = cross_stimuli({"sad": WALKS[0]}, {"sad": WALKS[1]})
    study = make_study([RatingTask(), PairTask()], walks=[*walks, WALKS[3]], n_participants=2, consent="I agree")
    contents = json.loads(json.dumps(page_contents(study), allow_nan=False))
    assert contents["calibrate"] is True
    assert contents["study"] == study.id
    assert {task["task"]: task["buttons_at"] for task in contents["tasks"]} == {"rating": "top", "pair": "bottom"}
