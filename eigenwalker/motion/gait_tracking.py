"""Where in its stride a recording is at every moment, starts, stops and standing included, and where it heads."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from eigenwalker.motion.support import smooth_step

__all__ = ["GaitTrack", "Wave", "local_wave", "track_gait"]

_STANDING, _WALKING = 0.2, 0.7  # of the steady swing of the legs: nothing below is walked, all above


class Wave(NamedTuple):
    """The sine that a signal is around each moment; arrays of shape (n_frames,).

    Parameters
    ----------
    mean : ndarray
        What it swings about.
    amplitude : ndarray
        How far.
    phase : ndarray
        In radians, without jumps; zero, and whole turns, where it is largest.
    """

    mean: NDArray[np.float64]
    amplitude: NDArray[np.float64]
    phase: NDArray[np.float64]


class GaitTrack(NamedTuple):
    """What `track_gait` returns; arrays of shape (n_frames,).

    Parameters
    ----------
    phase : ndarray
        In radians, rising by 2 pi a stride; whole turns are where the phase reference is largest.
    share : ndarray
        How much the legs swing: 1 while the walk walks, 0 while it stands, smooth between.
    heading : ndarray
        Where it leads, in radians to the left of x.
    """

    phase: NDArray[np.float64]
    share: NDArray[np.float64]
    heading: NDArray[np.float64]


def local_wave(signal: NDArray[np.floating], step: float) -> Wave:
    """Return mean, amplitude and phase of a signal around each moment.

    About each frame a mean and one sine are fitted to a stride on either side, with Hann's weights. Weighted least
    squares need no signal beyond the ends: a steady sine is found there as it is inside.

    Parameters
    ----------
    signal : ndarray of shape (n_frames,)
        At least a stride.
    step : float
        By how much the phase rises in a frame, about, in radians.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion.gait_tracking import local_wave
    >>> mean, amplitude, phase = local_wave(1 + 2 * np.cos(0.1 * np.arange(200) - 0.3), 0.1)
    >>> mean[[0, 99]].round(6), amplitude[[0, 99]].round(6), phase[:1].round(6)
    (array([1., 1.]), array([2., 2.]), array([-0.3]))
    """
    half = round(2 * np.pi / step)  # frames of a stride
    window = np.hanning(2 * half + 3)[1:-1]  # without the zeros at its ends
    angles = step * np.arange(len(signal))
    basis = np.column_stack((np.ones(len(signal)), np.cos(angles), np.sin(angles)))
    products = (basis[:, :, np.newaxis] * basis[:, np.newaxis]).reshape(-1, 9)  # (n_frames, 3, 3) -> (n_frames, 9)
    sums = fftconvolve(
        np.hstack((products, basis * np.reshape(signal, (-1, 1)))), window[:, np.newaxis], mode="full", axes=0
    )[half : half + len(signal)]
    gram, right = sums[:, :9].reshape(-1, 3, 3), sums[:, 9:, np.newaxis]
    mean, cosine, sine = np.linalg.solve(gram, right)[..., 0].T
    return Wave(mean, np.hypot(cosine, sine), angles + np.unwrap(np.arctan2(-sine, cosine)))


def track_gait(
    reference: NDArray[np.floating], yaw: NDArray[np.floating], step: float, *, steady: slice, heading: float
) -> GaitTrack:
    """Return where in its stride a recording is, how much it walks, and where it heads, in every frame.

    Parameters
    ----------
    reference : ndarray of shape (n_frames,)
        The phase reference, left minus right hip flexion.
    yaw : ndarray of shape (n_frames,)
        Where the pelvis faces, in radians to the left of x, without jumps.
    step : float
        By how much the phase rises in a frame of the steady stretch, in radians.
    steady : slice
        The frames of the steady stretch.
    heading : float
        Where the walk leads there, in radians to the left of x. Elsewhere it turns as the pelvis does, apart from its
        swing.
    """
    wave, facing = local_wave(reference, step), local_wave(yaw, step).mean
    shares = wave.amplitude / np.median(wave.amplitude[steady])
    walked = smooth_step((shares - _STANDING) / (_WALKING - _STANDING))
    return GaitTrack(wave.phase, walked, heading + facing - facing[steady].mean())
