"""Runs of frames for which something holds."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["find_runs", "longest_run"]


def find_runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and one past the last position of each run of true values, in order.

    Examples
    --------
    >>> import numpy as np
    >>> find_runs(np.array([True, True, False, True]))
    [(0, 2), (3, 4)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Return first and one past the last position of the longest run of true values (the first of equals)."""
    return max(find_runs(flags), key=lambda run: run[1] - run[0], default=(0, 0))
