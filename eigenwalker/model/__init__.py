"""The statistics: walks as vectors, Eigenwalkers, trait axes, and back."""

from eigenwalker.model.discriminant import TraitClassifier
from eigenwalker.model.eigenwalkers import make_eigenwalkers, walk_along_axis, walk_at
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
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.scaling import BlockScaler
from eigenwalker.model.traits import TraitRegressor

__all__ = [
    "BlockScaler",
    "BootstrapResult",
    "FourierLinearizer",
    "LearningCurve",
    "NestedResult",
    "PermutationResult",
    "TraitClassifier",
    "TraitRegressor",
    "bootstrap_axes",
    "learning_curve_walkers",
    "loo_matrix",
    "loo_predict",
    "make_eigenwalkers",
    "nested_loo",
    "permutation_test",
    "walk_along_axis",
    "walk_at",
]
