"""``eigenwalker study``: studies of recordings, and what people said in them."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from eigenwalker import make_walkers, write_walk
from eigenwalker.experiment.answers.files import write_answers
from eigenwalker.experiment.running.study_files import read_study
from eigenwalker.experiment.simulated.observers import simulate_answers

STYLES = ("cool", "happy", "sad")
PATTERN = r"^[a-z]+_(?P<style>[a-z]+)"


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(20, duration=4, frame_rate=50, random_state=0)


@pytest.fixture(scope="module")
def files(walkers, tmp_path_factory):
    """Return the recordings of twenty walkers on a treadmill."""
    folder = tmp_path_factory.mktemp("walkers")
    paths = [folder / f"{walk.name}.csv" for walk in walkers.data]
    for walk, path in zip(walkers.data, paths, strict=True):
        write_walk(walk, path)
    return paths


@pytest.fixture(scope="module")
def styled(tmp_path_factory):
    """Return recorded and made walks of three styles over a floor, and one of an average model."""
    folder = tmp_path_factory.mktemp("styled")
    walks = make_walkers(7, duration=4, frame_rate=50, treadmill=False, random_state=0).data
    names = [f"{kind}_{style}.csv" for kind in ("actor", "model") for style in STYLES] + ["average.csv"]
    for walk, name in zip(walks, names, strict=True):
        write_walk(walk, folder / name)
    return [folder / name for name in names]


@pytest.fixture
def movies(tmp_path):
    """Return movies of original and synthetic walks under two conditions."""
    names = [f"{kind}_{style}_{how}" for kind in ("a", "b") for style in STYLES for how in ("static", "displacement")]
    paths = [tmp_path / f"{name}.mp4" for name in names]
    for path in paths:
        path.write_bytes(path.name.encode())
    return paths


def answer(folder, **options):
    """Put simulated answers into a study's folder."""
    study = read_study(folder)
    answers = simulate_answers(study, random_state=0, **options)
    write_answers(answers, folder, study=study)
    return study, answers


def test_ratings_from_recordings_to_labels_of_a_model(run, walkers, files, tmp_path):
    folder = tmp_path / "moods"
    made = ["--labels", "sad,happy", "relaxed,nervous", "--out", folder, "--attention", 1, "--title", "Moods"]
    status, out, _ = run("study", "new", "rating", "--walkers", *files, *made)
    assert status == 0
    assert "20 walks, 6 participants; each has 3 runs of 21 trials" in out
    assert f"open {folder / 'index.html'} in a browser" in out
    assert f"eigenwalker study analyze {folder}" in out
    study, answers = answer(folder, truth=walkers.target[["happy", "nervous"]])
    assert [task.poles for task in study.tasks] == [("sad", "happy"), ("relaxed", "nervous")]
    assert set(study.design["view"]) == {0.0, 30.0, 90.0}
    status, out, err = run("study", "analyze", folder, "--figures")
    assert (status, err) == (0, "")
    for line in (
        f"Moods (study {study.id}): 6 of 6 participants, {len(answers)} answers",
        "Ratings: 360 answers of 6 participants about 20 walks. Attention trials failed: none of 18.",
        "Reliability of happy: 3 observers, 3 viewpoints, 20 walkers\n",
        "one observer, ICC(2,1)",
        "9 ratings a walker",
        f"eigenwalker fit FILE ... --labels {folder / 'traits.csv'} --trait happy",
    ):
        assert line in out
    traits = pd.read_csv(folder / "traits.csv", index_col="file")
    wanted = answers[answers["part"] == "main"].groupby(["stimulus", "trait"])["value"].mean().unstack()
    pd.testing.assert_frame_equal(traits, wanted.loc[[path.stem for path in files]], check_names=False)
    assert sorted(path.name for path in (folder / "figures").iterdir()) == ["rating_happy.png", "rating_nervous.png"]
    model = ["--labels", folder / "traits.csv", "--trait", "happy", "--components", 4, "--out", tmp_path / "m.skops"]
    assert run("fit", *files, *model)[0] == 0


def test_a_study_is_what_was_asked_for(run, files, tmp_path):
    consent = tmp_path / "consent.txt"
    consent.write_text("I take part.\n\nI may stop at any time.\n", encoding="utf-8")
    asked = ["--labels", "light,heavy", "--participants", 4, "--views", "side", 45, "--buttons", 7, "--left", "first"]
    more = ["--practice", 2, "--consent", consent, "--seed", 3, "--formats", "page", "--out", tmp_path / "study"]
    assert run("study", "new", "rating", "--walkers", *files[:5], *asked, *more)[0] == 0
    study = read_study(tmp_path / "study")
    (task,) = study.tasks
    assert (task.trait, task.views, task.n_buttons, task.left, task.n_practice) == (
        "heavy",
        (90.0, 45.0),
        7,
        "first",
        2,
    )
    assert (study.n_participants, len(study.stimuli)) == (4, 5)
    assert study.consent == "I take part.\n\nI may stop at any time."
    assert not (tmp_path / "study" / "study.jzip").exists()
    again = [*more[:-1], tmp_path / "again"]
    run("study", "new", "rating", "--walkers", *files[:5], *asked, *again)
    assert read_study(tmp_path / "again").id == study.id
    run("study", "new", "rating", "--walkers", *files[:5], *asked, *again[:-2], "--seed", 4, "--out", tmp_path / "c")
    assert read_study(tmp_path / "c").id != study.id


@pytest.mark.parametrize(
    ("task", "figures", "words"),
    [
        ("naturalness", ["shares"], 'Taken for "real", in percentage points'),
        ("recognition", ["confusions", "rates"], "Chance is 20.00 %, one of 5 answers"),
        ("pair", ["means", "scores", "shares"], "scores, 0 (not realistic) to 4 (as natural as the original)"),
        ("resemblance", ["means", "scores", "shares"], "scores, 0 (nothing in common) to 4 (identical)"),
    ],
)
def test_each_test_from_recordings_to_its_report(run, styled, tmp_path, task, figures, words):
    folder = tmp_path / "study"
    walks = ["--walkers", *styled[:3], "--synthetic", *styled[3:6], "--average", styled[6], "--label-pattern", PATTERN]
    status, out, err = run("study", "new", task, *walks, "--out", folder, "--participants", 12, "--trials", 6)
    assert status == 0, err
    study, answers = answer(folder)
    assert {stimulus.condition for stimulus in study.stimuli} == {"static", "displacement"}
    assert len(study.stimuli) == 14
    sources = pd.read_csv(folder / "walks.csv", index_col="stimulus")
    assert sources.loc["sad_synthetic_displacement", ["file", "reference"]].tolist() == [
        str(styled[5]),
        "sad_original_displacement",
    ]
    assert sources.loc["average_static", "style"] == "average walk"
    status, out, err = run("study", "analyse", folder, "--figures")
    assert (status, err) == (0, "")
    assert f"12 of 12 participants, {len(answers)} answers" in out
    assert words in out
    assert sorted(path.stem for path in (folder / "figures").iterdir()) == [f"{task}_{name}" for name in figures]


def test_numbers_of_the_papers_are_the_defaults(run, styled, tmp_path):
    walks = ["--walkers", *styled[:3], "--synthetic", *styled[3:6], "--label-pattern", PATTERN]
    for task, n_participants in {"pair": 37, "recognition": 100}.items():
        assert run("study", "new", task, *walks, "--out", tmp_path / task, "--formats", "page")[0] == 0
        assert read_study(tmp_path / task).n_participants == n_participants
    assert read_study(tmp_path / "pair").tasks[0].n_series == 3


def test_styles_from_a_table(run, styled, tmp_path):
    table = tmp_path / "styles.csv"
    rows = [f"{path.name},{style}" for path, style in zip(styled[:6], [*STYLES, *STYLES], strict=True)]
    table.write_text("\n".join(["file,style", *rows]), encoding="utf-8")
    walks = ["--walkers", *styled[:3], "--synthetic", *styled[3:6], "--labels-table", table]
    made = ["--out", tmp_path / "study", "--series", 1, "--draw", "balanced", "--conditions", "displacement"]
    assert run("study", "new", "pair", *walks, *made)[0] == 0
    study = read_study(tmp_path / "study")
    assert [stimulus.style for stimulus in study.stimuli if stimulus.kind == "synthetic"] == list(STYLES)
    assert (study.tasks[0].n_series, study.tasks[0].draw) == (1, "balanced")
    table.write_text("\n".join(["file,style", *rows[1:], f"{styled[0].name},"]), encoding="utf-8")
    status, _, err = run("study", "new", "pair", *walks, *made)
    assert status == 1
    assert "expected a style of each file, got none of actor_cool" in err


def test_walks_in_place_of_unknown_speed_are_shown_in_place(run, walkers, tmp_path):
    paths = [tmp_path / name for name in ("actor_sad.csv", "model_sad.csv")]
    for walk, path in zip(walkers.data, paths, strict=False):
        write_walk(replace(walk, speed=np.nan), path)
    walks = ["--walkers", paths[0], "--synthetic", paths[1], "--label-pattern", PATTERN, "--out", tmp_path / "study"]
    status, out, _ = run("study", "new", "resemblance", *walks)
    assert status == 0
    assert "2 of 2 walks stay in place, and their speed is not known: all are shown in place, static" in out
    assert {stimulus.condition for stimulus in read_study(tmp_path / "study").stimuli} == {"static"}
    status, _, err = run("study", "new", "resemblance", *walks, "--conditions", "static", "displacement")
    assert status == 1
    assert f"--conditions: 2 of 2 walks stay in place, and their speed is not known: {paths[0]}, {paths[1]}" in err


def test_movies_in_place_of_recordings(run, movies, tmp_path):
    pattern = r"_(?P<style>[a-z]+)_(?P<condition>[a-z]+)"
    walks = ["--walkers", *movies[:6], "--synthetic", *movies[6:], "--label-pattern", pattern]
    folder = tmp_path / "study"
    status, _, err = run("study", "new", "pair", *walks, "--average", movies[0], "--out", folder)
    assert status == 0, err
    stimuli = {stimulus.name: stimulus for stimulus in read_study(folder).stimuli}
    assert stimuli["sad_synthetic_static"].reference == "sad_original_static"
    assert stimuli["average"].style == "average walk"
    sources = pd.read_csv(folder / "walks.csv", index_col="stimulus")["file"]
    shown = [path.read_bytes().decode() for path in sorted((folder / "stimuli").iterdir())]
    assert shown == [Path(path).name for path in sources]
    status, _, err = run("study", "new", "pair", *walks, "--conditions", "static", "--out", folder)
    assert status == 1
    assert "movies are shown as they are; leave --conditions out" in err
    few = ["--walkers", *movies[:5], "--synthetic", *movies[6:], "--label-pattern", pattern, "--out", folder]
    status, _, err = run("study", "new", "pair", *few)
    assert status == 1
    assert "expected one original movie of a style, or as many as synthetic ones, got sad displacement (0 and 1)" in err


def test_movies_are_rated_from_where_they_were_filmed(run, files, movies, tmp_path):
    asked = ["--labels", "sad,happy", "--out", tmp_path / "study"]
    assert run("study", "new", "rating", "--walkers", *movies, *asked)[0] == 0
    assert set(read_study(tmp_path / "study").design["view"]) == {0.0}
    status, _, err = run("study", "new", "rating", "--walkers", *movies, *asked, "--views", 0, 90)
    assert (status, "leave --views out" in err) == (1, True)
    status, _, err = run("study", "new", "rating", "--walkers", *movies, files[0], *asked)
    assert status == 1
    assert f"expected movies only, or recordings only, got {movies[0]} and {files[0]}" in err


def test_an_analysis_before_there_are_answers_says_where_to_put_them(run, files, tmp_path):
    folder = tmp_path / "study"
    run("study", "new", "rating", "--walkers", *files[:4], "--labels", "sad,happy", "--out", folder)
    status, _, err = run("study", "analyze", folder)
    assert status == 1
    number = read_study(folder).id
    assert f"put what participants downloaded, study-{number}_participant-1_data.csv and so on" in err
    assert str(folder / "data") in err
    status, _, err = run("study", "analyze", tmp_path)
    assert status == 1
    assert f"no study.json in {tmp_path}" in err


def test_an_analysis_of_some_participants_says_who_is_missing(run, walkers, files, tmp_path):
    folder = tmp_path / "study"
    run(
        "study",
        "new",
        "rating",
        "--walkers",
        *files,
        "--labels",
        "sad,happy",
        "a,b",
        "--participants",
        8,
        "--out",
        folder,
    )
    study = read_study(folder)
    truth = walkers.target[["happy"]].assign(b=0.0)
    answers = simulate_answers(study, truth=truth, participants=[1, 3, 5], random_state=0)
    unfinished = (answers["participant"] == 5) & (answers["session"] == 3)
    write_answers(answers[~unfinished], folder, study=study)
    status, out, _ = run("study", "analyze", folder, "--standardize", "--adjust")
    assert status == 0
    assert "no answers yet of: 2, 4, 6, 7, 8" in out
    assert "Reliability of happy: 2 observers, 3 viewpoints, 20 walkers; 1 more have not rated all of them" in out
    assert "Reliability of b" not in out
    assert "8 ratings a walker" in out
    assert list(pd.read_csv(folder / "traits.csv").columns) == ["file", "happy"]
    one = folder / "data" / "participant-1_task-rating_data.csv"
    for path in (folder / "data").iterdir():
        if path != one:
            path.unlink()
    status, out, _ = run("study", "analyze", folder)
    assert status == 0
    assert "1 of 8 participants" in out


def test_answers_to_another_study_are_refused(run, files, tmp_path):
    for name, number in (("one", 4), ("other", 5)):
        asked = ["--labels", "sad,happy", "--out", tmp_path / name]
        run("study", "new", "rating", "--walkers", *files[:number], *asked)
    answer(tmp_path / "one")
    for path in (tmp_path / "one" / "data").iterdir():
        path.rename(tmp_path / "other" / "data" / path.name)
    status, _, err = run("study", "analyze", tmp_path / "other")
    assert status == 1
    assert f"expected {read_study(tmp_path / 'other').id}, got '{read_study(tmp_path / 'one').id}'" in err


def test_bad_recordings_are_refused_or_left_out(run, files, styled, tmp_path):
    broken = tmp_path / "actor_sad2.csv"
    broken.write_text("time,head_x\n0,1\n")
    asked = ["--labels", "sad,happy", "--out", tmp_path / "study"]
    status, _, err = run("study", "new", "rating", "--walkers", *files[:3], broken, *asked)
    assert status == 1
    assert "1 of 4 recordings were refused; mend them, or leave them out with --skip-bad" in err
    status, out, _ = run("study", "new", "rating", "--walkers", *files[:3], broken, *asked, "--skip-bad")
    assert status == 0
    assert "refused: 1 of 4" in out
    assert len(read_study(tmp_path / "study").stimuli) == 3
    walks = ["--walkers", *styled[:3], broken, "--synthetic", *styled[3:6], "--label-pattern", PATTERN]
    status, _, err = run("study", "new", "pair", *walks, "--out", tmp_path / "pairs")
    assert status == 1
    assert "1 of 7 recordings were refused; mend them, or leave them out of the command" in err


def test_wrong_requests_are_refused(run, styled, tmp_path):
    pattern = ["--label-pattern", PATTERN]
    cases = {
        "got twice: ": ["--walkers", *styled[:3], "--synthetic", styled[0], *pattern],
        "has no group for style": ["--walkers", *styled[:3], "--synthetic", styled[3], "--label-pattern", "(?P<a>a)"],
        "an original of each style that was synthesized, none of: happy": [
            *("--walkers", styled[0], "--synthetic", styled[4]),
            *pattern,
        ],
    }
    for message, request in cases.items():
        status, _, err = run("study", "new", "naturalness", *request, "--out", tmp_path / "study")
        assert status == 1
        assert message in err


@pytest.mark.parametrize("labels", ["sad", "sad,", "sad,sad", "sad,happy,proud"])
def test_labels_are_two_words(run, files, capsys, tmp_path, labels):
    with pytest.raises(SystemExit):
        run("study", "new", "rating", "--walkers", files[0], "--labels", labels, "--out", tmp_path / "study")
    assert "expected two different words with a comma between them, such as sad,happy" in capsys.readouterr().err


def test_a_page_holds_the_words_and_the_walks(run, files, tmp_path):
    run("study", "new", "rating", "--walkers", *files[:3], "--labels", "sad,happy", "--out", tmp_path / "study")
    page = (tmp_path / "study" / "index.html").read_text(encoding="utf-8")
    assert "How does this walker seem to you, sad or happy?" in page
    words = json.loads((tmp_path / "study" / "study.json").read_text(encoding="utf-8"))
    assert [stimulus["name"] for stimulus in words["stimuli"]] == [path.stem for path in files[:3]]
