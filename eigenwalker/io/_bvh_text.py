"""The text of a BVH file: its joints, their channels and the numbers, checked line by line.

Errors start with ``line 12:``; the reader puts the file's name before them.
"""

import math
import re
from array import array
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.io._bvh_hierarchy import BvhJoint, read_hierarchy
from eigenwalker.io._plain_numbers import parse_lines_of_numbers
from eigenwalker.io._text import CUT, decimal, decode_lines, shown
from eigenwalker.io._units import check_room

__all__ = ["BvhText", "parse_bvh"]

_HEAD_END = re.compile(rb"frame\s+time[^\r\n]*[\r\n]", re.IGNORECASE)


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


class _Head(NamedTuple):
    """What stands before the motion: the joints, its shape, and in which lines Frames and Frame Time are."""

    joints: list[BvhJoint]
    ends: list[tuple[int, tuple[float, ...]]]
    frame_time: float
    shape: tuple[int, int]
    frames_line: int
    time_line: int


def parse_bvh(data: bytes) -> BvhText:
    """Return what the bytes of a BVH file say, or raise a WalkError that names the line."""
    head, motion = _parse_plain(data) or _parse_lines(data)
    check_room(len(head.joints), len(motion), len(data), line=head.frames_line)
    return BvhText(head.joints, head.ends, head.frame_time, motion)


def _parse_plain(data: bytes) -> tuple[_Head, NDArray[np.float64]] | None:
    """Return head and motion of a plain and sound file, or None: `_parse_lines` can say what is wrong."""
    end = _HEAD_END.search(data)
    if end is None:
        return None
    try:
        head = _read_head(_decode(data[: end.end()]))
    except WalkError:
        return None
    motion = parse_lines_of_numbers(data, end.end(), head.shape)
    return None if motion is None else (head, motion)


def _parse_lines(data: bytes) -> tuple[_Head, NDArray[np.float64]]:
    lines = _decode(data)
    head = _read_head(lines)
    return head, _read_motion(lines, head.time_line, head.shape, head.frames_line)


def _read_head(lines: list[str]) -> _Head:
    joints, ends, after = read_hierarchy(lines)
    n_channels = sum(len(joint.channels) for joint in joints)
    if n_channels == 0:
        raise WalkError(f"line {after}: expected joints with channels before MOTION, got none, so nothing can move")
    frames, frames_line = _labelled(lines, after, "Frames")
    n_frames = _frame_count(frames, frames_line)
    seconds, time_line = _labelled(lines, frames_line, "Frame Time")
    return _Head(joints, ends, _frame_time(seconds, time_line), (n_frames, n_channels), frames_line, time_line)


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
    """Return the numbers from position `start` on, or raise an error about the first line that is wrong.

    The size comes from the lines, never from the header.
    """
    n_frames, n_channels = shape
    filled = [number for number, row in enumerate(lines[start:], start + 1) if row.strip()]
    motion = array("d")
    for number in filled[:n_frames]:
        motion.extend(_read_row(number, lines[number - 1].split(), n_channels, last=number == filled[-1]))
    counts = f"as Frames: in line {frames_line} says {n_frames}"
    if len(filled) > n_frames:
        raise WalkError(
            f"line {filled[n_frames]}: expected the end of the file, {counts}, got {len(filled)} lines of motion; "
            "correct the count or remove the lines"
        )
    if len(filled) < n_frames:
        raise WalkError(
            f"line {len(lines)}: expected {n_frames} lines of motion, {counts}, got {len(filled)}; "
            f"{CUT}, or correct the count"
        )
    return np.array(motion).reshape(shape)  # (n_frames n_channels,) -> (n_frames, n_channels)


def _read_row(line: int, words: list[str], n_channels: int, *, last: bool) -> list[float]:
    if len(words) != n_channels:
        cut = f"; {CUT}" if last and len(words) < n_channels else ""
        raise WalkError(f"line {line}: expected {n_channels} numbers, one a channel, got {len(words)}{cut}")
    numbers = [decimal(word) for word in words]
    if None in numbers:
        column = numbers.index(None)
        raise WalkError(
            f"line {line}: expected a finite number as value {column + 1} of {n_channels}, got {shown(words[column])}"
        )
    return [number for number in numbers if number is not None]
