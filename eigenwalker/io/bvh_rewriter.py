"""A BVH file with other motion in its own words: hierarchy, names, channels, frame time and still numbers stay."""

import re
import warnings
from collections.abc import Iterator
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from eigenwalker._validation import WalkError, check_finite
from eigenwalker.io._bvh_text import BvhText, parse_bvh
from eigenwalker.io._units import from_package_axes, meters_per_unit, to_package_order
from eigenwalker.io.bvh import channel_columns, read_bvh
from eigenwalker.motion.rotations import euler_from_rotvec
from eigenwalker.motion.walk import JointWalk

__all__ = ["rewrite_bvh"]

_HEAD = re.compile(rb"(MOTION\s+Frames\s*:?\s*)([0-9]+)(\s+frame\s+time[^\r\n]*(\r\n|\r|\n))", re.IGNORECASE)
_SAME_TURN, _SAME_PLACE = 1e-8, 1e-9  # radians and metres within which a file's own numbers are kept
_LOST_TURN, _LOST_PLACE = 1e-3, 1e-4  # and beyond which it is said that they have no channel
_DECIMALS = 6


def rewrite_bvh(
    walk: JointWalk,
    original: str | PathLike[str],
    path: str | PathLike[str],
    *,
    unit: str | float = "cm",
    up: str = "y",
) -> None:
    """Write a walk into a copy of the BVH file whose skeleton it has.

    Of the file everything before its frames stays, byte by byte, but for the number of frames: the hierarchy, names,
    End Sites, the channels and their order, the Frame Time. `write_bvh` writes all of that anew. Of the frames those
    numbers stay that say what the walk says; a walk that `read_bvh` made of the file makes the same file again.

    Parameters
    ----------
    walk : JointWalk
        With the joints of the file, made from it: by `restyle_walk`, for instance.
    original : str or path
        The file.
    path : str or path
        Where to write. It may be the same file.
    unit : {"m", "cm", "mm", "in"} or float, default "cm"
        As in `read_bvh`.
    up : {"y", "z"}, default "y"
        As in `read_bvh`.

    Raises
    ------
    TypeError
        If `walk` has markers.
    WalkError
        If the file is not a sound BVH file, or a value of the walk is not finite.
    ValueError
        If the walk has other joints than the file.

    Warns
    -----
    UserWarning
        If joints turn or move in ways for which the file has no channels; these ways are left out.

    Notes
    -----
    Every rotation has two families of angles and whole turns to spare. With as many frames as the file has, the angles
    nearest to those of its frame are taken; with more or fewer, those that run on without jumps from the ones nearest
    to its first frame. Channels of which the walk knows nothing, position channels of joints that stand still, have the
    numbers of the file's frame at the same share of its length. New numbers have as many decimals as the file's, six at
    least.
    """
    if not isinstance(walk, JointWalk):
        raise TypeError(f"expected a JointWalk, got {type(walk).__name__}; markers have no joints to turn")
    data = Path(original).read_bytes()
    recorded = read_bvh(original, unit=unit, up=up)
    bvh = parse_bvh(data)
    if walk.skeleton.joint_names != recorded.skeleton.joint_names:
        raise ValueError(
            f"walk {walk.name!r} must have the joints of {original}, {', '.join(recorded.skeleton.joint_names)}; got "
            f"{', '.join(walk.skeleton.joint_names)}"
        )
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    check_finite(walk.root, [f"root {axis}" for axis in "xyz"], walk=walk.name)
    head = _HEAD.search(data)
    if head is None:  # blank lines between them
        raise WalkError(f"{original}: expected MOTION, Frames: and Frame Time: in lines that follow each other")
    lines = [line for line in data[head.end() :].decode("ascii").splitlines() if line.strip()]
    sources = np.rint(np.linspace(0, len(lines) - 1, walk.n_frames)).astype(np.intp)
    copy = _Copy(np.array([line.split() for line in lines], dtype=object)[sources], len(lines) == walk.n_frames)
    lost = [
        *_write_turns(copy, walk, recorded, bvh, sources, up),
        *_write_places(copy, walk, recorded, bvh, sources, meters_per_unit(unit), up),
    ]
    if lost:
        warnings.warn(
            f"{original} lacks channels for what walk {walk.name!r} does; left out: {', '.join(lost)}", stacklevel=2
        )
    count = str(walk.n_frames).encode()
    Path(path).write_bytes(data[: head.start()] + head[1] + count + head[3] + copy.text(lines, head[4].decode()))


class _Copy:
    """The numbers of the file, as words of shape (n_frames, n_channels), with some of them replaced.

    Parameters
    ----------
    words : ndarray of str
        Of the file's frames, or of those at the same shares of its length.
    has_same_frames : bool
        Whether they are the file's frames.
    """

    def __init__(self, words: NDArray[np.object_], has_same_frames: bool) -> None:
        self.words = words
        self.has_same_frames = has_same_frames
        self.changed = np.zeros(len(words), dtype=np.bool_)
        self.decimals = max(_DECIMALS, *(len(word.partition(".")[2]) for word in words[0] if "e" not in word.lower()))

    def write(self, column: int, values: NDArray[np.floating], is_same: NDArray[np.bool_]) -> None:
        """Put numbers in where they are not the same; with other frames, in all or in none."""
        replaced = ~is_same if self.has_same_frames else np.full(len(is_same), not is_same.all())
        rounded = np.round(values[replaced], self.decimals) + 0.0  # no minus before a zero
        self.words[replaced, column] = [f"{value:.{self.decimals}f}" for value in rounded]
        self.changed |= replaced

    def text(self, lines: list[str], end: str) -> bytes:
        """Return the frames; a line in which nothing has changed is the file's own."""
        keep = ~self.changed if self.has_same_frames else np.zeros(len(self.words), dtype=np.bool_)
        rows = (lines[frame] if keep[frame] else " ".join(row) for frame, row in enumerate(self.words))
        return "".join(row + end for row in rows).encode()


def _write_turns(
    copy: _Copy, walk: JointWalk, recorded: JointWalk, bvh: BvhText, sources: NDArray[np.intp], up: str
) -> Iterator[str]:
    """Write the angles of joints that turn otherwise, and yield what has no channel."""
    turning = channel_columns(bvh, "rotation")
    for joint, name in enumerate(walk.skeleton.joint_names):
        own, theirs = np.array(walk.rotations[:, joint]), np.array(recorded.rotations[sources, joint])
        far = (Rotation.from_rotvec(theirs).inv() * Rotation.from_rotvec(own)).magnitude()
        is_same = far < _SAME_TURN
        if is_same.all():
            continue
        axes, columns = turning.get(joint, ("", []))
        if len(set(axes)) < len(axes):
            raise WalkError(f"joint {name!r} has the rotation channels {axes}: expected each axis once, to turn it")
        order = axes + "".join(axis for axis in "ZXY" if axis not in axes)
        near = np.zeros((walk.n_frames, 3))
        near[:, : len(axes)] = np.deg2rad(bvh.motion[sources][:, columns])
        angles = _nearest(euler_from_rotvec(own, to_package_order(order, up)), near, each=copy.has_same_frames)
        for place, column in enumerate(columns):
            copy.write(column, np.rad2deg(angles[:, place]), is_same)
        left = float(np.abs(angles[:, len(axes) :]).max(initial=0.0))
        if left > _LOST_TURN:
            yield f"{name} {np.rad2deg(left):.2g} degrees about {', '.join(order[len(axes) :])}"


def _nearest(angles: NDArray[np.float64], near: NDArray[np.float64], *, each: bool) -> NDArray[np.float64]:
    """Return the angles (n_frames, 3) of the same rotations that are nearest to others, in each frame or in the first.

    In the first: all others go on from it as they do in `angles`.
    """
    families = np.stack((angles, angles * [1, -1, 1] + np.pi))  # (a, b, c) and (a + pi, pi - b, c + pi)
    turns = 2 * np.pi * np.rint((near - families) / (2 * np.pi))
    frames = np.arange(len(angles)) if each else np.zeros(len(angles), dtype=np.intp)
    best = ((families + turns - near) ** 2).sum(axis=2).argmin(axis=0)[frames]
    return families[best, np.arange(len(angles))] + turns[best, frames]


def _write_places(
    copy: _Copy,
    walk: JointWalk,
    recorded: JointWalk,
    bvh: BvhText,
    sources: NDArray[np.intp],
    scale: float,
    up: str,
) -> Iterator[str]:
    """Write the places of joints that move otherwise, and yield what has no channel."""
    moving = channel_columns(bvh, "position")
    own, theirs = walk._local_positions(), recorded._local_positions()[sources]
    for joint, name in enumerate(walk.skeleton.joint_names):
        is_same = np.abs(own[:, joint] - theirs[:, joint]).max(axis=1) < _SAME_PLACE
        if is_same.all():
            continue
        axes, columns = moving.get(joint, ("", []))
        places = from_package_axes(own[:, joint], up)
        for axis, column in zip(axes, columns, strict=True):
            copy.write(column, places[:, "XYZ".index(axis)] / scale, is_same)
        without = ["XYZ".index(axis) for axis in "XYZ" if axis not in axes]
        left = np.abs(places - from_package_axes(theirs[:, joint], up))[:, without].max(initial=0.0)
        if left > _LOST_PLACE:
            yield f"{name} {1000 * left:.2g} mm along {', '.join('XYZ'[axis] for axis in without)}"
