"""Harmonics by projection on sines and cosines (Tilmanne & Dutoit 2012), beside which `fit_harmonics` is exact."""

import numpy as np
from numpy.typing import NDArray

from eigenwalker.motion.fourier import check_sampling

__all__ = ["project_harmonics"]


def project_harmonics(
    channels: NDArray[np.floating], frame_rate: float, frequency: float, n_harmonics: int = 2
) -> NDArray[np.float64]:
    r"""Return the coefficients of a harmonic series by projection (Tilmanne & Dutoit 2012, Eq. 2 to 6).

    .. math::
        p_0 = \frac{1}{N} \sum_{k=0}^{N-1} x_k, \qquad
        c_l = \frac{1}{N} \sum_{k=0}^{N-1} x_k e^{-i l \omega_0 k / r}, \qquad
        p_l = 2 |c_l|, \qquad \phi_l = \mathrm{atan2}(\mathrm{Im}\, c_l, \mathrm{Re}\, c_l)

    with the frame rate r. As p cos(l omega t + phi) = p cos(phi) cos(l omega t) - p sin(phi) sin(l omega t), the
    coefficients of sine and cosine are -p_l sin(phi_l) and p_l cos(phi_l). They are the least-squares ones of
    `fit_harmonics` on whole numbers of cycles. On others sines, cosines and the constant are not orthogonal, and
    the projection is biased, the more the larger the mean: of 175 recorded walks of 5 to 14 s, two harmonics of joint
    angles differ by 0.8 degrees in the median and by 1.9 at worst (root mean square) and explain 0.861 of the power in
    place of 0.875; two harmonics of positions, up to 1.7 m from their origin, explain 0.75 in place of 0.95.

    The source prints k where k / r is meant; counts from k = 1, which shifts the phase by a frame, where this counts
    from the first frame; and prints the arc tangent of the quotient, which loses the quadrant.

    Parameters
    ----------
    channels : ndarray of shape (n_frames, n_channels)
        The walk.
    frame_rate : float
        Frames per second.
    frequency : float
        Fundamental frequency in hertz; the source takes that of the steps, `step_frequency`.
    n_harmonics : int, default 2
        Number K of harmonics, the fundamental included.

    Returns
    -------
    ndarray of shape (2 K + 1, n_channels)
        Rows mean, sin1, cos1, ..., with time zero in the first frame.

    Raises
    ------
    ValueError
        If there are fewer frames than coefficients, or if harmonic K reaches half the frame rate.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import project_harmonics
    >>> t = np.arange(120) / 60
    >>> project_harmonics(1 + 2 * np.sin(2 * np.pi * t)[:, None], 60, 1.0, 1).round(6).ravel() + 0
    array([1., 2., 0.])
    """
    channels = np.asarray(channels, dtype=np.float64)
    check_sampling(len(channels), frame_rate, frequency, n_harmonics)
    angles = 2 * np.pi * frequency / frame_rate * np.outer(np.arange(1, n_harmonics + 1), np.arange(len(channels)))
    projected = np.exp(-1j * angles) @ channels / len(channels)  # Eq. 3 and 4, shape (K, n_channels)
    amplitude, phase = 2 * np.abs(projected), np.angle(projected)  # Eq. 5 and 6
    coefficients = np.empty((2 * n_harmonics + 1, channels.shape[1]))
    coefficients[0] = channels.mean(axis=0)  # Eq. 2
    coefficients[1::2], coefficients[2::2] = -amplitude * np.sin(phase), amplitude * np.cos(phase)
    return coefficients
