"""What people said in a study: printed, drawn, and written as labels."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd

from eigenwalker.display.ratings_display import RatingsDisplay
from eigenwalker.experiment.analysis.naturalness_answers import naturalness_report
from eigenwalker.experiment.analysis.recognition_answers import recognition_report
from eigenwalker.experiment.analysis.report_text import estimate_cell, text_table
from eigenwalker.experiment.analysis.score_answers import pair_report, resemblance_report
from eigenwalker.experiment.analysis.trials import trials_of
from eigenwalker.experiment.answers.files import read_answers
from eigenwalker.experiment.ratings.intervals import mean_ratings
from eigenwalker.experiment.ratings.reliability import reliability_table
from eigenwalker.experiment.ratings.traits import rating_counts, ratings_to_traits
from eigenwalker.experiment.running.study_files import read_study
from eigenwalker.experiment.study import Study
from eigenwalker.experiment.tasks import RatingTask

__all__ = ["report_answers"]

_COEFFICIENTS = {
    "icc_single": "one observer, ICC(2,1)",
    "icc_mean": "the mean of these observers, ICC(2,k)",
    "split_half": "the same, split halves",
    "view_icc": "one viewpoint, ICC(3,1)",
}
_PLOTS = ("plot_shares", "plot_rates", "plot_confusions", "plot_scores", "plot_means")


def report_answers(folder: Path, *, figures: bool, standardize: bool, adjust: bool) -> None:
    """Print what was answered in a study; write mean ratings, and maybe figures.

    Parameters
    ----------
    folder : Path
        Of the study.
    figures : bool
        Whether figures are drawn.
    standardize, adjust : bool
        Of `ratings_to_traits`.

    Raises
    ------
    ValueError, OSError
        If there is no study, or there are no answers, or they are not as they should be.
    """
    study = read_study(folder)
    _check_answers(folder, study)
    answers = read_answers(folder, study=study)
    asked, answered = study.n_participants, answers["participant"].nunique()
    print(f"{study.title} (study {study.id}): {answered} of {asked} participants, {len(answers)} answers")
    waiting = sorted(set(study.design["participant"]) - set(answers["participant"]))
    if waiting:
        print(f"no answers yet of: {', '.join(map(str, waiting[:20]))}{' ...' if len(waiting) > 20 else ''}")
    drawn: dict[str, Any] = {}
    for name in dict.fromkeys(task.name for task in study.tasks):
        print()
        trials = answers[(answers["task"] == name) & (answers["part"] == "main") & (answers["answer"] != "")]
        if not len(trials):
            print(f"{name}: no answers yet")
        elif name == RatingTask.name:
            drawn |= _report_ratings(folder, study, answers, standardize=standardize, adjust=adjust)
        else:
            drawn |= _report_test(study, name, answers)
    if figures:
        _save(folder / "figures", drawn)


def _check_answers(folder: Path, study: Study) -> None:
    data = folder / "data"
    if not any(file.is_file() and not file.name.startswith(".") for file in data.rglob("*")):
        raise ValueError(
            f"no answers yet: put what participants downloaded, study-{study.id}_participant-1_data.csv and so on, or "
            f"results of JATOS, into {data}"
        )


def _report_ratings(
    folder: Path, study: Study, answers: pd.DataFrame, *, standardize: bool, adjust: bool
) -> dict[str, Any]:
    """Print how reliable ratings are, write the mean ones, and return what draws them."""
    print(f"Ratings: {trials_of(answers, RatingTask.name).in_words()}\n")
    _print_reliability(answers)
    tasks = [task for task in study.tasks if isinstance(task, RatingTask)]
    names = [stimulus.name for stimulus in study.stimuli]
    labels = ratings_to_traits(answers, walks=names, standardize=standardize, adjust=adjust)
    labels.rename_axis("file").to_csv(folder / "traits.csv", lineterminator="\n")
    counts = rating_counts(answers, walks=names)
    print()
    for task in tasks:
        if task.trait in labels:
            found, number = labels[task.trait], counts[task.trait]
            span = f"{number.min()}" if number.nunique() == 1 else f"{number.min()} to {number.max()}"
            print(
                f"{task.trait}: mean ratings from {found.min():.2f} to {found.max():.2f}, towards {task.poles[1]!r}; "
                f"{span} ratings a walker"
            )
    print(f"wrote {folder / 'traits.csv'}; learn what goes along with it with:")
    print(f"  eigenwalker fit FILE ... --labels {folder / 'traits.csv'} --trait {labels.columns[0]} --out my.skops")
    return {f"rating_{task.trait}": _drawing(task, answers) for task in tasks if task.trait in labels}


def _drawing(task: RatingTask, answers: pd.DataFrame) -> Callable[[], Any]:
    def draw() -> RatingsDisplay:
        scale = (1.0, float(task.n_buttons))
        ratings = mean_ratings(answers[answers["trait"] == task.trait], scale=scale)
        return RatingsDisplay.from_frames(*ratings, poles={task.trait: task.poles}, scale=scale)

    return draw


def _print_reliability(answers: pd.DataFrame) -> None:
    """Print the coefficients of each trait, of the observers who have rated all walkers."""
    for trait, own in answers[answers["task"] == RatingTask.name].groupby("trait"):
        try:
            row = reliability_table(own, missing="drop_observers", random_state=0).iloc[0]
        except ValueError as error:
            print(f"Reliability of {trait}: not known yet; {error}")
            continue
        n_observers, n_views, n_walkers, left_out = (
            int(row[f"n_{what}"]) for what in ("observers", "views", "walkers", "observers_left_out")
        )
        without = f"; {left_out} more have not rated all of them" if left_out else ""
        print(f"Reliability of {trait}: {n_observers} observers, {n_views} viewpoints, {n_walkers} walkers{without}")
        cells = {
            words: {"value": estimate_cell(row[[name, f"{name}_low", f"{name}_high"]])}
            for name, words in _COEFFICIENTS.items()
        }
        print(text_table(cells))
    print("Intervals of 95 %.")


def _report_test(study: Study, name: str, answers: pd.DataFrame) -> dict[str, Callable[[], Any]]:
    """Print the report on a test, and return what draws it."""
    task = study.task_of(name)
    reports: dict[str, Callable[[], Any]] = {
        "pair": lambda: pair_report(answers, scale=getattr(task, "scale", ())),
        "naturalness": lambda: naturalness_report(answers),
        "recognition": lambda: recognition_report(answers, n_choices=len(task.buttons)),
        "resemblance": lambda: resemblance_report(answers),
    }
    report = reports[name]()
    print(report)
    drawings = {plot: getattr(report, plot) for plot in _PLOTS if hasattr(report, plot)}
    return {f"{name}_{plot.removeprefix('plot_')}": draw for plot, draw in drawings.items()}


def _save(folder: Path, drawings: dict[str, Callable[[], Any]]) -> None:
    folder.mkdir(exist_ok=True)
    print()
    for name, draw in drawings.items():
        path = folder / f"{name}.png"
        draw().figure_.savefig(path, dpi=150)
        print(f"wrote {path}")
