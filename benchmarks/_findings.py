"""What benchmarks find, as plain data: rows beside a peer, and checks without one. Nothing large is imported here."""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple, TypeAlias

__all__ = ["Check", "Finding", "Row", "from_plain", "to_plain"]


class Row(NamedTuple):
    """One job done by this project and by a peer in the same run.

    Attributes
    ----------
    task : str
        What is done, and of what the seconds are: "..., a walk".
    ours_s, peer_s : float or None
        Seconds; None where the peer did not run.
    peer : str
        Who else does the job.
    ratio : float or None
        How many times as long the peer takes, the median over rounds.
    wanted : float or None
        What the ratio is asked to reach; None where nothing is asked.
    error, bound : float or None
        How far the results are apart at most, and how far they may be.
    unit : str
        Of `error` and `bound`.
    note : str
        Why the peer did not run, or how its job differs.
    """

    task: str
    ours_s: float | None
    peer: str
    peer_s: float | None
    ratio: float | None
    wanted: float | None = None
    error: float | None = None
    bound: float | None = None
    unit: str = ""
    note: str = ""

    def is_fast(self, share: float = 1.0) -> bool | None:
        """Return whether the ratio reaches a share of what is wanted; None where nothing is asked or was measured."""
        return None if self.ratio is None or self.wanted is None else bool(self.ratio >= share * self.wanted)

    def is_close(self) -> bool | None:
        """Return whether the error is within its bound; None where there is no bound or nothing was compared."""
        return None if self.error is None or self.bound is None else bool(self.error <= self.bound)


class Check(NamedTuple):
    """Something that is asked of this project alone.

    Attributes
    ----------
    wanted, measured : str
        What is asked for, and what was found.
    passed : bool or None
        None where it was not measured, or of too little to tell.
    guarded : bool
        False for limits in seconds, which hold on one machine and not on another.
    """

    wanted: str
    measured: str
    passed: bool | None
    guarded: bool = True


Finding: TypeAlias = Row | Check


def to_plain(findings: Sequence[Finding]) -> list[dict[str, Any]]:
    """Return findings as dictionaries of texts, numbers and None, as JSON has them."""
    return [{name: _plain(value) for name, value in finding._asdict().items()} for finding in findings]


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else value  # NumPy's numbers


def from_plain(items: Iterable[dict[str, Any]]) -> list[Finding]:
    """Return the findings of which `to_plain` made dictionaries."""
    return [Row(**item) if "task" in item else Check(**item) for item in items]
