"""The states of a gait model, and what they say of a walk.

A walk passes the states of its steps one after the other. A state owns a Gaussian of observations, one of durations,
and belongs to a class, whose transform z = A c + b of the channels is what the Gaussian describes: the identity but for
models that were adapted. With n the number of windows that lie within the walk at frame t

    log p(o_t | state) = log N(z_t, delta z_t, delta2 z_t; mu, sigma^2) + n log |det A|
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.hsmm.duration import log_durations
from eigenwalker.hsmm.estimation import StateParameters
from eigenwalker.hsmm.features import whole_frames
from eigenwalker.hsmm.inference import Posterior, align_states, infer_states, sum_paths
from eigenwalker.hsmm.labeled_walks import LabeledWalk
from eigenwalker.hsmm.observation import accumulate_over_time, log_densities
from eigenwalker.hsmm.step_labels import CONTEXTS, StepLabel
from eigenwalker.hsmm.transforms import ChannelTransform

__all__ = ["GaitStates", "align_walk", "chain_of", "infer_walk", "score_walk"]


class GaitStates(NamedTuple):
    """All that a gait model knows, in arrays.

    Parameters
    ----------
    parameters : StateParameters
        Gaussians of observations and durations, one row a state.
    states, duration_states : ndarray of int of shape (n_contexts, n_states)
        Which rows the states of a step have in each context, in the order of CONTEXTS; -1 where none is known.
    transforms : tuple of ChannelTransform
        A and b of each class.
    classes : ndarray of int of shape (n_rows,)
        The class of each row of observations.
    windows : sequence of sequences of float
        See `append_dynamics`.
    """

    parameters: StateParameters
    states: NDArray[np.int64]
    duration_states: NDArray[np.int64]
    transforms: tuple[ChannelTransform, ...]
    classes: NDArray[np.int64]
    windows: Sequence[Sequence[float]]


def chain_of(states: NDArray[np.int64], labels: Sequence[StepLabel]) -> NDArray[np.int64]:
    """Return the rows that a walk of these steps passes, shape (n_steps * n_states,).

    Parameters
    ----------
    states : ndarray of int of shape (n_contexts, n_states)
        Of `GaitStates`.
    labels : sequence of tuple of str
        Of the steps.

    Raises
    ------
    ValueError
        If a label has no states.
    """
    rows = states[[CONTEXTS.index(label) for label in labels]]
    unknown = sorted({label for label, row in zip(labels, rows, strict=True) if (row < 0).any()})
    if unknown:
        raise ValueError(
            f"no walk in fit had a step {unknown[0]}, and without tying it has no states; fit with tying='tree', which "
            "gives every step some"
        )
    return rows.ravel()  # (n_steps, n_states) -> (n_steps * n_states,)


def infer_walk(walk: LabeledWalk, model: GaitStates) -> Posterior:
    """Return likelihood and posteriors of a walk, see `infer_states`."""
    return infer_states(*_evidence(walk, model), walk=walk.name)


def score_walk(walk: LabeledWalk, model: GaitStates) -> float:
    """Return the log-likelihood of a walk, see `sum_paths`."""
    return sum_paths(*_evidence(walk, model), walk=walk.name)


def align_walk(walk: LabeledWalk, model: GaitStates) -> tuple[NDArray[np.int64], float]:
    """Return the most likely path of a walk, counted from its first step, and its log-density, see `align_states`."""
    return align_states(*_evidence(walk, model), walk=walk.name)


def _evidence(walk: LabeledWalk, model: GaitStates) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return running sums of log-densities and log-probabilities of durations, one row a position."""
    chain, parameters = chain_of(model.states, walk.labels), model.parameters
    used, positions = np.unique(chain, return_inverse=True)
    n_observed = whole_frames(len(walk.channels), windows=model.windows)[walk.frames].sum(axis=1)
    densities = np.empty((len(used), len(n_observed)))
    for number in np.unique(model.classes[used]):
        transform = model.transforms[number]
        moved = walk._replace(channels=transform.apply(walk.channels))
        rows = model.classes[used] == number
        densities[rows] = log_densities(
            moved.observations(model.windows), parameters.means[used[rows]], parameters.variances[used[rows]]
        )
        densities[rows] += n_observed * transform.log_volume
    durations = log_durations(parameters.duration_means, parameters.duration_variances)
    chain_of_durations = chain_of(model.duration_states, walk.labels)
    return accumulate_over_time(densities)[positions], durations[chain_of_durations]
