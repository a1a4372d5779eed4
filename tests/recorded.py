"""Recorded walks, read and prepared once for all tests."""

import warnings
from functools import cache
from pathlib import Path

from eigenwalker import read_walks
from eigenwalker.motion import prepare_walks

__all__ = ["bandai_joints", "bandai_walks", "cmu_joints", "cmu_walks", "style"]


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


@cache
def bandai_joints(data_dir: Path, n_walks: int | None = None):
    """Return walks of `bandai2` in joint angles, the first few of each style."""
    files = sorted((data_dir / "bandai2").glob("*.bvh"))
    by_style = {}
    for file in files:
        by_style.setdefault(file.stem.split("_")[2], []).append(file)
    return prepare_walks(
        read_walks([file for found in by_style.values() for file in found[:n_walks]]), representation="joints"
    )


@cache
def cmu_joints(data_dir: Path):
    """Return the 27 walks of `cmu_bvh` in joint angles."""
    recorded = read_walks(sorted((data_dir / "cmu_bvh").glob("*.bvh")), unit=0.0564)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of frames that are left out at a start
        return prepare_walks(recorded, representation="joints")


def style(walk):
    """Return the style in the name of a walk of `bandai2`."""
    return walk.name.split("_")[2]
