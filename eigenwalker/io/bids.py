"""Motion-BIDS: a table of positions without a header, and the files beside it that say what its columns are."""

import json
import reprlib
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_frame_rate
from eigenwalker.io._bids_files import (
    MOTION,
    Channel,
    companion,
    event_words,
    frames_axes,
    prefix_of,
    read_channels,
    read_events,
    read_sidecar,
)
from eigenwalker.io._markers import check_different, check_markers, check_words, make_walk
from eigenwalker.io._text import (
    Row,
    decimal,
    decode_lines,
    join_numbers,
    listed,
    name_file,
    number_table,
    shown,
    split_rows,
    write_lines,
)
from eigenwalker.io._times import check_file_rate, rate_from_times
from eigenwalker.io._units import check_up, to_package_axes
from eigenwalker.motion.body import UNITS
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["read_bids", "write_bids"]

_GAP = "n/a"
_OUR_AXES = "ALS"  # anterior, left, superior: x forward, y left, z up
_DIRECTIONS = {
    letter: (axis, sign)
    for axis, pairs in enumerate((("AF", "PB"), ("L", "R"), ("SU", "ID")))
    for sign, letters in zip((1.0, -1.0), pairs, strict=True)
    for letter in letters
}  # anterior or forward, posterior or backward, ..., superior or up, inferior or down
_SAME = 1e-3  # relative difference between two frame rates that are the same


def read_bids(
    path: str | PathLike[str], *, up: str | None = None, frame_rate: float | None = None, name: str | None = None
) -> Walk:
    """Return the walk in a Motion-BIDS recording.

    Parameters
    ----------
    path : str or path
        The ``*_motion.tsv``. Beside it must be ``*_channels.tsv`` and ``*_motion.json``, and may be ``*_events.tsv``
        and ``*_channels.json``.
    up : {"z", "y"}, default None
        The axis that points up. "z": x is forward and y is left. "y": z is forward and x is left. None takes
        SpatialAxes, from the ``*_motion.json`` or for the reference frame of the positions from the
        ``*_channels.json``, and "z" where there is none.
    frame_rate : float, default None
        Frames per second, where the files are known to be wrong. None takes SamplingFrequencyEffective, else
        SamplingFrequency, else the column ``sampling_frequency``; a LATENCY channel must then be evenly spaced and
        agree within 0.1 %.
    name : str, default None
        Name of the walk. None is the file's name without ``_motion.tsv``.

    Returns
    -------
    Walk
        In metres, x forward, y left, z up, with a marker for each tracked point. Each must have POS channels for x, y
        and z; their units, m, cm, mm or in, are taken from the table. Channels of the other types of the standard are
        no positions and are ignored: orientations, quaternions included, are not turned into anything. ``n/a`` and
        ``nan`` are gaps. Events are the rows of ``*_events.tsv`` with an onset and a ``trial_type``;
        ``left_heel_strike`` becomes side "left" and kind "heel_strike".

    Raises
    ------
    WalkError
        If a companion file is missing; if one of the files is not sound, with the line; or if the legs of the 15
        markers are shorter than 0.3 m or longer than 1.3 m.
    OSError
        If a file cannot be opened.

    Notes
    -----
    Brain Imaging Data Structure, Motion, since version 1.9.0: the columns of ``*_motion.tsv`` are the rows of
    ``*_channels.tsv``.
    """
    if up is not None:
        check_up(up)
    path = Path(path)
    title = prefix_of(path) if name is None else name
    channels, channels_file = read_channels(path)
    with name_file(channels_file):
        columns = _position_columns(channels)
        scales = [[_scale(channels[place]) for place in triple] for triple in columns.values()]
        rates = _listed_rates(channels)
    rows = _read_rows(path, len(channels))
    with name_file(path):
        table = number_table(rows, len(channels), columns=[place for triple in columns.values() for place in triple])
    sidecar, sidecar_file = read_sidecar(path)
    if frame_rate is None:
        with name_file(sidecar_file, before=": "):
            rate = _sidecar_rate(sidecar, rates)
        with name_file(path):
            _check_latency(channels, rows, rate)
    else:
        rate = check_frame_rate(frame_rate)
    measured = table.reshape(len(table), -1, 3) * scales  # (n_frames, 3 n_markers) -> (n_frames, n_markers, 3)
    axes = _spatial_axes(path, sidecar, sidecar_file, channels) if up is None else None
    positions = to_package_axes(measured, up or "z") if axes is None else _turn(measured, axes)
    return make_walk(positions, rate, list(columns), path=path, name=title, unit="m", events=read_events(path))


def _position_columns(channels: Sequence[Channel]) -> dict[str, list[int]]:
    """Return the columns of x, y and z of each tracked point that has positions."""
    places: dict[str, dict[str, int]] = {}
    for place, channel in enumerate(channels):
        if channel.kind.upper() != "POS":
            continue
        axes = places.setdefault(channel.point, {})
        axis = channel.component.lower()
        if axis not in ("x", "y", "z") or axis in axes or channel.point in ("", "n/a"):
            raise WalkError(
                f"line {channel.line}: expected a tracked_point and a component x, y or z for each POS channel, each "
                f"pair once, got {shown(channel.point)} and {shown(channel.component)}"
            )
        axes[axis] = place
    check_different(list(places), 1, what="tracked point with POS channels")
    partial = [point for point, axes in places.items() if len(axes) < 3]
    if partial:
        raise WalkError(f"line 1: expected POS channels for x, y and z of each point, but not so {listed(partial)}")
    return {point: [axes[axis] for axis in "xyz"] for point, axes in places.items()}


def _scale(channel: Channel) -> float:
    if channel.unit not in UNITS:
        raise WalkError(f"line {channel.line}: expected units among {', '.join(UNITS)}, got {shown(channel.unit)}")
    return UNITS[channel.unit]


def _read_rows(path: Path, n_columns: int) -> list[Row]:
    """Return the frames of a recording, each a row of as many fields as there are channels."""
    data = path.read_bytes()
    with name_file(path):
        rows = split_rows(decode_lines(data, "a Motion-BIDS recording"), separator="\t", quotes=False)
        if not rows:
            raise WalkError(f"line 1: expected {n_columns} numbers a frame, got an empty file")
        first = rows[0].words[0].strip()
        if decimal(first) is None and first.lower() not in ("", _GAP, "nan"):
            raise WalkError(f"line 1: expected a number, as a {MOTION} has no header line, got {shown(first)}")
    return rows


def _listed_rates(channels: Sequence[Channel]) -> list[float]:
    """Return the frame rates that the table of channels gives for positions."""
    return [
        check_file_rate(channel.sampling_frequency, channel.line, "sampling_frequency")
        for channel in channels
        if channel.kind.upper() == "POS" and channel.sampling_frequency not in ("", _GAP)
    ]


def _sidecar_rate(sidecar: dict[str, Any], rates: Sequence[float]) -> float:
    """Return the frames per second that the sidecar says, or the channels where it says none."""
    said = [_rate_field(sidecar, key) for key in ("SamplingFrequencyEffective", "SamplingFrequency")]
    known = [rate for rate in said if rate is not None] or list(rates[:1])
    if not known:
        raise WalkError("expected a SamplingFrequency, got none; pass frame_rate=...")
    odd = [rate for rate in rates if min(abs(rate / other - 1) for other in known) > _SAME]
    if odd:
        raise WalkError(f"expected positions of {known[0]:g} frames a second, got sampling_frequency {odd[0]:g}")
    return known[0]


def _rate_field(sidecar: dict[str, Any], key: str) -> float | None:
    rate = sidecar.get(key, _GAP)
    if rate == _GAP:
        return None
    if isinstance(rate, bool) or not isinstance(rate, (int, float)) or not 1e-3 <= rate <= 1e6:
        raise WalkError(f"expected {key} in frames per second, 0.001 to 1,000,000, got {shown(reprlib.repr(rate))}")
    return float(rate)


def _check_latency(channels: Sequence[Channel], rows: Sequence[Row], rate: float) -> None:
    """Raise unless the frames come at the times of their rate, where the recording says when they came."""
    for place, channel in enumerate(channels):
        if channel.kind.upper() == "LATENCY":
            rate_from_times([row.words[place] for row in rows], [row.line for row in rows], frame_rate=rate)


def _spatial_axes(path: Path, sidecar: dict[str, Any], sidecar_file: Path, channels: Sequence[Channel]) -> str | None:
    """Return the directions of x, y and z that the files give, such as "ALS", or None."""
    frames = {channel.reference_frame for channel in channels if channel.kind.upper() == "POS"}
    if "SpatialAxes" in sidecar:
        found, file = [sidecar["SpatialAxes"]], sidecar_file
    else:
        description, file = read_sidecar(path, "_channels.json", optional=True)
        found = frames_axes(description, sorted(frames))
    known = [axes for axes in found if axes != _GAP]
    with name_file(file, before=": "):
        return _same_axes(known) if known else None


def _same_axes(known: Sequence[object]) -> str:
    """Return the directions that are given, such as "ALS", or raise."""
    axes = known[0] if isinstance(known[0], str) else ""
    directions = {_DIRECTIONS[letter][0] for letter in axes if letter in _DIRECTIONS}
    if len(axes) != 3 or len(directions) != 3 or any(other != axes for other in known):
        got = shown(reprlib.repr(list(known)))
        raise WalkError(
            f"expected SpatialAxes such as {_OUR_AXES!r}, the same for all positions, got {got}; pass up=..."
        )
    return axes


def _turn(positions: NDArray[np.floating], axes: str) -> NDArray[np.floating]:
    """Return positions with axes such as "RAS" in x forward, y left, z up."""
    turned = np.empty_like(positions)
    for place, letter in enumerate(axes):
        axis, sign = _DIRECTIONS[letter]
        turned[..., axis] = sign * positions[..., place]
    return turned


def write_bids(walk: Walk | JointWalk, path: str | PathLike[str]) -> None:
    """Write a walk as a Motion-BIDS recording: ``*_motion.tsv``, ``*_channels.tsv`` and ``*_motion.json``.

    Parameters
    ----------
    walk : Walk
        What to write. Gaps become ``n/a``. Its events go into ``*_events.tsv``, which is written if there are any or
        if there is such a file from before. Its speed and size do not fit into the files.
    path : str or path
        The ``*_motion.tsv``. TaskName and TrackingSystemName are taken from ``task-`` and ``tracksys-`` in its name,
        "walking" and "unknown" where they are not there.

    Raises
    ------
    TypeError
        If `walk` has joints and no markers.
    WalkError
        If `path` does not end in ``_motion.tsv``; if the walk has infinite positions; or if a marker's name or an
        event cannot be read back from a line of text.
    """
    walk = check_markers(walk)
    path = Path(path)
    prefix = prefix_of(path)
    names = walk.marker_set.names
    trial_types = event_words(walk.events)
    check_words((*names, *trial_types), what="names of markers and events")
    if _GAP in names:
        raise WalkError(f"expected names of markers other than {_GAP!r}, which stands for none")
    channels = [f"{name}_{axis}\t{axis}\tPOS\t{name}\tm" for name in names for axis in "xyz"]
    write_lines(path, (join_numbers(row, "\t", gap=_GAP) for row in walk.channels.tolist()))
    write_lines(companion(path, "_channels.tsv"), ["name\tcomponent\ttype\ttracked_point\tunits", *channels])
    write_lines(companion(path, "_motion.json"), [json.dumps(_sidecar(walk, prefix), indent=2)])
    events = companion(path, "_events.tsv")
    if walk.events or events.exists():
        timed = zip(walk.events, trial_types, strict=True)
        rows = [f"{float(event.time)!r}\t0\t{trial_type}" for event, trial_type in timed]
        write_lines(events, ["onset\tduration\ttrial_type", *rows])


def _sidecar(walk: Walk, prefix: str) -> dict[str, object]:
    entities = dict(part.partition("-")[::2] for part in prefix.split("_") if "-" in part)
    n_markers = len(walk.marker_set.names)
    return {
        "TaskName": entities.get("task") or "walking",
        "TrackingSystemName": entities.get("tracksys") or "unknown",
        "SamplingFrequency": walk.frame_rate,
        "TrackedPointsCount": n_markers,
        "MotionChannelCount": 3 * n_markers,
        "POSChannelCount": 3 * n_markers,
        "RecordingDuration": walk.duration,
        "SpatialAxes": _OUR_AXES,
        "MissingValues": _GAP,
    }
