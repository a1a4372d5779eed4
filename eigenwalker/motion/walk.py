"""The two containers: marker positions over time and joint rotations over time."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import WalkError, check_array, check_frame_rate, restore_read_only
from eigenwalker.motion.rig import Place, Rig, as_rig
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.rotations import forward_kinematics
from eigenwalker.motion.skeleton import TROJE15, TROJE15_AND_FEET, MarkerSet, Skeleton
from eigenwalker.motion.static_trial import carry_markers, hold_legs

__all__ = ["AnyWalk", "Event", "JointWalk", "Walk", "check_marker_walk", "hip_flexion"]

_AXES = ("x", "y", "z")


class Event(NamedTuple):
    """Something that happens at one time in a walk, such as a heel strike.

    Parameters
    ----------
    time : float
        Seconds from the first frame.
    kind : str
        "heel_strike", "toe_off", or what a file calls it.
    side : str, default ""
        "left", "right", or "" where the event has no side.
    """

    time: float
    kind: str
    side: str = ""


@dataclass(frozen=True, eq=False)
class Walk:
    """Marker positions of one walk.

    Axes are right-handed: x forward, y to the walker's left, z up.

    Parameters
    ----------
    positions : ndarray of shape (n_frames, n_markers, 3)
        In metres. NaN marks a gap. Stored read-only.
    frame_rate : float
        Frames per second.
    marker_set : MarkerSet, default TROJE15
        Names of the markers, in the order of the second axis.
    name : str, default ""
        What the walk is called in tables and errors, and what labels are joined by.
    speed : float, default NaN
        Speed of the treadmill belt in m/s; NaN where it is unknown.
    size : float, default 1.0
        The factor by which the positions were divided to take body size out.
    events : tuple of Event, default ()
        Known events, ordered by time.
    frequency : float, default NaN
        Strides per second, where they are known from events or from a file; NaN leaves them to be found in the motion.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import Walk
    >>> walk = Walk(np.zeros((240, 15, 3)), frame_rate=120, name="anna")
    >>> walk.channels.shape, walk.duration
    ((240, 45), 2.0)
    """

    positions: NDArray[np.floating]
    frame_rate: float
    marker_set: MarkerSet = TROJE15
    name: str = ""
    speed: float = float("nan")
    size: float = 1.0
    events: tuple[Event, ...] = ()
    frequency: float = float("nan")

    def __post_init__(self) -> None:
        if not isinstance(self.marker_set, MarkerSet):
            raise TypeError(f"marker_set must be a MarkerSet, got {type(self.marker_set).__name__}")
        shape = ("n_frames", len(self.marker_set.names), 3)
        object.__setattr__(self, "positions", check_array(self.positions, shape=shape, name="positions"))
        _check_common(self)

    def __setstate__(self, state: dict[str, object]) -> None:
        restore_read_only(self, state)

    @property
    def n_frames(self) -> int:
        """Number of frames."""
        return len(self.positions)

    @property
    def duration(self) -> float:
        """Number of frames over frame rate, in seconds."""
        return self.n_frames / self.frame_rate

    @property
    def channels(self) -> NDArray[np.floating]:
        """The positions as a matrix, shape (n_frames, n_channels), n_channels = 3 n_markers."""
        return self.positions.reshape(self.n_frames, -1)  # (n_frames, n_markers, 3) -> (n_frames, 3 n_markers)

    @property
    def channel_names(self) -> tuple[str, ...]:
        """Names of the channels, ``left_ankle_x`` and so on."""
        return _channels_of(self.marker_set.names)

    @property
    def phase_channels(self) -> dict[str, float]:
        """Channels, with weights, whose sum carries the phase of the gait: left minus right ankle, forward."""
        return {"left_ankle_x": 1.0, "right_ankle_x": -1.0}

    def marker(self, name: str) -> NDArray[np.floating]:
        """Return the path of one marker, shape (n_frames, 3), in metres."""
        return self.positions[:, self.marker_set.index(name)]

    def with_channels(self, channels: ArrayLike, **changes: Any) -> "Walk":
        """Return a copy with other channels, shape (n_frames, n_channels), and with `changes` of other fields."""
        matrix = check_array(channels, shape=("n_frames", len(self.channel_names)), name="channels")
        positions = matrix.reshape(len(matrix), -1, 3)  # (n_frames, 3 n_markers) -> (n_frames, n_markers, 3)
        return replace(self, positions=positions, **changes)

    def to_markers(
        self,
        rig: Rig | Mapping[str, Place] | None = None,
        *,
        static: "Walk | None" = None,
        feet: bool = False,
    ) -> "Walk":
        """Return the walk of the 15 markers of Troje 2002 that lie between or under the recorded markers.

        Parameters
        ----------
        rig : Rig or dict, default None
            Which markers make each of the 15: ``{"head": "HEAD", "left_knee": {"LKNE": 0.5, "LKNM": 0.5}, ...}``,
            names with weights that sum to one. None recognises the marker sets in `RIGS` by their names: these 15,
            the Kinect's joints, Plug-in Gait, and the markers of Horst et al. 2019.
        static : Walk, default None
            A static trial of the same person, which completes the markers (`carry_markers` with the segments of the
            rig) and says how long thighs and shanks are (`hold_legs`). None does without.
        feet : bool, default False
            Whether left_heel, left_toe, right_heel and right_toe are kept behind the 15, for `detect_events`.

        Returns
        -------
        Walk
            With `TROJE15` markers and everything else as in this walk, events among it. A walk of these 15 is
            returned as it is.

        Raises
        ------
        WalkError
            If no rig is given and none is recognised, or if markers are missing; it lists those found.

        Examples
        --------
        >>> from eigenwalker import read_walk
        >>> from eigenwalker.motion import detect_events
        >>> static = read_walk("S01_0001_Static.c3d")  # doctest: +SKIP
        >>> walk = read_walk("S01_0002_Gait.c3d").to_markers(static=static, feet=True)  # doctest: +SKIP
        >>> walk = detect_events(walk).to_markers()  # the 15 markers, with events  # doctest: +SKIP
        """
        if rig is None and static is None and not feet and self.marker_set.names == TROJE15.names:
            return self
        try:
            return self._place(rig, static, TROJE15_AND_FEET if feet else TROJE15)
        except WalkError:
            raise
        except ValueError as error:
            raise WalkError(f"walk {self.name!r}: {error}") from None

    def _place(self, rig: Rig | Mapping[str, Place] | None, static: "Walk | None", marker_set: MarkerSet) -> "Walk":
        """Return the walk with the markers of a set that a rig places."""
        if static is not None and not isinstance(static, Walk):
            raise TypeError(f"static must be a Walk, the static trial, got {type(static).__name__}")
        found = [*self.marker_set.names, *(static.marker_set.names if static is not None else ())]
        rig = find_rig(found) if rig is None else as_rig(rig, found)
        full = self if static is None else carry_markers(self, static, rig.segments)
        positions = rig.place(full.marker_set.names, full.positions, marker_set.names)
        if static is not None:
            positions = hold_legs(positions, marker_set.names, rig, static)
        return replace(self, positions=positions, marker_set=marker_set)


@dataclass(frozen=True, eq=False)
class JointWalk:
    """Joint rotations of one walk, and the path of its root.

    Parameters
    ----------
    rotations : ndarray of shape (n_frames, n_joints, 3)
        Exponential maps, in radians: the rotation of each joint against its parent, axis times angle.
    root : ndarray of shape (n_frames, 3)
        Position of the joint `skeleton.root` in its parent's frame, in metres.
    skeleton : Skeleton
        Joints and bones.
    frame_rate : float
        Frames per second.
    name : str, default ""
        What the walk is called in tables and errors, and what labels are joined by.
    speed : float, default NaN
        Speed of the treadmill belt in m/s; NaN where it is unknown.
    size : float, default 1.0
        The factor by which the body was divided to take its size out.
    translations : mapping of str to ndarray of shape (n_frames, 3), default empty
        Joints other than the root that move against their parent, in metres. Joints that are not
        named stay at their offset in the skeleton.
    events : tuple of Event, default ()
        Known events, ordered by time.
    frequency : float, default NaN
        Strides per second, where they are known from events or from a file; NaN leaves them to be found in the motion.
    channel_joints : tuple of str, default None
        The joints whose rotations are `channels`, in the order of the skeleton: `prepare` leaves those out that stand
        still. None is all of them.
    """

    rotations: NDArray[np.floating]
    root: NDArray[np.floating]
    skeleton: Skeleton
    frame_rate: float
    name: str = ""
    speed: float = float("nan")
    size: float = 1.0
    translations: Mapping[str, NDArray[np.floating]] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    frequency: float = float("nan")
    channel_joints: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.skeleton, Skeleton):
            raise TypeError(f"skeleton must be a Skeleton, got {type(self.skeleton).__name__}")
        shape = ("n_frames", len(self.skeleton.joint_names), 3)
        rotations = check_array(self.rotations, shape=shape, name="rotations")
        object.__setattr__(self, "rotations", rotations)
        object.__setattr__(self, "root", check_array(self.root, shape=(len(rotations), 3), name="root"))
        unknown = sorted(set(self.translations) - set(self.skeleton.joint_names))
        if unknown:
            raise ValueError(f"translations must name joints of the skeleton, got {', '.join(unknown)}")
        moving = {
            joint: check_array(path, shape=(len(rotations), 3), name=f"translations[{joint!r}]")
            for joint, path in self.translations.items()
        }
        object.__setattr__(self, "translations", moving)
        if self.channel_joints is not None:
            object.__setattr__(self, "channel_joints", self.skeleton.in_order(self.channel_joints))
        _check_common(self)

    def __setstate__(self, state: dict[str, object]) -> None:
        restore_read_only(self, state)

    @property
    def n_frames(self) -> int:
        """Number of frames."""
        return len(self.rotations)

    @property
    def duration(self) -> float:
        """Number of frames over frame rate, in seconds."""
        return self.n_frames / self.frame_rate

    @property
    def channels(self) -> NDArray[np.floating]:
        """The rotations as a matrix, shape (n_frames, n_channels), three channels a joint of `channel_joints`."""
        picked = self.rotations if self.channel_joints is None else self.rotations[:, self._columns()]
        return picked.reshape(self.n_frames, -1)  # (n_frames, n_joints, 3) -> (n_frames, 3 n_joints)

    @property
    def channel_names(self) -> tuple[str, ...]:
        """Names of the channels, ``LeftUpLeg_y`` and so on."""
        return _channels_of(self.skeleton.joint_names if self.channel_joints is None else self.channel_joints)

    def _columns(self) -> NDArray[np.intp]:
        """Positions of the joints that have channels, shape (n_channels / 3,)."""
        names = self.skeleton.joint_names
        joints = names if self.channel_joints is None else self.channel_joints
        return np.array([names.index(joint) for joint in joints], dtype=np.intp)

    @property
    def phase_channels(self) -> dict[str, float]:
        """Channels, with weights, whose sum carries the phase: left minus right hip flexion.

        Raises
        ------
        ValueError
            If no rig is recognised, or if the skeleton's axes are those of a file, in which flexion is anything.
        """
        if not self.skeleton.upright:
            raise ValueError(
                f"walk {self.name!r}: in the axes of a file no channel is hip flexion; bring it to the axes of the "
                "room, prepare(walk, representation='joints') or stand_upright(walk), or pass "
                "phase_reference={channel: weight} whose sum is left minus right"
            )
        try:
            return hip_flexion(find_rig(self.skeleton.joint_names))
        except ValueError:
            raise ValueError(
                f"walk {self.name!r}: its joints are of no known rig, so which channel is hip flexion is unknown; pass "
                "phase_reference={left hip_y: -1.0, right hip_y: 1.0} with the names of its joints, "
                f"{', '.join(self.skeleton.joint_names)}"
            ) from None

    def with_channels(self, channels: ArrayLike, **changes: Any) -> "JointWalk":
        """Return a copy with other rotations, shape (n_frames, n_channels), and with `changes` of other fields.

        The root path must be among the changes when the number of frames is another one. Joints without channels then
        stand as in the first frame.
        """
        matrix = check_array(channels, shape=("n_frames", len(self.channel_names)), name="channels")
        turning = matrix.reshape(len(matrix), -1, 3)  # (n_frames, 3 n_joints) -> (n_frames, n_joints, 3)
        if self.channel_joints is None:
            return replace(self, rotations=turning, **changes)
        same = len(matrix) == self.n_frames
        rotations = np.array(self.rotations) if same else np.repeat(self.rotations[:1], len(matrix), axis=0)
        rotations[:, self._columns()] = turning
        rotations.flags.writeable = False  # else the walk keeps a copy
        return replace(self, rotations=rotations, **changes)

    def joint_positions(self) -> NDArray[np.float64]:
        """Return where the joints are, shape (n_frames, n_joints, 3), in metres, by forward kinematics."""
        return forward_kinematics(self.rotations, self._local_positions(), self.skeleton.parents)[0]

    def end_positions(self) -> NDArray[np.float64]:
        """Return where the tips of the skeleton are, shape (n_frames, n_ends, 3), in metres."""
        skeleton = self.skeleton
        joints, frames = forward_kinematics(self.rotations, self._local_positions(), skeleton.parents)
        held = frames[:, skeleton.end_parents]  # (n_frames, n_ends, 3, 3)
        return joints[:, skeleton.end_parents] + np.einsum("teij,ej->tei", held, skeleton.end_offsets)

    def to_markers(self, rig: Rig | Mapping[str, Place] | None = None) -> Walk:
        """Return the walk of the 15 markers of Troje 2002 that this skeleton carries.

        Parameters
        ----------
        rig : Rig or dict, default None
            Which joints make each marker, as in `Walk.to_markers`. None recognises the rigs in `RIGS` by their joint
            names.

        Returns
        -------
        Walk
            With `TROJE15` markers, and everything else as in this walk.

        Raises
        ------
        ValueError
            If no rig is given and none is recognised, or if the rig needs joints that are missing.
        """
        names = self.skeleton.joint_names
        rig = find_rig(names) if rig is None else as_rig(rig, names)
        positions = rig.place(names, self.joint_positions())
        return Walk(positions, self.frame_rate, TROJE15, self.name, self.speed, self.size, self.events, self.frequency)

    def _local_positions(self) -> NDArray[np.float64]:
        """Position of each joint in its parent's frame, shape (n_frames, n_joints, 3)."""
        skeleton = self.skeleton
        local = np.tile(np.asarray(skeleton.offsets, dtype=np.float64), (self.n_frames, 1, 1))
        for joint, path in self.translations.items():
            local[:, skeleton.joint_names.index(joint)] = path
        local[:, skeleton.root] = self.root
        return local


def hip_flexion(rig: Rig) -> dict[str, float]:
    """Return the channels, with weights, that add up to left minus right hip flexion in upright skeletons of a rig."""
    return {f"{rig.joint('left_hip')}_y": -1.0, f"{rig.joint('right_hip')}_y": 1.0}


AnyWalk = TypeVar("AnyWalk", Walk, JointWalk)
"""Of what a function returns the same kind that it takes."""


@lru_cache(maxsize=64)  # walks share their markers
def _channels_of(places: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of the channels of markers or joints."""
    return tuple(f"{place}_{axis}" for place in places for axis in _AXES)


def _check_common(walk: Walk | JointWalk) -> None:
    """Check the fields that both kinds of walk share."""
    object.__setattr__(walk, "frame_rate", check_frame_rate(walk.frame_rate))
    if not isinstance(walk.name, str):
        raise TypeError(f"name must be a string, got {type(walk.name).__name__}")
    object.__setattr__(walk, "speed", float(walk.speed))
    object.__setattr__(walk, "size", float(walk.size))
    if not (np.isfinite(walk.size) and walk.size > 0):
        raise ValueError(f"size must be positive and finite, got {walk.size}")
    object.__setattr__(walk, "frequency", float(walk.frequency))
    if not (np.isnan(walk.frequency) or 0 < walk.frequency < np.inf):
        raise ValueError(f"frequency must be positive and finite, or NaN where unknown, got {walk.frequency}")
    wrong = [event for event in walk.events if not (isinstance(event, Event) and np.isfinite(event.time))]
    if wrong:
        raise TypeError(f"events must be Event(time, kind, side) with finite times, got {wrong[0]!r}")
    object.__setattr__(walk, "events", tuple(sorted(walk.events)))
    if walk.n_frames == 0:
        raise ValueError(f"walk {walk.name!r}: expected at least one frame, got none")


def check_marker_walk(walk: object) -> Walk:
    """Return `walk` if it is a walk of markers, else raise a TypeError."""
    if not isinstance(walk, Walk):
        raise TypeError(f"expected a Walk, got {type(walk).__name__}; turn joints into markers with to_markers()")
    return walk
