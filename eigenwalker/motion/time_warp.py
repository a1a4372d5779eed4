"""A recording at another pace, where it walks and not where it stands."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from eigenwalker.motion.filtering import along_time, resample_paths
from eigenwalker.motion.walk import JointWalk

__all__ = ["warp_time", "warped_frames"]

_LEAP = 1.0  # radians or metres from one frame to the next


def warped_frames(paces: NDArray[np.floating]) -> NDArray[np.float64]:
    r"""Return which moment of a recording each frame of it shows when it is played at a pace that varies.

    Time t of the recording is reached at :math:`t'(t) = \int_0^t du / r(u)` with the pace r; returned is its inverse
    at whole frames, as far as the recording reaches.

    Parameters
    ----------
    paces : ndarray of shape (n_frames,)
        Pace in each frame of the recording; 1.2 is faster by a fifth. Positive.

    Returns
    -------
    ndarray of shape (n_new_frames,)
        In frames of the recording, rising, from 0 on. Where the pace is 1 throughout they are its own frames.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion.time_warp import warped_frames
    >>> warped_frames(np.full(9, 2.0)).round(6)
    array([0., 2., 4., 6., 8.])
    """
    frames = np.arange(len(paces), dtype=np.float64)
    slowness = 1.0 / np.asarray(paces, dtype=np.float64)
    reached = np.concatenate(([0.0], np.cumsum((slowness[1:] + slowness[:-1]) / 2)))
    wanted = np.arange(int(reached[-1] + 1e-6) + 1, dtype=np.float64)
    sources = make_interp_spline(reached, frames, k=min(3, len(frames) - 1))(wanted)
    return np.clip(sources, 0.0, frames[-1])  # the ends, against rounding


def warp_time(walk: JointWalk, sources: NDArray[np.float64]) -> JointWalk:
    """Return a walk that shows, frame by frame, other moments of itself: all joints and paths move along.

    Parameters
    ----------
    walk : JointWalk
        Of 6 frames or more.
    sources : ndarray of shape (n_new_frames,)
        From `warped_frames`. Between its frames a walk lies on the quintic spline through all of them. What leaps from
        one to the next, by more than a radian or a metre, as thumbs do for which markers were mixed up, would make a
        spline ring; it goes there straight.
    """
    warped = along_time(walk, lambda paths: _shown(paths, sources))
    shown = np.arange(len(sources), dtype=np.float64)
    times = [float(np.interp(event.time * walk.frame_rate, sources, shown)) / walk.frame_rate for event in walk.events]
    return replace(
        warped, events=tuple(event._replace(time=time) for event, time in zip(walk.events, times, strict=True))
    )


def _shown(paths: NDArray[np.float64], sources: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return paths, shape (n_frames, n_paths), at moments in frames."""
    shown = resample_paths(paths, sources)
    leaping = np.abs(np.diff(paths, axis=0)).max(axis=0) > _LEAP
    if leaping.any():
        shown[:, leaping] = make_interp_spline(np.arange(len(paths)), paths[:, leaping], k=1)(sources)
    return shown
