"""Reading files: ``python -m benchmarks.read [--short]``.

A BVH file beside pymotion and bvh, the way from a file to 15 markers beside bvhio, and many files in one process and
in two. One core, but for the last row.
"""

import argparse
import os
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks import _measure
from benchmarks._bvh_peers import LOADERS, POSITIONS, to_package
from benchmarks._synthetic import random_joint_walk
from eigenwalker.io import read_bvh, read_walks, write_bvh
from eigenwalker.io._bvh_text import parse_bvh
from eigenwalker.motion import find_rig

_OURS = "eigenwalker"
_AIMS = {"pymotion": 6, "bvh": 12}
_FOLDER = Path(os.environ.get("EIGENWALKER_TEST_DATA", Path(__file__).parents[2] / "shared" / "data"))

_Targets = list[tuple[str, str, bool | None]]


def main() -> None:
    """Print the three tables and the targets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="fewer rounds, and fewer frames for markers")
    short = parser.parse_args().short
    with threadpool_limits(1), TemporaryDirectory() as name:
        folder = Path(name)
        print(_measure.describe_machine(("numpy", "numba", "upc-pymotion", "bvh", "bvhio")))
        targets = _load(_written(folder, 2752), 5 if short else 15)
        targets += _to_markers(_written(folder, 300 if short else 2752), 3 if short else 5)
        targets += _many_files(folder, 3 if short else 7)
    _measure.print_targets(targets)


def _written(folder: Path, n_frames: int) -> Path:
    path = folder / f"{n_frames}.bvh"
    write_bvh(random_joint_walk(np.random.default_rng(0), n_frames), path)
    return path


def _timed(function: Callable[[], object]) -> Callable[[int], int]:
    """Return a function for `interleaved` that calls another one once."""

    def run(turn: int) -> int:
        function()
        return 1

    return run


def _usable(peers: dict[str, Callable[[], object]]) -> tuple[dict[str, Callable[[], object]], list[list[str]]]:
    """Return the peers that run, and rows with the reason for the others."""
    usable, missing = {}, []
    for name, call in peers.items():
        try:
            call()
            usable[name] = call
        except Exception as error:  # whatever a peer's import raises is the reason its row gives
            missing.append([name, f"did not run: {error}", "", ""])
    return usable, missing


def _load(path: Path, n_rounds: int) -> _Targets:
    peers, missing = _usable({name: lambda load=load: load(path) for name, (load, _) in LOADERS.items()})
    calls = {_OURS: lambda: read_bvh(path), f"{_OURS}, numbers only": lambda: parse_bvh(path.read_bytes()), **peers}
    seconds = _measure.interleaved({name: _timed(call) for name, call in calls.items()}, n_rounds)
    ratios = {name: _measure.ratio(seconds, name, _OURS) for name in calls}
    ours = parse_bvh(path.read_bytes()).motion
    errors = {name: f"{np.abs(LOADERS[name][1](call()) - ours).max():.1e}" for name, call in peers.items()}
    rows = [
        [name, f"{1e3 * np.median(seconds[name]):.1f}", f"{ratios[name]:.1f}", errors.get(name, "")] for name in calls
    ]
    _measure.print_table(
        f"Load a BVH file of {path.stat().st_size / 1e6:.1f} MB, {' x '.join(map(str, ours.shape))} numbers, "
        f"median of {n_rounds} rounds",
        ["", "ms", "time / ours", "numbers most off ours"],
        rows + missing,
    )
    print("eigenwalker turns angles into exponential maps as well; bvh leaves its numbers as text, here too.")
    return [_at_least(f"as fast as {name}", ratios.get(name), aim) for name, aim in _AIMS.items()]


def _at_least(what: str, ratio: float | None, aim: float) -> tuple[str, str, bool | None]:
    return f"at least {aim} times {what}", f"{ratio or 0:.1f}", None if ratio is None else ratio >= aim


def _to_markers(path: Path, n_rounds: int) -> _Targets:
    walk = read_bvh(path)
    names = walk.skeleton.joint_names
    found = {}

    def by_peer(name: str) -> None:
        joints, positions = POSITIONS[name](path)
        found[name] = find_rig(joints).place(joints, to_package(positions, meters=0.01))

    peers, missing = _usable({name: lambda name=name: by_peer(name) for name in POSITIONS})
    calls = {_OURS: lambda: read_bvh(path).to_markers(), **peers}
    seconds = _measure.interleaved({name: _timed(call) for name, call in calls.items()}, n_rounds)
    ratios = {name: _measure.ratio(seconds, name, _OURS) for name in calls}
    ours = walk.to_markers().positions
    rows = []
    for name in calls:
        error = f"{np.abs(found[name] - ours).max():.1e}" if name in found else ""
        rows.append([name, f"{1e3 * np.median(seconds[name]):.1f}", f"{ratios[name]:.1f}", error])
    _measure.print_table(
        f"From a file to 15 markers, {walk.n_frames} frames of {len(names)} joints, median of {n_rounds} rounds",
        ["", "ms", "time / ours", "most off ours, m"],
        rows + missing,
    )
    return [_at_least("as fast as bvhio", ratios.get("bvhio"), 20)]


def _many_files(folder: Path, n_rounds: int) -> _Targets:
    files = sorted((_FOLDER / "bandai2").glob("*.bvh"))
    what = "recorded files"
    if not files:
        files, what = _synthetic_files(folder), "synthetic files"
    walks = {}

    def read(n_jobs: int) -> None:
        walks[n_jobs] = read_walks(files, n_jobs=n_jobs)

    calls = {f"n_jobs={n_jobs}": lambda n_jobs=n_jobs: read(n_jobs) for n_jobs in (1, 2)}
    seconds = _measure.interleaved({name: _timed(call) for name, call in calls.items()}, n_rounds)
    one, two = walks.values()
    error = max(float(np.abs(a.rotations - b.rotations).max()) for a, b in zip(one, two, strict=True))
    ratio = _measure.ratio(seconds, "n_jobs=1", "n_jobs=2")
    rows = [
        [name, f"{np.median(seconds[name]):.2f}", f"{1e3 * np.median(seconds[name]) / len(files):.1f}"]
        for name in calls
    ]
    _measure.print_table(f"{len(files)} {what}, median of {n_rounds} rounds", ["", "s", "ms a file"], rows)
    print(f"Two processes are {ratio:.2f} times as fast as one; their walks differ by {error:.0e}.")
    return [("the same walks by two processes", f"{error:.0e}", error == 0)]


def _synthetic_files(folder: Path) -> list[Path]:
    text = _written(folder, 300).read_bytes()
    files = [folder / f"walk_{number:03}.bvh" for number in range(175)]
    for file in files:
        file.write_bytes(text)
    return files


if __name__ == "__main__":
    main()
