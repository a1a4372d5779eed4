"""How recordings named on the command line become walks: the arguments, and what they do to one recording."""

import argparse
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from eigenwalker._validation import WalkError
from eigenwalker.cli._marker_map import read_marker_map
from eigenwalker.cli._numbers import positive
from eigenwalker.io.formats import read_walk
from eigenwalker.motion.fourier import FREQUENCY_RANGE
from eigenwalker.motion.gaps import fill_gaps
from eigenwalker.motion.passes import split_passes
from eigenwalker.motion.rig import Rig, sources
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.skeleton import FEET
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["Preparation", "add_preparation_arguments", "find_walks", "make_preparation"]


@dataclass(frozen=True)
class Preparation:
    """What becomes of every recording.

    Parameters
    ----------
    rig : Rig, default None
        Which recorded markers make the 15; None recognises known sets.
    static : Walk, default None
        The static trial of the person in all recordings.
    max_gap : float, default None
        Longest gap that is filled, in seconds; None fills none.
    passes : bool, default False
        Whether recordings are split at turns and stops.
    feet : bool, default False
        Whether markers of heels and toes are kept where there are any.
    joints : bool, default False
        Whether walks are those of joint angles.
    options : dict, default empty
        Arguments of `prepare`.
    """

    rig: Rig | None = None
    static: Walk | None = None
    max_gap: float | None = None
    passes: bool = False
    feet: bool = False
    joints: bool = False
    options: dict[str, Any] = field(default_factory=dict)


def add_preparation_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments that say how recordings become walks."""
    group = parser.add_argument_group("from recordings to walks")
    group.add_argument(
        "--markers",
        type=Path,
        metavar="MAP.json",
        help='which recorded markers make the 15, {"head": "HEAD", "left_knee": {"LKNE": 0.5, "LKNM": 0.5}, ...}',
    )
    group.add_argument(
        "--static",
        type=Path,
        metavar="FILE",
        help="static trial with the markers that were taken off for walking; all recordings are of that one person",
    )
    group.add_argument(
        "--passes", action="store_true", help="split recordings at turns and stops; each pass is a walk of its own"
    )
    group.add_argument(
        "--camera",
        choices=("still", "moving"),
        default="still",
        help="moving: the camera turned or went along with the walker, as a turning Kinect does (still)",
    )
    group.add_argument(
        "--max-gap", type=positive, metavar="SECONDS", help="fill gaps in marker paths up to this length (none)"
    )
    group.add_argument("--cutoff", type=positive, metavar="HZ", help="low-pass against noise, such as 6 (none)")
    group.add_argument(
        "--frequency",
        choices=("search", "events"),
        default="search",
        help="events: cut walks from heel strike to heel strike and count strides; one is enough (search)",
    )
    group.add_argument(
        "--frequency-range",
        type=positive,
        nargs=2,
        metavar=("LOW", "HIGH"),
        help=f"where strides per second are searched, such as 0.6 1.3 ({FREQUENCY_RANGE[0]} {FREQUENCY_RANGE[1]})",
    )
    group.add_argument("--steady-cadence", action="store_true", help="take drift of the cadence out")
    group.add_argument("--symmetrize", action="store_true", help="take differences between left and right out")


def make_preparation(options: argparse.Namespace, *, reading: dict[str, object], feet: bool = False) -> Preparation:
    """Return the preparation that was asked for; the map of markers and the static trial are read."""
    limits = options.frequency_range
    if limits is not None and limits[0] >= limits[1]:
        raise ValueError(f"--frequency-range must be LOW HIGH, the lower one first, got {limits[0]:g} {limits[1]:g}")
    if getattr(options, "representation", "markers") == "joints":
        return _of_joints(options, limits)
    return Preparation(
        rig=read_marker_map(options.markers) if options.markers is not None else None,
        static=_read_static(options.static, reading) if options.static is not None else None,
        max_gap=options.max_gap,
        passes=options.passes,
        feet=feet,
        options={
            "camera": options.camera,
            "cutoff": options.cutoff,
            "frequency": options.frequency,
            "frequency_range": None if limits is None else tuple(limits),
            "cadence": "steady" if options.steady_cadence else "recorded",
            "symmetrize": options.symmetrize,
        },
    )


def _of_joints(options: argparse.Namespace, limits: list[float] | None) -> Preparation:
    """Return the preparation of walks in joint angles, or raise if it is one of markers that was asked for."""
    asked = {
        "--static": options.static is not None,
        "--passes": options.passes,
        "--camera moving": options.camera != "still",
        "--max-gap": options.max_gap is not None,
        "--symmetrize": options.symmetrize,
    }
    wrong = [name for name, given in asked.items() if given]
    if wrong:
        raise ValueError(f"{', '.join(wrong)} can be asked for with --representation markers only")
    return Preparation(
        joints=True,
        options={
            "representation": "joints",
            "rig": read_marker_map(options.markers) if options.markers is not None else None,
            "cutoff": options.cutoff,
            "frequency": options.frequency,
            "frequency_range": None if limits is None else tuple(limits),
            "cadence": "steady" if options.steady_cadence else "recorded",
        },
    )


def _read_static(path: Path, reading: dict[str, object]) -> Walk:
    static = read_walk(path, **reading)
    if not isinstance(static, Walk):
        raise ValueError(f"--static must be a recording of markers, such as a C3D file, got the joints of {path}")
    return static


def find_walks(recording: Walk | JointWalk, preparation: Preparation) -> list[Any]:
    """Return the walks in a recording that `prepare` may take: one, or its passes.

    Gaps are filled first, while all recorded markers are there to help.
    """
    if preparation.joints:
        return [_check_joints(recording)]
    if preparation.max_gap is not None and isinstance(recording, Walk):
        recording = fill_gaps(recording, max_gap=preparation.max_gap)
    if preparation.passes:
        return split_passes(_to_markers(recording, preparation))
    feet = preparation.feet and _has_feet(recording, preparation)
    is_asked = feet or preparation.rig is not None or preparation.static is not None
    return [_to_markers(recording, preparation) if is_asked else recording]


def _check_joints(recording: Walk | JointWalk) -> JointWalk:
    if not isinstance(recording, JointWalk):
        raise WalkError(
            f"walk {recording.name!r}: expected a skeleton with joints, such as a BVH or AMC file has, for "
            "--representation joints, got markers, which do not say how joints turn"
        )
    return recording


def _to_markers(recording: Walk | JointWalk, preparation: Preparation) -> Walk:
    if isinstance(recording, Walk):
        feet = preparation.feet and _has_feet(recording, preparation)
        return recording.to_markers(preparation.rig, static=preparation.static, feet=feet)
    if preparation.static is not None:
        raise WalkError(f"walk {recording.name!r}: a static trial completes markers, and this recording has joints")
    return recording.to_markers(preparation.rig)


def _has_feet(recording: Walk | JointWalk, preparation: Preparation) -> bool:
    """Tell whether heels and toes are among the recorded markers."""
    if isinstance(recording, JointWalk):
        return False
    found = [*recording.marker_set.names, *(preparation.static.marker_set.names if preparation.static else ())]
    try:
        rig = preparation.rig if preparation.rig is not None else find_rig(found)
    except ValueError:
        return False  # what is wrong is said where the 15 markers are needed
    return all(foot in rig.markers and sources(rig.markers[foot]) <= set(found) for foot in FEET)
