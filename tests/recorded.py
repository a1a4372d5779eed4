"""Recorded walks, read and prepared once for all tests."""

import warnings
from functools import cache
from pathlib import Path

from eigenwalker import read_walks
from eigenwalker.motion import prepare_walks

__all__ = ["bandai_walks", "cmu_walks", "style"]


@cache
def bandai_walks(data_dir: Path):
    """Return the 175 walks of `bandai2`, as recorded and prepared."""
    recorded = read_walks(sorted((data_dir / "bandai2").glob("*.bvh")))
    return recorded, prepare_walks(recorded)


@cache
def cmu_walks(data_dir: Path):
    """Return the 27 walks of `cmu_bvh`, as recorded and prepared, and the warnings on the way."""
    recorded = read_walks(sorted((data_dir / "cmu_bvh").glob("*.bvh")), unit=0.0564)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        prepared = prepare_walks(recorded)
    return recorded, prepared, [str(entry.message) for entry in caught]


def style(walk):
    """Return the style in the name of a walk of `bandai2`."""
    return walk.name.split("_")[2]
