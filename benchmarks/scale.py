"""From a thousand walks to a hundred thousand: ``python -m benchmarks.scale [--short]``.

Walks are made on the fly, linearized into a data set on disk, and reduced to Eigenwalkers and a trait axis from there.
Each number of walks has a process of its own, between others with a thousand walks, so that a machine that grows slower
slows them all. Memory is that of the process and its workers together; pages that they share count once where the
system tells (Linux).
"""

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

from benchmarks._command import finish, suite_parser
from benchmarks._findings import Check, Finding, Row
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table

if TYPE_CHECKING:  # nothing large may be imported before a child starts: Linux hands the parent's peak on to it
    import pandas as pd

    from eigenwalker import Walk

_RATE = 60.0
_FEW = 1000
_LONG, _SHORT = (10_000, 100_000), (5000,)
_SPREAD = 0.2  # by how much the time a walk may be above that of a few walks
_LIMIT = 2**30  # bytes
_TIMES = 1.7  # one core's time by that of two
_BOUND = 1e-10  # of features that were scaled to a variance of 1
_PAUSE = 0.2  # seconds between two looks at the memory


class _Run(NamedTuple):
    """What a child process measured, and how much memory it and its workers took."""

    n_walks: int
    n_jobs: int
    linearized: float
    fitted: float
    processor: float
    agreement: float
    peak: int


def main() -> None:
    """Print the tables, or be a process that works on some walks."""
    parser = suite_parser(__doc__, short=f"{_SHORT[-1]:,} walks at most instead of {_LONG[-1]:,}")
    parser.add_argument("--child", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        name, *numbers = arguments.child.split(",")
        print(json.dumps(_CHILDREN[name](*map(int, numbers))))
    else:
        finish(findings(short=arguments.short), arguments.out)


def findings(*, short: bool) -> list[Finding]:
    """Run the children, print the tables, and return what is asked of them."""
    print(describe_machine())
    sizes = _SHORT if short else _LONG
    order = [_FEW, *(n for size in sizes for n in (size, _FEW))]
    runs = [_run_child(n_walks, 1) for n_walks in order]
    both = _run_child(sizes[-1], 2)
    _print_runs([*runs, both])
    return [
        *_compare_sizes(runs),
        *(_check_memory(run) for run in (next(run for run in runs if run.n_walks == sizes[-1]), both)),
        _compare_cores(4 if short else 12),
        _compare_models(),
    ]


def _call(name: str, *numbers: int) -> list[str]:
    return [sys.executable, "-m", "benchmarks.scale", "--child", ",".join(map(str, (name, *numbers)))]


def _run_child(n_walks: int, n_jobs: int) -> _Run:
    with subprocess.Popen(_call("run", n_walks, n_jobs), stdout=subprocess.PIPE) as child:
        peak = 0
        while child.poll() is None:
            peak = max(peak, _bytes_of_family(child.pid))
            time.sleep(_PAUSE)
        assert child.stdout is not None
        printed = child.stdout.read()
    if child.returncode:
        raise RuntimeError(f"the process with {n_walks} walks ended with status {child.returncode}")
    return _Run(n_walks, n_jobs, **json.loads(printed), peak=peak)


def _bytes_of_family(process: int) -> int:
    """Return the memory of a process and those that it has started."""
    import psutil

    total = 0
    try:
        first = psutil.Process(process)
        for member in [first, *first.children(recursive=True)]:
            memory = member.memory_full_info()
            total += getattr(memory, "pss", memory.rss)
    except psutil.Error:  # one of them has just ended
        pass
    return total


# What children do.


def make_walk(number: int) -> "Walk":
    """Return a walker with a trait, his steps, and noise, all from one number."""
    import numpy as np

    from benchmarks._synthetic import random_walk
    from eigenwalker import Walk

    base, axis = _planted()
    random = np.random.default_rng(number)
    own = base + _trait(number) * axis + 0.01 * random.standard_normal(base.shape)
    angles = 2 * np.pi * random.uniform(0.8, 1.1) / _RATE * np.arange(random.integers(300, 500))
    channels = random_walk(random, own, angles, 0.002)
    channels.flags.writeable = False  # else the walk keeps a copy
    return Walk(channels.reshape(len(channels), -1, 3), _RATE, name=str(number))


@cache
def _planted() -> tuple[Any, Any]:
    """Return the coefficients of the average walker, and what one unit of the trait adds to them."""
    import numpy as np

    from benchmarks._synthetic import random_coefficients

    random = np.random.default_rng(0)
    base = random_coefficients(random)
    return base, 0.01 * random.standard_normal(base.shape)


def _trait(number: int) -> float:
    """Return a number's trait: uniform over -1 to 1, by steps of the golden section."""
    return 2 * (number * 0.6180339887498949 % 1) - 1


def _linearize(n_walks: int, n_jobs: int, folder: str, first: int = 0) -> Path:
    from benchmarks import scale  # by this name workers find it, whatever name this process runs under
    from eigenwalker import FourierLinearizer
    from eigenwalker.batch import linearize_files

    numbers = range(first, first + n_walks)
    out = Path(folder, f"walks_{n_walks}_{n_jobs}_{first}")
    linearize_files(numbers, FourierLinearizer(), out, read=scale.make_walk, preparer="passthrough", n_jobs=n_jobs)
    return out


def _parts(folder: Path) -> Iterator[tuple["pd.DataFrame", Any]]:
    from eigenwalker.batch import iterate_coefficients

    for table in iterate_coefficients(folder):
        yield table, [_trait(int(name)) for name in table["name"]]


def _fit(folder: Path) -> Any:
    from eigenwalker import make_eigenwalkers
    from eigenwalker.batch import read_linearizer
    from eigenwalker.model import fit_stream

    model = make_eigenwalkers().set_params(linearizer=read_linearizer(folder))
    return fit_stream(model, lambda: _parts(folder))


def _measure_run(n_walks: int, n_jobs: int) -> dict[str, float]:
    import numpy as np

    with TemporaryDirectory() as folder:
        _fit(_linearize(64, n_jobs, folder, first=n_walks))  # compiled code, imports and workers are there now
        start, used = time.perf_counter(), time.process_time()
        table = _linearize(n_walks, n_jobs, folder)
        linearized = time.perf_counter() - start
        model = _fit(table)
        fitted = time.perf_counter() - start - linearized
        used = time.process_time() - used
    walks = [make_walk(n_walks + 64 + position) for position in range(200)]
    traits = [_trait(int(walk.name)) for walk in walks]
    agreement = float(np.corrcoef(model.predict(walks).ravel(), traits)[0, 1])
    return {"linearized": linearized, "fitted": fitted, "processor": used, "agreement": agreement}


def _measure_cores(n_rounds: int) -> dict[str, Any]:
    from benchmarks import _measure

    n_walks = 2 * _FEW
    with TemporaryDirectory() as folder:

        def portion(n_jobs: int) -> Any:
            def run(turn: int) -> int:
                _linearize(n_walks, n_jobs, folder, first=next(firsts))
                return n_walks

            return run

        firsts = iter(range(0, 10**9, n_walks))
        portions = {"one": portion(1), "two": portion(2), "one_counts": _count_with(1), "two_count": _count_with(2)}
        seconds = _measure.interleaved(portions, n_rounds)
        one, two = _linearize(_FEW, 1, folder), _linearize(_FEW, 2, folder)
        is_same = [path.read_bytes() for path in sorted(one.glob("*.parquet"))] == [
            path.read_bytes() for path in sorted(two.glob("*.parquet"))
        ]
    return {name: values.tolist() for name, values in seconds.items()} | {"is_same": is_same}


def _count_with(n_jobs: int) -> Any:
    """Return a portion of work that nothing but the machine can make slow with two processes."""
    from joblib import Parallel, delayed

    from benchmarks import scale

    def run(turn: int) -> int:
        return len(Parallel(n_jobs)(delayed(scale.count_up)() for _ in range(64)))

    return run


def count_up() -> int:
    """Count, for some hundredths of a second."""
    total = 0
    for number in range(500_000):
        total += number & 1
    return total


def _measure_difference() -> float:
    """Return how far the scores of a streamed model are from those of the same walks fitted at once."""
    import numpy as np

    from eigenwalker import make_eigenwalkers

    walks = [make_walk(number) for number in range(_FEW)]
    with TemporaryDirectory() as folder:
        streamed = _fit(_linearize(_FEW, 1, folder))
    at_once = make_eigenwalkers().fit(walks, [_trait(number) for number in range(_FEW)])
    return float(np.abs(streamed.predict(walks) - at_once.predict(walks)).max())


_CHILDREN = {"run": _measure_run, "cores": _measure_cores, "difference": _measure_difference}


# What is asked of them.


def _print_runs(runs: Sequence[_Run]) -> None:
    rows = [
        [
            f"{run.n_walks:,}",
            str(run.n_jobs),
            f"{run.linearized / run.n_walks * 1e3:.2f}",
            f"{run.fitted / run.n_walks * 1e3:.3f}",
            f"{run.processor / run.n_walks * 1e3:.2f}",
            f"{run.peak / 2**20:.0f}",
            f"{run.agreement:.3f}",
        ]
        for run in runs
    ]
    header = ["walks", "processes", "linearized, ms a walk", "axes, ms a walk", "processor", "peak, MiB", "correlation"]
    print_table("Walks made, linearized, reduced and given a trait axis; its correlation in new walks", header, rows)


def _compare_sizes(runs: Sequence[_Run]) -> list[Row]:
    few = [run for run in runs if run.n_walks == _FEW]
    many = [run for run in runs if run.n_walks != _FEW]
    return [
        _compare_size(what, run.n_walks, time_of(run), median(map(time_of, few)))
        for what, time_of in (("time", _time_a_walk), ("processor time", _processor_a_walk))
        for run in many
    ]


def _compare_size(what: str, n_walks: int, many_s: float, few_s: float) -> Row:
    task = f"linearize {n_walks:,} walks and fit, {what} a walk"
    return Row(task, many_s, f"ours, {_FEW:,}", few_s, few_s / many_s, wanted=1 / (1 + _SPREAD))


def _time_a_walk(run: _Run) -> float:
    return (run.linearized + run.fitted) / run.n_walks


def _processor_a_walk(run: _Run) -> float:
    return run.processor / run.n_walks


def _check_memory(run: _Run) -> Check:
    wanted = f"{run.n_walks:,} walks in less than {_LIMIT / 2**30:.0f} GiB, n_jobs={run.n_jobs}"
    return Check(wanted, f"{run.peak / 2**20:.0f} MiB", run.peak < _LIMIT)


def _compare_cores(n_rounds: int) -> Row:
    found = _output("cores", n_rounds)
    ratios = [one / two for one, two in zip(found["one"], found["two"], strict=True)]
    counts = [one / two for one, two in zip(found["one_counts"], found["two_count"], strict=True)]
    for what, values in (("beside one", ratios), ("that only count", counts)):
        print(f"\nTwo processes {what}, {n_rounds} rounds: {', '.join(f'{ratio:.2f}' for ratio in values)}")
    return Row(
        "linearize, a walk, two processes",
        median(found["two"]),
        "one process",
        median(found["one"]),
        median(ratios),
        wanted=_TIMES,
        error=float(not found["is_same"]),
        bound=0.0,
        unit="bytes",
        note=f"two processes that only count: {median(counts):.2f} times one",
    )


def _compare_models() -> Check:
    difference = _output("difference")
    wanted = f"predictions of the streamed model within {_BOUND:g} of the Pipeline's, {_FEW:,} walks"
    return Check(wanted, f"{difference:.1e}", difference <= _BOUND)


def _output(name: str, *numbers: int) -> Any:
    return json.loads(subprocess.run(_call(name, *numbers), check=True, stdout=subprocess.PIPE).stdout)


if __name__ == "__main__":
    main()
