"""The files around a Motion-BIDS recording: its channels, its sidecar, its events."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from eigenwalker._validation import WalkError
from eigenwalker.io._text import Row, decode_lines, name_file, number_table, shown, split_rows
from eigenwalker.motion.walk import Event

__all__ = [
    "MOTION",
    "Channel",
    "companion",
    "event_words",
    "frames_axes",
    "prefix_of",
    "read_channels",
    "read_events",
    "read_sidecar",
]

MOTION = "_motion.tsv"
_COLUMNS = ("name", "component", "type", "tracked_point", "units")
_TYPES = ("ACCEL", "ANGACCEL", "GYRO", "JNTANG", "LATENCY", "MAGN", "MISC", "ORNT", "POS", "VEL")
_SIDES = ("left", "right")


class Channel(NamedTuple):
    """One row of a ``*_channels.tsv``; fields that the table lacks are empty."""

    line: int
    name: str
    component: str
    kind: str
    point: str
    unit: str
    sampling_frequency: str
    reference_frame: str


def prefix_of(path: Path) -> str:
    """Return a recording's name without its ``_motion.tsv``, or raise."""
    if not path.name.lower().endswith(MOTION):
        raise WalkError(f"{path}: expected a Motion-BIDS recording, whose name ends in {MOTION}")
    return path.name[: -len(MOTION)]


def companion(path: Path, ending: str) -> Path:
    """Return the file beside a recording that has another ending, ``_channels.tsv`` for instance."""
    return path.with_name(prefix_of(path) + ending)


def _read_companion(path: Path, ending: str) -> tuple[Path, bytes]:
    file = companion(path, ending)
    try:
        return file, file.read_bytes()
    except FileNotFoundError:
        raise WalkError(f"{path}: expected its companion {file.name} beside it, got no such file") from None


def _read_titled(data: bytes, kind: str, required: Iterable[str]) -> tuple[list[str], list[Row]]:
    """Return the titles of the columns and the rows below them."""
    rows = split_rows(decode_lines(data, kind), separator="\t", quotes=False)
    titles = [word.strip() for word in rows[0].words] if rows else []
    lacking = [title for title in required if titles.count(title) != 1]
    if lacking:
        raise WalkError(
            f"line 1: expected the columns {', '.join(required)} once each, but not so {', '.join(lacking)}"
        )
    for row in rows[1:]:
        if len(row.words) != len(titles):
            raise WalkError(f"line {row.line}: expected {len(titles)} fields, got {len(row.words)}")
    return titles, rows[1:]


def read_channels(path: Path) -> tuple[list[Channel], Path]:
    """Return the channels of a recording, in the order of its columns, and the file they are in."""
    file, data = _read_companion(path, "_channels.tsv")
    with name_file(file):
        titles, rows = _read_titled(data, "a table of channels", _COLUMNS)
        wanted = (*_COLUMNS, "sampling_frequency", "reference_frame")
        places = [titles.index(title) if title in titles else None for title in wanted]
        channels = [
            Channel(row.line, *("" if place is None else row.words[place].strip() for place in places)) for row in rows
        ]
        for channel in channels:
            if channel.kind.upper() not in _TYPES:
                raise WalkError(
                    f"line {channel.line}: expected a type of {', '.join(_TYPES)}, got {shown(channel.kind)}"
                )
    return channels, file


def read_sidecar(path: Path, ending: str = "_motion.json", *, optional: bool = False) -> tuple[dict[str, Any], Path]:
    """Return what a JSON file beside a recording says, and that file."""
    file = companion(path, ending)
    if optional and not file.exists():
        return {}, file
    file, data = _read_companion(path, ending)
    with name_file(file, before=": "):
        try:
            fields = json.loads(data)
        except (ValueError, RecursionError) as error:
            raise WalkError(f"expected JSON, but {error}") from None
        if not isinstance(fields, dict):
            raise WalkError(f"expected a JSON object, got {type(fields).__name__}")
    return fields, file


def read_events(path: Path) -> tuple[Event, ...]:
    """Return the events beside a recording; none if there is no such file."""
    file = companion(path, "_events.tsv")
    if not file.exists():
        return ()
    data = file.read_bytes()
    with name_file(file):
        titles, rows = _read_titled(data, "a table of events", ("onset", "duration"))
        if not rows or "trial_type" not in titles:
            return ()
        onsets = number_table(rows, len(titles), columns=[titles.index("onset")]).ravel().tolist()
        kinds = [row.words[titles.index("trial_type")].strip() for row in rows]
    known = zip(onsets, kinds, strict=True)
    return tuple(_event(onset, kind) for onset, kind in known if kind not in ("", "n/a") and not np.isnan(onset))


def _event(onset: float, trial_type: str) -> Event:
    side, _, kind = trial_type.partition("_")
    return Event(onset, kind, side) if side in _SIDES and kind else Event(onset, trial_type)


def event_words(events: Sequence[Event]) -> list[str]:
    """Return the ``trial_type`` of each event, ``left_heel_strike`` for instance, from which it can be read back."""
    words = [f"{event.side}_{event.kind}" if event.side else event.kind for event in events]
    for event, word in zip(events, words, strict=True):
        if word in ("", "n/a") or _event(event.time, word) != event:
            raise WalkError(f"expected events of side left, right or '' and a kind without a side, got {event!r}")
    return words


def frames_axes(description: Mapping[str, Any], frames: Iterable[str]) -> list[object]:
    """Return the SpatialAxes that a ``*_channels.json`` gives for some reference frames."""
    column = description.get("reference_frame")
    levels = column.get("Levels") if isinstance(column, dict) else None
    found = [levels.get(frame) for frame in frames] if isinstance(levels, dict) else []
    return [level["SpatialAxes"] for level in found if isinstance(level, dict) and "SpatialAxes" in level]
