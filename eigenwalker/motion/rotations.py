"""Rotations as exponential maps: from and to other forms, along time, and down a skeleton.

An exponential map is a vector r of three numbers: the axis r / |r| and the angle |r| in radians.
"""

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from eigenwalker.motion._quaternions import from_rotvec, product, to_rotvec

__all__ = [
    "euler_from_rotvec",
    "forward_kinematics",
    "rotvec_from_channels",
    "rotvec_from_euler",
    "turn_frames",
    "unroll_rotvec",
]

_LOCKED = 1e-9  # two of the three angles are about one axis where a cosine or sine is smaller


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
    shape = (int(np.prod(angles.shape[:-1])), len(order))
    flat = np.ascontiguousarray(angles.reshape(shape))  # (..., n_axes) -> (n, n_axes)
    axes = np.array(["XYZ".index(letter) for letter in order], dtype=np.int64)
    return _rotvec_from_euler(flat, axes).reshape(*angles.shape[:-1], 3)


@njit(cache=True, nogil=True)
def _rotvec_from_euler(angles, axes):
    n_rotations, n_axes = angles.shape
    out = np.empty((n_rotations, 3))
    for i in range(n_rotations):
        w, x, y, z = 1.0, 0.0, 0.0, 0.0
        for j in range(n_axes):
            w, x, y, z = _turn_quaternion(w, x, y, z, axes[j], angles[i, j])
        out[i, 0], out[i, 1], out[i, 2] = to_rotvec((w, x, y, z))
    return out


@njit(cache=True, nogil=True, inline="always")
def _turn_quaternion(w, x, y, z, axis, angle):
    """Multiply a quaternion from the right with that of a turn about one of the axes."""
    c = np.cos(0.5 * angle)
    s = np.sin(0.5 * angle)
    if axis == 0:
        return w * c - x * s, x * c + w * s, y * c + z * s, z * c - y * s
    if axis == 1:
        return w * c - y * s, x * c - z * s, y * c + w * s, z * c + x * s
    return w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s


def rotvec_from_channels(channels: ArrayLike, columns: Sequence[Sequence[int]], orders: Sequence[str]) -> NDArray:
    """Return exponential maps of many joints without jumps: `rotvec_from_euler`, then `unroll_rotvec`, in one pass.

    Parameters
    ----------
    channels : array-like of shape (n_frames, n_channels)
        Angles in degrees, as files have them, among whatever other channels there are.
    columns : sequence of sequence of int
        For each joint the columns of its angles, from none on.
    orders : sequence of str
        For each joint the axes of those angles, X, Y and Z, from left to right.

    Returns
    -------
    ndarray of shape (n_frames, n_joints, 3)
        In radians.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion.rotations import rotvec_from_channels
    >>> np.rad2deg(rotvec_from_channels([[7, 170], [7, 190]], [[], [1]], ["", "Z"])[:, 1]).round(6) + 0.0
    array([[  0.,   0., 170.],
           [  0.,   0., 190.]])
    """
    channels = np.ascontiguousarray(channels, dtype=np.float64)
    most = max(map(len, columns), default=0)
    places = np.array([[*joint, *[-1] * (most - len(joint))] for joint in columns], dtype=np.int64)
    axes = np.array([["XYZ".index(letter) for letter in order.ljust(most, "X")] for order in orders], dtype=np.int64)
    shape = (len(columns), most)
    return _rotvec_from_channels(channels, places.reshape(shape), axes.reshape(shape))  # also where there are none


@njit(cache=True, nogil=True)
def _rotvec_from_channels(channels, columns, axes):
    n_joints, n_axes = columns.shape
    out = np.empty((len(channels), n_joints, 3))
    for frame in range(len(channels)):
        for joint in range(n_joints):
            w, x, y, z = 1.0, 0.0, 0.0, 0.0
            for j in range(n_axes):
                column = columns[joint, j]
                if column >= 0:
                    w, x, y, z = _turn_quaternion(w, x, y, z, axes[joint, j], np.deg2rad(channels[frame, column]))
            out[frame, joint, 0], out[frame, joint, 1], out[frame, joint, 2] = to_rotvec((w, x, y, z))
            if frame > 0:
                _unroll_one(out, frame, joint)
    return out


def euler_from_rotvec(rotvec: ArrayLike, order: str) -> NDArray[np.float64]:
    r"""Return the angles about moving axes that make the same rotations, without jumps from frame to frame.

    The inverse of `rotvec_from_euler`. Every rotation has two families of angles, (a, b, c) and (a + pi, pi - b,
    c + pi), and whole turns may be added. Those nearest to the frame before are taken, at first those nearest to zero.

    Parameters
    ----------
    rotvec : array-like of shape (3,) or (n_frames, ..., 3)
        Exponential maps, time first, in radians.
    order : str
        X, Y and Z, each once, in any order.

    Returns
    -------
    ndarray of the shape of `rotvec`
        In radians.

    Raises
    ------
    ValueError
        If `order` is not one of the six orders, or the last axis of `rotvec` does not have 3 entries.

    Notes
    -----
    For half angles and the quaternion w, i, j, k, axes in a right-handed order (else k and c change sign)::

        (cos b + sin b) (cos, sin)(a + c) = (w + j, i + k)
        (cos b - sin b) (cos, sin)(a - c) = (w - j, i - k)

    so that all angles keep their digits. At gimbal lock, b = pi / 2, the sum or the difference is free and stays.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import euler_from_rotvec
    >>> np.rad2deg(euler_from_rotvec([0.0, np.pi / 2, 0.0], "ZXY")).round(6) + 0.0
    array([ 0.,  0., 90.])
    """
    if sorted(order) != ["X", "Y", "Z"]:
        raise ValueError(f"order must have X, Y and Z once each, got {order!r}")
    rotvec = np.asarray(rotvec, dtype=np.float64)
    if rotvec.ndim == 0 or rotvec.shape[-1] != 3:
        raise ValueError(f"rotvec must have shape (3,) or (n_frames, ..., 3), got {rotvec.shape}")
    shape = (len(rotvec) if rotvec.ndim > 1 else 1, int(np.prod(rotvec.shape[1:-1])), 3)
    frames = np.ascontiguousarray(rotvec.reshape(shape))  # (n_frames, ..., 3) -> (n_frames, n, 3)
    axes = np.array(["XYZ".index(letter) for letter in order], dtype=np.int64)
    sign = 1.0 if order in "XYZXY" else -1.0
    return _euler_from_rotvec(frames, axes, sign).reshape(rotvec.shape)


@njit(cache=True, nogil=True)
def _euler_from_rotvec(rotvec, axes, sign):
    n_frames, n_joints, _ = rotvec.shape
    out = np.empty((n_frames, n_joints, 3))
    for joint in range(n_joints):
        total, middle, difference = 0.0, 0.0, 0.0  # a + c, b, a - c of the frame before
        for frame in range(n_frames):
            turn = rotvec[frame, joint]
            angle = np.sqrt(turn[0] ** 2 + turn[1] ** 2 + turn[2] ** 2)
            w, scale = np.cos(0.5 * angle), 0.5 if angle < 1e-12 else np.sin(0.5 * angle) / angle
            i, j, k = scale * turn[axes[0]], scale * turn[axes[1]], sign * scale * turn[axes[2]]
            plus, minus = np.hypot(w + j, i + k), np.hypot(w - j, i - k)
            b = 2.0 * np.arctan2(plus, minus) - 0.5 * np.pi
            s = 2.0 * np.arctan2(i + k, w + j) if plus > _LOCKED else total
            d = 2.0 * np.arctan2(i - k, w - j) if minus > _LOCKED else difference
            total, middle, difference = _nearest_angles(s, b, d, total, middle, difference)
            for axis, value in enumerate((0.5 * (total + difference), middle, 0.5 * sign * (total - difference))):
                out[frame, joint, axis] = value
    return out


@njit(cache=True, nogil=True)
def _nearest_angles(s, b, d, total, middle, difference):
    """Choose the nearest sum, middle angle and difference; an odd number of whole turns is the other family's."""
    turn, best, nearest = 2.0 * np.pi, np.inf, (s, b, d)
    x, y = (total - s) / turn, (difference - d) / turn
    for odd in range(2):
        m, n = np.round(x), np.round(y)
        if (m + n) % 2 != odd and abs(x - m) > abs(y - n):
            m += 1.0 if x > m else -1.0
        elif (m + n) % 2 != odd:
            n += 1.0 if y > n else -1.0
        base = np.pi - b if odd else b
        beta = base + turn * np.round((middle - base) / turn)
        far = 0.5 * turn**2 * ((x - m) ** 2 + (y - n) ** 2) + (beta - middle) ** 2
        if far < best - 1e-12:
            best, nearest = far, (s + turn * m, beta, d + turn * n)
    return nearest


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
    for frame in range(1, n_frames):
        for joint in range(n_joints):
            _unroll_one(out, frame, joint)
    return out


@njit(cache=True, nogil=True, inline="always")
def _unroll_one(out, frame, joint):
    """Take the exponential map nearest to that of the frame before, in place."""
    turn = 2.0 * np.pi
    x, y, z = out[frame, joint, 0], out[frame, joint, 1], out[frame, joint, 2]
    px, py, pz = out[frame - 1, joint, 0], out[frame - 1, joint, 1], out[frame - 1, joint, 2]
    angle = np.sqrt(x * x + y * y + z * z)
    if angle >= 1e-12:
        along = (x * px + y * py + z * pz) / angle
        if abs(along - angle) < np.pi:
            return
        scale = 1.0 + turn * np.round((along - angle) / turn) / angle
        out[frame, joint, 0], out[frame, joint, 1], out[frame, joint, 2] = scale * x, scale * y, scale * z
        return
    # The identity: any axis will do for a full turn, so the one before is kept.
    before = np.sqrt(px * px + py * py + pz * pz)
    if before > np.pi:
        scale = turn * np.round(before / turn) / before
        out[frame, joint, 0], out[frame, joint, 1], out[frame, joint, 2] = scale * px, scale * py, scale * pz


def turn_frames(
    rotations: NDArray[np.floating], before: NDArray[np.floating], after: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Return A R B of each joint's rotations R, without jumps from frame to frame.

    Where the frame of each joint is turned by G against the one it had, with the parent's G as A and the transpose of
    the joint's own G as B, the result is the same motion of the turned frames.

    Parameters
    ----------
    rotations : ndarray of shape (n_frames, n_joints, 3)
        Exponential maps R, in radians.
    before, after : ndarray of shape (n_joints, 3, 3)
        Rotation matrices A and B.

    Returns
    -------
    ndarray of shape (n_frames, n_joints, 3)
        In radians; the first frame has angles of at most pi.
    """
    left, right = (Rotation.from_matrix(part).as_quat(scalar_first=True) for part in (before, after))
    return _turn_frames(np.ascontiguousarray(rotations, dtype=np.float64), left, right)


@njit(cache=True, nogil=True)
def _turn_frames(rotations, left, right):
    n_frames, n_joints, _ = rotations.shape
    out = np.empty((n_frames, n_joints, 3))
    for frame in range(n_frames):
        for joint in range(n_joints):
            x, y, z = rotations[frame, joint]
            a = (left[joint, 0], left[joint, 1], left[joint, 2], left[joint, 3])
            b = (right[joint, 0], right[joint, 1], right[joint, 2], right[joint, 3])
            turn = to_rotvec(product(product(a, from_rotvec((x, y, z))), b))
            out[frame, joint, 0], out[frame, joint, 1], out[frame, joint, 2] = turn
            if frame > 0:
                _unroll_one(out, frame, joint)
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
    """Write Rodrigues' formula into `out`, its series where the angle is too small to divide by."""
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
            for i in range(3):  # element by element: assigning slices takes seconds to compile
                if parent < 0:
                    positions[frame, joint, i] = local_positions[frame, joint, i]
                    for j in range(3):
                        frames[frame, joint, i, j] = turn[i, j]
                    continue
                moved = positions[frame, parent, i]
                for k in range(3):
                    moved += frames[frame, parent, i, k] * local_positions[frame, joint, k]
                positions[frame, joint, i] = moved
                for j in range(3):
                    entry = 0.0
                    for k in range(3):
                        entry += frames[frame, parent, i, k] * turn[k, j]
                    frames[frame, joint, i, j] = entry
    return positions, frames
