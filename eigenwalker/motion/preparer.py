"""Preparation as a step of a Pipeline, and its way back over the floor."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, TransformerMixin

from eigenwalker._validation import WalkError, check_walks
from eigenwalker.motion.joint_preparation import joints_of_all, scale_body
from eigenwalker.motion.preparation import prepare_walks
from eigenwalker.motion.rig import Place, Rig
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["WalkPreparer"]


class WalkPreparer(TransformerMixin, BaseEstimator):
    """`prepare` as a step of a Pipeline: a list of recordings becomes a list of walks on a treadmill.

    Learns nothing of markers, and of joints only which of them turn.

    Parameters
    ----------
    representation : {"markers", "joints"}, default "markers"
        See `prepare`.
    rig : Rig or dict, default None
        See `prepare`.
    reference : "zero" or array-like of shape (n_joints, 3), default None
        See `prepare`.
    joints : sequence of str, default None
        See `prepare`; None is those that turn in any of the walks of `fit`.
    max_gap : float, default None
        See `prepare`, in seconds.
    cutoff : float, default None
        See `prepare`, in hertz.
    frame_rate : float, default None
        See `prepare`, in frames per second.
    camera : {"still", "moving"}, default "still"
        See `prepare`.
    clip : {"steady", "whole"}, default "steady"
        See `prepare`.
    frequency : {"search", "events"}, default "search"
        See `prepare`.
    heading : {"path", "curve", "body", None}, default "path"
        See `prepare`.
    treadmill : bool, default True
        See `prepare`.
    normalize_size : bool, default False
        See `prepare`.
    cadence : {"recorded", "steady"}, default "recorded"
        See `prepare`.
    symmetrize : bool, default False
        See `prepare`.
    frequency_range : tuple of float, default None
        See `prepare`, in hertz.

    Attributes
    ----------
    joints_ : tuple of str or None
        Joints that have channels; None for markers, and where the walks have different skeletons.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import WalkPreparer
    >>> walks = make_walkers(2, treadmill=False, random_state=0).data
    >>> preparer = WalkPreparer()
    >>> treadmill = preparer.fit_transform(walks)
    >>> back = preparer.inverse_transform(treadmill)
    >>> bool(back[0].marker("pelvis")[-1, 0] > 5)
    True
    """

    def __init__(
        self,
        *,
        representation: str = "markers",
        rig: Rig | Mapping[str, Place] | None = None,
        reference: str | ArrayLike | None = None,
        joints: Sequence[str] | None = None,
        max_gap: float | None = None,
        cutoff: float | None = None,
        frame_rate: float | None = None,
        camera: str = "still",
        clip: str = "steady",
        frequency: str = "search",
        heading: str | None = "path",
        treadmill: bool = True,
        normalize_size: bool = False,
        cadence: str = "recorded",
        symmetrize: bool = False,
        frequency_range: tuple[float, float] | None = None,
    ) -> None:
        self.representation = representation
        self.rig = rig
        self.reference = reference
        self.joints = joints
        self.max_gap = max_gap
        self.cutoff = cutoff
        self.frame_rate = frame_rate
        self.camera = camera
        self.clip = clip
        self.frequency = frequency
        self.heading = heading
        self.treadmill = treadmill
        self.normalize_size = normalize_size
        self.cadence = cadence
        self.symmetrize = symmetrize
        self.frequency_range = frequency_range

    def fit(self, X: Sequence[Walk | JointWalk], y: object = None) -> Self:
        """Check the walks' kind, and record which joints turn.

        Parameters
        ----------
        X : list of Walk or JointWalk
            Recordings.
        y : object, default None
            Ignored.

        Returns
        -------
        self
        """
        walks = check_walks(X, kind=(Walk, JointWalk))
        learn = self.representation == "joints" and self.joints is None
        self.joints_ = joints_of_all(walks) if learn else self.joints
        return self

    def transform(self, X: Sequence[Walk | JointWalk]) -> list[Walk | JointWalk]:
        """Return the prepared walks.

        Parameters
        ----------
        X : list of Walk or JointWalk
            Recordings.

        Returns
        -------
        list of Walk or JointWalk

        Raises
        ------
        WalkError
            If walks are refused; names each with its reason.
        """
        options = self.get_params(deep=False)
        return prepare_walks(X, **(options | {"joints": getattr(self, "joints_", self.joints)}))

    def inverse_transform(self, X: Sequence[Walk | JointWalk]) -> list[Walk | JointWalk]:
        """Return walks over the floor and in body size.

        Lengths are multiplied by `size`, and every marker, or the root, moves on along x with `speed`. The heading
        stays x, and neither the bends of the original path nor the frames that were cut off come back. The feet of
        joint walks stand still only after `plant_feet`.

        Parameters
        ----------
        X : list of Walk or JointWalk
            Prepared walks, or walks that a model made.

        Returns
        -------
        list of Walk or JointWalk

        Raises
        ------
        WalkError
            If the speed of a walk is unknown.
        """
        return [self._restore(walk) for walk in check_walks(X, kind=(Walk, JointWalk))]

    def _restore(self, walk: Walk | JointWalk) -> Walk | JointWalk:
        way = np.zeros((walk.n_frames, 3))
        if self.treadmill:
            if not np.isfinite(walk.speed):
                raise WalkError(
                    f"walk {walk.name!r}: its speed is unknown, so it cannot be put back on the floor; set it, "
                    "dataclasses.replace(walk, speed=1.3), or let the model carry it, extras=('speed',)"
                )
            way[:, 0] = walk.speed * np.arange(walk.n_frames) / walk.frame_rate
        if isinstance(walk, Walk):
            return replace(walk, positions=walk.positions * walk.size + way[:, np.newaxis], size=1.0)
        grown = scale_body(walk, walk.size)
        return replace(grown, root=grown.root + way, size=1.0)

    def __sklearn_is_fitted__(self) -> bool:
        """Tell scikit-learn that there is nothing to fit."""
        return True

    def __sklearn_tags__(self):
        """Tell scikit-learn that the input is a list of walks."""
        tags = super().__sklearn_tags__()
        tags.input_tags.two_d_array = False
        tags.requires_fit = False
        tags.no_validation = True
        return tags
