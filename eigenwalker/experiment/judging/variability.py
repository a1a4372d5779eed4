"""How much walks vary, over time and from stride to stride; and walks cut to one length to be compared."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import check_walks
from eigenwalker.motion.clip import cut
from eigenwalker.motion.stride_statistics import stride_features
from eigenwalker.motion.template import check_alike, one_frame
from eigenwalker.motion.walk import AnyWalk, JointWalk, Walk

__all__ = ["StrideVariability", "cut_alike", "stride_variability", "variance_ratio"]

_Walks = Sequence[Walk | JointWalk]


class StrideVariability(NamedTuple):
    """How single strides of a walk differ.

    Parameters
    ----------
    motion : float
        Standard deviation over strides of what a channel does at one phase, the root of the mean square over phases and
        channels, in radians of joint walks or metres.
    duration : float
        Standard deviation over strides of their duration, over its mean.
    """

    motion: float
    duration: float


def stride_variability(walk: Walk | JointWalk, *, n_harmonics: int = 3) -> StrideVariability:
    r"""Return how single strides of a walk differ from each other.

    With the coefficients p_0, s_k and c_k of each stride and channel:

    .. math:: motion^2 = \overline{var(p_0) + \tfrac{1}{2} \sum_k var(s_k) + var(c_k)}

    Parameters
    ----------
    walk : Walk or JointWalk
        Prepared, without its path over the floor, without its first and last steps.
    n_harmonics : int, default 3
        Of each stride. What is faster is noise.

    Returns
    -------
    StrideVariability
        NaN where there are fewer than two whole strides.

    Raises
    ------
    WalkError
        If the walk has no period, or a stride has too few frames for the harmonics.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import stride_variability
    >>> bool(stride_variability(make_walkers(1, random_state=0).data[0]).duration < 0.1)
    True
    """
    features = stride_features(walk, n_harmonics, "auto")
    if len(features) < 2:
        return StrideVariability(float("nan"), float("nan"))
    variances = features.var(axis=0, ddof=1)
    waves = variances[:-1].reshape(2 * n_harmonics + 1, -1)  # (n_features - 1) -> (2 K + 1, n_channels)
    weights = np.concatenate(([1.0], np.full(2 * n_harmonics, 0.5)))
    return StrideVariability(float(np.sqrt((weights @ waves).mean())), float(np.sqrt(variances[-1])))


def variance_ratio(synthetics: _Walks, originals: _Walks, *, least: float = np.pi / 180) -> NDArray[np.float64]:
    """Return the variance over time of each channel of synthetic walks over that of original ones.

    Parameters
    ----------
    synthetics, originals : list of Walk or JointWalk
        Prepared alike; their variances are averaged over walks.
    least : float, default pi / 180
        Channels whose standard deviation in the original walks is not above it are left out: 1 degree, in radians.

    Returns
    -------
    ndarray of shape (n_moving_channels,)
        Below 1 where synthesis is too smooth. Empty where nothing moves.

    Raises
    ------
    WalkError
        If walks differ in their channels.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import variance_ratio
    >>> walks = make_walkers(2, random_state=0).data
    >>> float(variance_ratio(walks, walks, least=0.01).mean())
    1.0
    """
    series = [check_walks(walks, kind=(Walk, JointWalk)) for walks in (synthetics, originals)]
    check_alike([*series[0], *series[1]], one_frame(series[1][0]))
    ours, theirs = (np.mean([np.var(walk.channels, axis=0) for walk in walks], axis=0) for walks in series)
    moving = theirs > least**2
    return np.asarray(ours[moving] / theirs[moving], dtype=np.float64)


def cut_alike(walks: _Walks, *, duration: float | None = None) -> list[Any]:
    """Return the middle of each walk, all of the same duration, so that none shows more of its motion than another.

    Parameters
    ----------
    walks : list of Walk or JointWalk
        Prepared, recorded and synthetic ones together.
    duration : float, default None
        In seconds; walks that are shorter stay as they are. None is that of the shortest.

    Returns
    -------
    list of Walk or JointWalk

    Raises
    ------
    ValueError
        If the duration is not positive.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import cut_alike
    >>> [walk.n_frames for walk in cut_alike(make_walkers(2, random_state=0).data, duration=2.0)]
    [240, 240]
    """
    known = check_walks(walks, kind=(Walk, JointWalk))
    shortest = min(walk.duration for walk in known) if duration is None else duration
    if not shortest > 0:
        raise ValueError(f"duration must be positive, in seconds, got {duration!r}")
    return [_middle(walk, shortest) for walk in known]


def _middle(walk: AnyWalk, duration: float) -> AnyWalk:
    n_frames = min(walk.n_frames, round(duration * walk.frame_rate))
    start = (walk.n_frames - n_frames) // 2
    return cut(walk, slice(start, start + n_frames))
