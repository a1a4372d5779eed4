"""Rotations as exponential maps: from and to other forms, along time, and down a skeleton.

An exponential map is a vector r of three numbers: the axis r / |r| and the angle |r| in radians.
"""

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

__all__ = ["forward_kinematics", "rotvec_from_euler", "unroll_rotvec"]


def rotvec_from_euler(angles: ArrayLike, order: str) -> NDArray[np.float64]:
    """Return exponential maps of rotations about moving axes.

    The rotation is the product of one elementary rotation per letter, from left to right, as in BVH
    files: order "ZXY" is Rz Rx Ry, and a vector is turned about y first.

    Parameters
    ----------
    angles : array-like of shape (..., n_axes)
        In radians, in the order of the letters.
    order : str
        One of X, Y, Z per angle; from no letter up to any number of them.

    Returns
    -------
    ndarray of shape (..., 3)
        In radians, with a length of at most pi.

    Raises
    ------
    ValueError
        If `order` has other letters or its length differs from the last axis of `angles`.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import rotvec_from_euler
    >>> rotvec_from_euler([np.pi / 2, 0.0, 0.0], "ZXY").round(3)
    array([0.   , 0.   , 1.571])
    """
    angles = np.asarray(angles, dtype=np.float64)
    if set(order) - set("XYZ"):
        raise ValueError(f"order must consist of X, Y and Z, got {order!r}")
    if angles.ndim == 0 or angles.shape[-1] != len(order):
        raise ValueError(
            f"angles must have {len(order)} entries in the last axis, one a letter of {order!r}, "
            f"got shape {angles.shape}"
        )
    n_rotations = int(np.prod(angles.shape[:-1]))
    flat = np.ascontiguousarray(angles.reshape(n_rotations, len(order)))  # (..., n_axes) -> (n, n_axes)
    axes = np.array(["XYZ".index(letter) for letter in order], dtype=np.int64)
    return _rotvec_from_euler(flat, axes).reshape(*angles.shape[:-1], 3)


@njit(cache=True, nogil=True)
def _rotvec_from_euler(angles, axes):
    """Multiply one quaternion (w, x, y, z) a letter from the left to the right, and take the logarithm."""
    n_rotations, n_axes = angles.shape
    out = np.empty((n_rotations, 3))
    for i in range(n_rotations):
        w, x, y, z = 1.0, 0.0, 0.0, 0.0
        for j in range(n_axes):
            c = np.cos(0.5 * angles[i, j])
            s = np.sin(0.5 * angles[i, j])
            if axes[j] == 0:
                w, x, y, z = w * c - x * s, x * c + w * s, y * c + z * s, z * c - y * s
            elif axes[j] == 1:
                w, x, y, z = w * c - y * s, x * c - z * s, y * c + w * s, z * c + x * s
            else:
                w, x, y, z = w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s
        if w < 0:
            w, x, y, z = -w, -x, -y, -z
        sine = np.sqrt(x * x + y * y + z * z)
        scale = 2.0 if sine < 1e-12 else 2.0 * np.arctan2(sine, w) / sine
        out[i, 0] = scale * x
        out[i, 1] = scale * y
        out[i, 2] = scale * z
    return out


def unroll_rotvec(rotvec: ArrayLike) -> NDArray[np.float64]:
    r"""Return the same rotations as exponential maps without jumps from frame to frame.

    r and r (1 - 2 pi k / \\|r\\|) are the same rotation for every whole k. In each frame the one nearest
    to the frame before is taken.

    Parameters
    ----------
    rotvec : array-like of shape (n_frames, ..., 3)
        Exponential maps, time first, in radians.

    Returns
    -------
    ndarray of shape (n_frames, ..., 3)
        In radians, the first frame as it was.
    """
    rotvec = np.asarray(rotvec, dtype=np.float64)
    if rotvec.ndim < 2 or rotvec.shape[-1] != 3:
        raise ValueError(f"rotvec must have shape (n_frames, ..., 3), got {rotvec.shape}")
    return _unroll(rotvec.reshape(len(rotvec), -1, 3)).reshape(rotvec.shape)  # (n_frames, n, 3) inside


@njit(cache=True, nogil=True)
def _unroll(rotvec):
    n_frames, n_joints, _ = rotvec.shape
    out = rotvec.copy()
    turn = 2.0 * np.pi
    for joint in range(n_joints):
        for frame in range(1, n_frames):
            x, y, z = out[frame, joint]
            px, py, pz = out[frame - 1, joint]
            angle = np.sqrt(x * x + y * y + z * z)
            if angle < 1e-12:
                # The identity: any axis will do for a full turn, so the one before is kept.
                before = np.sqrt(px * px + py * py + pz * pz)
                if before > np.pi:
                    scale = turn * np.round(before / turn) / before
                    out[frame, joint, 0] = px * scale
                    out[frame, joint, 1] = py * scale
                    out[frame, joint, 2] = pz * scale
                continue
            along = (x * px + y * py + z * pz) / angle
            scale = 1.0 + turn * np.round((along - angle) / turn) / angle
            out[frame, joint, 0] = x * scale
            out[frame, joint, 1] = y * scale
            out[frame, joint, 2] = z * scale
    return out


def forward_kinematics(
    rotations: NDArray[np.floating], local_positions: NDArray[np.floating], parents: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions and frames of all joints in the room, for all frames at once.

    Parameters
    ----------
    rotations : ndarray of shape (n_frames, n_joints, 3)
        Exponential maps of each joint against its parent, in radians.
    local_positions : ndarray of shape (n_frames, n_joints, 3)
        Position of each joint in its parent's frame, in metres.
    parents : ndarray of shape (n_joints,)
        Position of each joint's parent, which comes before it; -1 for none.

    Returns
    -------
    positions : ndarray of shape (n_frames, n_joints, 3)
        In metres.
    frames : ndarray of shape (n_frames, n_joints, 3, 3)
        Rotation matrices from each joint's frame to the room.
    """
    return _forward_kinematics(
        np.ascontiguousarray(rotations, dtype=np.float64),
        np.ascontiguousarray(local_positions, dtype=np.float64),
        np.ascontiguousarray(parents, dtype=np.int64),
    )


@njit(cache=True, nogil=True)
def _rotation_matrix(rotvec, out):
    """Rodrigues' formula, with its series where the angle is too small to divide by."""
    x, y, z = rotvec
    squared = x * x + y * y + z * z
    if squared < 1e-8:
        sine = 1.0 - squared / 6.0
        versine = 0.5 - squared / 24.0
    else:
        angle = np.sqrt(squared)
        sine = np.sin(angle) / angle
        half = np.sin(0.5 * angle)
        versine = 2.0 * half * half / squared
    cosine = 1.0 - versine * squared
    out[0, 0] = cosine + versine * x * x
    out[1, 1] = cosine + versine * y * y
    out[2, 2] = cosine + versine * z * z
    out[0, 1] = versine * x * y - sine * z
    out[1, 0] = versine * x * y + sine * z
    out[0, 2] = versine * x * z + sine * y
    out[2, 0] = versine * x * z - sine * y
    out[1, 2] = versine * y * z - sine * x
    out[2, 1] = versine * y * z + sine * x


@njit(cache=True, nogil=True)
def _forward_kinematics(rotations, local_positions, parents):
    n_frames, n_joints, _ = rotations.shape
    positions = np.empty((n_frames, n_joints, 3))
    frames = np.empty((n_frames, n_joints, 3, 3))
    turn = np.empty((3, 3))
    for frame in range(n_frames):
        for joint in range(n_joints):
            _rotation_matrix(rotations[frame, joint], turn)
            parent = parents[joint]
            if parent < 0:
                positions[frame, joint] = local_positions[frame, joint]
                frames[frame, joint] = turn
                continue
            above = frames[frame, parent]
            for i in range(3):
                moved = positions[frame, parent, i]
                for k in range(3):
                    moved += above[i, k] * local_positions[frame, joint, k]
                positions[frame, joint, i] = moved
                for j in range(3):
                    entry = 0.0
                    for k in range(3):
                        entry += above[i, k] * turn[k, j]
                    frames[frame, joint, i, j] = entry
    return positions, frames
