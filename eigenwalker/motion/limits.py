"""How far the joints of people turn, and walks in which they turn further."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple, TypeGuard

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from eigenwalker._validation import check_finite
from eigenwalker.motion.rig import Place, Rig, as_rig
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["JointLimitWarning", "joint_limits_exceeded", "warn_joint_limits"]

_COLUMNS = ("joint", "movement", "degrees", "limit", "share_of_frames")


class JointLimitWarning(UserWarning):
    """A joint of a generated walk turns further than the joints of people do."""


class _Limit(NamedTuple):
    """How far a joint turns, and the name of that movement, to the positive and to the negative side, in degrees.

    `slack` is how uncertain the zero is. Knees and elbows are straight where their bones are. Thighs, upper arms and
    feet count from pelvis, chest and shank in a reference posture that is not the one of a clinician: hips of recorded
    walks extend by up to 6 degrees more than the limit, and ankles that bear weight on a bent knee flex by up to 20.
    """

    positive: tuple[str, float]
    negative: tuple[str, float]
    slack: float


_SAGITTAL = {
    "hip": _Limit(("flexion", 120), ("extension", 30), 20),
    "knee": _Limit(("flexion", 135), ("hyperextension", 10), 0),
    "ankle": _Limit(("dorsiflexion", 20), ("plantar flexion", 50), 30),
    "shoulder": _Limit(("flexion", 180), ("extension", 60), 20),
    "elbow": _Limit(("flexion", 150), ("hyperextension", 10), 0),
}
_FRONTAL = {"hip": _Limit(("abduction", 45), ("adduction", 30), 20)}


def joint_limits_exceeded(walk: JointWalk, rig: Rig | Mapping[str, Place] | None = None) -> pd.DataFrame:
    """Return where the joints of a walk turn further than those of people.

    The limits are the averages of the American Academy of Orthopaedic Surgeons (1965, Joint Motion: Method of Measuring
    and Recording): hip flexion 120, extension 30, abduction 45, adduction 30; knee flexion 135; ankle dorsiflexion 20,
    plantar flexion 50; shoulder flexion 180, extension 60; elbow flexion 150; with 10 degrees of hyperextension of
    knees and elbows. For hips and shoulders 20 degrees are added, for ankles 30: a skeleton's reference posture is not
    a clinician's zero. No recorded walk that the package was tried with exceeds them.

    Parameters
    ----------
    walk : JointWalk
        Upright, from `prepare` or `stand_upright`.
    rig : Rig or dict, default None
        Which joints are hips, knees ...; None recognises the rigs in `RIGS` by their joint names.

    Returns
    -------
    DataFrame
        One row a joint and movement beyond its limit: ``joint``, as left_knee; ``movement``; ``degrees``, at the worst
        frame; ``limit``, what is allowed, in degrees; and ``share_of_frames`` beyond it. Empty where there is none.

    Raises
    ------
    TypeError
        If the walk has markers.
    ValueError
        If it is not upright, has values that are not finite, or no rig is recognised.

    Notes
    -----
    Measured is the swing that turns the bone below a joint, the shortest way, from hanging straight down to where it
    points, seen from the bone above: its part in the sagittal plane and that in the frontal plane. Ankles have the
    pitch of the foot. Turns about the bone itself are not measured.

    Examples
    --------
    >>> from eigenwalker import prepare, read_walk
    >>> from eigenwalker.motion import joint_limits_exceeded
    >>> walk = prepare(read_walk("broken.bvh"), representation="joints")  # doctest: +SKIP
    >>> joint_limits_exceeded(walk)  # doctest: +SKIP
           joint        movement  degrees  limit  share_of_frames
    0  left_knee  hyperextension     17.2   10.0             0.25
    """
    if not isinstance(walk, JointWalk):
        raise TypeError(f"joint limits are those of a JointWalk, got {type(walk).__name__}")
    if not walk.skeleton.upright:
        raise ValueError(
            f"walk {walk.name!r}: in the axes of a file no turn is flexion; bring it to the axes of the room, "
            "prepare(walk, representation='joints') or stand_upright(walk)"
        )
    names = walk.skeleton.joint_names
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    rig = find_rig(names) if rig is None else as_rig(rig, names)
    return pd.DataFrame(list(_excesses(walk, rig)), columns=list(_COLUMNS))


def _excesses(walk: JointWalk, rig: Rig) -> Iterator[tuple[str, str, float, float, float]]:
    for side in ("left", "right"):
        for joint, sagittal in _SAGITTAL.items():
            marker = f"{side}_{joint}"
            turn = Rotation.from_rotvec(np.array(walk.rotations[:, walk.skeleton.index(rig.joint(marker))]))
            ahead, outward = _angles(joint, turn, 1.0 if side == "left" else -1.0)
            yield from _beyond(marker, ahead, sagittal)
            if joint in _FRONTAL:
                yield from _beyond(marker, outward, _FRONTAL[joint])


def _angles(joint: str, turn: Rotation, side: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return flexion and abduction in each frame, (n_frames,), in degrees."""
    if joint == "ankle":
        foot = turn.apply([1.0, 0.0, 0.0])
        return np.rad2deg(np.arctan2(foot[:, 2], foot[:, 0])), np.zeros(len(foot))
    bone = turn.apply([0.0, 0.0, -1.0])
    aside = np.hypot(bone[:, 0], bone[:, 1])
    swing = np.rad2deg(np.arctan2(aside, -bone[:, 2])) / np.maximum(aside, np.finfo(np.float64).tiny)
    return (-1 if joint == "knee" else 1) * swing * bone[:, 0], side * swing * bone[:, 1]


def _beyond(marker: str, angles: NDArray[np.float64], limit: _Limit) -> Iterator[tuple[str, str, float, float, float]]:
    for sign, (movement, degrees) in ((1, limit.positive), (-1, limit.negative)):
        allowed = float(degrees + limit.slack)
        beyond = sign * angles > allowed
        if beyond.any():
            yield marker, movement, float((sign * angles).max()), allowed, float(beyond.mean())


def warn_joint_limits(walks: Sequence[Walk | JointWalk], *, stacklevel: int = 3) -> None:
    """Warn if joints of generated walks exceed their limits, naming walk, joint and degrees; silent about markers.

    Parameters
    ----------
    walks : sequence of Walk or JointWalk
        Those that are not upright, or of no known rig, say nothing about flexion and are passed over.
    stacklevel : int, default 3
        As in `warnings.warn`; 3 is who called the function that calls this one.
    """
    found = [(walk.name, row) for walk in walks if _is_known(walk) for row in joint_limits_exceeded(walk).itertuples()]
    if not found:
        return
    worst = sorted(found, key=lambda one: one[1].limit - one[1].degrees)
    shown = "; ".join(
        f"{name!r}, {row.joint}: {row.movement} {row.degrees:.0f} degrees, limit {row.limit:.0f}"
        for name, row in worst[:4]
    )
    warnings.warn(
        f"beyond the joints of people in {len({name for name, _ in found})} of {len(walks)} walks: "
        f"{shown}{' ...' if len(worst) > 4 else ''}; use an alpha or weights nearer to the recorded walks",
        JointLimitWarning,
        stacklevel=stacklevel,
    )


def _is_known(walk: Walk | JointWalk) -> TypeGuard[JointWalk]:
    if not isinstance(walk, JointWalk) or not walk.skeleton.upright:
        return False
    try:
        find_rig(walk.skeleton.joint_names)
    except ValueError:
        return False
    return True
