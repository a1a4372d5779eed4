import json
from dataclasses import replace

import pandas as pd
import pytest

from eigenwalker.datasets import make_walkers
from eigenwalker.experiment.running.study_files import build_study, read_study
from eigenwalker.experiment.stimulus import Stimulus, cross_stimuli
from eigenwalker.experiment.tasks import (
    NaturalnessTask,
    PairTask,
    RatingTask,
    RecognitionTask,
    ResemblanceTask,
)

WALKS = make_walkers(5, random_state=0).data


def build(out, tasks=None, **changes):
    settings = {"walks": WALKS[:2], "n_participants": 1, "random_state": 0, "formats": ["page", "jatos"]}
    return build_study(tasks or RatingTask(), out=out, **{**settings, **changes})


def test_a_folder_has_all_that_a_study_needs(tmp_path):
    study = build(tmp_path / "moods", consent="I agree.")
    found = sorted(path.name for path in (tmp_path / "moods").iterdir())
    assert found == ["data", "dataset_description.json", "design.csv", "index.html", "study.json", "study.jzip"]
    page = (tmp_path / "moods" / "index.html").read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>")
    assert study.id in page
    design = pd.read_csv(tmp_path / "moods" / "design.csv", keep_default_na=False, dtype={"view": float})
    pd.testing.assert_frame_equal(design, study.design, check_dtype=False)


def test_a_study_is_read_back_without_its_walks(tmp_path):
    tasks = [RatingTask(("relaxed", "nervous")), PairTask(), NaturalnessTask(), RecognitionTask(), ResemblanceTask()]
    walks = cross_stimuli({"sad": WALKS[0], "cool": WALKS[1]}, {"sad": WALKS[2], "cool": WALKS[3]})
    walks = [*walks, Stimulus("calm", WALKS[4], style="calm")]
    study = build(tmp_path, tasks, walks=walks, title="Moods & <styles>", consent="yes\n\nno")
    again = read_study(tmp_path)
    assert again.id == study.id
    assert again.tasks == study.tasks
    assert [stimulus.name for stimulus in again.stimuli] == [stimulus.name for stimulus in study.stimuli]
    assert all(stimulus.walk is None for stimulus in again.stimuli)
    pd.testing.assert_frame_equal(again.design, study.design)


def test_movies_lie_beside_the_page_under_plain_names(tmp_path):
    (tmp_path / "a b.mp4").write_bytes(b"movie")
    build(tmp_path / "out", NaturalnessTask(), walks=[Stimulus("a <b>", movie=tmp_path / "a b.mp4")])
    assert (tmp_path / "out" / "stimuli" / "stimulus_001.mp4").read_bytes() == b"movie"
    with pytest.raises(FileNotFoundError, match=r"no such movies: .*gone.mp4"):
        build(tmp_path / "other", NaturalnessTask(), walks=[Stimulus("a", movie=tmp_path / "gone.mp4")])


def test_a_study_with_answers_is_not_replaced_by_another(tmp_path):
    study = build(tmp_path)
    (tmp_path / "data" / "participant-1_task-rating_data.csv").write_text("answers")
    assert build(tmp_path).id == study.id
    with pytest.raises(ValueError, match=f"1 files of answers to another study, {study.id}"):
        build(tmp_path, random_state=1)
    (tmp_path / "data" / "participant-1_task-rating_data.csv").unlink()
    assert build(tmp_path, random_state=1).id != study.id


def test_nothing_is_written_of_a_study_that_cannot_be_shown(tmp_path):
    unknown = replace(WALKS[0], speed=float("nan"))
    with pytest.raises(ValueError, match="speed must be known"):
        build(tmp_path / "out", PairTask(), walks=cross_stimuli({"sad": unknown}, {"sad": WALKS[1]}))
    assert not (tmp_path / "out").exists()


def test_a_study_that_was_changed_is_refused(tmp_path):
    build(tmp_path)
    words = json.loads((tmp_path / "study.json").read_text())
    words["design"]["left"][0] = "sad"
    (tmp_path / "study.json").write_text(json.dumps(words))
    with pytest.raises(ValueError, match="it was changed after it was written"):
        read_study(tmp_path)
    (tmp_path / "study.json").write_text("{")
    with pytest.raises(ValueError, match="expected a study as build_study writes it"):
        read_study(tmp_path)
    with pytest.raises(FileNotFoundError, match=r"no study\.json"):
        read_study(tmp_path / "data")


def test_unknown_formats_are_refused(tmp_path):
    with pytest.raises(ValueError, match="formats must be one of 'page', 'jatos', 'psychopy', got 'pdf'"):
        build(tmp_path / "out", formats=["page", "pdf"])
