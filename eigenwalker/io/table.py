"""Tables of marker positions: one row a frame, a column each for ``left_ankle_x`` and so on."""

import csv
import io
import re
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np

from eigenwalker._validation import WalkError, check_frame_rate, check_names
from eigenwalker.io._events import read_events, write_events
from eigenwalker.io._markers import check_different, check_markers, check_words, make_walk
from eigenwalker.io._text import (
    Row,
    decode_lines,
    join_numbers,
    listed,
    name_file,
    number_table,
    shown,
    split_rows,
    write_lines,
)
from eigenwalker.io._times import rate_from_times, time_words
from eigenwalker.io._units import check_up, meters_per_unit, to_package_axes
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["read_csv", "write_csv"]

_COLUMN = re.compile(r"(.+)_([xyz])", re.IGNORECASE)
_TIME = "time"


def read_csv(
    path: str | PathLike[str],
    *,
    frame_rate: float | None = None,
    unit: str | float = "m",
    up: str = "z",
    markers: Sequence[str] | None = None,
    separator: str | None = None,
    name: str | None = None,
) -> Walk:
    r"""Return the walk in a wide table: a header line, then one line a frame.

    The columns are ``left_ankle_x``, ``left_ankle_y``, ``left_ankle_z`` and so on, in any order, and ``time`` in
    seconds unless `frame_rate` is given. Empty fields and ``nan`` are gaps.

    Parameters
    ----------
    path : str or path
        The file, CSV or TSV, UTF-8, with decimal points.
    frame_rate : float, default None
        Frames per second. None takes the column ``time``. If there are both they must agree within 0.1 %.
    unit : {"m", "cm", "mm", "in"} or float, default "m"
        Unit of length of the file; a number is in metres per unit.
    up : {"z", "y"}, default "z"
        The axis of the file that points up. "z": x is forward and y is left. "y": z is forward and x is left.
    markers : sequence of str, default None
        The markers to read, in this order; other columns are ignored. None reads them all and refuses columns that
        are neither ``time`` nor part of a full x, y, z triple.
    separator : str, default None
        What stands between fields. None is a tab for files that end in ``.tsv`` and a comma for others.
    name : str, default None
        Name of the walk. None is the file's name without its suffix.

    Returns
    -------
    Walk
        In metres, x forward, y left, z up. The markers are in the order of their first columns; if they are the 15
        of `TROJE15` and no others, in its order and with `TROJE15` as marker set. Events come from
        ``name.csv.events.json`` beside the file, if there is one. A table has no place for speed, size and frequency:
        they are unknown, and NPZ keeps all.

    Raises
    ------
    WalkError
        If the table is not whole and sound, with the line; if neither ``time`` nor `frame_rate` is there, or they
        contradict each other; if times are not evenly spaced within 1 % of a frame; or if the legs of the 15 markers
        are shorter than 0.3 m or longer than 1.3 m.
    OSError
        If the file cannot be opened.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from eigenwalker.io import read_csv
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "anna.csv")
    ...     _ = path.write_text("time,heel_x,heel_y,heel_z\n0,10,,5\n0.01,11,2,5\n")
    ...     walk = read_csv(path, unit="cm")
    >>> walk.name, walk.frame_rate, walk.marker_set.names
    ('anna', 100.0, ('heel',))
    >>> walk.marker("heel")
    array([[0.1 ,  nan, 0.05],
           [0.11, 0.02, 0.05]])
    """
    scale = meters_per_unit(unit)
    check_up(up)
    frame_rate = None if frame_rate is None else check_frame_rate(frame_rate)
    path = Path(path)
    separator = separator or ("\t" if path.name.lower().endswith(".tsv") else ",")
    data = path.read_bytes()
    with name_file(path):
        rows = split_rows(decode_lines(data, "a table"), separator=separator)
        columns, time = _read_header(rows, markers, separator)
        if len(rows) == 1:
            raise WalkError(f"line {rows[0].line}: expected a line a frame after the header, got none")
        flat = [column for triple in columns.values() for column in triple]
        table = number_table(rows[1:], len(rows[0].words), columns=flat)
        rate = _frame_rate(rows[1:], time, frame_rate)
    with np.errstate(over="ignore"):
        recorded = scale * table.reshape(len(table), -1, 3)  # (n_frames, 3 n_markers) -> (n_frames, n_markers, 3)
    title = path.stem if name is None else name
    events = read_events(path)
    positions = to_package_axes(recorded, up)
    return make_walk(positions, rate, list(columns), path=path, name=title, unit=unit, events=events)


def _read_header(
    rows: Sequence[Row], markers: Sequence[str] | None, separator: str
) -> tuple[dict[str, list[int]], int | None]:
    """Return the three columns of each marker, and the column of the time if there is one."""
    if not rows:
        raise WalkError("line 1: expected a header with columns such as left_ankle_x, got an empty file")
    line = rows[0].line
    titles = [_plain_title(word) for word in rows[0].words]
    wanted = titles if markers is None else [_TIME, *_titles_of(check_names(markers, name="markers"))]
    known = set(wanted)
    check_different([title for title in titles if title in known], line, what="column")
    places = {title: place for place, title in enumerate(titles)}
    names = _markers_of(titles) if markers is None else list(markers)
    taken = {_TIME, *_titles_of(names)}
    lacking = [title for title in wanted if title != _TIME and title not in places]
    left_over = [title for title in wanted if title not in taken]
    if lacking or left_over or not names:
        raise WalkError(f"line {line}: {_fault(lacking, left_over, titles, separator)}")
    return {name: [places[title] for title in _titles_of([name])] for name in names}, places.get(_TIME)


def _plain_title(word: str) -> str:
    """Return a column's title with the axis, and ``time``, in small letters."""
    title = word.strip()
    match = _COLUMN.fullmatch(title)
    if match is not None:
        return f"{match[1]}_{match[2].lower()}"
    return _TIME if title.lower() == _TIME else title


def _titles_of(names: Sequence[str]) -> list[str]:
    return [f"{name}_{axis}" for name in names for axis in "xyz"]


def _markers_of(titles: Sequence[str]) -> list[str]:
    """Return the markers that have all three columns, in order of their first."""
    matches = [_COLUMN.fullmatch(title) for title in titles]
    names = dict.fromkeys(match[1] for match in matches if match is not None)
    there = set(titles)
    return [name for name in names if there.issuperset(_titles_of([name]))]


def _fault(lacking: list[str], left_over: list[str], titles: list[str], separator: str) -> str:
    if lacking:
        found = listed(_markers_of(titles)) or "none"
        return f"expected the columns {listed(lacking)}, got none of that name; the markers found are {found}"
    if len(titles) == 1:
        return f"expected columns separated by {separator!r}, got a single one, {shown(titles[0])}; pass separator=..."
    wrong = listed([shown(title) for title in left_over]) or "none but the time"
    return (
        f"expected columns in full triples such as left_ankle_x, left_ankle_y, left_ankle_z, got {wrong}; "
        "rename or remove them, or name the markers to read with markers=[...]"
    )


def _frame_rate(frames: Sequence[Row], time: int | None, frame_rate: float | None) -> float:
    """Return the frames per second that the table, the argument, or both say."""
    if time is not None:
        return rate_from_times([row.words[time] for row in frames], [row.line for row in frames], frame_rate=frame_rate)
    if frame_rate is None:
        raise WalkError("line 1: expected a column 'time' in seconds, got none; add it, or pass frame_rate=...")
    return frame_rate


def write_csv(walk: Walk | JointWalk, path: str | PathLike[str]) -> None:
    """Write a walk as a table of positions in metres, with a column ``time`` in seconds.

    Parameters
    ----------
    walk : Walk
        What to write. Gaps become empty fields. Its events go into ``name.csv.events.json`` beside the file, if it has
        any. Its speed, size and frequency do not fit into a table; NPZ keeps all.
    path : str or path
        Where to. Names that end in ``.tsv`` get tabs, others commas.

    Raises
    ------
    TypeError
        If `walk` has joints and no markers.
    WalkError
        If it has infinite positions, or names that no line of text can hold.

    Notes
    -----
    Numbers are written with all their digits: reading the table gives the same positions to the last bit. x is
    forward, y left and z up, as in the package.
    """
    walk = check_markers(walk)
    check_words(walk.marker_set.names, what="names of markers")
    separator = "\t" if Path(path).name.lower().endswith(".tsv") else ","
    header = io.StringIO()
    csv.writer(header, delimiter=separator, lineterminator="").writerow([_TIME, *walk.channel_names])
    rows = zip(time_words(walk.n_frames, walk.frame_rate), walk.channels.tolist(), strict=True)
    write_lines(path, [header.getvalue(), *(time + separator + join_numbers(row, separator) for time, row in rows)])
    write_events(Path(path), walk.events)
