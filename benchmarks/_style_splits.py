"""Walks of bandai2 for gait models: steps to adapt to, walks to choose settings on, and walks to be asked about."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from eigenwalker.hsmm import cut_inner_steps
from eigenwalker.io import read_walks
from eigenwalker.motion import JointWalk, prepare_walks

__all__ = ["AVERAGE", "Labeled", "Recorded", "StyleSplit", "load_styles", "split_styles", "take_steps"]

AVERAGE = "normal"
FRAME_RATE = 60.0
_N_TRAIN, _N_VALIDATION, _N_TEST = 8, 3, 6  # the fewest walks of a style are 17
_WALKS_FOR = {3: 1, 6: 2, 12: 3, 24: 6, 48: 8}  # over how many walks so many steps are spread


class Recorded(NamedTuple):
    """One recording: as in its file, whole for gait models, and its steady part for judges."""

    file: JointWalk
    whole: JointWalk
    steady: JointWalk


class StyleSplit(NamedTuple):
    """Recordings of one style: to adapt to, to choose settings on, and held out."""

    train: list[Recorded]
    validation: list[Recorded]
    test: list[Recorded]


class Labeled(NamedTuple):
    """Walks and the labels of their steps, as `GaitHSMM` takes them; None has them found."""

    walks: list[JointWalk]
    labels: list[list[tuple[str, str]]] | None


def load_styles(folder: Path, styles: Sequence[str] | None = None) -> dict[str, list[Recorded]]:
    """Return the recordings of styles, of all for None."""
    files = [file for file in sorted(folder.glob("*.bvh")) if styles is None or _style(file) in styles]
    recorded = read_walks(files, unit="cm")
    whole = prepare_walks(recorded, representation="joints", clip="whole", frame_rate=FRAME_RATE)
    steady = prepare_walks(recorded, representation="joints", frame_rate=FRAME_RATE)
    found: dict[str, list[Recorded]] = {}
    for file, *walks in zip(files, recorded, whole, steady, strict=True):
        found.setdefault(_style(file), []).append(Recorded(*walks))
    return found


def _style(file: Path) -> str:
    return file.stem.split("_")[2]


def split_styles(recorded: Mapping[str, Sequence[Recorded]], seed: int) -> dict[str, StyleSplit]:
    """Return a split of each style, at random: within a session walks drift, and neighbors are more alike."""
    random = np.random.default_rng(seed)
    splits = {}
    for style, walks in recorded.items():
        drawn = [walks[at] for at in random.permutation(len(walks))]
        validation, test = drawn[_N_TEST : _N_TEST + _N_VALIDATION], drawn[:_N_TEST]
        others = drawn[_N_TEST + _N_VALIDATION :]
        splits[style] = StyleSplit(others if style == AVERAGE else others[:_N_TRAIN], validation, test)
    return splits


def take_steps(recorded: Sequence[Recorded], n_steps: int | None = None) -> Labeled:
    """Return steps from inside of walks: so many in all, spread evenly over some walks, or all of all for None."""
    n_walks = len(recorded) if n_steps is None else _WALKS_FOR[n_steps]
    each = None if n_steps is None else n_steps // n_walks
    parts = [cut_inner_steps(one.whole, each) for one in recorded[:n_walks]]
    return Labeled([part.walk for part in parts], [part.labels for part in parts])
