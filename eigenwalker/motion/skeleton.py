"""Names and anatomy: marker sets and skeletons."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import check_array, check_names, restore_read_only

__all__ = ["FEET", "TROJE15", "TROJE15_AND_FEET", "MarkerSet", "Skeleton"]


@dataclass(frozen=True)
class MarkerSet:
    """Names of markers, in order, and the sticks that connect them in a picture.

    Parameters
    ----------
    names : tuple of str
        One name a marker. Markers of the two body sides start with ``left_`` and ``right_``.
    sticks : tuple of (str, str), default ()
        Pairs of names to be drawn as lines.

    Examples
    --------
    >>> from eigenwalker.motion import MarkerSet
    >>> feet = MarkerSet(("left_ankle", "right_ankle", "pelvis"))
    >>> feet.names[feet.mirror[0]]
    'right_ankle'
    """

    names: tuple[str, ...]
    sticks: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", check_names(self.names, name="names"))
        unknown = sorted({end for stick in self.sticks for end in stick} - set(self.names))
        if unknown:
            raise ValueError(f"sticks must join known markers, got {', '.join(unknown)}")

    def index(self, name: str) -> int:
        """Return the position of a marker, or raise an error that lists the names."""
        if name not in self.names:
            raise ValueError(f"no marker {name!r}; this marker set has {', '.join(self.names)}")
        return self.names.index(name)

    @property
    def mirror(self) -> NDArray[np.intp]:
        """Position of each marker's partner on the other side of the body, shape (n_markers,)."""
        partners = [_other_side(name) for name in self.names]
        alone = [name for name, partner in zip(self.names, partners, strict=True) if partner not in self.names]
        if alone:
            raise ValueError(f"markers without a partner on the other side: {', '.join(alone)}")
        return np.array([self.names.index(partner) for partner in partners])


def _other_side(name: str) -> str:
    if name.startswith("left_"):
        return "right_" + name.removeprefix("left_")
    if name.startswith("right_"):
        return "left_" + name.removeprefix("right_")
    return name


_LIMBS = (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"))

TROJE15 = MarkerSet(
    names=(
        "head",
        "clavicle",
        *(f"{side}_{joint}" for side in ("left", "right") for joint in ("shoulder", "elbow", "wrist")),
        "pelvis",
        *(f"{side}_{joint}" for side in ("left", "right") for joint in ("hip", "knee", "ankle")),
    ),
    sticks=(
        ("head", "clavicle"),
        ("clavicle", "pelvis"),
        *(("clavicle", f"{side}_shoulder") for side in ("left", "right")),
        *(("pelvis", f"{side}_hip") for side in ("left", "right")),
        *((f"{side}_{upper}", f"{side}_{lower}") for side in ("left", "right") for upper, lower in _LIMBS),
    ),
)
"""The 15 virtual markers of Troje 2002, section 2, in the order of this package."""

FEET = tuple(f"{side}_{end}" for side in ("left", "right") for end in ("heel", "toe"))
"""Markers of the feet, which say when they touch the floor. The model does without them."""

TROJE15_AND_FEET = MarkerSet(
    (*TROJE15.names, *FEET),
    (*TROJE15.sticks, *((f"{side}_{end}", f"{side}_heel") for side in ("left", "right") for end in ("ankle", "toe"))),
)


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A tree of joints with the bones between them, in the posture where all rotations are zero.

    Parameters
    ----------
    joint_names : tuple of str
        Parents before children; the first one is the top of the tree.
    parents : ndarray of shape (n_joints,)
        Position of each joint's parent, -1 for the first.
    offsets : ndarray of shape (n_joints, 3)
        From the parent's joint to this one, in the parent's frame, in metres.
    end_parents : ndarray of shape (n_ends,), default empty
        Joints that end in a tip without a joint (fingers, toes, top of the head).
    end_offsets : ndarray of shape (n_ends, 3), default empty
        From that joint to the tip, in metres.
    root : int, default 0
        The joint that carries the body through space. It is not the first one in files that put
        a fixed reference above the hips.
    rotation_orders : tuple of str, default None
        For each joint the order, such as "XYZ", in which files write its angles: the letters are the package's axes,
        as in `euler_from_rotvec`. It changes no rotation. None leaves the orders to whoever writes a file.
    upright : bool, default False
        Whether the body stands at ease along x where all rotations are zero, with all joints' own axes along those of
        the room: what `stand_upright` makes. Then a turn about y, to the left, swings a leg back in every skeleton.
    """

    joint_names: tuple[str, ...]
    parents: NDArray[np.intp]
    offsets: NDArray[np.floating]
    end_parents: NDArray[np.intp] = field(default_factory=lambda: np.empty(0, dtype=np.intp))
    end_offsets: NDArray[np.floating] = field(default_factory=lambda: np.empty((0, 3)))
    root: int = 0
    rotation_orders: tuple[str, ...] | None = None
    upright: bool = False

    def __post_init__(self) -> None:
        names = check_names(self.joint_names, name="joint_names")
        parents = np.array(self.parents, dtype=np.intp)
        ends = np.array(self.end_parents, dtype=np.intp)
        if parents.shape != (len(names),):
            raise ValueError(f"parents must have shape ({len(names)},), one a joint, got {parents.shape}")
        if not names or parents[0] != -1 or (parents[1:] < 0).any() or (parents >= np.arange(len(names))).any():
            raise ValueError("parents must be -1 for the first joint and an earlier joint for all others")
        if ends.ndim != 1 or ((ends < 0) | (ends >= len(names))).any():
            raise ValueError(f"end_parents must be positions of joints below {len(names)}, got {ends}")
        if not 0 <= self.root < len(names):
            raise ValueError(f"root must be the position of a joint below {len(names)}, got {self.root}")
        if self.rotation_orders is not None:
            object.__setattr__(self, "rotation_orders", _check_orders(self.rotation_orders, len(names)))
        for array in (parents, ends):
            array.flags.writeable = False
        object.__setattr__(self, "joint_names", names)
        object.__setattr__(self, "parents", parents)
        object.__setattr__(self, "end_parents", ends)
        object.__setattr__(self, "offsets", check_array(self.offsets, shape=(len(names), 3), name="offsets"))
        object.__setattr__(self, "end_offsets", check_array(self.end_offsets, shape=(len(ends), 3), name="end_offsets"))

    def __setstate__(self, state: dict[str, object]) -> None:
        restore_read_only(self, state)

    def index(self, joint: str) -> int:
        """Return the position of a joint, or raise an error that lists the names."""
        if joint not in self.joint_names:
            raise ValueError(f"no joint {joint!r}; this skeleton has {', '.join(self.joint_names)}")
        return self.joint_names.index(joint)

    def in_order(self, joints: Iterable[str]) -> tuple[str, ...]:
        """Return joints in the order of the skeleton, or raise an error that lists its names."""
        return tuple(self.joint_names[place] for place in sorted({self.index(joint) for joint in joints}))

    def above(self, joint: int) -> list[int]:
        """Return the positions of the joints from the top of the tree down to the parent of a joint."""
        found: list[int] = []
        while (joint := int(self.parents[joint])) >= 0:
            found.insert(0, joint)
        return found


def _check_orders(orders: Iterable[str], n_joints: int) -> tuple[str, ...]:
    """Return `orders` as a tuple with one order of the three axes a joint."""
    result = (orders,) if isinstance(orders, str) else tuple(orders)
    if len(result) != n_joints or any(sorted(order) != ["X", "Y", "Z"] for order in result):
        raise ValueError(f"rotation_orders must be {n_joints} orders of X, Y and Z, one a joint, got {result}")
    return result
