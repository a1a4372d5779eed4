"""The statistics: walks as vectors, Eigenwalkers, trait axes, and back."""

from eigenwalker.model._guards import LeakageWarning, OutsideDataWarning
from eigenwalker.model.blending import blend
from eigenwalker.model.blocks import block_weights, feature_parts
from eigenwalker.model.discriminant import TraitClassifier
from eigenwalker.model.eigenwalkers import (
    axis_features,
    axis_shares,
    eigenwalker_features,
    make_eigenwalkers,
    settings_of,
)
from eigenwalker.model.generation import hybrid_walk, walk_along_axis, walk_at
from eigenwalker.model.inference import (
    BootstrapResult,
    LearningCurve,
    NestedResult,
    PermutationResult,
    bootstrap_axes,
    learning_curve_walkers,
    loo_matrix,
    loo_predict,
    nested_loo,
    permutation_test,
)
from eigenwalker.model.intervals import score_interval
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.moments import Moments
from eigenwalker.model.restyling import restyle_walk
from eigenwalker.model.scaling import BlockScaler
from eigenwalker.model.statistics import AxisStatistics, axis_statistics
from eigenwalker.model.streaming import fit_moments, fit_stream
from eigenwalker.model.traits import TraitRegressor
from eigenwalker.model.walker_score import WalkerScore, score_walker

__all__ = [
    "AxisStatistics",
    "BlockScaler",
    "BootstrapResult",
    "FourierLinearizer",
    "LeakageWarning",
    "LearningCurve",
    "Moments",
    "NestedResult",
    "OutsideDataWarning",
    "PermutationResult",
    "TraitClassifier",
    "TraitRegressor",
    "WalkerScore",
    "axis_features",
    "axis_shares",
    "axis_statistics",
    "blend",
    "block_weights",
    "bootstrap_axes",
    "eigenwalker_features",
    "feature_parts",
    "fit_moments",
    "fit_stream",
    "hybrid_walk",
    "learning_curve_walkers",
    "loo_matrix",
    "loo_predict",
    "make_eigenwalkers",
    "nested_loo",
    "permutation_test",
    "restyle_walk",
    "score_interval",
    "score_walker",
    "settings_of",
    "walk_along_axis",
    "walk_at",
]
