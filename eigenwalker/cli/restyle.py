"""``eigenwalker restyle``: a BVH file changed along trait axes, and in nothing else."""

import argparse
from pathlib import Path

from eigenwalker.cli._alphas import add_alpha_argument, parse_alphas
from eigenwalker.cli._marker_map import read_marker_map
from eigenwalker.cli._recordings import add_reading_arguments
from eigenwalker.cli._trait_model import load_trait_model
from eigenwalker.io.bvh import read_bvh
from eigenwalker.io.bvh_rewriter import rewrite_bvh
from eigenwalker.model.restyling import restyle_walk

_ENDING = ".bvh"

HELP = "change a BVH file along trait axes, and nothing else of it"
DESCRIPTION = (
    "Move the walk in a BVH file along trait axes, by --alpha from where it is; eigenwalker walk makes one that is at "
    "--alpha. Hierarchy, names, channels, frame rate, path, joints that the model does not know, such as fingers, and "
    "what no model says of the motion are kept. It needs a model of joint angles, eigenwalker fit --representation "
    "joints."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("file", type=Path, metavar="FILE", help=f"the recording, a {_ENDING} file")
    parser.add_argument("--model", required=True, type=Path, metavar="MODEL", help="from eigenwalker fit")
    add_alpha_argument(
        parser, help="step along an axis, in SD: how much more of it than the recording has; may be repeated"
    )
    parser.add_argument(
        "--hold", action="append", default=[], metavar="TRAIT", help="trait that stays as it is; may be repeated"
    )
    parser.add_argument(
        "--keep-cadence", action="store_true", help="let strides last as long as they do: as many frames as in FILE"
    )
    parser.add_argument("--out", required=True, type=Path, metavar="FILE", help=f"ends in {_ENDING}")
    parser.add_argument(
        "--markers",
        type=Path,
        metavar="MAP.json",
        help='which joints make the 15 markers, {"head": "Head", "left_knee": "LeftLeg", ...}, as in eigenwalker fit',
    )
    add_reading_arguments(parser)


def run(options: argparse.Namespace) -> None:
    """Change the recording and write it."""
    _check(options)
    alphas = parse_alphas(options.alpha)
    model = load_trait_model(options.model)
    rig = read_marker_map(options.markers) if options.markers is not None else None
    unit, up = "cm" if options.unit is None else options.unit, options.up or "y"
    walk = read_bvh(options.file, unit=unit, up=up, frame_rate=options.frame_rate)
    restyled = restyle_walk(model, walk, alphas, hold=options.hold, keep_cadence=options.keep_cadence, rig=rig)
    rewrite_bvh(restyled, options.file, options.out, unit=unit, up=up)
    moved = ", ".join(f"{trait} by {alpha:+g}" for trait, alpha in alphas.items())
    print(f"wrote {options.out}: {walk.name}, {moved}, {restyled.n_frames} frames in place of {walk.n_frames}")


def _check(options: argparse.Namespace) -> None:
    """Raise before all the reading if files are of other kinds, or the recording would be lost."""
    faults = [
        f"{name} must end in {_ENDING}, got {path.name}"
        for name, path in (("FILE", options.file), ("--out", options.out))
        if path.suffix.lower() != _ENDING
    ]
    if options.out.exists() and options.file.exists() and options.out.samefile(options.file):
        faults.append(f"--out must be another file than the recording, got {options.out}, which would be replaced")
    if faults:
        raise ValueError("; ".join(faults))
