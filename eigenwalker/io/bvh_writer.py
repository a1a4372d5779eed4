"""Joint walks as BVH files."""

import math
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_finite
from eigenwalker.io._units import check_up, from_package_axes, from_package_order, meters_per_unit, to_package_order
from eigenwalker.motion.rotations import euler_from_rotvec
from eigenwalker.motion.skeleton import Skeleton
from eigenwalker.motion.walk import JointWalk

__all__ = ["write_bvh"]

_DEGREE_DECIMALS = 6  # rounds by less than 1e-8 rad
_USUAL_ORDER = "ZXY"


def write_bvh(
    walk: JointWalk,
    path: str | PathLike[str],
    *,
    unit: str | float = "cm",
    up: str = "y",
    orders: str | Mapping[str, str] | None = None,
) -> None:
    """Write a walk as a BVH file, from which `read_bvh` with the same `unit` and `up` makes the same walk.

    Parameters
    ----------
    walk : JointWalk
        What to write. Its speed, size and events have no place in a BVH file.
    path : str or path
        Where to. A file that is there is replaced.
    unit : {"m", "cm", "mm", "in"} or float, default "cm"
        Unit of length of the file; a number is in metres per unit.
    up : {"y", "z"}, default "y"
        The axis of the file that points up, as in `read_bvh`.
    orders : str or mapping of str to str, default None
        Order of the rotation channels, such as "ZXY", in the file's axes, from left to right: one for all joints, or
        one for each joint named. None, and joints not named: `walk.skeleton.rotation_orders`, so that a file keeps
        its own orders, else "ZXY".

    Raises
    ------
    TypeError
        If `walk` has markers and no joints.
    WalkError
        If a value is not finite, or a joint has a name that a BVH file cannot hold.
    ValueError
        If `orders` names other axes or joints.

    Notes
    -----
    All joints have three rotation channels. The first joint, the root and the joints in `walk.translations` have
    three position channels before them; the others stay at their OFFSET. Chains that end without a tip get an
    End Site of length zero, because other programs insist on one. Angles run without jumps (`euler_from_rotvec`).

    Angles are rounded to 1e-6 degrees and lengths to 5e-9 m or less. The frame rate comes back as it is
    (with more than ten digits, to the last of 16), unless it is no whole number but within 1 in 10,000 of one, which
    `read_bvh` takes it for.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> import numpy as np
    >>> from eigenwalker.motion import JointWalk, Skeleton
    >>> skeleton = Skeleton(("Hips",), [-1], np.zeros((1, 3)), end_parents=[0], end_offsets=[[0, 0, 0.1]])
    >>> walk = JointWalk(np.zeros((2, 1, 3)), np.array([[0, 0, 0.9], [0.5, 0, 0.9]]), skeleton, frame_rate=50)
    >>> with TemporaryDirectory() as folder:
    ...     write_bvh(walk, Path(folder, "anna.bvh"), unit="m")
    ...     print(Path(folder, "anna.bvh").read_text().split("MOTION")[1])
    <BLANKLINE>
    Frames: 2
    Frame Time: 0.02
    0.00000000 0.90000000 0.00000000 0.000000 0.000000 0.000000
    0.00000000 0.90000000 0.50000000 0.000000 0.000000 0.000000
    <BLANKLINE>
    """
    scale = meters_per_unit(unit)
    check_up(up)
    if not isinstance(walk, JointWalk):
        raise TypeError(f"expected a JointWalk, got {type(walk).__name__}; markers have no joints to turn")
    _check_writable(walk)
    by_joint = _orders(walk.skeleton, orders, up)
    moving = _paths(walk)
    decimals = min(max(0, 8 + math.ceil(math.log10(scale))), 300)
    lines = [
        *_hierarchy(walk.skeleton, by_joint, set(moving), scale, up, decimals),
        "MOTION",
        f"Frames: {walk.n_frames}",
        f"Frame Time: {_frame_time(walk.frame_rate)}",
        *_motion(walk, by_joint, moving, scale, up, decimals),
    ]
    Path(path).write_bytes(("\n".join(lines) + "\n").encode())


def _check_writable(walk: JointWalk) -> None:
    """Raise unless the walk is finite and its joints have names that can be read again."""
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    for joint, path in [("root", walk.root), *walk.translations.items()]:
        check_finite(path, [f"{joint} {axis}" for axis in "xyz"], walk=walk.name)
    lengths = np.vstack([walk.skeleton.offsets, walk.skeleton.end_offsets])
    check_finite(lengths, [f"skeleton offsets {axis}" for axis in "xyz"], walk=walk.name)
    for name in walk.skeleton.joint_names:
        if name != name.strip() or not name.isprintable() or set(name) & set("{}"):
            raise WalkError(
                f"walk {walk.name!r}: joint {name!r} needs a name without braces and line breaks in a BVH file"
            )


def _orders(skeleton: Skeleton, orders: str | Mapping[str, str] | None, up: str) -> list[str]:
    """Return for each joint the order of its rotation channels in the file's axes."""
    names = skeleton.joint_names
    if isinstance(orders, str):
        orders = dict.fromkeys(names, orders)
    asked = dict(orders or {})
    wrong = [order for order in asked.values() if sorted(order) != ["X", "Y", "Z"]]
    if wrong:
        raise ValueError(f"orders must have X, Y and Z once each, such as 'ZXY', got {wrong[0]!r}")
    unknown = [name for name in asked if name not in names]
    if unknown:
        raise ValueError(
            f"orders must name joints of the skeleton, got {', '.join(unknown)}; it has {', '.join(names)}"
        )
    own = skeleton.rotation_orders or (to_package_order(_USUAL_ORDER, up),) * len(names)
    return [asked.get(name, from_package_order(order, up)) for name, order in zip(names, own, strict=True)]


def _paths(walk: JointWalk) -> dict[int, NDArray[np.floating]]:
    """Return the path, shape (n_frames, 3), of each joint that gets position channels."""
    skeleton = walk.skeleton
    paths = {0: np.tile(skeleton.offsets[0], (walk.n_frames, 1))}
    paths |= {skeleton.joint_names.index(name): path for name, path in walk.translations.items()}
    return paths | {skeleton.root: walk.root}


def _depth_first(parents: NDArray[np.intp]) -> list[int]:
    """Return the joints in the order of the file: each with all that hangs from it before its next sibling."""
    children: list[list[int]] = [[] for _ in parents]
    for joint, parent in enumerate(parents[1:], 1):
        children[parent].append(joint)
    order, waiting = [], [0]
    while waiting:
        order.append(waiting.pop())
        waiting.extend(reversed(children[order[-1]]))
    return order


def _hierarchy(
    skeleton: Skeleton, orders: list[str], moving: set[int], scale: float, up: str, decimals: int
) -> Iterator[str]:
    """Yield the lines before MOTION."""
    offsets = from_package_axes(skeleton.offsets / scale, up)
    tips = from_package_axes(skeleton.end_offsets / scale, up)
    inner = set(skeleton.parents.tolist())
    depths: dict[int, int] = {-1: -1}
    yield "HIERARCHY"
    last = -1
    for joint in _depth_first(skeleton.parents):
        depth = depths[joint] = depths[int(skeleton.parents[joint])] + 1
        yield from ("  " * closed + "}" for closed in range(depths[last], depth - 1, -1))
        indent, last = "  " * depth, joint
        ends = tips[skeleton.end_parents == joint]
        if not len(ends) and joint not in inner:
            ends = np.zeros((1, 3))
        yield f"{indent}{'JOINT' if depth else 'ROOT'} {skeleton.joint_names[joint]}"
        yield f"{indent}{{"
        yield f"{indent}  OFFSET {_numbers(offsets[joint], decimals)}"
        yield f"{indent}  CHANNELS {_channels(orders[joint], joint in moving)}"
        for tip in ends:
            yield from (f"{indent}  {text}" for text in ("End Site", "{", f"  OFFSET {_numbers(tip, decimals)}", "}"))
    yield from ("  " * closed + "}" for closed in range(depths[last], -1, -1))


def _numbers(values: NDArray[np.floating], decimals: int) -> str:
    return " ".join(f"{value:.{decimals}f}" for value in np.round(values, decimals) + 0.0)  # no minus before a zero


def _channels(order: str, moves: bool) -> str:
    names = ["Xposition", "Yposition", "Zposition"] * moves + [f"{axis}rotation" for axis in order]
    return f"{len(names)} {' '.join(names)}"


def _motion(
    walk: JointWalk,
    orders: list[str],
    moving: dict[int, NDArray[np.floating]],
    scale: float,
    up: str,
    decimals: int,
) -> list[str]:
    """Return one line a frame."""
    angles = np.round(np.rad2deg(_angles(walk.rotations, orders, up)), _DEGREE_DECIMALS) + 0.0
    blocks, formats = list[NDArray[np.floating]](), list[str]()
    for joint in _depth_first(walk.skeleton.parents):
        if joint in moving:
            blocks.append(np.round(from_package_axes(moving[joint] / scale, up), decimals) + 0.0)
            formats += [f"%.{decimals}f"] * 3
        blocks.append(angles[:, joint])
        formats += [f"%.{_DEGREE_DECIMALS}f"] * 3
    row_format = " ".join(formats)  # one % for a whole line is several times faster than np.savetxt
    return [row_format % tuple(row) for row in np.hstack(blocks).tolist()]


def _angles(rotations: NDArray[np.floating], orders: list[str], up: str) -> NDArray[np.float64]:
    """Return Euler angles in radians, shape (n_frames, n_joints, 3), in the order of each joint's channels.

    They are the same about the package's axes and about the file's, when the letters of the order change with them.
    """
    angles = np.empty(rotations.shape)
    for order in set(orders):
        joints = [joint for joint, other in enumerate(orders) if other == order]
        angles[:, joints] = euler_from_rotvec(rotations[:, joints], to_package_order(order, up))
    return angles


def _frame_time(frame_rate: float) -> str:
    """Return the seconds per frame, in the digits from which the same rate is computed again."""
    seconds = 1 / frame_rate
    near = [seconds, float(np.nextafter(seconds, 0)), float(np.nextafter(seconds, np.inf))]
    exact = [value for value in near if 1 / value == frame_rate]
    return np.format_float_positional((exact or near)[0], unique=True)
