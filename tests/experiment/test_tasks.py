import pytest

from eigenwalker.experiment.showing import Showing
from eigenwalker.experiment.study_words import task_from_words, task_words
from eigenwalker.experiment.tasks import (
    NaturalnessTask,
    PairTask,
    RatingTask,
    RecognitionTask,
    ResemblanceTask,
)

ALL = [
    RatingTask(("relaxed", "nervous"), left="alternate", n_practice=2),
    PairTask(draw="balanced"),
    NaturalnessTask(showing=Showing(figure="dots", height=4.0)),
    RecognitionTask(("sad", "cool")),
    ResemblanceTask(n_attention=1),
]


def test_ratings_are_those_of_troje():
    task = RatingTask()
    assert [(button.text, button.answer, button.value) for button in task.buttons] == [
        ("sad", "1", 1.0),
        ("", "2", 2.0),
        ("", "3", 3.0),
        ("", "4", 4.0),
        ("", "5", 5.0),
        ("happy", "6", 6.0),
    ]
    showing = task.showing
    assert (showing.figure, showing.height, showing.duration, showing.blank) == ("dots", 5.0, 7.0, 3.0)
    assert not showing.self_paced
    assert task.views == (0.0, 30.0, 90.0)
    assert task.trait == "happy"


def test_pairs_are_those_of_tilmanne_and_dutoit():
    task = PairTask()
    assert (task.n_series, task.n_trials) == (3, 15)
    assert [button.value for button in task.buttons] == [0, 1, 2, 3, 4]
    assert task.buttons[0].text == "0 not realistic"
    assert task.buttons[4].text == "4 as natural as the original"
    assert task.showing.self_paced


def test_recognition_adds_the_average_walk_and_not_knowing():
    styles = [f"style{number}" for number in range(11)]
    buttons = RecognitionTask(styles).buttons
    assert len(buttons) == 13
    assert [button.answer for button in buttons[-2:]] == ["average walk", "don't know"]


def test_resemblance_is_worth_four_to_zero():
    assert {button.answer: button.value for button in ResemblanceTask().buttons} == {
        "identical": 4,
        "slightly different": 3,
        "different": 2,
        "very different": 1,
        "nothing in common": 0,
    }


def test_naturalness_has_three_answers():
    assert [button.answer for button in NaturalnessTask().buttons] == ["real", "synthetic", "don't know"]


@pytest.mark.parametrize("task", ALL, ids=lambda task: task.name)
def test_tasks_survive_json(task):
    assert task_from_words(task_words(task)) == task


@pytest.mark.parametrize("task", ALL, ids=lambda task: task.name)
def test_answers_of_a_task_differ(task):
    answers = [button.answer for button in task.buttons]
    assert len(set(answers)) == len(answers)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: RatingTask(("sad", "sad")), "poles must differ"),
        (lambda: RatingTask(("sad", "so-so", "happy")), "poles must be two words"),
        (lambda: RatingTask("sad"), "poles must be a sequence"),
        (lambda: RatingTask(("sad", "hap\r\npy")), "poles must be without line breaks"),
        (lambda: RecognitionTask(("a\x0bb",)), "styles must be without line breaks"),
        (lambda: RatingTask(n_buttons=1), "n_buttons must be a number of at least 2"),
        (lambda: RatingTask(views=()), "views must be a sequence of one viewpoint or more"),
        (lambda: RatingTask(views=(0, "frontal")), "views must differ"),
        (lambda: RatingTask(left="right"), "left must be one of"),
        (lambda: RatingTask(showing=Showing(self_paced=False)), "showing.duration must be given"),
        (lambda: PairTask(n_trials=0), "n_trials must be a number of at least 1"),
        (lambda: PairTask(scale="01234"), "scale must be a sequence"),
        (lambda: PairTask(reference="middle"), "reference must be one of"),
        (lambda: RecognitionTask(("sad", "average walk")), "without those that are always there, got average walk"),
        (lambda: NaturalnessTask(draw="some"), "draw must be one of"),
        (lambda: ResemblanceTask(n_attention=-1), "n_attention must be a number of at least 0"),
        (lambda: Showing(figure="mesh"), "figure must be one of"),
        (lambda: Showing(height=0), "height must be a number above 0"),
        (lambda: Showing(blank=-1), "blank must be a number of at least 0"),
        (lambda: task_from_words({"task": "taste"}), "task must be one of rating, pair"),
    ],
)
def test_what_is_wrong_is_said(make, match):
    with pytest.raises((ValueError, TypeError), match=match):
        make()
