"""What readers and writers need to go between a file and metres, x forward, y left, z up."""

import math
from dataclasses import replace
from numbers import Real
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_choice
from eigenwalker.motion.body import UNITS, check_leg_length
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.walk import JointWalk

__all__ = [
    "check_body",
    "check_room",
    "check_up",
    "from_opensim_axes",
    "from_package_axes",
    "from_package_order",
    "meters_per_unit",
    "to_opensim_axes",
    "to_package_axes",
    "to_package_order",
]

_ALWAYS_ROOM = 2**27  # bytes of rotations
_MOST_TIMES = 8  # as large as the file
_AXES = {"y": (2, 0, 1), "z": (0, 1, 2)}  # which axis of the file becomes x, y and z


def meters_per_unit(unit: str | float) -> float:
    """Return how many metres one unit of length of a file is.

    Parameters
    ----------
    unit : {"m", "cm", "mm", "in"} or float
        A name, or the metres per unit.

    Examples
    --------
    >>> meters_per_unit("cm"), meters_per_unit(0.0564)
    (0.01, 0.0564)
    """
    if isinstance(unit, str):
        check_choice(unit, tuple(UNITS), name="unit")
        return UNITS[unit]
    if isinstance(unit, bool) or not isinstance(unit, Real):
        raise TypeError(f"unit must be one of {', '.join(map(repr, UNITS))} or metres per unit, got {unit!r}")
    if not (math.isfinite(unit) and unit > 0):
        raise ValueError(f"unit must be positive and finite, in metres per unit of the file, got {unit!r}")
    return float(unit)


def check_up(up: str) -> None:
    """Raise a ValueError unless `up` names an axis that a file may have pointing up."""
    check_choice(up, tuple(_AXES), name="up")


def to_package_axes(vectors: NDArray[np.floating], up: str) -> NDArray[np.floating]:
    """Return positions or exponential maps, shape (..., 3), in x forward, y left, z up.

    With ``up="y"`` the file's z is forward and its x is left, so that the axes are permuted
    cyclically, (z, x, y). That is a proper rotation B, and a rotation with the exponential map r
    becomes B exp(r) B' = exp(B r): the same permutation holds for both. With ``up="z"`` nothing changes.
    """
    return vectors[..., _AXES[up]]


def from_package_axes(vectors: NDArray[np.floating], up: str) -> NDArray[np.floating]:
    """Return positions or exponential maps in the axes of a file, the inverse of `to_package_axes`."""
    return vectors[..., np.argsort(_AXES[up])]


def to_package_order(order: str, up: str) -> str:
    """Return an order of axes of a file, such as "ZXY", in the letters of the package's axes.

    >>> to_package_order("ZXY", "y"), to_package_order("ZXY", "z")
    ('XYZ', 'ZXY')
    """
    return "".join("XYZ"[_AXES[up].index("XYZ".index(letter))] for letter in order)


def from_package_order(order: str, up: str) -> str:
    """Return an order of the package's axes in the letters of a file's axes, the inverse of `to_package_order`."""
    return "".join("XYZ"[_AXES[up]["XYZ".index(letter)]] for letter in order)


def from_opensim_axes(vectors: NDArray[np.floating], up: str) -> NDArray[np.floating]:
    """Return positions, shape (..., 3), of an OpenSim file in x forward, y left, z up.

    OpenSim has x forward, y up and z to the *right*, which is another convention than that of `to_package_axes`: with
    ``up="y"`` the file's (x, y, z) become (x, -z, y). With ``up="z"``, laboratory axes that were never turned for
    OpenSim, nothing changes.
    """
    if up == "z":
        return vectors
    return np.stack((vectors[..., 0], -vectors[..., 2], vectors[..., 1]), axis=-1)


def to_opensim_axes(vectors: NDArray[np.floating], up: str) -> NDArray[np.floating]:
    """Return positions, shape (..., 3), in OpenSim's axes: the inverse of `from_opensim_axes`."""
    if up == "z":
        return vectors
    return np.stack((vectors[..., 0], vectors[..., 2], -vectors[..., 1]), axis=-1)


def check_room(n_joints: int, n_frames: int, n_bytes: int, *, line: int) -> None:
    """Raise if joints without values would make a walk many times as large as its file.

    Parameters
    ----------
    n_joints, n_frames : int
        Three doubles each are kept for every joint in every frame.
    n_bytes : int
        Size of the file. Where all joints have values it is a quarter of that or more, even if all are zeros.
    line : int
        The line for the error.
    """
    size = 24 * n_joints * n_frames
    if size > max(_ALWAYS_ROOM, _MOST_TIMES * n_bytes):
        raise WalkError(
            f"line {line}: expected joints that turn, got {n_joints} joints in {n_frames} frames, {size / 1e9:.1f} GB "
            f"from a file of {n_bytes / 1e6:.1f} MB; remove the joints that never turn"
        )


def check_body(walk: JointWalk, path: Path, unit: str | float) -> None:
    """Raise if the skeleton is of a known rig and its legs are not of a person's length."""
    try:
        rig = find_rig(walk.skeleton.joint_names)
    except ValueError:
        return  # nothing says which joints are the legs
    some = np.unique(np.linspace(0, walk.n_frames - 1, 9).astype(np.intp))  # bones are rigid: a few frames do
    few = replace(
        walk,
        rotations=walk.rotations[some],
        root=walk.root[some],
        translations={joint: moved[some] for joint, moved in walk.translations.items()},
        name=str(path),
    )
    with np.errstate(over="ignore", invalid="ignore"):  # lengths beyond all numbers are refused like other wrong ones
        check_leg_length(few.to_markers(rig), unit=unit)
