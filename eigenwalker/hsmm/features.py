"""Static channels and their dynamics: the observations of a gait model (Tilmanne et al. 2012, Eq. 2 to 4).

A window is its coefficients on consecutive frames, as many before the frame as after it, so that an observation is

    o_t = (c_t, delta c_t, delta2 c_t)

and O = W C with W made of the windows. Walks must have one frame rate: dynamics per frame of another rate are others.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["NEIGHBOR_WINDOWS", "WINDOWS", "append_dynamics", "whole_frames"]

WINDOWS = (
    (1.0,),  # static
    (-0.5, 0.0, 0.5),  # Eq. 2: (c[t+1] - c[t-1]) / 2
    (0.25, 0.0, -0.5, 0.0, 0.25),  # Eq. 3: (c[t+2] - 2 c[t] + c[t-2]) / 4, which steps over every other frame
)
"""Those of the paper. They do not couple even and odd frames, which part in what is generated, see `generation`."""

NEIGHBOR_WINDOWS = (*WINDOWS[:2], (1.0, -2.0, 1.0))
"""With the second difference of neighboring frames, c[t+1] - 2 c[t] + c[t-1], as HTS has it: couples all frames."""


def append_dynamics(
    channels: NDArray[np.floating], *, windows: Sequence[Sequence[float]] = WINDOWS
) -> NDArray[np.float64]:
    """Return static channels followed by their derivatives in time.

    Frames at the edges, whose windows reach over the end of the walk, have no dynamics: they are NaN, which the
    functions of this part take as not observed. (HTS repeats the first and last frame, which halves the speed there.)

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        Exponential maps or whatever else is modeled.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of each window, an odd number of them; static, delta and delta2 by default.

    Returns
    -------
    ndarray of shape (n_frames, n_windows * n_channels)
        All channels of the first window, then all of the second, and so on.

    Raises
    ------
    ValueError
        If a window has an even number of coefficients.

    References
    ----------
    Tilmanne, Moinet & Dutoit 2012, Eq. 2 to 4. The order of their 162 values is that of the windows, as here.

    Examples
    --------
    >>> import numpy as np
    >>> append_dynamics(np.arange(5.0)[:, None] ** 2)
    array([[ 0., nan, nan],
           [ 1.,  2., nan],
           [ 4.,  4.,  2.],
           [ 9.,  6., nan],
           [16., nan, nan]])
    """
    channels = np.asarray(channels, dtype=np.float64)
    whole = whole_frames(len(channels), windows=windows)
    n_frames, n_channels = channels.shape
    observations = np.full((n_frames, len(windows), n_channels), np.nan)
    for position, window in enumerate(windows):
        frames = np.flatnonzero(whole[:, position])
        reach = len(window) // 2
        observations[frames, position] = sum(
            weight * channels[frames + offset] for offset, weight in enumerate(window, -reach)
        )
    return observations.reshape(n_frames, -1)  # (n_frames, n_windows * n_channels)


def whole_frames(n_frames: int, *, windows: Sequence[Sequence[float]] = WINDOWS) -> NDArray[np.bool_]:
    """Return in which frames each window lies within the walk.

    Parameters
    ----------
    n_frames : int
        Length of the walk.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of each window, an odd number of them.

    Returns
    -------
    ndarray of bool of shape (n_frames, n_windows)

    Raises
    ------
    ValueError
        If a window has an even number of coefficients.

    Examples
    --------
    >>> whole_frames(4)[:, 1]
    array([False,  True,  True, False])
    """
    even = [tuple(window) for window in windows if len(window) % 2 == 0]
    if even:
        raise ValueError(f"windows must have an odd number of coefficients, centered on the frame, got {even}")
    frames = np.arange(n_frames)[:, np.newaxis]
    reach = np.array([len(window) // 2 for window in windows])
    return (frames >= reach) & (frames < n_frames - reach)
