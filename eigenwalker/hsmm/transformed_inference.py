"""The E step for walkers who have transforms of their own: posteriors, and sums of transformed walks.

    log b_s(o_t) = log N(W_r zeta_t; mu_s, sigma_s^2) + n_t log |det A_r|

with r the class of state s and n_t how many windows of frame t were observed. Durations are those of the walker.
"""

from collections.abc import Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigenwalker.hsmm.accumulation import ObservedWalk, Statistics, accumulate_walk, add_statistics
from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.duration_transform import DurationTransform, identity_durations, transformed_durations
from eigenwalker.hsmm.estimation import StateParameters
from eigenwalker.hsmm.features import WINDOWS
from eigenwalker.hsmm.inference import Posterior, infer_states
from eigenwalker.hsmm.observation import accumulate_over_time, log_densities
from eigenwalker.hsmm.transform_statistics import TransformStatistics, accumulate_transform
from eigenwalker.hsmm.transforms import ChannelTransform, identity_transform, transform_observations

__all__ = [
    "TransformClasses",
    "WalkerTransforms",
    "accumulate_transformed",
    "accumulate_walk_transform",
    "expect_transformed",
    "identity_walker",
    "one_class",
    "transformed_log_densities",
]


class TransformClasses(NamedTuple):
    """Which states share a transform.

    Attributes
    ----------
    states : ndarray of int of shape (n_states,)
        Class of each state of observations, the channels' transform.
    durations : ndarray of int of shape (n_duration_states,)
        The same for durations.
    n_states, n_durations : int
        Number of classes of each.
    """

    states: NDArray[np.int_]
    durations: NDArray[np.int_]
    n_states: int
    n_durations: int


class WalkerTransforms(NamedTuple):
    """What makes one walker that of the model.

    Attributes
    ----------
    channels : tuple of ChannelTransform
        One for each class of states.
    durations : DurationTransform
        One for each class of duration states.
    """

    channels: tuple[ChannelTransform, ...]
    durations: DurationTransform


def one_class(
    parameters: StateParameters, *, state_classes: ArrayLike | None = None, duration_classes: ArrayLike | None = None
) -> TransformClasses:
    """Return the classes of states, by default one for all.

    Parameters
    ----------
    parameters : StateParameters
        Which says how many states there are.
    state_classes, duration_classes : array-like of int of shape (n_states,) and (n_duration_states,), default None
        Class of each state, from 0 on. None is one class for all.

    Returns
    -------
    TransformClasses

    Raises
    ------
    ValueError
        If there is not one class a state.
    """
    found = []
    for name, given, size in (
        ("state_classes", state_classes, len(parameters.means)),
        ("duration_classes", duration_classes, len(parameters.duration_means)),
    ):
        classes = np.zeros(size, dtype=int) if given is None else np.asarray(given)
        if classes.shape != (size,) or classes.dtype.kind not in "iu" or classes.min() < 0:
            raise ValueError(f"{name} must be a number from 0 on for each of {size} states, got {classes.tolist()}")
        found.append(classes)
    return TransformClasses(found[0], found[1], int(found[0].max()) + 1, int(found[1].max()) + 1)


def identity_walker(classes: TransformClasses, n_channels: int) -> WalkerTransforms:
    """Return transforms that change nothing."""
    channels = tuple(identity_transform(n_channels) for _ in range(classes.n_states))
    return WalkerTransforms(channels, identity_durations(classes.n_durations))


def transformed_log_densities(
    observations: NDArray[np.floating],
    means: NDArray[np.floating],
    variances: NDArray[np.floating],
    transforms: Sequence[ChannelTransform],
    *,
    state_classes: ArrayLike,
    windows: Sequence[Sequence[float]] = WINDOWS,
) -> NDArray[np.float64]:
    """Return the log-density of every frame in every state, each under the transform of its class.

    Parameters
    ----------
    observations : ndarray of shape (n_frames, n_windows * n_channels)
        Channels and their dynamics, not transformed; NaN is what was not observed, a whole window of a frame.
    means, variances : ndarray of shape (n_states, n_windows * n_channels)
        Of transformed channels.
    transforms : sequence of ChannelTransform
        One a class.
    state_classes : array-like of int of shape (n_states,)
        Class of each state.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of each window.

    Returns
    -------
    ndarray of shape (n_states, n_frames)
        A density of the channels as they are: with transforms that differ it can be compared.

    Examples
    --------
    >>> import numpy as np
    >>> double = ChannelTransform(np.array([[2.0]]), np.array([0.0]))
    >>> transformed_log_densities(
    ...     np.array([[1.0]]), np.array([[2.0]]), np.array([[1.0]]), [double], state_classes=[0], windows=((1.0,),)
    ... ).round(3)  # log(2) more than at the mean of a Gaussian
    array([[-0.226]])
    """
    classes = np.asarray(state_classes)
    result = np.empty((len(means), len(observations)))
    n_channels = len(transforms[0].bias)
    for group in np.unique(classes):
        chosen = classes == group
        moved = transform_observations(observations, transforms[group], windows=windows)
        result[chosen] = log_densities(moved, means[chosen], variances[chosen])
        result[chosen] += np.isfinite(moved[:, ::n_channels]).sum(axis=1) * transforms[group].log_volume
    return result


def expect_transformed(
    walk: ObservedWalk,
    parameters: StateParameters,
    transforms: WalkerTransforms,
    *,
    classes: TransformClasses,
    windows: Sequence[Sequence[float]] = WINDOWS,
) -> Posterior:
    """Return likelihood and posteriors of a walk of a walker with transforms.

    Parameters
    ----------
    walk : ObservedWalk
        Channels and their dynamics, not transformed.
    parameters : StateParameters
        Of transformed channels and durations.
    transforms : WalkerTransforms
        Of the walker.
    classes : TransformClasses
        Of the states, as from `one_class`.
    windows : sequence of sequences of float, default WINDOWS
        Coefficients of each window.

    Returns
    -------
    Posterior

    Raises
    ------
    WalkError
        If no durations add up to the length of the walk.
    """
    used, positions = np.unique(walk.states, return_inverse=True)
    moments = parameters.means[used], parameters.variances[used]
    densities = transformed_log_densities(
        walk.observations, *moments, transforms.channels, state_classes=classes.states[used], windows=windows
    )
    durations = log_durations(
        *transformed_durations(
            transforms.durations,
            parameters.duration_means,
            parameters.duration_variances,
            duration_classes=classes.durations,
        )
    )
    return infer_states(accumulate_over_time(densities)[positions], durations[walk.duration_states], walk=walk.name)


def accumulate_transformed(
    walk: ObservedWalk,
    posterior: Posterior,
    parameters: StateParameters,
    transforms: Sequence[ChannelTransform],
    *,
    classes: TransformClasses,
    windows: Sequence[Sequence[float]] = WINDOWS,
) -> Statistics:
    """Return the sums of a walk whose frames are transformed as the class of each state is; durations are in frames.

    Parameters
    ----------
    walk : ObservedWalk
        Channels and their dynamics, not transformed.
    posterior : Posterior
        From `expect_transformed`.
    parameters : StateParameters
        Which says how many states there are.
    transforms : sequence of ChannelTransform
        One for each class of states.
    classes, windows : TransformClasses, and sequence of sequences of float
        As of `expect_transformed`.

    Returns
    -------
    Statistics
        As `maximize_likelihood` and `map_states` take them.
    """
    sizes = {"n_states": len(parameters.means), "n_duration_states": len(parameters.duration_means)}
    groups = classes.states[walk.states]
    parts = []
    for group in np.unique(groups):
        own = np.flatnonzero(groups == group)
        moved = walk._replace(
            observations=transform_observations(walk.observations, transforms[group], windows=windows),
            states=walk.states[own],
            duration_states=walk.duration_states[own],
        )
        chosen = Posterior(0.0, posterior.state_posteriors[:, own], posterior.duration_counts[own])
        parts.append(accumulate_walk(moved, chosen, **sizes))
    total = reduce(add_statistics, parts)
    return total._replace(log_likelihood=posterior.log_likelihood, n_frames=len(walk.observations))


def accumulate_walk_transform(
    walk: ObservedWalk,
    posterior: Posterior,
    parameters: StateParameters,
    *,
    classes: TransformClasses,
    windows: Sequence[Sequence[float]] = WINDOWS,
) -> TransformStatistics:
    """Return the sums of a walk from which its transform is estimated; arguments as of `accumulate_transformed`."""
    return accumulate_transform(
        walk.observations,
        posterior.state_posteriors,
        states=walk.states,
        means=parameters.means,
        variances=parameters.variances,
        state_classes=classes.states,
        n_classes=classes.n_states,
        windows=windows,
    )
