"""Poses of walks as they are, frame by frame: at phases of one stride, or on their way over the floor."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_walks
from eigenwalker.display._canvas import figure_of, take_axes, to_png
from eigenwalker.display.body import draw_sticks, find_azimuth, project
from eigenwalker.motion.fourier import fit_harmonics, reference_phase
from eigenwalker.motion.phase import find_stride, phase_weights
from eigenwalker.motion.posture import stand_upright
from eigenwalker.motion.skeleton import MarkerSet
from eigenwalker.motion.sole import sole_offsets, sole_points
from eigenwalker.motion.walk import JointWalk, Walk

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["PoseDisplay"]

_SOLES = tuple(tuple(f"{side} {point}" for point in ("heel", "ball", "tip")) for side in ("left", "right"))
_HEAD = 40  # square points
_SHORT = 0.005  # metres below which a bone is not drawn


class Strip(NamedTuple):
    """Poses of one walk.

    Parameters
    ----------
    name : str
        Of the walk.
    markers : MarkerSet
        What is drawn, with its sticks.
    positions : ndarray of shape (n_poses, n_markers, 3)
        In metres.
    """

    name: str
    markers: MarkerSet
    positions: NDArray[np.float64]


class PoseDisplay:
    """Stick figures of single frames, one row a walk; nothing is averaged or smoothed.

    Of joint walks all bones are drawn, and the soles of the feet; of others the sticks of their markers.

    Parameters
    ----------
    strips : list of Strip
        Poses, as many of each walk.
    azimuth : float
        Where the observer stands, in degrees.
    spread : bool
        Whether poses stand side by side; else each is where the walk was.

    Attributes
    ----------
    ax_ : matplotlib Axes
        What was drawn on.
    figure_ : matplotlib Figure
        The figure it belongs to.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import PoseDisplay
    >>> PoseDisplay.from_walks(make_walkers(2, random_state=0).data, n_poses=4).ax_.get_aspect()
    1.0
    """

    def __init__(self, strips: list[Strip], *, azimuth: float, spread: bool) -> None:
        self.strips = strips
        self.azimuth = azimuth
        self.spread = spread

    @classmethod
    def from_walks(
        cls,
        walks: Sequence[Walk | JointWalk],
        *,
        view: str | float = "side",
        n_poses: int = 6,
        every: float | None = None,
        ax: Axes | None = None,
    ) -> Self:
        """Draw walks.

        Parameters
        ----------
        walks : list of Walk or JointWalk
            Leading along x; their names are written below the rows.
        view : {"frontal", "half-profile", "side"} or float, default "side"
            Where the observer stands; a number is an azimuth in degrees.
        n_poses : int, default 6
            Number of poses.
        every : float, default None
            Seconds from one pose to the next, from the first frame on, each where the walk was (Tilmanne, Moinet &
            Dutoit 2012, Fig. 4, has 0.1). None takes evenly spaced phases of one stride, from where the left foot is
            furthest ahead, side by side.
        ax : matplotlib Axes, default None
            Where to draw. None makes a new figure.

        Returns
        -------
        PoseDisplay

        Raises
        ------
        WalkError
            If a walk has no stride, or is too short.
        """
        walks = check_walks(walks, kind=(Walk, JointWalk))
        if n_poses < 1 or (every is not None and not 0 < every < np.inf):
            raise ValueError(f"n_poses must be 1 or more and every positive or None, got {n_poses!r} and {every!r}")
        walks = [stand_upright(walk) if isinstance(walk, JointWalk) else walk for walk in walks]
        strips = [_strip(walk, _frames(walk, n_poses, every), spread=every is None) for walk in walks]
        return cls(strips, azimuth=find_azimuth(view), spread=every is None).plot(ax=ax)

    def plot(self, ax: Axes | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : matplotlib Axes, default None
            Where to draw.

        Returns
        -------
        self
        """
        seen = [project(strip.positions, self.azimuth) for strip in self.strips]
        n_poses = len(seen[0])
        height = 1.18 * max(picture[..., 1].max() for picture in seen)
        width = 1.1 * max(float(np.ptp(pose[:, 0])) for picture in seen for pose in picture)
        length = n_poses * width if self.spread else max(float(np.ptp(picture[..., 0])) for picture in seen)
        (ax,) = take_axes(ax, (min(12.0, 1.3 * length + 0.4), 1.3 * height * len(seen) + 0.2))
        self.ax_, self.figure_ = ax, figure_of(ax)
        for row, (strip, picture) in enumerate(zip(self.strips, seen, strict=True)):
            steps = np.arange(n_poses) * width if self.spread else np.full(n_poses, -picture[..., 0].min())
            picture[..., :2] += np.column_stack((steps, np.full(n_poses, -row * height)))[:, np.newaxis]
            for pose in picture:
                draw_sticks(ax, strip.markers, pose[np.newaxis])
            if "head" in strip.markers.names:
                head = picture[:, strip.markers.index("head")]
                ax.scatter(head[:, 0], head[:, 1], s=_HEAD, color="0.25", linewidths=0, zorder=3)
            start = -0.5 * width if self.spread else 0.0
            ax.plot([start, start + length], [-row * height] * 2, color="0.75", lw=0.7, zorder=0)
            ax.text(start, -row * height - 0.02 * height, strip.name, ha="left", va="top", fontsize="small")
        ax.set_aspect("equal", anchor="N")
        ax.autoscale_view()
        ax.set_axis_off()
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _frames(walk: Walk | JointWalk, n_poses: int, every: float | None) -> NDArray[np.intp]:
    """Return the frames of the poses."""
    if every is not None:
        times = np.arange(n_poses) * every
    else:
        channels, weights = np.asarray(walk.channels, dtype=np.float64), phase_weights(walk)
        frequency = find_stride(channels, walk.frame_rate, weights, known=walk.frequency, name=walk.name)
        n_harmonics = max(1, min(2, int(0.45 * walk.frame_rate / frequency)))
        coefficients = fit_harmonics(channels, walk.frame_rate, frequency, n_harmonics)
        start = reference_phase(coefficients, weights) % (2 * np.pi) / (2 * np.pi)
        times = (start + np.arange(n_poses) / n_poses) / frequency
        times = np.where(times * walk.frame_rate > walk.n_frames - 1, times - 1 / frequency, times)
    frames = np.maximum(np.rint(times * walk.frame_rate), 0).astype(np.intp)
    if frames.max() >= walk.n_frames:
        raise WalkError(
            f"walk {walk.name!r}: expected at least {frames.max() + 1} frames for its poses, got {walk.n_frames}"
        )
    return frames


def _strip(walk: Walk | JointWalk, frames: NDArray[np.intp], *, spread: bool) -> Strip:
    if isinstance(walk, Walk):
        markers, positions = walk.marker_set, np.asarray(walk.positions[frames], dtype=np.float64)
    else:
        markers, positions = _body(walk, frames)
    if spread:
        positions = positions - positions.mean(axis=1, keepdims=True) * [1.0, 1.0, 0.0]
    return Strip(walk.name, markers, positions)


def _body(walk: JointWalk, frames: NDArray[np.intp]) -> tuple[MarkerSet, NDArray[np.float64]]:
    """Return joints, soles and head of an upright walk in single frames, with the bones between them."""
    skeleton = walk.skeleton
    drawn = [joint for joint in range(len(skeleton.parents)) if joint not in skeleton.above(skeleton.root)]
    names = [skeleton.joint_names[joint] for joint in drawn]
    bones = [
        (skeleton.joint_names[skeleton.parents[joint]], skeleton.joint_names[joint])
        for joint in drawn
        if joint != skeleton.root and np.linalg.norm(skeleton.offsets[joint]) > _SHORT
    ]
    ankles = [skeleton.joint_names[joint] for joint in sole_offsets(skeleton).joints[:, 0]]
    feet = [pair for ankle, sole in zip(ankles, _SOLES, strict=True) for pair in pairwise((ankle, *sole))]
    soles = sole_points(walk)[frames].reshape(len(frames), -1, 3)  # (n_frames, 2, 3, 3) -> (n_frames, 6, 3)
    head = walk.to_markers().marker("head")[frames, np.newaxis]
    positions = np.concatenate((walk.joint_positions()[frames][:, drawn], soles, head), axis=1)
    return MarkerSet((*names, *_SOLES[0], *_SOLES[1], "head"), tuple(bones + feet)), positions
