"""BML mm matrices: the walkers of the BioMotionLab as mean and two harmonics, in millimetres.

A matrix has five blocks, mean, sin1, cos1, sin2, cos2 (the sine first), each of 15 x, 15 y, 15 z and one scalar:
5 x 46 = 230 numbers. The scalar of the first block is the stride's period in frames at 120 Hz, that of the second a
size factor, that of the third the walking speed in millimetres per frame; those of the others are zero.
"""

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.io import savemat

from eigenwalker._validation import WalkError, check_array, check_finite, check_frame_rate
from eigenwalker.io._markers import check_markers, make_walk
from eigenwalker.io._mat5 import read_mat
from eigenwalker.io._text import decode_lines, join_numbers, listed, name_file, number_table, split_rows, write_lines
from eigenwalker.motion.fourier import (
    FREQUENCY_RANGE,
    evaluate_harmonics,
    fit_harmonics,
    reference_phase,
    shift_phase,
)
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.skeleton import TROJE15
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["BmlFeatures", "bml_to_features", "features_to_bml", "read_bml", "write_bml"]

_RATE = 120.0  # frames per second of the matrix, whatever the walk has
_SHAPE = (5, 46)
_SIZES = (_SHAPE, _SHAPE[::-1], (1, 230), (230, 1))
_LARGEST = 1e9  # millimetres


class BmlFeatures(NamedTuple):
    """What a BML mm matrix says, in units of this package.

    Parameters
    ----------
    coefficients : ndarray of shape (5, 45)
        Rows mean, sin1, cos1, sin2, cos2; columns as in `Walk.channels`; in metres, x forward, y left, z up.
    frequency : float
        Strides per second.
    size : float
        The size factor, carried along: the coefficients are as stored, neither divided nor multiplied by it.
    speed : float
        Walking speed in m/s, NaN where it is unknown.
    """

    coefficients: NDArray[np.float64]
    frequency: float
    size: float
    speed: float


def bml_to_features(matrix: ArrayLike, *, marker_order: Sequence[str] = TROJE15.names) -> BmlFeatures:
    """Return the features that a BML mm matrix stands for.

    Parameters
    ----------
    matrix : array-like of shape (5, 46)
        In millimetres and frames at 120 Hz; see the module.
    marker_order : sequence of str, default `TROJE15.names`
        The order of the markers in the matrix. That it is that of `TROJE15` is an assumption.

    Raises
    ------
    WalkError
        If a number is not finite (the speed apart), or if the period or the size is not positive.

    Examples
    --------
    >>> import numpy as np
    >>> matrix = np.zeros((5, 46))
    >>> matrix[:3, 45] = 126.03, 1.0, 11.30
    >>> features = bml_to_features(matrix)
    >>> round(features.frequency, 3), round(features.speed, 3)
    (0.952, 1.356)
    """
    matrix = check_array(matrix, shape=_SHAPE, name="matrix").astype(np.float64)
    period, size, speed = matrix[:3, -1].tolist()
    if not np.abs(matrix[:, :-1]).max() < _LARGEST:
        raise WalkError(f"expected positions in millimetres below {_LARGEST:g}, got larger ones or NaN")
    if not (0 < period < np.inf and 0 < size < np.inf and abs(speed) != np.inf):
        raise WalkError(
            "expected as last of each 46 numbers a positive period in frames, a positive size factor and a speed, "
            f"got {period:g}, {size:g} and {speed:g}; are these five blocks of 15 x, 15 y, 15 z and one scalar?"
        )
    blocks = matrix[:, :-1].reshape(5, 3, 15)[:, :, _places(marker_order)]  # (5, axes, markers)
    coefficients = blocks.transpose(0, 2, 1).reshape(5, 45) / 1000  # (5, markers, axes) -> (5, channels)
    return BmlFeatures(coefficients, _RATE / period, size, speed * _RATE / 1000)


def features_to_bml(features: BmlFeatures, *, marker_order: Sequence[str] = TROJE15.names) -> NDArray[np.float64]:
    """Return the BML mm matrix, shape (5, 46), of some features: the inverse of `bml_to_features`."""
    coefficients = check_array(features.coefficients, shape=(5, 45), name="coefficients")
    blocks = coefficients.reshape(5, 15, 3).transpose(0, 2, 1)  # (5, channels) -> (5, axes, markers)
    matrix = np.zeros(_SHAPE)
    matrix[:, :-1] = 1000 * blocks[:, :, np.argsort(_places(marker_order))].reshape(5, 45)
    matrix[:3, -1] = _RATE / features.frequency, features.size, features.speed * 1000 / _RATE
    return matrix


def _places(marker_order: Sequence[str]) -> list[int]:
    """Return where each marker of `TROJE15` stands in another order of the same markers."""
    order = list(marker_order)
    if sorted(order) != sorted(TROJE15.names):
        raise ValueError(f"marker_order must hold the 15 names {', '.join(TROJE15.names)}, got {', '.join(order)}")
    return [order.index(name) for name in TROJE15.names]


def read_bml(
    path: str | PathLike[str],
    *,
    variable: str | None = None,
    marker_order: Sequence[str] = TROJE15.names,
    n_cycles: float = 10,
    frame_rate: float = 120.0,
    name: str | None = None,
) -> Walk:
    """Return the walk that a BML mm matrix stands for.

    Parameters
    ----------
    path : str or path
        A MATLAB file (``.mat``, of version 5 to 7) or, with any other suffix, text: 230 numbers in one row or column,
        5 rows of 46 or 46 rows of 5, separated by commas.
    variable : str, default None
        Which variable of the MATLAB file. None is the only numeric one of a fitting size.
    marker_order : sequence of str, default `TROJE15.names`
        The order of the markers in the matrix. That it is that of `TROJE15` is an assumption.
    n_cycles : float, default 10
        Number of strides of the walk, to the nearest frame.
    frame_rate : float, default 120.0
        Frames per second of the walk.
    name : str, default None
        Name of the walk. None is the file's name without its suffix.

    Returns
    -------
    Walk
        In metres, x forward, y left, z up, with the speed and the size factor of the matrix. The positions are as
        stored: they are not multiplied by the size factor.

    Raises
    ------
    WalkError
        If the file holds no such matrix, or one with a stride frequency out of the range of people's.
    OSError
        If the file cannot be opened.
    """
    rate = check_frame_rate(frame_rate)
    path = Path(path)
    is_matlab = path.suffix.lower() == ".mat"
    data = path.read_bytes()
    with name_file(path):
        table = _read_mat(data, variable) if is_matlab else _read_text(data)
    with name_file(path, before=": "):
        features = bml_to_features(_to_matrix(table), marker_order=marker_order)
        _check_frequency(features.frequency)
    times = np.arange(max(1, round(n_cycles * rate / features.frequency))) / rate
    positions = evaluate_harmonics(features.coefficients, features.frequency, times).reshape(len(times), 15, 3)
    title = path.stem if name is None else name
    known = {"speed": features.speed, "size": features.size}
    return make_walk(positions, rate, TROJE15.names, path=path, name=title, unit="mm", **known)


def _check_frequency(frequency: float) -> None:
    low, high = FREQUENCY_RANGE
    if not low <= frequency <= high:
        raise WalkError(
            f"expected a stride's period of {_RATE / high:g} to {_RATE / low:g} frames at 120 Hz, "
            f"got {_RATE / frequency:.6g}"
        )


def _to_matrix(table: NDArray) -> NDArray:
    if table.shape not in _SIZES:
        sizes = ", ".join(f"{rows} x {columns}" for rows, columns in _SIZES)
        raise WalkError(f"expected a matrix of {sizes}, got {' x '.join(map(str, table.shape))}; one walker a file")
    return table.T if table.shape == _SHAPE[::-1] else table.reshape(_SHAPE)


def _read_text(data: bytes) -> NDArray[np.float64]:
    rows = split_rows(decode_lines(data, "a table of numbers"), separator=",")
    if not rows:
        raise WalkError("line 1: expected 230 numbers, got an empty file")
    return number_table(rows, len(rows[0].words))


def _read_mat(data: bytes, variable: str | None) -> NDArray:
    """Return the matrix in a MATLAB file."""
    variables = read_mat(data, n_numbers=_SHAPE[0] * _SHAPE[1])
    fitting = [
        found.values
        for found in variables
        if found.values is not None and found.shape in _SIZES and variable in (None, found.name)
    ]
    if len(fitting) != 1:
        have = listed([f"{found.name} ({' x '.join(map(str, found.shape))} {found.kind})" for found in variables])
        wanted = "a single numeric variable" if variable is None else f"a numeric variable {variable!r}"
        raise WalkError(f"expected {wanted} of 230 numbers, got {have or 'no variable'}; name it with variable=...")
    return fitting[0]


def write_bml(
    walk: Walk | JointWalk,
    path: str | PathLike[str],
    *,
    marker_order: Sequence[str] = TROJE15.names,
    phase_reference: str | Mapping[str, float] | None = "auto",
) -> None:
    """Write a walk as a BML mm matrix: its mean and two harmonics.

    Parameters
    ----------
    walk : Walk
        With the 15 markers of `TROJE15`, without gaps, and prepared: in the frame of a treadmill. What two harmonics
        leave out of it is lost; its speed and size are kept.
    path : str or path
        Where to: a MATLAB file with the variable ``walker`` if it ends in ``.mat``, else 5 lines of 46 numbers.
    marker_order : sequence of str, default `TROJE15.names`
        The order of the markers in the matrix.
    phase_reference : "auto", mapping of str to float, or None, default "auto"
        Time zero is where the first harmonic of these channels is a pure cosine with positive sign, as in
        `phase_weights`; "auto" is left minus right ankle, forward. None keeps the walk's own first frame.

    Raises
    ------
    TypeError
        If `walk` has joints and no markers.
    WalkError
        If it lacks one of the 15 markers, has gaps, or no period.
    """
    walk = check_markers(walk)
    missing = [marker for marker in TROJE15.names if marker not in walk.marker_set.names]
    if missing:
        raise WalkError(f"walk {walk.name!r}: expected the 15 markers of TROJE15, got none for {', '.join(missing)}")
    positions = walk.positions[:, [walk.marker_set.index(marker) for marker in TROJE15.names]]
    walk = Walk(positions, walk.frame_rate, TROJE15, walk.name, walk.speed, walk.size)
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    reference = "auto" if phase_reference is None else phase_reference
    frequency = stride_frequency(walk, phase_reference=reference)
    coefficients = fit_harmonics(walk.channels, walk.frame_rate, frequency, 2)
    if phase_reference is not None:
        phase = reference_phase(coefficients, phase_weights(walk, phase_reference))
        coefficients = shift_phase(coefficients, phase)
    features = BmlFeatures(coefficients, frequency, walk.size, walk.speed)
    _write_matrix(features_to_bml(features, marker_order=marker_order), Path(path))


def _write_matrix(matrix: NDArray[np.float64], path: Path) -> None:
    if path.suffix.lower() == ".mat":
        savemat(path, {"walker": matrix}, appendmat=False)
    else:
        write_lines(path, [join_numbers(row, ",", gap="nan") for row in matrix.tolist()])
