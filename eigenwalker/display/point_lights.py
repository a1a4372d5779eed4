r"""Dots that each run along a path of their own: where they are, how far their paths reach, and their mirror image.

Dot i of a display is at

.. math:: p_i(t) = m_i + v_i t + \sum_{k=1}^{K} s_{ik} \sin(k \theta_i) + c_{ik} \cos(k \theta_i), \quad
          \theta_i = 2 \pi (f_i t + \varphi_i)

with its mean m, velocity v, harmonics s and c, frequency f in hertz and phase in strides: Troje 2002, Eq. 1, with a
frequency and a phase for each dot. Coefficients are arrays of shape (2 K + 1, n_dots, n_axes) with the rows mean, sin1,
cos1, ... All functions work on plain arrays.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.display._numbers import check_number
from eigenwalker.display.body import project

__all__ = ["Reach", "evaluate_dots", "frame_times", "path_reach", "reflect", "view_axes"]

_SAMPLES = 720  # of one stride; the fourth harmonic's extremes are then right to 0.02 % of its amplitude


class Reach(NamedTuple):
    """How far paths reach, without their velocity.

    Parameters
    ----------
    lowest, highest : ndarray of shape (n_dots, n_axes)
        In the unit of the coefficients.
    """

    lowest: NDArray[np.float64]
    highest: NDArray[np.float64]

    @property
    def box(self) -> NDArray[np.float64]:
        """The box that all paths together fill, from its lowest to its highest corner, shape (2, n_axes)."""
        return np.stack((self.lowest.min(axis=0), self.highest.max(axis=0)))


def evaluate_dots(
    coefficients: NDArray[np.floating],
    frequencies: NDArray[np.floating],
    phases: NDArray[np.floating],
    times: NDArray[np.floating],
) -> NDArray[np.float64]:
    """Return where dots are, without their velocity.

    Parameters
    ----------
    coefficients : ndarray of shape (2 K + 1, n_dots, n_axes)
        Rows mean, sin1, cos1, ...
    frequencies : ndarray of shape (n_dots,)
        Of the fundamental, in hertz.
    phases : ndarray of shape (n_dots,)
        At time zero, in strides: 0.25 is a quarter of a stride further on.
    times : ndarray of shape (n_times,)
        In seconds.

    Returns
    -------
    ndarray of shape (n_times, n_dots, n_axes)
        Each a function of its own time alone, so that it does not matter which other times are asked for.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.display.point_lights import evaluate_dots
    >>> one_dot = np.array([[[5.0]], [[1.0]], [[0.0]]])  # mean, sin1, cos1
    >>> evaluate_dots(one_dot, np.array([2.0]), np.array([0.25]), np.array([0.0, 0.25])).ravel().round(12)
    array([6., 4.])
    """
    angles = 2 * np.pi * (np.multiply.outer(times, frequencies) + phases)  # (n_times, n_dots)
    positions = np.tile(np.asarray(coefficients[0], dtype=np.float64), (len(angles), 1, 1))
    for k in range(1, len(coefficients) // 2 + 1):
        positions += np.sin(k * angles)[..., np.newaxis] * coefficients[2 * k - 1]
        positions += np.cos(k * angles)[..., np.newaxis] * coefficients[2 * k]
    return positions


def path_reach(coefficients: NDArray[np.floating]) -> Reach:
    """Return how far the paths of dots reach over a stride.

    Parameters
    ----------
    coefficients : ndarray of shape (2 K + 1, n_dots, n_axes)
        Rows mean, sin1, cos1, ...

    Returns
    -------
    Reach
        From 720 points of each path.
    """
    n_dots = coefficients.shape[1]
    phases = np.arange(_SAMPLES) / _SAMPLES
    positions = evaluate_dots(coefficients, np.ones(n_dots), np.zeros(n_dots), phases)
    return Reach(positions.min(axis=0), positions.max(axis=0))


def reflect(vectors: NDArray[np.floating], normal: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return vectors, shape (..., 3), mirrored in the plane through zero with a unit normal: p - 2 (p . n) n."""
    return vectors - 2 * (vectors @ normal)[..., np.newaxis] * normal


def view_axes(azimuth: float, elevation: float) -> NDArray[np.float64]:
    """Return the axes of an observer's picture in those of the walker.

    Parameters
    ----------
    azimuth : float
        Where the observer stands, in degrees, as for `project`: 0 in front, 90 at the walker's right side.
    elevation : float
        How far above the walker's horizon the observer is, in degrees; at 90 it looks down on the head.

    Returns
    -------
    ndarray of shape (3, 3)
        Unit vectors to the right, up and towards the observer, one a row.

    Examples
    --------
    >>> from eigenwalker.display.point_lights import view_axes
    >>> view_axes(0, 90).round(12) + 0
    array([[ 0.,  1.,  0.],
           [-1.,  0.,  0.],
           [ 0.,  0.,  1.]])
    """
    right, up, near = project(np.eye(3), azimuth).T
    tilt = np.deg2rad(elevation)
    return np.stack((right, np.cos(tilt) * up - np.sin(tilt) * near, np.cos(tilt) * near + np.sin(tilt) * up))


def frame_times(duration: float, rate: float) -> NDArray[np.float64]:
    """Return the times i / rate of the frames of a duration, in seconds, shape (n_frames,)."""
    rate = check_number(rate, "rate", above=0, unit="frames per second")
    duration = check_number(duration, "duration", above=0, unit="seconds")
    n_frames = round(duration * rate)
    if n_frames == 0:
        raise ValueError(f"duration must hold at least one frame, got {duration:g} s at {rate:g} frames per second")
    return np.arange(n_frames) / rate
