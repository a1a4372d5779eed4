"""One walk, and what is done to one walk."""

from eigenwalker.motion.body import check_leg_length, stature
from eigenwalker.motion.fourier import (
    amplitude_phase,
    coarse_frequency,
    estimate_frequency,
    evaluate_harmonics,
    explained_power,
    fit_harmonics,
    reference_phase,
    shift_phase,
)
from eigenwalker.motion.gait import Step, detect_events, find_steps, gait_table, heel_strikes, toe_offs
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.preparation import mirror_walk, prepare, prepare_walks
from eigenwalker.motion.preparer import WalkPreparer
from eigenwalker.motion.quality import WalkQuality, walk_quality
from eigenwalker.motion.rotations import euler_from_rotvec, forward_kinematics, rotvec_from_euler, unroll_rotvec
from eigenwalker.motion.skeleton import RIGS, TROJE15, MarkerSet, Rig, Skeleton, find_rig
from eigenwalker.motion.walk import Event, JointWalk, Walk

__all__ = [
    "RIGS",
    "TROJE15",
    "Event",
    "JointWalk",
    "MarkerSet",
    "Rig",
    "Skeleton",
    "Step",
    "Walk",
    "WalkPreparer",
    "WalkQuality",
    "amplitude_phase",
    "check_leg_length",
    "coarse_frequency",
    "detect_events",
    "estimate_frequency",
    "euler_from_rotvec",
    "evaluate_harmonics",
    "explained_power",
    "find_rig",
    "find_steps",
    "fit_harmonics",
    "forward_kinematics",
    "gait_table",
    "heel_strikes",
    "mirror_walk",
    "phase_weights",
    "prepare",
    "prepare_walks",
    "reference_phase",
    "rotvec_from_euler",
    "shift_phase",
    "stature",
    "stride_frequency",
    "toe_offs",
    "unroll_rotvec",
    "walk_quality",
]
