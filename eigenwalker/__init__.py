"""Statistics of human walking on scikit-learn estimators.

Recorded walks become points of a linear space; PCA over walkers gives Eigenwalkers; least squares gives trait axes; and
every step inverts, so that a position on a trait axis becomes a walk again.
"""

from eigenwalker._validation import WalkError
from eigenwalker.datasets import make_walkers
from eigenwalker.hsmm import GaitHSMM, StyleClassifier
from eigenwalker.io import read_walk, read_walks, write_walk
from eigenwalker.model import (
    BlockScaler,
    FourierLinearizer,
    TraitClassifier,
    TraitRegressor,
    blend,
    hybrid_walk,
    make_eigenwalkers,
    restyle_walk,
    walk_along_axis,
    walk_at,
)
from eigenwalker.motion import TROJE15, JointWalk, MarkerSet, Skeleton, Walk, WalkPreparer, prepare, walk_quality
from eigenwalker.persistence import describe_model, load_model, save_model

__all__ = [
    "TROJE15",
    "BlockScaler",
    "FourierLinearizer",
    "GaitHSMM",
    "JointWalk",
    "MarkerSet",
    "Skeleton",
    "StyleClassifier",
    "TraitClassifier",
    "TraitRegressor",
    "Walk",
    "WalkError",
    "WalkPreparer",
    "blend",
    "describe_model",
    "hybrid_walk",
    "load_model",
    "make_eigenwalkers",
    "make_walkers",
    "prepare",
    "read_walk",
    "read_walks",
    "restyle_walk",
    "save_model",
    "walk_along_axis",
    "walk_at",
    "walk_quality",
    "write_walk",
]
