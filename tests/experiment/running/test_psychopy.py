"""Tables of conditions say what the design says, in cells that are safe to be evaluated."""

import csv
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.running import psychopy
from eigenwalker.experiment.running.psychopy import write_psychopy
from eigenwalker.experiment.showing import Showing
from eigenwalker.experiment.stimulus import Stimulus
from eigenwalker.experiment.study import make_study
from eigenwalker.experiment.tasks import NaturalnessTask, RatingTask, RecognitionTask
from tests.experiment.answers.given_answers import small_study

COLUMNS = [
    *("participant", "session", "trial", "task", "part", "trait", "stimulus", "reference", "left", "view", "kind"),
    *("condition", "expected", "movie", "reference_movie", "duration", "blank"),
]
NUMBER = r"-?[0-9]+(\.[0-9]+)?"
WORD = r"[a-z]+(_[0-9]+)?"
MOVIE = r"movies/stimulus_[0-9]{3,}(_view-[0-9.]+)?(_showing-[0-9]+)?\.mp4"
SAFE = re.compile(f"{NUMBER}|{WORD}|{MOVIE}")
HOSTILE = (
    *("__import__('os').system('rm -rf ~')", "=1+1", "[1, 2]", "{'a': 1}", "$name", "open", "None", "1e9", "a\tb"),
    *('"quoted", twice', "../../etc/passwd", "'; drop", "é ünï", "%s", "\\", "a,b", " lead", "x" * 400, "random"),
)


@pytest.fixture
def lengths(monkeypatch):
    """Return the movies that come to be written, which are not; each lasts half a second longer than the one before."""
    shown = {}

    def write(wanted, **_):
        shown.update({path.name: one for path, one in wanted})
        for path, _one in wanted:
            path.write_bytes(b"movie")
        return [1 + number / 2 for number in range(len(wanted))]

    monkeypatch.setattr(psychopy, "write_stimuli", write)
    return shown


def _cells(folder):
    tables = sorted(folder.glob("participant-*.csv"))
    return [row for path in tables for row in csv.DictReader(path.read_text(encoding="utf-8").splitlines())]


def _for_people(folder, name):
    with (folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_rows_say_what_the_design_says(lengths, tmp_path):
    study = small_study()
    paths = write_psychopy(study, tmp_path)
    assert [path.name for path in paths[:2]] == ["participant-1_session-1.csv", "participant-1_session-2.csv"]
    rows = pd.DataFrame(_cells(tmp_path))
    assert list(rows.columns) == COLUMNS
    names = {row["id"]: row["name"] for row in _for_people(tmp_path, "stimuli.csv")} | {"none": ""}
    for column in ("participant", "session", "trial", "view"):
        assert rows[column].astype(float).tolist() == study.design[column].tolist()
    for column in ("task", "part"):
        assert rows[column].tolist() == study.design[column].tolist()
    for column in ("kind", "condition"):
        assert rows[column].tolist() == [word or "none" for word in study.design[column]]
    for column in ("stimulus", "reference"):
        assert rows[column].map(names).tolist() == study.design[column].tolist()
    for row, movie in zip(study.design.to_dict("records"), rows["movie"], strict=True):
        shown = lengths[movie.removeprefix("movies/")]
        assert (shown.stimulus.name, shown.view) == (row["stimulus"], row["view"])
        assert shown.look[0] == study.task_of(row["task"], row["trait"]).showing.figure
        assert (tmp_path / movie).is_file()


def test_sides_answers_and_times(lengths, tmp_path):
    study = small_study()
    write_psychopy(study, tmp_path)
    names = {row["id"]: row["name"] for row in _for_people(tmp_path, "stimuli.csv")}
    buttons = _for_people(tmp_path, "buttons.csv")
    for row, planned in zip(_cells(tmp_path), study.design.to_dict("records"), strict=True):
        task = study.task_of(planned["task"], planned["trait"])
        if task.is_pair:
            assert names[row["left"]] == planned["left"]
        elif task.name == "rating":
            assert row["left"] == {"sad": "first", "happy": "second"}[planned["left"]]
            assert row["trait"] == "trait_1"
        else:
            assert row["left"] == "none"
        assert float(row["blank"]) == task.showing.blank
        movies = [row[name].removeprefix("movies/") for name in ("movie", "reference_movie") if row[name] != "none"]
        assert len(movies) == 1 + task.is_pair
        assert float(row["duration"]) == max(1 + list(lengths).index(movie) / 2 for movie in movies)
        if planned["expected"]:
            own = [one for one in buttons if (one["task"], one["trait"]) == (row["task"], row["trait"])]
            assert own[int(row["expected"]) - 1]["answer"] == planned["expected"]
        else:
            assert row["expected"] == "none"


def test_hostile_words_never_enter(lengths, tmp_path):
    walks = make_walkers(len(HOSTILE), random_state=0).data
    stimuli = [Stimulus(name, walk, style=name, condition="static") for name, walk in zip(HOSTILE, walks, strict=True)]
    tasks = [
        *(RatingTask((f"not {word}", word), views=(-30, 1 / 3)) for word in HOSTILE[:2]),
        RecognitionTask(n_trials=5, n_attention=3),
    ]
    study = make_study(tasks, walks=stimuli, n_participants=4, random_state=0, title=HOSTILE[0])
    paths = write_psychopy(study, tmp_path)
    for path in paths:
        lines = path.read_text(encoding="ascii").splitlines()
        assert lines[0] == ",".join(COLUMNS)
        cells = [cell for line in lines[1:] for cell in line.split(",")]
        assert [cell for cell in cells if not SAFE.fullmatch(cell)] == []
    assert {path.name for path in tmp_path.iterdir()} == {
        "movies",
        "stimuli.csv",
        "buttons.csv",
        *(p.name for p in paths),
    }
    assert all(re.fullmatch(r"stimulus_\d{3}_view-[\d.]+\.mp4", path.name) for path in (tmp_path / "movies").iterdir())
    assert [row["name"] for row in _for_people(tmp_path, "stimuli.csv")] == list(HOSTILE)
    assert set(HOSTILE) <= {row["answer"] for row in _for_people(tmp_path, "buttons.csv")}


def test_words_of_this_package_are_no_names_of_python(lengths, tmp_path):
    """A cell that is the name of something would become that."""
    import builtins
    import keyword

    write_psychopy(small_study(), tmp_path)
    words = {cell for row in _cells(tmp_path) for cell in row.values() if re.fullmatch(WORD, cell)}
    assert "none" in words
    assert not words & {*dir(builtins), *keyword.kwlist, *keyword.softkwlist}


def test_a_stimulus_that_is_shown_in_several_ways_has_several_movies(lengths, tmp_path):
    walks = [replace(walk, speed=1.0) for walk in make_walkers(2, random_state=0).data]
    stimuli = [Stimulus(name, walk, style=name, condition="static") for name, walk in zip("ab", walks, strict=True)]
    tasks = [
        RatingTask(views=(30,)),
        NaturalnessTask(n_trials=2),
        RecognitionTask(n_trials=2, showing=Showing(blank=3.0)),  # another pause is not another movie
    ]
    study = make_study(tasks, walks=stimuli, n_participants=1, random_state=0)
    write_psychopy(study, tmp_path)
    assert sorted(lengths) == [
        *("stimulus_001_view-30.mp4", "stimulus_001_view-30_showing-2.mp4"),
        *("stimulus_002_view-30.mp4", "stimulus_002_view-30_showing-2.mp4"),
    ]
    assert lengths["stimulus_001_view-30.mp4"].showing.figure == "dots"
    assert lengths["stimulus_001_view-30_showing-2.mp4"].showing.figure == "sticks"


def test_movies_have_no_view_and_maybe_no_known_length(monkeypatch, tmp_path):
    monkeypatch.setattr(psychopy, "write_stimuli", lambda wanted, **_: [np.nan for _ in wanted])
    stimuli = [Stimulus(name, movie=f"{name}.mp4") for name in ("a", "b")]
    study = make_study(NaturalnessTask(n_trials=2), walks=stimuli, n_participants=1, random_state=0)
    write_psychopy(study, tmp_path)
    assert {row["movie"] for row in _cells(tmp_path)} == {"movies/stimulus_001.mp4", "movies/stimulus_002.mp4"}
    assert {row["duration"] for row in _cells(tmp_path)} == {"none"}


def test_an_earlier_study_is_replaced_and_other_files_stay(lengths, tmp_path):
    (tmp_path / "movies").mkdir()
    (tmp_path / "participant-9_session-1.csv").write_text("old")
    (tmp_path / "movies" / "stimulus_099_view-30.mp4").write_text("old")
    (tmp_path / "movies" / "mine.mp4").write_text("mine")
    (tmp_path / "experiment.psyexp").write_text("mine")
    write_psychopy(small_study(), tmp_path)
    assert not (tmp_path / "participant-9_session-1.csv").exists()
    assert not (tmp_path / "movies" / "stimulus_099_view-30.mp4").exists()
    assert (tmp_path / "movies" / "mine.mp4").read_text() == "mine"
    assert (tmp_path / "experiment.psyexp").read_text() == "mine"


def test_the_same_study_makes_the_same_tables(lengths, tmp_path):
    for name in ("a", "b"):
        write_psychopy(small_study(), tmp_path / name)
    for path in (tmp_path / "a").glob("*.csv"):
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()


def test_movies_are_really_written(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    walks = make_walkers(2, random_state=0).data
    showing = Showing(figure="dots", height=5.0, duration=0.2)
    study = make_study(RatingTask(views=(0,), showing=showing), walks=walks, n_participants=1, random_state=0)
    write_psychopy(study, tmp_path, rate=30, n_jobs=1)
    movies = {row["movie"] for row in _cells(tmp_path)}
    assert len(movies) == 2
    assert all(b"ftyp" in (tmp_path / movie).read_bytes()[:12] for movie in movies)
    assert {row["duration"] for row in _cells(tmp_path)} == {"0.2"}


def test_rates_are_checked_before_anything_is_written(tmp_path):
    with pytest.raises(ValueError, match="rate must be a number above 0, in frames per second, got 0"):
        write_psychopy(small_study(), tmp_path / "out", rate=0)
    assert not list(tmp_path.iterdir())
