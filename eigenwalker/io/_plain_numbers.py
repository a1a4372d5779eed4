"""Lines of plain decimal numbers, compiled: what nearly every file of motion consists of.

Anything that is not as plain as that is left to slower code that can say what is wrong.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["parse_lines_of_numbers"]

_EXACT = 2**53  # whole numbers up to here are doubles
_TENS = 10.0 ** np.arange(23)  # and so are these powers, so that one product or quotient of two is rounded only once
_MOST_HARD = 10_000  # beyond which it is quicker to parse them all with `float`
_TAB, _LINE_FEED, _RETURN, _SPACE, _PLUS, _MINUS, _POINT, _ZERO, _E = map(np.uint8, b"\t\n\r +-.0e")


def parse_lines_of_numbers(data: bytes, start: int, shape: tuple[int, int]) -> NDArray[np.float64] | None:
    r"""Return the numbers from a byte on, or None unless they are lines of plain numbers of just this shape.

    Parameters
    ----------
    data : bytes
        Text. Lines end in line feeds, carriage returns or both; empty ones do not count.
    start : int
        Where the numbers begin.
    shape : tuple of int
        How many lines there must be, and how many numbers in each, with spaces or tabs between them.

    Returns
    -------
    ndarray or None
        The doubles nearest to the numbers, the same that `float` makes of them.

    Examples
    --------
    >>> parse_lines_of_numbers(b"1.5 -2e3\r\n.25 7\n", 0, (2, 2))
    array([[ 1.5e+00, -2.0e+03],
           [ 2.5e-01,  7.0e+00]])
    >>> parse_lines_of_numbers(b"1.5 two\n", 0, (1, 2)) is None
    True
    """
    if 2 * shape[0] * shape[1] > len(data) - start + 1:  # a number and a blank each: no header is believed
        return None
    if not data.endswith((b"\n", b"\r")):
        data += b"\n"
    values = np.empty(shape)
    hard = np.empty((_MOST_HARD, 3), dtype=np.int64)
    n_hard = _parse(np.frombuffer(data, np.uint8), start, values, hard, _TENS)
    if n_hard < 0:
        return None
    if n_hard > len(hard):
        values = np.array([float(word) for word in data[start:].split()]).reshape(shape)  # in lines of n_columns
        return values if np.isfinite(values).all() else None
    for place, first, end in hard[:n_hard].tolist():
        values.flat[place] = number = float(data[first:end])
        if math.isinf(number):
            return None
    return values


@njit(cache=True, nogil=True)
def _parse(data, start, values, hard, tens):
    """Fill in `values`; return how many of them are left, those of too many digits, or -1 if the text is not plain.

    `hard` gets the place among the values, and the first and last byte in the text, of as many of those as it holds.
    The text ends in a line feed, so that no number runs to its end.
    """
    n_columns = values.shape[1]
    flat = values.reshape(-1)  # (n_rows, n_columns) -> (n_rows n_columns,)
    count, line_end, n_hard = 0, 0, 0  # values so far, values at the end of the line before
    place, n_bytes = start, len(data)
    while place < n_bytes:
        byte = data[place]
        if byte in (_SPACE, _TAB):
            place += 1
            continue
        if byte in (_LINE_FEED, _RETURN):
            if count != line_end:
                if count != line_end + n_columns:
                    return -1
                line_end = count
            place += 1
            continue
        if count == len(flat):
            return -1
        first = place
        place, whole, power, n_digits = _read_number(data, place)
        byte = data[place]
        if n_digits == 0 or byte not in (_SPACE, _LINE_FEED, _TAB, _RETURN):
            return -1
        if n_digits > 18 or whole > _EXACT or power < -22 or power > 22:
            if n_hard < len(hard):
                hard[n_hard, 0], hard[n_hard, 1], hard[n_hard, 2] = count, first, place
            n_hard += 1
        else:
            value = whole / tens[-power] if power < 0 else whole * tens[power]
            flat[count] = -value if data[first] == _MINUS else value
        count += 1
    return n_hard if count == len(flat) else -1


@njit(cache=True, nogil=True, inline="always")
def _read_number(data, place):
    """Return the place behind a number, its digits as a whole number, its power of ten, and how many digits it has.

    Without digits it is no number. Of more than 18 digits the whole number is some other one.
    """
    whole, power = np.int64(0), 0
    if data[place] == _MINUS or data[place] == _PLUS:
        place += 1
    first = place
    digit = data[place] - _ZERO  # without a sign: bytes below a zero come out large
    while digit <= 9:
        whole = 10 * whole + np.int64(digit)
        place += 1
        digit = data[place] - _ZERO
    n_digits = place - first
    if data[place] == _POINT:
        place += 1
        first = place
        digit = data[place] - _ZERO
        while digit <= 9:
            whole = 10 * whole + np.int64(digit)
            place += 1
            digit = data[place] - _ZERO
        power = first - place
        n_digits -= power
    if n_digits > 0 and (data[place] | 32) == _E:
        place, exponent, n_digits = _read_exponent(data, place + 1, n_digits)
        power += exponent
    return place, whole, power, n_digits


@njit(cache=True, nogil=True)
def _read_exponent(data, place, n_digits):
    """Return the place behind an exponent, the exponent, some large one if it is, and `n_digits`, or 0 without one."""
    sign = -1 if data[place] == _MINUS else 1
    if data[place] == _MINUS or data[place] == _PLUS:
        place += 1
    first, exponent = place, 0
    while 48 <= data[place] <= 57:
        exponent = 10 * exponent + int(data[place]) - 48 if exponent < 1000 else 9999
        place += 1
    return place, sign * exponent, n_digits if place > first else 0
