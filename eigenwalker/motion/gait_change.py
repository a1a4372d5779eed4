"""A change of harmonics and pace, made to a whole recording: its residual motion, path and stands stay."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from eigenwalker.motion.clip import cut
from eigenwalker.motion.fourier import evaluate_harmonics
from eigenwalker.motion.gait_tracking import GaitTrack
from eigenwalker.motion.legs import find_legs
from eigenwalker.motion.recorded_gait import RecordedGait
from eigenwalker.motion.relative_planting import plant_as_before
from eigenwalker.motion.rig import Place, Rig
from eigenwalker.motion.rotations import unroll_rotvec
from eigenwalker.motion.time_warp import warp_time, warped_frames
from eigenwalker.motion.walk import JointWalk

__all__ = ["change_gait"]


def change_gait(
    gait: RecordedGait,
    joints: Sequence[str],
    coefficients: NDArray[np.floating],
    pace: float,
    *,
    max_knee: float,
    rig: Rig | Mapping[str, Place] | None = None,
) -> JointWalk:
    r"""Return a recording with other harmonics and another pace, upright.

    .. math:: p(t) + \Delta_0 + e(t) \sum_{k=1}^{K} \Delta_{s_k} \sin k \varphi(t) + \Delta_{c_k} \cos k \varphi(t)

    with the phase :math:`\varphi` and the share of walking e of the recording's `GaitTrack`.

    Parameters
    ----------
    gait : RecordedGait
        From `find_gait`.
    joints : sequence of str
        The joints that change.
    coefficients : ndarray of shape (2 K + 1, 3 n_joints)
        What is added to them, rows mean, sin1, cos1, ..., in radians.
    pace : float
        New frequency over old one.
    max_knee : float
        By how much a knee may bend or stretch to keep a foot in its place, in radians.
    rig : Rig or dict, default None
        Which joints are hips, knees and ankles; None recognises the rigs in `RIGS` by their joint names.

    Returns
    -------
    JointWalk
        Frames before and after a leap stay as they are.
    """
    old, track = cut(gait.whole, gait.frames), gait.track
    if pace != 1.0:
        sources = warped_frames(1.0 + (pace - 1.0) * track.share)
        track = GaitTrack(*(np.interp(sources, np.arange(old.n_frames), part) for part in track))
        old = warp_time(old, sources)
    rotations = _add_harmonics(old, joints, coefficients, track)
    legs = find_legs(gait.prepared.skeleton, rig)
    rotations, moved = plant_as_before(rotations, old.rotations, legs, track, max_knee=max_knee)
    speed = old.speed
    if not gait.goes:
        moved, slope = _without_slope(moved)
        speed += float(slope @ [np.cos(track.heading.mean()), np.sin(track.heading.mean())]) * old.frame_rate
    changed = replace(old, rotations=rotations, root=old.root + moved, speed=speed, frequency=old.frequency * pace)
    return _with_ends(changed, gait)


def _add_harmonics(
    walk: JointWalk, joints: Sequence[str], coefficients: NDArray[np.floating], track: GaitTrack
) -> NDArray[np.float64]:
    """Return rotations, shape (n_frames, n_joints, 3), with harmonics added; those of the root along its heading."""
    waving = np.vstack((np.zeros_like(coefficients[:1]), coefficients[1:]))
    waves = evaluate_harmonics(waving, 1 / (2 * np.pi), track.phase)  # one radian a second
    added = (coefficients[0] + track.share[:, np.newaxis] * waves).reshape(walk.n_frames, -1, 3)
    rotations = np.array(walk.rotations, dtype=np.float64)
    for joint, change in zip(joints, added.transpose(1, 0, 2), strict=True):
        place = walk.skeleton.index(joint)
        if place != walk.skeleton.root:
            rotations[:, place] += change
        elif change.any():
            heading = Rotation.from_rotvec(np.outer(track.heading, [0.0, 0.0, 1.0]))
            ahead = unroll_rotvec((heading.inv() * Rotation.from_rotvec(rotations[:, place])).as_rotvec())
            rotations[:, place] = unroll_rotvec((heading * Rotation.from_rotvec(ahead + change)).as_rotvec())
    return rotations


def _without_slope(path: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return a path (n_frames, 3) without the straight line over the floor through it, and its slope, shape (2,)."""
    line = np.vander(np.linspace(-1.0, 1.0, len(path)), 2)
    terms = np.linalg.lstsq(line, path[:, :2])[0]
    return path - np.pad(line @ terms, ((0, 0), (0, 1))), 2 * terms[0] / max(len(path) - 1, 1)


def _with_ends(walk: JointWalk, gait: RecordedGait) -> JointWalk:
    """Put the frames before and after the leaps back to a walk."""
    whole, frames = gait.whole, gait.frames
    if (frames.start, frames.stop) == (0, whole.n_frames):
        return walk
    shift = frames.start / whole.frame_rate

    def put_back(path: NDArray[np.floating], recorded: NDArray[np.floating]) -> NDArray[np.floating]:
        return np.concatenate((recorded[: frames.start], path, recorded[frames.stop :]))

    return replace(
        walk,
        rotations=put_back(walk.rotations, whole.rotations),
        root=put_back(walk.root, whole.root),
        translations={joint: put_back(path, whole.translations[joint]) for joint, path in walk.translations.items()},
        events=tuple(event._replace(time=event.time + shift) for event in walk.events),
    )
