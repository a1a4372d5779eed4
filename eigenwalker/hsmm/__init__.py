"""Hidden semi-Markov models of gait: states with Gaussian observations that last for Gaussian times."""

from eigenwalker.hsmm.accumulation import ObservedWalk, Statistics, accumulate_walk, add_statistics
from eigenwalker.hsmm.duration import duration_support, fit_durations, log_durations
from eigenwalker.hsmm.estimation import (
    StateParameters,
    maximize_likelihood,
    overall_moments,
    start_parameters,
    variance_floors,
)
from eigenwalker.hsmm.features import NEIGHBOR_WINDOWS, WINDOWS, append_dynamics, whole_frames
from eigenwalker.hsmm.gait_hsmm import GaitHSMM
from eigenwalker.hsmm.inference import (
    Posterior,
    align_states,
    certain_posterior,
    infer_states,
    reachable_starts,
    sum_paths,
)
from eigenwalker.hsmm.inner_steps import InnerSteps, cut_inner_steps
from eigenwalker.hsmm.observation import accumulate_over_time, log_densities
from eigenwalker.hsmm.step_labels import CONTEXTS, label_steps, make_labels
from eigenwalker.hsmm.style_blend import blend
from eigenwalker.hsmm.style_classifier import StyleClassifier
from eigenwalker.hsmm.training import FittedStates, expect_statistics, fit_states

__all__ = [
    "CONTEXTS",
    "NEIGHBOR_WINDOWS",
    "WINDOWS",
    "FittedStates",
    "GaitHSMM",
    "InnerSteps",
    "ObservedWalk",
    "Posterior",
    "StateParameters",
    "Statistics",
    "StyleClassifier",
    "accumulate_over_time",
    "accumulate_walk",
    "add_statistics",
    "align_states",
    "append_dynamics",
    "blend",
    "certain_posterior",
    "cut_inner_steps",
    "duration_support",
    "expect_statistics",
    "fit_durations",
    "fit_states",
    "infer_states",
    "label_steps",
    "log_densities",
    "log_durations",
    "make_labels",
    "maximize_likelihood",
    "overall_moments",
    "reachable_starts",
    "start_parameters",
    "sum_paths",
    "variance_floors",
    "whole_frames",
]
