"""Transforms that mix only channels of one block, such as the three of a joint: as many small problems.

With A block diagonal log |det A| is the sum over blocks, and so the objective of `transform_statistics` falls apart
into one for each, with the rows and columns of G_i and k_i that belong to it. Few frames determine a small block.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigenwalker.hsmm.transform_estimation import StandardUnits, estimate_transform
from eigenwalker.hsmm.transform_statistics import TransformStatistics
from eigenwalker.hsmm.transforms import ChannelTransform

__all__ = ["estimate_blocks"]


def estimate_blocks(
    statistics: TransformStatistics,
    blocks: Sequence[NDArray[np.integer]],
    *,
    center: ChannelTransform,
    start: ChannelTransform | None = None,
    units: StandardUnits | None = None,
    **settings: Any,
) -> ChannelTransform:
    """Return the block diagonal transform of largest posterior density.

    Parameters
    ----------
    statistics : TransformStatistics
        Of the frames that share the transform.
    blocks : sequence of ndarray of int
        The channels of each block; each channel is in one of them. One block of all is `estimate_transform`.
    center, start : ChannelTransform
        As of `estimate_transform`, block diagonal as well.
    units, **settings
        As of `estimate_transform`.

    Returns
    -------
    ChannelTransform

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.hsmm.transform_statistics import accumulate_transform
    >>> from eigenwalker.hsmm.transforms import identity_transform
    >>> channels = np.random.default_rng(0).normal(size=(50, 2)) @ [[2.0, 0.3], [0.0, 0.5]]
    >>> statistics = accumulate_transform(
    ...     channels, np.ones((50, 1)), states=[0], means=np.zeros((1, 2)), variances=np.ones((1, 2)), windows=((1.0,),)
    ... )
    >>> single = [np.array([0]), np.array([1])]
    >>> found = estimate_blocks(statistics, single, center=identity_transform(2))
    >>> (found.matrix @ channels.T).std(axis=1).round(6)  # each by itself to a variance of 1
    array([1., 1.])
    """
    matrix, bias = np.zeros_like(center.matrix), np.zeros_like(center.bias)
    for block in blocks:
        inside = np.ix_(block, block)
        part = estimate_transform(
            _select_channels(statistics, block),
            center=_select(center, block),
            start=None if start is None else _select(start, block),
            units=None if units is None else StandardUnits(units.origin[block], units.scales[block]),
            **settings,
        )
        matrix[inside], bias[block] = part
    return ChannelTransform(matrix, bias)


def _select(transform: ChannelTransform, block: NDArray[np.integer]) -> ChannelTransform:
    return ChannelTransform(transform.matrix[np.ix_(block, block)], transform.bias[block])


def _select_channels(statistics: TransformStatistics, block: NDArray[np.integer]) -> TransformStatistics:
    """Return the sums of some channels, and of the bias."""
    columns = np.append(block, statistics.linear.shape[2] - 1)
    return statistics._replace(
        quadratic=statistics.quadratic[:, block][:, :, columns[:, np.newaxis], columns],
        linear=statistics.linear[:, block[:, np.newaxis], columns],
    )
