"""ASF/AMC files of Acclaim: a skeleton in one file, the motion of its bones in another."""

import re
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_frame_rate
from eigenwalker.io._asf import LARGEST, AsfSkeleton, Statement, parse_asf, statements
from eigenwalker.io._text import decimal, decode_lines, name_file, shown
from eigenwalker.io._units import check_body, check_room, check_up, meters_per_unit, to_package_axes
from eigenwalker.motion.body import UNITS
from eigenwalker.motion.rotations import rotvec_from_euler, unroll_rotvec
from eigenwalker.motion.skeleton import Skeleton
from eigenwalker.motion.walk import JointWalk

__all__ = ["read_amc"]

_DIGITS = frozenset("0123456789+-.eE")


def read_amc(
    path: str | PathLike[str],
    *,
    skeleton: str | PathLike[str] | None = None,
    unit: str | float | None = None,
    up: str = "y",
    frame_rate: float = 120.0,
    name: str | None = None,
) -> JointWalk:
    """Return the walk that an AMC file holds, on the skeleton of an ASF file.

    Parameters
    ----------
    path : str or path
        The AMC file.
    skeleton : str or path, default None
        The ASF file. None looks in the folder of the AMC file: for ``07_01.amc`` it takes ``07_01.asf``, else the
        subject's ``07.asf``, else the only ASF file there is.
    unit : {"m", "cm", "mm", "in"} or float, default None
        Unit of length of both files; a number is in metres per unit. None: inches times the ``length`` of the ASF
        file's ``:units``, as in the CMU database, where ``length 0.45`` makes one unit 0.0254 / 0.45 = 0.0564 m.
        With a unit, ``length`` is not used.
    up : {"y", "z"}, default "y"
        The axis of the files that points up, as in `read_bvh`.
    frame_rate : float, default 120.0
        Frames per second, which the files do not say.
    name : str, default None
        Name of the walk. None is the file's name without its suffix.

    Returns
    -------
    JointWalk
        In metres and radians, x forward, y left, z up. Its joints are ``root`` and the bones by their names; a joint
        lies where its bone starts, and the tips of the last bones are end sites.

    Raises
    ------
    WalkError
        If no ASF file is found; if a file is not whole and sound, with the line; or if the skeleton is of a known rig
        (`RIGS`) and its legs are shorter than 0.3 m or longer than 1.3 m.
    OSError
        If a file cannot be opened.

    Notes
    -----
    Every bone has a frame C, its ``axis``, and turns by the matrix M of its values in the AMC file, about the axes of
    that frame, each about the fixed axes and the first one first. Its rotation against its parent is C M C^-1, so
    that all rotations are zero in the rest posture of the ASF file. A bone that the AMC file never names stays in
    the rest posture. ``limits`` are ignored.

    The angles of the AMC file are in the unit that ``:DEGREES`` or ``:RADIANS`` says, else in the ASF file's.

    Examples
    --------
    >>> from eigenwalker.io.amc import read_amc
    >>> walk = read_amc("subjects/07/07_01.amc", frame_rate=120)  # doctest: +SKIP
    """
    scale = None if unit is None else meters_per_unit(unit)
    check_up(up)
    frame_rate = check_frame_rate(frame_rate)
    path = Path(path)
    data = path.read_bytes()
    asf_path = _find_skeleton(path) if skeleton is None else Path(skeleton)
    with name_file(asf_path):
        asf = parse_asf(asf_path.read_bytes())
    with name_file(path):
        values = _read_values(data, asf)
    scale = UNITS["in"] / asf.length if scale is None else scale
    walk = _to_walk(asf, values, scale, up, frame_rate, path.stem if name is None else name)
    check_body(walk, path, scale if unit is None else unit)
    return walk


def _find_skeleton(path: Path) -> Path:
    """Return the ASF file that belongs to an AMC file."""
    found = {file.name.lower(): file for file in sorted(path.parent.iterdir()) if file.suffix.lower() == ".asf"}
    wanted = [f"{stem}.asf" for stem in dict.fromkeys((path.stem, path.stem.split("_")[0]))]
    for name in wanted:
        if name.lower() in found:
            return found[name.lower()]
    if len(found) == 1:
        return next(iter(found.values()))
    raise WalkError(
        f"{path}: expected its skeleton beside it, {' or '.join(wanted)} or a single .asf file, "
        f"got {', '.join(file.name for file in found.values()) or 'none'}; pass skeleton='...'"
    )


def _to_walk(
    asf: AsfSkeleton, values: dict[str, NDArray[np.float64]], scale: float, up: str, frame_rate: float, name: str
) -> JointWalk:
    """Return the walk in metres and in the package's axes; `values` are in the units of the file and radians."""
    turns = [_turn(values["root"], asf.root_dof)]
    turns += [_turn(values[bone.name], bone.dof) @ bone.frame.T for bone in asf.bones]  # C M C^-1 is exp(C m)
    moves = [
        values["root"][:, asf.root_dof.index(axis)] if axis in asf.root_dof else 0.0 for axis in ("tx", "ty", "tz")
    ]
    root = scale * (asf.root_position + np.column_stack(np.broadcast_arrays(*moves, turns[0][:, 0])[:3]))
    return JointWalk(
        unroll_rotvec(to_package_axes(np.stack(turns, axis=1), up)),  # (n_frames, n_joints, 3)
        to_package_axes(root, up),
        _skeleton(asf, scale, up),
        frame_rate,
        name,
    )


def _turn(values: NDArray[np.float64], dof: tuple[str, ...]) -> NDArray[np.float64]:
    """Return exponential maps, shape (n_frames, 3), of turns about fixed axes: the last one is the leftmost factor."""
    columns = [column for column, axis in enumerate(dof) if axis.startswith("r")][::-1]
    return rotvec_from_euler(values[:, columns], "".join(dof[column][1].upper() for column in columns))


def _skeleton(asf: AsfSkeleton, scale: float, up: str) -> Skeleton:
    """Return the joints, each at the end of its parent's bone, and the ends of the last bones."""
    tips = np.array([np.zeros(3), *(bone.tip for bone in asf.bones)])  # of the root and the bones
    parents = np.array([-1, *(bone.parent for bone in asf.bones)])
    offsets = np.vstack([asf.root_position, tips[parents[1:]]])
    last = np.array(sorted(set(range(1, len(parents))) - set(parents.tolist())), dtype=np.intp)
    return Skeleton(
        ("root", *(bone.name for bone in asf.bones)),
        parents,
        to_package_axes(scale * offsets, up),
        last,
        to_package_axes(scale * tips[last], up),
    )


def _read_values(data: bytes, asf: AsfSkeleton) -> dict[str, NDArray[np.float64]]:
    """Return the values of the root and of each bone, shape (n_frames, n_dof), with angles in radians."""
    lines = decode_lines(data, "an AMC file")
    dof = {"root": asf.root_dof} | {bone.name: bone.dof for bone in asf.bones}
    degrees, frames = asf.degrees, list[dict[str, Statement]]()
    number = 0
    for entry in statements(lines):
        word = entry.words[0]
        if word.startswith(":"):
            degrees = {":DEGREES": True, ":RADIANS": False}.get(word.upper(), degrees)
        elif len(entry.words) == 1 and re.fullmatch("[0-9]{1,18}", word):
            _check_frame(frames, entry.line)
            if frames and int(word) != number + 1:
                raise WalkError(f"line {entry.line}: expected frame {number + 1}, got frame {word}; frames are missing")
            number = int(word)
            frames.append({})
        else:
            _add_bone(frames, entry, dof)
    _check_frame(frames, len(lines))
    if not frames:
        raise WalkError(f"line {len(lines)}: expected frames, each a number and the values of its bones, got none")
    check_room(len(dof), len(frames), len(data), line=len(lines))
    return {name: _values(frames, name, axes, degrees) for name, axes in dof.items()}


def _add_bone(frames: list[dict[str, Statement]], entry: Statement, dof: Mapping[str, tuple[str, ...]]) -> None:
    """Put the values of one bone into the last frame."""
    name, *words = entry.words
    if not frames:
        raise WalkError(f"line {entry.line}: expected the number of a frame before its bones, got {shown(name)}")
    if name not in dof or name in frames[-1]:
        again = "again" if name in dof else "which the ASF file does not have"
        raise WalkError(f"line {entry.line}: expected each bone of the ASF file once, got {shown(name)}, {again}")
    if len(words) != len(dof[name]):
        wanted = f"{len(dof[name])} numbers ({', '.join(dof[name])})"
        raise WalkError(f"line {entry.line}: expected {wanted} for {shown(name)}, got {len(words)}")
    frames[-1][name] = entry


def _check_frame(frames: list[dict[str, Statement]], line: int) -> None:
    """Raise unless the last frame names the root and the bones of the first one."""
    if frames and (missing := ({"root"} | frames[0].keys()) - frames[-1].keys()):
        raise WalkError(
            f"line {line}: expected values of {min(missing)} in frame {len(frames)} of the file, which ends here; "
            "the file seems to be cut off; get it again"
        )


def _values(frames: list[dict[str, Statement]], name: str, dof: tuple[str, ...], degrees: bool) -> NDArray[np.float64]:
    """Return the values of one bone, shape (n_frames, n_dof); zeros if no frame has them."""
    if name not in frames[0]:
        _check_never(frames, name)
        return np.zeros((len(frames), len(dof)))
    words = [word for frame in frames for word in frame[name].words[1:]]
    try:
        values = np.array([float(word) for word in words]) if _DIGITS.issuperset("".join(words)) else None
    except ValueError:
        values = None
    if values is None or not (np.abs(values) <= LARGEST).all():
        _refuse_number(frame[name] for frame in frames)
        raise WalkError(f"line {frames[0][name].line}: expected finite numbers for {name!r}")
    values = values.reshape(len(frames), len(dof))  # (n_frames n_dof,) -> (n_frames, n_dof)
    turning = [axis.startswith("r") for axis in dof]
    return np.where(turning, np.deg2rad(values), values) if degrees else values


def _check_never(frames: list[dict[str, Statement]], name: str) -> None:
    """Raise if a bone that the first frame lacks comes later."""
    for frame in frames:
        if name in frame:
            raise WalkError(f"line {frame[name].line}: expected the bones of the first frame, got {name!r} besides")


def _refuse_number(entries: Iterable[Statement]) -> None:
    """Raise an error about the first word that is no number, if there is one."""
    for entry in entries:
        for word in entry.words[1:]:
            value = decimal(word)
            if value is None or abs(value) > LARGEST:
                raise WalkError(f"line {entry.line}: expected finite numbers, got {shown(word)}")
