"""Times of several ways to do a job in turns, the rows that come of them, and the bandwidth of memory."""

import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from benchmarks._findings import Row

__all__ = ["beside", "interleaved", "once", "ratio", "read_bandwidth", "sum_values", "try_peers"]

Seconds = Mapping[str, NDArray[np.float64]]


def interleaved(
    functions: Mapping[str, Callable[[int], float]], n_rounds: int, *, warm: bool = True
) -> dict[str, NDArray[np.float64]]:
    """Return seconds a walk of each function in each round, shape (n_rounds,).

    Parameters
    ----------
    functions : mapping of str to callable
        Each takes the number of the round, works on some walks, and returns how many they were.
    n_rounds : int
        Rounds in which all functions take turns, so that all of them meet the same other load.
    warm : bool
        Whether there is a round before them that is not counted.
    """
    seconds = {name: np.empty(n_rounds) for name in functions}
    for turn in range(-1 if warm else 0, n_rounds):
        for name, function in functions.items():
            start = time.perf_counter()
            n_walks = function(max(turn, 0))
            if turn >= 0:
                seconds[name][turn] = (time.perf_counter() - start) / n_walks
    return seconds


def once(job: Callable[[], object]) -> Callable[[int], int]:
    """Return a function for `interleaved` that does a job once in each round, whatever it is counted as one."""

    def run(turn: int) -> int:
        job()
        return 1

    return run


def try_peers(peers: Mapping[str, Callable[[], Any]]) -> tuple[dict[str, Any], dict[str, str]]:
    """Call each peer once; return what those return that run, and the reasons why the others do not."""
    found, missing = {}, {}
    for name, call in peers.items():
        try:
            found[name] = call()
        except Exception as error:  # whatever a peer's import raises is the reason its row gives
            missing[name] = f"did not run: {error}"
    return found, missing


def ratio(seconds: Seconds, name: str, reference: str) -> float:
    """Return how many times slower `name` is than `reference`, the median over the rounds."""
    return float(np.median(seconds[name] / seconds[reference]))


def beside(task: str, seconds: Seconds, ours: str, peer: str, *, times: float = 1.0, **asked: Any) -> Row:
    """Return the row of two of the ways that `interleaved` has timed.

    Parameters
    ----------
    ours, peer : str
        Their names. A peer without seconds did not run; `note` should say why.
    times : float
        How many of what the seconds are of make the task.
    **asked
        `wanted`, `error`, `bound`, `unit` and `note` of the row.
    """
    mine = times * float(np.median(seconds[ours]))
    if peer not in seconds:
        return Row(task, mine, peer, None, None, **asked)
    return Row(task, mine, peer, times * float(np.median(seconds[peer])), ratio(seconds, peer, ours), **asked)


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
