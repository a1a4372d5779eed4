"""The statistics: walks as vectors, Eigenwalkers, trait axes, and back."""

from eigenwalker.model.discriminant import TraitClassifier
from eigenwalker.model.eigenwalkers import make_eigenwalkers, walk_along_axis, walk_at
from eigenwalker.model.inference import PermutationResult, loo_matrix, permutation_test
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.scaling import BlockScaler
from eigenwalker.model.traits import TraitRegressor

__all__ = [
    "BlockScaler",
    "FourierLinearizer",
    "PermutationResult",
    "TraitClassifier",
    "TraitRegressor",
    "loo_matrix",
    "make_eigenwalkers",
    "permutation_test",
    "walk_along_axis",
    "walk_at",
]
