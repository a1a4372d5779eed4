"""What comes of 200,000 damaged files: ``python -m benchmarks.fuzz [--short]``.

Each must give a walk or an error that names it, within 5 seconds and 1 GiB, and nothing else. Files are those of
`tests.mutated_files`: ``python -m benchmarks.fuzz --replay bvh 1234`` writes one of them and reads it again. The heads
of recorded files are used where the folder of recorded walks is there. Needs a Unix system; ``--jobs`` processes.
"""

import argparse
import faulthandler
import json
import resource
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir

from benchmarks._command import finish, suite_parser
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._recordings import find_recordings
from benchmarks._tables import print_table

_A_TIME = 5000  # files a process
_RECORDED = ("bvh recorded", "kinect recorded", "c3d recorded")
_FOLDER = find_recordings()


def main() -> None:
    """Read all the files in processes of their own and print what came of it."""
    parser = suite_parser(__doc__, short="5,000 files instead of 200,000")
    parser.add_argument("--jobs", type=int, default=1, help="processes at a time")
    parser.add_argument("--replay", nargs=2, metavar=("KIND", "NUMBER"), help="read a single file, and keep it")
    parser.add_argument("--child", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        kind, first, last = arguments.child
        print(json.dumps(_read_mutants(kind, int(first), int(last))))
    elif arguments.replay:
        _replay(arguments.replay[0], int(arguments.replay[1]))
    else:
        finish(findings(short=arguments.short, n_jobs=arguments.jobs), arguments.out)


def findings(*, short: bool, n_jobs: int = 1) -> list[Check]:
    """Read all the files in processes of their own, print what came of it, and return whether there are faults."""
    # Nothing large may be imported before the children start: Linux hands the parent's peak on to them.
    return _run(5000 if short else 200_000, n_jobs)


def _kinds() -> list[str]:
    formats = ["bvh", "amc", "trc", "csv", "tsv", "bids", "kinect", "c3d", "npz", "bml"]
    return formats + [kind for kind in _RECORDED if _FOLDER.is_dir()]


def _run(n_files: int, n_jobs: int) -> list[Check]:
    kinds = _kinds()
    each = -(-n_files // len(kinds))
    portions = [(kind, first, min(first + _A_TIME, each)) for kind in kinds for first in range(0, each, _A_TIME)]
    start = time.perf_counter()
    with ThreadPoolExecutor(n_jobs) as pool:
        results = list(pool.map(_start_child, portions))
    minutes = (time.perf_counter() - start) / 60
    return _report({kind: [found for found in results if found["kind"] == kind] for kind in kinds}, minutes, n_jobs)


def _start_child(portion: tuple[str, int, int]) -> dict:
    """Return what a child found; one that dies has a fault to report too."""
    kind, *numbers = portion
    command = [sys.executable, "-m", "benchmarks.fuzz", "--child", kind, *map(str, numbers)]
    child = subprocess.run(command, capture_output=True, text=True)
    print(f"{time.strftime('%H:%M:%S')} {kind} {numbers[0]} to {numbers[1] - 1}: exit {child.returncode}", flush=True)
    if child.returncode == 0:
        return json.loads(child.stdout)
    last = child.stderr.rpartition("reading ")[2].split("\n")[0]
    faults = [[kind, last, f"the process ended with {child.returncode}: {child.stderr[-1000:]}"]]
    return {"kind": kind, "walks": 0, "errors": 0, "faults": faults, "worst": [0.0, 0], "peak": [0, 0]}


def _read_mutants(kind: str, first: int, last: int) -> dict:
    """Return counts, faults, the longest time in seconds and the most bytes, each with the number of the file."""
    from tests.mutated_files import MisreadError, make_mutant, memory_limit, read_mutant

    seeds = _seeds()
    counts, faults = Counter[str](), []
    worst, peak = (0.0, 0), (0, 0)
    with TemporaryDirectory() as name, memory_limit():
        folder = Path(name)
        for seed in seeds[kind]:
            read_mutant(seed, folder)  # what is compiled and imported is there now
        before = highest = _peak_bytes()
        for number in range(first, last):
            mutant = make_mutant(seeds, kind, number)
            print(f"reading {number}", file=sys.stderr)
            faulthandler.dump_traceback_later(120, exit=True)  # what no signal can stop
            start = time.process_time()  # of this process alone, whatever else the machine does
            try:
                counts["errors" if read_mutant(mutant, folder) else "walks"] += 1
            except MisreadError as error:
                faults.append([kind, number, str(error)])
            worst = max(worst, (time.process_time() - start, number))
            if _peak_bytes() > highest:
                highest = _peak_bytes()
                peak = (highest - before, number)
        faulthandler.cancel_dump_traceback_later()
    return {"kind": kind, "walks": counts["walks"], "errors": counts["errors"], "faults": faults} | {
        "worst": worst,
        "peak": peak,
    }


def _seeds() -> dict:
    from tests.mutated_files import make_seeds, recorded_seeds

    return make_seeds() | (recorded_seeds(_FOLDER) if _FOLDER.is_dir() else {})


def _peak_bytes() -> int:
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def _report(found: dict[str, list[dict]], minutes: float, n_jobs: int) -> list[Check]:
    print(describe_machine(("numpy", "numba")))
    rows = []
    for kind, portions in found.items():
        walks, errors = (sum(part[key] for part in portions) for key in ("walks", "errors"))
        slowest, largest = (max(part[key] for part in portions) for key in ("worst", "peak"))
        rows.append(
            [
                kind,
                f"{walks:,}",
                f"{errors:,}",
                str(sum(len(part["faults"]) for part in portions)),
                f"{slowest[0]:.2f}",
                f"{largest[0] / 1e6:.0f}",
            ]
        )
    print_table(
        f"Damaged files read in {minutes:.1f} minutes by {n_jobs} processes at a time",
        ["", "walks", "errors", "faults", "longest, s", "most memory, MB"],
        rows,
    )
    faults = [fault for portions in found.values() for part in portions for fault in part["faults"]]
    for kind, number, message in faults[:50]:
        print(f"FAULT --replay {kind!r} {number}: {message}")
    return [
        Check("damaged files give nothing but walks and errors that name them", f"{len(faults)} others", not faults)
    ]


def _replay(kind: str, number: int) -> None:
    """Write one of the files into a folder that stays, and read it without a limit."""
    from tests.mutated_files import make_mutant

    mutant = make_mutant(_seeds(), kind, number)
    folder = Path(gettempdir(), f"fuzz-{kind.replace(' ', '-')}-{number}")
    folder.mkdir(exist_ok=True)
    for name, data in mutant.files.items():
        (folder / name).write_bytes(data)
    print(f"{folder}: {', '.join(mutant.files)}")
    print(mutant.read(folder / next(iter(mutant.files))))


if __name__ == "__main__":
    main()
