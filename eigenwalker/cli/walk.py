"""``eigenwalker walk``: a walk from a model."""

import argparse
from pathlib import Path

from eigenwalker.cli._recordings import add_recording_arguments, list_reasons, load
from eigenwalker.display.plotting import StickFigureDisplay
from eigenwalker.io.formats import WRITERS, find_ending, write_walk
from eigenwalker.model.generation import walk_at
from eigenwalker.motion.strides import pool_walks
from eigenwalker.motion.walk import Walk
from eigenwalker.persistence import load_model

_PICTURE = ".png"
_ENDINGS = sorted({*WRITERS, _PICTURE} - {".bvh"})  # BVH holds joints; what the command makes are markers

HELP = "make a walk with a given position on trait axes"
DESCRIPTION = "Make the walk with the given alpha on trait axes, from the average walker or from a recording."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("model", type=Path, metavar="MODEL", help="from eigenwalker fit")
    parser.add_argument(
        "--alpha", required=True, action="append", metavar="TRAIT=VALUE", help="position on an axis; may be repeated"
    )
    parser.add_argument(
        "--base",
        type=Path,
        metavar="FILE",
        help="recording to change, instead of the average walker; it needs the arguments that the recordings of the "
        "model had, and with --passes all its passes together are the base",
    )
    parser.add_argument(
        "--out",
        required=True,
        type=Path,
        metavar="FILE",
        help=f"ends in {', '.join(_ENDINGS)}; {_PICTURE} is a picture",
    )
    add_recording_arguments(parser)


def run(options: argparse.Namespace) -> None:
    """Make the walk and write it."""
    ending = find_ending(options.out, dict.fromkeys(_ENDINGS))
    if ending is None:
        raise ValueError(f"--out must end in {', '.join(_ENDINGS)}, got {options.out.name}")
    alphas = dict(_parse_alpha(text) for text in options.alpha)
    model = load_model(options.model)
    walk = walk_at(model, alphas, None if options.base is None else _load_base(options))
    if ending == _PICTURE:
        StickFigureDisplay.from_walks([walk]).figure_.savefig(options.out, dpi=150)
    else:
        write_walk(walk, options.out)
    print(f"wrote {options.out}: {walk.name}, {walk.n_frames} frames at {walk.frame_rate:g} a second")


def _load_base(options: argparse.Namespace) -> Walk:
    """Return the recording, or its passes put together."""
    loaded = load([options.base], options)
    walks = [walk for walk in loaded.walks if walk is not None]
    if loaded.refusals:
        raise ValueError(f"--base was refused:\n{list_reasons(loaded.refusals)}")
    return walks[0] if len(walks) == 1 else pool_walks(walks, [options.base.stem] * len(walks))[0]


def _parse_alpha(text: str) -> tuple[str, float]:
    trait, equals, value = text.rpartition("=")
    try:
        if equals and trait:
            return trait, float(value)
    except ValueError:
        pass
    raise ValueError(f"--alpha must be TRAIT=NUMBER, such as gender=2, got {text!r}")
