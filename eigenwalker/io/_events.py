"""Events beside a file that has no place for them: ``anna.csv`` and ``anna.csv.events.json``."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TypeGuard

from eigenwalker._validation import WalkError
from eigenwalker.io._text import name_file, shown
from eigenwalker.motion.walk import Event

__all__ = ["read_events", "write_events"]

_FIELDS = ("time", "kind", "side")


def _companion(path: Path) -> Path:
    return path.with_name(path.name + ".events.json")


def write_events(path: Path, events: Sequence[Event]) -> None:
    """Write the events of a walk beside its file, as a list of objects with time (seconds), kind and side.

    Without events there is no such file, and one that is left from an earlier walk is removed.
    """
    if not events:
        _companion(path).unlink(missing_ok=True)
        return
    listed = ",\n ".join(json.dumps(event._asdict(), ensure_ascii=False) for event in events)
    _companion(path).write_text(f"[{listed}]\n", encoding="utf-8")


def read_events(path: Path) -> tuple[Event, ...]:
    """Return the events beside a file; none if there is no such companion.

    Raises
    ------
    WalkError
        If the companion is not what `write_events` writes.
    """
    file = _companion(path)
    if not file.exists():
        return ()
    with name_file(file, before=": "):
        try:
            entries = json.loads(file.read_bytes())
        except (ValueError, RecursionError) as error:
            raise WalkError(f"expected JSON, but {error}") from None
        if not isinstance(entries, list):
            raise WalkError(f"expected a list of events, got {type(entries).__name__}")
        return tuple(_event(number, entry) for number, entry in enumerate(entries, 1))


def _event(number: int, entry: object) -> Event:
    time, kind, side = (entry.get(name) for name in _FIELDS) if isinstance(entry, dict) else (None, None, None)
    if not (_is_finite(time) and isinstance(kind, str) and isinstance(side, str)):
        raise WalkError(
            f"event {number}: expected an object with a finite time in seconds, a kind and a side, "
            f"got {shown(json.dumps(entry))}"
        )
    return Event(float(time), kind, side)


def _is_finite(time: object) -> TypeGuard[int | float]:
    if isinstance(time, bool) or not isinstance(time, (int, float)):
        return False
    try:
        return math.isfinite(time)
    except OverflowError:  # a whole number beyond all floats
        return False
