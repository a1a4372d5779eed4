"""What the benchmarks share: the machine, interleaved timing, the bandwidth of memory, tables."""

import os
import platform
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import PackageNotFoundError, version

import numpy as np
from numba import njit
from numpy.typing import NDArray
from threadpoolctl import threadpool_info

__all__ = [
    "describe_machine",
    "interleaved",
    "print_table",
    "print_targets",
    "ratio",
    "read_bandwidth",
    "sum_values",
]


def describe_machine(packages: Sequence[str] = ("numpy", "scipy", "scikit-learn", "numba")) -> str:
    """Return processor, cores, versions and the threads of the linear algebra, in two lines."""
    pools = ", ".join(f"{pool['internal_api']} {pool['num_threads']}" for pool in threadpool_info()) or "none"
    versions = ", ".join(f"{package} {_version(package)}" for package in packages)
    return (
        f"Machine: {_processor()}, {os.cpu_count()} cores; {platform.system()}; threads a pool: {pools}\n"
        f"Versions: Python {platform.python_version()}, {versions}"
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def interleaved(functions: Mapping[str, Callable[[int], float]], n_rounds: int) -> dict[str, NDArray[np.float64]]:
    """Return seconds a walk of each function in each round, shape (n_rounds,), after one round that is not counted.

    Parameters
    ----------
    functions : mapping of str to callable
        Each takes the number of the round, works on some walks, and returns how many they were.
    n_rounds : int
        Rounds in which all functions take turns, so that all of them meet the same other load.
    """
    seconds = {name: np.empty(n_rounds) for name in functions}
    for turn in range(-1, n_rounds):
        for name, function in functions.items():
            start = time.perf_counter()
            n_walks = function(max(turn, 0))
            if turn >= 0:
                seconds[name][turn] = (time.perf_counter() - start) / n_walks
    return seconds


def ratio(seconds: Mapping[str, NDArray[np.float64]], name: str, reference: str) -> float:
    """Return how many times slower `name` is than `reference`, the median over the rounds."""
    return float(np.median(seconds[name] / seconds[reference]))


@njit(cache=True, nogil=True, fastmath=True)
def sum_values(values):
    """Return the sum of a vector, as fast as memory delivers it."""
    total = 0.0
    for position in range(len(values)):
        total += values[position]
    return total


def read_bandwidth(n_cores: int, *, megabytes: int = 1024, n_rounds: int = 5) -> float:
    """Return bytes a second that sums over an array too large for the caches read, the best of some rounds."""
    parts = np.array_split(np.ones(megabytes * 131072), n_cores)
    sum_values(parts[0][:8])
    seconds = []
    with ThreadPoolExecutor(n_cores) as pool:
        for _ in range(n_rounds):
            start = time.perf_counter()
            list(pool.map(sum_values, parts))
            seconds.append(time.perf_counter() - start)
    return megabytes * 2**20 / min(seconds)


def print_table(title: str, header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table with columns as wide as their longest cell, the first to the left, the others to the right."""
    lines = [list(header), *[list(row) for row in rows]]
    widths = [max(len(line[column]) for line in lines) for column in range(len(header))]
    print(f"\n{title}")
    for line in lines:
        cells = [cell.rjust(width) for cell, width in zip(line[1:], widths[1:], strict=True)]
        print("  ".join([line[0].ljust(widths[0]), *cells]).rstrip())


def print_targets(targets: Iterable[tuple[str, str, bool | None]]) -> None:
    """Print which targets are met: what is wanted, what was measured, and whether that is enough (None: not run)."""
    print("\nTargets")
    for wanted, measured, met in targets:
        print(f"  {'met   ' if met else 'not run' if met is None else 'MISSED'} {wanted}: {measured}")
