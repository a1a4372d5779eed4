import numpy as np
import pandas as pd
import pytest

from eigenwalker.experiment.answer_columns import DESIGN_COLUMNS
from eigenwalker.experiment.design import cyclic_square, make_design
from eigenwalker.experiment.design_table import design_from_values, design_values
from eigenwalker.experiment.stimulus import Stimulus
from eigenwalker.experiment.tasks import (
    NaturalnessTask,
    PairTask,
    RatingTask,
    RecognitionTask,
    ResemblanceTask,
)

WALKERS = [Stimulus(f"walker{number}") for number in range(80)]
STYLES = [f"style{number}" for number in range(11)]
CROSSED = [
    Stimulus(
        f"{style}_{kind}_{condition}",
        style=style,
        kind=kind,
        condition=condition,
        reference=f"{style}_original_{condition}" if kind == "synthetic" else "",
    )
    for style in STYLES
    for kind in ("original", "synthetic")
    for condition in ("static", "displacement")
] + [
    Stimulus(f"average_{condition}", style="average walk", kind="synthetic", condition=condition)
    for condition in ("static", "displacement")
]


@pytest.fixture(scope="module")
def moods():
    """Return the design of Troje 2002, section 4: six observers, two label groups, three sessions of 80 trials."""
    return make_design([RatingTask(("sad", "happy")), RatingTask(("relaxed", "nervous"))], WALKERS, n_participants=6)


def test_the_papers_ratings_have_80_trials_a_session_and_3_sessions(moods):
    assert len(moods) == 6 * 3 * 80
    sessions = moods.groupby(["participant", "session"])
    assert (sessions.size() == 80).all()
    assert (sessions["stimulus"].nunique() == 80).all()  # every walker once
    assert (sessions["view"].nunique() == 1).all()
    assert moods.groupby("trait")["participant"].nunique().to_dict() == {"happy": 3, "nervous": 3}


def test_viewpoints_form_a_latin_square_in_each_label_group(moods):
    for _, group in moods.groupby("trait"):
        orders = group.groupby("participant")["view"].unique()
        square = np.array(orders.tolist())  # (n_participants, n_sessions)
        assert all(sorted(row) == [0, 30, 90] for row in square)
        assert all(sorted(column) == [0, 30, 90] for column in square.T)


def test_the_second_pole_stands_left_as_in_the_paper(moods):
    assert moods.groupby("trait")["left"].unique().map(list).to_dict() == {"happy": ["happy"], "nervous": ["nervous"]}


def test_sides_of_poles_alternate_within_a_group():
    tasks = [RatingTask(left="alternate"), RatingTask(("relaxed", "nervous"), left="first")]
    lefts = make_design(tasks, WALKERS[:3], n_participants=6).groupby("participant")["left"].first().tolist()
    assert lefts == ["happy", "relaxed", "sad", "relaxed", "happy", "relaxed"]


def test_orders_are_random_and_differ_between_sessions_and_participants(moods):
    orders = moods.groupby(["participant", "session"])["stimulus"].agg(tuple)
    assert orders.nunique() == len(orders)


def test_more_participants_leave_the_first_ones_as_they_are():
    tasks = [RatingTask(), PairTask(), ResemblanceTask()]
    few = make_design(tasks, CROSSED, n_participants=2, seed=5)
    many = make_design(tasks, CROSSED, n_participants=9, seed=5)
    pd.testing.assert_frame_equal(few, many[many["participant"] <= 2])


def test_one_seed_gives_one_design():
    same = [make_design([NaturalnessTask()], CROSSED, n_participants=3, seed=1) for _ in range(2)]
    pd.testing.assert_frame_equal(*same)
    assert not make_design([NaturalnessTask()], CROSSED, n_participants=3, seed=2).equals(same[0])


def test_the_three_tests_draw_ten_of_44_and_2():
    styles = RecognitionTask(tuple(STYLES))
    design = make_design([NaturalnessTask(), styles, ResemblanceTask()], CROSSED, n_participants=50)
    assert len(CROSSED) == 46
    sessions = design.groupby(["participant", "session"])
    assert (sessions.size() == 10).all()
    assert (sessions["stimulus"].nunique() == 10).all()
    assert design.groupby("session")["task"].unique().map(list).tolist() == [
        ["naturalness"],
        ["recognition"],
        ["resemblance"],
    ]
    assert design[design["task"] == "naturalness"]["stimulus"].nunique() == 46
    assert design[design["task"] == "resemblance"]["stimulus"].nunique() == 22


def test_both_walks_of_a_pair_share_style_and_condition():
    design = make_design([ResemblanceTask(n_trials=22)], CROSSED, n_participants=20)
    words = design["stimulus"].str.replace("synthetic", "original")
    assert (words == design["reference"]).all()
    assert (design["kind"] == "synthetic").all()
    left = design["left"] == design["reference"]
    assert ((design["left"] == design["stimulus"]) | left).all()
    assert 0.4 < left.mean() < 0.6  # 440 draws: 4 standard errors are 0.1


def test_the_reference_of_a_pair_task_stands_left_unless_it_is_drawn():
    design = make_design([PairTask()], CROSSED, n_participants=2)
    assert (design["left"] == design["reference"]).all()
    right = make_design([PairTask(reference="right")], CROSSED, n_participants=2)
    assert (right["left"] == right["stimulus"]).all()


def test_three_series_of_15_are_cut_short_where_pairs_are_few():
    sizes = make_design([PairTask()], CROSSED, n_participants=1).groupby("session").size()
    assert sizes.tolist() == [15, 7]
    many = [Stimulus("real")] + [Stimulus(f"made{number}", reference="real") for number in range(67)]
    assert make_design([PairTask()], many, n_participants=1).groupby("session").size().tolist() == [15, 15, 15]


def test_balanced_draws_show_everything_equally_often():
    design = make_design([NaturalnessTask(draw="balanced")], CROSSED, n_participants=23)
    assert np.ptp(design["stimulus"].value_counts()) == 0  # 230 trials of 46 stimuli


def test_attention_trials_are_among_the_others_but_not_first_and_ask_for_an_answer():
    task = RatingTask(n_attention=4, n_practice=2)
    design = make_design([task], WALKERS[:5], n_participants=8, seed=3)
    asked = design[design["part"] == "attention"]
    assert (
        design.groupby(["participant", "session"])["part"].agg(list).map(lambda parts: parts.count("attention")) == 4
    ).all()
    assert set(asked["expected"]) <= {button.answer for button in task.buttons}
    assert not (asked["trial"] == 1).any()
    practice = design[design["part"] == "practice"]
    assert (practice["session"] == 1).all()
    assert sorted(set(practice["trial"])) == [1, 2]
    mains = design[design["part"] == "main"]
    assert (mains.groupby(["participant", "session"])["stimulus"].nunique() == 5).all()
    assert (design["expected"] == "").eq(design["part"] != "attention").all()


def test_more_practice_than_walkers_goes_round_again():
    design = make_design([RatingTask(n_practice=7)], WALKERS[:3], n_participants=1)
    counts = design[design["part"] == "practice"]["stimulus"].value_counts()
    assert counts.sum() == 7
    assert np.ptp(counts) <= 1


def test_columns_and_kinds_are_those_of_the_table_and_survive_json(moods):
    assert list(moods) == list(DESIGN_COLUMNS)
    assert {name: moods[name].dtype.kind for name in moods} == {
        name: {"int": "i", "float": "f", "str": "O"}[column.kind] for name, column in DESIGN_COLUMNS.items()
    }
    pd.testing.assert_frame_equal(design_from_values(design_values(moods)), moods)


def test_pairs_without_references_are_refused():
    with pytest.raises(ValueError, match="pair task needs synthetic walks that refer to their originals"):
        make_design([PairTask()], WALKERS, n_participants=1)


def test_a_cyclic_square_goes_round():
    assert cyclic_square("abc", 5) == [list("abc"), list("bca"), list("cab"), list("abc"), list("bca")]
