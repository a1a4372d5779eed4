"""A rig says how recorded markers, or the joints of a skeleton, lead to the 15 markers."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.skeleton import FEET, TROJE15

__all__ = ["Estimate", "Place", "Posture", "Rig", "Segment", "as_rig", "locate", "sources"]


class Estimate(NamedTuple):
    """A joint centre that a published rule finds from other places on the body.

    Parameters
    ----------
    rule : callable
        Takes one path a place, each of shape (n_frames, 3), and returns the path of the centre; see
        `eigenwalker.motion.joint_centers`.
    places : tuple of (str, mapping of str to float, or Estimate)
        What the rule takes, in its order.
    """

    rule: Callable[..., NDArray[np.float64]]
    places: tuple["Place", ...]


Place: TypeAlias = str | Mapping[str, float] | Estimate
"""A recorded marker or joint, some of them with weights that sum to one, or an estimate."""


class Segment(NamedTuple):
    """Markers that a bone carries, and what a static trial knows of the same bone.

    Parameters
    ----------
    cluster : tuple of Place
        At least three places on the bone that are not on one line, seen in the walk and in the static trial.
    carried : tuple of str
        Markers on the bone that only the static trial needs to have.
    """

    cluster: tuple[Place, ...]
    carried: tuple[str, ...]


class Posture(NamedTuple):
    """How the bodies of a family of skeletons stand at ease: upright, legs straight, arms hanging, feet flat.

    Parameters
    ----------
    axes : mapping of str to str, default empty
        Where a joint's own x, y and z point then, such as "x-zy": ahead, down, and to the left. Joints that are not
        named point where they do when all rotations are zero.
    foot_pitch : float, default None
        By how many degrees the bone from ankle to toe joint points below the horizontal. None leaves feet as they are
        against the shank when all rotations are zero.
    toe_lift : float, default 0.0
        By how many degrees the axes of the toe joint are pitched up against those of the ankle then.
    toe_height : float, default 0.05
        Height of the toe joint above the floor, in lengths of the leg from hip to ankle.
    heel_back : float, default 0.06
        How far the heel's end lies behind the ankle, in lengths of the leg.
    toe_ahead : float, default 0.07
        How far the toes reach beyond their joint, in lengths of the leg.
    """

    axes: Mapping[str, str] = {}
    foot_pitch: float | None = None
    toe_lift: float = 0.0
    toe_height: float = 0.05
    heel_back: float = 0.06
    toe_ahead: float = 0.07


STANDING = Posture()


def locate(place: Place, names: Sequence[str], positions: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the path of a place, shape (n_frames, 3), from positions of shape (n_frames, n_names, 3)."""
    if isinstance(place, Estimate):
        return place.rule(*(locate(part, names, positions) for part in place.places))
    path = np.zeros((len(positions), 3))
    for name, weight in _weights(place).items():  # what a place does not need may have gaps
        path += weight * positions[:, names.index(name)]
    return path


def sources(place: Place) -> frozenset[str]:
    """Return the names of the markers or joints that a place needs."""
    if isinstance(place, Estimate):
        return frozenset(name for part in place.places for name in sources(part))
    return frozenset(_weights(place))


def _weights(place: str | Mapping[str, float]) -> Mapping[str, float]:
    return {place: 1.0} if isinstance(place, str) else place


@dataclass(frozen=True)
class Rig:
    """How the joints of one family of skeletons, or the markers of one marker set, lead to the 15 markers.

    Parameters
    ----------
    name : str
        What the family or the marker set is called.
    markers : mapping of str to Place
        For each marker of `TROJE15` the joint or marker it is, or those it lies between with weights that sum to one,
        or an `Estimate`. A weight beyond one carries the marker past a joint along a bone. The markers of the feet
        (left_heel, left_toe, right_heel, right_toe) may be added.
    posture : Posture, default STANDING
        The reference posture of skeletons, from which their joints are counted.
    segments : tuple of Segment, default ()
        How a static trial completes the markers of a walk. A marker that two segments carry is put midway.
    """

    name: str
    markers: Mapping[str, Place]
    posture: Posture = STANDING
    segments: tuple[Segment, ...] = ()

    def __post_init__(self) -> None:
        faults = _faults(self.markers)
        if faults:
            raise ValueError(f"rig {self.name!r} {'; '.join(faults)}")

    @cached_property  # asked of every known rig whenever one is looked for
    def sources(self) -> frozenset[str]:
        """The joints or markers that the 15 markers need."""
        return frozenset(name for marker in TROJE15.names for name in sources(self.markers[marker]))

    def joint(self, marker: str) -> str:
        """Return the joint that a marker is, or raise where it lies between several."""
        place = self.markers[marker]
        if not isinstance(place, str):
            raise ValueError(f"rig {self.name!r}: expected one joint for {marker}, got {place!r}")
        return place

    def place(
        self, names: Sequence[str], positions: NDArray[np.floating], markers: Sequence[str] = TROJE15.names
    ) -> NDArray[np.float64]:
        """Return the paths of markers, shape (n_frames, n_markers, 3).

        Parameters
        ----------
        names : sequence of str
            Recorded joints or markers.
        positions : ndarray of shape (n_frames, n_names, 3)
            Where they are.
        markers : sequence of str, default the 15 markers
            What to place.
        """
        missing = [marker for marker in markers if marker not in self.markers]
        if missing:
            raise ValueError(f"rig {self.name!r} does not place {', '.join(missing)}; it has {', '.join(self.markers)}")
        wanted = frozenset(name for marker in markers for name in sources(self.markers[marker]))
        absent = sorted(wanted - set(names))
        if absent:
            raise ValueError(f"rig {self.name!r} needs {', '.join(absent)}; found {', '.join(names)}")
        return np.stack([locate(self.markers[marker], names, positions) for marker in markers], axis=1)


def as_rig(rig: Rig | Mapping[str, Place], names: Iterable[str] | None = None) -> Rig:
    """Return a rig, or the rig that a plain dictionary stands for.

    Parameters
    ----------
    rig : Rig or mapping
        A dictionary is the `markers` of a rig: ``{"head": "HEAD", "left_knee": {"LKNE": 0.5, "LKNM": 0.5}, ...}``.
    names : iterable of str, default None
        The joints or markers there are, if known: a dictionary that needs others is refused.

    Returns
    -------
    Rig

    Raises
    ------
    TypeError
        If it is neither.
    ValueError
        With all that is wrong with the dictionary, and the names found.
    """
    if isinstance(rig, Rig):
        return rig
    if not isinstance(rig, Mapping):
        raise TypeError(f"expected a Rig or a dictionary of the 15 markers, got {type(rig).__name__}")
    faults = _faults(rig)
    found = list(names) if names is not None else []
    needed = {name for place in rig.values() if _is_place(place) for name in sources(place)}
    absent = sorted(needed - set(found)) if names is not None else []
    if absent:
        faults.append(f"needs {', '.join(absent)}")
    if faults:
        there = f"; found {', '.join(found)}" if names is not None else ""
        raise ValueError(f"the map of markers {'; '.join(faults)}{there}")
    return Rig("map", dict(rig))


def _faults(markers: Mapping[str, Place]) -> list[str]:
    """Say all that is wrong with places of markers."""
    missing = [name for name in TROJE15.names if name not in markers]
    unknown = [str(name) for name in markers if name not in (*TROJE15.names, *FEET)]
    strange = [str(name) for name, place in markers.items() if not _is_place(place)]
    uneven = [str(name) for name, place in markers.items() if _is_place(place) and not _is_even(place)]
    kinds = {
        "must place all 15 markers; it lacks": missing,
        f"may place the 15 markers and {', '.join(FEET)}, but not": unknown,
        "must give the name of a marker, or names with weights, but does not for": strange,
        "weights must sum to one, but not for": uneven,
    }
    return [f"{fault} {', '.join(names)}" for fault, names in kinds.items() if names]


def _is_place(place: object) -> bool:
    if isinstance(place, (str, Estimate)):
        return bool(place)
    return isinstance(place, Mapping) and all(
        isinstance(name, str) and isinstance(weight, Real) and not isinstance(weight, bool)
        for name, weight in place.items()
    )


def _is_even(place: Place) -> bool:
    if isinstance(place, Estimate):
        return all(_is_even(part) for part in place.places)
    return abs(sum(_weights(place).values()) - 1) <= 1e-9  # False for NaN
