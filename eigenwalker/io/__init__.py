"""Files of walks, read into the package's units and axes."""

from eigenwalker.io.bvh import read_bvh
from eigenwalker.io.formats import read_walk, read_walks

__all__ = ["read_bvh", "read_walk", "read_walks"]
