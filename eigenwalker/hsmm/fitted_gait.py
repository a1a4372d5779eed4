"""What a fitted gait model does: it scores and aligns walks, and makes new ones."""

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.utils import check_random_state
from sklearn.utils.validation import check_is_fitted

from eigenwalker._validation import check_choice
from eigenwalker.hsmm.estimation import StateParameters
from eigenwalker.hsmm.gait_generation import choose_states, generate_channels, sample_channels
from eigenwalker.hsmm.gait_states import GaitStates, align_walk, infer_walk, score_walk
from eigenwalker.hsmm.global_variance import GlobalVariance
from eigenwalker.hsmm.labeled_walks import LabeledWalk, label_like
from eigenwalker.hsmm.step_labels import StepLabel, make_labels
from eigenwalker.hsmm.transforms import ChannelTransform
from eigenwalker.motion.ground import plant_feet
from eigenwalker.motion.template import fill_template
from eigenwalker.motion.walk import JointWalk

__all__ = ["FittedGaitMixin", "Labels", "Seed", "Walks"]

_TWO_STRIDES = 4  # steps

Seed = int | np.random.RandomState | None
Walks = Sequence[JointWalk] | Sequence[NDArray[np.floating]]
Labels = Sequence[Sequence[StepLabel]] | None


class FittedGaitMixin:
    """Methods of `GaitHSMM` that need its fit."""

    template_: JointWalk | None
    frame_rate: float | None
    frame_rate_: float
    walking_speed_: float
    timing_share_: float
    windows_: Sequence[Sequence[float]]
    is_canonical_: bool
    means_: NDArray[np.float64]
    covars_: NDArray[np.float64]
    durations_: NDArray[np.float64]
    states_: NDArray[np.int64]
    duration_states_: NDArray[np.int64]
    transforms_: NDArray[np.float64]
    classes_of_states_: NDArray[np.int64]
    global_variance_: NDArray[np.float64]

    def score(self, X: Walks, y: Labels = None) -> float:
        """Return the mean log-likelihood per frame, in nats.

        Parameters
        ----------
        X, y
            Walks and the labels of their steps, see `fit`.

        Returns
        -------
        float
            Over all frames of all walks.
        """
        walks = self._label(X, y)
        self._warn_of_canonical()
        model = self._states()
        return sum(score_walk(walk, model) for walk in walks) / sum(walk.n_frames for walk in walks)

    def score_samples(self, X: Walks, y: Labels = None) -> tuple[NDArray[np.float64], list[NDArray[np.float64]]]:
        """Return the log-likelihood of each walk, and the posteriors of its states.

        Parameters
        ----------
        X, y
            Walks and the labels of their steps, see `fit`.

        Returns
        -------
        log_likelihoods : ndarray of shape (n_walks,)
            In nats, of all frames of each walk.
        posteriors : list of ndarray of shape (n_frames, n_steps * n_states)
            Probability of each state of the walk in each frame of its steps.
        """
        walks = self._label(X, y)
        self._warn_of_canonical()
        model = self._states()
        found = [infer_walk(walk, model) for walk in walks]
        return np.array([part.log_likelihood for part in found]), [part.state_posteriors for part in found]

    def predict(self, X: Walks, y: Labels = None) -> list[NDArray[np.int64]]:
        """Return which state each frame of walks is in: the most likely path (Viterbi).

        Parameters
        ----------
        X, y
            Walks and the labels of their steps, see `fit`.

        Returns
        -------
        list of ndarray of int of shape (n_frames,)
            Number of the step times `n_states`, plus the state; -1 before the first and after the last step.
        """
        model = self._states()
        return [_to_positions(walk, align_walk(walk, model)[0]) for walk in self._label(X, y)]

    def sample(
        self, n_steps: int = 12, *, first: str = "right", random_state: Seed = None
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Return channels and states drawn from the model.

        Parameters
        ----------
        n_steps : int, default 12
            Of the walk.
        first : {"right", "left"}, default "right"
            The foot of the first step.
        random_state : int, RandomState or None, default None
            Seed.

        Returns
        -------
        channels : ndarray of shape (n_frames, n_channels)
            See `sample_channels`.
        positions : ndarray of int of shape (n_frames,)
            As of `predict`.
        """
        random = check_random_state(random_state)
        model = self._states()
        sequence = choose_states(model, make_labels(n_steps, first=first), durations="draw", random_state=random)
        return sample_channels(model, sequence, random_state=random), sequence.positions

    def synthesize(
        self,
        n_steps: int = 12,
        *,
        first: str = "right",
        global_variance: str | None = "exact",
        global_variance_weight: float = 1.0,
        durations: str = "mean",
        speed: float = 1.0,
        random_state: Seed = None,
        name: str = "",
        **planting: Any,
    ) -> JointWalk | NDArray[np.float64]:
        """Return a new walk that starts and stops (section 5.1.4).

        Parameters
        ----------
        n_steps : int, default 12
            Number of steps.
        first : {"right", "left"}, default "right"
            The foot of the first step.
        global_variance : {"exact", None}, default "exact"
            Whether the variance over time of each channel is that of walks (Eq. 12 to 15), found exactly, or falls
            short of it, as in the most likely trajectory. Walks of fewer than four steps fall short of it in any case:
            a part of a stride cannot have the variance of strides.
        global_variance_weight : float, default 1.0
            w in omega = w / (n_windows T), the weight of Eq. 15, see `generate_with_variance`. 0: the variance is
            exactly that of walks.
        durations : {"mean", "sample"}, default "mean"
            Whether states last for their most likely durations, or vary by chance, so that strides differ as much as
            those of the walks.
        speed : float, default 1.0
            How much faster than the model it steps.
        random_state : int, RandomState or None, default None
            Seed of drawn durations.
        name : str, default ""
            Of the walk.
        **planting
            `travel`, `heading`, `curvature`, `path`, `hold`, `max_knee`, `rig` of `plant_feet`. The walk goes at the
            mean speed of the walks as far as legs reach.

        Returns
        -------
        JointWalk, or ndarray of shape (n_frames, n_channels)
            At the frame rate of the model, over the floor z = 0, with feet that do not slide. Channels, of a model that
            was trained on arrays.

        Raises
        ------
        ValueError
            If an argument is out of range, or the steps have no states, see `tying`.
        """
        check_choice(global_variance, ("exact", None), name="global_variance")
        check_choice(durations, ("mean", "sample"), name="durations")
        if not global_variance_weight >= 0:
            raise ValueError(f"global_variance_weight must be zero or more, got {global_variance_weight!r}")
        model = self._states()
        sequence = choose_states(
            model,
            make_labels(n_steps, first=first),
            durations=durations,
            speed=speed,
            share=self.timing_share_,
            random_state=random_state,
        )
        channels = generate_channels(
            model,
            sequence,
            target=None
            if global_variance is None or n_steps < _TWO_STRIDES
            else GlobalVariance(*self.global_variance_),
            weight=global_variance_weight,
        )
        if self.template_ is None:
            return channels
        fields = {"frame_rate": self.frame_rate_, "speed": speed * self.walking_speed_, "name": name}
        return plant_feet(fill_template(self.template_, channels, **fields), **planting)

    def _warn_of_canonical(self) -> None:
        if self.is_canonical_:
            warnings.warn(
                "this model was trained walker-adaptively and not adapted: its states are none of a walker's, so that "
                "all walks look unlikely; adapt it, model.adapt(walks), and score with what it returns",
                stacklevel=3,
            )

    def _states(self) -> GaitStates:
        """Return what was learned as the functions of this part take it."""
        check_is_fitted(self)
        return GaitStates(
            StateParameters(self.means_, self.covars_, *self.durations_.T),
            self.states_,
            self.duration_states_,
            tuple(ChannelTransform(part[:, :-1], part[:, -1]) for part in self.transforms_),
            self.classes_of_states_,
            self.windows_,
        )

    def _label(self, X: Walks, y: Labels) -> list[LabeledWalk]:
        """Return walks that fit the model, with their steps."""
        check_is_fitted(self)
        return label_like(
            X,
            y,
            template=self.template_,
            n_channels=self.transforms_.shape[1],
            frame_rate=self.frame_rate_,
            resampled=self.frame_rate is not None,
        )


def _to_positions(walk: LabeledWalk, boundaries: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the number of the state of every frame of the recording, -1 outside of its steps."""
    positions = np.full(len(walk.channels), -1, dtype=np.int64)
    positions[walk.frames] = np.repeat(np.arange(len(boundaries) - 1), np.diff(boundaries))
    return positions
