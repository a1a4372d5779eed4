"""BVH files: a skeleton and the rotations of its joints."""

from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.io._bvh_text import BvhText, parse_bvh
from eigenwalker.io._units import check_body, check_up, meters_per_unit, to_package_axes, to_package_order
from eigenwalker.motion.rotations import rotvec_from_channels
from eigenwalker.motion.skeleton import Skeleton
from eigenwalker.motion.walk import JointWalk

__all__ = ["channel_columns", "read_bvh"]

_STILL = 1e-6  # a joint moves if its position channels range over more than this, in metres
_SHORT = 12  # characters of a frame rate that a person chose
_WHOLE = 1e-4  # a frame rate this near to a whole number is that number, printed with few digits


def read_bvh(
    path: str | PathLike[str],
    *,
    unit: str | float = "cm",
    up: str = "y",
    frame_rate: float | None = None,
    name: str | None = None,
) -> JointWalk:
    """Return the walk that a BVH file holds.

    BVH files say neither their unit of length nor which axis points up, so both are arguments.

    Parameters
    ----------
    path : str or path
        The file.
    unit : {"m", "cm", "mm", "in"} or float, default "cm"
        Unit of length of the file; a number is in metres per unit.
    up : {"y", "z"}, default "y"
        The axis of the file that points up. "y": z is forward and x is left in the file, and the
        cyclic permutation (z, x, y) makes them the package's axes. "z": x is forward and y is left,
        as in the package.
    frame_rate : float, default None
        Frames per second, where the file's Frame Time is known to be wrong. None takes the file's.
    name : str, default None
        Name of the walk. None is the file's name without its suffix.

    Returns
    -------
    JointWalk
        In metres and radians, x forward, y left, z up. The rotations run without jumps
        (`unroll_rotvec`). `skeleton.root` is the first joint in the file whose position channels move by
        more than 1e-6 m, else the first joint. Other joints that move are in `translations`.

    Raises
    ------
    WalkError
        If the file is not a whole and sound BVH file of one body, with the line; or if the skeleton is
        of a known rig (`RIGS`) and its legs are shorter than 0.3 m or longer than 1.3 m.
    OSError
        If the file cannot be opened.

    Notes
    -----
    A joint may have any of the six channels in any order. Its rotation is the product of its rotation
    channels from left to right, as in `rotvec_from_euler`. Its position channels *replace* its OFFSET, they
    are not added to it: files that have both write the same numbers twice. An axis without a position
    channel keeps the OFFSET. `skeleton.rotation_orders` keeps the order of the rotation channels, for `write_bvh`.

    A frame rate within 1 in 10,000 of a whole number is taken for it: a Frame Time of 0.0083333 s is 120 Hz.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from eigenwalker.io import read_bvh
    >>> text = '''HIERARCHY
    ... ROOT Hips
    ... {
    ...   OFFSET 0 0 0
    ...   CHANNELS 4 Xposition Yposition Zposition Yrotation
    ... }
    ... MOTION
    ... Frames: 2
    ... Frame Time: .0083333
    ... 10 90 0 0
    ... 10 90 1 90
    ... '''
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "anna.bvh")
    ...     _ = path.write_text(text)
    ...     walk = read_bvh(path, unit="cm")
    >>> walk.name, walk.frame_rate
    ('anna', 120.0)
    >>> walk.root
    array([[0.  , 0.1 , 0.9 ],
           [0.01, 0.1 , 0.9 ]])
    >>> walk.rotations[1].round(3)
    array([[0.   , 0.   , 1.571]])
    """
    scale = meters_per_unit(unit)
    check_up(up)
    path = Path(path)
    data = path.read_bytes()
    try:
        bvh = parse_bvh(data)
    except WalkError as error:
        raise WalkError(f"{path}, {error}") from None
    walk = _to_walk(bvh, scale, up, path.stem if name is None else name)
    check_body(walk, path, unit)
    return walk if frame_rate is None else replace(walk, frame_rate=frame_rate)


def _to_walk(bvh: BvhText, scale: float, up: str, name: str) -> JointWalk:
    """Return the walk in metres and in the package's axes."""
    paths = _position_paths(bvh, scale)
    moving = [joint for joint, path in paths.items() if np.ptp(path, axis=0).max() > _STILL]
    root = moving[0] if moving else 0
    offsets = scale * np.array([joint.offset for joint in bvh.joints])
    for joint in paths.keys() - set(moving):
        offsets[joint] = paths[joint][0]
    names = tuple(joint.name for joint in bvh.joints)
    skeleton = Skeleton(
        names,
        np.array([joint.parent for joint in bvh.joints]),
        to_package_axes(offsets, up),
        np.array([joint for joint, _ in bvh.ends], dtype=np.intp),
        to_package_axes(scale * np.array([offset for _, offset in bvh.ends]).reshape(-1, 3), up),
        root,
        _rotation_orders(bvh, up),
    )
    still = np.tile(offsets[root], (len(bvh.motion), 1))
    return JointWalk(
        _rotations(bvh, up),
        to_package_axes(paths[root] if root in moving else still, up),
        skeleton,
        _frame_rate(bvh.frame_time),
        name,
        translations={names[joint]: to_package_axes(paths[joint], up) for joint in moving if joint != root},
    )


def channel_columns(bvh: BvhText, kind: str) -> dict[int, tuple[str, list[int]]]:
    """Return each joint's axes of the channels of one kind, such as "ZXY", and their columns in the motion."""
    found = {}
    first = 0
    for joint, entry in enumerate(bvh.joints):
        columns = [first + place for place, channel in enumerate(entry.channels) if channel.endswith(kind)]
        if columns:
            found[joint] = ("".join(entry.channels[column - first][0] for column in columns), columns)
        first += len(entry.channels)
    return found


def _position_paths(bvh: BvhText, scale: float) -> dict[int, NDArray[np.float64]]:
    """Return the path of each joint with position channels against its parent, shape (n_frames, 3), in metres."""
    paths = {}
    for joint, (axes, columns) in channel_columns(bvh, "position").items():
        path = np.tile(np.array(bvh.joints[joint].offset), (len(bvh.motion), 1))
        path[:, ["XYZ".index(axis) for axis in axes]] = bvh.motion[:, columns]
        paths[joint] = scale * path
    return paths


def _rotations(bvh: BvhText, up: str) -> NDArray[np.float64]:
    """Return exponential maps in the package's axes, shape (n_frames, n_joints, 3), without jumps."""
    turning = channel_columns(bvh, "rotation")
    axes, columns = zip(*(turning.get(joint, ("", [])) for joint in range(len(bvh.joints))), strict=True)
    rotations = rotvec_from_channels(bvh.motion, columns, [to_package_order(order, up) for order in axes])
    rotations.flags.writeable = False  # else the walk keeps a copy
    return rotations


def _rotation_orders(bvh: BvhText, up: str) -> tuple[str, ...]:
    """Return the order of each joint's rotation channels, each axis once, the axes it lacks in the order ZXY."""
    turning = channel_columns(bvh, "rotation")
    orders = [turning[joint][0] if joint in turning else "" for joint in range(len(bvh.joints))]
    return tuple(to_package_order("".join(dict.fromkeys(order + "ZXY")), up) for order in orders)


def _frame_rate(frame_time: float) -> float:
    rate = 1 / frame_time
    whole = max(1.0, np.round(rate))
    if abs(rate - whole) <= _WHOLE * whole:
        return float(whole)
    # Rounding twice can miss a rate of few digits, such as 59.94, by the last bit.
    near = [float(np.nextafter(rate, 0)), float(np.nextafter(rate, np.inf))]
    return next((other for other in near if 1 / other == frame_time and len(repr(other)) <= _SHORT), rate)
