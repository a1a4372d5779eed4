"""``eigenwalker style``: a new walk in a style, of which there are a dozen recorded steps."""

import argparse
import sys
from contextlib import redirect_stdout
from functools import partial
from pathlib import Path

import numpy as np

from eigenwalker.cli._numbers import count, finite, not_negative, positive
from eigenwalker.cli._recordings import add_collecting_arguments, add_reading_arguments, reading_options
from eigenwalker.cli._skeleton import in_skeleton_of
from eigenwalker.cli._style_recordings import StyleWalks, load_style_walks, read_walkers
from eigenwalker.hsmm.adaptation import METHODS
from eigenwalker.hsmm.gait_hsmm import GaitHSMM
from eigenwalker.hsmm.style_blend import blend
from eigenwalker.io.formats import write_walk
from eigenwalker.motion.limits import warn_joint_limits
from eigenwalker.motion.walk import JointWalk
from eigenwalker.motion.walk_measures import quality_table
from eigenwalker.persistence import save_model

_ENDINGS = (".bvh", ".npz")  # of files that hold joints
_OF_ADAPTATION = ("method", "transform_weight", "map_weight", "classes", "weight")

HELP = "make a walk in a style, from a dozen steps of it"
DESCRIPTION = (
    "Train a gait model of the average walk on FILE ..., a hidden semi-Markov model of joint angles (Tilmanne, Moinet "
    "& Dutoit 2012), adapt it to the few steps in the files of --adapt, and write a new walk that starts, goes and "
    "stops. Without --adapt it is the average walk. Recordings need a skeleton, as BVH files have one."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="recordings of the average walk")
    parser.add_argument(
        "--adapt", nargs="+", type=Path, metavar="FILE", help="recordings of the style, about a dozen steps in all"
    )
    parser.add_argument(
        "--out", required=True, type=Path, metavar="FILE", help=f"for the walk; ends in {' or '.join(_ENDINGS)}"
    )
    parser.add_argument(
        "--save", type=Path, metavar="MODEL", help="file for the model that makes the walk, such as sad.skops"
    )
    _add_model_arguments(parser.add_argument_group("the model"))
    _add_walk_arguments(parser.add_argument_group("the walk"))
    add_reading_arguments(parser, frame_rate=False)
    add_collecting_arguments(parser)


def _add_model_arguments(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--frame-rate",
        dest="rate",
        type=positive,
        default=60.0,
        metavar="HZ",
        help="frames per second of the model and the walk, to which all recordings are resampled (60)",
    )
    group.add_argument(
        "--walkers",
        type=Path,
        metavar="CSV",
        help="table with the columns file and walker, of the recordings of the average walk: what people differ in is "
        "then kept out of it (walker-adaptive training)",
    )
    group.add_argument("--method", choices=METHODS, help=f"how the model is adapted ({METHODS[0]})")
    group.add_argument(
        "--transform-weight",
        type=not_negative,
        metavar="W",
        help="of the prior of transforms (of 1 to 10000 the best on walks held out; 1000 for a single walk)",
    )
    group.add_argument(
        "--map-weight",
        type=not_negative,
        metavar="W",
        help="of the prior of MAP (of 3 to 100 the best on walks held out; 30 for a single walk)",
    )
    group.add_argument("--classes", type=count, metavar="N", help="most classes of states with own transforms (1)")
    group.add_argument(
        "--weight",
        type=finite,
        metavar="W",
        help="between the average walk, 0, and the style, 1; beyond 1 the style is exaggerated, below 0 reversed (1)",
    )


def _add_walk_arguments(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--steps", type=count, default=12, metavar="N", help="number of steps (12)")
    group.add_argument("--first", choices=("right", "left"), default="right", help="foot of the first step (right)")
    group.add_argument(
        "--durations",
        choices=("mean", "sample"),
        default="mean",
        help="how long states last: most likely, or drawn, so that steps differ (mean)",
    )
    group.add_argument(
        "--seed", type=partial(count, least=0), metavar="N", help="of --durations sample (another walk every time)"
    )
    group.add_argument(
        "--global-variance",
        choices=("exact", "none"),
        default="exact",
        help="whether angles vary as much as in recordings, or less, as in the most likely walk (exact)",
    )
    group.add_argument(
        "--speed", type=positive, default=1.0, metavar="FACTOR", help="how much faster than the model it steps (1)"
    )
    group.add_argument("--in-place", action="store_true", help="let it stay in place, as on a treadmill")
    group.add_argument(
        "--skeleton",
        type=Path,
        metavar="FILE",
        help="a recording whose skeleton is written, its bones and the axes of its joints, so that the walk moves that "
        "character (the first recording's, standing upright where all rotations are zero)",
    )


def run(options: argparse.Namespace) -> None:
    """Train, adapt, make the walk and write it."""
    _check(options)
    walkers = None if options.walkers is None else read_walkers(options.walkers, options.files)
    average, style = load_style_walks(options.files, options.adapt or [], options)
    model = _train(average, None if walkers is None else [walkers[file] for file in average.files], options.rate)
    if options.adapt is not None:
        adapted = _adapt(model, style, options)
        model = adapted if options.weight in (None, 1.0) else blend(model, adapted, options.weight)
    walk = model.synthesize(
        options.steps,
        first=options.first,
        global_variance=None if options.global_variance == "none" else options.global_variance,
        durations=options.durations,
        speed=options.speed,
        random_state=options.seed,
        name=options.out.stem,
        travel=not options.in_place,
    )
    assert isinstance(walk, JointWalk)  # as those that the model was trained on
    _write(walk, options)
    if options.save is not None:
        save_model(model, options.save)
        print(f"saved {options.save}")


def _check(options: argparse.Namespace) -> None:
    """Raise before all the reading if arguments do not go together, or files would be lost or could not be written."""
    faults = []
    if options.out.suffix.lower() not in _ENDINGS:
        faults.append(f"--out must end in {' or '.join(_ENDINGS)}, files that hold joints, got {options.out.name}")
    if options.skeleton is not None and options.out.suffix.lower() != ".bvh":
        faults.append("--skeleton is for --out that ends in .bvh")
    given = [f"--{name.replace('_', '-')}" for name in _OF_ADAPTATION if getattr(options, name) is not None]
    if given and options.adapt is None:
        faults.append(f"{', '.join(given)}: what is adapted, and to what? give recordings of a style, --adapt FILE ...")
    method = options.method or METHODS[0]
    if options.transform_weight is not None and not method.startswith("csmaplr"):
        faults.append(f"--transform-weight is for csmaplr, whose transforms have a prior, not for --method {method}")
    if options.map_weight is not None and not method.endswith("map"):
        faults.append(f"--map-weight is for a method with map, got --method {method}")
    faults += _output_faults(options)
    if faults:
        raise ValueError("; ".join(faults))


def _output_faults(options: argparse.Namespace) -> list[str]:
    faults = []
    others = [*options.files, *(options.adapt or []), *filter(None, (options.skeleton, options.walkers))]
    for name, path in (("--out", options.out), ("--save", options.save)):
        if path is None:
            continue
        if not path.parent.is_dir():
            faults.append(f"{name}: expected a folder that is there, got {path.parent}")
        if path.exists() and any(other.exists() and path.samefile(other) for other in others):
            faults.append(f"{name} must be another file than those that are read, got {path}, which would be replaced")
    return faults


def _train(average: StyleWalks, walkers: list[str] | None, frame_rate: float) -> GaitHSMM:
    people = "" if walkers is None else f" of {len(set(walkers))} people"
    counts = f"{len(average.walks)} walks{people}, {average.n_steps} steps"
    print(f"average: {counts}, {frame_rate:g} frames a second", flush=True)
    with redirect_stdout(sys.stderr):
        model = GaitHSMM(frame_rate=frame_rate, verbose=True).fit(average.walks, walkers=walkers)
    until = "converged" if model.converged_ else "stopped"
    print(f"  log-likelihood per frame {model.history_[-1]:.1f}, {until} after {model.n_iter_} iterations")
    return model.set_params(verbose=False)


def _adapt(model: GaitHSMM, style: StyleWalks, options: argparse.Namespace) -> GaitHSMM:
    print(f"style: {len(style.walks)} walks, {style.n_steps} steps", flush=True)
    adapted = model.adapt(
        style.walks,
        method=options.method or METHODS[0],
        transform_weight=options.transform_weight,
        map_weight=options.map_weight,
        n_classes=options.classes or 1,
    )
    report = adapted.adaptation_
    method = report["method"]
    weights = [f"weight of transforms {report['transform_weight']:g}"] if method.startswith("csmaplr") else []
    weights += [f"weight of MAP {report['map_weight']:g}"] if method.endswith("map") else []
    print(f"  {', '.join([method, *weights])}, classes of states {report['n_classes']}")
    if report["held_out"]:
        best = max(score for *_, score in report["held_out"])
        before = "" if model.is_canonical_ else f", by the average model {model.score(style.walks):.1f}"
        trials = f"the best of {len(report['held_out'])} trials of weights"
        print(f"  log-likelihood per frame of walks held out {best:.1f}, {trials}{before}")
    return adapted


def _write(walk: JointWalk, options: argparse.Namespace) -> None:
    """Write the walk, and print how it goes over the floor."""
    warn_joint_limits([walk])
    measured = quality_table([walk]).iloc[0]
    slip = f", feet slip {1000 * measured['foot_slip_m_per_step']:.1f} mm a step" if measured["n_steps"] else ""
    if options.skeleton is not None:
        walk = in_skeleton_of(options.skeleton, walk, reading=reading_options(options))
    write_walk(walk, options.out)
    speed = measured["speed_m_per_s"]
    pace = f", {speed:.2f} m/s" if np.isfinite(speed) else ""
    print(
        f"wrote {options.out}: {options.steps} steps, {walk.n_frames} frames at {walk.frame_rate:g} a second"
        f"{pace}{slip}"
    )
