"""Walks as a gait model takes them: channels at one frame rate, and the steps they consist of."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker._validation import WalkError, check_array, check_finite
from eigenwalker.hsmm.features import append_dynamics
from eigenwalker.hsmm.step_labels import StepLabel, check_labels, label_steps
from eigenwalker.motion.filtering import resample
from eigenwalker.motion.template import check_alike
from eigenwalker.motion.walk import JointWalk

__all__ = ["LabeledWalk", "check_collection", "common_frame_rate", "label_like", "label_walks", "mean_speed"]


_DIGITS = 1e-4  # of a frame rate


class LabeledWalk(NamedTuple):
    """One walk and its steps.

    Parameters
    ----------
    name : str
        What it is called in an error.
    channels : ndarray of shape (n_frames, n_channels)
        Of the whole recording.
    labels : list of tuple of str
        Side and position of each step.
    boundaries : ndarray of int of shape (n_steps + 1,)
        First frame of each step, and the frame after the last one. What lies before or after is not modeled, but its
        frames are known to the windows.
    """

    name: str
    channels: NDArray[np.float64]
    labels: list[StepLabel]
    boundaries: NDArray[np.int64]

    @property
    def frames(self) -> slice:
        """The frames of all steps."""
        return slice(int(self.boundaries[0]), int(self.boundaries[-1]))

    @property
    def n_frames(self) -> int:
        """Number of frames of all steps."""
        return int(self.boundaries[-1] - self.boundaries[0])

    def observations(self, windows: Sequence[Sequence[float]]) -> NDArray[np.float64]:
        """Return the channels and their dynamics in the frames of the steps, see `append_dynamics`."""
        return append_dynamics(self.channels, windows=windows)[self.frames]

    def inner_channels(self) -> NDArray[np.float64]:
        """Return the channels without those of a first step and of a last one, if two others are left or more."""
        starts, ends = self.labels[0][1] == "first", self.labels[-1][1] == "last"
        edges = self.boundaries[int(starts) : len(self.boundaries) - int(ends)]
        edges = edges if len(edges) > 2 else self.boundaries
        return self.channels[edges[0] : edges[-1]]


def check_collection(X: object) -> list[JointWalk | NDArray[np.float64]]:
    """Return a list of joint walks, or of finite arrays of shape (n_frames, n_channels) with equally many channels."""
    if isinstance(X, (JointWalk, np.ndarray, str)) or not isinstance(X, Sequence):
        raise TypeError(f"expected a list of walks, got a single {type(X).__name__}; pass [walk]")
    if not len(X):
        raise ValueError("expected at least one walk, got an empty list")
    kind = JointWalk if isinstance(X[0], JointWalk) else np.ndarray
    for at, walk in enumerate(X):
        if not isinstance(walk, kind):
            raise TypeError(
                "expected JointWalks, from prepare(walk, representation='joints', clip='whole'), or arrays of shape "
                f"(n_frames, n_channels), all of one kind, got {type(walk).__name__} at position {at}"
            )
    if kind is JointWalk:
        for walk in X:
            check_finite(walk.channels, walk.channel_names, walk=walk.name)
            if not walk.skeleton.upright:
                raise WalkError(
                    f"walk {walk.name!r}: expected joints that count along the axes of the room, got those of a file; "
                    "prepare it, prepare(walk, representation='joints', clip='whole')"
                )
        return list(X)
    arrays = [
        np.asarray(check_array(walk, shape=("n_frames", "n_channels"), name=f"X[{at}]"), dtype=np.float64)
        for at, walk in enumerate(X)
    ]
    for at, array in enumerate(arrays):
        check_finite(array, [f"channel {number}" for number in range(array.shape[1])], walk=f"walk {at}")
        if array.shape[1] != arrays[0].shape[1]:
            raise WalkError(
                f"walk {at}: expected {arrays[0].shape[1]} channels, as the first walk has, got {array.shape[1]}"
            )
    return list(arrays)


def common_frame_rate(walks: Sequence[JointWalk]) -> float:
    """Return the frame rate of walks, or raise a WalkError that names those of another."""
    rate = walks[0].frame_rate
    others = [f"{walk.name!r} {walk.frame_rate:g}" for walk in walks if not _same_rate(walk.frame_rate, rate)]
    if others:
        raise WalkError(
            f"expected walks of one frame rate, {rate:g} as the first has, got {', '.join(others[:6])} frames per "
            "second; dynamics and durations count in frames: give frame_rate=..., to which all are resampled"
        )
    return rate


def _same_rate(one: float, other: float) -> bool:
    """Return whether frame rates are the same but for the digits of a file: 30 and 30.00003."""
    return abs(one - other) < _DIGITS * other


def mean_speed(walks: Sequence[object]) -> float:
    """Return the mean speed of the walks whose speed is known, in m/s; NaN if there are none."""
    speeds = [walk.speed for walk in walks if isinstance(walk, JointWalk) and np.isfinite(walk.speed)]
    return float(np.mean(speeds)) if speeds else float("nan")


def label_walks(
    X: Sequence[JointWalk | NDArray[np.float64]],
    y: Sequence[Sequence[StepLabel]] | None = None,
    boundaries: Sequence[ArrayLike] | None = None,
    *,
    template: JointWalk | None = None,
    frame_rate: float | None = None,
) -> list[LabeledWalk]:
    """Return walks with their steps.

    Parameters
    ----------
    X : list of JointWalk, or list of ndarray of shape (n_frames, n_channels)
        From `check_collection`.
    y : list of lists of tuple of str, default None
        Labels of the steps of each walk. None finds them, see `label_steps`; arrays need them.
    boundaries : list of array-like of int of shape (n_steps + 1,), default None
        First frame of each step, and the frame after the last one. None finds them in walks; walks whose labels are
        given are cut into equal steps, which is only where training starts.
    template : JointWalk, default None
        Whose channels walks must have.
    frame_rate : float, default None
        To which walks are resampled; None leaves them.

    Raises
    ------
    WalkError
        If a walk has other channels than the template, no steps, or labels or boundaries that are not possible.
    ValueError
        If there are not as many labels or boundaries as walks.
    """
    for name, given in (("y", y), ("boundaries", boundaries)):
        if given is not None and len(given) != len(X):
            raise ValueError(f"expected {name} for each of the {len(X)} walks, got {len(given)}")
    labels: list[Any] = [None] * len(X) if y is None else list(y)
    edges: list[Any] = [None] * len(X) if boundaries is None else list(boundaries)
    if template is not None:
        check_alike([walk for walk in X if isinstance(walk, JointWalk)], template)
    return [_label(at, walk, labels[at], edges[at], frame_rate) for at, walk in enumerate(X)]


def label_like(
    X: object,
    y: Sequence[Sequence[StepLabel]] | None,
    *,
    template: JointWalk | None,
    n_channels: int,
    frame_rate: float,
    resampled: bool,
) -> list[LabeledWalk]:
    """Return walks like those that a model was fitted to, with their steps.

    Parameters
    ----------
    X, y
        See `label_walks`.
    template : JointWalk or None
        Of the model, None if it was fitted to arrays.
    n_channels : int
        Of the model.
    frame_rate : float
        Of the model.
    resampled : bool
        Whether walks of another frame rate are resampled, or refused.

    Raises
    ------
    TypeError
        If walks are given for arrays, or arrays for walks.
    ValueError
        If arrays have another number of channels, or walks another frame rate.
    """
    walks = check_collection(X)
    joint_walks = [walk for walk in walks if isinstance(walk, JointWalk)]
    arrays = [walk for walk in walks if isinstance(walk, np.ndarray)]
    if bool(arrays) == (template is not None):
        kinds = ("JointWalks", "arrays") if arrays else ("arrays", "JointWalks")
        raise TypeError(f"expected {kinds[0]}, as in fit, got {kinds[1]}")
    if arrays and arrays[0].shape[1] != n_channels:
        raise ValueError(f"expected {n_channels} channels, as in fit, got {arrays[0].shape[1]}")
    if joint_walks and not resampled and not _same_rate(common_frame_rate(joint_walks), frame_rate):
        raise ValueError(
            f"expected {frame_rate:g} frames per second, as in fit, got {joint_walks[0].frame_rate:g}; resample the "
            "walks, or fit with frame_rate=..., to which all walks are resampled"
        )
    return label_walks(walks, y, template=template, frame_rate=frame_rate if resampled else None)


def _label(
    at: int,
    walk: JointWalk | NDArray[np.float64],
    labels: Sequence[StepLabel] | None,
    boundaries: ArrayLike | None,
    frame_rate: float | None,
) -> LabeledWalk:
    name = f"walk {at}"
    if isinstance(walk, JointWalk):
        name, before = walk.name or name, walk.frame_rate
        if frame_rate is not None and not _same_rate(frame_rate, before):
            walk = resample(walk, frame_rate=frame_rate)
            if boundaries is not None:
                boundaries = np.minimum(np.rint(np.asarray(boundaries) * (frame_rate / before)), walk.n_frames)
        if labels is None:
            found = label_steps(walk)
            labels, boundaries = found.labels, found.boundaries if boundaries is None else boundaries
        channels = np.asarray(walk.channels, dtype=np.float64)
    else:
        channels = walk
    if labels is None:
        raise ValueError(
            "arrays need step labels, y=[[('right', 'first'), ...], ...], see make_labels; only walks' are found"
        )
    known = check_labels(labels, walk=name)
    edges = np.linspace(0, len(channels), len(known) + 1).round() if boundaries is None else np.asarray(boundaries)
    return LabeledWalk(name, channels, known, _check_boundaries(edges, len(known), len(channels), name))


def _check_boundaries(edges: NDArray, n_steps: int, n_frames: int, name: str) -> NDArray[np.int64]:
    whole = edges.ndim == 1 and len(edges) == n_steps + 1 and np.array_equal(edges, np.rint(edges))
    if not whole or edges[0] < 0 or edges[-1] > n_frames or (np.diff(edges) < 1).any():
        raise WalkError(
            f"walk {name!r}: expected boundaries that rise from frame to frame, one more than its {n_steps} steps, "
            f"within its {n_frames} frames, got {np.asarray(edges).tolist()}"
        )
    return edges.astype(np.int64)
