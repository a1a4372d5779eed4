"""The text of a BVH file: its joints, their channels and the numbers, checked line by line.

Errors start with ``line 12:``; the reader puts the file's name before them.
"""

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.io._bvh_hierarchy import BvhJoint, read_hierarchy
from eigenwalker.io._text import CUT, decimal, decode_lines, shown

__all__ = ["BvhText", "parse_bvh"]


@dataclass(frozen=True, eq=False)
class BvhText:
    """What a BVH file says, in its own units and axes.

    Parameters
    ----------
    joints : list of BvhJoint
        In the order of the file.
    ends : list of (int, tuple of float)
        For each end site its joint and its offset.
    frame_time : float
        Seconds per frame.
    motion : ndarray of shape (n_frames, n_channels)
        The channels of all joints, in the order of the file.
    """

    joints: list[BvhJoint]
    ends: list[tuple[int, tuple[float, ...]]]
    frame_time: float
    motion: NDArray[np.float64]


def parse_bvh(data: bytes) -> BvhText:
    """Return what the bytes of a BVH file say, or raise a WalkError that names the line."""
    lines = _decode(data)
    joints, ends, after = read_hierarchy(lines)
    n_channels = sum(len(joint.channels) for joint in joints)
    if n_channels == 0:
        raise WalkError(f"line {after}: expected joints with channels before MOTION, got none, so nothing can move")
    frames, frames_line = _labelled(lines, after, "Frames")
    n_frames = _frame_count(frames, frames_line)
    seconds, time_line = _labelled(lines, frames_line, "Frame Time")
    frame_time = _frame_time(seconds, time_line)
    motion = _read_motion(lines, time_line, (n_frames, n_channels), frames_line)
    return BvhText(joints, ends, frame_time, motion)


def _decode(data: bytes) -> list[str]:
    """Return the lines of the text, without blank ones at its end."""
    lines = decode_lines(data, "a BVH file")
    while len(lines) > 1 and not lines[-1].strip():
        lines.pop()
    return lines


def _labelled(lines: list[str], start: int, label: str) -> tuple[str, int]:
    """Return what follows ``label:`` in the first line with text from position `start` on, and its number."""
    for number, line in enumerate(lines[start:], start + 1):
        if not line.strip():
            continue
        match = re.fullmatch(label.replace(" ", r"\s+") + r"(?:\s*:|\s)(.*)", line.strip(), re.IGNORECASE)
        if match is None:
            raise WalkError(f"line {number}: expected '{label}:' and a number after MOTION, got {shown(line)}")
        return match.group(1).strip(), number
    raise WalkError(f"line {len(lines)}: expected '{label}:' and a number, got the end of the file; {CUT}")


def _frame_count(text: str, line: int) -> int:
    if re.fullmatch(r"[0-9]{1,18}", text) is None:
        raise WalkError(f"line {line}: expected a whole number of frames, got {shown(text)}")
    if int(text) == 0:
        raise WalkError(f"line {line}: expected at least one frame, got Frames: 0; the file holds no motion")
    return int(text)


def _frame_time(text: str, line: int) -> float:
    seconds = decimal(text)
    if seconds is None or seconds <= 0 or not math.isfinite(1 / seconds):
        raise WalkError(f"line {line}: expected a positive Frame Time in seconds, got {shown(text)}")
    return seconds


def _read_motion(lines: list[str], start: int, shape: tuple[int, int], frames_line: int) -> NDArray[np.float64]:
    """Return the numbers from position `start` on. The size comes from the lines, never from the header."""
    rows = lines[start:]
    problem = ""
    if any(row.strip() for row in rows):
        try:
            motion = np.loadtxt(rows, comments=None, ndmin=2)
            if motion.shape == shape and np.isfinite(motion).all():
                return motion
        except ValueError as error:
            problem = str(error)
    _refuse_motion(rows, start, shape, frames_line)
    raise WalkError(f"line {start + 1}: expected {shape[0]} lines of {shape[1]} numbers from here on; {problem}")


def _refuse_motion(rows: list[str], start: int, shape: tuple[int, int], frames_line: int) -> None:
    """Raise an error about the first line that is wrong, if there is one."""
    n_frames, n_channels = shape
    filled = [(number, row.split()) for number, row in enumerate(rows, start + 1) if row.strip()]
    for position, (number, words) in enumerate(filled[:n_frames], 1):
        _check_row(number, words, n_channels, last=position == len(filled))
    counts = f"as Frames: in line {frames_line} says {n_frames}"
    if len(filled) > n_frames:
        raise WalkError(
            f"line {filled[n_frames][0]}: expected the end of the file, {counts}, got {len(filled)} lines of motion; "
            "correct the count or remove the lines"
        )
    if len(filled) < n_frames:
        raise WalkError(
            f"line {start + len(rows)}: expected {n_frames} lines of motion, {counts}, got {len(filled)}; "
            f"{CUT}, or correct the count"
        )


def _check_row(line: int, words: list[str], n_channels: int, *, last: bool) -> None:
    if len(words) != n_channels:
        cut = f"; {CUT}" if last and len(words) < n_channels else ""
        raise WalkError(f"line {line}: expected {n_channels} numbers, one a channel, got {len(words)}{cut}")
    for column, word in enumerate(words, 1):
        if decimal(word) is None:
            raise WalkError(
                f"line {line}: expected a finite number as value {column} of {n_channels}, got {shown(word)}"
            )
