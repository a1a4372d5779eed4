"""TRC files, the marker positions of Motion Analysis and OpenSim."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np

from eigenwalker._validation import WalkError, check_frame_rate
from eigenwalker.io._events import read_events, write_events
from eigenwalker.io._markers import check_different, check_markers, check_words, make_walk
from eigenwalker.io._text import (
    CUT,
    Row,
    decode_lines,
    join_numbers,
    name_file,
    number_table,
    shown,
    split_rows,
    write_lines,
)
from eigenwalker.io._times import check_file_rate, rate_from_times
from eigenwalker.io._units import check_up, from_opensim_axes, meters_per_unit, to_opensim_axes
from eigenwalker.motion.body import UNITS
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["read_trc", "write_trc"]

_KEYS = (
    "DataRate",
    "CameraRate",
    "NumFrames",
    "NumMarkers",
    "Units",
    "OrigDataRate",
    "OrigDataStartFrame",
    "OrigNumFrames",
)


def read_trc(
    path: str | PathLike[str],
    *,
    unit: str | float | None = None,
    up: str = "y",
    frame_rate: float | None = None,
    name: str | None = None,
) -> Walk:
    """Return the walk that a TRC file holds.

    Parameters
    ----------
    path : str or path
        The file: three lines of header, two of column labels, then a line a frame, with tabs between fields.
    unit : {"m", "cm", "mm", "in"} or float, default None
        Unit of length, where the file's Units are known to be wrong; a number is in metres per unit. None takes
        the file's.
    up : {"y", "z"}, default "y"
        The axis of the file that points up. "y": OpenSim's axes, x forward, y up and z to the *right*, so that the
        file's (x, y, z) become (x, -z, y). That is not the mapping of BVH files, where z is forward. "z": x is
        forward and y is left, as in the package.
    frame_rate : float, default None
        Frames per second, where the file's DataRate is known to be wrong; the column Time is not looked at then.
        None takes DataRate, with which Time must agree within 0.1 %.
    name : str, default None
        Name of the walk. None is the file's name without its suffix.

    Returns
    -------
    Walk
        In metres, x forward, y left, z up. Empty fields and ``nan`` are gaps. The markers are those of the file, in
        its order, but the 15 of `TROJE15`, and no others, come in the order of `TROJE15`. Events come from
        ``name.trc.events.json`` beside the file, if there is one.

    Raises
    ------
    WalkError
        If the file is not a whole and sound TRC file, with the line; or if the legs of the 15 markers are shorter
        than 0.3 m or longer than 1.3 m.
    OSError
        If the file cannot be opened.
    """
    check_up(up)
    path = Path(path)
    data = path.read_bytes()
    with name_file(path):
        rows = split_rows(decode_lines(data, "a TRC file"), separator="\t", quotes=False)
        header = _read_header(rows)
        unit = _file_unit(header) if unit is None else unit
        scale = meters_per_unit(unit)
        names = _read_names(rows, header)
        frames = _frames(rows[5:], header, 2 + 3 * len(names))
        table = number_table(frames, 2 + 3 * len(names))
        rate = _frame_rate(frames, header) if frame_rate is None else check_frame_rate(frame_rate)
    with np.errstate(over="ignore"):
        recorded = scale * table[:, 2:].reshape(len(table), -1, 3)  # (n_frames, 3 n_markers) -> (.., n_markers, 3)
    title = path.stem if name is None else name
    events = read_events(path)
    positions = from_opensim_axes(recorded, up)
    return make_walk(positions, rate, names, path=path, name=title, unit=unit, events=events)


def _read_header(rows: Sequence[Row]) -> dict[str, tuple[str, int]]:
    """Return what the second line names and the third line says, each with its line."""
    if not rows or rows[0].words[0].strip() != "PathFileType":
        found = shown(rows[0].words[0]) if rows else "an empty file"
        raise WalkError(f"line 1: expected PathFileType, with which TRC files start, got {found}")
    if len(rows) < 5:
        raise WalkError(f"line {rows[-1].line}: expected five lines before the first frame, got {len(rows)}; {CUT}")
    keys = [word.strip().lower() for word in rows[1].words]
    line = rows[2].line
    header = {key: (word.strip(), line) for key, word in zip(keys, rows[2].words, strict=False)}
    lacking = [key for key in ("DataRate", "NumFrames", "NumMarkers") if not header.get(key.lower(), ("", 0))[0]]
    if lacking:
        raise WalkError(f"line {line}: expected a value under each of {', '.join(lacking)}, got none")
    return header


def _file_unit(header: dict[str, tuple[str, int]]) -> str:
    word, line = header.get("units", ("", 3))
    if word.lower() not in UNITS:
        raise WalkError(f"line {line}: expected Units among {', '.join(UNITS)}, got {shown(word)}; pass unit=...")
    return word.lower()


def _count(header: dict[str, tuple[str, int]], key: str, found: int, what: str) -> None:
    """Raise unless the header counts what is there. Nothing is ever made as large as it says."""
    word, line = header[key.lower()]
    if not word.isdecimal() or word.lstrip("0") != str(found):
        raise WalkError(
            f"line {line}: expected {key} {found}, as many as there are {what}, got {shown(word)}; {CUT}, or correct it"
        )


def _read_names(rows: Sequence[Row], header: dict[str, tuple[str, int]]) -> list[str]:
    """Return the names of the markers, each above the first of its three columns."""
    line = rows[3].line
    labels = [word.strip() for word in rows[3].words]
    if [label.lower() for label in labels[:2]] != ["frame#", "time"]:
        raise WalkError(f"line {line}: expected Frame#, Time and names of markers, got {shown(' '.join(labels))}")
    names = [label for label in labels[2:] if label]
    check_different(names, line)
    axes = [word.strip() for word in rows[4].words if word.strip()]
    expected = [f"{axis}{marker}" for marker in range(1, len(names) + 1) for axis in "XYZ"]
    if [axis.upper() for axis in axes] != expected:
        raise WalkError(
            f"line {rows[4].line}: expected {expected[0]}, {expected[1]} ... {expected[-1]} below {len(names)} names, "
            f"got {shown(' '.join(axes))}"
        )
    _count(header, "NumMarkers", len(names), "names of markers")
    return names


def _frames(rows: Sequence[Row], header: dict[str, tuple[str, int]], n_columns: int) -> list[Row]:
    """Return the rows of frames without empty fields past the last column, which many writers leave."""
    if not rows:
        raise WalkError(f"line {header['datarate'][1]}: expected at least one frame, got none; {CUT}")
    frames = [
        Row(row.line, row.words[:n_columns]) if not "".join(row.words[n_columns:]).strip() else row for row in rows
    ]
    _count(header, "NumFrames", len(frames), "lines of frames")
    return frames


def _frame_rate(frames: Sequence[Row], header: dict[str, tuple[str, int]]) -> float:
    rate = check_file_rate(*header["datarate"], "DataRate")
    return rate_from_times([row.words[1] for row in frames], [row.line for row in frames], frame_rate=rate)


def write_trc(walk: Walk | JointWalk, path: str | PathLike[str], *, unit: str | float = "mm", up: str = "y") -> None:
    """Write a walk as a TRC file, for OpenSim for instance.

    Parameters
    ----------
    walk : Walk
        What to write. Gaps become empty fields. Its events go into ``name.trc.events.json`` beside the file, if it has
        any. Its speed, size and frequency do not fit into the file.
    path : str or path
        Where to.
    unit : {"mm", "m", "cm", "in"}, default "mm"
        Unit of length in the file.
    up : {"y", "z"}, default "y"
        "y": OpenSim's axes, x forward, y up, z to the right; see `read_trc`. "z": the package's axes.

    Raises
    ------
    TypeError
        If `walk` has joints and no markers.
    WalkError
        If it has infinite positions, or names that no line of text can hold.
    """
    walk = check_markers(walk)
    check_up(up)
    scale = meters_per_unit(unit)
    if not isinstance(unit, str):
        raise TypeError(f"unit must be one of {', '.join(map(repr, UNITS))} for a TRC file, got {unit!r}")
    names = walk.marker_set.names
    check_words((Path(path).name, *names), what="names of file and markers")
    rate, n_frames = repr(walk.frame_rate), str(walk.n_frames)
    labels = "".join(f"\tX{marker}\tY{marker}\tZ{marker}" for marker in range(1, len(names) + 1))
    header = [
        f"PathFileType\t4\t(X/Y/Z)\t{Path(path).name}",
        "\t".join(_KEYS),
        "\t".join((rate, rate, n_frames, str(len(names)), unit, rate, "1", n_frames)),
        "Frame#\tTime\t" + "\t\t\t".join(names) + "\t\t",
        "\t" + labels,
        "",
    ]
    table = to_opensim_axes(walk.positions, up).reshape(walk.n_frames, -1) / scale  # (n_frames, 3 n_markers)
    times = (np.arange(walk.n_frames) / walk.frame_rate).tolist()
    rows = zip(times, table.tolist(), strict=True)
    write_lines(path, header + [f"{frame}\t" + join_numbers((t, *row), "\t") for frame, (t, row) in enumerate(rows, 1)])
    write_events(Path(path), walk.events)
