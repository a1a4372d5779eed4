"""Small sound files of each format, what becomes of them, and what may come of reading that.

Every mutant has a number: the same number of the same format is the same file, on every machine.
"""

import json
import re
import resource
import signal
import struct
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from types import FrameType
from typing import NamedTuple

import numpy as np
from scipy.io import savemat

from eigenwalker._validation import WalkError
from eigenwalker.io import read_amc, read_bml, read_walk, write_bvh, write_walk
from eigenwalker.motion import Event, MarkerSet, Walk
from tests.acclaim import AMC, ASF
from tests.binary_mutations import mutate_c3d, mutate_mat, mutate_npz
from tests.bvh_files import BVH
from tests.c3d_files import POINTS, Maker
from tests.marker_walks import body
from tests.mutations import grow, mutate_json, mutate_text, splice

__all__ = [
    "FORMATS",
    "MisreadError",
    "Seed",
    "make_mutant",
    "make_seeds",
    "memory_limit",
    "read_mutant",
    "recorded_seeds",
]

FORMATS = ("bvh", "amc", "trc", "csv", "tsv", "bids", "kinect", "c3d", "npz", "bml")
SECONDS = 5.0  # of the processor, that reading one file may take
LARGEST = 2**23  # bytes of a file, minutes of motion; some mutations after each other would make hundreds of megabytes
LONGEST = 6000  # characters of an error, the name of the file apart

_WHOLE = (  # faults that no line can be named for, or that stand in a file without lines
    *("legs are", "expected finite positions with unit=", ".json", "got infinite ones"),
    *("expected as last of each 46", "expected positions in millimetres", "expected a stride's period"),
    *("expected a matrix of", "expected its companion", "expected its skeleton"),
)
_BINARY = {".c3d": mutate_c3d, ".npz": mutate_npz, ".mat": mutate_mat}


class Seed(NamedTuple):
    """A sound recording: its files by name, the first one to be read, and how."""

    files: Mapping[str, bytes]
    read: Callable[[Path], object]


class MisreadError(AssertionError):
    """A file that gave neither a walk nor an error as it should be."""


def make_seeds() -> dict[str, list[Seed]]:
    """Return small recordings of each format, made by this package's writers and by hand."""
    rng = np.random.default_rng(5)
    whole = body(rng, gaps=4)
    known = Walk(whole.positions, 120.0, name="anna", events=(Event(0.01, "heel_strike", "left"), Event(0.02, "turn")))
    small = Walk(rng.normal(size=(4, 2, 3)), 100.0, MarkerSet(("heel", "toe é")))
    with TemporaryDirectory() as name:
        folder = Path(name)
        seeds = {
            kind: [_written(folder, walk, f"walk.{kind}") for walk in (known, small)]
            for kind in ("trc", "csv", "tsv", "c3d", "npz")
        }
        joints = _acclaim(folder)
        write_walk(joints, folder / "joints.npz")
        write_bvh(joints, folder / "walk.bvh")
        seeds["npz"].append(_seed(folder, ["joints.npz"]))
        seeds["bvh"] = [_seed(folder, ["walk.bvh"]), Seed({"walk.bvh": BVH.encode()}, read_walk)]
        seeds["bids"] = [_bids(folder, known), _other_bids(folder, small)]
        seeds["bml"] = _bml(folder)
    seeds["amc"] = [Seed({"walk.amc": AMC.encode(), "walk.asf": ASF.encode()}, read_walk)]
    seeds["kinect"] = [Seed({"walk.txt": _kinect_text(rng)}, read_walk)]
    seeds["c3d"] += [Seed({"walk.c3d": _c3d(processor)}, read_walk) for processor in ("Intel", "DEC", "MIPS")]
    return {kind: seeds[kind] for kind in FORMATS}


def recorded_seeds(folder: Path) -> dict[str, list[Seed]]:
    """Return the heads of some recorded files."""
    bvh = [*sorted((folder / "bandai2").glob("*.bvh"))[::60], *sorted((folder / "cmu_bvh").glob("*.bvh"))[::9]]
    kinect = sorted((folder / "kinect").glob("*/*.txt"))[::80]
    c3d = sorted((folder / "horst_c3d").glob("*.c3d"))[:2]
    return {
        "bvh recorded": [_bvh_head(path) for path in bvh],
        "kinect recorded": [
            Seed({"walk.txt": b"".join(path.read_bytes().splitlines(keepends=True)[:60])}, read_walk) for path in kinect
        ],
        "c3d recorded": [_c3d_head(path.read_bytes()) for path in c3d],
    }


def make_mutant(seeds: Mapping[str, list[Seed]], kind: str, number: int) -> Seed:
    """Return what becomes of one of the recordings of a format."""
    random = Random(f"{kind} {number}")
    seed = random.choice(seeds[kind])
    files = dict(seed.files)
    name = random.choice((next(iter(files)), *files))
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        files[name] = _mutate(random, files[name], Path(name).suffix)[:LARGEST]
    if random.random() < 0.04:
        other = random.choice(seeds[random.choice((kind, *seeds))])
        files[name] = splice(random, files[name], random.choice(list(other.files.values())))
    if random.random() < 0.01:
        files.pop(random.choice(list(files)[1:] or [""]), None)
    return Seed(files, seed.read)


def _mutate(random: Random, data: bytes, ending: str) -> bytes:
    if ending in _BINARY:
        return _BINARY[ending](random, data)
    if ending == ".json":
        return mutate_json(random, data)
    return grow(random, data, ending) if random.random() < 0.02 else mutate_text(random, data)


def read_mutant(mutant: Seed, folder: Path) -> str:
    """Read the first of the files and return "" for a walk, the error for a good refusal.

    Raises
    ------
    MisreadError
        If there is any other exception or a warning, if it takes too long, or if the error does not name the file
        and, in a text, the line.
    """
    for name, data in mutant.files.items():
        (folder / name).write_bytes(data)
    first = folder / next(iter(mutant.files))
    try:
        with warnings.catch_warnings(), _time_limit():
            warnings.simplefilter("error")
            mutant.read(first)
    except WalkError as error:
        _check_message(str(error), folder, first)
        return str(error)
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        raise MisreadError(f"{type(error).__name__}: {str(error)[:300]}") from error
    finally:
        for name in mutant.files:
            (folder / name).unlink()
    return ""


class _TooLong(BaseException):
    """So that no reader takes it for one of its own errors."""


@contextmanager
def memory_limit(n_bytes: int = 2**30) -> Iterator[None]:
    """Let a request for more memory than so many bytes beyond what is mapped now fail, where the system can do that."""
    try:
        mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except OSError:
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = mapped + n_bytes if hard == resource.RLIM_INFINITY else min(mapped + n_bytes, hard)
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@contextmanager
def _time_limit() -> Iterator[None]:
    def stop(number: int, frame: FrameType | None) -> None:
        raise _TooLong(f"reading takes more than {SECONDS:g} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def _check_message(message: str, folder: Path, first: Path) -> None:
    """Raise unless an error names the file, and the line if it is a text, in one line that can be read."""
    plain = message.replace(str(folder), "")
    if str(folder) not in message:
        raise MisreadError(f"the error does not name the file: {message[:300]}")
    if first.suffix in (".c3d", ".npz", ".mat"):
        named = "MemoryError" not in message
    else:
        named = re.search(r"line \d", message) or any(word in message for word in _WHOLE)
    if not named:
        raise MisreadError(f"the error names no line: {plain[:300]}")
    if len(plain) > LONGEST or "\n" in plain:
        raise MisreadError(f"the error has {len(plain)} characters, {plain.count(chr(10)) + 1} lines: {plain[:300]!r}")


def _seed(folder: Path, names: list[str]) -> Seed:
    return Seed({name: (folder / name).read_bytes() for name in names}, read_walk)


def _written(folder: Path, walk: Walk, name: str) -> Seed:
    write_walk(walk, folder / name)
    return _seed(folder, [name])


def _acclaim(folder: Path):
    (folder / "walk.asf").write_text(ASF)
    (folder / "walk.amc").write_text(AMC)
    return read_amc(folder / "walk.amc")


def _bvh_head(path: Path) -> Seed:
    """Return the first four frames of a BVH file."""
    lines = path.read_bytes().splitlines(keepends=True)
    start = next(place for place, line in enumerate(lines) if line.startswith(b"Frames:"))
    lines[start] = b"Frames: 4\n"
    unit = {"cmu_bvh": 0.0564}.get(path.parent.name, "cm")
    return Seed({"walk.bvh": b"".join(lines[: start + 6])}, partial(read_walk, unit=unit))


def _c3d_head(data: bytes) -> Seed:
    """Return a C3D file that says it has three frames."""
    n_points, n_analog, first = struct.unpack_from("<HHH", data, 2)
    size = 4 * (4 * n_points + n_analog)
    changed = bytearray(data[: 512 * (struct.unpack_from("<H", data, 16)[0] - 1) + 3 * size])
    struct.pack_into("<H", changed, 8, first + 2)
    for name in (b"ACTUAL_START_FIELD", b"ACTUAL_END_FIELD"):
        place = data.find(name) + len(name) + 5  # behind offset, type and sizes
        struct.pack_into("<HH", changed, place, first + 2 * (b"END" in name), 0)
    return Seed({"walk.c3d": bytes(changed)}, read_walk)


_BIDS = ("_motion.tsv", "_channels.tsv", "_motion.json", "_events.tsv")


def _bids(folder: Path, walk: Walk) -> Seed:
    write_walk(walk, folder / "sub-1_motion.tsv")
    return _seed(folder, ["sub-1" + ending for ending in _BIDS])


def _other_bids(folder: Path, walk: Walk) -> Seed:
    """Return a recording with a column of times, reference frames, and their description."""
    write_walk(walk, folder / "sub-2_motion.tsv")
    files = dict(_seed(folder, ["sub-2" + ending for ending in _BIDS[:3]]).files)
    rows = files["sub-2_motion.tsv"].decode().splitlines()
    timed = [f"{row}\t{frame / 100:.9f}\n" for frame, row in enumerate(rows)]
    titles, *channels = files["sub-2_channels.tsv"].decode().splitlines()
    table = [f"{titles}\tsampling_frequency\treference_frame\n", *(f"{row}\t100\tlab\n" for row in channels)]
    sidecar = json.loads(files["sub-2_motion.json"])
    del sidecar["SpatialAxes"]
    return Seed(
        {
            "sub-2_motion.tsv": "".join(timed).encode(),
            "sub-2_channels.tsv": "".join([*table, "time\tn/a\tLATENCY\tn/a\ts\t100\tn/a\n"]).encode(),
            "sub-2_motion.json": json.dumps(sidecar).encode(),
            "sub-2_channels.json": json.dumps(
                {"reference_frame": {"Levels": {"lab": {"SpatialAxes": "RAS"}}}}
            ).encode(),
        },
        read_walk,
    )


def _bml(folder: Path) -> list[Seed]:
    """Return a matrix in a MATLAB file, as it is and compressed, and as text."""
    matrix = np.zeros((5, 46))
    matrix[:3, 45] = 126.03, 1.02, 11.3
    matrix[0, :45] = 1000 * body(np.random.default_rng(6)).positions[0].T.ravel()  # 15 x, 15 y, 15 z
    savemat(folder / "plain.mat", {"walker": matrix, "note": "a word"})
    savemat(folder / "packed.mat", {"walker": matrix.ravel()}, do_compression=True)
    files = [(folder / name).read_bytes() for name in ("plain.mat", "packed.mat")]
    undated = [b"MATLAB 5.0 MAT-file".ljust(116) + data[116:] for data in files]
    text = "".join(",".join(map(repr, row)) + "\n" for row in matrix.tolist())
    return [Seed({"walk.mat": data}, read_walk) for data in undated] + [Seed({"walk.csv": text.encode()}, read_bml)]


def _kinect_text(rng: np.random.Generator) -> bytes:
    pairs = ("Shoulder", "Elbow", "Wrist", "Hand", "Hip", "Knee", "Ankle", "Foot")
    titles = ["Head", "Shoulder-Center", "Spine", "Hip-centro"]
    titles += [f"{joint}-{side}" for side in ("Left", "Right") for joint in pairs]
    heights = {"Hip": 0.9, "Knee": 0.5, "Ankle": 0.1}
    still = np.array([[0.1 * ("Left" in title), heights.get(title.split("-")[0], 1.2), 2.5] for title in titles])
    rows = [
        f"{title};{';'.join(map(repr, place))}\r\n"
        for _ in range(3)
        for title, place in zip(titles, (still + 0.01 * rng.normal(size=(20, 3))).tolist(), strict=True)
    ]
    return "".join(rows).encode()


def _c3d(processor: str) -> bytes:
    """Return integers with analog data, and a recording whose length is said in parameters."""
    maker = Maker(processor)
    more = maker.entry("TRIAL", -3, b"\0")
    for name, frame in (("ACTUAL_START_FIELD", 1), ("ACTUAL_END_FIELD", 2)):
        kind, numbers = (4, maker.real(frame, 0)) if processor == "DEC" else (2, maker.word(frame, 0))
        more += maker.parameter(name, 3, kind, [2], numbers)
    return maker.file(POINTS, scale=0.1 if processor != "MIPS" else -1.0, analog=3, more=more)
