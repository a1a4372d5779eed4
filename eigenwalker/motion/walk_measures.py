"""How physical a walk is: bones, feet on the floor, jumps of the root and smoothness, in one table."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import repeat
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_finite, check_walks
from eigenwalker.motion.footing import Footing, contact_path, find_footing, marker_walk, path_velocity
from eigenwalker.motion.gait import SIDES, find_steps
from eigenwalker.motion.heading import turn
from eigenwalker.motion.rig import Place, Rig
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["quality_table"]

_BONES = (("hip", "knee"), ("knee", "ankle"), ("shoulder", "elbow"), ("elbow", "wrist"))


def quality_table(
    walks: Sequence[Walk | JointWalk],
    reference: Sequence[Walk | JointWalk] | None = None,
    *,
    rig: Rig | Mapping[str, Place] | None = None,
) -> pd.DataFrame:
    """Return how physical walks are, one row a walk: synthetic ones, and beside them those they were made from.

    *When a foot stands* is decided by the motion of the feet against the pelvis alone: the heel strikes when it is
    furthest in front of the pelvis, the toes leave when they are furthest behind (`heel_strikes`, `toe_offs`; Zeni et
    al. 2008). Events that a walk holds are not used. A foot stands alone from the toe off to the heel strike of the
    other one, a step; it trails from the heel strike of the other one to its own toe off. *Where it stands*: from each
    frame to the next the point of the sole that is the lowest on average of the two. The path of these points over
    the floor is what the foot slides. It is a path, so that noise adds to it. Toes that leave already move with the
    pelvis when they are furthest behind it, so that a trailing foot slides a little in every walk.

    Joints have soles, `sole_points`. Markers have none: heel and toe are taken where the walk has them, else the ankle,
    which a foot that rolls carries forward by centimeters, so that only like may be compared with like; the distance
    from the floor is not known.

    Parameters
    ----------
    walks : list of Walk or JointWalk
        Over the floor, straight or along a curve; or in place and leading along x, then the floor moves with the walk's
        `speed`. The floor is at height 0. Only the part that is walked, see `prepare` with ``treadmill=False``.
    reference : list of Walk or JointWalk, default None
        For each walk the one to compare its jerk with, a recording for instance, at the same frame rate.
    rig : Rig or dict, default None
        Which joints or markers make the 15 markers; None recognises the rigs in `RIGS`.

    Returns
    -------
    DataFrame
        Columns, lengths in metres of the body as it was recorded, whatever the `size` of the walk:

        - name, duration_s;
        - speed_m_per_s, the mean of the pelvis over the floor along its path, without the sway of a stride; in place
          the belt's;
        - frequency_hz, from the steps (`step_frequency`); n_steps, the single supports that are measured;
        - bone_length_variation_m, the range over the frames of the length of a thigh, shank, upper arm or forearm,
          the largest of the eight;
        - foot_slip_m_per_step and worst_foot_slip_m_per_step, what the foot slides while it stands alone, mean and
          largest;
        - trailing_foot_slide_m and worst_trailing_foot_slide_m, what it slides while it trails;
        - foot_above_ground_m, how far the lowest point of the foot that stands alone is from the floor at most;
        - foot_below_ground_m, how deep a point of either foot lies below the floor at most, at any time;
        - root_jump_m and root_jump_m_per_s, the largest change of the root's displacement from one frame to the next,
          and the change of its velocity; of the pelvis for markers;
        - jerk_m_per_s3, the root of the mean square of the third derivative of all joints' or markers' positions
          against the root, from differences; and jerk_ratio, the mean square over that of the reference, of the 15
          markers where the two have different joints.

        NaN where a walk has too few steps, too few frames, markers only, an unknown speed, or no reference.

    Raises
    ------
    WalkError
        If a walk has gaps, lacks markers that events need, or has another frame rate than its reference.
    ValueError
        If `reference` has another length than `walks`, or no rig is recognised.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import quality_table
    >>> table = quality_table(make_walkers(2, random_state=0).data)
    >>> bool((table["root_jump_m"] < 0.01).all())
    True
    """
    walks = check_walks(walks, kind=(Walk, JointWalk))
    originals = repeat(None) if reference is None else check_walks(reference, kind=(Walk, JointWalk))
    if reference is not None and len(reference) != len(walks):
        raise ValueError(f"reference must have one walk for each of the {len(walks)} walks, got {len(reference)}")
    return pd.DataFrame([_measures(walk, other, rig) for walk, other in zip(walks, originals, strict=False)])


def _measures(
    walk: Walk | JointWalk, original: Walk | JointWalk | None, rig: Rig | Mapping[str, Place] | None
) -> dict[str, object]:
    markers = marker_walk(walk, rig)
    check_finite(markers.channels, markers.channel_names, walk=walk.name)
    body = _body(walk, markers)
    jump = float(np.linalg.norm(np.diff(body.root, 2, axis=0), axis=1).max()) if walk.n_frames > 2 else np.nan
    velocity = path_velocity(markers)
    return {
        "name": walk.name,
        "duration_s": walk.duration,
        "speed_m_per_s": walk.speed if velocity is None else float(np.hypot(*velocity.T).mean()),
        "frequency_hz": _frequency(markers if velocity is None else turn(markers, velocity)),
        **_foot_measures(find_footing(walk, rig), isinstance(walk, JointWalk)),
        "bone_length_variation_m": walk.size * _bone_variation(markers),
        "root_jump_m": jump,
        "root_jump_m_per_s": jump * walk.frame_rate,
        "jerk_m_per_s3": float(np.sqrt(_mean_square_jerk(body))),
        "jerk_ratio": np.nan if original is None else _jerk_ratio(walk, original, rig),
    }


def _frequency(markers: Walk) -> float:
    """Return the frequency of the steps, NaN where there are none."""
    durations = [step.end - step.start for step in find_steps(replace(markers, events=()))]
    return 0.5 / float(np.mean(durations)) if durations else float("nan")


def _foot_measures(footing: Footing, on_sole: bool) -> dict[str, float]:
    points = footing.points
    slips = [contact_path(points[frames, foot]) for foot, frames in footing.supports]
    slides = [contact_path(points[frames, foot]) for foot, frames in footing.handovers]
    lowest = [float(points[frames, foot, :, 2].min(axis=1).max()) for foot, frames in footing.supports]
    return {
        "n_steps": len(slips),
        "foot_slip_m_per_step": float(np.mean(slips)) if slips else np.nan,
        "worst_foot_slip_m_per_step": float(np.max(slips)) if slips else np.nan,
        "trailing_foot_slide_m": float(np.mean(slides)) if slides else np.nan,
        "worst_trailing_foot_slide_m": float(np.max(slides)) if slides else np.nan,
        "foot_above_ground_m": max(0.0, *lowest) if on_sole and lowest else np.nan,
        "foot_below_ground_m": max(0.0, -float(points[..., 2].min())) if on_sole else np.nan,
    }


def _bone_variation(markers: Walk) -> float:
    """Return the largest range of the length of a limb's bone."""
    ranges = [
        np.ptp(np.linalg.norm(markers.marker(f"{side}_{one}") - markers.marker(f"{side}_{other}"), axis=1))
        for side in SIDES
        for one, other in _BONES
    ]
    return float(max(ranges))


class _Body(NamedTuple):
    """Joints or markers by name, the path of the root, and all paths against it, in metres, with the frame rate."""

    names: tuple[str, ...]
    root: NDArray[np.float64]
    about_root: NDArray[np.float64]
    frame_rate: float


def _body(walk: Walk | JointWalk, markers: Walk) -> _Body:
    places: NDArray[np.floating]
    if isinstance(walk, JointWalk):
        names, places, root = walk.skeleton.joint_names, walk.joint_positions(), walk.skeleton.root
    else:
        names, places, root = markers.marker_set.names, markers.positions, markers.marker_set.index("pelvis")
    positions = walk.size * np.asarray(places, dtype=np.float64)
    return _Body(names, positions[:, root], positions - positions[:, [root]], walk.frame_rate)


def _mean_square_jerk(body: _Body) -> float:
    """Return the mean over joints and frames of the squared jerk against the root, NaN for less than four frames."""
    if len(body.root) < 4:
        return float("nan")
    jerk = np.diff(body.about_root, 3, axis=0) * body.frame_rate**3
    return float((jerk**2).sum(axis=-1).mean())


def _jerk_ratio(walk: Walk | JointWalk, original: Walk | JointWalk, rig: Rig | Mapping[str, Place] | None) -> float:
    """Return the mean squared jerk of a walk over that of its original, of joints or markers that both have."""
    if not np.isclose(walk.frame_rate, original.frame_rate, rtol=1e-6):
        raise WalkError(
            f"walk {walk.name!r}: expected the frame rate of its reference {original.name!r}, {original.frame_rate:g} "
            f"per second, got {walk.frame_rate:g}; resample one of them"
        )
    markers = [marker_walk(one, rig) for one in (walk, original)]
    bodies = [_body(one, seen) for one, seen in zip((walk, original), markers, strict=True)]
    if bodies[0].names != bodies[1].names:
        bodies = [_body(seen, seen) for seen in (one.to_markers() for one in markers)]
    ours, theirs = (_mean_square_jerk(body) for body in bodies)
    return ours / theirs if theirs > 0 else float("nan")
