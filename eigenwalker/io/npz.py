"""NPZ files: everything that a walk holds, for this package to read back."""

import io
import json
import math
import re
import reprlib
import zipfile
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.io._text import listed, name_file
from eigenwalker.motion.skeleton import MarkerSet, Skeleton
from eigenwalker.motion.walk import Event, JointWalk, Walk

__all__ = ["read_npz", "write_npz"]

_VERSION = 1
_LONGEST = 300  # characters of another library's error
_HEADER = re.compile(  # of numpy's own parser too much can come: it takes the text for a piece of Python
    rb"\x93NUMPY\x01\x00..\{'descr': '([<>|=]?[fiuUbcOSV][0-9]{0,9})', 'fortran_order': (False|True), "
    rb"'shape': \(((?:[0-9]{1,18}, ?)*(?:[0-9]{1,18})?)\), \} *\n",
    re.DOTALL,
)
_SKELETON = ("parents", "offsets", "end_parents", "end_offsets")


def write_npz(walk: Walk | JointWalk, path: str | PathLike[str]) -> None:
    """Write a walk with everything it holds, to the last bit.

    Parameters
    ----------
    walk : Walk or JointWalk
        What to write.
    path : str or path
        Where to. Unlike `numpy.savez` this adds no suffix.

    Notes
    -----
    The file is a plain archive of arrays, which `numpy.load` opens without pickle: ``positions``, or ``rotations``,
    ``root``, the arrays of the skeleton and one ``translation_0``, ... for each joint that moves. ``walk`` is a text,
    JSON, with the version of this layout and all names and numbers.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> import numpy as np
    >>> from eigenwalker.io import read_npz, write_npz
    >>> from eigenwalker.motion import Walk
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "anna.npz")
    ...     write_npz(Walk(np.zeros((240, 15, 3)), frame_rate=120, name="anna", speed=1.2), path)
    ...     walk = read_npz(path)
    >>> walk.name, walk.speed, walk.n_frames
    ('anna', 1.2, 240)
    """
    if not isinstance(walk, (Walk, JointWalk)):
        raise TypeError(f"expected a Walk or JointWalk, got {type(walk).__name__}")
    fields, arrays = _marker_fields(walk) if isinstance(walk, Walk) else _joint_fields(walk)
    fields = {
        "version": _VERSION,
        "kind": type(walk).__name__,
        "name": walk.name,
        "frame_rate": walk.frame_rate,
        "speed": None if math.isnan(walk.speed) else walk.speed,
        "frequency": None if math.isnan(walk.frequency) else walk.frequency,
        "size": walk.size,
        "events": [list(event) for event in walk.events],
        **fields,
    }
    with Path(path).open("wb") as file:
        np.savez(file, allow_pickle=False, **{"walk": np.array(json.dumps(fields)), **arrays})


def _marker_fields(walk: Walk) -> tuple[dict[str, Any], dict[str, Any]]:
    markers = walk.marker_set
    return {"markers": markers.names, "sticks": markers.sticks}, {"positions": walk.positions}


def _joint_fields(walk: JointWalk) -> tuple[dict[str, Any], dict[str, Any]]:
    skeleton = walk.skeleton
    fields = {
        "joints": skeleton.joint_names,
        "root": skeleton.root,
        "rotation_orders": skeleton.rotation_orders,
        "upright": skeleton.upright,
        "channel_joints": walk.channel_joints,
        "translations": list(walk.translations),
    }
    arrays = {name: getattr(skeleton, name) for name in _SKELETON}
    moving = {f"translation_{place}": path for place, path in enumerate(walk.translations.values())}
    return fields, {"rotations": walk.rotations, "root": walk.root, **arrays, **moving}


def read_npz(path: str | PathLike[str], *, name: str | None = None) -> Walk | JointWalk:
    """Return the walk that `write_npz` has written.

    Parameters
    ----------
    path : str or path
        The file.
    name : str, default None
        Name of the walk. None is the name it was written with.

    Returns
    -------
    Walk or JointWalk
        Equal to what was written.

    Raises
    ------
    WalkError
        If the file is not a sound archive of a walk, or of a version that this package does not know.
    OSError
        If the file cannot be opened.
    """
    data = Path(path).read_bytes()
    with name_file(path, before=": "):
        return _read(data, name)


def _read(data: bytes, name: str | None) -> Walk | JointWalk:
    try:
        arrays = _read_arrays(data)
        return _build(_fields(arrays), arrays, name)
    except (WalkError, MemoryError):
        raise
    except Exception as error:  # zipfile, numpy and json raise nearly every kind for bytes that were never theirs
        reason = " ".join(str(error).split())[:_LONGEST]
        raise WalkError(
            f"expected an archive written by write_npz, got {type(error).__name__}: {reason}; get it again"
        ) from None


def _read_arrays(data: bytes) -> dict[str, NDArray]:
    """Return the arrays in an archive. No header is trusted: an array is as large as the bytes that are there."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        entries = archive.infolist()
        packed = [entry.filename for entry in entries if entry.compress_type != zipfile.ZIP_STORED]
        if packed:
            raise WalkError(f"expected an archive without compression, got {listed(packed)} compressed; use write_npz")
        if sum(entry.file_size for entry in entries) > len(data):  # several may be made of the same bytes
            raise WalkError(f"expected entries of fewer bytes than the archive, {len(data)}; get it again")
        return {entry.filename.removesuffix(".npy"): _read_array(archive.read(entry)) for entry in entries}


def _read_array(data: bytes) -> NDArray:
    """Return the array in the bytes of an NPY file, of which only the version that `numpy.savez` writes is read."""
    start = 10 + int.from_bytes(data[8:10], "little")
    header = _HEADER.fullmatch(data[:start])
    if header is None:
        raise WalkError("expected arrays of numeric type, as numpy.savez writes them, got others; get it again")
    kind = np.dtype(header[1].decode())
    shape = tuple(int(size) for size in header[3].replace(b",", b" ").split())
    n_bytes = len(data) - start
    if (
        kind.kind not in "fiuU"
        or math.prod(shape) * kind.itemsize != n_bytes
        or max(shape, default=0) > max(n_bytes, 1_000_000)
    ):
        # Frames without markers take no bytes: of them too there may not be any number.
        raise WalkError(f"expected an array of shape {shape} and numeric type, got {n_bytes} bytes of type {kind}")
    return np.frombuffer(data, dtype=kind, offset=start).reshape(shape, order="F" if header[2] == b"True" else "C")


def _fields(arrays: dict[str, NDArray]) -> dict[str, Any]:
    """Return the names and numbers of the walk, after a check of the version."""
    if "walk" not in arrays:
        raise WalkError(f"expected an archive written by write_npz, got one of {listed(arrays) or 'nothing'}")
    fields = json.loads(str(arrays["walk"]))
    if fields["version"] != _VERSION:
        got = reprlib.repr(fields["version"])
        raise WalkError(f"expected version {_VERSION} of the layout, got {got}; update the package")
    return fields


def _build(fields: dict[str, Any], arrays: dict[str, NDArray], name: str | None) -> Walk | JointWalk:
    common = {
        "frame_rate": fields["frame_rate"],
        "name": fields["name"] if name is None else name,
        "speed": math.nan if fields["speed"] is None else fields["speed"],
        "frequency": math.nan if fields["frequency"] is None else fields["frequency"],
        "size": fields["size"],
        "events": tuple(Event(float(time), str(kind), str(side)) for time, kind, side in fields["events"]),
    }
    if fields["kind"] == "Walk":
        markers = MarkerSet(tuple(fields["markers"]), tuple((start, end) for start, end in fields["sticks"]))
        return Walk(arrays["positions"], marker_set=markers, **common)
    parents, offsets, end_parents, end_offsets = (arrays[part] for part in _SKELETON)
    names, root, orders = (fields[key] for key in ("joints", "root", "rotation_orders"))
    upright, joints = fields.get("upright", False), fields.get("channel_joints")  # files without them are older
    if not isinstance(upright, bool):
        raise WalkError(f"expected upright to be true or false, got {reprlib.repr(upright)}; get it again")
    skeleton = Skeleton(tuple(names), parents, offsets, end_parents, end_offsets, root, orders, upright)
    moving = {joint: arrays[f"translation_{place}"] for place, joint in enumerate(fields["translations"])}
    common["channel_joints"] = None if joints is None else tuple(joints)
    return JointWalk(arrays["rotations"], arrays["root"], skeleton, translations=moving, **common)
