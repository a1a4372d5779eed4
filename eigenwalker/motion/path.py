"""The way a walk takes over the floor: where it is steady, where it leads, and how fast.

All functions work on plain arrays, time first, in metres and seconds.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.fourier import SEARCH_HARMONICS
from eigenwalker.motion.runs import longest_run

__all__ = ["Path", "fit_path", "n_path_terms", "stance_speed", "steady_stretch", "swing_direction"]


class Path(NamedTuple):
    """A smooth path over the floor, and the sway about it.

    Parameters
    ----------
    points : ndarray of shape (n_frames, 2)
        The polynomial, in metres.
    velocity : ndarray of shape (2,)
        Its mean velocity, in m/s.
    residual : float
        Root mean square distance, in metres, from path plus harmonics to the walk.
    """

    points: NDArray[np.float64]
    velocity: NDArray[np.float64]
    residual: float


def n_path_terms(n_strides: float) -> int:
    """Return how many polynomial coefficients a path of so many strides gets: one in three strides, 2 to 6."""
    return max(2, min(6, int(2 + n_strides / 3)))


def fit_path(floor_points: NDArray[np.floating], frame_rate: float, frequency: float) -> Path:
    """Return the smooth path under a swaying walk.

    A polynomial in time and 4 harmonics of the stride are fitted together by least squares, so that the sway of a
    stride does not bend the path; the path is the polynomial alone.

    Parameters
    ----------
    floor_points : ndarray of shape (n_frames, 2)
        x and y of the pelvis, in metres.
    frame_rate, frequency : float
        Frames and strides per second.

    Returns
    -------
    Path
    """
    n_frames = len(floor_points)
    n_strides = n_frames * frequency / frame_rate
    n_terms = n_path_terms(n_strides)
    # Below one and a half strides the higher harmonics and the polynomial cannot be told apart.
    n_harmonics = SEARCH_HARMONICS if n_strides >= 1.5 else 2
    n_harmonics = max(1, min(n_harmonics, int(0.45 * frame_rate / frequency)))
    line = np.linspace(-1.0, 1.0, n_frames)
    polynomial = np.polynomial.legendre.legvander(line, n_terms - 1)
    angles = 2 * np.pi * frequency / frame_rate * np.outer(np.arange(n_frames), np.arange(1, n_harmonics + 1))
    basis = np.hstack((polynomial, np.sin(angles), np.cos(angles)))
    coefficients = np.linalg.lstsq(basis, floor_points)[0]
    points = polynomial @ coefficients[:n_terms]
    rest = floor_points - basis @ coefficients
    duration = max(n_frames - 1, 1) / frame_rate
    return Path(points, (points[-1] - points[0]) / duration, float(np.sqrt((rest**2).sum(axis=1).mean())))


def steady_stretch(
    floor_points: NDArray[np.floating], frame_rate: float, frequency: float, *, tolerance: float = 0.2
) -> slice:
    """Return the longest stretch of frames around which the speed over the floor stays near its median.

    The speed of a frame is that of the mean position over the stride around it, so that half a stride at either
    end, where no such mean exists, is never part of the stretch.

    Parameters
    ----------
    floor_points : ndarray of shape (n_frames, 2)
        x and y of the pelvis, in metres.
    frame_rate, frequency : float
        Frames and strides per second.
    tolerance : float, default 0.2
        Largest share of the median by which the speed may differ from it.

    Returns
    -------
    slice
    """
    window = min(round(frame_rate / frequency), len(floor_points) - 2)
    if window < 1:
        return slice(0, len(floor_points))
    sums = np.vstack((np.zeros(2), np.cumsum(floor_points, axis=0)))
    means = (sums[window:] - sums[:-window]) / window  # (n_frames - window + 1, 2), centered on its window
    speed = np.hypot(*np.gradient(means, 1 / frame_rate, axis=0).T)
    median = np.median(speed)
    first, last = longest_run(np.abs(speed - median) <= tolerance * median)
    return slice(first + window // 2, last + window // 2)


def swing_direction(leg_difference: NDArray[np.floating], leftward: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the unit vector over the floor along which the legs swing, for walks that stay in place.

    Parameters
    ----------
    leg_difference : ndarray of shape (n_frames, 2)
        Left minus right ankle, x and y.
    leftward : ndarray of shape (2,)
        From right to left hip; tells front from back, because left is 90 degrees counter-clockwise of forward.

    Returns
    -------
    ndarray of shape (2,)
    """
    swing = leg_difference - leg_difference.mean(axis=0)
    direction = np.linalg.eigh(swing.T @ swing)[1][:, -1]
    forward = np.array([leftward[1], -leftward[0]])
    return direction if direction @ forward >= 0 else -direction


def stance_speed(left: NDArray[np.floating], right: NDArray[np.floating], frame_rate: float) -> float:
    """Return the speed of the belt under a walk in place, from the feet that stand on it, in m/s.

    The stance foot is the one that moves backward against the other; the median of its velocity is taken. Because the
    ankle rolls forward over the foot at both ends of stance, the result is some 5 % low.

    Parameters
    ----------
    left, right : ndarray of shape (n_frames,)
        Forward position of the ankles, in metres.
    frame_rate : float
        Frames per second.
    """
    if len(left) < 2:
        return float("nan")
    velocities = np.gradient(np.column_stack((left, right)), 1 / frame_rate, axis=0)
    return float(np.median(-velocities.min(axis=1)))
