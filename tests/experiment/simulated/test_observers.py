import numpy as np
import pandas as pd
import pytest
from joblib import parallel_config
from numpy.testing import assert_allclose, assert_array_equal

from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS
from eigenwalker.experiment.answers.files import read_answers, write_answers
from eigenwalker.experiment.simulated.observers import simulate_answers
from eigenwalker.experiment.simulated.studies import simulate_studies
from eigenwalker.experiment.stimulus import Stimulus, cross_stimuli
from eigenwalker.experiment.study import make_study
from eigenwalker.experiment.tasks import (
    DONT_KNOW,
    NaturalnessTask,
    PairTask,
    RatingTask,
    RecognitionTask,
    ResemblanceTask,
    Showing,
)

WALKS = make_walkers(12, duration=3, frame_rate=60, random_state=0).data
NAMES = [walk.name for walk in WALKS]
HAPPY = pd.Series(np.linspace(-3, 3, len(WALKS)), NAMES)
CROSSED = cross_stimuli(
    dict(zip("abcde", WALKS[:5], strict=True)), dict(zip("abcde", WALKS[5:10], strict=True)), average=WALKS[10]
)
TESTS = [PairTask(reference="random"), NaturalnessTask(), RecognitionTask(), ResemblanceTask()]
ALIKE = {"noise": 0.0, "taste": 0.0, "bias": 0.0, "gain": 0.0}


def ratings(n_participants=3, *, walks=WALKS, n_buttons=6, **task):
    return make_study(
        RatingTask(n_buttons=n_buttons, **task), walks=walks, n_participants=n_participants, random_state=0
    )


def judgments(n_participants=4, **task):
    tasks = [type(one)(n_attention=2, n_practice=2, **task) for one in TESTS]
    return make_study(tasks, walks=CROSSED, n_participants=n_participants, random_state=0)


def without(answers, *columns):
    return answers.drop(columns=list(columns)).reset_index(drop=True)


# ---- the table


@pytest.mark.parametrize("study", [ratings(n_practice=2, n_attention=2), judgments()], ids=["ratings", "tests"])
def test_answers_are_those_that_a_file_gives_back(study, tmp_path):
    answers = simulate_answers(study, random_state=0)
    assert list(answers.columns) == list(ANSWER_COLUMNS)
    assert len(answers) == len(study.design)
    assert (answers["study"] == study.id).all()
    write_answers(answers, tmp_path, study=study)
    pd.testing.assert_frame_equal(read_answers(tmp_path, study=study), answers)


def test_one_seed_gives_the_same_answers_and_another_one_others():
    study = judgments()
    first = simulate_answers(study, random_state=0)
    pd.testing.assert_frame_equal(simulate_answers(study, random_state=0), first)
    assert (simulate_answers(study, random_state=1)["answer"] != first["answer"]).any()


@pytest.mark.parametrize("make", [ratings, judgments], ids=["ratings", "tests"])
def test_more_participants_leave_the_answers_of_the_first_ones_as_they_are(make):
    few, many = (without(simulate_answers(make(number), random_state=0), "study") for number in (3, 7))
    pd.testing.assert_frame_equal(many[many["participant"] <= 3], few)


def test_some_participants_answer_as_if_all_did():
    study = judgments()
    answers = simulate_answers(study, random_state=0)
    some = simulate_answers(study, random_state=0, participants=[2, 4])
    pd.testing.assert_frame_equal(some, answers[answers["participant"].isin([2, 4])].reset_index(drop=True))


def test_neither_lapses_nor_missing_answers_change_the_others():
    study = judgments(20)
    sound = simulate_answers(study, random_state=0)
    careless = simulate_answers(study, random_state=0, lapse=0.3)
    same = careless["answer"] == sound["answer"]
    assert 0.7 < same.mean() < 0.85  # of 30 % of random presses some hit the same button
    key = ["participant", "session", "trial"]
    gappy = simulate_answers(study, random_state=0, missing=0.2)
    assert 0.15 < 1 - len(gappy) / len(sound) < 0.25
    pd.testing.assert_frame_equal(gappy, gappy[key].merge(sound, on=key)[list(gappy.columns)])


def test_attention_trials_are_heeded_but_for_lapses():
    study = judgments(30)
    answers = simulate_answers(study, random_state=0)
    asked = answers[answers["part"] == "attention"]
    assert len(asked) > 200
    assert (asked["answer"] == asked["expected"]).all()
    asleep = simulate_answers(study, random_state=0, lapse=1.0)
    asked = asleep[asleep["part"] == "attention"]
    chance = sum(1 / len(task.buttons) for task in study.tasks) / len(study.tasks)
    heeded = (asked["answer"] == asked["expected"]).mean()
    assert abs(heeded - chance) < 4 * np.sqrt(chance / len(asked))  # four standard errors


# ---- ratings


@pytest.mark.parametrize("n_buttons", [2, 5, 6, 10])
def test_observers_without_noise_press_even_steps_of_the_trait(n_buttons):
    answers = simulate_answers(ratings(n_buttons=n_buttons), truth=HAPPY, **ALIKE)
    edges = np.linspace(-3, 3, n_buttons + 1)[1:-1]
    wanted = 1 + np.searchsorted(edges, HAPPY[answers["stimulus"]].to_numpy())
    assert_array_equal(answers["value"], wanted)
    assert_array_equal(answers["answer"], wanted.astype(str))


def test_six_buttons_change_at_whole_standard_deviations():
    truth = pd.Series([-2.5, -1.5, -0.5, 0.5, 1.5, 2.5] * 2, NAMES)
    answers = simulate_answers(ratings(), truth=truth, **ALIKE)
    assert answers.groupby("stimulus")["value"].first()[NAMES].tolist() == [1, 2, 3, 4, 5, 6] * 2


def test_which_pole_stands_on_the_left_changes_nothing():
    first, second = (simulate_answers(ratings(left=left), truth=HAPPY, random_state=0) for left in ("first", "second"))
    pd.testing.assert_frame_equal(without(first, "study", "left"), without(second, "study", "left"))


def test_spreads_of_what_observers_see_are_those_that_were_asked_for():
    # With 100 buttons a rating is what is seen, in steps of 0.06; of 200 observers of twelve walkers in three views.
    study = ratings(200, n_buttons=100)
    spreads = {"noise": 0.4, "taste": 0.3, "bias": 0.2, "gain": 0.0}
    answers = simulate_answers(study, truth=0.0, random_state=0, **spreads)
    seen = (answers["value"] - 50.5) * 0.06
    by_walker = seen.groupby([answers["participant"], answers["stimulus"]])
    assert_allclose(np.sqrt(by_walker.var().mean()), 0.4, rtol=0.05)
    means = by_walker.mean().unstack()
    assert_allclose(means.var(axis=1).mean(), 0.3**2 + 0.4**2 / 3, rtol=0.1)
    assert_allclose(means.mean(axis=1).var(), 0.2**2 + (0.3**2 + 0.4**2 / 3) / 12, rtol=0.25)
    gains = simulate_answers(study, truth=HAPPY / 2, random_state=0, **{**ALIKE, "gain": 0.2})
    spans = gains.groupby("participant")["value"].agg(lambda values: values.max() - values.min()) * 0.06 / 3
    assert_allclose(np.log(spans).std(), 0.2, rtol=0.15)


def test_label_groups_rate_their_own_trait():
    tasks = [RatingTask(("sad", "happy")), RatingTask(("relaxed", "nervous"))]
    study = make_study(tasks, walks=WALKS, n_participants=6, random_state=0)
    truth = pd.DataFrame({"happy": HAPPY, "nervous": -HAPPY, "weight": 70.0})
    answers = simulate_answers(study, truth=truth, random_state=0)
    seen = answers.groupby(["trait", "stimulus"])["value"].mean().unstack(0).loc[NAMES]
    assert seen["happy"].corr(HAPPY) > 0.9
    assert seen["nervous"].corr(HAPPY) < -0.9


def test_without_a_truth_walkers_do_not_differ():
    answers = simulate_answers(ratings(300), random_state=0)
    means = answers.groupby("stimulus")["value"].mean()
    # Means of 900 ratings, three of each observer: standard errors of sqrt(taste^2 / 300 + noise^2 / 900) of a step
    assert means.std() < 2 * np.sqrt(0.5**2 / 300 + (1 + 1 / 12) / 900)
    assert_allclose(means.mean(), 3.5, atol=4 * 0.5 / np.sqrt(300))


# ---- other answers


def test_the_papers_figures_come_back():
    styles = "abcdefghijk"
    originals, synthetics = (dict(zip(styles, [WALKS[at]] * 11, strict=True)) for at in (0, 1))
    stimuli = cross_stimuli(originals, synthetics)
    study = make_study(TESTS, walks=stimuli, n_participants=600, random_state=0)
    answers = simulate_answers(study, random_state=0)
    main = answers[answers["part"] == "main"]
    said = main[main["task"] == "naturalness"].groupby("kind")["answer"].value_counts(normalize=True)
    recognized = main[main["task"] == "recognition"]
    right = (recognized["answer"] == recognized["style"]).groupby(recognized["kind"]).mean()
    grades = main.groupby("task")["value"].mean()
    wanted = {
        0.6545: said["original", "real"],
        0.0244: said["original", DONT_KNOW],
        0.5039: said["synthetic", "real"],
        0.0669: said["synthetic", DONT_KNOW],
        0.459: right["original"],
        0.3893: right["synthetic"],
    }
    # About 3,000 answers of 600 people, whose answers are alike by 1/6: 4 standard errors
    for share, found in wanted.items():
        assert abs(found - share) < 4 * np.sqrt(share * (1 - share) / 3000 * (1 + 4 / 6)), share
    assert_allclose(
        [grades["pair"], grades["resemblance"]], [2.91, 3.15], atol=4 * 1.2 * np.sqrt(1 / 600 / 6 + 1 / 6000)
    )
    counts = main[main["task"] == "resemblance"]["answer"].value_counts()
    buttons = [button.answer for button in ResemblanceTask().buttons]
    assert counts[buttons].is_monotonic_decreasing  # from identical on, as in Fig. 8


def test_means_by_style_and_shares_by_kind_come_back():
    study = judgments(400)
    grades = pd.Series({"a": 1.60, "b": 2.0, "c": 2.5, "d": 3.0, "e": 3.45, "average walk": 0.0})
    truth = {
        "pair": grades.drop("average walk"),
        "naturalness": {"original": 0.9, "synthetic": 0.2},
        "recognition": 0.5,
    }
    answers = simulate_answers(study, truth=truth, random_state=0, bias=0.0, taste=0.0)
    main = answers[answers["part"] == "main"]
    found = main[main["task"] == "pair"].groupby("style")["value"].agg(["mean", "count"])
    assert (abs(found["mean"] - grades) * np.sqrt(found["count"]) < 4 * 1.4).drop("average walk").all()
    real = main[main["task"] == "naturalness"].groupby("kind")["answer"].agg(lambda said: (said == "real").mean())
    assert_allclose(real[["original", "synthetic"]], [0.9, 0.2], atol=0.05)
    assert DONT_KNOW not in set(main[main["task"] == "naturalness"]["answer"])


def test_a_confusion_table_says_what_styles_are_taken_for():
    study = make_study(RecognitionTask(), walks=CROSSED, n_participants=300, random_state=0)
    styles = [*"abcde", "average walk"]
    confusions = pd.DataFrame(np.roll(np.eye(6), 1, axis=1), styles, styles)  # each for the next
    confusions.loc["a"] = [0.5, 0, 0.5, 0, 0, 0]
    answers = simulate_answers(study, truth=confusions, random_state=0)
    table = pd.crosstab(answers["style"], answers["answer"], normalize="index").reindex(columns=styles, fill_value=0)
    assert_allclose(table.loc[styles].drop("a"), confusions.drop("a"))
    assert_allclose(table.loc["a", ["a", "c"]], 0.5, atol=0.06)


def test_answers_of_one_observer_are_alike_by_the_share_of_the_bias():
    study = make_study(NaturalnessTask(), walks=CROSSED, n_participants=400, random_state=0)
    agreement = {}
    for bias in (0.0, 1.0):
        answers = simulate_answers(study, truth=0.5, bias=bias, taste=0.0, noise=1.0, random_state=0)
        real = (answers["answer"] == "real").groupby(answers["participant"]).mean()
        agreement[bias] = real.var() / (0.25 / 10)  # over that of ten independent answers
    assert_allclose(agreement[0.0], 1.0, atol=0.3)
    # Normal variables that correlate by 1/2 agree in sign by 2/3, so the answers correlate by 1/3: 1 + 9 / 3
    assert_allclose(agreement[1.0], 4.0, atol=0.8)


def test_all_alike_give_the_median_answer():
    answers = simulate_answers(judgments(), truth={"resemblance": 4.0, "naturalness": 0.6}, **ALIKE)
    main = answers[answers["part"] == "main"].groupby("task")["answer"].unique()
    assert main["resemblance"].tolist() == ["identical"]
    assert main["naturalness"].tolist() == ["real"]


# ---- times


def test_ratings_run_by_themselves_for_seven_seconds():
    answers = simulate_answers(ratings(), random_state=0)
    for column, value in {"shown_s": 7.0, "shown_error_s": 0.0, "frames_drawn": 420, "replays": 0}.items():
        assert (answers[column] == value).all()
    assert (answers["frames_dropped"] == 0).all()
    assert answers["response_time_s"].between(0.1, 60).all()
    times = pd.to_datetime(answers["answered_at"]).groupby(answers["participant"])
    gaps = times.diff().dropna().dt.total_seconds()
    assert gaps.min() >= 10.0  # seven seconds of walking, three of blank


def test_an_answer_ends_a_walk_that_was_started_by_hand():
    answers = simulate_answers(judgments(40), random_state=0)
    cut = answers["shown_s"] < 3.0
    assert 0.3 < cut.mean() < 0.99
    assert answers.loc[cut, "shown_error_s"].isna().all()
    assert (answers.loc[~cut, "shown_error_s"] == 0.0).all()
    assert answers["pixels_per_degree"].isna().all()
    waiting = make_study(NaturalnessTask(showing=Showing(answer="after")), walks=CROSSED, n_participants=4)
    assert (simulate_answers(waiting, random_state=0)["response_time_s"] > 3.0).all()


# ---- errors


def test_names_that_are_missing_and_names_of_nothing_are_all_told():
    truth = HAPPY.rename({NAMES[0]: "anna", NAMES[1]: "bert"})
    message = f"2 stimuli without a truth: {NAMES[0]}, {NAMES[1]}; 2 truths of no stimuli: anna, bert"
    with pytest.raises(ValueError, match=message):
        simulate_answers(ratings(), truth=truth)
    with pytest.raises(ValueError, match=f"1 truths that are no numbers: {NAMES[3]}"):
        simulate_answers(ratings(), truth=HAPPY.where(HAPPY.index != NAMES[3]))
    with pytest.raises(ValueError, match=f"1 truths that are there twice: {NAMES[0]}"):
        simulate_answers(ratings(), truth=pd.concat([HAPPY, HAPPY[:1]]))


def test_faults_of_several_tasks_come_together():
    truth = {"pair": {"a": 2.0}, "naturalness": 1.5, "recognition": {"a": 0.5, "z": 0.5}}
    parts = (
        "truth of the task pair: 4 styles without a truth: b, c, d, e",
        "truth of the task naturalness: expected shares from 0 to 1, got 1.5 to 1.5",
        "truth of the task recognition: 5 styles without a truth: average walk, b, c, d, e; 1 truths of no styles: z",
    )
    with pytest.raises(ValueError, match="; ".join(parts)):
        simulate_answers(judgments(), truth=truth)


def test_truths_of_another_form_are_refused():
    groups = make_study(
        [RatingTask(), RatingTask(("relaxed", "nervous"))], walks=WALKS, n_participants=2, random_state=0
    )
    odd = pd.DataFrame(0.4, [*"abcde", "average walk"], ["a", "b"])
    cases = {
        "several rating tasks must be a DataFrame with the columns happy, nervous, got a Series": (groups, HAPPY),
        "expected a column of this name, got happy": (groups, HAPPY.to_frame("happy")),
        "expected standard deviations, 0 between both poles, got values from 170 to 170": (ratings(), HAPPY * 0 + 170),
        "must be a mapping from their names, {'naturalness': ..., 'pair'": (judgments(), 0.5),
        "expected tasks of the study, naturalness, pair, .*, got rating": (judgments(), {"pair": 1.0, "rating": 0.0}),
        "expected mean grades from 0 to 4, got 5 to 5": (judgments(), {"pair": 5.0}),
        "expected shares that sum to 1 in each row, not so: a_original_static": (judgments(), {"recognition": odd}),
        "expected columns among a, b, c, d, e, average walk, don't know, got f": (
            judgments(),
            {"recognition": odd.rename(columns={"b": "f"})},
        ),
    }
    for message, (study, truth) in cases.items():
        with pytest.raises(ValueError, match=message):
            simulate_answers(study, truth=truth)


def test_the_papers_figures_need_kinds():
    plain = [Stimulus(walk.name, walk) for walk in WALKS[:3]]
    study = make_study(NaturalnessTask(), walks=plain, n_participants=2)
    with pytest.raises(ValueError, match=f"these are neither: {NAMES[0]}, .*; pass truth="):
        simulate_answers(study)
    assert set(simulate_answers(study, truth=1.0)["answer"]) == {"real"}


def test_numbers_out_of_range_are_refused():
    study = ratings()
    cases = {
        "noise must be a number of at least 0, got -1": {"noise": -1},
        "gain must be a number of at least 0, got nan": {"gain": float("nan")},
        "lapse must be a number of at least 0 and at most 1, got 2": {"lapse": 2},
        "participants must be among the 3 of the design, got 4, 9": {"participants": [1, 4, 9]},
        "participants must be among the 3 of the design, got none": {"participants": []},
    }
    for message, options in cases.items():
        with pytest.raises(ValueError, match=message):
            simulate_answers(study, **options)
    with pytest.raises(ValueError, match="n_sets must be a number of at least 1, got 0"):
        simulate_studies(study, len, n_sets=0)


# ---- many studies


def test_sets_do_not_depend_on_the_number_of_jobs():
    study, found = ratings(), []
    for n_jobs in (1, 2):
        with parallel_config("threading"):  # processes take long to start
            found.append(simulate_studies(study, spread_of, n_sets=3, truth=HAPPY, random_state=0, n_jobs=n_jobs))
    pd.testing.assert_frame_equal(*found)
    assert found[0].columns.tolist() == ["mean", "sd"]
    assert found[0]["sd"].nunique() == 3
    first = simulate_studies(study, spread_of, n_sets=2, truth=HAPPY, random_state=0)
    pd.testing.assert_frame_equal(first, found[0][:2])


def spread_of(answers):
    return answers["value"].agg(["mean", "std"]).rename({"std": "sd"})


def test_an_analysis_that_returns_a_number_has_one_column():
    found = simulate_studies(ratings(), len, n_sets=2)
    assert found.to_dict("list") == {"value": [108, 108]}
