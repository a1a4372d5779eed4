"""One walk, and what is done to one walk."""

from eigenwalker.motion.body import check_leg_length, stature
from eigenwalker.motion.cadence import StridePhase, steady_cadence, stride_phase
from eigenwalker.motion.common_body import share_skeleton
from eigenwalker.motion.filtering import low_pass, resample
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
from eigenwalker.motion.gait import Step, detect_events, find_steps, gait_table, heel_strikes, step_frequency, toe_offs
from eigenwalker.motion.gaps import Gap, fill_gaps, find_gaps
from eigenwalker.motion.ground import plant_feet
from eigenwalker.motion.harmonic_needs import harmonics_table
from eigenwalker.motion.limits import JointLimitWarning, joint_limits_exceeded
from eigenwalker.motion.passes import split_passes
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.posture import reference_frames, stand_upright
from eigenwalker.motion.preparation import prepare, prepare_walks
from eigenwalker.motion.preparer import WalkPreparer
from eigenwalker.motion.projection import project_harmonics
from eigenwalker.motion.quality import WalkQuality, walk_quality
from eigenwalker.motion.rig import Estimate, Posture, Rig, Segment
from eigenwalker.motion.rigid import fit_rigid
from eigenwalker.motion.rigs import RIGS, find_rig
from eigenwalker.motion.robust import fit_harmonics_robust
from eigenwalker.motion.rotations import euler_from_rotvec, forward_kinematics, rotvec_from_euler, unroll_rotvec
from eigenwalker.motion.skeleton import FEET, TROJE15, MarkerSet, Skeleton
from eigenwalker.motion.sole import sole_points
from eigenwalker.motion.spectrum import spectrum
from eigenwalker.motion.static_trial import carry_markers
from eigenwalker.motion.strides import cut_to_strides, pool_walks
from eigenwalker.motion.symmetry import Asymmetry, asymmetry_index, mirror_walk, symmetrize_walk
from eigenwalker.motion.synthesis import synthesize
from eigenwalker.motion.variation import StrideVariation
from eigenwalker.motion.walk import Event, JointWalk, Walk
from eigenwalker.motion.walk_measures import quality_table

__all__ = [
    "FEET",
    "RIGS",
    "TROJE15",
    "Asymmetry",
    "Estimate",
    "Event",
    "Gap",
    "JointLimitWarning",
    "JointWalk",
    "MarkerSet",
    "Posture",
    "Rig",
    "Segment",
    "Skeleton",
    "Step",
    "StridePhase",
    "StrideVariation",
    "Walk",
    "WalkPreparer",
    "WalkQuality",
    "amplitude_phase",
    "asymmetry_index",
    "carry_markers",
    "check_leg_length",
    "coarse_frequency",
    "cut_to_strides",
    "detect_events",
    "estimate_frequency",
    "euler_from_rotvec",
    "evaluate_harmonics",
    "explained_power",
    "fill_gaps",
    "find_gaps",
    "find_rig",
    "find_steps",
    "fit_harmonics",
    "fit_harmonics_robust",
    "fit_rigid",
    "forward_kinematics",
    "gait_table",
    "harmonics_table",
    "heel_strikes",
    "joint_limits_exceeded",
    "low_pass",
    "mirror_walk",
    "phase_weights",
    "plant_feet",
    "pool_walks",
    "prepare",
    "prepare_walks",
    "project_harmonics",
    "quality_table",
    "reference_frames",
    "reference_phase",
    "resample",
    "rotvec_from_euler",
    "share_skeleton",
    "shift_phase",
    "sole_points",
    "spectrum",
    "split_passes",
    "stand_upright",
    "stature",
    "steady_cadence",
    "step_frequency",
    "stride_frequency",
    "stride_phase",
    "symmetrize_walk",
    "synthesize",
    "toe_offs",
    "unroll_rotvec",
    "walk_quality",
]
