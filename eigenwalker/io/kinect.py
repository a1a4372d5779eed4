"""Recordings of the first Kinect as text: ``Joint;x;y;z``, with a new frame at each ``Head``."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_frame_rate
from eigenwalker.io._markers import make_walk
from eigenwalker.io._text import CUT, Row, decode_lines, name_file, number_table, plain_numbers, shown, split_rows
from eigenwalker.io._units import to_package_axes
from eigenwalker.motion.walk import Walk

__all__ = ["read_kinect"]

_PAIRS = ("Shoulder", "Elbow", "Wrist", "Hand", "Hip", "Knee", "Ankle", "Foot")
_JOINTS = {
    "Head": "head",
    "Shoulder-Center": "shoulder_center",
    "Spine": "spine",
    "Hip-centro": "hip_center",  # the source's spelling
    "Hip-Center": "hip_center",
    **{f"{joint}-{side}": f"{side.lower()}_{joint.lower()}" for joint in _PAIRS for side in ("Left", "Right")},
}
_N_JOINTS = 20


def read_kinect(path: str | PathLike[str], *, frame_rate: float = 30.0, name: str | None = None) -> Walk:
    """Return the walk in a text file of the first Kinect.

    Parameters
    ----------
    path : str or path
        The file: a line ``Head;x;y;z``, the other 19 joints in any order, then the next frame in the same order.
    frame_rate : float, default 30.0
        Frames per second, which the file does not say. A Kinect delivers about 30.
    name : str, default None
        Name of the walk. None is the file's name without its suffix.

    Returns
    -------
    Walk
        In metres. The 20 joints as they are, ``left_ankle``, ``hip_center``, ``shoulder_center`` and so on, in the
        order of the file; `Walk.to_markers` makes the 15 markers of them. The camera's x points to its left, y up and
        z along its view; the cyclic permutation (z, x, y) makes that right-handed with z up. x points away from the
        camera and not where the walker goes, until `prepare` turns the heading to x. Empty coordinates and ``nan``
        are gaps.

    Raises
    ------
    WalkError
        If the file is not whole and sound, with the line; or if the legs are shorter than 0.3 m or longer than 1.3 m.
    OSError
        If the file cannot be opened.

    Notes
    -----
    The layout is that of the recordings of Andersson & Araujo (AAAI 2015), with their spelling ``Hip-centro``.

    Examples
    --------
    >>> from eigenwalker.io import read_kinect
    >>> walk = read_kinect("Person001/1.txt", name="Person001_1").to_markers()  # doctest: +SKIP
    """
    rate = check_frame_rate(frame_rate)
    path = Path(path)
    data = path.read_bytes()
    with name_file(path):
        lines = decode_lines(data, "a Kinect recording")
        names, camera = _read_whole(lines) or _read_rows(lines)
    positions = to_package_axes(camera, "y")
    return make_walk(positions, rate, names, path=path, name=path.stem if name is None else name, unit="m")


def _read_whole(lines: Sequence[str]) -> tuple[list[str], NDArray[np.float64]] | None:
    """Return the joints and their positions all at once, or None where a line needs a closer look."""
    words = ";".join(lines).split(";")
    titles = words[::4]
    first = titles[:_N_JOINTS]
    n_frames = len(lines) // _N_JOINTS
    is_regular = len(words) == 4 * len(lines) and titles == first * n_frames
    if not is_regular or first[0] != "Head" or {_JOINTS.get(title) for title in first} != set(_JOINTS.values()):
        return None
    del words[::4]
    numbers = plain_numbers(words)
    if numbers is None:
        return None
    return [_JOINTS[title] for title in first], numbers.reshape(n_frames, _N_JOINTS, 3)  # from one row


def _read_rows(lines: Sequence[str]) -> tuple[list[str], NDArray[np.float64]]:
    """Return the joints and their positions line by line, or raise an error about the first line that is wrong."""
    rows = split_rows(lines, separator=";", quotes=False)
    names = _read_names(rows)
    table = number_table(rows, 4, columns=(1, 2, 3))
    return names, table.reshape(-1, _N_JOINTS, 3)  # (n_frames n_joints, 3) -> (n_frames, n_joints, 3)


def _read_names(rows: Sequence[Row]) -> list[str]:
    """Return the names of the joints in the order of the first frame, after a check that all frames have it."""
    if not rows:
        raise WalkError("line 1: expected Head;x;y;z, with which a Kinect recording starts, got an empty file")
    titles = [row.words[0].strip() for row in rows]
    first = titles[:_N_JOINTS]
    _check_first_frame(rows, first)
    n_frames = -(-len(rows) // _N_JOINTS)
    for row, title, expected in zip(rows, titles, first * n_frames, strict=False):
        if title != expected:
            raise WalkError(f"line {row.line}: expected {expected}, as in the first frame, got {shown(title)}")
    if len(rows) % _N_JOINTS:
        missing = first[len(rows) % _N_JOINTS]
        raise WalkError(f"line {rows[-1].line}: expected {missing} next, got the end of the file; {CUT}")
    return [_JOINTS[title] for title in first]


def _check_first_frame(rows: Sequence[Row], first: Sequence[str]) -> None:
    seen: set[str] = set()
    for row, title in zip(rows, first, strict=False):
        if not seen and title != "Head":
            raise WalkError(f"line {row.line}: expected Head;x;y;z, with which each frame starts, got {shown(title)}")
        left = [joint for joint, name in _JOINTS.items() if name not in seen and joint != "Hip-Center"]
        if title not in _JOINTS or _JOINTS[title] in seen:
            raise WalkError(f"line {row.line}: expected one of {', '.join(left)}, got {shown(title)}")
        seen.add(_JOINTS[title])
    if len(first) < _N_JOINTS:
        raise WalkError(f"line {rows[-1].line}: expected {_N_JOINTS} joints a frame, got {len(first)}; {CUT}")
