"""Recordings that are changed along trait axes and keep all else: their skeleton, their path, their residual motion."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from sklearn.pipeline import Pipeline

from eigenwalker._validation import WalkError
from eigenwalker.model.eigenwalkers import split_model
from eigenwalker.model.stepping import check_traits, label_of, start_from, step_from, trait_name
from eigenwalker.motion.gait_change import change_gait
from eigenwalker.motion.limits import warn_joint_limits
from eigenwalker.motion.posture import lean_back, stand_upright
from eigenwalker.motion.preparer import WalkPreparer
from eigenwalker.motion.recorded_gait import find_gait
from eigenwalker.motion.rig import Place, Rig
from eigenwalker.motion.skeleton import Skeleton
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["restyle_walk"]


def restyle_walk(
    model: Pipeline,
    walk: JointWalk,
    alphas: Mapping[str, float],
    *,
    hold: Sequence[str] = (),
    keep_cadence: bool = False,
    max_knee: float = 25.0,
    rig: Rig | Mapping[str, Place] | None = None,
    reference: str | ArrayLike | None = None,
) -> JointWalk:
    r"""Return a recording moved along trait axes by some steps, changed in nothing else.

    `walk_at` makes the walk that *has* given alphas, in place and without variation, from its harmonics. This function
    moves a recording *by* given alphas from where it is: with alpha 0 it is the recording. With the difference that a
    step makes in the features, :math:`\Delta`, each channel of the model becomes, at its phase :math:`\varphi(t)`,

    .. math:: p(t) + \Delta_0 + e(t) \sum_{k=1}^{K} \Delta_{s_k} \sin k \varphi(t) + \Delta_{c_k} \cos k \varphi(t)

    where e(t) is 1 while the walk walks and fades to 0 where it stands (`track_gait`). Residual motion, how strides
    differ, starts and stops stay. Where it walks it is played at the pace of the new frequency over the old one. The
    root is turned in the walk's own heading, and goes and sinks as far as the changed legs ask for; legs reach so that
    feet slide as they did (`plant_as_before`).

    Parameters
    ----------
    model : Pipeline
        Fitted, from `make_eigenwalkers` or with the same kinds of steps, to walks in joint angles:
        ``prepare(walk, representation="joints")``.
    walk : JointWalk
        As `read_walk` has it: the whole recording, over the floor or in place, of the same family of skeletons.
    alphas : mapping of str to float
        Step along each axis, in the trait step's `alpha_unit`, SD unless that says otherwise: {"happy": 2.0} is 2 SD
        happier than the recording.
    hold : sequence of str, default ()
        Traits that stay where they are; all others are free to go along.
    keep_cadence : bool, default False
        Whether strides last as long as they did, so that the walk keeps its number of frames.
    max_knee : float, default 25.0
        By how many degrees a knee may bend or stretch to keep a foot in its place. With less, the foot of a first step
        may dip into the floor by centimetres.
    rig, reference
        Those that the model's walks were prepared with, see `prepare`. A `WalkPreparer` in the model says so itself.

    Returns
    -------
    JointWalk
        With the skeleton and frame rate of `walk`. Joints that the model does not know move as they did, at the new
        pace. Frames before and after a leap, such as a T-pose in front of the motion, stay as they are.

    Raises
    ------
    TypeError
        If the walk has markers.
    WalkError
        If the walk lacks joints of the model, or hangs them elsewhere; as `prepare`.
    ValueError
        If the model is of markers, a trait is unknown, or an alpha is not finite or so far out that the frequency is
        not positive.

    Warns
    -----
    OutsideDataWarning
        If the walk comes to lie further from the training walkers than 99 % of walkers of their kind.
    JointLimitWarning
        If joints turn further than those of people.

    Examples
    --------
    >>> from eigenwalker import load_model, read_walk, restyle_walk
    >>> from eigenwalker.io import rewrite_bvh
    >>> walk = read_walk("mine.bvh")  # doctest: +SKIP
    >>> happy = restyle_walk(load_model("moods.skops"), walk, {"happy": 2.0})  # doctest: +SKIP
    >>> rewrite_bvh(happy, "mine.bvh", "mine_happy.bvh")  # doctest: +SKIP
    """
    if not isinstance(walk, JointWalk):
        raise TypeError(f"expected a JointWalk, whose skeleton is kept, got {type(walk).__name__}")
    if not alphas:
        raise ValueError("alphas must have one trait or more, {'happy': 1.0}, got none")
    names = [trait_name(model, name) for name in alphas]
    steps = np.array([list(alphas.values())], dtype=np.float64)
    held = check_traits(model, names, steps, hold)
    if not np.isfinite(max_knee) or max_knee < 0:
        raise ValueError(f"max_knee must be finite and not negative, in degrees, got {max_knee!r}")
    before, linearizer, _ = split_model(model)
    template = _check_template(linearizer.template_)
    joints = template.channel_joints or template.skeleton.joint_names
    _check_joints(walk, template.skeleton, joints)
    asked = {"rig": rig, "reference": reference} | _preparation(before)
    standing = {name: asked[name] for name in ("rig", "reference")}
    gait = find_gait(
        stand_upright(walk, **standing),
        joints,
        phase_reference=linearizer.phase_reference,
        **{name: value for name, value in asked.items() if name != "reference"},
    )
    prepared = before.transform([walk])[0] if before else gait.prepared
    start = start_from(model, _on_skeleton(prepared, template))
    label = f"{walk.name}, {label_of(names, steps[0])}"
    change = (step_from(model, start, names, steps, held, [label]) - start.vector)[0]
    frequency = list(linearizer.get_feature_names_out()).index("frequency")
    coefficients = change[:frequency].reshape(2 * linearizer.n_harmonics + 1, -1)  # (2 K + 1, n_channels)
    pace = 1.0 if keep_cadence else float(1.0 + change[frequency] / start.vector[0, frequency])
    changed = change_gait(gait, joints, coefficients, pace, max_knee=np.deg2rad(max_knee), rig=asked["rig"])
    if change.any():
        warn_joint_limits([replace(changed, name=label)])
    return replace(lean_back(changed, walk, **standing), channel_joints=walk.channel_joints)


def _check_template(template: Walk | JointWalk) -> JointWalk:
    """Return the template of a model of joints along the axes of the room, or raise."""
    if not isinstance(template, JointWalk):
        raise ValueError(
            "model must be one of joint angles, to change those of a recording, got one of markers; learn one with "
            "prepare(walk, representation='joints'), or eigenwalker fit --representation joints"
        )
    if not template.skeleton.upright:
        raise ValueError(
            "model must have joints along the axes of the room, got those of files; fit it to walks from "
            "prepare(walk, representation='joints')"
        )
    return template


def _check_joints(walk: JointWalk, known: Skeleton, joints: Sequence[str]) -> None:
    """Raise unless a walk has the joints that a model turns, each below the same other one of these."""
    lacking = [joint for joint in joints if joint not in walk.skeleton.joint_names]
    faults = [f"it lacks {', '.join(lacking)}"] if lacking else []
    for joint in joints if not lacking else ():
        found, expected = (_nearest_above(skeleton, joint, joints) for skeleton in (walk.skeleton, known))
        if found != expected:
            faults.append(f"{joint} hangs from {found} in place of {expected}")
    if faults:
        raise WalkError(
            f"walk {walk.name!r}: expected the skeleton of the model, with the joints {', '.join(joints)}; "
            f"{'; '.join(faults)}; further joints do no harm"
        )


def _nearest_above(skeleton: Skeleton, joint: str, joints: Sequence[str]) -> str:
    above = [skeleton.joint_names[place] for place in reversed(skeleton.above(skeleton.index(joint)))]
    return next((name for name in above if name in joints), "none of them")


def _preparation(before: Pipeline | None) -> dict[str, Any]:
    """Return how the walks of a model were prepared, as far as a `WalkPreparer` in it says so."""
    preparers = [step for _, step in before.steps if isinstance(step, WalkPreparer)] if before else []
    asked = ("rig", "reference", "heading", "frequency_range")
    return {name: getattr(preparers[-1], name) for name in asked} if preparers else {}


def _on_skeleton(walk: JointWalk, template: JointWalk) -> JointWalk:
    """Return the joints of the model alone, in its order; their axes are along the room in every skeleton."""
    skeleton = template.skeleton
    rotations = np.zeros((walk.n_frames, len(skeleton.joint_names), 3))
    for place, joint in enumerate(skeleton.joint_names):
        if joint in walk.skeleton.joint_names:  # those without channels need not be there
            rotations[:, place] = walk.rotations[:, walk.skeleton.index(joint)]
    joints = template.channel_joints
    return replace(walk, rotations=rotations, skeleton=skeleton, translations={}, channel_joints=joints)
