import json
from dataclasses import replace

import numpy as np
import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.stimulus import Stimulus, cross_stimuli
from eigenwalker.experiment.study import Study, make_study
from eigenwalker.experiment.tasks import NaturalnessTask, PairTask, RatingTask, RecognitionTask

WALKS = make_walkers(6, random_state=0).data
CROSSED = cross_stimuli({"sad": WALKS[0], "cool": WALKS[1]}, {"sad": WALKS[2], "cool": WALKS[3]}, average=WALKS[4])


def study(**changes):
    settings = {"walks": CROSSED, "n_participants": 2, "random_state": 0}
    return make_study([NaturalnessTask(), PairTask()], **{**settings, **changes})


def test_one_seed_gives_one_study_and_everything_else_another():
    first = study()
    assert study().id == first.id
    assert len(first.id) == 12
    others = [
        study(random_state=1),
        study(n_participants=3),
        study(walks=CROSSED[:8]),
        study(title="x"),
        study(consent="x"),
    ]
    assert len({first.id, *(other.id for other in others)}) == 6


def test_recognition_offers_the_styles_that_are_shown():
    made = make_study(RecognitionTask(), walks=CROSSED, n_participants=1)
    assert made.tasks[0].styles == ("cool", "sad")
    wide = make_study(RecognitionTask(("cool", "manly", "sad")), walks=CROSSED, n_participants=1)
    assert wide.tasks[0].styles == ("cool", "manly", "sad")


def test_tasks_are_found_by_name_and_trait():
    made = make_study([RatingTask(), RatingTask(("relaxed", "nervous"))], walks=WALKS, n_participants=2)
    assert made.task_of("rating", "nervous").poles == ("relaxed", "nervous")
    with pytest.raises(ValueError, match="no task 'pair'"):
        made.task_of("pair")


def test_words_of_a_study_are_json_and_know_no_walks():
    words = json.loads(json.dumps(study().words()))
    assert words["stimuli"][0] == {
        "name": "sad_original_static",
        "style": "sad",
        "kind": "original",
        "condition": "static",
        "reference": "",
    }


def test_a_study_says_what_it_is():
    made = study()
    assert repr(made).startswith(f"<Study {made.id}: naturalness, pair; 10 stimuli, 2 participants")
    assert isinstance(made, Study)


@pytest.mark.parametrize(
    ("tasks", "settings", "match"),
    [
        ([], {}, "at least one task"),
        ("rating", {}, "expected tasks such as RatingTask"),
        ([PairTask(), PairTask(n_series=1)], {}, "repeated: pair"),
        ([RatingTask(), RatingTask(n_buttons=7)], {}, "repeated: rating of happy"),
        (RatingTask(), {"n_participants": 0}, "n_participants must be a number of at least 1"),
        ([RatingTask(), RatingTask(("a", "b"))], {"n_participants": 1}, "at least 2, one for each rating task"),
        (RecognitionTask(), {"walks": WALKS}, "needs the style of each stimulus, missing of: walker_000"),
        (RecognitionTask(("sad",)), {}, "missing: cool"),
        (RatingTask(), {"walks": [replace(WALKS[0], name="")]}, "non-empty"),
        (RatingTask(), {"walks": []}, "at least one walk"),
        (RatingTask(), {"walks": [np.zeros(3)]}, "expected a list of Walk or JointWalk or Stimulus"),
        (PairTask(), {"walks": [Stimulus("a")]}, "refer to their originals"),
    ],
)
def test_what_is_wrong_is_said(tasks, settings, match):
    with pytest.raises((ValueError, TypeError), match=match):
        make_study(tasks, **{"walks": CROSSED, "n_participants": 2, **settings})
