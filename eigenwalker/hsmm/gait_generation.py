"""Channels of new walks from the states of a gait model (Tilmanne et al. 2012, 5.1.4)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sklearn.utils import check_random_state

from eigenwalker._validation import check_choice
from eigenwalker.hsmm.duration import duration_moments
from eigenwalker.hsmm.gait_states import GaitStates, align_walk, chain_of
from eigenwalker.hsmm.generation import generate_trajectory
from eigenwalker.hsmm.global_variance import GlobalVariance, generate_with_variance
from eigenwalker.hsmm.labeled_walks import LabeledWalk
from eigenwalker.hsmm.state_durations import mean_durations, sample_durations
from eigenwalker.hsmm.step_labels import StepLabel
from eigenwalker.hsmm.transforms import transformed_moments

__all__ = [
    "StateSequence",
    "choose_states",
    "generate_channels",
    "measure_timing",
    "moments_in_channels",
    "sample_channels",
]

Array = NDArray[np.float64]

_FEWEST_STEPS = 5  # of a walk whose strides are compared
_ROUNDING = 1 / 6  # frames squared by which whole frames at both ends make strides vary


class StateSequence(NamedTuple):
    """Which state a walk to be generated is in, frame by frame.

    Parameters
    ----------
    positions : ndarray of int of shape (n_frames,)
        Place in the chain of the walk's states: number of the step times the states of a step, plus the state.
    rows : ndarray of int of shape (n_frames,)
        Row of the state in the parameters.
    inside : ndarray of bool of shape (n_frames,)
        Whether the frame is neither of the first nor of the last step, unless there are no others.
    """

    positions: NDArray[np.int64]
    rows: NDArray[np.int64]
    inside: NDArray[np.bool_]


def choose_states(
    model: GaitStates,
    labels: Sequence[StepLabel],
    *,
    durations: str = "mean",
    speed: float = 1.0,
    share: float = 1.0,
    random_state: int | np.random.RandomState | None = None,
) -> StateSequence:
    """Return the sequence of states of a walk of these steps (Eq. 9).

    Parameters
    ----------
    model : GaitStates
        The states.
    labels : sequence of tuple of str
        Of the steps.
    durations : {"mean", "sample", "draw"}, default "mean"
        The expected durations, see `mean_durations`; such that vary about them as strides do; or such as the model
        draws, each state for itself, see `sample_durations`.
    speed : float, default 1.0
        How much faster than the model the walk steps.
    share : float, default 1.0
        Of the variance of durations that drawn ones have, see `measure_timing`.
    random_state : int, RandomState or None, default None
        Seed of drawn durations.
    """
    check_choice(durations, ("mean", "sample", "draw"), name="durations")
    chain = chain_of(model.duration_states, labels)
    gaussians = model.parameters.duration_means[chain], model.parameters.duration_variances[chain]
    means, variances = duration_moments(*gaussians)
    if durations == "sample":
        deviations = check_random_state(random_state).normal(size=len(chain)) * np.sqrt(share * variances)
        means = np.maximum(means + deviations, 1.0)
    if durations == "draw":
        lengths = sample_durations(*gaussians, speed=speed, random_state=random_state)
    else:
        lengths = mean_durations(means, variances, speed=speed)
    positions = np.repeat(np.arange(len(chain)), lengths)
    steps = positions // model.states.shape[1]
    inside = (steps > 0) & (steps < len(labels) - 1) & (len(labels) >= _FEWEST_STEPS)
    return StateSequence(
        positions, chain_of(model.states, labels)[positions], inside if inside.any() else np.ones_like(inside)
    )


def measure_timing(walks: Sequence[LabeledWalk], model: GaitStates) -> float:
    """Return which share of the variance of durations strides really have; NaN if no walk has five steps.

    States whose durations were independent would add up to strides that vary more than those of people, who make up for
    a late step; and states of a few frames cannot vary by less than about a frame. So the variance of the durations of
    strides within walks, along the most likely paths and but for the first and the last step, which take another time,
    is compared with what the states add up to.

    Parameters
    ----------
    walks : sequence of LabeledWalk
        Those that the model was trained on.
    model : GaitStates
        The states.

    Returns
    -------
    float
        At most 1.
    """
    n_states = model.states.shape[1]
    found, expected = [], []
    for walk in walks:
        if len(walk.labels) < _FEWEST_STEPS:
            continue
        starts = align_walk(walk, model)[0][::n_states]
        starts = starts[int(walk.labels[0][1] == "first") : len(starts) - int(walk.labels[-1][1] == "last")]
        strides = starts[2:] - starts[:-2]
        found.append(strides.var(ddof=1))
        chain = chain_of(model.duration_states, walk.labels)
        gaussians = model.parameters.duration_means[chain], model.parameters.duration_variances[chain]
        variances = duration_moments(*gaussians)[1]
        expected.append(2.0 * n_states * variances.mean())
    if not found:
        return float("nan")
    return float(min(1.0, max(0.0, np.mean(found) - _ROUNDING) / np.mean(expected)))


def moments_in_channels(model: GaitStates) -> tuple[Array, Array]:
    """Return means and variances of all states as the channels have them, both (n_rows, n_features).

    Those of states that were adapted are A^-1 (mu - b) and the diagonal of A^-1 Sigma A^-T.
    """
    means, variances = np.array(model.parameters.means), np.array(model.parameters.variances)
    for number, transform in enumerate(model.transforms):
        rows = model.classes == number
        means[rows], variances[rows] = transformed_moments(
            transform, means[rows], variances[rows], windows=model.windows
        )
    return means, variances


def generate_channels(
    model: GaitStates,
    sequence: StateSequence,
    *,
    target: GlobalVariance | None = None,
    weight: float = 1.0,
) -> Array:
    """Return the channels of a walk, shape (n_frames, n_channels).

    Parameters
    ----------
    model : GaitStates
        The states.
    sequence : StateSequence
        From `choose_states`.
    target : GlobalVariance, default None
        Of the channels; None takes the most likely trajectory (Eq. 11), which is too smooth.
    weight : float, default 1.0
        See `generate_with_variance`.

    Notes
    -----
    Without a target, and with one transform for all states, the trajectory is that of the full covariances: generated
    in z, where they are diagonal, and transformed back. Else covariances are taken for diagonal.
    """
    windows, rows = model.windows, sequence.rows
    if target is None and len(model.transforms) == 1:
        return (
            model.transforms[0]
            .inverse()
            .apply(generate_trajectory(model.parameters.means[rows], model.parameters.variances[rows], windows=windows))
        )
    means, variances = moments_in_channels(model)
    if target is None:
        return generate_trajectory(means[rows], variances[rows], windows=windows)
    return generate_with_variance(
        means[rows], variances[rows], target, weight=weight, frames=sequence.inside, windows=windows
    )


def sample_channels(
    model: GaitStates, sequence: StateSequence, *, random_state: int | np.random.RandomState | None = None
) -> Array:
    """Return channels drawn from the Gaussian that the states make of a whole trajectory, see `generate_trajectory`.

    Static channels and their dynamics contradict each other if they are drawn one by one. What they agree on is a
    Gaussian of the trajectory with mean (W'PW)^-1 W'P mu and covariance (W'PW)^-1. It is drawn from by adding noise of
    the states' variances to their means, and generating from these.

    Parameters
    ----------
    model, sequence
        See `generate_channels`.
    random_state : int, RandomState or None, default None
        Seed.
    """
    means, variances = moments_in_channels(model)
    noise = check_random_state(random_state).normal(size=(len(sequence.rows), means.shape[1]))
    drawn = means[sequence.rows] + np.sqrt(variances[sequence.rows]) * noise
    return generate_trajectory(drawn, variances[sequence.rows], windows=model.windows)
