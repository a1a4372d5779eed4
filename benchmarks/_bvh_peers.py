"""BVH files by other means: their numbers, and where their joints are in the room.

Numbers have shape (n_frames, n_channels), in the order of the file. Positions have shape (n_frames, n_joints, 3), in
the unit and axes of the file, beside the names of the joints. A peer is imported when it is used.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

__all__ = ["LOADERS", "POSITIONS", "to_package"]

Array = NDArray[np.float64]


def _load_by_pymotion(path: Path):
    from pymotion.io.bvh import BVH

    file = BVH()
    file.load(str(path))
    return file


def _numbers_of_pymotion(file) -> Array:
    data = file.data
    parts = []
    for joint, n_channels in enumerate(data["channels"]):
        parts += [data["positions"][:, joint]] if n_channels == 6 else []
        parts.append(data["rotations"][:, joint])
    return np.concatenate(parts, axis=1)


def _load_by_bvh(path: Path):
    from bvh import Bvh

    return Bvh(path.read_text())


def _numbers_of_bvh(file) -> Array:
    return np.array(file.frames, dtype=np.float64)  # it keeps them as texts


LOADERS: dict[str, tuple[Callable, Callable]] = {
    "pymotion": (_load_by_pymotion, _numbers_of_pymotion),
    "bvh": (_load_by_bvh, _numbers_of_bvh),
}
"""For each peer what loads a file, and what makes its numbers of that."""


def _positions_by_pymotion(path: Path) -> tuple[list[str], Array]:
    from pymotion.ops.skeleton import fk

    file = _load_by_pymotion(path)
    rotations, positions, parents, *_ = file.get_data()
    return list(file.data["names"]), fk(rotations, positions[:, 0], positions, parents)[0]


def _positions_by_bvhio(path: Path) -> tuple[list[str], Array]:
    import bvhio

    root = bvhio.readAsHierarchy(str(path))
    joints = [joint for joint, *_ in root.layout()]
    n_frames = root.getKeyframeRange()[1] + 1
    positions = np.empty((n_frames, len(joints), 3))
    for frame in range(n_frames):
        root.loadPose(frame)
        positions[frame] = [tuple(joint.PositionWorld) for joint in joints]
    return [joint.Name for joint in joints], positions


POSITIONS: dict[str, Callable[[Path], tuple[list[str], Array]]] = {
    "pymotion": _positions_by_pymotion,
    "bvhio": _positions_by_bvhio,
}
"""For each peer what gives the names of the joints in a file and their positions in the room."""


def to_package(positions: Array, *, meters: float) -> Array:
    """Return positions of a file with y up in metres, x forward, y left, z up."""
    return meters * positions[..., [2, 0, 1]]
