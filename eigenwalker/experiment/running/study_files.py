"""The folder of a study: the page that runs it, what other software needs to run it, and room for its answers."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

from eigenwalker._validation import check_choice
from eigenwalker._whole_files import write_whole
from eigenwalker.experiment.answers.psych_ds import write_description
from eigenwalker.experiment.design_table import design_from_values
from eigenwalker.experiment.running.jatos import write_jzip
from eigenwalker.experiment.running.page_contents import movie_file, page_contents
from eigenwalker.experiment.running.psychopy import write_psychopy
from eigenwalker.experiment.running.study_page import study_page
from eigenwalker.experiment.stimulus import Stimulus
from eigenwalker.experiment.study import Study, make_study
from eigenwalker.experiment.study_words import stimulus_from_words, task_from_words
from eigenwalker.experiment.tasks import Task
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["FORMATS", "build_study", "read_study"]

FORMATS = ("page", "jatos", "psychopy")
"""What a study can be written as."""

_FORMAT = 1
_STUDY = "study.json"


def build_study(
    tasks: Task | Sequence[Task],
    *,
    walks: Sequence[Walk | JointWalk | Stimulus],
    n_participants: int,
    out: str | os.PathLike[str],
    random_state: Any = None,
    title: str = "How people walk",
    consent: str = "",
    formats: Collection[str] = FORMATS,
    n_jobs: int | None = None,
) -> Study:
    """Return a study, and write the folder that it is run from.

    Parameters
    ----------
    tasks : Task or list of Task
        `RatingTask`, `PairTask`, `NaturalnessTask`, `RecognitionTask`, `ResemblanceTask`. A participant does all of
        them in order, but of several rating tasks, the label groups, only one.
    walks : list of Walk, JointWalk or Stimulus
        What is shown, with names of their own. Ratings take prepared walks in place; the other tasks what
        `cross_stimuli` makes of original and synthetic walks, or movies, ``Stimulus("sad1", movie="sad1.mp4")``.
    n_participants : int
        In all groups together; the paper has three a label group (Troje 2002) and about 100 for its tests (Tilmanne,
        Moinet & Dutoit 2012).
    out : str or path
        The folder; made where it is missing. A study that is there is replaced, unless there are answers to it.
    random_state : int, RandomState or None, default None
        Of all orders and draws. With the same number the study is the same.
    title, consent : str
        Plain words on the page; paragraphs of the consent are separated by blank lines. Without a consent none is
        asked for.
    formats : collection of {"page", "jatos", "psychopy"}, default all
        "page" is ``index.html``, which runs from the folder, without a server; "jatos" is ``study.jzip``, to be
        imported into JATOS; "psychopy" is a folder of condition files and movies, which need ``.[movie]``.
    n_jobs : int, default None
        Number of processes for movies, as in joblib.

    Returns
    -------
    Study
        To be simulated (`simulate_answers`); `read_study` reads it back without the walks. Beside the formats the
        folder holds ``design.csv``, ``study.json``, ``dataset_description.json`` and ``data``, for the answers, which
        `read_answers` reads.

    Raises
    ------
    TypeError, ValueError
        If tasks, walks or numbers are not as they should be, or the folder has answers to another study.
    ImportError
        If ffmpeg is not installed, which movies need.

    See Also
    --------
    make_study : The study without the folder.

    Examples
    --------
    The five studies of the papers, each by one call (Troje 2002, section 4; Tilmanne & Dutoit 2012, section 3;
    Tilmanne, Moinet & Dutoit 2012, 6.2, 6.3 and 6.4):

    >>> from eigenwalker.experiment import NaturalnessTask, PairTask, RatingTask, RecognitionTask, ResemblanceTask
    >>> from eigenwalker.experiment import build_study, cross_stimuli
    >>> moods = [RatingTask(("sad", "happy")), RatingTask(("relaxed", "nervous"))]
    >>> build_study(moods, walks=walkers, n_participants=6, out="moods", random_state=0)  # doctest: +SKIP
    >>> walks = cross_stimuli(originals, synthetics, average=average)  # doctest: +SKIP
    >>> build_study(PairTask(), walks=walks, n_participants=37, out="pairs", random_state=0)  # doctest: +SKIP
    >>> tests = [NaturalnessTask(), RecognitionTask(), ResemblanceTask()]  # or each by itself
    >>> build_study(tests, walks=walks, n_participants=100, out="tests", random_state=0)  # doctest: +SKIP
    """
    for name in formats:
        check_choice(name, FORMATS, name="formats")
    study = make_study(
        tasks, walks=walks, n_participants=n_participants, random_state=random_state, title=title, consent=consent
    )
    folder = Path(out)
    _check_folder(folder, study)
    contents, assets = page_contents(study), _movies(study)
    (folder / "data").mkdir(parents=True, exist_ok=True)
    write_whole(folder / _STUDY, _encoded_study(study))
    write_whole(folder / "design.csv", study.design.to_csv(index=False, lineterminator="\n").encode())
    write_description(folder, study)
    if "page" in formats:
        write_whole(folder / "index.html", study_page(contents).encode())
        for file, movie in assets.items():
            (folder / file).parent.mkdir(exist_ok=True)
            shutil.copyfile(movie, folder / file)
    if "jatos" in formats:
        page = study_page(contents, jatos=True)
        write_jzip(folder / "study.jzip", page, title=study.title, study_id=study.id, assets=assets)
    if "psychopy" in formats:
        write_psychopy(study, folder / "psychopy", n_jobs=n_jobs)
    return study


def read_study(folder: str | os.PathLike[str]) -> Study:
    """Return the study of a folder that `build_study` wrote, without its walks: what its answers are read against.

    Parameters
    ----------
    folder : str or path
        With ``study.json``.

    Returns
    -------
    Study

    Raises
    ------
    FileNotFoundError
        If there is no study.
    ValueError
        If the file is damaged, or was changed.
    """
    path = Path(folder, _STUDY)
    if not path.is_file():
        above = Path(folder).resolve().parent
        hint = f"; it is in {above}" if (above / _STUDY).is_file() else ""
        raise FileNotFoundError(
            f"no {_STUDY} in {folder}; expected the folder that build_study or study new wrote{hint}"
        )
    try:
        words = json.loads(path.read_text(encoding="utf-8"))
        study = Study(
            tuple(task_from_words(task) for task in words["tasks"]),
            tuple(stimulus_from_words(stimulus) for stimulus in words["stimuli"]),
            design_from_values(words["design"]),
            title=words["title"],
            consent=words["consent"],
        )
    except (ValueError, TypeError, KeyError, UnicodeError) as error:
        raise ValueError(
            f"{path}: expected a study as build_study writes it, {type(error).__name__}: {error}"
        ) from None
    if words.get("format") != _FORMAT or words.get("study") != study.id:
        raise ValueError(
            f"{path}: expected format {_FORMAT} and the study {study.id}, which its contents make, got "
            f"{words.get('format')!r} and {words.get('study')!r}; it was changed after it was written"
        )
    return study


def _check_folder(folder: Path, study: Study) -> None:
    """Raise where a folder has answers that belong to another study."""
    answers = sorted((folder / "data").glob("**/*.csv")) if (folder / "data").is_dir() else []
    if not answers:
        return
    known = read_study(folder).id if (folder / _STUDY).is_file() else "an unknown one"
    if known != study.id:
        raise ValueError(
            f"{folder} has {len(answers)} files of answers to another study, {known}, and this one is {study.id}; "
            "write to another folder, or move data/ away"
        )


def _encoded_study(study: Study) -> bytes:
    return json.dumps({"format": _FORMAT, "study": study.id, **study.words()}, indent=1).encode()


def _movies(study: Study) -> dict[str, Path]:
    """Return the movies that are stimuli, by where they go."""
    movies = {movie_file(study, one): Path(one.movie) for one in study.stimuli if one.movie is not None}
    missing = [str(movie) for movie in movies.values() if not movie.is_file()]
    if missing:
        raise FileNotFoundError(f"no such movies: {', '.join(missing[:10])}")
    return movies
