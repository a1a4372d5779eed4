"""The rotation and translation that carry a rigid body from one place to others."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import check_array

__all__ = ["fit_rigid"]

_FLAT = 1e-6  # second singular value over the first, below which points lie on one line


def fit_rigid(source: ArrayLike, target: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    r"""Return the rigid motion that brings points nearest to where they are in each frame, by least squares.

    .. math:: \min_{R_t, d_t} \sum_i \| R_t a_i + d_t - b_{ti} \|^2, \quad R_t^\top R_t = 1, \det R_t = 1

    for the points a_i of `source` and b_ti of `target` in frame t. With the singular value decomposition
    U S V' of the centred sum of b_ti a_i', R_t = U diag(1, 1, det(U V')) V', so that a body is never
    turned inside out (Kabsch 1978, Acta Crystallogr. A 34, 827-828; Söderkvist & Wedin 1993, J. Biomech. 26,
    1473-1477).

    Parameters
    ----------
    source : array-like of shape (n_points, 3)
        The points of the body in one place. At least three that are not on one line.
    target : array-like of shape (n_frames, n_points, 3)
        The same points in each frame.

    Returns
    -------
    rotation : ndarray of shape (n_frames, 3, 3)
        ``source @ rotation[t].T + translation[t]`` is nearest to ``target[t]``.
    translation : ndarray of shape (n_frames, 3)
        In the unit of the points. Both are NaN in frames where a point is NaN or the points have run together on
        one line.

    Raises
    ------
    ValueError
        If a point of `source` is not finite or all are on one line, or if the shapes do not fit.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import fit_rigid
    >>> triangle = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.1, 0.0]])
    >>> rotation, translation = fit_rigid(triangle, triangle[np.newaxis] + [1.0, 2.0, 3.0])
    >>> rotation[0].round(9) + 0.0
    array([[1., 0., 0.],
           [0., 1., 0.],
           [0., 0., 1.]])
    >>> translation.round(9)
    array([[1., 2., 3.]])
    """
    source = np.asarray(check_array(source, shape=("n_points", 3), name="source"), dtype=np.float64)
    target = np.asarray(check_array(target, shape=("n_frames", len(source), 3), name="target"), dtype=np.float64)
    _check_spread(source)
    known = np.isfinite(target).all(axis=(1, 2))
    rotation, translation = np.full((len(target), 3, 3), np.nan), np.full((len(target), 3), np.nan)
    rotation[known] = _rotations(source - source.mean(axis=0), target[known])
    translation[known] = target[known].mean(axis=1) - rotation[known] @ source.mean(axis=0)
    return rotation, translation


def _check_spread(source: NDArray[np.float64]) -> None:
    """Raise unless the points lie in a plane or in space: about a line, a body may turn unseen."""
    if not np.isfinite(source).all():
        raise ValueError("source must be finite, got NaN or infinite values; take a frame with every point known")
    if len(source) < 3:
        raise ValueError(f"source must have at least three points, got {len(source)}")
    spread = np.linalg.svd(source - source.mean(axis=0), compute_uv=False)
    if spread[1] <= _FLAT * spread[0]:
        raise ValueError("source must have three points that are not on one line, got points on one line; add another")


def _rotations(centered: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation of each frame; NaN where the points are on one line there."""
    moved = target - target.mean(axis=1, keepdims=True)
    left, spread, right = np.linalg.svd(np.swapaxes(moved, 1, 2) @ centered)  # (n_frames, 3, 3) of b a'
    left[:, :, 2] *= np.linalg.det(left @ right)[:, np.newaxis]
    rotation = left @ right
    rotation[spread[:, 1] <= _FLAT * spread[:, 0]] = np.nan
    return rotation
