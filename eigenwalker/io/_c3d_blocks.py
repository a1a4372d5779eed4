"""The blocks of a C3D file: header, parameters and points, read and written.

They are taken apart here and not by a library, because a file is a stranger's: no count in it is believed before the
bytes that it speaks of are there. Errors start with ``byte 512:`` where a place can be named.
"""

import math
import struct
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.io._text import listed

__all__ = ["C3dBlocks", "format_c3d", "parse_c3d"]

_BLOCK = 512  # bytes
_MARK = 0x50  # in the second byte of header and parameters
_PROCESSORS = {84: "Intel", 85: "DEC", 86: "MIPS"}
_SIZES = {-1: 1, 1: 1, 2: 2, 4: 4}  # bytes a value, by type: characters, bytes, 16-bit integers, reals
_INTEGERS = ("USED", "FRAMES", "DATA_START", "ACTUAL_START_FIELD", "ACTUAL_END_FIELD")
_LARGEST_ENTRY = 32767  # bytes from one parameter to the next, in 16 bits with a sign
_CUT = "the file seems to be cut off or damaged; get it again"


@dataclass(frozen=True, eq=False)
class C3dBlocks:
    """What a C3D file says, in its own units and axes, without its analog data.

    Parameters
    ----------
    numbers : dict of str to ndarray
        Numeric parameters, such as ``"POINT:RATE"``, the first index innermost in the file.
    texts : dict of str to list of str
        Parameters of characters, such as ``"POINT:LABELS"``, without spaces at the ends.
    points : ndarray of shape (n_frames, n_points, 4)
        x, y, z and residual.
    first_frame : int
        Number of the first frame in the recording, which starts with 1.
    frame_rate : float
        Frames per second.
    """

    numbers: dict[str, NDArray[np.float64]]
    texts: dict[str, list[str]]
    points: NDArray[np.float64]
    first_frame: int
    frame_rate: float


@dataclass(frozen=True)
class _Numbers:
    """How a processor writes numbers."""

    processor: str

    def words(self, data: bytes, *, signed: bool = True) -> NDArray[np.integer]:
        """Return 16-bit integers."""
        return np.frombuffer(data, (">" if self.processor == "MIPS" else "<") + ("i2" if signed else "u2"))

    def reals(self, data: bytes) -> NDArray[np.float64]:
        """Return 32-bit reals. DEC's have the halves the other way round and are four times IEEE's."""
        with np.errstate(invalid="ignore"):  # not every pattern of bits is a number
            if self.processor == "DEC":
                swapped = np.frombuffer(data, "<u2").reshape(-1, 2)[:, ::-1]  # (n, 2) halves
                return np.ascontiguousarray(swapped).view("<f4").ravel().astype(np.float64) / 4
            return np.frombuffer(data, ">f4" if self.processor == "MIPS" else "<f4").astype(np.float64)


def parse_c3d(data: bytes) -> C3dBlocks:
    """Return what the bytes of a C3D file say, or raise a WalkError."""
    if len(data) < _BLOCK or data[1] != _MARK:
        raise WalkError(f"byte 1: expected the header of a C3D file, {_BLOCK} bytes with the mark 0x50, got none")
    start = (data[0] - 1) * _BLOCK
    if start < _BLOCK or start + 4 > len(data):
        raise WalkError(f"byte 0: expected the block where the parameters start, got {data[0]}; {_CUT}")
    if data[start + 3] not in _PROCESSORS:
        raise WalkError(f"byte {start + 3}: expected processor type 84, 85 or 86, got {data[start + 3]}")
    read = _Numbers(_PROCESSORS[data[start + 3]])
    numbers, texts = _parameters(data, start + 4, read)
    header = read.words(data[:_BLOCK], signed=False)
    first, n_frames = _frames(header, numbers)
    scale = _number(numbers, "POINT:SCALE", read.reals(data[12:16])[0])
    if not math.isfinite(scale) or scale == 0:
        raise WalkError(
            f"expected a POINT:SCALE that integers are multiplied with, or below 0 for reals, got {scale!r}"
        )
    points = _points(data, header, scale, n_frames, read)
    used = _number(numbers, "POINT:USED", points.shape[1])
    if used != points.shape[1]:
        raise WalkError(f"expected as many points as the header says, {points.shape[1]}, got POINT:USED {used:g}")
    rate = _number(numbers, "POINT:RATE", read.reals(data[20:24])[0])
    if not (math.isfinite(rate) and rate > 0 and math.isfinite(1 / rate)):
        raise WalkError(f"expected a positive POINT:RATE in frames per second, got {rate!r}")
    return C3dBlocks(numbers, texts, points, first, rate)


def _parameters(data: bytes, place: int, read: _Numbers) -> tuple[dict[str, NDArray[np.float64]], dict[str, list[str]]]:
    """Return all parameters by GROUP:NAME; each entry says where the next one starts."""
    groups: dict[int, str] = {}
    found: list[tuple[int, str, int, int]] = []  # group, name, where type and sizes stand, where the next entry starts
    while place + 2 <= len(data) and data[place]:
        length, number = abs(_signed(data[place])), _signed(data[place + 1])
        after = place + 2 + length
        if after + 2 > len(data):
            raise WalkError(f"byte {place}: expected a parameter with a name of {length} characters; {_CUT}")
        name = _text(data[place + 2 : after]).upper()
        step = int(read.words(data[after : after + 2], signed=False)[0])
        place = after + step if step else len(data)  # the last entry may say 0
        if number < 0:
            groups[-number] = name
        else:
            found.append((number, name, after + 2, place))
    numbers, texts = {}, {}
    for number, name, start, end in found:
        key = f"{groups.get(number, number)}:{name}"
        kind, sizes, values = _values(data[start:end], start, key)
        if kind == -1:
            texts[key] = _strings(values, sizes)
        else:
            numbers[key] = _reals(values, kind, read).reshape(sizes[::-1]).T  # the first index is innermost
    return numbers, texts


def _values(data: bytes, place: int, key: str) -> tuple[int, list[int], bytes]:
    """Return type, sizes and bytes of the parameter that starts at `place` and has its own bytes only."""
    named = listed([key])
    kind = _signed(data[0]) if len(data) > 1 else 0
    sizes = list(data[2 : 2 + data[1]]) if kind in _SIZES else []
    if kind not in _SIZES or data[1] > 7 or len(sizes) < data[1]:
        raise WalkError(f"byte {place}: expected type and up to 7 sizes of the parameter {named}, got others; {_CUT}")
    start, n_bytes = 2 + len(sizes), _SIZES[kind] * math.prod(sizes)
    if start + n_bytes > len(data):
        raise WalkError(
            f"byte {place}: expected {n_bytes} bytes of the parameter {named}, got {len(data) - start} before the "
            f"next; {_CUT}"
        )
    return kind, sizes, data[start : start + n_bytes]


def _reals(values: bytes, kind: int, read: _Numbers) -> NDArray[np.float64]:
    if kind == 4:
        return read.reals(values)
    return (read.words(values) if kind == 2 else np.frombuffer(values, np.int8)).astype(np.float64)


def _strings(values: bytes, sizes: list[int]) -> list[str]:
    """Return one string for each column of a matrix of characters."""
    length = sizes[0] if sizes else 1
    return [_text(values[place : place + length]) for place in range(0, len(values), length)] if length else []


def _text(raw: bytes) -> str:
    raw = raw.strip(b"\0 ")
    try:
        return raw.decode().strip()
    except UnicodeDecodeError:
        return raw.decode("latin-1").strip()


def _signed(byte: int) -> int:
    return byte - 256 if byte > 127 else byte


def _number(numbers: dict[str, NDArray[np.float64]], key: str, default: float) -> float:
    """Return the first value of a parameter, or `default` without one. USED counts up to 65535 in 16 bits."""
    value = float(numbers[key].flat[0]) if key in numbers and numbers[key].size else float(default)
    return value + 65536 if key.endswith(":USED") and value < 0 else value


def _frames(header: NDArray[np.integer], numbers: dict[str, NDArray[np.float64]]) -> tuple[int, int]:
    """Return the number of the first frame and how many frames there are.

    The header counts to 65535. Longer recordings say the ends in two words each, or the length as a real number.
    """
    first, last = int(header[3]), int(header[4])
    ends = [numbers.get(f"TRIAL:ACTUAL_{end}_FIELD", np.empty(0)).ravel() for end in ("START", "END")]
    if all(end.size == 2 for end in ends):
        if not np.isfinite(ends).all():
            raise WalkError(
                "expected numbers of the first and the last frame in TRIAL:ACTUAL_START_FIELD and _END_FIELD"
            )
        first, last = (int(low) % 65536 + 65536 * (int(high) % 65536) for low, high in ends)
    elif last == 65535:
        length = _number(numbers, "POINT:LONG_FRAMES", 0)
        last = max(last, first + int(length) - 1) if math.isfinite(length) else last
    if last < first:
        raise WalkError(f"expected at least one frame, got frames {first} to {last}")
    return first, last - first + 1


def _points(
    data: bytes, header: NDArray[np.integer], scale: float, n_frames: int, read: _Numbers
) -> NDArray[np.float64]:
    """Return x, y, z and residual of all points, shape (n_frames, n_points, 4)."""
    n_points, n_analog, start = int(header[1]), int(header[2]), (int(header[8]) - 1) * _BLOCK
    if n_points == 0:
        raise WalkError("byte 2: expected points, got none; a file with nothing but analog data holds no walk")
    size = 4 if scale < 0 else 2
    frame_size = size * (4 * n_points + n_analog)
    if start < _BLOCK or start + n_frames * frame_size > len(data):
        raise WalkError(
            f"byte {max(start, 0)}: expected {n_frames} frames of {frame_size} bytes, got a file of {len(data)} bytes; "
            f"{_CUT}"
        )
    frames = np.frombuffer(data, np.uint8, n_frames * frame_size, start).reshape(n_frames, frame_size)
    raw = frames[:, : size * 4 * n_points].tobytes()  # without the analog part of each frame
    if size == 4:
        points = read.reals(raw).reshape(n_frames, n_points, 4)
    else:
        points = read.words(raw).astype(np.float64).reshape(n_frames, n_points, 4)
        points[..., :3] *= scale
    return points


def format_c3d(blocks: C3dBlocks) -> bytes:
    """Return the bytes of a C3D file, in Intel's order with points as reals, that say `blocks` to `parse_c3d`.

    What describes the points themselves (USED, SCALE, RATE, FRAMES, DATA_START) is put in; the recording starts with
    frame 1.
    """
    n_frames, n_points, _ = blocks.points.shape
    counted = min(n_frames, 65535)
    own = {"USED": n_points, "SCALE": -1, "RATE": blocks.frame_rate, "FRAMES": counted, "DATA_START": 0}
    numbers = {f"POINT:{name}": np.array([value], dtype=np.float64) for name, value in own.items()}
    if n_frames > counted:
        ends = {"START": 1, "END": n_frames}
        numbers |= {f"TRIAL:ACTUAL_{end}_FIELD": np.array([n % 65536, n // 65536]) for end, n in ends.items()}
    numbers |= blocks.numbers
    size = len(_format_parameters(numbers, blocks.texts))
    start = 2 + size // _BLOCK  # blocks count from 1
    if n_points > 65535 or start > 257:
        raise WalkError(f"expected markers and events whose names fit into a C3D file, got {n_points} markers")
    numbers["POINT:DATA_START"] = np.array([start])
    header = struct.pack("<BBHHHHHfHHf", 2, _MARK, n_points, 0, 1, counted, 0, -1.0, start, 0, blocks.frame_rate)
    points = np.asarray(blocks.points, dtype="<f4").tobytes()
    if n_frames == counted:  # some readers take a recording beyond the header's count to the end of the file
        points = _padded(points)
    return header.ljust(_BLOCK, b"\0") + _format_parameters(numbers, blocks.texts) + points


def _padded(data: bytes) -> bytes:
    return data + bytes(-len(data) % _BLOCK)


def _format_parameters(numbers: dict[str, NDArray[np.float64]], texts: dict[str, list[str]]) -> bytes:
    """Return the blocks of parameters."""
    keys = [key.split(":") for key in (*numbers, *texts)]
    groups = {group: place for place, group in enumerate(dict.fromkeys(group for group, _ in keys), 1)}
    entries = [_format_entry(group, -place, b"\0") for group, place in groups.items()]
    for key, values in numbers.items():
        group, name = key.split(":")
        kind, form = (2, "<u2") if name in _INTEGERS else (4, "<f4")
        data = np.ravel(values, order="F").astype(form).tobytes()
        entries.append(_format_entry(name, groups[group], struct.pack("b", kind) + _sized(values.shape, data)))
    for key, words in texts.items():
        group, name = key.split(":")
        coded = [word.encode() for word in words]
        length = max(map(len, coded), default=0)
        data = b"".join(word.ljust(length) for word in coded)
        entries.append(_format_entry(name, groups[group], struct.pack("b", -1) + _sized((length, len(words)), data)))
    body = b"".join(entries) + b"\0\0"
    n_blocks = -(-(4 + len(body)) // _BLOCK)
    return _padded(struct.pack("BBBB", 1, _MARK, min(n_blocks, 255), 84) + body)


def _sized(sizes: tuple[int, ...], data: bytes) -> bytes:
    """Return sizes, data, and a description of no length."""
    if max(sizes, default=0) > 255 or len(data) > _LARGEST_ENTRY - 64:
        raise WalkError(f"expected at most 255 entries and {_LARGEST_ENTRY - 64} bytes in a parameter, got {sizes}")
    return bytes([len(sizes), *sizes]) + data + b"\0"


def _format_entry(name: str, number: int, content: bytes) -> bytes:
    """Return a group or a parameter; the offset counts from itself to the next entry."""
    return struct.pack("bb", len(name), number) + name.encode() + struct.pack("<H", 2 + len(content)) + content
