"""``eigenwalker study``: what people see in walks, from the page that asks them to a vector of their mean ratings."""

import argparse
from functools import partial
from pathlib import Path
from typing import Any

from eigenwalker.cli._numbers import count
from eigenwalker.cli._recordings import add_collecting_arguments, add_reading_arguments, add_recording_arguments
from eigenwalker.cli._study_report import report_answers
from eigenwalker.cli._study_stimuli import judged_stimuli, rated_stimuli, write_sources
from eigenwalker.experiment.running.study_files import FORMATS, build_study
from eigenwalker.experiment.stimulus import CONDITIONS, Stimulus
from eigenwalker.experiment.study import Study
from eigenwalker.experiment.tasks import (
    TASKS,
    NaturalnessTask,
    PairTask,
    RatingTask,
    RecognitionTask,
    ResemblanceTask,
    Task,
)

HELP = "ask people what they see in walks, and analyze what they say"
DESCRIPTION = (
    "Make a study of walks that people judge, as a page that runs in a browser without a network, and analyze their "
    "answers: ratings of traits (Troje 2002), naturalness beside an original (Tilmanne & Dutoit 2012), naturalness, "
    "recognition of styles and resemblance (Tilmanne, Moinet & Dutoit 2012)."
)

_TITLE = "How people walk"
_OBSERVERS = 3  # of a label group (Troje 2002, section 4)
_PARTICIPANTS = {"pair": 37, "naturalness": 100, "recognition": 100, "resemblance": 100}  # of the papers
_HELPS = {
    "rating": "how happy, nervous ... walkers seem, on buttons between two words",
    "pair": "how natural a synthetic walk is beside its original, from 0 to 4",
    "naturalness": "whether a walk is real or synthetic",
    "recognition": "which style a walk is in",
    "resemblance": "how much a synthetic walk resembles its original",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    new = actions.add_parser("new", help="make a study", description="Make a study: choose what people are asked.")
    tasks = new.add_subparsers(dest="task", required=True, metavar="TASK")
    for name, words in _HELPS.items():
        task = tasks.add_parser(name, help=words, description=f"Make a study of {words}.")
        (_add_rating_arguments if name == "rating" else partial(_add_test_arguments, name=name))(task)
        _add_study_arguments(task, name)
    analyze = actions.add_parser(
        "analyze",
        aliases=["analyse"],
        help="analyze the answers to a study",
        description="Print what people said, how reliable it is, and with which intervals. Mean ratings are written to "
        "traits.csv in the folder of the study, as labels for eigenwalker fit.",
    )
    analyze.add_argument("folder", type=Path, metavar="DIR", help="folder of the study, with answers in DIR/data")
    analyze.add_argument("--figures", action="store_true", help="draw figures as well, into DIR/figures")
    analyze.add_argument(
        "--standardize", action="store_true", help="turn the ratings of each observer into z-scores before averaging"
    )
    analyze.add_argument(
        "--adjust", action="store_true", help="account for who has not rated which walker, where ratings are missing"
    )


def _add_rating_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--walkers", required=True, nargs="+", type=Path, metavar="FILE", help="recordings, or movies")
    group = parser.add_argument_group("what people are asked")
    group.add_argument(
        "--labels",
        required=True,
        nargs="+",
        type=_pair_of_words,
        metavar="LOW,HIGH",
        help="words at both ends, such as sad,happy; ratings count towards the second. With several pairs, such as "
        "sad,happy relaxed,nervous, each participant is asked about one of them",
    )
    group.add_argument("--buttons", type=partial(count, least=2), default=6, metavar="N", help="how many (6)")
    group.add_argument(
        "--left",
        choices=("second", "first", "alternate"),
        default="second",
        help="which word stands at the leftmost button; alternate: another one for every other participant (second)",
    )
    group.add_argument(
        "--views",
        nargs="+",
        type=_view,
        metavar="VIEW",
        help="from where walkers are seen, one run of trials each: frontal, half-profile, side, or degrees (0 30 90)",
    )
    _add_trial_arguments(group)
    add_collecting_arguments(parser)
    add_recording_arguments(parser)


def _add_test_arguments(parser: argparse.ArgumentParser, *, name: str) -> None:
    walks = parser.add_argument_group("the walks", "Recordings as they are, or movies that end in .mp4.")
    walks.add_argument("--walkers", required=True, nargs="+", type=Path, metavar="FILE", help="original walks")
    walks.add_argument(
        "--synthetic", required=True, nargs="+", type=Path, metavar="FILE", help="walks that were made after them"
    )
    walks.add_argument("--average", type=Path, metavar="FILE", help="a walk of no style, made by an average model")
    source = walks.add_mutually_exclusive_group(required=True)
    source.add_argument("--labels-table", type=Path, metavar="CSV", help="table with the columns file and style")
    source.add_argument(
        "--label-pattern", metavar="REGEX", help="the style out of the file names, such as 'walk_(?P<style>[a-z]+)_'"
    )
    walks.add_argument(
        "--conditions",
        nargs="+",
        choices=CONDITIONS,
        help="in place, on the way over the floor, or each walk both ways (static displacement)",
    )
    walks.add_argument(
        "--markers", type=Path, metavar="MAP.json", help="which recorded markers make the 15, see eigenwalker fit"
    )
    group = parser.add_argument_group("what people are asked")
    group.add_argument("--trials", type=count, metavar="N", help="walks or pairs that a participant sees in a run")
    if name == "pair":
        group.add_argument("--series", type=count, default=3, metavar="N", help="runs of trials, with breaks (3)")
    group.add_argument(
        "--draw",
        choices=("random", "balanced"),
        default="random",
        help="which walks a participant sees: drawn at random, or dealt out, so that all are seen as often (random)",
    )
    _add_trial_arguments(group)
    add_reading_arguments(parser)
    parser.add_argument("--jobs", type=int, metavar="N", help="number of processes for reading")


def _add_trial_arguments(group: argparse._ArgumentGroup) -> None:
    least = partial(count, least=0)
    group.add_argument("--practice", type=least, default=0, metavar="N", help="trials before the first run (0)")
    group.add_argument(
        "--attention", type=least, default=0, metavar="N", help="trials in each run that ask for a given answer (0)"
    )


def _add_study_arguments(parser: argparse.ArgumentParser, name: str) -> None:
    group = parser.add_argument_group("the study")
    group.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder of the study")
    usual = f"{_PARTICIPANTS[name]}" if name in _PARTICIPANTS else f"{_OBSERVERS} for each pair of words"
    group.add_argument("--participants", type=count, metavar="N", help=f"how many ({usual})")
    group.add_argument("--title", default=_TITLE, help=f"title of the page ({_TITLE})")
    group.add_argument(
        "--consent", type=Path, metavar="FILE", help="plain text that participants agree to before they begin"
    )
    group.add_argument(
        "--seed", type=partial(count, least=0), default=0, metavar="N", help="of all orders and draws (0)"
    )
    group.add_argument(
        "--formats",
        nargs="+",
        choices=FORMATS,
        default=["page", "jatos"],
        help="a page, an archive for JATOS, tables and movies for PsychoPy, which take minutes (page jatos)",
    )


def run(options: argparse.Namespace) -> None:
    """Make or analyze a study."""
    if options.action != "new":
        report_answers(options.folder, figures=options.figures, standardize=options.standardize, adjust=options.adjust)
        return
    consent = "" if options.consent is None else options.consent.read_text(encoding="utf-8").strip()
    stimuli, sources = (rated_stimuli if options.task == "rating" else judged_stimuli)(options)
    tasks = _rating_tasks(options, stimuli) if options.task == "rating" else [_test(options)]
    study = build_study(
        tasks,
        walks=stimuli,
        n_participants=options.participants or _PARTICIPANTS.get(options.task, _OBSERVERS * len(tasks)),
        out=options.out,
        random_state=options.seed,
        title=options.title,
        consent=consent,
        formats=options.formats,
        n_jobs=options.jobs,
    )
    write_sources(options.out / "walks.csv", stimuli, sources)
    _describe(study, options)


def _rating_tasks(options: argparse.Namespace, stimuli: list[Stimulus]) -> list[Task]:
    views = options.views
    if any(stimulus.movie is not None for stimulus in stimuli):
        if views is not None and len(views) > 1:
            raise ValueError("movies show walkers from where they were filmed; leave --views out")
        views = views or [0.0]
    given: dict[str, Any] = {} if views is None else {"views": views}
    settings = {"n_practice": options.practice, "n_attention": options.attention, "left": options.left}
    return [RatingTask(poles, n_buttons=options.buttons, **settings, **given) for poles in options.labels]


def _test(options: argparse.Namespace) -> Task:
    settings = {"n_practice": options.practice, "n_attention": options.attention, "draw": options.draw}
    if options.trials is not None:
        settings["n_trials"] = options.trials
    if options.task == "pair":
        settings["n_series"] = options.series
    kind: type[PairTask] | type[NaturalnessTask] | type[RecognitionTask] | type[ResemblanceTask] = TASKS[options.task]
    return kind(**settings)


def _describe(study: Study, options: argparse.Namespace) -> None:
    """Print what there is, and what comes next."""
    runs = study.design.groupby(["participant", "session"]).size()
    n_runs, longest = runs.groupby("participant").size().max(), runs.max()
    print(
        f"study {study.id}: {len(study.stimuli)} walks, {study.n_participants} participants; each has "
        f"{_counted(n_runs, 'run')} of {'up to ' if runs.nunique() > 1 else ''}{_counted(longest, 'trial')}"
    )
    observers = study.design[study.design["task"] == RatingTask.name].groupby("trait")["participant"].nunique()
    if len(observers):
        print("  observers: " + ", ".join(f"{number} of {trait!r}" for trait, number in observers.items()))
    if (observers < 2).any():
        print("  a single observer's ratings have no reliability; ask for more with --participants")
    print(f"wrote {options.out}")
    if "page" in options.formats:
        print(f"  open {options.out / 'index.html'} in a browser, and choose the number of the participant")
    if "jatos" in options.formats:
        print(f"  or import {options.out / 'study.jzip'} into JATOS")
    if "psychopy" in options.formats:
        print(f"  or use the tables and movies in {options.out / 'psychopy'}")
    print(f"put the answers, a CSV file of each participant, into {options.out / 'data'}; then")
    print(f"  eigenwalker study analyze {options.out}")


def _counted(number: int, word: str) -> str:
    return f"{number} {word}" if number == 1 else f"{number} {word}s"


def _pair_of_words(text: str) -> tuple[str, str]:
    words = [word.strip() for word in text.split(",")]
    if len(words) != 2 or not all(words) or words[0] == words[1]:
        raise argparse.ArgumentTypeError(
            f"expected two different words with a comma between them, such as sad,happy, got {text!r}"
        )
    return words[0], words[1]


def _view(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text
