"""Synthetic recordings in files of three formats, for notebooks, where there are no recorded ones."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker import JointWalk, Skeleton, Walk, make_walkers, write_walk

__all__ = ["there_and_back", "write_recordings"]

_STYLES = ("active", "elderly", "exhausted", "feminine", "masculine", "normal", "youthful")
_N_WALKS = 5  # of each style
_N_PASSES = 10
_N_PEOPLE = 18  # before a Kinect
_N_RECORDINGS = 2  # of each
_PAIRS = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
_KINECT = {"Head": "head", "Shoulder-Center": "clavicle", "Spine": "clavicle", "Hip-centro": "pelvis"} | {
    f"{joint}-{side}": f"{side.lower()}_{marker}"
    for marker in _PAIRS
    for side in ("Left", "Right")
    for joint in {"wrist": ("Wrist", "Hand"), "ankle": ("Ankle", "Foot")}.get(marker, (marker.capitalize(),))
}


def write_recordings(folder: Path) -> Path:
    """Write BVH, C3D and Kinect text files, laid out as the recorded ones, and return the folder.

    Parameters
    ----------
    folder : Path
        Where to. It gets the folders ``bandai2``, with walks over the floor; ``horst_c3d``, with short passes of one
        person and a static trial; and ``kinect``, with recordings there and back of some people, and a table of them.
    """
    floor = make_walkers(len(_STYLES) * _N_WALKS, treadmill=False, frame_rate=30, random_state=0).data
    names = [f"dataset-2_walk_{style}_{number:03d}" for style in _STYLES for number in range(1, _N_WALKS + 1)]
    for directory in ("bandai2", "horst_c3d", "kinect"):
        (folder / directory).mkdir(parents=True)
    for walk, name in zip(floor, names, strict=True):
        write_walk(_as_joints(walk), folder / "bandai2" / f"{name}.bvh")
    _write_passes(folder / "horst_c3d")
    _write_people(folder / "kinect")
    return folder


def _as_joints(walk: Walk) -> JointWalk:
    """Return joints that do not turn, and move as the markers do: all that BVH needs."""
    names = walk.marker_set.names
    paths = walk.positions - walk.marker("pelvis")[:, np.newaxis]
    order = ("pelvis", *(name for name in names if name != "pelvis"))
    columns = [names.index(name) for name in order]
    skeleton = Skeleton(order, [-1] + [0] * (len(order) - 1), paths[0, columns])
    moving = {name: paths[:, names.index(name)] for name in order[1:]}
    still = np.zeros((walk.n_frames, len(order), 3))
    return JointWalk(still, walk.marker("pelvis"), skeleton, walk.frame_rate, name=walk.name, translations=moving)


def _write_passes(folder: Path) -> None:
    """Write passes of little more than a stride, out of the middle of walks of one person, and that person standing."""
    walk = make_walkers(1, treadmill=False, duration=20, frame_rate=250, random_state=1).data[0]
    for number, start in enumerate(np.linspace(1000, 3600, _N_PASSES).astype(int), 2):
        write_walk(replace(walk, positions=walk.positions[start : start + 350]), folder / f"S01_{number:04d}_Gait.c3d")
    standing = np.repeat(walk.positions[:1], 100, axis=0)
    write_walk(replace(walk, positions=standing), folder / "S01_0001_Static.c3d")


def _write_people(folder: Path) -> None:
    """Write noisy recordings there and back of people before a Kinect, and what is known of them."""
    walkers = make_walkers(_N_PEOPLE, treadmill=False, duration=6, frame_rate=30, random_state=2)
    rng = np.random.default_rng(3)
    people = [f"Person{number:03d}" for number in range(1, _N_PEOPLE + 1)]
    for person, walk in zip(people, walkers.data, strict=True):
        (folder / person).mkdir()
        for number in range(1, _N_RECORDINGS + 1):
            recording = there_and_back(walk)
            noisy = recording.positions + rng.normal(scale=0.02, size=recording.positions.shape)
            _write_kinect(replace(recording, positions=noisy), folder / person / f"{number}.txt")
    table = {
        "Gender": np.where(walkers.target["gender"] == "male", "M", "F"),
        "Height": walkers.target["height"].to_numpy().round(2),
        "Weight (Kg)": walkers.target["weight"].to_numpy().round(1),
        "Age": walkers.target["age"].to_numpy().round(),
    }
    pd.DataFrame(table, index=pd.Index(people, name="Individual")).to_csv(folder / "person-data.csv")


def there_and_back(walk: Walk) -> Walk:
    """Return a recording in which a walk is walked, the body turned round in 2 s, and the walk walked again."""
    n_frames = round(2 * walk.frame_rate)
    angles = np.linspace(0, np.pi, n_frames)[:, np.newaxis]
    turning = _turned(walk, np.repeat(walk.positions[-1:], n_frames, axis=0), angles)
    back = _turned(walk, walk.positions, np.pi)
    pelvis = walk.marker_set.index("pelvis")
    back = back + (turning[-1, pelvis] - back[0, pelvis]) * [1.0, 1.0, 0.0]
    return replace(walk, positions=np.concatenate((walk.positions, turning, back)))


def _turned(walk: Walk, positions: NDArray[np.floating], angle: float | NDArray[np.float64]) -> NDArray[np.floating]:
    """Turn positions about the vertical through the first place of the pelvis, by one angle or one a frame."""
    center = positions[0, walk.marker_set.index("pelvis")] * [1.0, 1.0, 0.0]
    x, y, z = np.moveaxis(positions - center, 2, 0)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack((cosine * x - sine * y, sine * x + cosine * y, z), axis=2) + center


def _write_kinect(walk: Walk, path: Path) -> None:
    """Write the text of a Kinect: x to its left, y up, z away from it, a line a joint."""
    lines: list[str] = []
    for frame in walk.positions:
        places: dict[str, Sequence[float]] = dict(zip(walk.marker_set.names, frame, strict=True))
        lines += [
            f"{joint};{y:.7g};{z - 1.0:.7g};{x + 3.0:.7g}"
            for joint, (x, y, z) in ((joint, places[marker]) for joint, marker in _KINECT.items())
        ]
    path.write_text("\n".join(lines) + "\n")
