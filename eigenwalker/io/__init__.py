"""Files of walks, read into the package's units and axes, and written from them."""

from eigenwalker.io.amc import read_amc
from eigenwalker.io.bids import read_bids, write_bids
from eigenwalker.io.bml import BmlFeatures, bml_to_features, features_to_bml, read_bml, write_bml
from eigenwalker.io.bvh import read_bvh
from eigenwalker.io.bvh_rewriter import rewrite_bvh
from eigenwalker.io.bvh_writer import write_bvh
from eigenwalker.io.c3d import read_c3d, write_c3d
from eigenwalker.io.formats import read_walk, read_walks, write_walk
from eigenwalker.io.kinect import read_kinect
from eigenwalker.io.npz import read_npz, write_npz
from eigenwalker.io.table import read_csv, write_csv
from eigenwalker.io.trc import read_trc, write_trc

__all__ = [
    "BmlFeatures",
    "bml_to_features",
    "features_to_bml",
    "read_amc",
    "read_bids",
    "read_bml",
    "read_bvh",
    "read_c3d",
    "read_csv",
    "read_kinect",
    "read_npz",
    "read_trc",
    "read_walk",
    "read_walks",
    "rewrite_bvh",
    "write_bids",
    "write_bml",
    "write_bvh",
    "write_c3d",
    "write_csv",
    "write_npz",
    "write_trc",
    "write_walk",
]
