"""``eigenwalker walk``: a walk from a model."""

import argparse
from dataclasses import replace
from pathlib import Path

from eigenwalker.cli._alphas import add_alpha_argument, parse_alphas
from eigenwalker.cli._recordings import add_recording_arguments, list_reasons, load, reading_options
from eigenwalker.cli._skeleton import in_skeleton_of
from eigenwalker.cli._trait_model import load_trait_model
from eigenwalker.display.plotting import StickFigureDisplay
from eigenwalker.io.formats import WRITERS, find_ending, write_walk
from eigenwalker.model.generation import walk_at
from eigenwalker.motion.strides import pool_walks
from eigenwalker.motion.walk import JointWalk, Walk

_PICTURE = ".png"
_ENDINGS = sorted({*WRITERS, _PICTURE})
_OF_JOINTS = (".bvh", ".npz")  # other files hold markers

HELP = "make a walk with a given position on trait axes"
DESCRIPTION = (
    "Make the walk with the given alpha on trait axes, from the average walker or from a recording. A model of joint "
    "angles, eigenwalker fit --representation joints, writes BVH."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("model", type=Path, metavar="MODEL", help="from eigenwalker fit")
    add_alpha_argument(parser, help="position on an axis; may be repeated")
    parser.add_argument(
        "--base",
        type=Path,
        metavar="FILE",
        help="recording to change, instead of the average walker; it needs the arguments that the recordings of the "
        "model had, and with --passes all its passes together are the base",
    )
    parser.add_argument(
        "--skeleton",
        type=Path,
        metavar="FILE",
        help="for BVH: a file with the skeleton to be written, its bones and the axes of its joints (that of --base; "
        "else the model's, standing upright where all rotations are zero)",
    )
    parser.add_argument(
        "--out",
        required=True,
        type=Path,
        metavar="FILE",
        help=f"ends in {', '.join(_ENDINGS)}; {_PICTURE} is a picture, .bvh for models of joint angles",
    )
    add_recording_arguments(parser)


def run(options: argparse.Namespace) -> None:
    """Make the walk and write it."""
    ending = find_ending(options.out, dict.fromkeys(_ENDINGS))
    if ending is None:
        raise ValueError(f"--out must end in {', '.join(_ENDINGS)}, got {options.out.name}")
    alphas = parse_alphas(options.alpha)
    model = load_trait_model(options.model)
    template = model["linearizer"].template_
    has_joints = isinstance(template, JointWalk)
    _check(options, ending, has_joints=has_joints)
    options.representation = "joints" if has_joints else "markers"
    base = None if options.base is None else _load_base(options, template)
    walk = walk_at(model, alphas, base)
    skeleton = options.skeleton or options.base
    if isinstance(walk, JointWalk) and ending == ".bvh" and skeleton is not None:
        walk = in_skeleton_of(skeleton, walk, reading=reading_options(options))
    elif isinstance(walk, JointWalk) and ending not in _OF_JOINTS:
        walk = walk.to_markers()
    if ending == _PICTURE:
        StickFigureDisplay.from_walks([walk]).figure_.savefig(options.out, dpi=150)
    else:
        write_walk(walk, options.out)
    print(f"wrote {options.out}: {walk.name}, {walk.n_frames} frames at {walk.frame_rate:g} a second")


def _check(options: argparse.Namespace, ending: str, *, has_joints: bool) -> None:
    faults = []
    if ending == ".bvh" and not has_joints:
        faults.append(
            f"--out: a BVH file holds joints, and {options.model} is a model of markers; learn one with "
            f"eigenwalker fit --representation joints, or write {', '.join(e for e in _ENDINGS if e != '.bvh')}"
        )
    if options.skeleton is not None and (ending != ".bvh" or not has_joints):
        faults.append("--skeleton is for models of joint angles and --out that ends in .bvh")
    if faults:
        raise ValueError("; ".join(faults))


def _load_base(options: argparse.Namespace, template: Walk | JointWalk) -> Walk | JointWalk:
    """Return the recording, or its passes put together, with the channels of the model."""
    loaded = load([options.base], options)
    walks = [walk for walk in loaded.walks if walk is not None]
    if loaded.refusals:
        raise ValueError(f"--base was refused:\n{list_reasons(loaded.refusals)}")
    if isinstance(template, JointWalk):
        (walk,) = walks
        if walk.skeleton.joint_names == template.skeleton.joint_names:
            return replace(walk, channel_joints=template.channel_joints)
        return walk  # which the model refuses, with the names
    return walks[0] if len(walks) == 1 else pool_walks(walks, [options.base.stem] * len(walks))[0]
