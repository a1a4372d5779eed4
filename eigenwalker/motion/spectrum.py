"""Amplitude spectra of walks (Tilmanne & Dutoit 2012, Fig. 1 and 2)."""

import numpy as np
import pandas as pd

from eigenwalker._validation import check_finite
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["spectrum"]


def spectrum(walk: Walk | JointWalk, *, max_frequency: float | None = None) -> pd.DataFrame:
    r"""Return the amplitude of each channel of a walk at each frequency that its length resolves.

    .. math:: A(0) = |\bar x|, \qquad A(f_j) = \frac{2}{N} \left| \sum_{k=0}^{N-1} x_k e^{-2 \pi i j k / N} \right|

    at f_j = j frame_rate / N, the discrete Fourier transform: a cosine of amplitude A that fits into the recording a
    whole number of times has A at its frequency, and nothing elsewhere. Others leak into their neighbors.

    Parameters
    ----------
    walk : Walk or JointWalk
        Without gaps; in place, else its path over the floor drowns everything.
    max_frequency : float, default None
        In hertz; higher ones are left out. None is half the frame rate.

    Returns
    -------
    DataFrame
        One row a frequency in hertz, one column a channel, in the channel's unit.

    Raises
    ------
    WalkError
        If there are values that are not finite.
    ValueError
        If `max_frequency` is not positive.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import spectrum
    >>> walk = make_walkers(1, random_state=0).data[0]
    >>> ankle = spectrum(walk, max_frequency=3.0)["left_ankle_x"]
    >>> bool(0.7 < ankle.idxmax() < 1.3)
    True
    """
    if max_frequency is not None and not max_frequency > 0:
        raise ValueError(f"max_frequency must be positive, in hertz, got {max_frequency!r}")
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    frequencies = np.fft.rfftfreq(walk.n_frames, 1 / walk.frame_rate)
    amplitudes = np.abs(np.fft.rfft(np.asarray(walk.channels, dtype=np.float64), axis=0)) / walk.n_frames
    # All but the mean, and the highest of an even number, are there twice, at plus and minus the frequency.
    amplitudes[1 : len(amplitudes) - (walk.n_frames % 2 == 0)] *= 2
    kept = frequencies <= (np.inf if max_frequency is None else max_frequency)
    index = pd.Index(frequencies[kept], name="frequency")
    return pd.DataFrame(amplitudes[kept], index=index, columns=list(walk.channel_names))
