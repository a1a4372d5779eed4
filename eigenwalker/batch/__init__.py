"""Many files to one table of coefficients, walk by walk, on one machine or many."""

from eigenwalker.batch.cluster import on_cluster
from eigenwalker.batch.coefficients import iterate_coefficients, read_coefficients, read_linearizer, refused_files
from eigenwalker.batch.run import LinearizedFiles, linearize_files

__all__ = [
    "LinearizedFiles",
    "iterate_coefficients",
    "linearize_files",
    "on_cluster",
    "read_coefficients",
    "read_linearizer",
    "refused_files",
]
