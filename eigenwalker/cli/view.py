"""``eigenwalker view``: walkers that move, with sliders, as a page."""

import argparse
from pathlib import Path

from eigenwalker.cli._recordings import add_collecting_arguments, add_recording_arguments, list_reasons, load
from eigenwalker.cli._trait_model import load_trait_model
from eigenwalker.display.walker_view import view
from eigenwalker.io.formats import READERS, find_ending
from eigenwalker.motion.walk import Walk

HELP = "write a page of moving walkers with sliders"
DESCRIPTION = (
    "Write a page of a model's walkers with a slider for each trait; recordings that are named behind the model can be "
    "loaded on it. Without a model, write a page of the recordings side by side."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "files", nargs="+", type=Path, metavar="MODEL|FILE", help="a model from eigenwalker fit, and recordings"
    )
    parser.add_argument("-o", "--out", required=True, type=Path, metavar="PAGE", help="file for the page, walker.html")
    parser.add_argument("--title", help="title of the page (the names of the traits)")
    add_collecting_arguments(parser)
    add_recording_arguments(parser)


def run(options: argparse.Namespace) -> None:
    """Read the model and the recordings, and write the page."""
    if options.out.suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"--out must end in .html, got {options.out.name}")
    recordings = [path for path in options.files if find_ending(path, READERS)]
    models = [path for path in options.files if path not in recordings]
    if len(models) > 1:
        raise ValueError(
            f"expected at most one model, and recordings that end in {', '.join(sorted(READERS))}, got "
            f"{', '.join(map(str, models))}"
        )
    model = load_trait_model(models[0]) if models else None
    walks = _load_walks(recordings, options)
    page = view(walks, title=options.title) if model is None else view(model, walks or None, title=options.title)
    page.save(options.out)
    print(f"wrote {options.out}: open it in a browser")


def _load_walks(paths: list[Path], options: argparse.Namespace) -> list[Walk]:
    """Return the prepared recordings; those that are refused may be left out, if the user says so."""
    if not paths:
        return []
    loaded = load(paths, options, n_jobs=options.jobs)
    walks = [walk for walk in loaded.walks if walk is not None]
    if loaded.refusals and not (options.skip_bad and walks):
        advice = "" if options.skip_bad else "; mend them, or leave them out with --skip-bad"
        reasons = list_reasons(loaded.refusals)
        raise ValueError(f"{len(loaded.refusals)} of {len(loaded.walks)} recordings were refused{advice}:\n{reasons}")
    if loaded.refusals:
        print(list_reasons(loaded.refusals))
    return walks
