"""C3D files of optical motion capture: paths of markers, with gaps and events."""

from collections import Counter
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_choice, check_names
from eigenwalker.io._c3d_blocks import C3dBlocks, format_c3d, parse_c3d
from eigenwalker.io._markers import check_markers, check_words, make_walk
from eigenwalker.io._text import listed, name_file, shown
from eigenwalker.io._units import check_up, meters_per_unit, to_package_axes
from eigenwalker.motion.body import UNITS
from eigenwalker.motion.walk import Event, JointWalk, Walk

__all__ = ["read_c3d", "write_c3d"]

_KINDS = {"foot strike": "heel_strike", "foot off": "toe_off"}
_LABELS = {"heel_strike": "Foot Strike", "toe_off": "Foot Off"}
_SIDES = {"left": "Left", "right": "Right", "": "General"}
_MOST = 255  # entries of one parameter; LABELS2, LABELS3 ... hold the next ones
_LONGEST = 120  # bytes of a label, so that 255 of them fit
_LARGEST = 1e38  # of a 32-bit real


def read_c3d(
    path: str | PathLike[str],
    *,
    unit: str | float | None = None,
    up: str = "z",
    markers: Sequence[str] | None = None,
    name: str | None = None,
) -> Walk:
    """Return the walk of markers that a C3D file holds.

    Parameters
    ----------
    path : str or path
        The file, in any of the format's byte orders, with points as integers or as reals.
    unit : {"m", "cm", "mm", "in"} or float, default None
        Unit of length of the file; a number is in metres per unit. None takes POINT:UNITS of the file.
    up : {"z", "y"}, default "z"
        The axis of the file that points up. "z": axes stay as they are; which way the walker goes is the laboratory's
        matter, and `prepare` turns the walk. "y": the cyclic permutation (z, x, y) makes them the package's axes.
    markers : sequence of str, default None
        Labels of the points to read, in this order. None reads all.
    name : str, default None
        Name of the walk. None is the file's name without its suffix.

    Returns
    -------
    Walk
        In metres, z up. Points that the cameras lost, with a negative residual or NaN, are NaN. A prefix that all
        labels share, as in ``Anna:LANK``, is dropped. Events "Foot Strike" and "Foot Off" are ``heel_strike`` and
        ``toe_off``, others keep their label; their times count from the first frame of the file.

    Raises
    ------
    WalkError
        If the file is not a whole and sound C3D file with points; if it does not say its unit; if labels repeat or
        are missing; or if the legs of the 15 markers are shorter than 0.3 m or longer than 1.3 m.
    OSError
        If the file cannot be opened.

    Notes
    -----
    Analog data and force plates are ignored. Points without a label are called ``point 57``, by their place.

    Examples
    --------
    >>> from eigenwalker.io.c3d import read_c3d
    >>> walk = read_c3d("trial_03.c3d", markers=["LANK", "RANK", "SACR"])  # doctest: +SKIP
    """
    if unit is not None:
        meters_per_unit(unit)
    check_up(up)
    markers = None if markers is None else check_names(markers, name="markers")
    path = Path(path)
    data = path.read_bytes()
    with name_file(path, before=": "):
        file = parse_c3d(data)
        unit = _file_unit(file) if unit is None else unit
        labels = _labels(file)
        columns = _columns(labels, markers)
        events = _events(file)
    positions = to_package_axes(meters_per_unit(unit) * _positions(file)[:, columns], up)
    return make_walk(
        positions,
        file.frame_rate,
        [labels[column] for column in columns],
        path=path,
        name=path.stem if name is None else name,
        unit=unit,
        events=events,
    )


def _file_unit(file: C3dBlocks) -> str:
    unit = next(iter(file.texts.get("POINT:UNITS", [])), "").lower()
    if unit not in UNITS:
        got = shown(unit)
        raise WalkError(f"expected POINT:UNITS {', '.join(UNITS)}, got {got}; pass unit=..., most often unit='mm'")
    return unit


def _labels(file: C3dBlocks) -> list[str]:
    """Return one label a point."""
    n_points = file.points.shape[1]
    labels = _joined(file, "POINT:LABELS")[:n_points]
    labels += [""] * (n_points - len(labels))
    labels = [label or f"point {place}" for place, label in enumerate(labels, 1)]
    prefixes = {label.partition(":")[0] if ":" in label else None for label in labels}
    if len(prefixes) > 1 or None in prefixes:
        return labels
    bare = [label.partition(":")[2].strip() for label in labels]
    return bare if all(bare) else labels


def _joined(file: C3dBlocks, key: str) -> list[str]:
    """Return the entries of a parameter and of those that carry on from it."""
    entries = list(file.texts.get(key, []))
    part = 2
    while f"{key}{part}" in file.texts:
        entries += file.texts[f"{key}{part}"]
        part += 1
    return entries


def _columns(labels: list[str], markers: tuple[str, ...] | None) -> list[int]:
    """Return the places of the points to be read."""
    missing = sorted(set(markers or ()) - set(labels))
    if missing:
        raise WalkError(f"expected points labelled {listed(missing)}; the labels are {listed(labels)}")
    wanted = labels if markers is None else list(markers)
    count = Counter(labels)
    repeated = sorted({label for label in wanted if count[label] > 1})
    if repeated:
        raise WalkError(
            f"expected a label of its own for each point, got {listed(repeated)} more than once; "
            "pass markers=[...] with the others, or rename them in the program that wrote the file"
        )
    places = {label: place for place, label in enumerate(labels)}
    return [places[label] for label in wanted]


def _positions(file: C3dBlocks) -> NDArray[np.float64]:
    """Return positions in the file's unit, NaN where the cameras lost a point, shape (n_frames, n_points, 3)."""
    positions = file.points[..., :3].copy()
    positions[(file.points[..., 3] < 0) | np.isnan(positions).any(axis=-1)] = np.nan
    return positions


def _events(file: C3dBlocks) -> tuple[Event, ...]:
    labels, contexts = _joined(file, "EVENT:LABELS"), _joined(file, "EVENT:CONTEXTS")
    times = _event_times(file)
    used = file.numbers.get("EVENT:USED", np.empty(0)).ravel()
    n_events = max(0, int(used[0])) if used.size and np.isfinite(used[0]) else len(labels)
    if min(len(labels), len(times)) < n_events or not np.isfinite(times[:n_events]).all():
        raise WalkError(
            f"expected {n_events} events, as EVENT:USED says, got {len(labels)} EVENT:LABELS "
            f"and {int(np.isfinite(times).sum())} EVENT:TIMES"
        )
    contexts += [""] * (n_events - len(contexts))
    start = (file.first_frame - 1) / file.frame_rate
    return tuple(
        Event(
            float(time) - start, _KINDS.get(label.lower(), label), context.lower() if context.lower() in _SIDES else ""
        )
        for time, label, context in zip(times[:n_events], labels, contexts, strict=False)
    )


def _event_times(file: C3dBlocks) -> NDArray[np.float64]:
    """Return seconds from the start of the recording; the file has minutes and seconds."""
    key, part, times = "EVENT:TIMES", 2, []
    while key in file.numbers:
        matrix = file.numbers[key]
        if matrix.size and (matrix.ndim != 2 or len(matrix) != 2):
            raise WalkError(f"expected {key} with minutes and seconds of each event, got the sizes {matrix.shape}")
        with np.errstate(invalid="ignore"):  # what is not finite is refused where it is used
            times.append(60.0 * matrix[0] + matrix[1] if matrix.size else np.empty(0))
        key, part = f"EVENT:TIMES{part}", part + 1
    return np.concatenate(times) if times else np.empty(0)


def write_c3d(walk: Walk | JointWalk, path: str | PathLike[str], *, unit: str = "mm") -> None:
    """Write a walk as a C3D file, with its gaps and events.

    Parameters
    ----------
    walk : Walk
        What to write. Its speed and size have no place in a C3D file.
    path : str or path
        Where to. A file that is there is replaced.
    unit : {"mm", "m", "cm", "in"}, default "mm"
        Unit of length of the file, its POINT:UNITS.

    Raises
    ------
    TypeError
        If `walk` has joints and no markers.
    WalkError
        If positions are infinite or too large for 32 bits, or if names of markers or events are empty, longer than
        120 bytes, or not printable; or if an event's side is not "left", "right" or "".

    Notes
    -----
    Positions are 32-bit reals, seven digits, with z up; times of events are too. Gaps get the residual -1 and zeros,
    all other frames the residual 0. ``heel_strike`` and ``toe_off`` are written as "Foot Strike" and "Foot Off".
    Recordings of more than 65535 frames say their length in TRIAL:ACTUAL_END_FIELD.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> import numpy as np
    >>> from eigenwalker.io.c3d import read_c3d, write_c3d
    >>> from eigenwalker.motion import Event, MarkerSet, Walk
    >>> positions = np.full((2, 1, 3), [0.5, 0.25, 1.0])
    >>> positions[1] = np.nan
    >>> walk = Walk(positions, 100, MarkerSet(("LANK",)), events=(Event(0.01, "toe_off", "left"),))
    >>> with TemporaryDirectory() as folder:
    ...     write_c3d(walk, Path(folder, "anna.c3d"))
    ...     again = read_c3d(Path(folder, "anna.c3d"))
    >>> again.marker("LANK")
    array([[0.5 , 0.25, 1.  ],
           [ nan,  nan,  nan]])
    >>> [(round(event.time, 6), event.kind, event.side) for event in again.events]
    [(0.01, 'toe_off', 'left')]
    """
    walk = check_markers(walk)
    check_choice(unit, ("mm", "m", "cm", "in"), name="unit")
    positions = walk.positions / UNITS[unit]
    if (np.abs(positions) > _LARGEST).any():
        raise WalkError(f"walk {walk.name!r}: expected positions that fit into 32 bits, got values beyond {_LARGEST:g}")
    lost = np.isnan(positions).any(axis=-1, keepdims=True)
    points = np.concatenate([np.where(lost, 0.0, positions), np.where(lost, -1.0, 0.0)], axis=-1)
    numbers, texts = _event_parameters(walk)
    labels = _coded(walk, walk.marker_set.names, "names of markers")
    texts = {"POINT:UNITS": [unit]} | _split("POINT:LABELS", labels) | texts
    numbers = {"ANALOG:USED": np.zeros(1)} | numbers
    Path(path).write_bytes(format_c3d(C3dBlocks(numbers, texts, points, 1, walk.frame_rate)))


def _event_parameters(walk: Walk) -> tuple[dict[str, NDArray[np.float64]], dict[str, list[str]]]:
    """Return the parameters of the group EVENT; none without events."""
    if not walk.events:
        return {}, {}
    strange = sorted({event.side for event in walk.events} - set(_SIDES))
    if strange or len(walk.events) > _MOST**2:
        wrong = f"the side {strange[0]!r}" if strange else f"{len(walk.events)} events"
        raise WalkError(
            f"walk {walk.name!r}: expected up to 65025 events on the left, the right or no side, got {wrong}"
        )
    labels = _coded(walk, [_LABELS.get(event.kind, event.kind) for event in walk.events], "kinds of events")
    times = np.array([divmod(event.time, 60.0) for event in walk.events])  # minutes and seconds
    texts = _split("EVENT:LABELS", labels)
    texts |= _split("EVENT:CONTEXTS", [_SIDES[event.side] for event in walk.events])
    numbers = {"EVENT:USED": np.array([float(len(walk.events))])}
    for part, key in enumerate(_split("EVENT:TIMES", labels)):
        numbers[key] = times[_MOST * part : _MOST * (part + 1)].T
    return numbers, texts


def _split(key: str, words: list[str]) -> dict[str, list[str]]:
    """Return the words in parameters of at most 255 entries each: LABELS, LABELS2, LABELS3."""
    parts = [words[first : first + _MOST] for first in range(0, len(words), _MOST)]
    return {key + (str(number) if number > 1 else ""): part for number, part in enumerate(parts, 1)}


def _coded(walk: Walk, words: Sequence[str], what: str) -> list[str]:
    """Return the words if they are those that come back."""
    check_words(words, what=f"walk {walk.name!r}: {what}")
    wrong = [word for word in words if not 0 < len(word.encode()) <= _LONGEST]
    if wrong:
        raise WalkError(f"walk {walk.name!r}: expected {what} of 1 to {_LONGEST} bytes, got {wrong[0]!r}")
    return list(words)
