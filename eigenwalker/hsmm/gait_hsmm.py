"""GaitHSMM: a hidden semi-Markov model of gait as a scikit-learn estimator."""

from collections.abc import Hashable, Sequence
from copy import copy
from typing import Self

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator

from eigenwalker._validation import check_choice
from eigenwalker.hsmm.average_model import Floors, TrainedStates, train_states, train_walkers
from eigenwalker.hsmm.features import NEIGHBOR_WINDOWS
from eigenwalker.hsmm.fitted_gait import FittedGaitMixin, Labels, Walks
from eigenwalker.hsmm.gait_generation import measure_timing
from eigenwalker.hsmm.gait_states import GaitStates
from eigenwalker.hsmm.global_variance import measure_global_variance
from eigenwalker.hsmm.labeled_walks import LabeledWalk, check_collection, common_frame_rate, label_walks, mean_speed
from eigenwalker.hsmm.style_adaptation import adapt_model
from eigenwalker.hsmm.transforms import identity_transform
from eigenwalker.motion.template import one_frame
from eigenwalker.motion.walk import JointWalk

__all__ = ["GaitHSMM"]

_STILL = 1e-12  # squared units of channels, of a variance over time that is none


class GaitHSMM(FittedGaitMixin, BaseEstimator):
    """Hidden semi-Markov model of gait (Tilmanne, Moinet & Dutoit 2012).

    Each step of a walk passes through `n_states` states from left to right. A state makes frames, Gaussians of the
    channels and of their dynamics with diagonal covariance (Eq. 2 to 4), and lasts for a Gaussian number of frames.
    Which states these are depends on the side of the step and on its position in the walk. Trained by embedded EM over
    whole walks; walks are generated from it, and from what `adapt` makes of it for a style.

    Parameters
    ----------
    n_states : int, default 5
        Of a step.
    frame_rate : float, default None
        Frames per second to which walks are resampled. None takes them as they are, all of one rate. The paper trains
        at 60 and adapts at 30 frames per second, so that durations and dynamics have to absorb the difference; here
        all walks have the rate of the model.
    windows : sequence of sequences of float, default None
        Coefficients of static, delta and delta2 channels on consecutive frames. None is `NEIGHBOR_WINDOWS`. Those of
        Eq. 2 and 3, `WINDOWS`, leave even and odd frames to themselves: walks generated with them have 6 times the
        jerk of real ones, and roots that jump by 1.9 m/s between frames, in place of 0.3.
    tying : {"tree", "paper", None}, default "tree"
        How contexts share states: by decision trees that make the description of the walks short, so that steps that
        were never seen have states as well; as the six that were left in the paper; not at all.
    tying_penalty : float, default 1.0
        Of the description length: more ties more.
    variance_floor : float, default 0.001
        Least variance of a state, as a share of the feature's variance over all frames.
    absolute_floor : float, default 1e-07
        Least variance in squared units of the channels, for those that hardly move: in radians the square of 0.02
        degrees.
    duration_floor : float, default 1.0
        Least variance of a duration, in frames squared.
    walker_weight : float, default 1000.0
        Of the prior of each walker's transform, if `walkers` are given to `fit`, see `fit_walker_adaptive`.
    max_iter : int, default 20
        Largest number of iterations of EM, before and after tying.
    tol : float, default 0.001
        Gain of the log-likelihood per frame at which EM stops.
    n_jobs : int, default None
        Number of threads, as in joblib. Results do not depend on it.
    verbose : bool, default False
        Whether each iteration is printed.

    Attributes
    ----------
    means_, covars_ : ndarray of shape (n_tied, n_features)
        Of the observations of the tied states; covars_ are the variances.
    durations_ : ndarray of shape (n_tied_durations, 2)
        Mean and variance, in frames, of the Gaussians that durations, whole numbers from 1 on, are drawn from.
    startprob_ : ndarray of shape (n_states,)
    transmat_ : ndarray of shape (n_states, n_states)
        Of the states of a step, which follow each other.
    states_, duration_states_ : ndarray of int of shape (n_contexts, n_states)
        Row of each state of each context, in the order of `CONTEXTS`; -1 without walks and without tying.
    trees_, duration_trees_ : tuple of ContextTree
        What tied them.
    transforms_ : ndarray of shape (n_classes, n_channels, n_channels + 1)
        A and b of z = A c + b, which `means_` and `covars_` describe; the identity unless adapted.
    classes_of_states_ : ndarray of int of shape (n_tied,)
        Which transform each tied state has.
    global_variance_ : ndarray of shape (2, n_channels)
        Mean and variance over walks of the variance over time of the channels, first and last steps left out.
    history_ : ndarray of shape (n_iter_ + 1,)
        Log-likelihood per frame at the start and after each iteration of the last training.
    n_iter_, converged_ : int, bool
        Of the last training.
    is_canonical_ : bool
        Whether training was walker-adaptive, and `adapt` has not followed.
    walking_speed_ : float
        Mean of the walks, in m/s; NaN where unknown.
    timing_share_ : float
        Share of the variance of durations that strides have, see `measure_timing`.
    windows_ : tuple of tuples of float
        Coefficients of the windows.
    frame_rate_ : float
        Frames per second; NaN of arrays.
    template_ : JointWalk or None
        One frame of the first walk, with the skeleton and the names of the channels.

    References
    ----------
    Tilmanne, Moinet & Dutoit 2012, section 5.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.hsmm import GaitHSMM, make_labels
    >>> steps = np.sin(np.arange(240) * np.pi / 30)[:, None] * [1.0, 0.5]  # 8 steps of 30 frames
    >>> noise = np.random.default_rng(0).normal(scale=0.05, size=(4, *steps.shape))
    >>> model = GaitHSMM().fit([steps + part for part in noise], [make_labels(8)] * 4)
    >>> model.sample(n_steps=3, random_state=0)[0].shape[1]
    2
    """

    def __init__(
        self,
        n_states: int = 5,
        *,
        frame_rate: float | None = None,
        windows: Sequence[Sequence[float]] | None = None,
        tying: str | None = "tree",
        tying_penalty: float = 1.0,
        variance_floor: float = 0.001,
        absolute_floor: float = 1e-7,
        duration_floor: float = 1.0,
        walker_weight: float = 1000.0,
        max_iter: int = 20,
        tol: float = 1e-3,
        n_jobs: int | None = None,
        verbose: bool = False,
    ) -> None:
        self.n_states = n_states
        self.frame_rate = frame_rate
        self.windows = windows
        self.tying = tying
        self.tying_penalty = tying_penalty
        self.variance_floor = variance_floor
        self.absolute_floor = absolute_floor
        self.duration_floor = duration_floor
        self.walker_weight = walker_weight
        self.max_iter = max_iter
        self.tol = tol
        self.n_jobs = n_jobs
        self.verbose = verbose

    def fit(
        self,
        X: Walks,
        y: Labels = None,
        *,
        walkers: Sequence[Hashable] | None = None,
        boundaries: Sequence[ArrayLike] | None = None,
    ) -> Self:
        """Train the states on walks.

        Parameters
        ----------
        X : list of JointWalk, or list of ndarray of shape (n_frames, n_channels)
            Walks from ``prepare(walk, representation="joints", clip="whole")``, without steady cadence: starts, stops
            and timing are modeled.
        y : list of lists of tuple of str, default None
            Labels of the steps of each walk, such as ("right", "first"), see `make_labels`. None finds the steps of
            walks, see `label_steps`; arrays need them.
        walkers : sequence of hashable, default None
            Who walks, one a walk. Then training is walker-adaptive (5.1.2): what walkers differ in, as far as linear
            transforms take it, is no spread of the states, and the model, which no walker walks like, must be adapted
            before it scores walks.
        boundaries : list of array-like of int of shape (n_steps + 1,), default None
            First frame of each step, and the frame after the last: only where training starts.

        Returns
        -------
        self

        Raises
        ------
        WalkError
            If walks differ in skeleton or frame rate, have no steps, or steps of fewer frames than states.
        ValueError
            If a parameter is out of range, there is nothing to train on, or walkers are not one a walk.
        """
        self._check_parameters()
        walks = check_collection(X)
        self.__dict__.pop("adaptation_", None)  # of a fit before
        self.windows_ = tuple(map(tuple, NEIGHBOR_WINDOWS if self.windows is None else self.windows))
        self.template_, self.frame_rate_ = None, float("nan")
        joint_walks = [walk for walk in walks if isinstance(walk, JointWalk)]
        if joint_walks:
            self.template_ = one_frame(joint_walks[0])
            self.frame_rate_ = float(common_frame_rate(joint_walks) if self.frame_rate is None else self.frame_rate)
        labeled = label_walks(walks, y, boundaries, template=self.template_, frame_rate=self.frame_rate)
        trained = train_states(
            labeled,
            n_states=self.n_states,
            windows=self.windows_,
            tying=self.tying,
            penalty=self.tying_penalty,
            floors=Floors(self.variance_floor, self.absolute_floor, self.duration_floor),
            max_iter=self.max_iter,
            tol=self.tol,
            n_jobs=self.n_jobs,
            report=self._report if self.verbose else None,
        )
        if walkers is not None:
            trained = train_walkers(
                labeled,
                walkers,
                trained,
                windows=self.windows_,
                weight=self.walker_weight,
                duration_floor=self.duration_floor,
                max_iter=self.max_iter,
                tol=self.tol,
                n_jobs=self.n_jobs,
                report=self._report if self.verbose else None,
            )
        self.is_canonical_, self.walking_speed_ = walkers is not None, mean_speed(walks)
        self._keep(trained, labeled)
        return self

    def adapt(
        self,
        X: Walks,
        y: Labels = None,
        *,
        method: str = "csmaplr+map",
        transform_weight: float | None = None,
        map_weight: float | None = None,
        n_classes: int = 1,
        mixing: str = "joints",
        max_iter: int = 5,
    ) -> "GaitHSMM":
        """Return a model of a style, made of this one and a few steps (section 5.1.3). This one stays as it is.

        Parameters
        ----------
        X, y
            Walks of the style and the labels of their steps, see `fit`; about a dozen steps in all.
        method : {"csmaplr+map", "csmaplr", "cmllr+map", "cmllr", "map"}, default "csmaplr+map"
            Linear transforms of channels (Eq. 5) and durations (Eq. 6), with a prior along a tree of classes of states
            (CSMAPLR) or without (CMLLR, which 5.2.2 names), and MAP, which then moves each state by the frames it has.
        transform_weight, map_weight : float, default None
            Of the priors, see `estimate_transform` and `map_states`. None chooses those that make walks that are held
            out most likely, see `choose_weights`; of a single walk 1000 and 30.
        n_classes : int, default 1
            Most classes of states with a transform of their own; there are fewer if frames are too few.
        mixing : {"joints", "all", "none"}, default "joints"
            Which channels a transform mixes: those of a joint, three each; all of them, which takes many frames; or
            none, a factor and a shift of each channel.
        max_iter : int, default 5
            Most iterations of transforms, and of MAP.

        Returns
        -------
        GaitHSMM
            With the attribute `adaptation_`, which says how: method, weights, classes that were wanted and had frames,
            n_frames, and the scores of weights on walks held out.

        Raises
        ------
        WalkError
            If a walk has other channels, or no path through the durations.
        ValueError
            If an argument is out of range, or this model was adapted before.

        Warns
        -----
        UserWarning
            If there are too few frames for the classes that were asked for.
        """
        walks = self._label(X, y)
        if hasattr(self, "adaptation_"):
            raise ValueError("this model was adapted already; adapt the average model that it came from")
        adapted, report = adapt_model(
            walks,
            self._states(),
            method=method,
            weights=(transform_weight, map_weight),
            n_classes=n_classes,
            mixing=mixing,
            max_iter=max_iter,
            floors=self.floors_,
            noise=self.absolute_floor,
            duration_floor=self.duration_floor,
            n_jobs=self.n_jobs,
        )
        style = copy(self)
        style._keep_states(adapted)
        style.is_canonical_, style.walking_speed_ = False, mean_speed(X)
        style.adaptation_ = report
        share = measure_timing(walks, adapted)
        style.timing_share_ = self.timing_share_ if np.isnan(share) else share
        own = measure_global_variance([walk.inner_channels() for walk in walks]).means
        usual, spread = self.global_variance_  # of channels that stand still both are nothing
        style.global_variance_ = np.array([own, spread * (own / np.maximum(usual, _STILL)) ** 2])
        return style

    def _check_parameters(self) -> None:
        check_choice(self.tying, ("tree", "paper", None), name="tying")
        bounds = {"n_states": 1, "tying_penalty": 0, "variance_floor": 0, "absolute_floor": 0, "duration_floor": 0}
        bounds |= {"walker_weight": 0, "max_iter": 1, "tol": 0}
        faults = [
            f"{name} must be {least} or more, got {getattr(self, name)!r}"
            for name, least in bounds.items()
            if not getattr(self, name) >= least
        ]
        if faults:
            raise ValueError("\n".join(faults))

    def _report(self, iteration: int, log_likelihood: float) -> None:
        print(f"iteration {iteration}: log-likelihood per frame {log_likelihood:.6g}")  # noqa: T201 - verbose

    def _keep(self, trained: TrainedStates, walks: list[LabeledWalk]) -> None:
        self.states_, self.duration_states_ = trained.states.states, trained.duration_states.states
        self.trees_, self.duration_trees_ = trained.states.trees, trained.duration_states.trees
        self.floors_ = trained.floors
        n_states = len(trained.fitted.parameters.means)
        self._keep_states(
            GaitStates(
                trained.fitted.parameters,
                self.states_,
                self.duration_states_,
                (identity_transform(walks[0].channels.shape[1]),),
                np.zeros(n_states, dtype=np.int64),
                self.windows_,
            )
        )
        self.startprob_, self.transmat_ = np.eye(1, self.n_states)[0], np.eye(self.n_states, k=1)
        self.global_variance_ = np.array(measure_global_variance([walk.inner_channels() for walk in walks]))
        self.history_ = trained.fitted.log_likelihoods / sum(walk.n_frames for walk in walks)
        share = measure_timing(walks, self._states())
        self.timing_share_ = 1.0 if np.isnan(share) else share
        self.n_iter_, self.converged_ = len(self.history_) - 1, trained.fitted.converged

    def _keep_states(self, model: GaitStates) -> None:
        parameters = model.parameters
        self.means_, self.covars_ = parameters.means, parameters.variances
        self.durations_ = np.column_stack((parameters.duration_means, parameters.duration_variances))
        self.transforms_ = np.array([np.column_stack(transform) for transform in model.transforms])
        self.classes_of_states_ = model.classes

    def __sklearn_tags__(self):
        """Tell scikit-learn that the input is a list of walks."""
        tags = super().__sklearn_tags__()
        tags.input_tags.two_d_array = False
        tags.no_validation = True
        return tags
