"""The variables of a MATLAB file of versions 5 to 7: their names and sizes, and the numbers of small real matrices.

SciPy reads these files as well, but a damaged file can bring its compiled reader, and Python with it, to a crash.
Errors start with ``byte 128:``; `name_file` puts the file's name before them.
"""

import math
import zlib
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError

__all__ = ["MatVariable", "read_mat"]

_HEADER = 128  # bytes: a text, the version, and the order of bytes
_MOST_SIZES = 32  # dimensions of a variable
_UNPACKED = 65_536  # bytes at most of a compressed variable: the head of any, and the whole of a small matrix
_MATRIX, _COMPRESSED = 14, 15
_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_CLASSES = (
    *("cell", "struct", "object", "char", "sparse", "double", "single"),
    *("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"),
)  # from 1 on
_FIRST_NUMERIC = 6
_IS_COMPLEX = 0x0800
_Order = Literal["little", "big"]


class MatVariable(NamedTuple):
    """One variable: what it is called, its size, its class as MATLAB says it, and its numbers or None."""

    name: str
    shape: tuple[int, ...]
    kind: str
    values: NDArray | None


class _Element(NamedTuple):
    """One data element: its type, its bytes, and where the next one starts."""

    kind: int
    data: bytes
    end: int


def read_mat(data: bytes, *, n_numbers: int) -> list[MatVariable]:
    """Return the variables in a MATLAB file, with the values of those that are real matrices of `n_numbers`.

    Raises
    ------
    WalkError
        If the bytes are no MATLAB file of versions 5 to 7, with the place.
    """
    orders: dict[bytes, _Order] = {b"IM": "little", b"MI": "big"}
    order = orders.get(data[126:128])
    version = int.from_bytes(data[124:126], order or "little")
    if order is not None and version == 0x0200:
        raise WalkError("byte 124: expected a MATLAB file up to version 7, got version 7.3; save it with '-v7'")
    if order is None or version != 0x0100:
        raise WalkError("byte 124: expected a MATLAB file of version 5 to 7, got something else; save it with '-v7'")
    variables = []
    place = _HEADER
    while place < len(data):
        element = _read_element(data, place, order)
        unpacked = _unpack(element, place, order) if element.kind == _COMPRESSED else element
        if unpacked.kind != _MATRIX:
            raise WalkError(f"byte {place}: expected a variable (type {_MATRIX}), got type {unpacked.kind}")
        variables.append(_read_variable(unpacked.data, place, order, n_numbers))
        place = element.end
    return variables


def _read_element(data: bytes, place: int, order: _Order, *, cut: bool = False) -> _Element:
    """Return the element at a place, whose first eight bytes say its type and size; it may be cut if `cut`."""
    if place + 8 > len(data):
        raise WalkError(f"byte {place}: expected a data element, got the end of the file; it seems to be cut off")
    kind, size = (int.from_bytes(data[place + start : place + start + 4], order) for start in (0, 4))
    if kind >> 16:  # up to four bytes are packed into the tag
        kind, size, start = kind & 0xFFFF, kind >> 16, place + 4
        end = place + 8
    else:
        start = place + 8
        end = start + (size if kind == _COMPRESSED else -(-size // 8) * 8)
    body = data[start : min(start + size, len(data))]
    if len(body) < size and not cut:
        raise WalkError(f"byte {place}: expected {size} bytes, got {len(body)}; the file seems to be cut off")
    return _Element(kind, body, end)


def _unpack(element: _Element, place: int, order: _Order) -> _Element:
    """Return the element within a compressed one, of which no more is unpacked than a small matrix takes."""
    try:
        return _read_element(zlib.decompressobj().decompress(element.data, _UNPACKED), 0, order, cut=True)
    except zlib.error as error:
        raise WalkError(f"byte {place}: expected a compressed variable, but {error}") from None


def _read_variable(data: bytes, place: int, order: _Order, n_numbers: int) -> MatVariable:
    """Return the variable in the bytes of a matrix: flags, dimensions, name and, if it is small, its numbers."""
    try:
        flags = _read_element(data, 0, order)
        sizes = _read_element(data, flags.end, order)
        title = _read_element(data, sizes.end, order)
    except WalkError:
        raise WalkError(f"byte {place}: expected flags, dimensions and name of a variable, got none") from None
    word = int.from_bytes(flags.data[:4], order)
    kind = word & 0xFF
    if len(sizes.data) > 4 * _MOST_SIZES:
        raise WalkError(f"byte {place}: expected a variable of at most {_MOST_SIZES} dimensions, got more")
    shape = tuple(int.from_bytes(sizes.data[at : at + 4], order) for at in range(0, len(sizes.data), 4))
    name = title.data.decode("latin-1")
    label = _CLASSES[kind - 1] if 1 <= kind <= len(_CLASSES) else "unknown"
    if word & _IS_COMPLEX:
        label = f"complex {label}"
    if kind < _FIRST_NUMERIC or word & _IS_COMPLEX or math.prod(shape) != n_numbers:
        return MatVariable(name, shape, label, None)
    numbers = _read_element(data, title.end, order)
    stored = np.dtype(_TYPES.get(numbers.kind, "V1")).newbyteorder("<" if order == "little" else ">")
    if stored.kind == "V" or len(numbers.data) != n_numbers * stored.itemsize:
        raise WalkError(f"byte {place}: expected {n_numbers} numbers, got {len(numbers.data)} bytes of other things")
    return MatVariable(name, shape, label, np.frombuffer(numbers.data, stored).reshape(shape, order="F"))
