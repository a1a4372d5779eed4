"""Linear transforms of channels: what makes the walk of one walker look like that of the model, and back.

    z = A c + b

acts on the static channels c, and so on every window: delta z = A delta c, as the windows are linear in time, too. In
general a window whose coefficients sum to s has A (window of c) + s b: all of the bias for the static window, none for
dynamics.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm.features import WINDOWS

__all__ = ["ChannelTransform", "identity_transform", "transform_observations", "transformed_moments"]


class ChannelTransform(NamedTuple):
    """z = A c + b.

    Attributes
    ----------
    matrix : ndarray of shape (n_channels, n_channels)
        A, whose row i says what channel i of the model is made of. Invertible.
    bias : ndarray of shape (n_channels,)
        b, in the units of the channels.

    Examples
    --------
    >>> import numpy as np
    >>> transform = ChannelTransform(np.array([[2.0, 0.0], [0.0, 4.0]]), np.array([1.0, 1.0]))
    >>> transform.apply([[1.0, 1.0]])
    array([[3., 5.]])
    >>> transform.then(transform.inverse()).apply([[1.0, 1.0]])
    array([[1., 1.]])
    >>> round(transform.log_volume, 3)
    2.079
    """

    matrix: NDArray[np.floating]
    bias: NDArray[np.floating]

    @property
    def log_volume(self) -> float:
        """The logarithm of |det A|, by which every window of a frame is denser than that of z."""
        return float(np.linalg.slogdet(self.matrix).logabsdet)

    def apply(self, channels: ArrayLike) -> NDArray[np.float64]:
        """Return z of static channels c; shape (..., n_channels). With dynamics: `transform_observations`."""
        return np.asarray(channels, dtype=np.float64) @ self.matrix.T + self.bias

    def inverse(self) -> "ChannelTransform":
        """Return c = A^-1 z - A^-1 b."""
        matrix = np.linalg.inv(self.matrix)
        return ChannelTransform(matrix, -matrix @ self.bias)

    def then(self, other: "ChannelTransform") -> "ChannelTransform":
        """Return this transform followed by another: A_2 A_1 c + A_2 b_1 + b_2."""
        return ChannelTransform(other.matrix @ self.matrix, other.matrix @ self.bias + other.bias)


def identity_transform(n_channels: int) -> ChannelTransform:
    """Return the transform that changes nothing.

    Parameters
    ----------
    n_channels : int
        Number of static channels.

    Returns
    -------
    ChannelTransform

    Examples
    --------
    >>> identity_transform(2).apply([3.0, 4.0])
    array([3., 4.])
    """
    return ChannelTransform(np.eye(n_channels), np.zeros(n_channels))


def transform_observations(
    observations: NDArray[np.floating], transform: ChannelTransform, *, windows: Sequence[Sequence[float]] = WINDOWS
) -> NDArray[np.float64]:
    """Return transformed channels and their dynamics, from channels and their dynamics.

    Parameters
    ----------
    observations : ndarray of shape (n_frames, n_windows * n_channels)
        From `append_dynamics` with the same windows. A window of a frame that has NaN is NaN.
    transform : ChannelTransform
        Of the static channels.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of each window.

    Returns
    -------
    ndarray of shape (n_frames, n_windows * n_channels)
        The same as ``append_dynamics(transform.apply(channels))``, up to rounding.

    Raises
    ------
    ValueError
        If the features are not those of the windows and the transform.

    Examples
    --------
    >>> import numpy as np
    >>> half = ChannelTransform(np.array([[0.5]]), np.array([10.0]))
    >>> transform_observations(np.array([[4.0, 2.0, 6.0]]), half)  # static, delta, delta2
    array([[12.,  1.,  3.]])
    """
    parts = split_windows(observations, len(transform.bias), windows)
    shifts = np.multiply.outer(window_sums(windows), transform.bias)
    return (parts @ transform.matrix.T + shifts).reshape(len(parts), -1)  # (n_frames, n_windows * n_channels)


def transformed_moments(
    transform: ChannelTransform,
    means: NDArray[np.floating],
    variances: NDArray[np.floating],
    *,
    windows: Sequence[Sequence[float]] = WINDOWS,
    full: bool = False,
) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """Return means and variances of states as the channels c see them, which is the adapted model.

    With mu and Sigma those of z and s the sum of a window's coefficients, each window has

        mean A^-1 (mu - s b),    covariance A^-1 Sigma A^-T

    Parameters
    ----------
    transform : ChannelTransform
        z = A c + b.
    means, variances : ndarray of shape (n_states, n_windows * n_channels)
        Of z.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of each window.
    full : bool, default False
        Whether covariances are returned rather than their diagonals.

    Returns
    -------
    means : ndarray of shape (n_states, n_windows * n_channels)
    variances : ndarray of shape (n_states, n_windows * n_channels), or (n_states, n_windows, n_channels, n_channels)

    See Also
    --------
    undo_transform : Trajectories of the adapted model, exact without covariances.

    References
    ----------
    Tilmanne, Moinet & Dutoit 2012, Eq. 5, with A^-1 for their A and A^-1 b for their b. Their second part,
    A Sigma A, lacks a transpose.

    Examples
    --------
    >>> import numpy as np
    >>> double = ChannelTransform(np.array([[2.0]]), np.array([1.0]))
    >>> transformed_moments(double, np.array([[5.0, 4.0, 0.0]]), np.array([[4.0, 4.0, 8.0]]))
    (array([[2., 2., 0.]]), array([[1., 1., 2.]]))
    """
    inverse = np.linalg.inv(transform.matrix)
    shifts = np.multiply.outer(window_sums(windows), transform.bias)
    centers = (split_windows(means, len(inverse), windows) - shifts) @ inverse.T
    spreads = split_windows(variances, len(inverse), windows)
    if full:
        seen = np.einsum("ij,swj,kj->swik", inverse, spreads, inverse, optimize=True)
    else:
        seen = (spreads @ (inverse**2).T).reshape(len(spreads), -1)
    return centers.reshape(len(spreads), -1), seen


def window_sums(windows: Sequence[Sequence[float]]) -> NDArray[np.float64]:
    """Return the sum of each window's coefficients: how much of the bias it has."""
    return np.array([np.sum(window) for window in windows], dtype=np.float64)


def split_windows(
    values: NDArray[np.floating], n_channels: int, windows: Sequence[Sequence[float]]
) -> NDArray[np.float64]:
    """Return rows of features as (n_rows, n_windows, n_channels), or raise."""
    rows = np.asarray(values, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != len(windows) * n_channels:
        raise ValueError(
            f"expected rows of {len(windows)} windows of {n_channels} channels each, "
            f"(n_rows, {len(windows) * n_channels}), got shape {rows.shape}"
        )
    return rows.reshape(len(rows), len(windows), n_channels)
