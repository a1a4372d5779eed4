"""Checks that every part of the package shares: shapes, rates, finiteness, names and choices."""

import math
from collections import Counter
from collections.abc import Collection, Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "WalkError",
    "check_array",
    "check_choice",
    "check_finite",
    "check_frame_rate",
    "check_names",
    "check_walks",
    "restore_read_only",
]


class WalkError(ValueError):
    """A walk or a file of walks that cannot be used, with the reason and the way out."""


def check_array(values: ArrayLike, *, shape: Sequence[int | str], name: str) -> NDArray[np.floating]:
    """Return `values` as a read-only float array of the given shape.

    Parameters
    ----------
    values : array-like
        Numbers. float32 stays float32, anything else becomes float64.
    shape : sequence of int or str
        Expected length of each axis; a string names an axis of any length.
    name : str
        What the array is called in the error.

    Returns
    -------
    ndarray
        Read-only. The input itself if it was read-only already, else a copy.

    Raises
    ------
    ValueError
        If `values` is not numeric or its shape differs.
    """
    try:
        array = np.asarray(values)
        array = array if array.dtype == np.float32 else np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be an array of numbers, got {type(values).__name__}: {error}") from None
    wanted = "(" + ", ".join(map(str, shape)) + ")"
    fits = array.ndim == len(shape) and all(
        isinstance(want, str) or want == got for want, got in zip(shape, array.shape, strict=True)
    )
    if not fits:
        raise ValueError(f"{name} must have shape {wanted}, got {array.shape}")
    if array.flags.writeable:
        array = array.copy()
        array.flags.writeable = False
    return array


def check_frame_rate(frame_rate: float) -> float:
    """Return `frame_rate` as a float, in frames per second."""
    try:
        rate = float(frame_rate)
    except (TypeError, ValueError):
        raise TypeError(f"frame_rate must be a number of frames per second, got {frame_rate!r}") from None
    if not 0 < rate < math.inf:
        raise ValueError(f"frame_rate must be positive and finite, in frames per second, got {frame_rate!r}")
    return rate


def check_choice(value: object, choices: Collection[object], *, name: str) -> None:
    """Raise a ValueError that lists the choices unless `value` is one of them."""
    if value not in choices:
        listed = ", ".join(repr(choice) for choice in choices)
        raise ValueError(f"{name} must be one of {listed}, got {value!r}")


def check_names(names: Iterable[str], *, name: str) -> tuple[str, ...]:
    """Return `names` as a tuple of different, non-empty strings."""
    if isinstance(names, str):
        raise TypeError(f"{name} must be a sequence of names, got the single string {names!r}")
    result = tuple(names)
    wrong = [item for item in result if not isinstance(item, str) or not item]
    if wrong:
        raise TypeError(f"{name} must be non-empty strings, got {wrong[0]!r}")
    repeated = sorted(item for item, count in Counter(result).items() if count > 1)
    if repeated:
        raise ValueError(f"{name} must differ from each other, but these repeat: {', '.join(repeated)}")
    return result


def check_finite(channels: NDArray[np.floating], channel_names: Sequence[str], *, walk: str) -> None:
    """Raise a WalkError that says where a walk has NaN or infinite values.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        The walk's values.
    channel_names : sequence of str
        One name a channel.
    walk : str
        The walk's name, for the error.
    """
    bad = ~np.isfinite(channels)
    if not bad.any():
        return
    columns = np.flatnonzero(bad.any(axis=0))
    frames = np.flatnonzero(bad.any(axis=1))
    shown = ", ".join(channel_names[column] for column in columns[:4])
    more = f" and {len(columns) - 4} more channels" if len(columns) > 4 else ""
    raise WalkError(
        f"walk {walk!r}: expected finite values, got {int(bad.sum())} NaN or infinite ones in {shown}{more}, "
        f"first in frame {frames[0]}, last in frame {frames[-1]} of {len(channels)}; "
        "fill the gaps or cut the walk to frames without gaps first"
    )


def check_walks(walks: object, *, kind: type | tuple[type, ...]) -> list:
    """Return `walks` as a list, or raise unless it is a non-empty sequence of walks.

    Parameters
    ----------
    walks : sequence
        What the caller passed.
    kind : type or tuple of types
        The accepted walk classes.
    """
    names = [item.__name__ for item in (kind if isinstance(kind, tuple) else (kind,))]
    if isinstance(walks, kind):
        raise TypeError(f"expected a list of walks, got a single {type(walks).__name__}: wrap it, [walk]")
    if isinstance(walks, (str, bytes)) or not isinstance(walks, (Sequence, np.ndarray)):
        raise TypeError(f"expected a list of {' or '.join(names)}, got {type(walks).__name__}")
    result = list(walks)
    if not result:
        raise ValueError("expected at least one walk, got an empty list")
    for position, item in enumerate(result):
        if not isinstance(item, kind):
            raise TypeError(
                f"expected a list of {' or '.join(names)}, got {type(item).__name__} at position {position}"
            )
    return result


def restore_read_only(instance: object, state: dict[str, object]) -> None:
    """Set the state of an unpickled frozen dataclass; numpy brings read-only arrays back writeable.

    Parameters
    ----------
    instance : object
        The new object.
    state : dict
        Its attributes: arrays, dictionaries of arrays, or anything else.
    """
    for value in state.values():
        for item in value.values() if isinstance(value, dict) else (value,):
            if isinstance(item, np.ndarray):
                item.flags.writeable = False
    instance.__dict__.update(state)
