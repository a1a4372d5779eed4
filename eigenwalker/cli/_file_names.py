"""Short names for files: enough of their paths to tell them apart."""

from collections.abc import Sequence
from pathlib import Path

__all__ = ["name_depth", "short_name"]


def name_depth(paths: Sequence[Path]) -> int:
    """Return how many parts of their paths, from the end, tell files apart: 1 unless names repeat.

    Files that differ in nothing but the suffix are not told apart; for them it is 1, too.
    """
    depths = range(1, max(len(path.parts) for path in paths) + 1)
    return next((depth for depth in depths if len({short_name(path, depth) for path in paths}) == len(paths)), 1)


def short_name(path: Path, depth: int) -> str:
    """Return the last parts of a path, without suffix.

    Examples
    --------
    >>> paths = [Path("kinect/anna/1.txt"), Path("kinect/bert/1.txt")]
    >>> [short_name(path, name_depth(paths)) for path in paths]
    ['anna/1', 'bert/1']
    """
    return "/".join(path.with_suffix("").parts[-depth:])
