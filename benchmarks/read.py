"""Reading files: ``python -m benchmarks.read [--short]``.

A BVH file beside pymotion and bvh, the way from a file to 15 markers beside bvhio, the way from a file to a prepared
walk beside the same, which leaves preparation out, and many files in one process and in two. One core, but for the
last row.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from benchmarks import _measure
from benchmarks._bvh_peers import LOADERS, POSITIONS, to_package
from benchmarks._command import run
from benchmarks._findings import Row
from benchmarks._joint_walks import make_joint_walks, random_joint_walk
from benchmarks._machine import describe_machine
from benchmarks._recordings import find_recordings
from benchmarks._tables import print_table
from eigenwalker.io import read_bvh, read_walks, write_bvh
from eigenwalker.io._bvh_text import parse_bvh
from eigenwalker.motion import find_rig, prepare, synthesize

_OURS = "eigenwalker"
_WANTED = {("load", "pymotion"): 6, ("load", "bvh"): 12, ("markers", "bvhio"): 20}
_BOUNDS = {"load": 0.0, "markers": 1e-5}  # numbers of the file; metres
_Calls = dict[str, Callable[[], object]]


def findings(*, short: bool) -> list[Row]:
    """Print the tables, and return a row for each peer."""
    with threadpool_limits(1), TemporaryDirectory() as name:
        folder = Path(name)
        print(describe_machine(("numpy", "numba", "upc-pymotion", "bvh", "bvhio")))
        return [
            *_load(_written(folder, 2752), 3 if short else 15),
            *_to_markers(_written(folder, 300 if short else 2752), 3 if short else 5),
            *_to_prepared(folder, 3 if short else 5),
            *_many_files(folder, 1 if short else 7),
        ]


def _written(folder: Path, n_frames: int) -> Path:
    path = folder / f"{n_frames}.bvh"
    write_bvh(random_joint_walk(np.random.default_rng(0), n_frames), path)
    return path


def _take_turns(
    calls: _Calls,
    n_rounds: int,
    title: str,
    *,
    missing: Mapping[str, str],
    errors: Mapping[str, float],
    apart: str,
) -> _measure.Seconds:
    """Print the table of some calls, with the reasons of those that are missing, and return the seconds."""
    seconds = _measure.interleaved({name: _measure.once(call) for name, call in calls.items()}, n_rounds)
    rows = [
        [
            name,
            f"{1e3 * np.median(seconds[name]):.1f}",
            f"{_measure.ratio(seconds, name, _OURS):.1f}",
            f"{errors[name]:.1e}" if name in errors else "",
        ]
        for name in calls
    ]
    rows += [[name, reason, "", ""] for name, reason in missing.items()]
    print_table(f"{title}, median of {n_rounds} rounds", ["", "ms", "time / ours", apart], rows)
    return seconds


def _load(path: Path, n_rounds: int) -> list[Row]:
    peers = {name: lambda load=load: load(path) for name, (load, _) in LOADERS.items()}
    found, missing = _measure.try_peers(peers)
    calls: _Calls = {_OURS: lambda: read_bvh(path), f"{_OURS}, numbers only": lambda: parse_bvh(path.read_bytes())}
    calls |= {name: peers[name] for name in found}
    ours = parse_bvh(path.read_bytes()).motion
    errors = {name: float(np.abs(LOADERS[name][1](file) - ours).max()) for name, file in found.items()}
    size = f"{path.stat().st_size / 1e6:.1f} MB, {' x '.join(map(str, ours.shape))} numbers"
    title = f"Load a BVH file of {size}"
    seconds = _take_turns(calls, n_rounds, title, missing=missing, errors=errors, apart="numbers most off ours")
    print("eigenwalker turns angles into exponential maps as well; bvh leaves its numbers as text, here too.")
    return [_row("load", "load a BVH file of 2.7 MB", seconds, name, errors, missing) for name in LOADERS]


def _row(
    part: str,
    task: str,
    seconds: _measure.Seconds,
    peer: str,
    errors: Mapping[str, float],
    missing: Mapping[str, str],
    *,
    unit: str = "",
) -> Row:
    asked = {"wanted": _WANTED.get((part, peer)), "error": errors.get(peer), "bound": _BOUNDS.get(part), "unit": unit}
    return _measure.beside(task, seconds, _OURS, peer, note=missing.get(peer, ""), **asked)


def _markers_by(peer: str, path: Path) -> NDArray[np.float64]:
    joints, positions = POSITIONS[peer](path)
    return find_rig(joints).place(joints, to_package(positions, meters=0.01))


def _to_markers(path: Path, n_rounds: int) -> list[Row]:
    walk = read_bvh(path)
    peers = {name: lambda name=name: _markers_by(name, path) for name in POSITIONS}
    found, missing = _measure.try_peers(peers)
    calls: _Calls = {_OURS: lambda: read_bvh(path).to_markers()} | {name: peers[name] for name in found}
    ours = walk.to_markers().positions
    errors = {name: float(np.abs(markers - ours).max()) for name, markers in found.items()}
    title = f"From a file to 15 markers, {walk.n_frames} frames of {len(walk.skeleton.joint_names)} joints"
    seconds = _take_turns(calls, n_rounds, title, missing=missing, errors=errors, apart="most off ours, m")
    task = f"read a file to 15 markers, {walk.n_frames} frames"
    return [_row("markers", task, seconds, name, errors, missing, unit="m") for name in POSITIONS]


def _to_prepared(folder: Path, n_rounds: int) -> list[Row]:
    path = folder / "walk.bvh"
    write_bvh(synthesize(make_joint_walks(1), duration=10.0, frame_rate=60.0)[0], path)
    peers = {"bvhio": lambda: _markers_by("bvhio", path)}
    found, missing = _measure.try_peers(peers)
    calls: _Calls = {_OURS: lambda: prepare(read_bvh(path))} | {name: peers[name] for name in found}
    title = "From a file to a prepared walk of 15 markers, 600 frames; the peer prepares nothing"
    seconds = _take_turns(calls, n_rounds, title, missing=missing, errors={}, apart="")
    note = missing.get("bvhio", "the peer reads and places markers, and prepares nothing")
    return [_measure.beside("read and prepare a walk of 600 frames", seconds, _OURS, "bvhio", note=note)]


def _many_files(folder: Path, n_rounds: int) -> list[Row]:
    files = sorted(find_recordings("bandai2").glob("*.bvh"))
    what = "recorded files"
    if not files:
        files, what = _synthetic_files(folder), "synthetic files"
    walks = {}

    def read(n_jobs: int) -> None:
        walks[n_jobs] = read_walks(files, n_jobs=n_jobs)

    jobs = {f"n_jobs={n_jobs}": _measure.once(lambda n_jobs=n_jobs: read(n_jobs)) for n_jobs in (1, 2)}
    seconds = _measure.interleaved(jobs, n_rounds)
    one, two = walks.values()
    error = max(float(np.abs(a.rotations - b.rotations).max()) for a, b in zip(one, two, strict=True))
    rows = [
        [name, f"{np.median(seconds[name]):.2f}", f"{1e3 * np.median(seconds[name]) / len(files):.1f}"] for name in jobs
    ]
    print_table(f"{len(files)} {what}, median of {n_rounds} rounds", ["", "s", "ms a file"], rows)
    task = f"read {len(files)} {what}, two processes"
    return [_measure.beside(task, seconds, "n_jobs=2", "n_jobs=1", error=error, bound=0.0)]


def _synthetic_files(folder: Path) -> list[Path]:
    text = _written(folder, 300).read_bytes()
    files = [folder / f"walk_{number:03}.bvh" for number in range(175)]
    for file in files:
        file.write_bytes(text)
    return files


if __name__ == "__main__":
    run(findings, __doc__, short="fewer rounds, and fewer frames for markers")
