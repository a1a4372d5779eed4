"""``eigenwalker walk``: a walk from a model."""

import argparse
from pathlib import Path

from eigenwalker.cli._recordings import add_reading_arguments, load, reading_options
from eigenwalker.display.plotting import StickFigureDisplay
from eigenwalker.io.formats import WRITERS, find_ending, write_walk
from eigenwalker.model.eigenwalkers import walk_at
from eigenwalker.persistence import load_model

_PICTURE = ".png"

HELP = "make a walk with a given position on trait axes"
DESCRIPTION = "Make the walk with the given alpha on trait axes, from the average walker or from a recording."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("model", type=Path, metavar="MODEL", help="from eigenwalker fit")
    parser.add_argument(
        "--alpha", required=True, action="append", metavar="TRAIT=VALUE", help="position on an axis; may be repeated"
    )
    parser.add_argument("--base", type=Path, metavar="FILE", help="recording to change, instead of the average walker")
    endings = ", ".join(f"walk{ending}" for ending in sorted(WRITERS))
    parser.add_argument(
        "--out", required=True, type=Path, metavar="FILE", help=f"{endings}, or walk{_PICTURE} for a picture"
    )
    add_reading_arguments(parser)


def run(options: argparse.Namespace) -> None:
    """Make the walk and write it."""
    is_picture = options.out.suffix.lower() == _PICTURE
    if not is_picture and find_ending(options.out, WRITERS) is None:
        raise ValueError(f"--out must end in {', '.join(sorted(WRITERS))} or {_PICTURE}, got {options.out.name}")
    alphas = dict(_parse_alpha(text) for text in options.alpha)
    model = load_model(options.model)
    base = None
    if options.base is not None:
        (base,), refusals = load([options.base], reading=reading_options(options), markers=options.markers)
        if refusals:
            raise ValueError(refusals[0].reason)
    walk = walk_at(model, alphas, base)
    if is_picture:
        StickFigureDisplay.from_walks([walk]).figure_.savefig(options.out, dpi=150)
    else:
        write_walk(walk, options.out)
    print(f"wrote {options.out}: {walk.name}, {walk.n_frames} frames at {walk.frame_rate:g} a second")


def _parse_alpha(text: str) -> tuple[str, float]:
    trait, equals, value = text.rpartition("=")
    try:
        if equals and trait:
            return trait, float(value)
    except ValueError:
        pass
    raise ValueError(f"--alpha must be TRAIT=NUMBER, such as gender=2, got {text!r}")
