"""Whether to believe a trait axis: persons left out, labels shuffled, and persons drawn again."""

from eigenwalker.model.bootstrap import BootstrapResult, bootstrap_axes
from eigenwalker.model.learning_curve import LearningCurve, learning_curve_walkers
from eigenwalker.model.leave_one_out import loo_matrix, loo_predict
from eigenwalker.model.nested import NestedResult, nested_loo
from eigenwalker.model.permutation import PermutationResult, permutation_test

__all__ = [
    "BootstrapResult",
    "LearningCurve",
    "NestedResult",
    "PermutationResult",
    "bootstrap_axes",
    "learning_curve_walkers",
    "loo_matrix",
    "loo_predict",
    "nested_loo",
    "permutation_test",
]
